/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: checks that only fail: cells given inside each other at the start of a
// run, cells that ran into each other

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_cell_bins.h"
#include "dcm_compat.h"
#include "dcm_slots.h"
#include "dcm_text.h"
#include "law/face_overlap.h"
#include "law/solid_angle.h"
#include "law/triangle.h"
#include "law/volume.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <tuple>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

// a cell as the start check sees it: the sphere of its volume

namespace {
struct Body {
  tagint molecule;
  double x[3], radius;
  int cell;        // row of the table of cells, -1: center-based
  double reach;    // of its surface from the center
};

// is a point inside a cell?

struct Query {
  int body;
  Vec3 point;
  double angle;    // solid angle of the cell's surface: 4 pi inside, 0 outside
};
}    // namespace

/* ----------------------------------------------------------------------
   answer all queries about deformable cells from their faces, on all ranks
------------------------------------------------------------------------- */

static void solid_angles(LAMMPS *lmp, const FixDCMCell *fix, const std::vector<Body> &bodies,
                         std::vector<Query> &queries)
{
  std::vector<std::vector<int>> of_cell(fix ? fix->cells().size() : 0);
  std::vector<double> angles(queries.size(), 0.0);
  for (size_t q = 0; q < queries.size(); q++) {
    const Body &body = bodies[queries[q].body];
    if (body.cell >= 0) of_cell[body.cell].push_back((int) q);
  }
  for (int f = 0; fix && f < fix->nowned(); f++) {
    const auto &face = fix->faces()[f];
    for (int q : of_cell[face.cell]) {
      double *const *const x = lmp->atom->x;
      Vec3 a = vec(x[face.v[0]]) - queries[q].point;
      dcm_minimum_image(lmp->domain, a[0], a[1], a[2]);
      const Vec3 b = a + (vec(x[face.v[1]]) - vec(x[face.v[0]]));
      const Vec3 c = a + (vec(x[face.v[2]]) - vec(x[face.v[0]]));
      angles[q] += 4.0 * dcm::PI * dcm::face_winding(Vec3::Zero(), a, b, c);
    }
  }
  if (fix && !angles.empty())
    MPI_Allreduce(MPI_IN_PLACE, angles.data(), (int) angles.size(), MPI_DOUBLE, MPI_SUM,
                  lmp->world);
  for (size_t q = 0; q < queries.size(); q++) {
    const Body &body = bodies[queries[q].body];
    queries[q].angle = angles[q];
    if (body.cell >= 0) continue;
    Vec3 d = queries[q].point - vec(body.x);
    dcm_minimum_image(lmp->domain, d[0], d[1], d[2]);
    queries[q].angle = d.norm() < body.radius ? 4.0 * dcm::PI : 0.0;
  }
}

/* ----------------------------------------------------------------------
   largest distance of a cell's nodes from its center, per row of the table
------------------------------------------------------------------------- */

static std::vector<double> reaches(LAMMPS *lmp, const FixDCMCell *fix)
{
  if (!fix) return {};
  std::vector<double> reach(fix->cells().size(), 0.0);
  for (int f = 0; f < fix->nowned(); f++) {
    const auto &face = fix->faces()[f];
    for (const int v : face.v) {
      Vec3 d = vec(lmp->atom->x[v]) - vec(fix->cells()[face.cell].x);
      dcm_minimum_image(lmp->domain, d[0], d[1], d[2]);
      reach[face.cell] = std::max(reach[face.cell], d.norm());
    }
  }
  if (!reach.empty())
    MPI_Allreduce(MPI_IN_PLACE, reach.data(), (int) reach.size(), MPI_DOUBLE, MPI_MAX, lmp->world);
  return reach;
}

/* ----------------------------------------------------------------------
   law maugis puts adhesion into a ring at the rim of the contact: where that of
   two undeformed cells is wider than the cells no face carries it, and strong
   adhesion would repel. Zero-load contact radius of JKR: a^3 = 9 pi W R^2 / (2 E).
------------------------------------------------------------------------- */

