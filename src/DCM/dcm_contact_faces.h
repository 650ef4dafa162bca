/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CONTACT_FACES_H
#define LMP_DCM_CONTACT_FACES_H

// Parts of pair style dcm/contact, for its own files only: contacts of faces with faces and
// spheres, as templates over the law. Each file that includes this one compiles the laws it names.

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "fix_dcm_cell.h"
#include "law/symmetric.h"

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

using dcm::vec;
using dcm::Vec3;

// cosine between the normals of faces that certainly look at each other

constexpr double DCM_OPPOSED = -0.7;

// the faces of a pair lie anywhere in memory: fetch those of a later pair while computing this one

constexpr size_t DCM_AHEAD = 4;

static inline void prefetch(const dcm::FaceGeometry *face)
{
  const char *bytes = reinterpret_cast<const char *>(face);
  for (size_t line = 0; line < sizeof(dcm::FaceGeometry); line += 64)
    __builtin_prefetch(bytes + line);
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
   connection of their centroids, which settles most pairs at a fraction of the full test. Where one
   lies right over the other, as in meshes that coincide, the connection has no part across the axis
   but round-off, which says nothing.
------------------------------------------------------------------------- */

constexpr double DCM_ROUND_OFF = 1.0e-24;    // of the square of the connection

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
  return front + back + DCM_ROUND_OFF * apart.squaredNorm() < side.squaredNorm();
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
    if (m + DCM_AHEAD < npairs) {
      const FacePair &next = face_pairs[HISTORY ? m + DCM_AHEAD : candidates[m + DCM_AHEAD]];
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
    // faces that have passed through each other look at each other, and the middle of one of them
    // lies behind the other; others so far behind each other stand beside the same fold or corner,
    // as those of newborn cells do, and do not touch

    const auto &face = faces[fi], &other = faces[gi];
    const double weight = set.facing(f.n.dot(r.u)) * set.facing(-g.n.dot(r.u));
    const double overlap = -apart.dot(r.u);
    const double limit = std::min(bears[face.cell], bears[other.cell]);
    const double depth = std::max({overlap, g.n.dot(apart), -f.n.dot(apart)});
    const bool beyond = !(overlap <= overlap_used);
    if (!std::isfinite(r.force) ||
        (!(depth <= limit) && !(f.n.dot(g.n) > DCM_OPPOSED) && ran_into(fi, gi, r.u, limit)))
      fail_pair(face.atom, other.atom, depth, limit, r.force);
    const bool touching = !beyond && weight > 0.0;
    if (HISTORY) *face_touch[n] = touching;
    if (!touching) continue;
    r.scale(weight);
    if (want_overlap) note_overlap(fi, gi, r.u, limit);
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
    if (want_partners)
      add_partner(atom->molecule[face.atom], atom->molecule[other.atom], r.area, r.force, r.u);
    if (want_blocks)
      contacts.push_back({{face.v[0], face.v[1], face.v[2], other.v[0], other.v[1], other.v[2]},
                          {r.bf[0], r.bf[1], r.bf[2], -r.bg[0], -r.bg[1], -r.bg[2]},
                          {r.u[0], r.u[1], r.u[2]},
                          r.area * mat.gn,
                          r.area * mat.gt});
    if constexpr (SLOPE) contact_slope.push_back(slope_of(r, f, weight, &g));
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

    // a cell smaller than the sphere, half inside it

    const double inner = radius - rmax_cell[faces[fi].cell] / set.rmax;
    if (inner > 0.0 && apart.squaredNorm() < inner * inner)
      fail_pair(faces[fi].atom, j, radius - apart.norm(), radius - inner, 0.0);
    const dcm::ContactMaterial &mat =
        table[face_class[fi] * nclass + AtomVecDCM::NREGION * (atom->type[j] - 1)];
    if (!(apart.squaredNorm() < bound * bound) ||
        !dcm::face_sphere<State, SLOPE>(f, vec(x[j]), radius, mat, set.points, r,
                                        HISTORY && *mixed_touch[n])) {
      if (HISTORY) *mixed_touch[n] = 0;
      if (f.n.dot(apart) <= 0.0 && swallowed(fi, j))
        fail_pair(faces[fi].atom, j, radius - f.n.dot(apart), radius, 0.0);
      continue;
    }
    const auto &face = faces[fi];
    if (!std::isfinite(r.force)) fail_pair(face.atom, j, r.delta, radius, r.force);
    const double weight = set.facing(f.n.dot(r.u)) * set.facing(r.tilt);
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
    if (want_tensor)
      dcm::add_outer(&tensor[6 * (size_t) j], r.force * (radius - 0.5 * r.delta) * r.u, r.u);
    if (want_partners)
      add_partner(atom->molecule[face.atom], atom->molecule[j], r.area, r.force, r.u);
    if (want_blocks)
      contacts.push_back({{face.v[0], face.v[1], face.v[2], j, j, j},
                          {r.bf[0], r.bf[1], r.bf[2], -1.0, 0.0, 0.0},
                          {r.u[0], r.u[1], r.u[2]},
                          r.area * mat.gn,
                          r.area * mat.gt});
    if constexpr (SLOPE) contact_slope.push_back(slope_of(r, f, weight, nullptr));
  }
}

}    // namespace LAMMPS_NS

#endif
