/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/convert,DCMTimedFix<FixDCMConvert>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_CONVERT_H
#define LMP_FIX_DCM_CONVERT_H

#include "law/shape.h"
#include "dcm_cell_surgery.h"
#include "dcm_convert_rules.h"
#include "dcm_request.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace LAMMPS_NS {

// Turns center-based cells into deformable ones where the deck's rule asks for their shape, and
// back where it does not. Volume and center stay, and the cell keeps its molecule ID, its place in
// the cycle and its lineage.

class FixDCMConvert : public Fix, public DCMRole {
 public:
  FixDCMConvert(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;

  // a deformable cell may be larger than all spheres so far
  unsigned traits() const override;

 private:
  using Cells = DCMConvertRule::Cells;

  int every;    // looks, as given, 0: not

  struct Change {
    tagint molecule;
    bool to_deformable;
  };

  class FixDCMCell *cell;
  DCMRequest<> spheres;
  DCMCellTable::Handle ratio;    // rest volume over volume when a cell was last deformable, else 1
  DCMCellTable::Handle until;    // time until which a cell keeps its form; with keyword hold
  DCMCellBuilder::Types deformable, sphere;
  int level;
  double rest;    // rest length over edge of the round cell
  double hold;    // shortest time between two conversions of a cell
  int nrules;
  std::unique_ptr<DCMConvertRule> rule;
  std::uint64_t seed;
  DCMCellBuilder::Topology top;
  std::vector<Change> changing;
  bigint counts[2];    // to deformable, to center-based

  void parse(int, char **);
  bool nobody() const;
  bool held(int row) const;
  void changed(tagint molecule, int type, bool to_deformable, double volume0);
  std::vector<dcm::Ball> neighbors_of(tagint, const dcm::Vec3 &, const Cells &) const;
  bool can_be_shaped(tagint, const Cells &) const;
  void to_sphere(DCMCellSurgery &, const DCMCellSurgery::Cell &);
  void to_deformable(DCMCellSurgery &, const DCMCellSurgery::Cell &, const Cells &);
};

}    // namespace LAMMPS_NS

#endif
#endif
