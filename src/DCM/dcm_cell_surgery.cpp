/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_cell_surgery.h"

#include "atom.h"
#include "atom_vec.h"
#include "atom_vec_dcm.h"
#include "bond_dcm_cortex.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_compat.h"
#include "dihedral_dcm_bend.h"
#include "domain.h"
#include "dump.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "output.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <map>

using namespace LAMMPS_NS;
using dcm::Vec3;

namespace {

// what one atom contributes to a gathered cell

struct Part {
  tagint molecule, tag, vertex[3];
  int kind, type, mask, region;
  double x[3], v[3], size;    // size: rest volume of a center, radius of a sphere
};

struct Edge {
  tagint molecule, a, b;
  int bond, dihedral, keeper;
  double l0, theta0;
};

// A dump sorted by atom ID puts atoms at their places without sorting as long as their number is
// that of the run's first step. It trusts the IDs to be those of that step, too, and would write
// beyond its arrays (LAMMPS makes an exception for fix gcmc only).

struct SortedDump : Dump {
  static void look_again(Dump *dump) { dump->*(&SortedDump::reorderflag) = 0; }
};

bool holds(const std::vector<tagint> &sorted, tagint value)
{
  return std::binary_search(sorted.begin(), sorted.end(), value);
}

}    // namespace

/* ---------------------------------------------------------------------- */

DCMCellSurgery::DCMCellSurgery(LAMMPS *lmp, const std::string &_asking) :
    Pointers(lmp), builder(lmp, _asking, false), asking(_asking),
    dcm(AtomVecDCM::require(lmp, _asking))
{
}

/* ----------------------------------------------------------------------
   shape and rest state of some cells, in the order of their tags: independent of
   where their atoms live
------------------------------------------------------------------------- */