void PairDCMContact::check_law(double radius)
{
  if (set.law != MAUGIS || !expect_faces) return;
  const double R = 0.5 * radius;
  for (int s = 1; s <= atom->ntypes; s++)
    for (int t = s; t <= atom->ntypes; t++) {
      if (!may_be(types[s], AtomVecDCM::FACE) && !may_be(types[t], AtomVecDCM::FACE)) continue;
      auto m = table[(size_t) AtomVecDCM::NREGION * ((s - 1) * nclass + t - 1)];
      if (!types[s].active || !types[t].active) continue;
      if (!expect_new && (!types[s].kind || !types[t].kind)) continue;
      for (int p = 0; p < AtomVecDCM::NREGION; p++)
        for (int q = 0; q < AtomVecDCM::NREGION; q++)
          m.W = std::max(m.W, parameters->adhesion(s, p, t, q));
      const double a = std::cbrt(4.5 * dcm::PI * m.W * R * R / m.E);
      if (a > 0.9 * radius)
        error->all(
            FLERR,
            "Pair style dcm/contact: adhesion W = {:.4} of atom types {} and {} is too strong "
            "for law maugis: the contact radius {:.4} of undeformed cells is over 0.9 of the cell "
            "radius {:.4}; use law dmt, a lower W or a higher E_contact",
            m.W, s, t, a, radius);
    }
}

/* ----------------------------------------------------------------------
   a number for which atoms there are, where and how large, the same on all ranks
------------------------------------------------------------------------- */

