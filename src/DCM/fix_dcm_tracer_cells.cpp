/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// fix dcm/tracer: tracers are made, handed on when cells divide, die or change their form, checked
// at the start of runs, and kept from becoming ghosts

#include "fix_dcm_tracer.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_compat.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "group.h"
#include "law/random.h"
#include "law/solid_angle.h"
#include "law/triangle.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/tracer";
static const char GHOSTS[] = "dcm_ghosts";    // group of all atoms that may be ghosts

static constexpr int MOST_TRIES = 1000;    // places tried per tracer that is made

// what comm_modify group sets

namespace {
struct Borders : Comm {
  static int &group_of(Comm *comm) { return comm->*(&Borders::bordergroup); }
};
}    // namespace

/* ----------------------------------------------------------------------
   a cell as all ranks know it, unwrapped
------------------------------------------------------------------------- */

struct FixDCMTracer::Shape {
  tagint molecule = 0;
  Vec3 mid, lo, hi;
  dcm::Mesh mesh;

  bool inside(const Vec3 &x) const
  {
    if ((x - lo).minCoeff() < 0.0 || (hi - x).minCoeff() < 0.0) return false;
    double sum = 0.0;
    for (const auto &f : mesh.faces)
      sum += dcm::face_winding(x, mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
    return sum > 0.5;
  }

  Vec3 nearest(const Vec3 &x) const
  {
    Vec3 best = x;
    double least = 1.0e300;
    for (const auto &f : mesh.faces) {
      const Vec3 y =
          dcm::nearest_on_triangle(x, mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
      if ((x - y).squaredNorm() >= least) continue;
      least = (x - y).squaredNorm();
      best = y;
    }
    return best;
  }
};

std::vector<FixDCMTracer::Shape> FixDCMTracer::shapes_of(std::vector<tagint> molecules) const
{
  std::sort(molecules.begin(), molecules.end());
  molecules.erase(std::unique(molecules.begin(), molecules.end()), molecules.end());
  std::vector<Shape> shapes;
  for (auto &it : DCMCellSurgery(lmp, STYLE).gather(molecules)) {
    Shape shape;
    shape.molecule = it.molecule;
    shape.mid = it.x;
    shape.lo = shape.hi = it.x;
    for (const Vec3 &x : it.mesh.nodes) {
      shape.lo = shape.lo.cwiseMin(x);
      shape.hi = shape.hi.cwiseMax(x);
    }
    shape.mesh = std::move(it.mesh);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

// position of an atom, in the image next to the cell

Vec3 FixDCMTracer::near_cell(int i, const Shape &shape) const
{
  Vec3 d = vec(atom->x[i]) - shape.mid;
  dcm_minimum_image(domain, d[0], d[1], d[2]);
  return shape.mid + d;
}

// onto the surface, and a little beyond it in the same direction; settle() does the rest

void FixDCMTracer::shift(int i, const Vec3 &way)
{
  const double length = way.norm();
  vec(atom->x[i]) += way * (length > 0.0 ? 1.0 + 2.0 * walk.delta / length : 1.0);
  walk.count.swept++;
}

/* ----------------------------------------------------------------------
   at the start of a run: tracers are no part of a cell and homes exist; in its first run tracers of
   the deck are where they say they are, and those that are missing are made
------------------------------------------------------------------------- */

void FixDCMTracer::setup_pre_exchange()
{
  choose_lengths();
  check_homes();
  const bool first = !kept.begun && !restored;
  if (first || unsure) check_start();
  unsure = false;
  kept.begun = 1;
  mark_ghosts();
  if (first) make(needy());
}

void FixDCMTracer::check_homes()
{
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::TRACER && atom->molecule[i] != 0)
      error->one(FLERR,
                 "{}: tracer {} has molecule ID {}, must be 0: it is no part of a cell; do not set "
                 "it, the cell a tracer is in is its home",
                 STYLE, atom->tag[i], atom->molecule[i]);
  const auto &table = cell->cells();
  tagint wrong[2] = {0, 0};
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::TRACER) continue;
    const tagint home = dcm->vertex[i][AtomVecDCM::HOME];
    if (home == 0) continue;
    const int row = table.find(home);
    if (row >= 0 && table[row].deformable) continue;
    if (atom->tag[i] > wrong[0]) {
      wrong[0] = atom->tag[i];
      wrong[1] = home;
    }
  }
  struct {
    tagint tag, home;
  } mine = {wrong[0], wrong[1]};
  tagint tag = mine.tag;
  MPI_Allreduce(MPI_IN_PLACE, &tag, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (tag == 0) return;
  tagint home = mine.tag == tag ? mine.home : 0;
  MPI_Allreduce(MPI_IN_PLACE, &home, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  error->all(
      FLERR,
      "{}: tracer {} has home {}, but there is no deformable cell {}; delete the tracers of a "
      "cell with it, or set their home to 0 (outside)",
      STYLE, tag, home, home);
}

/* ----------------------------------------------------------------------
   against whole cells: those read from a file may be off by what surfaces move in a step; after a
   minimization they are put where they belong
------------------------------------------------------------------------- */

void FixDCMTracer::check_start()
{
  bigint any = 0;
  for (int i = 0; i < atom->nlocal; i++) any += dcm->kind[i] == AtomVecDCM::TRACER;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (any == 0) return;
  const bool moved = unsure && kept.begun;
  std::vector<tagint> all;
  for (const int row : cell->cells().all_deformable()) all.push_back(cell->cells()[row].molecule);
  for (const auto &shape : shapes_of(all)) {
    for (int i = 0; i < atom->nlocal; i++) {
      if (dcm->kind[i] != AtomVecDCM::TRACER || dcm->vertex[i][AtomVecDCM::HOST] != 0) continue;
      const tagint home = dcm->vertex[i][AtomVecDCM::HOME];
      if (home != 0 && home != shape.molecule) continue;
      const Vec3 x = near_cell(i, shape);
      if (home == 0 && ((x - shape.lo).minCoeff() < 0.0 || (shape.hi - x).minCoeff() < 0.0))
        continue;
      if (shape.inside(x) == (home != 0)) continue;
      const Vec3 way = shape.nearest(x) - x;
      if (moved)
        shift(i, way);
      else if (way.norm() > 0.5 * walk.near && home != 0)
        error->one(
            FLERR,
            "{}: tracer {} has home {} but is {:.4g} outside that cell; correct its position, "
            "or set its home to 0 (outside)",
            STYLE, atom->tag[i], home, way.norm());
      else if (way.norm() > 0.5 * walk.near)
        error->one(FLERR,
                   "{}: tracer {} has home 0 (outside) but is {:.4g} deep in cell {}; correct its "
                   "position, or set its home to {}",
                   STYLE, atom->tag[i], way.norm(), shape.molecule, shape.molecule);
    }
  }
}

/* ----------------------------------------------------------------------
   secreting cells that have not been given tracers
------------------------------------------------------------------------- */

bool FixDCMTracer::any_needy() const
{
  const auto &table = cell->cells();
  for (const int row : table.all_deformable())
    if (acts_on(table[row]) && (*secretes)(row) == 0.0) return true;
  return false;
}

std::vector<tagint> FixDCMTracer::needy() const
{
  const auto &table = cell->cells();
  std::vector<tagint> molecules;
  for (const int row : table.all_deformable())
    if (acts_on(table[row]) && (*secretes)(row) == 0.0) molecules.push_back(table[row].molecule);
  return molecules;
}

/* ----------------------------------------------------------------------
   places uniform in a cell (and the slab), the same on all ranks
------------------------------------------------------------------------- */

std::vector<Vec3> FixDCMTracer::fill(const Shape &shape, int wanted) const
{
  std::vector<Vec3> places;
  Vec3 lo = shape.lo, hi = shape.hi;
  if (slab_axis >= 0) {
    lo[slab_axis] = std::max(lo[slab_axis], slab_lo);
    hi[slab_axis] = std::min(hi[slab_axis], slab_hi);
    if (lo[slab_axis] >= hi[slab_axis]) return places;
  }
  // no atom has a negative ID: no walk shares these numbers
  dcm::Random random(seed, -(std::int64_t) shape.molecule, 0, dcm::RandomPurpose::TRACER);
  for (bigint n = 0; n < (bigint) MOST_TRIES * wanted && (int) places.size() < wanted; n++) {
    Vec3 x;
    for (int k = 0; k < 3; k++) x[k] = lo[k] + (hi[k] - lo[k]) * random.uniform();
    if (shape.inside(x)) places.push_back(x);
  }
  return places;
}

/* ----------------------------------------------------------------------
   fill cells up to their number of tracers
------------------------------------------------------------------------- */

void FixDCMTracer::make(const std::vector<tagint> &molecules)
{
  if (molecules.empty()) return;
  const auto shapes = shapes_of(molecules);
  std::vector<int> inside(shapes.size(), 0);
  int common = ~0;    // groups that all tracers are in
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::TRACER) continue;
    common &= atom->mask[i];
    for (size_t n = 0; n < shapes.size(); n++)
      inside[n] += dcm->vertex[i][AtomVecDCM::HOME] == shapes[n].molecule;
  }
  MPI_Allreduce(MPI_IN_PLACE, inside.data(), (int) inside.size(), MPI_INT, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, &common, 1, MPI_INT, MPI_BAND, world);

  DCMCellSurgery surgery(lmp, STYLE);
  surgery.begin();
  for (size_t n = 0; n < shapes.size(); n++) {
    const int wanted = std::max(0, number - inside[n]);
    const auto places = fill(shapes[n], wanted);
    if ((int) places.size() < wanted && update->setupflag)
      error->all(
          FLERR,
          "{}: cell {} of group {} has no room for tracers in slab {} {} {}; move the slab, or "
          "take the cell out of the group",
          STYLE, shapes[n].molecule, group->names[igroup], "xyz"[std::max(0, slab_axis)], slab_lo,
          slab_hi);
    surgery.insert(type, common == ~0 ? 1 : common | 1, shapes[n].molecule, places);
    (*secretes)(cell->cells().find(shapes[n].molecule)) = 1.0;
  }
  surgery.end();
}

/* ----------------------------------------------------------------------
   cells that came and went in this step
------------------------------------------------------------------------- */

void FixDCMTracer::cell_divided(const DCMCellTable::Division &division)
{
  const auto &table = cell->cells();
  const tagint one = table[division.daughter[0]].molecule,
               two = table[division.daughter[1]].molecule;
  gone[table[division.mother].molecule] = {one, two};
  fresh.push_back(one);
  fresh.push_back(two);
}

void FixDCMTracer::cell_removed(int row)
{
  gone[cell->cells()[row].molecule] = {0, 0};
}

// a cell that becomes a sphere is gone for tracers; one that becomes deformable is a new surface

void FixDCMTracer::cell_converted(int row, double /*volume0_before*/)
{
  const auto &it = cell->cells()[row];
  if (it.deformable) {
    fresh.push_back(it.molecule);
  } else {
    gone[it.molecule] = {0, 0};
    (*secretes)(row) = 0.0;
  }
}

// deformable cells that a cell has become

std::vector<tagint> FixDCMTracer::heirs(tagint molecule) const
{
  const auto found = gone.find(molecule);
  if (found == gone.end()) {
    const int row = cell->cells().find(molecule);
    if (row < 0 || !cell->cells()[row].deformable) return {};
    return {molecule};
  }
  if (found->second.first == 0) return {};
  auto all = heirs(found->second.first);
  for (const tagint it : heirs(found->second.second)) all.push_back(it);
  return all;
}

/* ----------------------------------------------------------------------
   a tracer whose cell has divided belongs to the daughter it is in, else to the nearer one; those
of a cell that is gone are deleted or set free; nobody outside is inside a new surface
------------------------------------------------------------------------- */

void FixDCMTracer::hand_on()
{
  std::vector<tagint> there;
  for (const tagint molecule : fresh)
    for (const tagint it : heirs(molecule)) there.push_back(it);
  const auto shapes = shapes_of(there);
  auto shape_of = [&shapes](tagint molecule) -> const Shape & {
    return *std::lower_bound(shapes.begin(), shapes.end(), molecule, [](const Shape &s, tagint m) {
      return s.molecule < m;
    });
  };
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::TRACER) continue;
    tagint *const state = dcm->vertex[i];
    state[AtomVecDCM::HOST] = 0;    // IDs of faces are given again; settle() catches anew
    if (state[AtomVecDCM::WEIGHTS] != DOOMED) state[AtomVecDCM::WEIGHTS] = 0;
    if (state[AtomVecDCM::HOME] != 0 && gone.count(state[AtomVecDCM::HOME])) {
      const auto candidates = heirs(state[AtomVecDCM::HOME]);
      state[AtomVecDCM::HOME] = 0;
      Vec3 way = Vec3::Zero();
      double least = 1.0e300;
      for (const tagint molecule : candidates) {
        const Shape &shape = shape_of(molecule);
        const Vec3 x = near_cell(i, shape), d = shape.nearest(x) - x;
        const double distance = shape.inside(x) ? -1.0 : d.norm();
        if (distance >= least) continue;
        least = distance;
        way = d;
        state[AtomVecDCM::HOME] = molecule;
      }
      if (!candidates.empty() && least >= 0.0) shift(i, way);
      if (candidates.empty() && !release) state[AtomVecDCM::WEIGHTS] = DOOMED;
    }
    if (state[AtomVecDCM::HOME] != 0) continue;
    for (const Shape &shape : shapes) {
      const Vec3 x = near_cell(i, shape);
      if (shape.inside(x)) shift(i, shape.nearest(x) - x);
    }
  }
  gone.clear();
  fresh.clear();
}