std::vector<DCMCellSurgery::Cell> DCMCellSurgery::gather(const std::vector<tagint> &molecules) const
{
  std::vector<Part> mine;
  std::vector<Edge> my_edges;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!holds(molecules, atom->molecule[i])) continue;
    Part part = {};
    part.molecule = atom->molecule[i];
    part.tag = atom->tag[i];
    part.kind = dcm->kind[i];
    part.type = atom->type[i];
    part.mask = atom->mask[i];
    part.region = dcm->region[i];
    domain->unmap(atom->x[i], atom->image[i], part.x);
    for (int k = 0; k < 3; k++) {
      part.v[k] = atom->v[i][k];
      part.vertex[k] = atom->tag[i] + dcm->vertex[i][k];
    }
    part.size = part.kind == AtomVecDCM::CENTER ? dcm->volume0[i] : atom->radius[i];
    mine.push_back(part);
    for (int m = 0; m < atom->num_bond[i]; m++) {
      const tagint a = atom->tag[i], b = atom->bond_atom[i][m];
      const int dihedral = atom->num_dihedral[i] ? atom->dihedral_type[i][0] : 0;
      double theta0 = AtomVecDCM::UNSET_THETA0;
      for (int n = 0; n < atom->num_dihedral[i]; n++)
        if (atom->dihedral_atom2[i][n] == a && atom->dihedral_atom3[i][n] == b)
          theta0 = dcm->theta0[i][n];
      my_edges.push_back({atom->molecule[i], std::min(a, b), std::max(a, b), atom->bond_type[i][m],
                          dihedral, a < b ? 0 : 1, dcm->l0[i][m], theta0});
    }
  }
  auto parts = dcm_allgather(mine, world);
  auto edges = dcm_allgather(my_edges, world);
  std::sort(parts.begin(), parts.end(), [](const Part &a, const Part &b) {
    return a.molecule != b.molecule ? a.molecule < b.molecule : a.tag < b.tag;
  });
  std::sort(edges.begin(), edges.end(), [](const Edge &a, const Edge &b) {
    if (a.molecule != b.molecule) return a.molecule < b.molecule;
    return a.a != b.a ? a.a < b.a : a.b < b.b;
  });

  std::vector<Cell> cells;
  size_t p = 0, e = 0;
  for (tagint molecule : molecules) {
    Cell cell;
    cell.molecule = molecule;
    std::map<tagint, int> node;
    std::vector<const Part *> faces;
    const Part *center = nullptr;    // image flags may be missing or wrong: the others are near it
    for (size_t q = p; q < parts.size() && parts[q].molecule == molecule; q++)
      if (parts[q].kind == AtomVecDCM::CENTER) center = &parts[q];
    for (; p < parts.size() && parts[p].molecule == molecule; p++) {
      const Part &part = parts[p];
      const Vec3 v(part.v[0], part.v[1], part.v[2]);
      Vec3 x(part.x[0], part.x[1], part.x[2]);
      if (center) {
        const Vec3 from(center->x[0], center->x[1], center->x[2]), far = x - from;
        Vec3 near = far;
        dcm_minimum_image(domain, near[0], near[1], near[2]);
        if ((near - far).norm() > 0.5 * far.norm()) x = from + near;
      }
      switch (part.kind) {
        case AtomVecDCM::CENTER:
          cell.types.center = part.type;
          cell.masks.center = part.mask;
          cell.volume0 = part.size;
          break;
        case AtomVecDCM::SPHERE:
          cell.types.center = part.type;
          cell.masks.center = part.mask;
          cell.radius = part.size;
          cell.x = x;
          cell.v = v;
          break;
        case AtomVecDCM::NODE:
          cell.types.node = part.type;
          cell.masks.node = node.empty() ? part.mask : cell.masks.node & part.mask;
          node[part.tag] = (int) cell.mesh.nodes.size();
          cell.mesh.nodes.push_back(x);
          cell.node_tag.push_back(part.tag);
          cell.node_mask.push_back(part.mask);
          cell.node_v.push_back(v);
          cell.v += v;
          cell.x += x;
          break;
        case AtomVecDCM::FACE:
          cell.types.face = part.type;
          cell.masks.face = faces.empty() ? part.mask : cell.masks.face & part.mask;
          cell.region.push_back(part.region);
          cell.face_tag.push_back(part.tag);
          cell.face_mask.push_back(part.mask);
          faces.push_back(&part);
          break;
      }
    }
    if (cell.types.center == 0)
      error->all(FLERR, "{}: cell {} does not exist at step {}", asking, molecule,
                 update->ntimestep);
    if (!node.empty()) {
      cell.x /= (double) node.size();
      cell.v /= (double) node.size();
    }
    for (const Part *face : faces) {
      std::array<int, 3> v;
      for (int k = 0; k < 3; k++) {
        const auto found = node.find(face->vertex[k]);
        if (found == node.end())
          error->all(FLERR, "{}: vertex {} of face {} is no node of cell {} at step {}", asking,
                     face->vertex[k], face->tag, molecule, update->ntimestep);
        v[k] = found->second;
      }
      cell.mesh.faces.push_back(v);
    }
    for (; e < edges.size() && edges[e].molecule == molecule; e++) {
      cell.types.bond = edges[e].bond;
      if (edges[e].dihedral) cell.types.dihedral = edges[e].dihedral;
      cell.l0.push_back(edges[e].l0);
      cell.theta0.push_back(edges[e].theta0);
      cell.keeper.push_back(edges[e].keeper);
    }
    cells.push_back(std::move(cell));
  }
  return cells;
}

/* ---------------------------------------------------------------------- */

DCMCellBuilder::Masks DCMCellSurgery::masks_after(const DCMCellBuilder::Types &to,
                                                  const Cell &cell) const
{
  // masks common to all atoms of a type, the same after any number of ranks; ~0: no such atom

  const int types[4] = {to.center, to.node, to.face, cell.types.center};
  int common[4] = {~0, ~0, ~0, ~0};
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < 4; k++)
      if (atom->type[i] == types[k]) common[k] &= atom->mask[i];
  MPI_Allreduce(MPI_IN_PLACE, common, 4, MPI_INT, MPI_BAND, world);
  const int own = cell.masks.center, special = own & ~common[3];
  return {common[0] == ~0 ? own : own | common[0], common[1] == ~0 ? own : special | common[1],
          common[2] == ~0 ? own : special | common[2]};
}

/* ----------------------------------------------------------------------
   ghosts are gone from here until the exchange that follows
------------------------------------------------------------------------- */

void DCMCellSurgery::begin()
{
  if (atom->map_style != Atom::MAP_NONE) atom->map_clear();
  atom->nghost = 0;
  nbefore = atom->nlocal;
  count(expected);
  have_used = false;
}

