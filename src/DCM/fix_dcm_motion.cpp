/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_motion.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_deck_check.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::STRIDE;

static const char STYLE[] = "Fix dcm/motion";

// A velocity that solves the system of setup() to this many times the tolerance is kept: it comes
// from a restart file or an earlier run, and solving again would only change its last bits.

static constexpr double KEEP = 2.0;

/* ----------------------------------------------------------------------
   fix ID group dcm/motion [FILE name1..nameN] [friction_ecm v] [tolerance t] [maxiter n]
                           [precondition block|jacobi|none] [maxmove m] [floor f]
                           [scheme explicit|implicit]
                           [dt auto tol X [min A] [max B]] [accuracy A] [stop T]
------------------------------------------------------------------------- */

FixDCMMotion::FixDCMMotion(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), parameters(lmp, STYLE, {"friction_ecm"}), messages(world),
    unknowns(lmp, system, messages)
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  maxmove = 0.25;
  least_free = 1e-6;
  implicit = true;
  automatic = shrinks = ended = false;
  solver.tolerance = 0.0;
  stop = std::numeric_limits<double>::infinity();
  given = least = longest = radius = 0.0;
  step = wanted = error_of_step = rejected = 0.0;
  nshort = shortest = 0.0;
  read_time = 0.0;
  read_timestep = -1;

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3,
               {"tolerance", "maxiter", "precondition", "maxmove", "floor", "scheme", "dt",
                "accuracy", "stop"});
  parameters.parse(args, atom->ntypes);
  while (args.next()) {
    if (parameters.parse_keyword(args)) continue;
    if (args.is("tolerance")) {
      solver.tolerance = args.number(DCMArgs::POSITIVE);
      args.check(solver.tolerance < 1.0, "below 1");
    } else if (args.is("maxiter")) {
      solver.maxiter = (int) args.whole();
    } else if (args.is("precondition")) {
      using dcm::Precondition;
      const Precondition order[] = {Precondition::BLOCK, Precondition::JACOBI, Precondition::NONE};
      solver.precondition = order[args.choose({"block", "jacobi", "none"})];
    } else if (args.is("maxmove")) {
      maxmove = args.number(DCMArgs::POSITIVE);
      shrinks = args.word("shrink");
    } else if (args.is("scheme")) {
      implicit = args.choose({"explicit", "implicit"}) == 1;
    } else if (args.is("dt")) {
      parse_step(args);
    } else if (args.is("accuracy")) {
      half.accuracy = args.number(DCMArgs::POSITIVE);
      args.check(half.accuracy <= 0.2, "at most 0.2");
    } else if (args.is("stop")) {
      stop = args.number(DCMArgs::POSITIVE);
    } else {
      least_free = args.number(DCMArgs::NONNEGATIVE);
      args.check(least_free <= 1.0, "0 to 1");
    }
  }

  if (half.accuracy > 0.0) plan_accuracy();
  if (solver.tolerance == 0.0) solver.tolerance = 1e-3;
  if (automatic && control.tolerance == 0.0 && half.accuracy == 0.0)
    error->all(FLERR,
               "{}: dt auto needs tol, the error of a step, a length; or accuracy in its place",
               STYLE);
  if (automatic && !implicit)
    error->all(FLERR, "{}: dt auto does not go with scheme explicit", STYLE);
  if (automatic && shrinks)
    error->all(FLERR, "{}: dt auto shortens steps by itself; leave out shrink behind maxmove {}",
               STYLE, maxmove);

  time_integrate = 1;
  restart_global = automatic || shrinks ? 1 : 0;
  dynamic_group_allow = 0;
  vector_flag = 1;
  size_vector = automatic || shrinks ? 13 : 8;
  global_freq = 1;
  extvector = 0;
  comm_forward = 1;

  stale = true;
  deferred = pending = false;
  largest_move = solves = iterations = 0.0;
  slot_move = 0;
  seconds_assembly = seconds_solve = messages_start = 0.0;
}

