/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_cell_change.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "domain.h"
#include "error.h"
#include "irregular.h"
#include "update.h"

#include <algorithm>
#include <unordered_map>

using namespace LAMMPS_NS;
using dcm::Vec3;

DCMCellChange::DCMCellChange(LAMMPS *lmp, const std::string &_asking) :
    Pointers(lmp), asking(_asking), dcm(AtomVecDCM::require(lmp, _asking))
{
}

void DCMCellChange::add(const DCMCellSurgery::Cell &before, const dcm::Remeshed &after)
{
  Change it;
  it.before = before;
  it.after = after;
  it.hinges = dcm::hinges(after.cell.mesh);
  share_edges(it);
  changes.push_back(std::move(it));
}

/* ----------------------------------------------------------------------
   an edge that was there is stored where it was. A new one goes to the end that
   stores fewer; if both are full, edges are handed on along a path to a node that is not. In a
   closed mesh of n nodes there are 3n - 6 edges, and three slots a node are always enough.
------------------------------------------------------------------------- */

void DCMCellChange::share_edges(Change &it) const
{
  const size_t most = std::min(atom->bond_per_atom, atom->dihedral_per_atom);
  const auto old = dcm::edges(it.before.mesh);
  const int nnodes = (int) it.before.mesh.nodes.size(), nedges = (int) it.hinges.size();
  std::vector<int> owner(nedges, -1);
  it.stored.resize(nnodes);
  for (int e = 0; e < nedges; e++) {
    const std::array<int, 2> ends = {it.hinges[e][1], it.hinges[e][2]};
    const auto at = std::lower_bound(old.begin(), old.end(), ends);
    if (at == old.end() || *at != ends) continue;
    owner[e] = ends[it.before.keeper[at - old.begin()]];
    it.stored[owner[e]].push_back(e);
  }
  for (int e = 0; e < nedges; e++) {
    if (owner[e] >= 0) continue;
    const int a = it.hinges[e][1], b = it.hinges[e][2];
    const int from = it.stored[a].size() <= it.stored[b].size() ? a : b;

    // breadth first: by which edge a node was reached

    std::vector<int> reached(nnodes, -1), queue = {from};
    int free = -1;
    for (size_t q = 0; q < queue.size() && free < 0; q++) {
      const int n = queue[q];
      if (it.stored[n].size() < most) free = n;
      for (const int s : it.stored[n]) {
        const int other = it.hinges[s][1] == n ? it.hinges[s][2] : it.hinges[s][1];
        if (other == from || reached[other] >= 0) continue;
        reached[other] = s;
        queue.push_back(other);
      }
    }
    if (free < 0)
      error->all(FLERR,
                 "{}: cell {} has no bond slot left at step {}, of {} per atom; add "
                 "'extra/bond/per/atom 3 extra/dihedral/per/atom 3' to create_box or read_data",
                 asking, it.before.molecule, update->ntimestep, most);
    while (free != from) {
      const int s = reached[free];
      const int last = it.hinges[s][1] == free ? it.hinges[s][2] : it.hinges[s][1];
      auto &list = it.stored[last];
      list.erase(std::find(list.begin(), list.end(), s));
      it.stored[free].push_back(s);
      owner[s] = free;
      free = last;
    }
    owner[e] = from;
    it.stored[from].push_back(e);
  }
}

/* ---------------------------------------------------------------------- */

void DCMCellChange::apply()
{
  struct Place {
    size_t change;
    int node, face;
  };
  std::unordered_map<tagint, Place> where;
  for (size_t c = 0; c < changes.size(); c++) {
    const auto &cell = changes[c].before;
    for (size_t n = 0; n < cell.node_tag.size(); n++) where[cell.node_tag[n]] = {c, (int) n, -1};
    for (size_t f = 0; f < cell.face_tag.size(); f++) where[cell.face_tag[f]] = {c, -1, (int) f};
  }

  // ghosts are gone from here until the exchange that follows

  if (atom->map_style != Atom::MAP_NONE) atom->map_clear();
  atom->nghost = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    const auto found = where.find(atom->tag[i]);
    if (found == where.end()) continue;
    const Place &it = found->second;
    if (it.node >= 0) write_node(i, changes[it.change], it.node);
    if (it.face >= 0) write_face(i, changes[it.change], it.face);
  }
  changes.clear();

  // an atom may now lie beyond the processes that an exchange reaches

  if (domain->triclinic) domain->x2lamda(atom->nlocal);
  Irregular irregular(lmp);
  if (irregular.migrate_check()) irregular.migrate_atoms();
  if (domain->triclinic) domain->lamda2x(atom->nlocal);
  if (atom->map_style != Atom::MAP_NONE) {
    atom->map_init();
    atom->map_set();
  }
}

/* ---------------------------------------------------------------------- */

void DCMCellChange::place(int i, const Vec3 &x)
{
  for (int k = 0; k < 3; k++) atom->x[i][k] = x[k];
  atom->image[i] =
      ((imageint) IMGMAX << IMG2BITS) | ((imageint) IMGMAX << IMGBITS) | (imageint) IMGMAX;
  domain->remap(atom->x[i], atom->image[i]);
}

void DCMCellChange::write_node(int i, const Change &it, int node)
{
  const auto &cell = it.before;
  const auto &now = it.after.cell;
  if (it.after.node_changed[node]) {
    place(i, now.mesh.nodes[node]);
    for (int k = 0; k < 3; k++) atom->v[i][k] = now.v[node][k];
  }

  const auto &edges = it.stored[node];
  const bool hinged = cell.types.dihedral > 0;
  atom->num_bond[i] = (int) edges.size();
  atom->num_dihedral[i] = hinged ? (int) edges.size() : 0;
  for (size_t m = 0; m < edges.size(); m++) {
    std::array<int, 4> n = it.hinges[edges[m]];
    if (n[1] != node) n = {n[3], n[2], n[1], n[0]};    // the same hinge from the other end
    atom->bond_type[i][m] = cell.types.bond;
    atom->bond_atom[i][m] = cell.node_tag[n[2]];
    dcm->l0[i][m] = now.l0[edges[m]];
    if (!hinged) continue;
    atom->dihedral_type[i][m] = cell.types.dihedral;
    atom->dihedral_atom1[i][m] = cell.node_tag[n[0]];
    atom->dihedral_atom2[i][m] = cell.node_tag[n[1]];
    atom->dihedral_atom3[i][m] = cell.node_tag[n[2]];
    atom->dihedral_atom4[i][m] = cell.node_tag[n[3]];
    dcm->theta0[i][m] = now.theta0[edges[m]];
  }
  dcm->bonded[i] = AtomVecDCM::stamp(atom, i);
}

void DCMCellChange::write_face(int i, const Change &it, int face)
{
  if (!it.after.face_changed[face]) return;
  const auto &now = it.after.cell;
  const auto &v = now.mesh.faces[face];
  const Vec3 mid = (now.mesh.nodes[v[0]] + now.mesh.nodes[v[1]] + now.mesh.nodes[v[2]]) / 3.0;
  place(i, mid);
  dcm->region[i] = now.region[face];
  atom->radius[i] = 0.0;
  for (int k = 0; k < 3; k++) {
    dcm->vertex[i][k] = it.before.node_tag[v[k]] - atom->tag[i];
    atom->radius[i] = std::max(atom->radius[i], (now.mesh.nodes[v[k]] - mid).norm());
  }
}
