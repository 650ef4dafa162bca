/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_face_graph.h"

#include "atom.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "neighbor.h"
#include "pair_dcm_contact.h"

#include <algorithm>

using namespace LAMMPS_NS;
using dcm::vec;

// ends of a line of sight above the centroids, in mean edges: clear of the faces' own planes, and
// well below the width of the gaps that free faces leave

static constexpr double HEIGHT = 0.05;

// faces in contact that stand closer than this, in units of the range h0 of adhesion, shut the
// space between them; cells that adhere stand up to h0 apart

static constexpr double SLIT = 1.5;

DCMFaceGraph::DCMFaceGraph(LAMMPS *lmp, const std::string &_asking) :
    Pointers(lmp), asking(_asking), cell(nullptr), contact(nullptr)
{
}

void DCMFaceGraph::init()
{
  cell = FixDCMCell::require(lmp, asking);
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (!contact)
    error->all(FLERR,
               "{}: there is no pair_style dcm/contact, whose contact areas tell which faces are "
               "free; add it to the deck",
               asking);
}

/* ----------------------------------------------------------------------
   what may cut a line from an owned face has its vertices within the range and its own diameter;
   all have moved by up to half a skin since the ghosts were chosen
------------------------------------------------------------------------- */

void DCMFaceGraph::check_cutoff(double range) const
{
  if (comm->nprocs == 1 && !domain->xperiodic && !domain->yperiodic && !domain->zperiodic) return;
  double reach = 0.0;
  for (int f = 0; f < cell->nowned(); f++)
    for (const int v : cell->faces()[f].v)
      reach = std::max(reach, (vec(atom->x[v]) - vec(atom->x[cell->faces()[f].atom])).norm());
  MPI_Allreduce(MPI_IN_PLACE, &reach, 1, MPI_DOUBLE, MPI_MAX, world);
  if (reach == 0.0) return;
  if (range == 0.0) range = RANGE * cell->mean_edge();
  const double need = range + 2.0 * reach + neighbor->skin, have = comm->get_comm_cutoff();
  if (have < need)
    error->all(FLERR,
               "{}: the ghost cutoff {:.4} is too small for range {:.4}, some faces across a gap "
               "would be missed; set 'comm_modify cutoff {:.4}' or reduce the range",
               asking, have, range, need);
}

/* ---------------------------------------------------------------------- */

void DCMFaceGraph::collect(double range)
{
  const double edge = cell->mean_edge();
  const int nall = atom->nlocal + atom->nghost;
  double **x = atom->x;
  index.assign(nall, -1);
  atom_of.clear();
  space.faces.clear();
  for (int f = 0; f < (int) cell->faces().size(); f++) {
    const auto &it = cell->faces()[f];
    if (!it.whole()) continue;    // too far away
    dcm::FloodFace face;
    for (int k = 0; k < 3; k++) {
      face.corner[k] = vec(x[it.v[k]]);
      face.vertex[k] = atom->tag[it.v[k]];
    }
    face.measure();
    face.tag = atom->tag[it.atom];
    face.cell = atom->molecule[it.atom];
    face.own = it.atom < atom->nlocal;
    index[it.atom] = (int) space.faces.size();
    atom_of.push_back(it.atom);
    space.faces.push_back(face);
  }
  space.sort({range == 0.0 ? RANGE * edge : range, HEIGHT * edge, SLIT * contact->h0()});
}

int DCMFaceGraph::opposite(int i) const
{
  if (index[i] < 0) return -1;
  const int f = space.opposite(index[i]);
  return f < 0 ? -1 : atom_of[f];
}

/* ----------------------------------------------------------------------
   all processes sort the same faces and join the same links
------------------------------------------------------------------------- */

void DCMFaceGraph::build(const std::vector<int> &state, bool linked)
{
  std::vector<Face> mine;
  for (int f = 0; f < (int) space.faces.size(); f++) {
    auto &it = space.faces[f];
    const int i = atom_of[f];
    it.node = (state[i] & NODE) != 0;
    it.shut = (state[i] & SHUT) != 0;
    if (!it.node || !it.own) continue;
    Face face = {};
    face.tag = atom->tag[i];
    face.molecule = atom->molecule[i];
    face.area = cell->area(cell->face_of(i));
    vec(face.mid) = it.mid;
    face.state = state[i];
    mine.push_back(face);
  }
  all = dcm_allgather(mine, world);
  std::sort(all.begin(), all.end(), [](const Face &a, const Face &b) {
    return a.tag < b.tag;
  });

  dcm::Components components((int) all.size());
  if (linked) {
    space.find_links(links);
    for (const auto &link : dcm_allgather(links, world))
      components.link(place_of((tagint) link[0]), place_of((tagint) link[1]));
  }
  std::vector<int> set;
  number = components.number(set);
  for (size_t n = 0; n < all.size(); n++) all[n].set = set[n];
}

int DCMFaceGraph::place_of(tagint tag) const
{
  const auto found = std::lower_bound(all.begin(), all.end(), tag, [](const Face &a, tagint b) {
    return a.tag < b;
  });
  return found == all.end() || found->tag != tag ? -1 : (int) (found - all.begin());
}

const DCMFaceGraph::Face *DCMFaceGraph::find(tagint tag) const
{
  const int n = place_of(tag);
  return n < 0 ? nullptr : &all[n];
}

double DCMFaceGraph::memory_usage() const
{
  return (double) space.faces.capacity() * sizeof(dcm::FloodFace) +
         (double) all.capacity() * sizeof(Face) + (double) links.capacity() * 2 * sizeof(tagint);
}
