// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Constant surface tension: energy T A of a triangle, T a force per length that does not depend on
// how far the surface has been stretched, as that of a contractile cortex which turns over faster
// than the cell deforms. Not in S1, whose cortex is of springs.
// Units: lengths um, areas um^2, tensions nN/um, forces nN, energies nN um.

#ifndef DCM_TENSION_H
#define DCM_TENSION_H

#include "vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dcm {

/// A triangle whose height is below this fraction of its longest side counts as degenerate:
/// round-off then decides its normal, and the area has a kink there anyway.
constexpr double TENSION_SLIVER = 1.0e-10;

/// Area of a triangle, um^2, and its gradient by the corners, um.
struct AreaGradient {
  double area;
  Vec3 by[3];
};

/// Twice the area vector of the triangle and its length; false if the triangle is degenerate. A
/// coordinate that is no number makes no degenerate triangle, so that it is never hidden.
inline bool doubled_area(const Vec3 &a, const Vec3 &b, const Vec3 &c, Vec3 &m, double &twice)
{
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  m = ab.cross(-ca);
  const double mm = m.squaredNorm();
  twice = std::sqrt(mm);
  const double longest =
      std::max({ab.squaredNorm(), bc.squaredNorm(), ca.squaredNorm()});    // squared
  return !(mm <= TENSION_SLIVER * TENSION_SLIVER * longest * longest ||
           mm < std::numeric_limits<double>::min());
}

/// Half of each side, turned outward by a right angle in the plane of the triangle: exact, without
/// net force and net torque. A degenerate triangle has no gradient and no area.
inline AreaGradient area_gradient(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  AreaGradient g;
  Vec3 m;
  double twice;
  if (!doubled_area(a, b, c, m, twice)) {
    g.area = 0.0;
    for (Vec3 &by : g.by) by.setZero();
    return g;
  }
  g.area = 0.5 * twice;
  const Vec3 half = (0.5 / twice) * m;
  g.by[0] = half.cross(c - b);
  g.by[1] = half.cross(a - c);
  g.by[2] = half.cross(b - a);
  return g;
}

/// Stiffness of the triangle's sides, nN/um: iso of an EdgeBlock (stiffness.h) on the sides bc, ca
/// and ab, opposite the corners a, b and c: T/2 cot of the angle at that corner, or zero beyond a
/// right angle.
///
/// With E the Dirichlet energy of the map that takes the triangle to a displaced one, the area of
/// the latter is E at most, and the two agree to first order: E is the area plus half the square of
/// what shears the triangle. E is quadratic, and its matrix is the cotangents (Dziuk 1990). So,
/// with L the cotangents and H the second derivative of the area,
///
///   L = H + (the two shears, positive semidefinite),    K = T L + (what clamping adds) >= T H
///
/// Exact for all displacements out of the plane, and for turning and uniform swelling in it. And
/// since T A(x + u) <= T A(x) + u . grad + 1/2 u . K u for any u however large, a step with K can
/// only lower the energy, whatever the time step. The rest is what makes H indefinite.
inline std::array<double, 3> tension_stiffness(double T, const Vec3 &a, const Vec3 &b,
                                               const Vec3 &c)
{
  Vec3 m;
  double twice;
  if (!(T > 0.0) || !doubled_area(a, b, c, m, twice)) return {0.0, 0.0, 0.0};
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double half = 0.5 * T / twice;    // cot = scalar product over |m|
  return {half * std::max(0.0, -ab.dot(ca)), half * std::max(0.0, -bc.dot(ab)),
          half * std::max(0.0, -ca.dot(bc))};
}

}    // namespace dcm

#endif