/* ----------------------------------------------------------------------
   the atoms that stay keep their order
------------------------------------------------------------------------- */

void DCMCellSurgery::remove(const std::vector<tagint> &molecules)
{
  if (molecules.empty()) return;
  int n = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (holds(molecules, atom->molecule[i])) {
      expected[0] -= 1;
      expected[1] -= atom->num_bond[i];
      expected[2] -= atom->num_dihedral[i];
      continue;
    }
    if (i != n) atom->avec->copy(i, n, 1);
    n++;
  }
  atom->nlocal = nbefore = n;
}

void DCMCellSurgery::remove_tracers(const std::vector<char> &doomed)
{
  int n = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (doomed[i]) {
      expected[0] -= 1;
      continue;
    }
    if (i != n) atom->avec->copy(i, n, 1);
    n++;
  }
  atom->nlocal = nbefore = n;
}

/* ----------------------------------------------------------------------
   tags in use. Those of a deformable cell follow each other, the center's first, unless a data file
   says otherwise: then, and for atoms that belong to no cell, all ranks get them one by one.
------------------------------------------------------------------------- */

void DCMCellSurgery::find_used()
{
  struct Head {
    tagint molecule, tag;
  };
  std::vector<Head> mine;
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::CENTER) mine.push_back({atom->molecule[i], atom->tag[i]});
  auto heads = dcm_allgather(mine, world);
  std::sort(heads.begin(), heads.end(), [](const Head &a, const Head &b) {
    return a.molecule < b.molecule;
  });
  auto cell_of = [&heads](tagint molecule) {
    const auto found =
        std::lower_bound(heads.begin(), heads.end(), molecule, [](const Head &head, tagint mol) {
          return head.molecule < mol;
        });
    return found == heads.end() || found->molecule != molecule ? -1 : (int) (found - heads.begin());
  };

  // a cell with as many atoms as its tags reach beyond its center's has them all

  const int n = (int) heads.size();
  std::vector<tagint> count(n, 0), reach(n, 0);
  std::vector<int> cells(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) {
    const int c = cells[i] = cell_of(atom->molecule[i]);
    if (c < 0) continue;
    const tagint offset = atom->tag[i] - heads[c].tag;
    count[c]++;
    reach[c] = std::max(reach[c], offset < 0 ? MAXTAGINT - 1 : offset);
  }
  if (n) {
    MPI_Allreduce(MPI_IN_PLACE, count.data(), n, MPI_LMP_TAGINT, MPI_SUM, world);
    MPI_Allreduce(MPI_IN_PLACE, reach.data(), n, MPI_LMP_TAGINT, MPI_MAX, world);
  }
  used.clear();
  for (int c = 0; c < n; c++)
    if (count[c] == reach[c] + 1) used.push_back({heads[c].tag, heads[c].tag + reach[c]});
  std::vector<Range> loose;
  for (int i = 0; i < atom->nlocal; i++)
    if (cells[i] < 0 || count[cells[i]] != reach[cells[i]] + 1)
      loose.push_back({atom->tag[i], atom->tag[i]});
  join(loose);
  loose = dcm_allgather(loose, world);
  used.insert(used.end(), loose.begin(), loose.end());
  join(used);
  have_used = true;
}

// sort, and make one of ranges that follow each other

void DCMCellSurgery::join(std::vector<Range> &ranges)
{
  std::sort(ranges.begin(), ranges.end(), [](const Range &a, const Range &b) {
    return a.first < b.first;
  });
  size_t n = 0;
  for (size_t m = 1; m < ranges.size(); m++) {
    if (ranges[m].first == ranges[n].last + 1)
      ranges[n].last = ranges[m].last;
    else
      ranges[++n] = ranges[m];
  }
  if (!ranges.empty()) ranges.resize(n + 1);
}

/* ----------------------------------------------------------------------
   first of n tags in a row that nobody has; found in the same way on all ranks
------------------------------------------------------------------------- */