/* ----------------------------------------------------------------------
   the fixes that change cells have acted before, being earlier in the deck
------------------------------------------------------------------------- */

void FixDCMTracer::pre_exchange()
{
  if (!gone.empty() || !fresh.empty()) {
    cell->refresh();    // groups of the new cells
    hand_on();
  }
  take_away();
  mark_ghosts();
  make(needy());
}

void FixDCMTracer::take_away()
{
  std::vector<char> doomed(atom->nlocal, 0);
  int any = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::TRACER) continue;
    if (dcm->vertex[i][AtomVecDCM::WEIGHTS] != DOOMED) continue;
    doomed[i] = 1;
    deleted++;
    any = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return;
  DCMCellSurgery surgery(lmp, STYLE);
  surgery.begin();
  surgery.remove_tracers(doomed);
  surgery.end();
}

/* ----------------------------------------------------------------------
   LAMMPS can limit ghosts to a group (comm_modify group), whose atoms then come first on each rank:
   all atoms but tracers. A deck that uses this itself keeps it, and tracers become ghosts that
   nobody looks at.
------------------------------------------------------------------------- */

void FixDCMTracer::keep_from_ghosts()
{
  if (atom->firstgroupname || Borders::group_of(comm)) return;
  ghost_group = group->find_or_create(GHOSTS);
  atom->firstgroupname = utils::strdup(GHOSTS);
  atom->firstgroup = Borders::group_of(comm) = ghost_group;
  mark_ghosts();
}

void FixDCMTracer::let_be_ghosts()
{
  if (ghost_group < 0 || !comm) return;    // gone before fixes when LAMMPS ends
  Borders::group_of(comm) = 0;
  delete[] atom->firstgroupname;
  atom->firstgroupname = nullptr;
  atom->firstgroup = -1;
}

void FixDCMTracer::mark_ghosts()
{
  if (ghost_group < 0) return;
  const int bit = group->bitmask[ghost_group];
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::TRACER)
      atom->mask[i] &= ~bit;
    else
      atom->mask[i] |= bit;
}

// an atom that another fix has made after us would have no ghosts

void FixDCMTracer::pre_neighbor()
{
  if (ghost_group < 0) return;
  const int bit = group->bitmask[ghost_group];
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] != AtomVecDCM::TRACER && !(atom->mask[i] & bit))
      error->one(
          FLERR,
          "{}: atom {} has come at step {} after this fix has acted; define the fix that makes "
          "atoms before this fix",
          STYLE, atom->tag[i], update->ntimestep);
}
