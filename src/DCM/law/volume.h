// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Volume of a closed triangulated surface and the pressure that resists its change (S1 eq 6).
// Units: lengths um, volumes um^3, pressures and moduli nN/um^2 (= kPa), forces nN.
// Faces are counter-clockwise seen from outside.

#ifndef DCM_VOLUME_H
#define DCM_VOLUME_H

#include "vector.h"

#include <cmath>

namespace dcm {

/// Volume of a ball, um^3, and radius of the ball of a volume, um.
inline double ball_volume(double radius)
{
  return 4.0 / 3.0 * PI * radius * radius * radius;
}

inline double ball_radius(double volume)
{
  return std::cbrt(0.75 / PI * volume);
}

/// Signed volume of the tetrahedron (origin, a, b, c), um^3. Summed over the faces of a closed
/// surface it gives the enclosed volume, for any origin. Choose the origin near the cell (its
/// center atom): far away, the terms cancel and digits are lost.
inline double face_volume(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  return a.dot(b.cross(c)) / 6.0;
}

/// Area times outward unit normal of a face, um^2. Sums to zero over a closed surface.
inline Vec3 face_area_vector(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  return 0.5 * (b - a).cross(c - a);
}

/// Pressure in a cell, nN/um^2, positive when it pushes outward: -KV ln(V/V0) (S1 eq 6).
/// V and V0 must be positive (an inverted cell has no pressure): NaN or infinite otherwise.
inline double pressure(double KV, double V, double V0)
{
  return -KV * std::log(V / V0);
}

/// Potential of that pressure, nN um: dU/dV = -p, U(V0) = 0.
inline double pressure_energy(double KV, double V, double V0)
{
  // V ln(V/V0) - V + V0 cancels to second order near V0: its series keeps the digits
  const double x = (V - V0) / V0;
  if (std::fabs(x) < 1.0e-3)
    return KV * V0 * x * x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 12.0 - x * (0.05 - x / 30.0))));
  return KV * (V * std::log(V / V0) - V + V0);
}

/// Stiffness of that potential against the volume, nN/um^5: c of a CellBlock (stiffness.h), whose
/// G is dV/dr, on each vertex of a face a third of face_area_vector(). -p d2V/dr2 is left out.
inline double pressure_stiffness(double KV, double V)
{
  return KV / V;
}

/// Force on each of the three vertices of a face, nN: p A n / 3. The sum over the faces of a
/// closed surface is exactly p dV/dr: no net force, no net torque, derives from pressure_energy().
inline Vec3 face_pressure_force(double p, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  return (p / 6.0) * (b - a).cross(c - a);
}

/// The source's form of the force on a node, nN: p S N with its Voronoi area S (um^2) and unit
/// outward curvature direction N. Differs from the gradient by O(edge^2), neither sums to zero
/// nor derives from a potential; kept for comparison.
inline Vec3 voronoi_pressure_force(double p, double S, const Vec3 &N)
{
  return (p * S) * N;
}

}    // namespace dcm

#endif
