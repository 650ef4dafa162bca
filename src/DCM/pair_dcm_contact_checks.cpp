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
#include "law/solid_angle.h"
#include "law/triangle.h"
#include "law/volume.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

// a cell as the start check sees it: the sphere of its volume

namespace {
struct Body {
  tagint molecule;
  double x[3], radius;
  int cell;    // row of the table of cells, -1: center-based
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
   cells that are given inside each other: faces that start on the wrong side
   see no contact at all, so no force would ever tell
   first the spheres of equal volume, then, where these overlap by half a radius, how long the line
   through both centers runs inside both surfaces
------------------------------------------------------------------------- */

void PairDCMContact::check_start()
{
  // not again when a run just goes on
  if (checked_step == update->ntimestep && checked_atoms == atom->natoms) return;
  checked_atoms = atom->natoms;

  std::vector<Body> mine, bodies;
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::SPHERE)
      mine.push_back(
          {atom->molecule[i], {atom->x[i][0], atom->x[i][1], atom->x[i][2]}, atom->radius[i], -1});
  bodies = dcm_allgather(mine, world);
  for (const int c : fix_cell ? fix_cell->cells().all_deformable() : std::vector<int>()) {
    const auto &cell = fix_cell->cells()[c];
    bodies.push_back(
        {cell.molecule, {cell.x[0], cell.x[1], cell.x[2]}, dcm::ball_radius(cell.volume), c});
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
    largest = std::max(largest, body.radius);
  }
  const DCMCellBins bins(domain, places, std::max(2.0 * largest, 1.0e-6 * domain->prd[0]));
  for (int a = comm->me; a < nbodies; a += comm->nprocs)
    for (const int b : bins.near(bodies[a].x)) {
      if (b <= a) continue;
      Vec3 d = vec(bodies[b].x) - vec(bodies[a].x);
      const double Ra = bodies[a].radius, Rb = bodies[b].radius;
      const double limit = Ra + Rb - 0.5 * std::min(Ra, Rb);
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      if (d.squaredNorm() < limit * limit) near_mine.insert(near_mine.end(), {a, b});
    }
  near_all = dcm_allgather(near_mine, world);

  // two center-based cells may overlap far: after a division, or pressed

  constexpr int NSTEP = 36;    // samples on the line, a tenth of the smaller radius apart
  std::vector<Query> queries;
  std::vector<std::pair<int, int>> doubtful;
  int nspheres = 0;
  for (size_t m = 0; m < near_all.size(); m += 2) {
    const int a = near_all[m], b = near_all[m + 1];
    if (bodies[a].cell < 0 && bodies[b].cell < 0) {
      if (find_sisters(bodies[a].molecule, bodies[b].molecule) < 0) nspheres++;
      continue;
    }
    doubtful.emplace_back(a, b);
    Vec3 d = vec(bodies[b].x) - vec(bodies[a].x);
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    const double small = std::min(bodies[a].radius, bodies[b].radius);
    const Vec3 u = d.norm() > 1.0e-6 * small ? Vec3(d.normalized()) : Vec3(Vec3::UnitX());
    const Vec3 mid = vec(bodies[a].x) + 0.5 * d;
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

  for (size_t m = 0; m < doubtful.size(); m++) {
    int both = 0;
    const Query *q = &queries[m * 2 * (NSTEP + 1)];
    for (int k = 0; k <= NSTEP; k++)
      if (q[2 * k].angle > 2.0 * dcm::PI && q[2 * k + 1].angle > 2.0 * dcm::PI) both++;
    if (both < 5) continue;
    const Body &a = bodies[doubtful[m].first], &b = bodies[doubtful[m].second];
    error->all(FLERR,
               "Pair style dcm/contact: cells {} and {} overlap by about {:.3} of the smaller "
               "radius ({:.4}) at the start of the run; move them apart in the data file or the "
               "create_cells command",
               a.molecule, b.molecule, 0.1 * both, std::min(a.radius, b.radius));
  }
}

/* ----------------------------------------------------------------------
   does x lie inside a cell, farther from its surface than an overlap may be? Asked of
   the few faces that seem to: those of sharp corners, as newborn cells have them, can lie
   far behind each other along the axis of a contact and yet next to the surface.
------------------------------------------------------------------------- */

bool PairDCMContact::deep_inside(const Vec3 &x, int cell) const
{
  double *const *const at = atom->x;
  dcm::SurfaceDistance nearest;
  for (const auto &face : fix_cell->faces()) {
    if (face.cell != cell || face.v[0] < 0 || face.v[1] < 0 || face.v[2] < 0 || face.torn) continue;
    nearest.add(x, vec(at[face.v[0]]), vec(at[face.v[1]]), vec(at[face.v[2]]));
  }
  return nearest.inside() && nearest.distance() > overlap_used;
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::fail_pair(int i, int j, double overlap, double limit, double force)
{
  if (!std::isfinite(force) || !std::isfinite(overlap))
    error->one(FLERR,
               "Pair style dcm/contact: the contact of cells {} and {} (atoms {} and {}) has force "
               "{} at step {}; coincident cells, or a timestep too large",
               atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], force,
               update->ntimestep);
  if (update->setupflag)
    error->one(FLERR,
               "Pair style dcm/contact: cells {} and {} overlap at the start of the run: atoms {} "
               "and {} by {:.4} at step {}, more than {:.4}; move them apart in the data file or "
               "the create_cells command, or raise keyword range",
               atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], overlap,
               update->ntimestep, limit);
  error->one(FLERR,
             "Pair style dcm/contact: cells {} and {} run into each other: atoms {} and {} overlap "
             "by {:.4} at step {}, more than {:.4}; reduce the timestep or fix dcm/motion maxmove, "
             "give the cells a stiffer or tenser cortex, or raise keyword range",
             atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], overlap,
             update->ntimestep, limit);
}
