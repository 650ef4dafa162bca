// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Measures of a lumen from the cells' faces that bound it, whose normals point into the lumen:
// volume, wall, closure, what it covers; in a slab of a planar tissue, whose tube of a lumen has no
// lids; and its section with a plane. Positions are relative to a point near the lumen. Lengths in
// um.

#ifndef DCM_LUMEN_H
#define DCM_LUMEN_H

#include "solid_angle.h"
#include "vector.h"

#include <cmath>

namespace dcm {

/// Sums over faces; those of several processes are added up.
struct LumenSums {
  double volume = 0.0;                      ///< um^3
  double area = 0.0;                        ///< of the wall, um^2
  Vec3 area_vector = Vec3::Zero();          ///< sum of A n, zero if closed
  double section = 0.0, perimeter = 0.0;    ///< of the outline in the plane
  Vec3 outline = Vec3::Zero();              ///< sum of its sides, zero if closed
  double covered = 0.0;                     ///< part of all directions in which there is wall

  void add(const LumenSums &other)
  {
    volume += other.volume;
    area += other.area;
    area_vector += other.area_vector;
    section += other.section;
    perimeter += other.perimeter;
    outline += other.outline;
    covered += other.covered;
  }

  /// |sum A n|/sum A, 0 if closed.
  double closure() const { return area > 0.0 ? area_vector.norm() / area : 0.0; }

  /// Part of the outline that is missing; parts that are opposite do not count.
  double missing_outline() const { return perimeter > 0.0 ? outline.norm() / perimeter : 0.0; }

  /// 4 pi S/L^2, 1 for a circle.
  double circularity() const
  {
    return perimeter > 0.0 ? 4.0 * PI * section / (perimeter * perimeter) : 0.0;
  }
};

/// Volume in front of a face, -(1/3) A n.x: summed over the wall of a lumen its volume. Its
/// gradient at each corner, -(1/3) A n plus what cancels over a closed wall, is the force of unit
/// pressure.
inline double lumen_volume(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  return -a.dot(b.cross(c)) / 6.0;
}

/// Force of a pressure in the lumen on each corner of a face of area A and outward normal n, of
/// which the area `acting` is free: -P acting n/3, nN.
inline Vec3 lumen_force(double pressure, double acting, const Vec3 &normal)
{
  return -pressure * acting / 3.0 * normal;
}

/// What a face adds to volume, wall and area vector.
inline void add_face(LumenSums &sums, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const Vec3 n = 0.5 * (b - a).cross(c - a);
  sums.volume += lumen_volume(a, b, c);
  sums.area += n.norm();
  sums.area_vector += n;
}

/// What a face covers of the full solid angle as seen from the origin, the middle of the wall. A
/// part of the wall that is seen from behind counts negative: all together 1 if closed around it.
inline void add_covered(LumenSums &sums, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  sums.covered -= face_winding(Vec3::Zero(), a, b, c);
}

/// Corners of the part of a face that lies between lo and hi along an axis (0 to 2), fewer than 3
/// if there is none.
inline int cut_to_slab(Vec3 (&polygon)[6], const Vec3 &a, const Vec3 &b, const Vec3 &c, int axis,
                       double lo, double hi)
{
  Vec3 cut[6];
  int n = 3;
  polygon[0] = a, polygon[1] = b, polygon[2] = c;
  for (int side = 0; side < 2; side++) {
    int m = 0;
    for (int k = 0; k < n; k++) {
      const Vec3 &p = polygon[k], &q = polygon[(k + 1) % n];
      const double hp = side ? hi - p[axis] : p[axis] - lo, hq = side ? hi - q[axis] : q[axis] - lo;
      if (hp >= 0.0) cut[m++] = p;
      if ((hp >= 0.0) != (hq >= 0.0)) cut[m++] = p + hp / (hp - hq) * (q - p);
    }
    n = m;
    for (int k = 0; k < n; k++) polygon[k] = cut[k];
    if (n < 3) break;
  }
  return n;
}

/// The same for a tube along an axis that is cut off at lo and hi: with the field (x, y, 0)/2, of
/// divergence 1, the open ends do not count. The part of the face between lo and hi; of its area
/// vector what lies across the axis.
inline void add_face_in_slab(LumenSums &sums, const Vec3 &a, const Vec3 &b, const Vec3 &c, int axis,
                             double lo, double hi)
{
  Vec3 polygon[6];
  const int n = cut_to_slab(polygon, a, b, c, axis, lo, hi);
  for (int k = 2; k < n; k++) {
    Vec3 normal = 0.5 * (polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]);
    Vec3 mid = (polygon[0] + polygon[k - 1] + polygon[k]) / 3.0;
    sums.area += normal.norm();
    normal[axis] = mid[axis] = 0.0;
    sums.volume -= 0.5 * normal.dot(mid);
    sums.area_vector += normal;
  }
}

/// What the part of a face between lo and hi covers.
inline void add_covered_in_slab(LumenSums &sums, const Vec3 &a, const Vec3 &b, const Vec3 &c,
                                int axis, double lo, double hi)
{
  Vec3 polygon[6];
  const int n = cut_to_slab(polygon, a, b, c, axis, lo, hi);
  for (int k = 2; k < n; k++) add_covered(sums, polygon[0], polygon[k - 1], polygon[k]);
}

/// What a face adds to the outline in the plane at `at` across an axis (0 to 2).
inline void add_section(LumenSums &sums, const Vec3 &a, const Vec3 &b, const Vec3 &c, int axis,
                        double at)
{
  const Vec3 *const corner[3] = {&a, &b, &c};
  Vec3 end[2];    // where the face's boundary goes up, and down
  int n = 0;
  for (int k = 0; k < 3; k++) {
    const Vec3 &p = *corner[k], &q = *corner[(k + 1) % 3];
    const double hp = p[axis] - at, hq = q[axis] - at;
    if ((hp < 0.0) == (hq < 0.0)) continue;
    end[hp < 0.0 ? 0 : 1] = p + hp / (hp - hq) * (q - p);
    n++;
  }
  if (n != 2) return;
  // normals point into the lumen: its outline runs counter-clockwise from the place where the
  // face's boundary goes up
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Vec3 side = end[1] - end[0];
  sums.section += 0.5 * (end[0][u] * end[1][v] - end[0][v] * end[1][u]);
  sums.perimeter += side.norm();
  sums.outline += side;
}

/// Osmotic pressure of an amount of solute in a volume (van 't Hoff), kPa: n kT/V. kT: energy per
/// amount, nN um = kPa um^3. The volume counts as no smaller than `least`.
inline double osmotic_pressure(double amount, double kT, double volume, double least)
{
  return amount * kT / (volume > least ? volume : least);
}

/// Amount of solute after a time dt of constant secretion and first-order loss with time constant
/// `loss` (infinite: none): dn/dt = rate - n/loss.
inline double secreted(double amount, double rate, double loss, double dt)
{
  if (!std::isfinite(loss)) return amount + rate * dt;
  const double steady = rate * loss;
  return steady + (amount - steady) * std::exp(-dt / loss);
}

}    // namespace dcm

#endif
