/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: measures and checks at the start of a run, new neighbor lists, restart
// files

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_compat.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "fix_neigh_history.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

// factor by which the largest face may have changed between runs for its size to be kept

static constexpr double FACE_KEEP = 1.2;

/* ----------------------------------------------------------------------
   mean edge and largest face per type, at a time when no ghosts exist yet:
   vertices that other ranks own are asked from all
------------------------------------------------------------------------- */

void PairDCMContact::measure_mesh()
{
  mean_edge = face_radius_max = 0.0;
  if (!have_faces) return;
  const int nlocal = atom->nlocal;

  std::vector<tagint> mine;
  auto owned = [&](tagint tag) {
    const int j = tag > atom->map_tag_max ? -1 : atom->map(tag);    // map() does not check
    return j >= 0 && j < nlocal ? j : -1;
  };
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::FACE) continue;
    for (int k = 0; k < 3; k++) {
      const tagint tag = atom->tag[i] + dcm->vertex[i][k];
      if (owned(tag) < 0) mine.push_back(tag);
    }
  }
  const int n = (int) mine.size();
  std::vector<int> counts(comm->nprocs), offsets(comm->nprocs, 0);
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < comm->nprocs; p++) offsets[p] = offsets[p - 1] + counts[p - 1];
  std::vector<tagint> asked(offsets.back() + counts.back());
  MPI_Allgatherv(mine.data(), n, MPI_LMP_TAGINT, asked.data(), counts.data(), offsets.data(),
                 MPI_LMP_TAGINT, world);
  std::vector<double> answer(3 * asked.size(), 0.0);
  for (size_t m = 0; m < asked.size(); m++) {
    const int j = owned(asked[m]);
    if (j >= 0) vec(&answer[3 * m]) = vec(atom->x[j]);
  }
  if (!answer.empty())
    MPI_Allreduce(MPI_IN_PLACE, answer.data(), (int) answer.size(), MPI_DOUBLE, MPI_SUM, world);

  std::vector<double> largest(atom->ntypes + 1, 0.0);
  double sums[2] = {0.0, 0.0};
  const double *next = answer.data() + 3 * (size_t) offsets[comm->me];
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::FACE) continue;
    Vec3 v[3];
    for (int k = 0; k < 3; k++) {
      const int j = owned(atom->tag[i] + dcm->vertex[i][k]);
      if (j >= 0) {
        v[k] = vec(atom->x[j]);
      } else {
        v[k] = vec(next);
        next += 3;
      }
      if (k == 0) continue;
      Vec3 d = v[k] - v[0];
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      v[k] = v[0] + d;
    }
    const Vec3 mid = (v[0] + v[1] + v[2]) / 3.0;
    for (int k = 0; k < 3; k++) {
      largest[atom->type[i]] = std::max(largest[atom->type[i]], (v[k] - mid).norm());
      sums[0] += (v[(k + 1) % 3] - v[k]).norm();
      sums[1] += 1.0;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), atom->ntypes + 1, MPI_DOUBLE, MPI_MAX, world);
  mean_edge = sums[0] / sums[1];

  // keep the sizes of an earlier run while they fit: bins, and with them the order of sums, and
  // the ghost cutoff stay as they were when a run is continued or restarted

  face_radius.resize(atom->ntypes + 1, 0.0);
  for (int t = 1; t <= atom->ntypes; t++) {
    const double ratio = largest[t] / face_radius[t];
    if (!(ratio < FACE_KEEP && ratio > 1.0 / FACE_KEEP)) face_radius[t] = largest[t];
    if (types[t].kind == AtomVecDCM::FACE) types[t].radius = face_radius[t];
    face_radius_max = std::max(face_radius_max, face_radius[t]);
  }
}

// a cell as the start check sees it: the sphere of its volume

