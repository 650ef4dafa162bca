/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// fix dcm/motion: what is known of the end of a step before it is taken, and how long it is

#include "fix_dcm_motion.h"

#include "atom.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_record.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "law/volume.h"
#include "force.h"
#include "modify.h"
#include "output.h"
#include "pair.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

using namespace LAMMPS_NS;
using dcm::STRIDE;

static const char STYLE[] = "Fix dcm/motion";
static constexpr int RECORD = 3;    // version of the restart record

// the steps of dt auto, where the deck does not say: from the timestep of the deck on, up to this
// times as much

static constexpr double LONGEST = 60.0;

// a step in which a node would move too far may be this much shorter than the shortest one

static constexpr double LEAST = 1.0e-3;

/* ----------------------------------------------------------------------
   dt auto tol X [min A] [max B]
------------------------------------------------------------------------- */

void FixDCMMotion::parse_step(DCMArgs &args)
{
  args.choose({"auto"});
  automatic = true;
  given = update->dt;
  while (true) {
    if (args.word("tol"))
      control.tolerance = args.number(DCMArgs::POSITIVE, "dt auto tol");
    else if (args.word("min"))
      least = args.number(DCMArgs::POSITIVE, "dt auto min");
    else if (args.word("max"))
      longest = args.number(DCMArgs::POSITIVE, "dt auto max");
    else
      break;
  }
  find_limits();
}

void FixDCMMotion::find_limits()
{
  if (shrinks) {
    control.least = LEAST * given;
    control.longest = given;
    return;
  }
  control.least = least > 0.0 ? least : longest > 0.0 ? std::min(given, longest) : given;
  control.longest = longest > 0.0 ? longest : LONGEST * control.least;
  if (control.least > control.longest)
    error->all(FLERR, "{}: dt auto min is {}, above max {}", STYLE, control.least, control.longest);
}

// the timestep of the deck comes back

FixDCMMotion::~FixDCMMotion()
{
  if (!(automatic || shrinks) || !(step > 0.0)) return;
  update->update_time();
  update->dt = given;
}

/* ----------------------------------------------------------------------
   forces of the rest state that cells will have at the end of a step of length dt: on top of those
   of assemble()
------------------------------------------------------------------------- */

void FixDCMMotion::look_ahead(double dt)
{
  if (!ahead_forces.empty())    // of another dt
    for (size_t n = 0; n < STRIDE * ((size_t) system.nowned + 1); n++) rhs[n] -= ahead_forces[n];
  ahead_forces.clear();

  ahead.assign(cell->cells().all().size(), RestAhead());
  bool any = false;
  for (auto *const role : roles) any |= role->rest_ahead(dt, ahead);
  if (!any) return;
  ahead_forces.assign(STRIDE * ((size_t) system.nall + 1), 0.0);
  for (auto *const role : roles) role->add_ahead(ahead, ahead_forces, unknowns);
  for (int k = 0; k < STRIDE; k++) ahead_forces[k] = 0.0;    // slot 0 is fixed
  messages.reverse(ahead_forces.data(), STRIDE, 3);
  for (size_t n = 0; n < STRIDE * ((size_t) system.nowned + 1); n++) rhs[n] += ahead_forces[n];
}

/* ----------------------------------------------------------------------
   length and velocities of the coming step. It is solved before it is taken: one that is too long
   is solved again with a shorter one
------------------------------------------------------------------------- */

void FixDCMMotion::choose_step(double keep)
{
  // a run that goes on does so with the step it had, unless it is to end before

  if (keep > 0.0 && wanted > 0.0) {
    const double dt = until_event(step);
    if (std::fabs(dt - step) <= 1e-9 * step && !solve_system(step, keep)) {
      begin_step(step);
      return;
    }
  }

  before = velocity;
  double h = wanted > 0.0 ? wanted : control.round_down(update->dt), dt;
  while (true) {
    dt = until_event(h);
    solve_system(dt, 0.0);
    error_of_step = 0.5 * dt * change_of_velocity();
    const bool near = largest_move <= maxmove || dt <= LEAST * control.least;
    if (near && control.accepts(dt, error_of_step)) break;
    rejected += 1.0;
    const double shorter = std::min(0.8 * dt, control.next(dt, error_of_step));
    h = control.round_down(std::max(control.least, shorter));

    // the error does not make a step shorter than `min`, a node that moves too far does

    if (!near && h * largest_move > dt * maxmove)
      h = std::max(LEAST * control.least, 0.8 * dt * maxmove / largest_move);
  }
  if (half.due(dt)) dt = check_half(dt);
  const bool cut = dt < 0.999 * h && error_of_step <= control.allowed(dt);    // by an event
  if (!cut) h = control.next(dt, error_of_step);
  wanted = std::max(control.least, std::min(h, control.round_down(half.limit)));
  begin_step(dt);
}

/* ----------------------------------------------------------------------
   maxmove X shrink: a step of the deck's length, or a shorter one if a node would move too far in
   it. Steps that follow one that was shortened become longer by a quarter of an octave each, as
   long as no node moves too far. The lengths are on a grid, so that round-off does not change one
------------------------------------------------------------------------- */

