/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/adapt,DCMTimedFix<FixDCMAdapt>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_ADAPT_H
#define LMP_FIX_DCM_ADAPT_H

#include "atom_vec_dcm.h"
#include "dcm_cell_table.h"
#include "dcm_request.h"
#include "dcm_rest_change.h"
#include "dcm_role.h"
#include "dcm_slot_lengths.h"
#include "dcm_timed.h"
#include "dcm_value.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

// Factors on the rest volume and on the rest lengths of deformable cells, from numbers or variables
// of the deck. A factor on whole cells is kept per cell, one on the edges of some regions per bond
// slot.

class FixDCMAdapt : public DCMSlotLengths, public DCMRole {
 public:
  FixDCMAdapt(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_force(int) override;
  void initial_integrate(int) override;
  double compute_vector(int) override;
  double memory_usage() override;

  unsigned traits() const override { return by_region ? KEEPS_PLACES : 0U; }

 private:
  struct Factor {
    bool given = false;
    DCMValue value;
    DCMCellTable::Handle applied;    // per cell: what is in its rest state; of all these fixes
    std::vector<double> now;         // per row
  };

  class FixDCMCell *cell;
  Factor volume, length;
  bool by_region;                                  // of lengths: of some edges only
  std::array<bool, AtomVecDCM::NREGION> chosen;    // surface regions
  int every, look;                                 // steps between two looks at the regions
  DCMRequest<> adjacency;
  DCMRestChange rest;

  bool acts_on(int row) const;
  bool anyone() const;
  void evaluate();
  void evaluate(Factor &);
  void apply();
  void check_alone();
  bool inside(int i, int j) const;
  void choose_edges();
  void write_lengths();
};

}    // namespace LAMMPS_NS

#endif
#endif
