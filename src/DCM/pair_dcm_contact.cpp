/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: a step: contacts of faces, what it hands over to others, communication

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "law/curvature.h"
#include "law/volume.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "neighbor.h"
#include "platform.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static constexpr int NREGION = AtomVecDCM::NREGION;

// reach of a concave face in find_candidates(): only the exact test can tell

static constexpr float ALWAYS = 1.0e9f;

// cosine between the normals of faces that certainly look at each other

static constexpr double OPPOSED = -0.7;

// the faces of a pair lie anywhere in memory: fetch those of a later pair while computing this one

static constexpr size_t AHEAD = 4, FAR_AHEAD = 16;

template <class State, bool HISTORY>
constexpr std::array<PairDCMContact::Contacts, 2> PairDCMContact::contacts_of()
{
  return {&PairDCMContact::compute_cells<State, HISTORY, false>,
          &PairDCMContact::compute_cells<State, HISTORY, true>};
}

// the contact laws of keyword law: a new one is a header in law/ and a line here, at the end

const PairDCMContact::Law PairDCMContact::LAWS[] = {
    {"dmt", contacts_of<dcm::DmtState, false>(), {nullptr, nullptr}},
    {"maugis", contacts_of<dcm::MaugisState, false>(), contacts_of<dcm::MaugisState, true>()}};

std::vector<std::string> PairDCMContact::law_names()
{
  std::vector<std::string> names;
  for (const auto &law : LAWS) names.emplace_back(law.name);
  return names;
}

static inline void prefetch(const dcm::FaceGeometry *face)
{
  const char *bytes = reinterpret_cast<const char *>(face);
  for (size_t line = 0; line < sizeof(dcm::FaceGeometry); line += 64)
    __builtin_prefetch(bytes + line);
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::compute(int eflag, int vflag)
{
  const double start = platform::walltime();
  ev_init(eflag, vflag);

  count = Counters();
  if (neighbor->ago == 0 || built != neighbor->lastcall) sort_pairs();
  count.pairs = (bigint) face_pairs.size() + mixed_pairs.size() + sphere_pairs.size();
  if (update->setupflag) check_start();
  checked_step = update->ntimestep;
  count.list_seconds = platform::walltime() - start;

  find_wanted();
  const int nall = atom->nlocal + atom->nghost;
  area.assign(nall, 0.0);
  if (want_stress) stress.assign(nall, 0.0);
  if (want_virial) moment.assign(nall, 0.0);
  clear_blocks();
  if (want_partners) {
    partner_list.clear();
    partners_merged = false;
  }

  if (fix_cell) {
    make_faces();
    const Law &law = LAWS[set.law];
    (this->*(set.history ? law.with_history : law.contacts)[want_stiffness])();
  }
  if (any_apparent) compute_moduli();
  compute_spheres(eflag);

  commmode = SUMS;
  comm->reverse_comm(this, 1 + want_stress + want_virial);

  if (vflag_fdotr) virial_fdotr_compute();

  pvector[0] = (double) count.pairs;
  pvector[1] = (double) count.contacts;
  pvector[2] = count.area;
  count.seconds = platform::walltime() - start;
  pvector[3] = count.seconds;
}

/* ----------------------------------------------------------------------
   what is recorded in this step
------------------------------------------------------------------------- */

void PairDCMContact::find_wanted()
{
  want_stress = stress_requests.any();
  want_virial = virial_requests.any();
  want_stiffness = (traits_of_deck & IMPLICIT) || stiffness_requests.any();
  want_blocks = (traits_of_deck & MOVES) || blocks_requests.any() || want_stiffness;
  want_partners = false;
  partner_requests.each([this](int every) {
    if (update->setupflag || update->ntimestep % every == 0) want_partners = true;
  });
}

/* ----------------------------------------------------------------------
   spheres through the faces that have a partner in the list
------------------------------------------------------------------------- */

void PairDCMContact::make_faces()
{
  const auto &faces = fix_cell->faces();
  double *const *const x = atom->x;

  const auto &table = fix_cell->cells();
  rmax_cell.resize(table.size());
  for (const int c : table.deformable())
    rmax_cell[c] = set.rmax * dcm::ball_radius(table[c].volume);

  double scale = 0.0;
  for (int f : used_faces) {
    const auto &face = faces[f];
    const int *v = face.v;
    const double k =
        (fix_cell->curvature(v[0]) + fix_cell->curvature(v[1]) + fix_cell->curvature(v[2])) / 3.0;
    const double R = dcm::face_radius(k, 0.0, 0.0, rmax_cell[face.cell], set.concave);
    const dcm::FaceGeometry &g = geometry[f] =
        dcm::make_face(vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]]), R);
    face_class[f] = NREGION * (atom->type[face.atom] - 1) + dcm->region[face.atom];

    const double size = g.center.cwiseAbs().maxCoeff() + std::fabs(g.R);
    if (!std::isfinite(size))
      error->one(FLERR,
                 "Pair style dcm/contact: face {} of cell {} has no finite position at step {}; "
                 "reduce the timestep",
                 atom->tag[face.atom], atom->molecule[face.atom], update->ntimestep);
    scale = std::max(scale, size);
    Outline &o = outline[f];
    for (int m = 0; m < 3; m++) {
      o.mid[m] = (float) g.mid[m];
      o.center[m] = (float) g.center[m];
    }
    o.R = (float) g.R;
    o.reach = g.R > 0.0 ? (float) g.reach : ALWAYS;
  }
  blur = 8.0 * FLT_EPSILON * scale;
}

