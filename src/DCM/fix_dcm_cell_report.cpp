/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// What fix dcm/cell tells at the end of a run: neighbor lists, and how good the triangles are.

#include "fix_dcm_cell.h"

#include "atom.h"
#include "comm.h"
#include "fmt/format.h"
#include "law/mesh.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using dcm::vec;

/* ----------------------------------------------------------------------
   why there is a new list: as Neighbor::decide() has found, where a fix does not change that before
------------------------------------------------------------------------- */

void FixDCMCell::count_list()
{
  if (update->setupflag) return;
  nlists++;
  const bigint now = update->ntimestep;
  if (output->restart_flag && output->next_restart == now) {
    lists_for["restart files"]++;
    return;
  }
  for (const auto *const fix : std::vector<Fix *>(modify->get_fix_list()))
    if (fix->force_reneighbor && fix->next_reneighbor == now) {
      lists_for[std::string("fix ") + fix->id]++;
      return;
    }
}

/* ---------------------------------------------------------------------- */

// new lists for distance in more than this part of the steps take a good part of a run

static constexpr double OFTEN = 0.2;
static constexpr bigint FEW = 20;

DCMRole::Note FixDCMCell::report_lists() const
{
  const bigint steps = update->ntimestep - update->firststep;
  Note note;
  note.text = fmt::format("new neighbor lists: {} in {} steps", nlists, steps);
  bigint others = 0;
  std::string why;
  for (const auto &[name, n] : lists_for) {
    why += fmt::format(", {} for {}", n, name);
    others += n;
  }
  const bigint moved = nlists - others;
  if (moved > 0)
    note.text += fmt::format(", {} {}", moved,
                             neighbor->dist_check ? "since atoms had moved by half the skin"
                                                  : "as neigh_modify check no says");
  note.text += fmt::format("{}; dangerous {}", why, neighbor->ndanger);
  if (neighbor->ndanger > 0)
    note.advice = "atoms may have come closer than the list knew: 'neigh_modify every 1 delay 0 "
                  "check yes', a larger skin (command neighbor) or a smaller timestep";
  else if (neighbor->dist_check && moved > FEW && (double) moved > OFTEN * (double) steps)
    note.advice = "a larger skin (command neighbor) makes them rarer, as long as the lists do not "
                  "get too long";
  return note;
}

/* ----------------------------------------------------------------------
   the worst triangle of all cells, as the run leaves it
------------------------------------------------------------------------- */

// below which a triangle is a sliver; tools/lammps_dcm says the same of meshes

static constexpr double POOR_QUALITY = 0.2;

void FixDCMCell::report_faces(std::vector<Note> &notes) const
{
  struct {
    double quality;
    int rank;
  } worst = {2.0, comm->me};
  tagint who[2] = {0, 0};
  double **x = atom->x;
  for (int f = 0; f < nowned_faces; f++) {
    const Face &face = face_list[f];
    const double quality =
        dcm::face_quality(vec(x[face.v[0]]), vec(x[face.v[1]]), vec(x[face.v[2]]));
    if (quality >= worst.quality) continue;
    worst.quality = quality;
    who[0] = atom->tag[face.atom];
    who[1] = atom->molecule[face.atom];
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);
  if (worst.quality > 1.5) return;    // no faces at all
  MPI_Bcast(who, 2, MPI_LMP_TAGINT, worst.rank, world);
  Note note;
  note.text = fmt::format("worst triangle: face {} of cell {}, quality {:.2g} (1: equilateral)",
                          who[0], who[1], worst.quality);
  if (worst.quality < POOR_QUALITY)
    note.advice = "slivers take short steps and hide how the cell bends: look at the cell "
                  "('lammps_dcm quality'), make its cortex stiffer, its load smaller or its mesh "
                  "finer";
  notes.push_back(note);
}

std::vector<DCMRole::Note> FixDCMCell::report()
{
  std::vector<Note> notes = {report_lists()};
  report_faces(notes);
  return notes;
}
