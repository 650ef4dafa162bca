/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Marks of fix dcm/osmosis: which faces bound a lumen, what daughters of a cell get of them, and
// their storage.

#include "fix_dcm_osmosis.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_compat.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "law/triangle.h"
#include "memory.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/osmosis";

// a daughter's face takes the mark of a face of her mother's that is this near, in mean edges, and
// faces the same way; those at the division plane face across

static constexpr double NEAR = 0.3, ALONG = 0.7;

// a lumen that takes more than this part of all free area, and encloses cells instead of being
// enclosed by them, is open

static constexpr double OPEN = 0.5;

// which faces a tracer touches, in mean edges

static constexpr double TOUCH = 0.25;

/* ----------------------------------------------------------------------
   from the contacts of the last force evaluation, before atoms move: a run that restarts here finds
   the same. Where nothing secretes and nothing is marked there is no lumen to look for
------------------------------------------------------------------------- */

void FixDCMOsmosis::look()
{
  note_joined();
  int sources = find_sources();
  MPI_Allreduce(MPI_IN_PLACE, &sources, 1, MPI_INT, MPI_MAX, world);
  if (sources) {
    graph.collect(range);
    find_states();
    comm->forward_comm(this, 1);
    graph.build(state, !tracers);
  } else {
    graph.clear();
  }
  set_marks();
  measured = false;
  now.due = 0;
}

/* ----------------------------------------------------------------------
   since when a cell is in the secreting group; daughters have it from their mother
------------------------------------------------------------------------- */

void FixDCMOsmosis::note_joined()
{
  const auto &table = cell->cells();
  for (const int row : table.all_deformable()) {
    double &since = (*joined)(row);
    if (!secreting(row))
      since = -1.0;
    else if (since < 0.0)
      since = now.clock;
  }
}

bool FixDCMOsmosis::acts_on(int row) const
{
  return row >= 0 && (cell->cells()[row].mask & groupbit);
}

bool FixDCMOsmosis::secreting(int row) const
{
  return row >= 0 && (cell->cells()[row].mask & secrete_bit);
}

// in a box that is periodic along its axis a slab may reach across the border

double FixDCMOsmosis::near_slab(double x) const
{
  if (!domain->periodicity[axis]) return x;
  const double length = domain->prd[axis];
  return x - length * std::round((x - 0.5 * (lo + hi)) / length);
}

bool FixDCMOsmosis::in_slab(const double *x) const
{
  return axis < 0 || (near_slab(x[axis]) > lo && near_slab(x[axis]) < hi);
}

/* ----------------------------------------------------------------------
   the starter around a point: a ball, in a slab a cylinder
------------------------------------------------------------------------- */

bool FixDCMOsmosis::near_starter(const double *x) const
{
  if (starter != AT_POINT || now.clock >= starting) return false;
  double d[3] = {x[0] - point[0], x[1] - point[1], x[2] - point[2]};
  dcm_minimum_image(domain, d[0], d[1], d[2]);
  if (axis >= 0) d[axis] = 0.0;
  return vec(d).norm() < radius;
}

/* ----------------------------------------------------------------------
   the starter between apical faces: one of two secreting cells has joined not long ago
------------------------------------------------------------------------- */

bool FixDCMOsmosis::starting_at(int row) const
{
  return starter == APICAL && now.clock - (*joined)(row) < starting;
}

bool FixDCMOsmosis::started_across(int f) const
{
  if (starter != APICAL) return false;
  const int i = cell->faces()[f].atom, row = cell->faces()[f].cell;
  if (!secreting(row) || dcm->region[i] != AtomVecDCM::APICAL) return false;
  const int j = graph.opposite(i);
  if (j < 0 || dcm->region[j] != AtomVecDCM::APICAL || !secreting(cell->cell_of(j))) return false;
  return starting_at(row) || starting_at(cell->cell_of(j));
}

// of an owned face

double FixDCMOsmosis::covered_part(int f) const
{
  const double all = cell->area(f);
  return all > 0.0 ? contact->contact_area()[cell->faces()[f].atom] / all : 1.0;
}

/* ----------------------------------------------------------------------
   faces that marks may come from, of this process: in `state`. 1: marks may come of it, 0: none
can, for no face is marked and all sources are in contact, where no starter opens it
------------------------------------------------------------------------- */