/* ----------------------------------------------------------------------
   pairs that may be in contact: spheres that come closer than h0, centroids
   that are close across the axis of the spheres. In single precision, on 32
   bytes a face, and without branches, since nine in ten pairs end here; blur
   covers the round-off, so no pair is lost that the exact tests would take.
------------------------------------------------------------------------- */

void PairDCMContact::find_candidates()
{
  const size_t npairs = face_pairs.size();
  candidates.resize(npairs);
  int *const out = candidates.data();
  const FacePair *const pairs = face_pairs.data();
  const Outline *const lines = outline.data();
  const float slack = (float) (range_used + blur), gap = (float) (h0_used + blur);
  const float tiny = (float) blur;
  size_t n = 0;
  for (size_t m = 0; m < npairs; m++) {
    // reading on after the last pair reads the first again
    const FacePair &next = pairs[m + FAR_AHEAD < npairs ? m + FAR_AHEAD : 0];
    __builtin_prefetch(&lines[next.f]);
    __builtin_prefetch(&lines[next.g]);
    const Outline &f = lines[pairs[m].f], &g = lines[pairs[m].g];
    const float dx = g.mid[0] - f.mid[0], dy = g.mid[1] - f.mid[1], dz = g.mid[2] - f.mid[2];
    const float ax = g.center[0] - f.center[0], ay = g.center[1] - f.center[1];
    const float az = g.center[2] - f.center[2];
    const float apart = dx * dx + dy * dy + dz * dz;
    const float axis = ax * ax + ay * ay + az * az;
    const float along = dx * ax + dy * ay + dz * az;
    const float bound = f.reach + g.reach + tiny;
    const float sum = f.R + g.R + gap;
    const bool close = apart < (bound + slack) * (bound + slack);
    const bool beside = apart * axis - along * along < (bound * bound + 1e-5f * apart) * axis;
    const bool touching = axis < sum * sum;
    out[n] = (int) m;
    n += close & ((beside & touching) | (bound > 0.5f * ALWAYS));
  }
  candidates.resize(n);
}

/* ----------------------------------------------------------------------
   contacts of deformable cells; the law, and whether it remembers who has touched, are fixed
   before the loops
------------------------------------------------------------------------- */

template <class State, bool HISTORY, bool SLOPE> void PairDCMContact::compute_cells()
{
  compute_faces<State, HISTORY, SLOPE>();
  compute_mixed<State, HISTORY, SLOPE>();
}

/* ----------------------------------------------------------------------
   do the projections along the axis lie on two sides of a line? Tried is the line across the
   connection of their centroids, which settles most pairs at a fraction of the full test.
------------------------------------------------------------------------- */

static inline bool separated(const dcm::FaceGeometry &f, const dcm::FaceGeometry &g,
                             const Vec3 &apart)
{
  if (!(f.R > 0.0 && g.R > 0.0)) return false;    // concave: the axis may be another one
  const Vec3 axis = g.center - f.center;
  const Vec3 side = apart - axis * (apart.dot(axis) / axis.squaredNorm());
  double front = 0.0, back = 0.0;
  for (int k = 0; k < 3; k++) {
    front = std::max(front, side.dot(f.x[k] - f.mid));
    back = std::max(back, side.dot(g.mid - g.x[k]));
  }
  return front + back < side.squaredNorm();
}

/* ----------------------------------------------------------------------
   does a face lie on the line through a point along u?
------------------------------------------------------------------------- */

static inline bool covers(const dcm::FaceGeometry &face, const Vec3 &point, const Vec3 &u)
{
  const double sign = face.n.dot(u) > 0.0 ? 1.0 : -1.0;
  for (int k = 0; k < 3; k++) {
    const Vec3 edge = face.x[(k + 1) % 3] - face.x[k];
    if (sign * edge.cross(point - face.x[k]).dot(u) < 0.0) return false;
  }
  return true;
}

/* ---------------------------------------------------------------------- */

