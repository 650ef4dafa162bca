/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
// Adjacency and regions of fix dcm/cell: the faces around nodes and edges, and what region of the
// surface a face belongs to.

#include "fix_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "error.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   a node may have several images on a process, and so may a face: both are known by the copy that
   the atom map gives, and a face counts once, the owned one first
------------------------------------------------------------------------- */

void FixDCMCell::build_adjacency()
{
  const int nall = atom->nlocal + atom->nghost;
  auto visit = [this](auto &&use) {
    for (int f = 0; f < (int) face_list.size(); f++) {
      const Face &face = face_list[f];
      if (atom->map(atom->tag[face.atom]) != face.atom) continue;
      for (const int v : face.v)
        if (v >= 0) use(atom->map(atom->tag[v]), f);
    }
  };
  first_around.assign(nall + 1, 0);
  visit([this](int node, int) {
    first_around[node + 1]++;
  });
  for (int i = 0; i < nall; i++) first_around[i + 1] += first_around[i];
  around.resize(first_around[nall]);
  std::vector<int> fill(first_around.begin(), first_around.end() - 1);
  visit([&](int node, int f) {
    around[fill[node]++] = f;
  });
  for (int i = 0; i < nall; i++)
    std::sort(around.begin() + first_around[i], around.begin() + first_around[i + 1],
              [this](int f, int g) {
                return atom->tag[face_list[f].atom] < atom->tag[face_list[g].atom];
              });
}

std::vector<int> FixDCMCell::faces_of_node(int i) const
{
  const int node = atom->map(atom->tag[i]);
  return {around.begin() + first_around[node], around.begin() + first_around[node + 1]};
}

std::array<int, 2> FixDCMCell::faces_of_edge(int i, int j) const
{
  std::array<int, 2> both = {-1, -1};
  const int node = atom->map(atom->tag[i]);
  const tagint other = atom->tag[j];
  int n = 0;
  for (int m = first_around[node]; m < first_around[node + 1] && n < 2; m++)
    for (const int v : face_list[around[m]].v)
      if (v >= 0 && atom->tag[v] == other && n < 2) both[n++] = around[m];
  return both;
}

/* ----------------------------------------------------------------------
   ghosts get regions with their face when they are made; what changes later is sent here
------------------------------------------------------------------------- */

void FixDCMCell::set_region(int f, int region)
{
  if (region < 0 || region >= AtomVecDCM::NREGION)
    error->one(FLERR, "Fix dcm/cell: region {} of face {} does not exist; they are 0 to {}", region,
               atom->tag[face_list[f].atom], AtomVecDCM::NREGION - 1);
  dcm->region[face_list[f].atom] = region;
}

void FixDCMCell::update_regions()
{
  commflag = REGION;
  comm->forward_comm(this, 1);
}
