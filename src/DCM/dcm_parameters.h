/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_PARAMETERS_H
#define LMP_DCM_PARAMETERS_H

#include "dcm_args.h"
#include "pointers.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Cell-type parameters of one style: from a parameter file (potentials/*.dcm, doc page parameters),
// overridden by keywords of the deck. The file and the cell type of each atom type are named
//
//   once in the deck:      fix cell all dcm/cell types FILE name1 ... nameN
//   or for one style:      ... FILE name1 ... nameN [keyword value ...]
//
// name is NULL for atom types a style does not act on, FILE when every value comes by keyword.
// Cortex styles name one cell type, with its file or without: [FILE] name.
//
// The deck's names are taken in init(), where the order of the deck no longer matters: call
// resolve() there, before any value is asked for.

class DCMParameters : protected Pointers, public DCMRanges {
 public:
  // asking: the style as it stands in the deck, for messages, e.g. "Pair style dcm/contact"
  // keywords: parameters that the deck may give in place of the file
  DCMParameters(class LAMMPS *, const std::string &asking,
                const std::vector<std::string> &keywords);

  // FILE name1 ... nameN if it stands there; nothing if a keyword or the end comes first
  void parse(DCMArgs &, int ntypes);
  void parse_one(DCMArgs &);                  // [FILE] name
  void parse_table(DCMArgs &, int ntypes);    // it must stand there

  // take the values of the keyword if it is a parameter; for all names
  bool parse_keyword(DCMArgs &);
  bool by_keyword(const std::string &keyword) const { return overrides.count(keyword) > 0; }

  // names from the deck if this style has none of its own; an error if there are none either
  void resolve();
  bool own() const { return has_own; }

  // name of slot 1..ncount, "" for NULL
  const std::string &name(int slot) const { return names[slot]; }
  bool used(int slot) const { return !names[slot].empty(); }

  // value of a parameter; an error naming style, cell type, parameter and file when it is missing
  // or out of range; the second form has a default
  double get(int slot, const std::string &keyword, Range range) const;
  double get(int slot, const std::string &keyword, Range range, double preset) const;
  bool has(int slot, const std::string &keyword) const;    // is there a value?

  // name of a surface region, as in the file: NAME:REGION, KEYWORD:REGION
  static const std::string &region_name(int region);

  // one name or more, up to the next keyword
  static std::vector<int> parse_regions(DCMArgs &);

  // work of adhesion W (energy/area) between region ri of slot i and region rj of slot j;
  // error when the file names no adhesion for the two cell types
  double adhesion(int i, int ri, int j, int rj) const;

 private:
  std::string asking, file;
  bool has_own;
  std::vector<std::string> keywords;
  std::string wanted;                                            // of parse_one() without FILE
  std::vector<std::string> names;                                // [1..ncount]
  std::map<std::string, std::map<std::string, double>> types;    // cell type -> keyword -> value
  std::map<std::pair<std::string, std::string>, double> energies;    // "type:region" pairs
  std::map<std::string, double> overrides;

  void read_file(const DCMArgs &);
  void read_line(const std::string &line, std::string &current);
  void contradiction(const std::string &where, double before, double now) const;
  [[noreturn]] void unknown_type(const std::string &name) const;
};

}    // namespace LAMMPS_NS

#endif