int FixDCMMotion::setmask()
{
  return INITIAL_INTEGRATE | POST_NEIGHBOR | FINAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixDCMMotion::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  if (group->dynamic[igroup])
    error->all(FLERR,
               "{}: group {} is dynamic; what moves is numbered at rebuilds of the neighbor lists "
               "only, so give it a static group ('group NAME static ...')",
               STYLE, group->names[igroup]);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::NODE, AtomVecDCM::SPHERE});
  check_deck();
  roles = DCMRole::of(lmp);
  find_movers();
  if ((automatic || shrinks) && (traits_of(lmp) & FIXED_STEP))
    error->all(FLERR,
               "{}: {} does not go with a fix dcm/motility whose random force is drawn for each "
               "step; give it a time for which a force is held, keyword interval, or leave {} out",
               STYLE, automatic ? "dt auto" : "maxmove shrink", automatic ? "dt" : "shrink");
  find_friction();
  reset_dt();
  stale = true;
  solves = iterations = rejected = 0.0;
  most = Most();
  seconds_assembly = seconds_solve = 0.0;
  messages_start = messages.seconds;
  if (automatic && longest == 0.0 && !(step > 0.0)) {    // the command timestep may have come after
    given = update->dt;
    find_limits();
  }
  if (automatic) set_step(step > 0.0 ? step : control.round_down(update->dt));
  if (automatic) take_time();
  nshort = shortest = 0.0;
  if (shrinks && update->dt != step) {    // the deck's timestep, not what a run had come to
    given = update->dt;
    step = wanted = 0.0;
  }
  if (shrinks) find_limits();
}

void FixDCMMotion::check_deck()
{
  if (modify->get_fix_by_style("^dcm/motion$").size() > 1)
    error->all(FLERR,
               "{}: there are two of them; one fix moves all cells, choose which by its "
               "group",
               STYLE);
  if (!utils::strmatch(update->integrate_style, "^verlet"))
    error->all(FLERR, "{} works with run_style verlet, not {}", STYLE, update->integrate_style);

  // fixes defined later add their forces of setup() after ours: the first solve has to wait

  deferred = false;
  bool later = false;
  for (auto *other : std::vector<Fix *>(modify->get_fix_list())) {
    if (other == this) {
      later = true;
      continue;
    }
    if (other->time_integrate && !dynamic_cast<DCMRole *>(other))
      error->all(FLERR,
                 "{} and fix {} ({}) both move atoms; unfix one of them (bodies that move as the "
                 "deck says: fix dcm/move)",
                 STYLE, other->id, other->style);
    if ((automatic || shrinks) && utils::strmatch(other->style, "^dt/reset"))
      error->all(FLERR, "{}: fix {} ({}) changes the time step, and so does {}; unfix one", STYLE,
                 other->id, other->style, automatic ? "dt auto" : "maxmove shrink");
    if (later && (modify->get_fix_mask(other) & POST_FORCE)) deferred = true;
  }
}

bigint FixDCMMotion::count_movable() const
{
  bigint n = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (unknowns.moves(i, 1)) n++;    // group all
  MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  return n;
}

/* ----------------------------------------------------------------------
   ECM friction of every atom type that holds nodes or spheres of the group. A group whose cells
have all gone is no error: others may come, and restart files have to be written
------------------------------------------------------------------------- */

void FixDCMMotion::find_friction()
{
  parameters.resolve();
  const auto needed =
      AtomVecDCM::types_holding(lmp, {AtomVecDCM::NODE, AtomVecDCM::SPHERE}, groupbit);
  const bool holds = std::find(needed.begin(), needed.end(), 1) != needed.end();
  const bool fewer = count_movable() < movable;    // the deck has deleted some
  emptied = !holds && (emptied || removed || fewer);
  removed = false;
  if (!holds && !emptied)
    error->all(FLERR, "{}: group {} holds no node and no sphere, nothing to move", STYLE,
               group->names[igroup]);

  friction.assign(atom->ntypes + 1, 0.0);
  for (int itype = 1; itype <= atom->ntypes; itype++) {
    if (parameters.used(itype))
      friction[itype] = parameters.get(itype, "friction_ecm", DCMParameters::NONNEGATIVE);
    else if (needed[itype])
      error->all(FLERR,
                 "{}: atom type {} holds nodes or spheres of group {} but has no cell-type "
                 "name; give it one in place of NULL",
                 STYLE, itype, group->names[igroup]);
  }
}

