/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// fix dcm/tracer: what has happened to tracers; restart

#include "fix_dcm_tracer.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_record.h"

using namespace LAMMPS_NS;

static const char STYLE[] = "Fix dcm/tracer";
static constexpr int RECORD = 1;    // version of the restart record

/* ----------------------------------------------------------------------
   what has happened, on all ranks and in earlier runs
------------------------------------------------------------------------- */

dcm::TracerCounts FixDCMTracer::summed() const
{
  dcm::TracerCounts all = before;
  dcm::TracerCounts sum = walk.count;
  static_assert(sizeof(sum) % sizeof(std::int64_t) == 0, "counts only");
  MPI_Allreduce(MPI_IN_PLACE, &sum, sizeof(sum) / sizeof(std::int64_t), MPI_INT64_T, MPI_SUM,
                world);
  all.add(sum);
  return all;
}

std::int64_t FixDCMTracer::summed_deleted() const
{
  std::int64_t sum = deleted;
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_INT64_T, MPI_SUM, world);
  return sum + deleted_before;
}

/* ----------------------------------------------------------------------
   inside, outside, exits, swept, caught now, rejected, capped, deleted, blocked
------------------------------------------------------------------------- */

double FixDCMTracer::compute_vector(int n)
{
  enum { INSIDE, OUTSIDE, EXITS, SWEPT, CAUGHT, REJECTED, CAPPED, DELETED, BLOCKED };
  if (n == INSIDE || n == OUTSIDE || n == CAUGHT) {
    bigint sum = 0;
    for (int i = 0; i < atom->nlocal; i++) {
      if (dcm->kind[i] != AtomVecDCM::TRACER) continue;
      const tagint *const state = dcm->vertex[i];
      if (n == CAUGHT)
        sum += state[AtomVecDCM::HOST] != 0;
      else
        sum += (state[AtomVecDCM::HOME] != 0) == (n == INSIDE);
    }
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_LMP_BIGINT, MPI_SUM, world);
    return (double) sum;
  }
  if (n == DELETED) return (double) summed_deleted();
  const auto all = summed();
  switch (n) {
    case EXITS:
      return (double) all.exits;
    case SWEPT:
      return (double) all.swept;
    case REJECTED:
      return (double) all.rejected;
    case CAPPED:
      return (double) all.capped;
    default:
      return (double) all.blocked;
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMTracer::write_restart(FILE *fp)
{
  const auto all = summed();
  const auto all_deleted = summed_deleted();
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(kept);
  record.put(all);
  record.put(all_deleted);
  record.write(fp);
}

void FixDCMTracer::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(kept);
  record.get(before);
  record.get(deleted_before);
  restored = true;
}

double FixDCMTracer::memory_usage()
{
  return voxels.memory_usage() + faces.memory_usage() +
         (double) sizeof(int) * (mine.capacity() + shut.capacity()) +
         (double) sizeof(double) * last_place.capacity();
}
