// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Solid angle of a triangle. Lengths in um.

#ifndef DCM_SOLID_ANGLE_H
#define DCM_SOLID_ANGLE_H

#include "vector.h"

#include <cmath>

namespace dcm {

/// Solid angle of a face seen from x, over 4 pi; positive if its front looks away from x. Its sum
/// over a closed surface is 1 inside and 0 outside (van Oosterom and Strackee 1983).
inline double face_winding(const Vec3 &x, const Vec3 &p, const Vec3 &q, const Vec3 &r)
{
  const Vec3 a = p - x, b = q - x, c = r - x;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.dot(b.cross(c)),
                    la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb) /
         (2.0 * PI);
}

}    // namespace dcm

#endif