void FixDCMMotion::shrink_step(double keep)
{
  // a run that goes on does so with the step it had

  if (keep > 0.0 && step > 0.0 && !solve_system(step, keep) && largest_move <= maxmove) {
    begin_step(step);
    return;
  }

  double h = wanted > 0.0 ? wanted : given;
  while (true) {
    solve_system(h, 0.0);
    if (largest_move <= maxmove || control.shortest(h)) break;
    rejected += 1.0;
    h = control.round_down(0.8 * h * maxmove / largest_move);
  }
  wanted = std::min(given, h * std::exp2(0.25));
  begin_step(h);
}

void FixDCMMotion::count_short()
{
  if (update->dt > (1.0 - 1e-9) * given) return;
  if (nshort == 0.0 && comm->me == 0)
    error->warning(FLERR,
                   "{}: from step {} on, steps are shorter than the timestep {} where a node would "
                   "move by more than maxmove {}; count the time with the keyword time",
                   STYLE, update->ntimestep, given, maxmove);
  shortest = nshort == 0.0 ? update->dt : std::min(shortest, update->dt);
  nshort += 1.0;
}

void FixDCMMotion::tell_short()
{
  if (nshort == 0.0 || comm->me != 0) return;
  utils::logmesg(lmp,
                 "{}: {:.0f} of {} steps of this run were shorter than the timestep {}, the "
                 "shortest {:.4g}\n",
                 STYLE, nshort, update->ntimestep - update->firststep, given, shortest);
}

/* ----------------------------------------------------------------------
   length of a step that was to be h, so that it does not pass over an event
------------------------------------------------------------------------- */

double FixDCMMotion::until_event(double h)
{
  const double now = cell->cells().time();
  double first = std::numeric_limits<double>::infinity();
  for (auto *const role : roles) {
    first = std::min(first, role->next_event());
    h = std::min(h, role->longest_step());
  }
  for (int i = 0; i < output->ndump; i++) {    // dump_modify every/time
    if (output->mode_dump[i] != 1) continue;
    double left = output->next_time_dump[i] - now;
    if (left < 1e-6 * h) left += output->every_time_dump[i];    // it is written in this step
    if (left >= 1e-6 * h) first = std::min(first, left);
  }
  const double dt = control.until(h, first), left = stop - now;
  return left <= dt * (1.0 + 1e-9) && left > 1e-9 * dt ? left : dt;
}

/* ----------------------------------------------------------------------
   a last step is known one step ahead, as thermo output needs it
------------------------------------------------------------------------- */

void FixDCMMotion::begin_step(double dt)
{
  for (int i = 0; i < output->ndump; i++)    // dumps by time do not see to that themselves
    if (output->mode_dump[i] == 1 && output->next_dump[i] == update->ntimestep)
      modify->clearstep_compute();
  set_step(dt);
  const double left = stop - cell->cells().time();
  if (left > dt * (1.0 + 1e-9)) return;
  if (left <= 1e-9 * dt) {    // the last step has been taken
    timer->force_timeout();
    ended = true;
    return;
  }
  const bigint last_step = update->ntimestep + 1;
  update->laststep = last_step;
  output->next_thermo = std::min(output->next_thermo, last_step);
  output->next = std::min(output->next, last_step);
  modify->addstep_compute_all(last_step);
}

/* ----------------------------------------------------------------------
   as fix dt/reset does it
------------------------------------------------------------------------- */

void FixDCMMotion::set_step(double dt)
{
  step = dt;
  if (dt == update->dt) return;
  update->update_time();
  update->dt = dt;
  update->dt_default = 0;
  if (force->pair) force->pair->reset_dt();
  for (auto *const fix : std::vector<Fix *>(modify->get_fix_list())) fix->reset_dt();
  output->reset_dt();
}

void FixDCMMotion::post_run()
{
  movable = count_movable();
  tell_short();
  if (ended) timer->reset_timeout();
  ended = false;
}

/* ----------------------------------------------------------------------
   fix_modify ID stop T
------------------------------------------------------------------------- */

int FixDCMMotion::modify_param(int narg, char **arg)
{
  if (strcmp(arg[0], "stop") != 0) return 0;
  if (narg < 2) utils::missing_cmd_args(FLERR, "fix_modify stop", error);
  stop = DCMArgs::number(lmp, STYLE, "fix_modify stop", arg[1], DCMArgs::POSITIVE);
  return 2;
}

/* ---------------------------------------------------------------------- */

void FixDCMMotion::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(given);
  record.put(step);
  record.put(wanted);
  record.put(error_of_step);
  record.put(radius);
  record.put(half.limit);
  record.put(half.checked);
  record.put(half.since);
  record.put(update->atime);
  record.put(update->atimestep);
  record.write(fp);
}

void FixDCMMotion::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(given);
  record.get(step);
  record.get(wanted);
  record.get(error_of_step);
  record.get(radius);
  record.get(half.limit);
  record.get(half.checked);
  record.get(half.since);
  record.get(read_time);
  record.get(read_timestep);
  find_limits();
}

/* ----------------------------------------------------------------------
   the time is counted from the last change of the timestep. A command timestep behind read_restart
   counts it from there, which is the same but for the last digit, and that for events and variables
------------------------------------------------------------------------- */

void FixDCMMotion::take_time()
{
  if (read_timestep < 0) return;
  const double now = cell->cells().time();
  const double read = read_time + (double) (update->ntimestep - read_timestep) * update->dt;
  if (std::fabs(now - read) <= 1e-12 * std::fabs(now)) {
    update->atime = read_time;
    update->atimestep = read_timestep;
  }
  read_timestep = -1;
}
