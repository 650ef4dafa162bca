/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CONVERT_RULES_H
#define LMP_DCM_CONVERT_RULES_H

#include "dcm_cell_table.h"
#include "law/conversion.h"
#include "pointers.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// A rule of fix dcm/convert: which form it asks for, cell by cell. A new rule is a class in
// dcm_convert_rules.cpp and a line in its table.

class DCMConvertRule : protected Pointers {
 public:
  using Cells = std::vector<DCMCellTable::CellAtom>;

  explicit DCMConvertRule(class LAMMPS *lmp) : Pointers(lmp) {}
  ~DCMConvertRule() override = default;

  // in init() of the fix, every run: look up what the rule names, ask for what it measures

  virtual void init(const class Fix *, class FixDCMCell *) = 0;

  // a look at all cells, collective and the same on all processes, then what it asks for each

  virtual void look(const Cells &) {}
  virtual dcm::Form wants(const Cells &, size_t n) const = 0;

  // the words that name rules, and the rule whose word has just been read, with its values

  static std::vector<std::string> names();
  static std::unique_ptr<DCMConvertRule> read(class LAMMPS *, class DCMArgs &);
};

}    // namespace LAMMPS_NS

#endif
