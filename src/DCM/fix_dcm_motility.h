/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/motility,DCMTimedFix<FixDCMMotility>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_MOTILITY_H
#define LMP_FIX_DCM_MOTILITY_H

#include "dcm_parameters.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"
#include "update.h"

#include <cstdint>
#include <vector>

namespace LAMMPS_NS {

// Random and biased migration force of cells (S1 "Migration forces"). The random numbers depend on
// seed, cell and step, or interval of time, only, so that neither the number of ranks nor a restart
// changes a run.

class FixDCMMotility : public Fix, public DCMRole {
 public:
  FixDCMMotility(class LAMMPS *, int, char **);
  ~FixDCMMotility() override;
  int setmask() override;
  void init() override;
  void setup_pre_reverse(int, int) override;
  void initial_integrate(int) override;
  void pre_reverse(int, int) override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  double memory_usage() override;

  unsigned traits() const override { return interval > 0.0 ? 0U : FIXED_STEP; }
  double next_event() override;

 private:
  class FixDCMCell *cell;
  struct DCMAtoms *dcm;
  DCMParameters parameters;
  std::uint64_t seed;
  double interval;       // time for which a force is held, 0: a step
  double persistence;    // correlation time of the force, 0: white noise
  double bias[3];        // constant force
  int plane;             // 0-2: no random force along this axis, -1: in all directions

  struct Type {    // per atom type
    bool used = false;
    double D = 0.0, friction = 0.0;    // < 0: not given
  };
  std::vector<Type> types;

  // with persistence: force of each center and sphere in units of its standard deviation

  double **state;
  std::vector<double> cell_force;    // per deformable cell 3

  void read_types();
  bool moves(int) const;
  void draw(tagint, double *) const;
  void check(int type) const;
  double amplitude(const Type &, double) const;
  double held_for() const { return interval > 0.0 ? interval : update->dt; }
  bigint number_of_interval(double) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