template <class State, bool HISTORY, bool SLOPE> void PairDCMContact::compute_faces()
{
  const auto &faces = fix_cell->faces();
  double *const *const force_of = atom->f;
  if (!HISTORY) find_candidates();
  const size_t npairs = HISTORY ? face_pairs.size() : candidates.size();
  dcm::ContactResult r;

  for (size_t m = 0; m < npairs; m++) {
    const size_t n = HISTORY ? m : candidates[m];
    if (m + AHEAD < npairs) {
      const FacePair &next = face_pairs[HISTORY ? m + AHEAD : candidates[m + AHEAD]];
      prefetch(&geometry[next.f]);
      prefetch(&geometry[next.g]);
    }
    const int fi = face_pairs[n].f, gi = face_pairs[n].g;
    const dcm::FaceGeometry &f = geometry[fi], &g = geometry[gi];

    // what is farther apart may or may not be in the list: never look at it, so that results do
    // not depend on when the list was built

    const Vec3 apart = g.mid - f.mid;
    const double bound = f.reach + g.reach + range_used;
    const dcm::ContactMaterial &mat = table[face_class[fi] * nclass + face_class[gi]];
    if (!(apart.squaredNorm() < bound * bound) || (!HISTORY && separated(f, g, apart)) ||
        !dcm::face_face<State, SLOPE>(f, g, mat, set.points, r, HISTORY && *face_touch[n])) {
      if (HISTORY) *face_touch[n] = 0;
      continue;
    }
    // faces that have passed through each other look at each other and have their middles on the
    // same line; others so far behind each other stand beside the same fold or corner, as those of
    // newborn cells do, and do not touch

    const auto &face = faces[fi], &other = faces[gi];
    const double weight = dcm::facing(f.n.dot(r.u)) * dcm::facing(-g.n.dot(r.u));
    const double overlap = -apart.dot(r.u);
    const bool beyond = !(overlap <= overlap_used), opposed = !(f.n.dot(g.n) > OPPOSED);
    if (!std::isfinite(r.force) ||
        (beyond && opposed && covers(f, g.mid, r.u) && covers(g, f.mid, r.u) &&
         (deep_inside(f.mid, other.cell) || deep_inside(g.mid, face.cell))))
      fail_pair(face.atom, other.atom, overlap, overlap_used, r.force);
    const bool touching = !beyond && weight > 0.0;
    if (HISTORY) *face_touch[n] = touching;
    if (!touching) continue;
    r.scale(weight);
    count.overlap = std::max(count.overlap, overlap);
    count.contacts++;
    count.area += r.area;

    for (int k = 0; k < 3; k++) {
      vec(force_of[face.v[k]]) -= r.wf[k] * r.u;
      vec(force_of[other.v[k]]) += r.wg[k] * r.u;
    }
    area[face.atom] += r.area;
    area[other.atom] += r.area;
    if (want_stress) {
      stress[face.atom] += r.force;
      stress[other.atom] += r.force;
    }
    if (want_partners) add_partner(atom->molecule[face.atom], atom->molecule[other.atom], r.area);
    if (want_blocks)
      contacts.push_back({{face.v[0], face.v[1], face.v[2], other.v[0], other.v[1], other.v[2]},
                          {r.bf[0], r.bf[1], r.bf[2], -r.bg[0], -r.bg[1], -r.bg[2]},
                          {r.u[0], r.u[1], r.u[2]},
                          r.area * mat.gn,
                          r.area * mat.gt});
    if constexpr (SLOPE) contact_slope.push_back(std::max(0.0, weight * r.slope));
  }
}

/* ----------------------------------------------------------------------
   a deformable cell's face against a center-based cell
------------------------------------------------------------------------- */