int FixDCMOsmosis::find_sources()
{
  int any = 0;
  state.assign(atom->nlocal + atom->nghost, 0);
  std::vector<int> touched;
  if (tracers) {
    touched.assign(atom->nlocal, 0);
    tracer->touch_faces(range > 0.0 ? range : TOUCH * cell->mean_edge(), touched);
  }
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    const int i = face.atom;
    const double *const x = atom->x[i];
    whole[i] = acts_on(face.cell) && in_slab(x) && near_starter(x);
    const bool source = tracers ? touched[i] != 0
                                : secreting(face.cell) && dcm->region[i] == AtomVecDCM::APICAL;
    if (source || whole[i]) state[i] |= DCMFaceGraph::SOURCE;
    if (mark[i]) state[i] |= DCMFaceGraph::BEFORE;
    any = any || mark[i] || whole[i] ||
          (source && (tracers || starting_at(face.cell) || covered_part(f) < theta));
  }
  return any;
}

/* ---------------------------------------------------------------------- */

void FixDCMOsmosis::find_states()
{
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    const int i = face.atom;
    const double part = covered_part(f);
    const bool inside = acts_on(face.cell) && in_slab(atom->x[i]);
    whole[i] = inside && (whole[i] || started_across(f));
    if (inside && (whole[i] || dcm::may_be_marked(part, theta, mark[i] != 0)))
      state[i] |= DCMFaceGraph::NODE;
    else
      state[i] = part >= theta ? DCMFaceGraph::SHUT : 0;
  }
}

/* ----------------------------------------------------------------------
   all processes go through the same faces in the same order
------------------------------------------------------------------------- */

void FixDCMOsmosis::set_marks()
{
  const auto &all = graph.faces();
  std::vector<char> reached(graph.nsets(), 0);
  for (const auto &face : all)
    if (face.state & DCMFaceGraph::SOURCE) reached[face.set] = 1;
  auto marked = [&](const DCMFaceGraph::Face &face) {
    return reached[face.set] ||
           ((tracers || memory_kept) && (face.state & DCMFaceGraph::BEFORE) != 0);
  };

  now.lost = 0.0;
  for (int f = 0; f < cell->nowned(); f++) {
    const int i = cell->faces()[f].atom;
    const auto *const face = (state[i] & DCMFaceGraph::NODE) ? graph.find(atom->tag[i]) : nullptr;
    const int before = mark[i];
    mark[i] = face && marked(*face);
    if (!mark[i]) whole[i] = 0;
    if (before && !mark[i]) now.lost += cell->area(f);
  }
  MPI_Allreduce(MPI_IN_PLACE, &now.lost, 1, MPI_DOUBLE, MPI_SUM, world);

  const auto &table = cell->cells();
  for (int row = 0; row < table.size(); row++) (*marked_area)(row) = 0.0;
  double free_area = 0.0, area = 0.0;
  const DCMFaceGraph::Face *first = nullptr;
  Vec3 center = Vec3::Zero();
  std::vector<tagint> molecules;
  now.nfaces = 0;
  for (const auto &face : all) {
    free_area += face.area;
    if (!marked(face)) continue;
    if (!first) first = &face;
    now.nfaces++;
    area += face.area;
    const int row = table.find(face.molecule);
    if (row >= 0) (*marked_area)(row) += face.area;
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = face.mid[k] - first->mid[k];
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    center += face.area * vec(d);
    molecules.push_back(face.molecule);
  }
  std::sort(molecules.begin(), molecules.end());
  now.ncells = (int) (std::unique(molecules.begin(), molecules.end()) - molecules.begin());
  if (first) vec(now.center) = vec(first->mid) + center / area;
  if (first && axis >= 0) now.center[axis] = near_slab(now.center[axis]);
  if (first && now.begun < 0.0) now.begun = now.clock;

  double secretes_now = 0.0;
  for (const auto &face : all)
    if (marked(face) && (face.state & DCMFaceGraph::SOURCE)) secretes_now += face.area;
  count_solute(first ? secretes_now : 0.0);
  measured = false;
  if (area > OPEN * free_area) warn_if_open(area / free_area);
}

/* ----------------------------------------------------------------------
   the area of the last look has secreted until now; what was in a lumen that is gone, is gone
------------------------------------------------------------------------- */

void FixDCMOsmosis::count_solute(double area)
{
  if (solute && now.counted >= 0.0)
    now.amount = dcm::secreted(now.amount, rate * now.secreting, loss, now.clock - now.counted);
  if (now.nfaces == 0) now.amount = 0.0;
  now.counted = now.clock;
  now.secreting = area;
}

/* ----------------------------------------------------------------------
   normals of a lumen's wall point into it; those of a tissue seen from outside point away
------------------------------------------------------------------------- */