void FixDCMMotion::reset_dt()
{
  if (!(update->dt > 0.0))
    error->all(FLERR, "{}: timestep is {}, must be positive", STYLE, update->dt);
}

/* ---------------------------------------------------------------------- */

void FixDCMMotion::setup(int /*vflag*/)
{
  stale = true;
  pending = deferred;
  if (half.accuracy > 0.0) tell_accuracy();
  const double now = cell->cells().time();
  if (stop <= now * (1.0 + 1e-9) && update->nsteps > 0 && comm->me == 0)
    error->warning(FLERR,
                   "{}: stop {:.8g} is not after the time {:.8g} at which this run begins: it ends "
                   "at once. stop counts from the beginning of the simulation, over all runs and "
                   "restarts",
                   STYLE, stop, now);
  if (!deferred) solve(KEEP);
}

void FixDCMMotion::post_neighbor()
{
  stale = true;
}

void FixDCMMotion::final_integrate()
{
  solve(0.0);
}

/* ----------------------------------------------------------------------
   Euler step; faces and centers follow their nodes, wherever these are
------------------------------------------------------------------------- */

void FixDCMMotion::initial_integrate(int /*vflag*/)
{
  if (pending) solve(KEEP);
  pending = false;
  if (shrinks) count_short();
  if (update->ntimestep == update->firststep + 1) began = cell->cells().time() - update->dt;
  note_move();

  double **x = atom->x, **v = atom->v;
  const double dt = update->dt;
  const int nlocal = atom->nlocal;
  for (int i = 0; i < nlocal; i++) {
    const int kind = dcm->kind[i];
    if (kind == AtomVecDCM::TRACER) continue;
    if ((kind == AtomVecDCM::NODE || kind == AtomVecDCM::SPHERE) && !(atom->mask[i] & moving))
      continue;
    x[i][0] += dt * v[i][0];
    x[i][1] += dt * v[i][1];
    x[i][2] += dt * v[i][2];
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMMotion::solve(double keep)
{
  const double start = platform::walltime();
  const double before = messages.seconds;
  assemble();
  const double assembled = platform::walltime();
  const double between = messages.seconds;
  if (automatic) {
    choose_step(keep);
  } else if (shrinks) {
    shrink_step(keep);
  } else {
    solve_system(update->dt, keep);
    begin_step(update->dt);
  }
  const double solved = platform::walltime();
  const double after = messages.seconds;

  check_move();
  if (!movers.empty()) find_loads();
  if (last.status != dcm::FrictionResult::KEPT || !movers.empty()) spread_velocity();

  seconds_solve += solved - assembled - (after - between);
  seconds_assembly += platform::walltime() - solved + (assembled - start) - (between - before);
}

/* ----------------------------------------------------------------------
   velocities of a step of length dt; false: those there were are kept
------------------------------------------------------------------------- */

bool FixDCMMotion::solve_system(double dt, double keep)
{
  if (implicit) look_ahead(dt);
  const double *const forces = movers.empty() ? rhs.data() : without_bodies(dt);
  if (implicit)
    last = solver.solve(dcm::StepSystem(system, stiffness, dt), forces, velocity.data(), messages,
                        keep);
  else
    last = solver.solve(system, forces, velocity.data(), messages, keep);
  if (!movers.empty()) add_bodies();
  check_solution();
  solves += 1.0;
  iterations += last.iterations;
  find_move(dt);
  return last.status != dcm::FrictionResult::KEPT;
}

/* ----------------------------------------------------------------------
   velocities of owned unknowns, of faces (mean of their vertices') and centers (of their nodes')
------------------------------------------------------------------------- */

void FixDCMMotion::spread_velocity()
{
  double **v = atom->v;
  const int nlocal = atom->nlocal;
  const auto &cells = cell->cells();

  cell->begin_sum(cell_sums, 3);
  for (int i = 0; i < nlocal; i++) {
    const int kind = dcm->kind[i];
    if (kind != AtomVecDCM::NODE && kind != AtomVecDCM::SPHERE) continue;
    const double *u = &velocity[STRIDE * (size_t) unknowns(i)];
    for (int k = 0; k < 3; k++) v[i][k] = u[k];
    if (kind == AtomVecDCM::SPHERE) continue;
    for (int k = 0; k < 3; k++) cell_sums[3 * (size_t) cell->cell_of(i) + k] += u[k];
  }
  cell->sum_owned(cell_sums, 3);
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::CENTER) continue;
    const int c = cell->cell_of(i);
    for (int k = 0; k < 3; k++)
      v[i][k] = cell_sums[3 * (size_t) c + k] / std::max(1, cells[c].nnodes);
  }
  for (int f = 0; f < cell->nowned(); f++) {
    double *vf = v[cell->faces()[f].atom];
    const int *s = &face_slots[3 * (size_t) f];
    for (int k = 0; k < 3; k++)
      vf[k] = (velocity[STRIDE * (size_t) s[0] + k] + velocity[STRIDE * (size_t) s[1] + k] +
               velocity[STRIDE * (size_t) s[2] + k]) /
              3.0;
  }
}

