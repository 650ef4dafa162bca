/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/motion,DCMTimedFix<FixDCMMotion>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_MOTION_H
#define LMP_FIX_DCM_MOTION_H

#include "law/friction_comm.h"
#include "law/friction_solver.h"
#include "law/half_step.h"
#include "law/step_control.h"
#include "law/step_system.h"
#include "dcm_parameters.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "dcm_unknowns.h"
#include "fix.h"

#include <vector>

namespace LAMMPS_NS {

// Overdamped motion: once a step, solve Gamma v = F (scheme explicit) or (Gamma + dt K) v = F
// (scheme implicit) for all nodes and spheres of the group, then x += dt v. Gamma is the sum of ECM
// friction and of what the styles of the deck contribute (DCMRole), cortex dashpots and contact
// friction among them, and so is the stiffness K. Nodes and spheres outside the group are fixed,
// or move as another style says (DCMRole::moved_bits()).
// Doc page fix_dcm_motion.

class FixDCMMotion : public Fix, public DCMRole {
 public:
  FixDCMMotion(class LAMMPS *, int, char **);
  ~FixDCMMotion() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void post_neighbor() override;
  void final_integrate() override;
  void reset_dt() override;
  void post_run() override;
  int modify_param(int, char **) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;
  double memory_usage() override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;

  unsigned traits() const override
  {
    return MOVES | (implicit ? IMPLICIT : 0U) | (automatic ? CHOOSES_STEP : 0U) |
           (shrinks ? SHORTENS_STEP : 0U);
  }
  void cell_removed(int) override { removed = true; }
  int solved_bits() const override { return groupbit; }
  std::string work() override;
  std::vector<Note> report() override;

 private:
  struct DCMAtoms *dcm;
  class FixDCMCell *cell;
  std::vector<DCMRole *> roles;    // of the deck, in this run
  DCMParameters parameters;

  std::vector<double> friction;    // per atom type: ECM friction per area
  double maxmove, least_free;
  bool implicit;

  dcm::FrictionSystem system;
  dcm::StiffnessSystem stiffness;    // scheme implicit only
  dcm::FrictionComm messages;
  DCMUnknowns unknowns;
  dcm::FrictionSolver<dcm::FrictionComm> solver;
  dcm::FrictionResult last;

  bool emptied = false;             // the cells of the group have all died or been deleted
  bool removed = false;             // cells have been taken away in the last run
  bigint movable = -1;              // nodes and spheres at its end, in the group or not; -1: no run
  bool stale, deferred, pending;    // lists outdated; solve of setup() must wait, is waiting
  std::vector<int> face_slots;      // 3 per owned face
  std::vector<double> owner;        // per owned + ghost atom: its process
  std::vector<double> rhs, velocity;    // dcm::STRIDE per slot
  std::vector<double> cell_sums;

  // bodies that others move: their velocities go to the right-hand side

  std::vector<DCMRole *> movers;
  int moving;                                  // bits of the groups of all that moves
  std::vector<double> given_velocity, load;    // dcm::STRIDE per slot

  // dt auto, and maxmove X shrink

  dcm::StepControl control;
  dcm::HalfStep half;    // accuracy A
  double radius;         // of the cells it is relative to; 0: not known yet
  bool automatic, shrinks;
  double step, wanted;                 // its length, and were there no event; 0: not known yet
  double given;                        // timestep of the deck, which comes back with unfix
  double least, longest;               // keywords min and max, 0: from that timestep
  double stop;                         // time at which runs end, infinite: never
  bool ended;                          // that time has come
  double read_time;                    // of a restart file: atime and atimestep of LAMMPS' Update;
  bigint read_timestep;                // -1: there is none, or it has been taken
  double began = 0.0;                  // time at which the run did
  double nshort, shortest;             // steps shorter than the timestep since the start of the run
  double error_of_step, rejected;      // of the coming step; since the start of the run
  std::vector<double> before;          // velocities of the last step, dcm::STRIDE per slot
  std::vector<double> cell_means;      // two numbers per row, largest_of_cells()
  std::vector<RestAhead> ahead;        // per row, to the end of the coming step
  std::vector<double> ahead_forces;    // dcm::STRIDE per slot

  double largest_move;          // dt |v| over mean edge (node) or radius (sphere)
  int slot_move;                // where, 0: on another process
  double solves, iterations;    // since the start of the run

  struct Most {    // the largest of the steps taken in the run; who: where it is on this process
    double ratio = 0.0, move = 0.0;
    bigint step = 0;
    tagint tag = 0, molecule = 0;
    int kind = 0;
  } most;
  double seconds_assembly, seconds_solve, messages_start;

  bigint count_movable() const;
  void find_friction();
  void check_deck();
  void make_slots();
  void assemble();
  void add_ecm();
  void solve(double);
  void check_solution();
  double scale_of_move(int) const;
  void find_move(double);
  void note_move();
  double seconds_left() const;
  void check_move();
  template <class Terms, class Function> double largest_of_cells(Terms &&, Function &&);
  double change_of_velocity();
  void plan_accuracy();
  void tell_accuracy();
  double check_half(double);
  void look_ahead(double);
  bool solve_system(double, double);
  DCMRole *mover_of(int) const;
  void apply(double, double *, double *);
  const double *without_bodies(double);
  void add_bodies();
  void find_loads();
  void find_movers();
  void choose_step(double);
  void shrink_step(double);
  double until_event(double);
  void begin_step(double);
  void set_step(double);
  void take_time();
  void parse_step(class DCMArgs &);
  void count_short();
  void tell_short();
  void find_limits();
  void spread_velocity();
  std::vector<tagint> describe(int);
};

}    // namespace LAMMPS_NS

#endif
#endif
