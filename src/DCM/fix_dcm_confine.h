/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/confine,DCMTimedFix<FixDCMConfine>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_CONFINE_H
#define LMP_FIX_DCM_CONFINE_H

#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Confinement of a tissue: an inward force on the outermost cells, driven so that the mean pressure
// of chosen deformable cells reaches a target, and a penalty that holds cells in a plane.
//
// The force of step n+1 follows from the pressures of step n, in initial_integrate: setup() changes
// nothing, so that a restart repeats what the run did, and the order of fixes does not matter.

class FixDCMConfine : public Fix, public DCMRole {
 public:
  FixDCMConfine(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_reverse(int, int) override;
  void initial_integrate(int) override;
  void pre_reverse(int, int) override;
  void min_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double longest_step() override;
  void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) override;
  int modify_param(int, char **) override;
  double memory_usage() override;

 private:
  class FixDCMCell *cell;
  struct DCMAtoms *dcm;

  double target;           // pressure to reach, 0: no inward force
  std::string measured;    // group whose deformable cells are averaged
  int measured_bit;
  int axis;             // 0-2: x, y or z
  double center[3];     // a point of the axis
  double tau;           // time constant of the controller, 0: TAU_STEPS steps
  double limit;         // largest force, in units of the reference force
  double outer_area;    // outer area per cell, 0: estimated

  double force;        // inward force per cell
  double reference;    // force that would do if each cell passed on the target on its outer area
  double smooth;       // low-pass filtered mean pressure
  bool started, warned;
  bool hold;    // the force stays what it is

  int plane;            // 0-2: normal of the plane, -1: none
  double spring, at;    // force constant, position
  std::string held;     // group held in the plane, empty: that of the fix
  int plane_bit;
  double energy, farthest;    // of this rank's cells; deformable ones count on rank 0

  std::vector<double> cell_force;    // per deformable cell 3

  bool any_held() const;
  void add_force(const double *, int, double *);
  void estimate_reference();
  double mean_pressure() const;
  void radial(const double *, double *) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