/* ----------------------------------------------------------------------
   tag, molecule and kind of the atom in a slot, from the first process that has one (slot >= 0);
   collective, empty if none has
------------------------------------------------------------------------- */

std::vector<tagint> FixDCMMotion::describe(int s)
{
  int rank = (s > 0) ? comm->me : comm->nprocs;
  MPI_Allreduce(MPI_IN_PLACE, &rank, 1, MPI_INT, MPI_MIN, world);
  if (rank == comm->nprocs) return {};
  tagint values[3] = {0, 0, 0};
  if (rank == comm->me) {
    const int i = unknowns.atom_of(s);
    values[0] = atom->tag[i];
    values[1] = atom->molecule[i];
    values[2] = dcm->kind[i];
  }
  MPI_Bcast(values, 3, MPI_LMP_TAGINT, rank, world);
  return {values[0], values[1], values[2]};
}

static const char *kind_name(tagint kind)
{
  return (kind == AtomVecDCM::SPHERE) ? "sphere" : "node";
}

/* ----------------------------------------------------------------------
   a system that was not solved ends the run, with the reason
------------------------------------------------------------------------- */

void FixDCMMotion::check_solution()
{
  using Result = dcm::FrictionResult;
  const bigint step = update->ntimestep;

  if (last.status == Result::SINGULAR) {
    const auto who = describe(last.zero_slot);
    error->all(FLERR,
               "{}: {} {} of cell {} has no friction at all at step {} (no ECM friction, no "
               "dashpot, no contact), its velocity is undetermined; set friction_ecm above 0 for "
               "its cell type, or gamma of its cortex",
               STYLE, kind_name(who[2]), who[0], who[1], step);
  }
  if (last.status == Result::NOT_FINITE) {
    int bad = -1;
    for (int s = system.nowned; s > 0; s--)
      for (int k = 0; k < 3; k++)
        if (!std::isfinite(rhs[STRIDE * (size_t) s + k])) bad = s;
    const auto who = describe(bad);
    if (!who.empty())
      error->all(FLERR,
                 "{}: force on {} {} of cell {} is not a finite number at step {}; reduce the "
                 "timestep or check the parameters of the force styles",
                 STYLE, kind_name(who[2]), who[0], who[1], step);
    error->all(FLERR,
               "{}: the friction system overflows at step {}: a friction coefficient is not a "
               "finite number or a force is far too large; check gamma, friction_normal, "
               "friction_tangential, friction_ecm and what pushes the cells",
               STYLE, step);
  }
  if (last.status == Result::NOT_CONVERGED)
    error->all(FLERR,
               "{}: no convergence at step {}: residual {:.3g} of the force after {} "
               "iterations, tolerance {}; raise maxiter or tolerance, and check that "
               "friction_ecm is above 0 where unbalanced forces act",
               STYLE, step, last.residual, last.iterations, solver.tolerance);
  if (last.status == Result::INDEFINITE)
    error->all(FLERR,
               "{}: friction matrix is not positive definite at step {} (residual {:.3g} after "
               "{} iterations): a cell or group of cells without ECM friction is driven by forces "
               "that do not add up to zero; set friction_ecm above 0, or floor above 0 if all its "
               "surface is in contact",
               STYLE, step, last.residual, last.iterations);
}

