/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_VALUE_H
#define LMP_DCM_VALUE_H

#include "dcm_args.h"

#include <cmath>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// A parameter of a style that the deck gives as a number, as an equal-style variable (of time) or
// as an atom-style one (of time and place):
//
//   constructor: value.parse(args);
//   init():      value.find(lmp, STYLE);
//   each step:   DCMValue::evaluate(lmp, STYLE, {&one, &other}, igroup);    // collective
//                value(i)    // i: an owned atom of the group

class DCMValue {
 public:
  explicit DCMValue(double number = 0.0) : now(number) {}

  // the next value of the keyword; what: it is called in messages, instead of the keyword
  void parse(DCMArgs &, const std::string &what = "");

  void find(class LAMMPS *, const std::string &asking);

  bool varies() const { return !name.empty(); }
  bool per_atom() const { return style == ATOM; }    // after find()
  const std::string &variable() const { return name; }

  // with the computes that the variables name, as LAMMPS' fixes do; an error if an equal-style one
  // is no number
  static void evaluate(class LAMMPS *, const std::string &asking,
                       const std::vector<DCMValue *> &values, int igroup);

  double operator()(int i) const { return style == ATOM ? atoms[i] : now; }
  double operator()() const { return now; }    // not per_atom()

  // an error if the value of an atom is no number; for those that are used
  void check(class LAMMPS *lmp, const std::string &asking, int i) const
  {
    if (style == ATOM && !std::isfinite(atoms[i])) complain(lmp, asking, i);
  }

  double memory_usage() const { return (double) atoms.capacity() * sizeof(double); }

 private:
  enum Style { NUMBER, EQUAL, ATOM };

  std::string name, what;    // of the variable, empty: a number; of the parameter
  Style style = NUMBER;
  double now;
  std::vector<double> atoms;

  void compute(class LAMMPS *, const std::string &asking, int igroup);
  void complain(class LAMMPS *, const std::string &asking, int i) const;
};

}    // namespace LAMMPS_NS

#endif
