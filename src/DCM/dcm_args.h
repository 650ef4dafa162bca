/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#ifndef LMP_DCM_ARGS_H
#define LMP_DCM_ARGS_H

#include "lmptype.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// what a number of the deck or of a parameter file may be

struct DCMRanges {
  enum Range { ANY, NONNEGATIVE, POSITIVE };
};

// The arguments of a style or command, keyword by keyword:
//
//   DCMArgs args(lmp, "Fix dcm/death", narg - 3, arg + 3, {"age", "every", "log"});
//   while (args.next()) {
//     if (args.is("age")) age = args.number(DCMArgs::NONNEGATIVE);
//     else if (args.is("every")) nevery = args.whole();
//     else log_name = args.text();
//   }
//
// Every error names the style, the keyword, the value and what would do. Nothing is looked up
// here: what a value names (a group, a region, a variable) may change until init().

class DCMArgs : protected Pointers, public DCMRanges {
 public:
  // asking: the style as it stands in the deck, for messages, e.g. "Fix dcm/death"
  DCMArgs(class LAMMPS *, const std::string &asking, int narg, char **arg,
          const std::vector<std::string> &keywords);

  // arguments that come before the first keyword
  int left() const { return narg - iarg; }
  const char *ahead(int n = 0) const { return n < left() ? arg[iarg + n] : nullptr; }
  bool keyword_ahead(int n = 0) const;    // at place n from here there is a keyword, or the end
  const char *take() { return arg[iarg++]; }

  void add_keywords(const std::vector<std::string> &);    // in front of the known ones
  void may_repeat(const std::vector<std::string> &);      // others: an error if given twice
  std::string known() const;

  // on to the next keyword; false: no argument is left, an error: it is not known, or was there
  // before: which of two values is meant nobody knows
  bool next();
  const std::string &keyword() const { return key; }
  bool is(const std::string &keyword) const { return key == keyword; }

  // the values of the keyword, one after the other
  void need(int n) const;          // so many must follow; without it each value asks for itself
  const char *text();              // any word
  bool word(const char *which);    // take the next value if it is this one
  double number(Range range = ANY, const std::string &what = "");    // what: instead of the keyword
  bigint whole(bigint least = 1, bigint most = MAXSMALLINT);
  int type(int ntypes);    // atom, bond or dihedral type
  int choose(const std::vector<std::string> &names, const std::string &shown = "");    // index
  int axis();                // x, y or z: 0, 1 or 2
  std::string variable();    // v_NAME: NAME

  // a bound of the value just taken: error `KEYWORD is VALUE, must be MUST`
  void check(bool ok, const std::string &must) const;

  // a number from text, for those who have no DCMArgs
  static double number(class LAMMPS *, const std::string &asking, const std::string &what,
                       const char *text, Range);
  static double in_range(class LAMMPS *, const std::string &asking, const std::string &what,
                         double value, Range);

 private:
  std::string asking;
  int narg, iarg, ikey;    // arguments, next one, place of the keyword
  char **arg;
  std::vector<std::string> keywords, repeatable, given;
  std::string key;
};

// what arguments name, looked up in init() since the deck may change it between runs; an error if
// it is not there

int dcm_find_group(class LAMMPS *, const std::string &asking, const std::string &id);    // its bit
class Region *dcm_find_region(class LAMMPS *, const std::string &asking, const std::string &id);
void dcm_find_variable(class LAMMPS *, const std::string &asking, const std::string &name);

// a point that distances are measured to at the closest image: an error if it is more than a box
// length outside a periodic box, where LAMMPS gives up

void dcm_check_point(class LAMMPS *, const std::string &asking, const std::string &what,
                     const double *x);

}    // namespace LAMMPS_NS

#endif
