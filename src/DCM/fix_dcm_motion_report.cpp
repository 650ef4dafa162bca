/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// What fix dcm/motion tells: its vector, and how a run went.

#include "fix_dcm_motion.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "fix_dcm_cell.h"
#include "fmt/format.h"
#include "timer.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   the largest move of the steps that were taken, when one is: the process that has the node knows
   which it is
------------------------------------------------------------------------- */

void FixDCMMotion::note_move()
{
  if (!(largest_move > most.ratio)) return;
  most = Most();
  most.ratio = largest_move;
  most.step = update->ntimestep;
  if (slot_move <= 0) return;
  const int i = unknowns.atom_of(slot_move);
  most.move = largest_move * scale_of_move(i);
  most.tag = atom->tag[i];
  most.molecule = atom->molecule[i];
  most.kind = dcm->kind[i];
}

/* ---------------------------------------------------------------------- */

// of the limit, from which on there is advice

static constexpr double NEAR_LIMIT = 0.8;

std::vector<DCMRole::Note> FixDCMMotion::report()
{
  if (!(most.ratio > 0.0)) return {};
  double move = most.move;
  tagint who[3] = {most.tag, most.molecule, most.kind};    // 0 where it is not known
  MPI_Allreduce(MPI_IN_PLACE, &move, 1, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(MPI_IN_PLACE, who, 3, MPI_LMP_TAGINT, MPI_MAX, world);
  const bool sphere = who[2] == AtomVecDCM::SPHERE;
  Note note;
  note.text = fmt::format("largest move {:.3g}: {} {} of cell {} at step {}, {:.2g} of its {}, "
                          "maxmove is {:.3g}",
                          move, sphere ? "sphere" : "node", who[0], who[1], most.step, most.ratio,
                          sphere ? "radius" : "mean edge length", maxmove);
  if (most.ratio > NEAR_LIMIT * maxmove && !automatic && !shrinks)
    note.advice = "a little more ends the run: a smaller timestep, 'maxmove X shrink' or 'dt auto' "
                  "of fix dcm/motion";
  return {note};
}

/* ----------------------------------------------------------------------
   wall time to the end of the run, if it goes on as fast as so far: in time up to where the fix
ends it, or in steps; 0 before the first step
------------------------------------------------------------------------- */

double FixDCMMotion::seconds_left() const
{
  const bigint steps = update->ntimestep - update->firststep;
  if (steps <= 0 || update->setupflag) return 0.0;
  const double now = cell->cells().time(), passed = now - began;
  double share = (double) (update->laststep - update->ntimestep) / (double) steps;
  if (passed > 0.0) share = std::min(share, (stop - now) / passed);
  return std::max(0.0, share) * timer->elapsed(Timer::TOTAL);
}

/* ----------------------------------------------------------------------
   doc page fix_dcm_motion lists the entries; times are means over processes
------------------------------------------------------------------------- */

double FixDCMMotion::compute_vector(int n)
{
  double value = 0.0;
  switch (n) {
    case 0:
      return last.residual;
    case 1:
      return last.iterations;
    case 2:
      return (solves > 0.0) ? iterations / solves : 0.0;
    case 3:
      return largest_move;
    case 4:
      value = seconds_assembly / comm->nprocs;
      break;
    case 5:
      value = seconds_solve / comm->nprocs;
      break;
    case 6:
      value = (messages.seconds - messages_start) / comm->nprocs;
      break;
    case 7:
      value = system.nowned;
      break;
    case 8:
      return update->dt;
    case 9:
      return error_of_step;
    case 10:
      return rejected;
    case 11:
      return cell->cells().time();
    case 12:
      value = seconds_left() / comm->nprocs;
      break;
    default:
      return 0.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, world);
  return value;
}

std::string FixDCMMotion::work()
{
  auto text = fmt::format("{:.0f} solves of {:.1f} iterations", solves,
                          solves > 0.0 ? iterations / solves : 0.0);
  if (rejected > 0.0) text += fmt::format(", {:.0f} of them again, shorter", rejected);
  return text;
}