template <class State, bool HISTORY, bool SLOPE> void PairDCMContact::compute_mixed()
{
  const auto &faces = fix_cell->faces();
  double *const *const force_of = atom->f;
  double *const *const x = atom->x;
  const size_t npairs = mixed_pairs.size();
  dcm::ContactResult r;

  for (size_t n = 0; n < npairs; n++) {
    const int fi = mixed_pairs[n].i, j = mixed_pairs[n].j;
    const dcm::FaceGeometry &f = geometry[fi];
    const double radius = atom->radius[j];
    const Vec3 apart = vec(x[j]) - f.mid;
    const double bound = f.reach + radius + 0.5 * range_used;
    const dcm::ContactMaterial &mat =
        table[face_class[fi] * nclass + NREGION * (atom->type[j] - 1)];
    if (!(apart.squaredNorm() < bound * bound) ||
        !dcm::face_sphere<State, SLOPE>(f, vec(x[j]), radius, mat, set.points, r,
                                        HISTORY && *mixed_touch[n])) {
      if (HISTORY) *mixed_touch[n] = 0;
      if (apart.squaredNorm() < 0.25 * radius * radius && f.n.dot(apart) <= 0.0)
        fail_pair(faces[fi].atom, j, radius - f.n.dot(apart), radius, 0.0);
      continue;
    }
    const auto &face = faces[fi];
    if (!std::isfinite(r.force)) fail_pair(face.atom, j, r.delta, radius, r.force);
    const double weight = dcm::facing(f.n.dot(r.u));
    if (HISTORY) *mixed_touch[n] = weight > 0.0;
    if (!(weight > 0.0)) continue;
    r.scale(weight);
    count.contacts++;
    count.area += r.area;

    for (int k = 0; k < 3; k++) vec(force_of[face.v[k]]) -= r.wf[k] * r.u;
    vec(force_of[j]) += r.force * r.u;
    area[face.atom] += r.area;
    area[j] += r.area;
    if (want_stress) {
      stress[face.atom] += r.force;
      stress[j] += r.force;
    }
    if (want_virial) moment[j] += r.force * (radius - 0.5 * r.delta);
    if (want_partners) add_partner(atom->molecule[face.atom], atom->molecule[j], r.area);
    if (want_blocks)
      contacts.push_back({{face.v[0], face.v[1], face.v[2], j, j, j},
                          {r.bf[0], r.bf[1], r.bf[2], -1.0, 0.0, 0.0},
                          {r.u[0], r.u[1], r.u[2]},
                          r.area * mat.gn,
                          r.area * mat.gt});
    if constexpr (SLOPE) contact_slope.push_back(std::max(0.0, weight * r.slope));
  }
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::add_partner(tagint a, tagint b, double patch)
{
  if (a > b) std::swap(a, b);
  if (!partner_list.empty() && partner_list.back().molecule == a && partner_list.back().other == b)
    partner_list.back().area += patch;
  else
    partner_list.push_back({a, b, patch});
}

/* ----------------------------------------------------------------------
   each pair of cells once; the order of a stable sort, so that sums repeat
------------------------------------------------------------------------- */

static void merge(std::vector<PairDCMContact::Partner> &list)
{
  using Partner = PairDCMContact::Partner;
  std::stable_sort(list.begin(), list.end(), [](const Partner &p, const Partner &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.other < q.other;
  });
  size_t n = 0;
  for (size_t m = 0; m < list.size(); m++) {
    if (n && list[n - 1].molecule == list[m].molecule && list[n - 1].other == list[m].other)
      list[n - 1].area += list[m].area;
    else
      list[n++] = list[m];
  }
  list.resize(n);
}

const std::vector<PairDCMContact::Partner> &PairDCMContact::partners()
{
  if (partners_merged) return partner_list;
  merge(partner_list);
  partner_list = dcm_allgather(partner_list, world);
  merge(partner_list);
  partners_merged = true;
  return partner_list;
}

/* ----------------------------------------------------------------------
   only faces and spheres have anything to communicate
------------------------------------------------------------------------- */

int PairDCMContact::pack_reverse_comm(int n, int first, double *buf)
{
  int m = 0;
  for (int i = first; i < first + n; i++) {
    const int kind = dcm->kind[i];
    if (commmode == NEIGHBORS) {
      if (kind != AtomVecDCM::SPHERE) continue;
      buf[m++] = near_sum[i];
      buf[m++] = near_count[i];
    } else if (kind == AtomVecDCM::SPHERE || kind == AtomVecDCM::FACE) {
      buf[m++] = area[i];
      if (want_stress) buf[m++] = stress[i];
      if (want_virial && kind == AtomVecDCM::SPHERE) buf[m++] = moment[i];
    }
  }
  return m;
}

void PairDCMContact::unpack_reverse_comm(int n, int *list, double *buf)
{
  int m = 0;
  for (int ii = 0; ii < n; ii++) {
    const int i = list[ii], kind = dcm->kind[i];
    if (commmode == NEIGHBORS) {
      if (kind != AtomVecDCM::SPHERE) continue;
      near_sum[i] += buf[m++];
      near_count[i] += buf[m++];
    } else if (kind == AtomVecDCM::SPHERE || kind == AtomVecDCM::FACE) {
      area[i] += buf[m++];
      if (want_stress) stress[i] += buf[m++];
      if (want_virial && kind == AtomVecDCM::SPHERE) moment[i] += buf[m++];
    }
  }
}

int PairDCMContact::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  int m = 0;
  for (int ii = 0; ii < n; ii++)
    if (dcm->kind[list[ii]] == AtomVecDCM::SPHERE) buf[m++] = modulus[list[ii]];
  return m;
}

void PairDCMContact::unpack_forward_comm(int n, int first, double *buf)
{
  int m = 0;
  for (int i = first; i < first + n; i++)
    if (dcm->kind[i] == AtomVecDCM::SPHERE) modulus[i] = buf[m++];
}
