/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_PARAMETERS_H
#define LMP_DCM_PARAMETERS_H

#include "pointers.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Cell-type parameters of one style: read from a parameter file (potentials/*.dcm, doc page
// parameters) and overridden by keywords of the deck.
//
// All styles of the package share one form of arguments,
//   FILE name1 ... nameN [keyword value ...]
// with one cell-type name per atom type (pair, fixes; NULL for types the style does not act on) or
// a single name (bond_coeff, dihedral_coeff). FILE is NULL when every value comes by keyword.

class DCMParameters : protected Pointers {
 public:
  enum Range { ANY, NONNEGATIVE, POSITIVE };

  // asking: the style as it stands in the deck, for messages, e.g. "Pair style dcm/contact"
  DCMParameters(class LAMMPS *, const std::string &asking);

  // read FILE and ncount names; returns the number of arguments used (1 + ncount)
  int parse(int narg, char **arg, int ncount);

  // take `keyword value` for all names if keyword is in known; returns 2 or 0 (not known)
  int parse_keyword(int narg, char **arg, const std::vector<std::string> &known);

  // name of slot 1..ncount, "" for NULL
  const std::string &name(int slot) const { return names[slot]; }
  bool used(int slot) const { return !names[slot].empty(); }
  int count() const { return (int) names.size() - 1; }

  // value of a parameter; an error naming style, cell type, parameter and file when it is missing
  // or out of range; the second form has a default
  double get(int slot, const std::string &keyword, Range range) const;
  double get(int slot, const std::string &keyword, Range range, double preset) const;

  // work of adhesion W (energy/area) between region ri of slot i and region rj of slot j;
  // error when the file names no adhesion for the two cell types
  double adhesion(int i, int ri, int j, int rj) const;

  // a number of the deck, checked; errors name style and keyword
  double number(const char *keyword, const char *text, Range range) const;

 private:
  std::string asking, file;
  std::vector<std::string> names;                                // [1..ncount]
  std::map<std::string, std::map<std::string, double>> types;    // cell type -> keyword -> value
  std::map<std::pair<std::string, std::string>, double> energies;    // "type:region" pairs
  std::map<std::string, double> overrides;

  void read_file();
  void read_line(const std::string &line, std::string &current);
  double check(const std::string &keyword, double value, Range range,
               const std::string &where) const;
};

}    // namespace LAMMPS_NS

#endif
