/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/move,DCMTimedFix<FixDCMMove>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_MOVE_H
#define LMP_FIX_DCM_MOVE_H

#include "dcm_role.h"
#include "dcm_timed.h"
#include "dcm_value.h"
#include "fix.h"
#include "law/rigid_motion.h"

namespace LAMMPS_NS {

// Bodies that move at a velocity that the deck gives: nodes and spheres of the group are no
// unknowns of fix dcm/motion, which takes what they do to the others into its right-hand side and
// tells what the others do to them. Doc page fix_dcm_move.

class FixDCMMove : public Fix, public DCMRole {
 public:
  FixDCMMove(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void final_integrate() override;
  double compute_vector(int) override;

  int moved_bits() const override { return groupbit; }
  void move_body(int, double, double *) override;
  void begin_load() override;
  void add_load(int, const double *) override;

 private:
  struct DCMAtoms *dcm;
  DCMValue linear[3], rate;
  bool turns;
  dcm::RigidMotion motion;

  // force, torque about the origin, places and number of the group's atoms: of this process, of all

  static constexpr int NSUM = 10;
  double mine[NSUM], all[NSUM];
  bool summed;

  void parse(class DCMArgs &);
  void check_others() const;
};

}    // namespace LAMMPS_NS

#endif
#endif
