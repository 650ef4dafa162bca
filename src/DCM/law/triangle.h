// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Signed distance of a point from a surface given face by face, for the rare question; for many
// points and one surface see envelope.h. Lengths in um.

#ifndef DCM_TRIANGLE_H
#define DCM_TRIANGLE_H

#include "vector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dcm {

/// Point of triangle a, b, c nearest to x. Degenerate triangles are taken as their sides.
inline Vec3 nearest_on_triangle(const Vec3 &x, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const Vec3 u = b - a, v = c - a, p = x - a;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), pu = p.dot(u), pv = p.dot(v);
  const double det = uu * vv - uv * uv;
  if (det > 0.0) {
    const double s = (vv * pu - uv * pv) / det, t = (uu * pv - uv * pu) / det;
    if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) return a + s * u + t * v;
  }
  Vec3 best = a;
  double best2 = std::numeric_limits<double>::infinity();
  const Vec3 *const corner[4] = {&a, &b, &c, &a};
  for (int k = 0; k < 3; k++) {
    const Vec3 e = *corner[k + 1] - *corner[k];
    const double ee = e.squaredNorm();
    const double s = ee > 0.0 ? std::clamp((x - *corner[k]).dot(e) / ee, 0.0, 1.0) : 0.0;
    const Vec3 y = *corner[k] + s * e;
    if ((x - y).squaredNorm() < best2) {
      best2 = (x - y).squaredNorm();
      best = y;
    }
  }
  return best;
}

/// Distance of one point from a closed surface, whose faces (counter-clockwise from outside) are
/// added one by one. Where the nearest point is on an edge or corner, several faces are equally
/// near and may lie on either side; their normals, weighted by the angle each spans there, add up
/// to one that tells the side (Baerentzen and Aanaes 2005).
class SurfaceDistance {
 public:
  void add(const Vec3 &x, const Vec3 &a, const Vec3 &b, const Vec3 &c)
  {
    const Vec3 y = nearest_on_triangle(x, a, b, c), d = x - y;
    const double d2 = d.squaredNorm();
    if (d2 > (1.0 + TIE) * least) return;
    if (d2 < (1.0 - TIE) * least) side = 0.0;
    least = std::min(least, d2);
    const Vec3 n = (b - a).cross(c - a);
    if (n.norm() > 0.0) side += span(y, a, b, c) * d.dot(n) / n.norm();
  }

  /// Infinite before the first face.
  double distance() const { return std::sqrt(least); }
  bool inside() const { return side < 0.0; }

 private:
  static constexpr double TIE = 1.0e-12, PI = 3.14159265358979323846;
  double least = std::numeric_limits<double>::infinity(), side = 0.0;

  /// Angle of the face at a point of it: that of a corner, or as on an edge (also inside, where no
  /// other face counts).
  static double span(const Vec3 &y, const Vec3 &a, const Vec3 &b, const Vec3 &c)
  {
    const Vec3 *const corner[3] = {&a, &b, &c};
    for (int k = 0; k < 3; k++) {
      const Vec3 u = *corner[(k + 1) % 3] - *corner[k], v = *corner[(k + 2) % 3] - *corner[k];
      if ((y - *corner[k]).squaredNorm() > TIE * std::min(u.squaredNorm(), v.squaredNorm()))
        continue;
      return std::atan2(u.cross(v).norm(), u.dot(v));
    }
    return PI;
  }
};

}    // namespace dcm

#endif