uint64_t PairDCMContact::places() const
{
  uint64_t mine = 0, all;
  for (int i = 0; i < atom->nlocal; i++) {
    uint64_t hash = (uint64_t) atom->tag[i];
    for (const double value : {atom->x[i][0], atom->x[i][1], atom->x[i][2], atom->radius[i]}) {
      uint64_t bits;
      std::memcpy(&bits, &value, sizeof(bits));
      hash = dcm_mix(hash ^ bits);
    }
    mine += hash;
  }
  MPI_Allreduce(&mine, &all, 1, MPI_UINT64_T, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   cells that are given inside each other: faces that start on the wrong side
   see no contact at all, so no force would ever tell
   first the spheres of equal volume, then, where these overlap by half a radius, how long the line
   through both centers runs inside both surfaces, around the middle of what the spheres share; for
   cells that are not round, also whether the center of the smaller one is inside both
------------------------------------------------------------------------- */

void PairDCMContact::check_start()
{
  // not again when a run just goes on: no atom was made, deleted or moved since the last one
  if (checked == places()) return;

  std::vector<Body> mine, bodies;
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::SPHERE)
      mine.push_back({atom->molecule[i],
                      {atom->x[i][0], atom->x[i][1], atom->x[i][2]},
                      atom->radius[i],
                      -1,
                      atom->radius[i]});
  bodies = dcm_allgather(mine, world);
  if (fix_cell) fix_cell->update_all();
  const auto reach = reaches(lmp, fix_cell);
  for (const int c : fix_cell ? fix_cell->cells().all_deformable() : std::vector<int>()) {
    const auto &cell = fix_cell->cells()[c];
    bodies.push_back({cell.molecule,
                      {cell.x[0], cell.x[1], cell.x[2]},
                      dcm::ball_radius(cell.volume),
                      c,
                      reach[c]});
  }
  std::sort(bodies.begin(), bodies.end(), [](const Body &a, const Body &b) {
    return a.molecule < b.molecule;
  });
  for (size_t n = 1; n < bodies.size(); n++)
    if (bodies[n].molecule == bodies[n - 1].molecule)
      error->all(FLERR,
                 "Pair style dcm/contact: two cells have molecule ID {}; every cell needs a "
                 "molecule ID of its own",
                 bodies[n].molecule);

  check_law(bodies.empty()
                ? 0.0
                : std::min_element(bodies.begin(), bodies.end(), [](const Body &a, const Body &b) {
                    return a.radius < b.radius;
                  })->radius);

  // each rank looks at its share of the pairs

  std::vector<int> near_mine, near_all;
  const int nbodies = (int) bodies.size();
  std::vector<double> places;
  double largest = 0.0;
  for (const auto &body : bodies) {
    places.insert(places.end(), body.x, body.x + 3);
    largest = std::max(largest, body.reach);
  }
  const DCMCellBins bins(domain, places, std::max(2.0 * largest, 1.0e-6 * domain->prd[0]));
  for (int a = comm->me; a < nbodies; a += comm->nprocs)
    for (const int b : bins.near(bodies[a].x)) {
      if (b <= a) continue;
      Vec3 d = vec(bodies[b].x) - vec(bodies[a].x);
      const double Ra = bodies[a].radius, Rb = bodies[b].radius;
      const double limit = Ra + Rb - 0.5 * std::min(Ra, Rb);
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      const double most = std::max({limit, bodies[a].reach, bodies[b].reach});
      if (d.squaredNorm() < most * most) near_mine.insert(near_mine.end(), {a, b});
    }
  near_all = dcm_allgather(near_mine, world);

  // two center-based cells may overlap far: after a division, or pressed

  constexpr int NSTEP = 36;    // samples on the line, a tenth of the smaller radius apart
  std::vector<Query> queries;
  struct Pair {
    int a, b;
    size_t query;    // the first of its own
    bool close;      // or may only be if they are not round
  };
  std::vector<Pair> doubtful;
  int nspheres = 0;
  for (size_t m = 0; m < near_all.size(); m += 2) {
    const int a = near_all[m], b = near_all[m + 1];
    if (bodies[a].cell < 0 && bodies[b].cell < 0) {
      if (find_sisters(bodies[a].molecule, bodies[b].molecule) < 0) nspheres++;
      continue;
    }
    Vec3 d = vec(bodies[b].x) - vec(bodies[a].x);
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    const double Ra = bodies[a].radius, Rb = bodies[b].radius, small = std::min(Ra, Rb);
    const bool close = d.norm() < Ra + Rb - 0.5 * small;
    doubtful.push_back({a, b, queries.size(), close});
    const Vec3 center = vec(bodies[a].x) + (Rb < Ra ? d : Vec3(Vec3::Zero()));
    for (int body : {a, b}) queries.push_back({body, center, 0.0});
    if (!close) continue;
    const Vec3 u = d.norm() > 1.0e-6 * small ? Vec3(d.normalized()) : Vec3(Vec3::UnitX());
    const double from = std::max(-Ra, d.norm() - Rb), to = std::min(Ra, d.norm() + Rb);
    const Vec3 mid = vec(bodies[a].x) + 0.5 * (from + to) * u;
    for (int k = 0; k <= NSTEP; k++)
      for (int body : {a, b})
        queries.push_back({body, mid + 0.1 * (k - 0.5 * NSTEP) * small * u, 0.0});
  }
  if (nspheres && comm->me == 0)
    error->warning(FLERR,
                   "Pair style dcm/contact: {} pairs of center-based cells start with an overlap "
                   "of more than half a radius",
                   nspheres);
  if (doubtful.empty()) return;
  solid_angles(lmp, fix_cell, bodies, queries);

  for (const auto &pair : doubtful) {
    const auto inside_both = [&queries](size_t n) {
      return queries[n].angle > 2.0 * dcm::PI && queries[n + 1].angle > 2.0 * dcm::PI;
    };
    const Body &a = bodies[pair.a], &b = bodies[pair.b];
    int both = 0;
    for (int k = 0; pair.close && k <= NSTEP; k++) both += inside_both(pair.query + 2 + 2 * k);
    if (both < 5 && inside_both(pair.query))
      error->all(
          FLERR,
          "Pair style dcm/contact: the center of cell {} lies inside cell {} at the start of "
          "the run; move them apart in the data file or the create_cells command",
          (b.radius < a.radius ? b : a).molecule, (b.radius < a.radius ? a : b).molecule);
    if (both < 5) continue;
    error->all(FLERR,
               "Pair style dcm/contact: cells {} and {} overlap by about {:.3} of the smaller "
               "radius ({:.4}) at the start of the run; move them apart in the data file or the "
               "create_cells command",
               a.molecule, b.molecule, 0.1 * both, std::min(a.radius, b.radius));
  }
}

/* ----------------------------------------------------------------------
   does x lie inside a cell, more than `least` from its surface? Asked of the few faces that seem
   to: those of sharp corners, as newborn cells have them, can lie far behind each other along the
   axis of a contact and yet next to the surface.
------------------------------------------------------------------------- */

// Winding number, of what is known here of the surface: 1 inside, 0 outside of one that is known to
// its end; just behind a wall whose other side is not known 0.5, just in front of it -0.5. The
// nearest face would not do: where a corner has turned inside out, it shows the wrong side.

static constexpr double INSIDE = 0.25;

bool PairDCMContact::deep_inside(const Vec3 &x, int cell, double least)
{
  const auto &faces = fix_cell->faces();
  if (faces_of_cell.empty()) {
    faces_of_cell.resize(fix_cell->cells().size());
    for (size_t f = 0; f < faces.size(); f++)
      if (faces[f].cell >= 0 && faces[f].whole()) faces_of_cell[faces[f].cell].push_back((int) f);
  }
  double *const *const at = atom->x;
  dcm::SurfaceDistance nearest;
  double winding = 0.0;
  for (const int f : faces_of_cell[cell]) {
    const Vec3 a = vec(at[faces[f].v[0]]), b = vec(at[faces[f].v[1]]), c = vec(at[faces[f].v[2]]);
    nearest.add(x, a, b, c);
    winding += dcm::face_winding(x, a, b, c);
  }
  return nearest.distance() > least && winding > INSIDE;
}

/* ----------------------------------------------------------------------
   does a face lie on the line through a point along u?
------------------------------------------------------------------------- */

static bool covers(const dcm::FaceGeometry &face, const Vec3 &point, const Vec3 &u)
{
  const double sign = face.n.dot(u) > 0.0 ? 1.0 : -1.0;
  for (int k = 0; k < 3; k++) {
    const Vec3 edge = face.x[(k + 1) % 3] - face.x[k];
    if (sign * edge.cross(point - face.x[k]).dot(u) < 0.0) return false;
  }
  return true;
}

/* ----------------------------------------------------------------------
   does a point of face fi lie in the cell of face gi, or one of gi in that of fi, deeper than
   `limit`? Around a ghost the other cell's surface is known as far as the ghosts reach, which is
   far enough next to an owned face.
------------------------------------------------------------------------- */

bool PairDCMContact::deep_in_each_other(int fi, const Vec3 &on_f, int gi, const Vec3 &on_g,
                                        double limit)
{
  const auto &faces = fix_cell->faces();
  const double known = own_cutoff - 2.0 * face_reach - neighbor->skin -
                       (geometry[gi].mid - geometry[fi].mid).norm();    // to their corners
  for (const auto &[point, here, wall] : {std::tuple(&on_f, fi, gi), std::tuple(&on_g, gi, fi)}) {
    if (here >= fix_cell->nowned() && known < limit) continue;
    if (deep_inside(*point, faces[wall].cell, limit)) return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   two faces that seem to be behind each other: does the middle of one of them, where it is in front
   of the other face, lie deep in the other cell, or else the place where they overlap most? It is
   the small cell's that tells, in front of any part of the other's face.
------------------------------------------------------------------------- */

bool PairDCMContact::ran_into(int fi, int gi, const Vec3 &u, double limit)
{
  const dcm::FaceGeometry &f = geometry[fi], &g = geometry[gi];
  const bool f_in_front = covers(g, f.mid, u), g_in_front = covers(f, g.mid, u);
  dcm::FaceOverlap most = {f.mid, g.mid, 0.0};
  if (!f_in_front || !g_in_front) {
    // no point is farther from a surface than from the point of it in front
    const bool deep = dcm::face_overlap(f, g, u, most) && most.depth > limit;
    if (!deep && !f_in_front && !g_in_front) return false;
  }
  return deep_in_each_other(fi, f_in_front ? f.mid : most.on_f, gi, g_in_front ? g.mid : most.on_g,
                            limit);
}

/* ----------------------------------------------------------------------
   the largest overlaps, anywhere in what two faces in contact have in common. Where there would be
   a warning, only what lies as deep inside the other cell: faces beside a sharp corner look as if
   they did.
------------------------------------------------------------------------- */

void PairDCMContact::note_overlap(int fi, int gi, const Vec3 &u, double limit)
{
  const dcm::FaceGeometry &f = geometry[fi], &g = geometry[gi];
  const double least = std::min(count.overlap, count.share * limit);
  if (!(dcm::overlap_bound(f, g, u) > least)) return;
  dcm::FaceOverlap most;
  if (!dcm::face_overlap(f, g, u, most) || !(most.depth > least)) return;
  if (most.depth > DEEP * limit &&
      !deep_in_each_other(fi, most.on_f, gi, most.on_g, 0.5 * DEEP * limit))
    return;
  count.overlap = std::max(count.overlap, most.depth);
  if (!(most.depth > count.share * limit)) return;
  const auto &faces = fix_cell->faces();
  count.share = most.depth / limit;
  count.deepest = most.depth;
  count.deep[0] = atom->molecule[faces[fi].atom];
  count.deep[1] = atom->molecule[faces[gi].atom];
}

/* ----------------------------------------------------------------------
   a sphere behind a face: is its center in the cell? Only just behind the face: farther there may
   be the other side of a thin cell.
------------------------------------------------------------------------- */

bool PairDCMContact::swallowed(int fi, int j)
{
  const dcm::FaceGeometry &f = geometry[fi];
  const Vec3 center = vec(atom->x[j]);
  const int cell = fix_cell->faces()[fi].cell;
  const double radius = atom->radius[j], depth = f.n.dot(f.mid - center);
  if ((center - f.mid).squaredNorm() < 0.25 * radius * radius) return true;
  return depth < std::max(radius, 0.5 * fix_cell->mean_edge(cell)) && covers(f, center, f.n) &&
         deep_inside(center, cell, 0.0);
}

/* ----------------------------------------------------------------------
   the largest overlap that a cell bears, from the mean edge and the radius of its own: the pair's
is that of the smaller cell. By the mesh or as the deck says, but no more than half the cell.
------------------------------------------------------------------------- */

double PairDCMContact::bearable(double edge, double radius) const
{
  const bool given = set.range > 0.0 || set.maxoverlap > 0.0;
  const double mesh = given ? overlap_used : std::max(RANGE * edge, 2.0 * h0_used);
  return std::min({overlap_used, mesh, 0.5 * radius});
}

/* ---------------------------------------------------------------------- */

const char *PairDCMContact::remedy_for_overlap() const
{
  return set.law == FOUNDATION
             ? "a thinner layer (pair_coeff keyword layer) or a larger E_contact keeps them apart"
             : "'pair_style dcm/contact law foundation' keeps them apart";
}

/* ----------------------------------------------------------------------
   the largest overlap of two deformable cells in the run, where it was looked for: for output, and
   when the list was new
------------------------------------------------------------------------- */

std::vector<DCMRole::Note> PairDCMContact::report()
{
  if (!(deepest.share > 0.0)) return {};
  Deepest most = deepest;
  MPI_Bcast(&most, sizeof(most), MPI_BYTE, most.rank, world);
  Note note;
  note.text = fmt::format(
      "largest overlap {:.3g}: cells {} and {} at step {}, {:.2g} of h0 {:.3g}, "
      "{:.2g} of what ends the run",
      most.depth, std::min(most.cells[0], most.cells[1]), std::max(most.cells[0], most.cells[1]),
      most.step, most.depth / h0_used, h0_used, most.share);
  if (most.share > DEEP) note.advice = remedy_for_overlap();
  return {note};
}

/* ----------------------------------------------------------------------
   how much of the box the cells take, and how deep they are in each other: where output is due,
   and when the list is new
------------------------------------------------------------------------- */

void PairDCMContact::measure_overlap()
{
  struct {
    double share;
    int rank;
  } worst = {count.share, comm->me};
  overlap = count.overlap;
  filled = 0.0;
  if (fix_cell) {
    MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
    MPI_Allreduce(MPI_IN_PLACE, &overlap, 1, MPI_DOUBLE, MPI_MAX, world);
    for (int i = 0; i < atom->nlocal; i++)    // a cell's volume is known where its center is
      if (dcm->kind[i] == AtomVecDCM::CENTER)
        filled += fix_cell->cells()[fix_cell->cell_of(i)].volume;
    MPI_Allreduce(MPI_IN_PLACE, &filled, 1, MPI_DOUBLE, MPI_SUM, world);
  }
  if (expect_spheres && domain->xperiodic && domain->yperiodic && domain->zperiodic) {
    double volume = 0.0;    // elsewhere they stick out of the box
    for (int i = 0; i < atom->nlocal; i++)
      if (dcm->kind[i] == AtomVecDCM::SPHERE)
        volume += 4.0 / 3.0 * dcm::PI * std::pow(atom->radius[i], 3);
    MPI_Allreduce(MPI_IN_PLACE, &volume, 1, MPI_DOUBLE, MPI_SUM, world);
    filled += volume;
  }
  filled /= domain->xprd * domain->yprd * domain->zprd;
  if (!fix_cell) return;

  if (worst.share > deepest.share)
    deepest = {
        worst.share, count.deepest, {count.deep[0], count.deep[1]}, update->ntimestep, worst.rank};
  const char *const remedy = remedy_for_overlap();
  if (filled > OVERFILLED && !warned_filled) {
    warned_filled = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "Pair style dcm/contact: the volumes of the cells add up to {:.4} of the box "
                     "at step {}, they share space; {}",
                     filled, update->ntimestep, remedy);
  }
  if (worst.share > DEEP && !warned_overlap) {
    warned_overlap = true;
    double depth = count.deepest;
    tagint cells[2] = {count.deep[0], count.deep[1]};
    MPI_Bcast(&depth, 1, MPI_DOUBLE, worst.rank, world);
    MPI_Bcast(cells, 2, MPI_LMP_TAGINT, worst.rank, world);
    if (comm->me == 0)
      error->warning(
          FLERR,
          "Pair style dcm/contact: cells {} and {} overlap by {:.4} at step {}, {:.2} of "
          "what ends the run; {}",
          cells[0], cells[1], depth, update->ntimestep, worst.share, remedy);
  }
}

/* ----------------------------------------------------------------------
   cells that ran into each other. In a step each process that sees it ends the run; in setup, where
   all have the time, it is one error, the same on any number of processes
------------------------------------------------------------------------- */

void PairDCMContact::fail_pair(int i, int j, double depth, double limit, double force)
{
  if (atom->molecule[i] > atom->molecule[j]) std::swap(i, j);
  std::string text;
  if (!std::isfinite(force) || !std::isfinite(depth))
    text = fmt::format("the contact of cells {} and {} (atoms {} and {}) has force {} at step {}; "
                       "coincident cells, or a timestep too large",
                       atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], force,
                       update->ntimestep);
  else if (update->setupflag)
    text = fmt::format(
        "cells {} and {} overlap at the start of the run: atoms {} and {} by {:.4} at step {}, "
        "more than {:.4}; move them apart in the data file or the create_cells command, or raise "
        "keyword range",
        atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], depth, update->ntimestep,
        limit);
  else
    text = fmt::format(
        "cells {} and {} run into each other: atoms {} and {} overlap by {:.4} at step {}, more "
        "than {:.4}; reduce the timestep or fix dcm/motion maxmove, give the cells a stiffer or "
        "tenser cortex or a stiffer contact (law foundation), or raise keyword range, which counts "
        "up to half the radius of the smaller cell",
        atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], depth, update->ntimestep,
        limit);
  if (!update->setupflag) error->one(FLERR, "Pair style dcm/contact: {}", text);
  const tagint a = atom->tag[i], b = atom->tag[j];
  if (first_fault.i == 0 || std::tie(a, b) < std::tie(first_fault.i, first_fault.j))
    first_fault = {a, b, text};
}

void PairDCMContact::report_fault()
{
  tagint mine[2] = {first_fault.i ? first_fault.i : MAXTAGINT, first_fault.j}, lowest[2];
  MPI_Allreduce(mine, lowest, 1, MPI_LMP_TAGINT, MPI_MIN, world);
  if (lowest[0] == MAXTAGINT) return;
  if (mine[0] != lowest[0]) mine[1] = MAXTAGINT;
  MPI_Allreduce(mine + 1, lowest + 1, 1, MPI_LMP_TAGINT, MPI_MIN, world);
  int rank = mine[0] == lowest[0] && mine[1] == lowest[1] ? comm->me : comm->nprocs, teller;
  MPI_Allreduce(&rank, &teller, 1, MPI_INT, MPI_MIN, world);
  std::string text = first_fault.text;
  first_fault = Fault();
  dcm_bcast(world, text, teller);
  error->all(FLERR, "Pair style dcm/contact: {}", text);
}
