/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/traction,DCMTimedFix<FixDCMTraction>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_TRACTION_H
#define LMP_FIX_DCM_TRACTION_H

#include "atom_vec_dcm.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "dcm_value.h"
#include "fix_dcm_cell.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Load per area on faces of deformable cells, from outside: a pressure, a traction of fixed
// direction, or both (law/traction.h).

class FixDCMTraction : public Fix, public DCMRole {
 public:
  FixDCMTraction(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_reverse(int, int) override;
  void pre_reverse(int, int) override;
  void min_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  double compute_vector(int) override;
  double memory_usage() override;

 private:
  FixDCMCell *cell;
  DCMAtoms *dcm;
  DCMValue pressure;
  DCMValue traction[3];
  std::array<bool, AtomVecDCM::NREGION> loaded;    // surface regions
  std::string region_id;                           // of LAMMPS, empty: everywhere
  class Region *region;
  bool nobody;               // has no faces and gets none in this run
  double sums[4], all[4];    // force, area: of this process, of all once somebody has asked
  bool summed;

  std::vector<DCMValue *> values();
  bool inside(const double *) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