tagint DCMCellSurgery::free_tags(tagint n)
{
  if (!have_used) find_used();
  tagint first = 1;
  size_t at = 0;
  for (; at < used.size() && used[at].first - first < n; at++) first = used[at].last + 1;
  if (first > MAXTAGINT - n)
    error->all(FLERR, "{}: no atom IDs left at step {}", asking, update->ntimestep);
  used.insert(used.begin() + at, {first, first + n - 1});
  return first;
}

/* ----------------------------------------------------------------------
   what is put in is known to all ranks; rank 0 counts it
------------------------------------------------------------------------- */

void DCMCellSurgery::insert(const DCMCellBuilder::Types &types, const DCMCellBuilder::Topology &top,
                            DCMCellBuilder::Deformable cell)
{
  builder.reserve_slots(top.slots);
  cell.tag = free_tags(top.size());
  builder.create(types, top, cell);
  if (comm->me) return;
  expected[0] += top.size();
  expected[1] += (bigint) top.hinges.size();
  expected[2] += (bigint) top.hinges.size();
}

void DCMCellSurgery::insert(const DCMCellBuilder::Types &types, DCMCellBuilder::Sphere cell)
{
  cell.tag = free_tags(1);
  builder.create(types, cell);
  if (comm->me == 0) expected[0] += 1;
}

void DCMCellSurgery::insert(int type, int mask, tagint home, const std::vector<Vec3> &tracers)
{
  if (tracers.empty()) return;
  DCMCellBuilder::Tracer it;
  it.tag = free_tags((tagint) tracers.size());
  it.home = home;
  it.mask = mask;
  for (const Vec3 &x : tracers) {
    it.x = x;
    builder.create(type, it);
    it.tag++;
  }
  if (comm->me == 0) expected[0] += (bigint) tracers.size();
}

/* ----------------------------------------------------------------------
   atoms, bonds and dihedrals of this rank
------------------------------------------------------------------------- */

void DCMCellSurgery::count(bigint *counts) const
{
  counts[0] = atom->nlocal;
  counts[1] = counts[2] = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    counts[1] += atom->num_bond[i];
    counts[2] += atom->num_dihedral[i];
  }
}

void DCMCellSurgery::end()
{
  atom->data_fix_compute_variable(nbefore, atom->nlocal);

  bigint both[6];
  count(both);
  std::copy(expected, expected + 3, both + 3);
  MPI_Allreduce(MPI_IN_PLACE, both, 6, MPI_LMP_BIGINT, MPI_SUM, world);
  if (!std::equal(both, both + 3, both + 3))
    error->all(FLERR,
               "{}: {} atoms, {} bonds and {} dihedrals at step {} where {}, {} and {} were "
               "expected: atoms were lost or belong to no rank",
               asking, both[0], both[1], both[2], update->ntimestep, both[3], both[4], both[5]);
  atom->natoms = both[0];
  atom->nbonds = both[1];
  atom->ndihedrals = both[2];
  if (atom->map_style != Atom::MAP_NONE) {
    atom->map_init();
    atom->map_set();
  }
  for (auto *dump : output->get_dump_list()) SortedDump::look_again(dump);
}

/* ---------------------------------------------------------------------- */

void DCMCellSurgery::require_laws(LAMMPS *lmp, const std::string &asking)
{
  Force *const force = lmp->force;
  if (!dynamic_cast<BondDCMCortex *>(force->bond_match("dcm/cortex")) ||
      !dynamic_cast<DihedralDCMBend *>(force->dihedral_match("dcm/bend")) ||
      lmp->modify->get_fix_by_style("^dcm/volume$").empty())
    lmp->error->all(FLERR,
                    "{}: deformable cells need bond_style dcm/cortex, dihedral_style dcm/bend and "
                    "fix dcm/volume; add them to the deck",
                    asking);
}

/* ----------------------------------------------------------------------
   contact history stores partners by local index until its own pre_exchange: it has to
   come first
------------------------------------------------------------------------- */

void DCMCellSurgery::check_order(LAMMPS *lmp, const Fix *mine, const std::string &asking)
{
  bool after = false;
  for (const auto *fix : std::vector<Fix *>(lmp->modify->get_fix_list())) {
    if (fix == mine) after = true;
    if (after && utils::strmatch(fix->style, "^NEIGH_HISTORY"))
      lmp->error->all(FLERR, "{}: define pair_style dcm/contact before this fix", asking);
  }
}