void FixDCMOsmosis::warn_if_open(double part)
{
  if (now.warned) return;
  measure();
  if (sums.volume >= 0.0) return;
  now.warned = 1;
  if (comm->me == 0)
    error->warning(FLERR,
                   "{}: the lumen is open at step {}: {:.0f} % of all free area is marked, the "
                   "outside of the tissue with it; close the tissue, or restrict the marks by the "
                   "fix group or keyword slab",
                   STYLE, update->ntimestep, 100.0 * part);
}

/* ----------------------------------------------------------------------
   daughters get the marks of the part of the mother's surface that they are made of. Where the
mother was is known to all processes only before she divides
------------------------------------------------------------------------- */

void FixDCMOsmosis::take_snapshot()
{
  std::vector<Corner> mine;
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    if (!mark[face.atom]) continue;
    Corner it = {};
    it.molecule = atom->molecule[face.atom];
    for (int k = 0; k < 3; k++) vec(&it.x[3 * k]) = vec(atom->x[face.v[k]]);
    mine.push_back(it);
  }
  snapshot = dcm_allgather(mine, world);
}

void FixDCMOsmosis::cell_divided(const DCMCellTable::Division &division)
{
  now.due = 1;
  const auto &table = cell->cells();
  for (const int daughter : division.daughter)
    newborn.push_back({table[daughter].molecule, table[division.mother].molecule});
}

void FixDCMOsmosis::inherit()
{
  const double most = NEAR * cell->mean_edge();
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    const auto birth = std::find_if(newborn.begin(), newborn.end(), [this, &face](const Birth &it) {
      return it.daughter == atom->molecule[face.atom];
    });
    if (birth == newborn.end()) continue;
    for (const auto &it : snapshot) {
      if (it.molecule != birth->mother || mark[face.atom]) continue;
      double d[3];
      for (int k = 0; k < 3; k++) d[k] = atom->x[face.atom][k] - it.x[k];
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      const Vec3 b = vec(&it.x[3]) - vec(&it.x[0]), c = vec(&it.x[6]) - vec(&it.x[0]);
      const Vec3 mid = vec(d);
      if ((mid - dcm::nearest_on_triangle(mid, Vec3::Zero(), b, c)).norm() > most) continue;
      const Vec3 normal = b.cross(c).normalized();
      if (normal.dot(vec(&cell->normals()[3 * (size_t) f])) > ALONG) mark[face.atom] = 1;
    }
  }
  newborn.clear();
  snapshot.clear();
}

/* ----------------------------------------------------------------------
   states of a look, to the ghosts
------------------------------------------------------------------------- */

int FixDCMOsmosis::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  for (int i = 0; i < n; i++) buf[i] = state[list[i]];
  return n;
}

void FixDCMOsmosis::unpack_forward_comm(int n, int first, double *buf)
{
  for (int i = 0; i < n; i++) state[first + i] = (int) buf[i];
}

/* ----------------------------------------------------------------------
   marks go with their atoms
------------------------------------------------------------------------- */

void FixDCMOsmosis::grow_arrays(int nmax)
{
  memory->grow(mark, nmax, "dcm/osmosis:mark");
  memory->grow(whole, nmax, "dcm/osmosis:whole");
}

void FixDCMOsmosis::copy_arrays(int i, int j, int /*delflag*/)
{
  mark[j] = mark[i];
  whole[j] = whole[i];
}

void FixDCMOsmosis::set_arrays(int i)
{
  mark[i] = whole[i] = 0;
}

int FixDCMOsmosis::pack_exchange(int i, double *buf)
{
  buf[0] = mark[i] + 2 * whole[i];
  return 1;
}

int FixDCMOsmosis::unpack_exchange(int nlocal, double *buf)
{
  const int both = (int) buf[0];
  mark[nlocal] = both & 1;
  whole[nlocal] = both >> 1;
  return 1;
}

int FixDCMOsmosis::pack_restart(int i, double *buf)
{
  buf[0] = 2;    // number of values, this one included
  return 1 + pack_exchange(i, buf + 1);
}

void FixDCMOsmosis::unpack_restart(int nlocal, int nth)
{
  double *const extra = atom->extra[nlocal];
  int m = 0;
  for (int i = 0; i < nth; i++) m += static_cast<int>(extra[m]);
  unpack_exchange(nlocal, extra + m + 1);
}

int FixDCMOsmosis::size_restart(int /*nlocal*/)
{
  return 2;
}

int FixDCMOsmosis::maxsize_restart()
{
  return 2;
}