namespace {
struct Body {
  tagint molecule;
  double x[3], radius;
  int cell;    // index into FixDCMCell::cells, -1: center-based
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
  std::vector<std::vector<int>> of_cell(fix ? fix->cells.size() : 0);
  std::vector<double> angles(queries.size(), 0.0);
  for (size_t q = 0; q < queries.size(); q++) {
    const Body &body = bodies[queries[q].body];
    if (body.cell >= 0) of_cell[body.cell].push_back((int) q);
  }
  for (int f = 0; fix && f < fix->nowned; f++) {
    const auto &face = fix->faces[f];
    for (int q : of_cell[face.cell]) {
      double *const *const x = lmp->atom->x;
      Vec3 a = vec(x[face.v[0]]) - queries[q].point;
      dcm_minimum_image(lmp->domain, a[0], a[1], a[2]);
      const Vec3 b = a + (vec(x[face.v[1]]) - vec(x[face.v[0]]));
      const Vec3 c = a + (vec(x[face.v[2]]) - vec(x[face.v[0]]));
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      angles[q] += 2.0 * std::atan2(a.dot(b.cross(c)),
                                    la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la);
    }
  }
  if (fix) fix->sum(angles);
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
  if (set.law != MAUGIS || !have_faces) return;
  const double R = 0.5 * radius;
  for (int s = 1; s <= atom->ntypes; s++)
    for (int t = s; t <= atom->ntypes; t++) {
      if (types[s].kind != AtomVecDCM::FACE && types[t].kind != AtomVecDCM::FACE) continue;
      const auto &m = table[(size_t) AtomVecDCM::NREGION * ((s - 1) * nclass + t - 1)];
      if (!types[s].active || !types[t].active || !types[s].kind || !types[t].kind) continue;
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
  const int nbytes = (int) (mine.size() * sizeof(Body));
  std::vector<int> counts(comm->nprocs), offsets(comm->nprocs, 0);
  MPI_Allgather(&nbytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < comm->nprocs; p++) offsets[p] = offsets[p - 1] + counts[p - 1];
  bodies.resize((offsets.back() + counts.back()) / sizeof(Body));
  MPI_Allgatherv(mine.data(), nbytes, MPI_BYTE, bodies.data(), counts.data(), offsets.data(),
                 MPI_BYTE, world);
  for (size_t c = 0; fix_cell && c < fix_cell->cells.size(); c++) {
    const auto &cell = fix_cell->cells[c];
    bodies.push_back({cell.molecule,
                      {cell.x[0], cell.x[1], cell.x[2]},
                      std::cbrt(0.75 / dcm::PI * cell.volume),
                      (int) c});
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
  for (int a = comm->me; a < nbodies; a += comm->nprocs)
    for (int b = a + 1; b < nbodies; b++) {
      Vec3 d = vec(bodies[b].x) - vec(bodies[a].x);
      const double Ra = bodies[a].radius, Rb = bodies[b].radius;
      const double limit = Ra + Rb - 0.5 * std::min(Ra, Rb);
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      if (d.squaredNorm() < limit * limit) near_mine.insert(near_mine.end(), {a, b});
    }
  const int n = (int) near_mine.size();
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < comm->nprocs; p++) offsets[p] = offsets[p - 1] + counts[p - 1];
  near_all.resize(offsets.back() + counts.back());
  MPI_Allgatherv(near_mine.data(), n, MPI_INT, near_all.data(), counts.data(), offsets.data(),
                 MPI_INT, world);

  // two center-based cells may overlap far: after a division, or pressed

  constexpr int NSTEP = 36;    // samples on the line, a tenth of the smaller radius apart
  std::vector<Query> queries;
  std::vector<std::pair<int, int>> doubtful;
  int nspheres = 0;
  for (size_t m = 0; m < near_all.size(); m += 2) {
    const int a = near_all[m], b = near_all[m + 1];
    if (bodies[a].cell < 0 && bodies[b].cell < 0) {
      nspheres++;
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
   after each rebuild: sort the neighbor list by kind, so that the loops of
   every step neither look up kinds nor meet pairs that never interact
------------------------------------------------------------------------- */

void PairDCMContact::sort_pairs()
{
  check_radii();
  built = neighbor->lastcall;
  face_pairs.clear();
  mixed_pairs.clear();
  sphere_pairs.clear();
  face_touch.clear();
  mixed_touch.clear();
  sphere_touch.clear();

  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    if (!types[atom->type[i]].active) continue;
    const int *jlist = list->firstneigh[i];
    const int jnum = list->numneigh[i];
    int *touch = use_history ? fix_history->firstflag[i] : nullptr;
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      if (types[atom->type[j]].active) add_pair(i, j, touch ? touch + jj : nullptr);
    }
  }

  used_faces.clear();
  if (!fix_cell) return;
  geometry.resize(fix_cell->faces.size());
  outline.resize(fix_cell->faces.size());
  face_class.assign(fix_cell->faces.size(), -1);
  auto use = [this](int f) {
    if (face_class[f] >= 0) return;
    face_class[f] = 0;
    used_faces.push_back(f);
  };
  for (const auto &pair : face_pairs) {
    use(pair.f);
    use(pair.g);
  }
  for (const auto &pair : mixed_pairs) use(pair.i);

  const auto &faces = fix_cell->faces;
  for (int f : used_faces) {
    const int *v = faces[f].v;
    if (v[0] >= 0 && v[1] >= 0 && v[2] >= 0) continue;
    error->one(
        FLERR,
        "Pair style dcm/contact: a vertex of face {} (cell {}) lies beyond the ghost cutoff "
        "at step {}; nodes must be known {:.4} away: set 'comm_modify cutoff {:.4}' or, with "
        "mode multi, this cutoff for the atom types of nodes",
        atom->tag[faces[f].atom], atom->molecule[faces[f].atom], update->ntimestep, own_cutoff,
        own_cutoff);
  }
}

/* ----------------------------------------------------------------------
   the two faces stand in the order of their IDs, so that a pair is computed
   in the same way on whatever rank
------------------------------------------------------------------------- */

void PairDCMContact::add_pair(int i, int j, int *touch)
{
  const int ki = dcm->kind[i], kj = dcm->kind[j];
  if (atom->molecule[i] == atom->molecule[j]) return;
  if (ki == AtomVecDCM::FACE && kj == AtomVecDCM::FACE) {
    if (atom->tag[i] > atom->tag[j]) std::swap(i, j);
    face_pairs.push_back({fix_cell->face_of[i], fix_cell->face_of[j]});
    if (use_history && set.history) face_touch.push_back(touch);
  } else if (ki == AtomVecDCM::SPHERE && kj == AtomVecDCM::SPHERE) {
    if (atom->tag[i] > atom->tag[j]) std::swap(i, j);
    sphere_pairs.push_back({i, j});
    sphere_touch.push_back(touch);
  } else if (ki == AtomVecDCM::FACE && kj == AtomVecDCM::SPHERE) {
    mixed_pairs.push_back({fix_cell->face_of[i], j});
    if (use_history && set.history) mixed_touch.push_back(touch);
  } else if (ki == AtomVecDCM::SPHERE && kj == AtomVecDCM::FACE) {
    mixed_pairs.push_back({fix_cell->face_of[j], i});
    if (use_history && set.history) mixed_touch.push_back(touch);
  }
}

/* ----------------------------------------------------------------------
   a face or sphere larger than what the list was built for may miss partners
------------------------------------------------------------------------- */

void PairDCMContact::check_radii()
{
  for (int i = 0; i < atom->nlocal; i++) {
    const TypeInfo &info = types[atom->type[i]];
    const int kind = dcm->kind[i];
    if (kind != AtomVecDCM::FACE && kind != AtomVecDCM::SPHERE) continue;
    if (!info.used) continue;
    if (!info.active)
      error->one(FLERR,
                 "Pair style dcm/contact: atom {} is a {} but its type {} held none when the run "
                 "started; give faces and spheres atom types of their own",
                 atom->tag[i], kind == AtomVecDCM::FACE ? "face" : "sphere", atom->type[i]);
    if (kind == AtomVecDCM::FACE && !fix_cell)
      error->one(FLERR, "Pair style dcm/contact: face {} appeared without a fix dcm/cell",
                 atom->tag[i]);
    if (atom->radius[i] > info.promise)
      error->one(FLERR,
                 "Pair style dcm/contact: the {} {} of cell {} has grown to radius {:.4} at step "
                 "{}, beyond the {:.4} for which the neighbor list was prepared at the start of "
                 "this run; split the run ('run N every M') or look for a mesh that falls apart",
                 kind == AtomVecDCM::FACE ? "face" : "sphere", atom->tag[i], atom->molecule[i],
                 atom->radius[i], update->ntimestep, info.promise);
  }
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
  error->one(FLERR,
             "Pair style dcm/contact: cells {} and {} run into each other: atoms {} and {} overlap "
             "by {:.4} at step {}, more than {:.4}; reduce the timestep or fix dcm/motion maxmove, "
             "give the cells a stiffer or tenser cortex, or raise keyword range",
             atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], overlap,
             update->ntimestep, limit);
}

/* ----------------------------------------------------------------------
   each pair of cells once; the order of a stable sort, so that sums repeat
------------------------------------------------------------------------- */

void PairDCMContact::merge_partners()
{
  std::stable_sort(partner_list.begin(), partner_list.end(),
                   [](const Partner &p, const Partner &q) {
                     return p.molecule != q.molecule ? p.molecule < q.molecule : p.other < q.other;
                   });
  size_t n = 0;
  for (size_t m = 0; m < partner_list.size(); m++) {
    if (n && partner_list[n - 1].molecule == partner_list[m].molecule &&
        partner_list[n - 1].other == partner_list[m].other)
      partner_list[n - 1].area += partner_list[m].area;
    else
      partner_list[n++] = partner_list[m];
  }
  partner_list.resize(n);
}

/* ----------------------------------------------------------------------
   restart files keep the settings and the lengths derived from the mesh;
   cell types come again from pair_coeff
------------------------------------------------------------------------- */

void PairDCMContact::write_restart(FILE *fp)
{
  fwrite(&set, sizeof(Settings), 1, fp);
  fwrite(&h0_used, sizeof(double), 1, fp);
  fwrite(&range_used, sizeof(double), 1, fp);
  fwrite(&own_cutoff, sizeof(double), 1, fp);
  face_radius.resize(atom->ntypes + 1, 0.0);
  fwrite(face_radius.data(), sizeof(double), face_radius.size(), fp);
}

void PairDCMContact::read_restart(FILE *fp)
{
  face_radius.assign(atom->ntypes + 1, 0.0);
  if (comm->me == 0) {
    utils::sfread(FLERR, &set, sizeof(Settings), 1, fp, nullptr, error);
    utils::sfread(FLERR, &h0_used, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &range_used, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &own_cutoff, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, face_radius.data(), sizeof(double), face_radius.size(), fp, nullptr,
                  error);
  }
  MPI_Bcast(&set, sizeof(Settings), MPI_BYTE, 0, world);
  MPI_Bcast(&h0_used, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&range_used, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&own_cutoff, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(face_radius.data(), (int) face_radius.size(), MPI_DOUBLE, 0, world);
}

/* ---------------------------------------------------------------------- */

void *PairDCMContact::extract(const char *name, int &dim)
{
  dim = 0;
  if (strcmp(name, "h0") == 0) return &h0_used;
  if (strcmp(name, "range") == 0) return &range_used;
  return nullptr;
}

double PairDCMContact::memory_usage()
{
  double bytes = Pair::memory_usage();
  bytes += (double) (face_pairs.capacity() + mixed_pairs.capacity() + sphere_pairs.capacity()) *
           sizeof(FacePair);
  bytes += (double) (face_touch.capacity() + mixed_touch.capacity() + sphere_touch.capacity()) *
           sizeof(int *);
  bytes += (double) geometry.capacity() * sizeof(dcm::FaceGeometry);
  bytes += (double) (area.capacity() + stress.capacity() + moment.capacity() + modulus.capacity()) *
           sizeof(double);
  bytes += (double) contacts.capacity() * sizeof(dcm::ContactBlock);
  bytes += (double) spheres.capacity() * sizeof(dcm::EdgeBlock);
  bytes += (double) table.capacity() * sizeof(dcm::ContactMaterial);
  return bytes;
}
