// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// How a contact answers to a tilt of its surfaces, for the stiffness of an implicit step.
//
// The stiffness of a contact along its axis u is
//
//   int dp/d delta w w^T dA  =  slope (wm wm^T + sum_e t_e t_e^T),
//
// w the barycentric weights at a point, linear in it, wm those at the centroid of the contact, t_e
// what they change by along e_1, e_2 across the axis, with e_1 e_1^T + e_2 e_2^T the second moments
// of the contact per area.
// Without the tilts nodes that move to and fro against their neighbors meet no resistance: a mode
// of 1, -1/2, -1/2 on the corners of each face leaves all means where they are.
// Units: weights have none.

#ifndef DCM_CONTACT_TILT_H
#define DCM_CONTACT_TILT_H

#include "contact.h"

namespace dcm {

/// Changes t_1, t_2 of the three barycentric weights of f, seen along u; each sums to zero.
/// \param moment  second moments xx, xy, yy (length^2) in the frame of u, positive semidefinite
inline void contact_tilt(const FaceGeometry &f, const Vec3 &u, const double moment[3],
                         double t[2][3])
{
  Vec3 e1, e2;
  detail::frame(u, e1, e2);
  const double xx = std::sqrt(moment[0]), xy = xx > 0.0 ? moment[1] / xx : 0.0;    // Cholesky
  const double yy = std::sqrt(std::max(0.0, moment[2] - xy * xy));
  const double inv2area = 1.0 / (2.0 * f.area * f.n.dot(u));
  for (int k = 0; k < 3; k++) {
    const Vec3 gradient = inv2area * u.cross(f.x[(k + 2) % 3] - f.x[(k + 1) % 3]);
    t[0][k] = xx * gradient.dot(e1) + xy * gradient.dot(e2);
    t[1][k] = yy * gradient.dot(e2);
  }
}

}    // namespace dcm

#endif