/* ----------------------------------------------------------------------
   what the displacement of a node or sphere is measured in: the mean edge of its own cell, its
   radius; for a body that is moved, which may be large, the mean edge of all cells if that is less
------------------------------------------------------------------------- */

double FixDCMMotion::scale_of_move(int i) const
{
  const double own = dcm->kind[i] == AtomVecDCM::NODE ? cell->mean_edge(cell->cell_of(i))
                                                      : atom->radius[i];
  const double mean = cell->mean_edge();
  return (atom->mask[i] & moving & ~groupbit) && mean > 0.0 ? std::min(own, mean) : own;
}

/* ----------------------------------------------------------------------
   the largest displacement of a step of length dt, and where it is
------------------------------------------------------------------------- */

void FixDCMMotion::find_move(double dt)
{
  struct {
    double ratio;
    int rank;
  } worst = {0.0, comm->me};
  slot_move = 0;
  int row = -1;    // nodes of a cell follow each other
  double scale = 0.0;
  for (int s = 1; s <= system.nowned; s++) {
    const double *u = &velocity[STRIDE * (size_t) s];
    const int i = unknowns.atom_of(s);
    if (dcm->kind[i] != AtomVecDCM::NODE || cell->cell_of(i) != row) scale = scale_of_move(i);
    row = dcm->kind[i] == AtomVecDCM::NODE ? cell->cell_of(i) : -1;
    const double move = dt * std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    if (move <= worst.ratio * scale || scale == 0.0) continue;
    worst.ratio = move / scale;
    slot_move = s;
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  largest_move = worst.ratio;
  if (comm->me != worst.rank) slot_move = 0;
}

/* ----------------------------------------------------------------------
   a step too large for the mesh ends the run before it is taken
------------------------------------------------------------------------- */

void FixDCMMotion::check_move()
{
  if (largest_move <= maxmove) return;

  const auto who = describe(slot_move > 0 ? slot_move : -1);
  double scale = slot_move > 0 ? scale_of_move(unknowns.atom_of(slot_move)) : 0.0;
  MPI_Allreduce(MPI_IN_PLACE, &scale, 1, MPI_DOUBLE, MPI_MAX, world);
  error->all(FLERR,
             "{}: {} {} of cell {} would move by {:.4g} at step {}, {:.3g} of its {} {:.4g}, "
             "the limit is maxmove {}; use a smaller timestep than {}{}, larger friction (gamma, "
             "friction_ecm), or raise maxmove",
             STYLE, kind_name(who[2]), who[0], who[1], largest_move * scale, update->ntimestep,
             largest_move, (who[2] == AtomVecDCM::SPHERE) ? "radius" : "mean edge length", scale,
             maxmove, shrinks ? given : update->dt,
             shrinks     ? fmt::format(" (it was tried down to {:.3g})", update->dt)
             : automatic ? ""
                         : " (or let such steps become shorter, maxmove X shrink)");
}

/* ---------------------------------------------------------------------- */

double FixDCMMotion::memory_usage()
{
  return system.memory_usage() + stiffness.memory_usage() + solver.memory_usage() +
         (double) sizeof(double) * (owner.capacity() + rhs.capacity() + velocity.capacity() +
                                    given_velocity.capacity() + load.capacity()) +
         (double) sizeof(int) * face_slots.capacity() + unknowns.memory_usage();
}
