// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Cortex: one Kelvin-Voigt element (spring and dashpot side by side) per mesh edge.
// Source: Van Liedekerke et al. 2022, supplement S1, eqs 1-3 and 5.
// Units: lengths um, forces nN, moduli nN/um^2 (= kPa), time s; any consistent set works.

#ifndef DCM_CORTEX_H
#define DCM_CORTEX_H

#include "vector.h"

#include <cmath>

namespace dcm {

/// Which modulus of a thin elastic sheet of Poisson ratio 1/2 the sixfold spring lattice matches.
/// Its own ratio is 1/3, so it cannot match both.
enum class CortexStiffness {
  AREA,    ///< area modulus E h / (2 (1 - nu)): k_s = (2/sqrt 3) E h (S1 eq 3, the default)
  YOUNG    ///< two-dimensional Young modulus E h: k_s = (sqrt 3/2) E h
};

/// Spring constant of an edge, nN/um, from the cortex Young modulus E (nN/um^2) and its
/// thickness h (um). S1 eq 3 for CortexStiffness::AREA.
inline double cortex_stiffness(double E, double h, CortexStiffness form)
{
  const double sqrt3 = std::sqrt(3.0);
  return (form == CortexStiffness::AREA ? 2.0 / sqrt3 : 0.5 * sqrt3) * E * h;
}

/// Bending constant of a hinge, nN um: E h^3 / (12 (1 - nu^2)) (S1 eq 5).
inline double bending_stiffness(double E, double h, double nu = 0.5)
{
  return E * h * h * h / (12.0 * (1.0 - nu * nu));
}

/// Tension in an edge, nN, positive when it pulls its ends together: k_s (l - l0) (S1 eq 1).
inline double cortex_tension(double ks, double l, double l0)
{
  return ks * (l - l0);
}

/// Elastic energy of an edge, nN um.
inline double cortex_energy(double ks, double l, double l0)
{
  return 0.5 * ks * (l - l0) * (l - l0);
}

/// Elastic force on node j of edge i-j, nN; node i gets the opposite (S1 eq 1).
/// rij = r_j - r_i. An edge of length zero has no direction and gives no force.
inline Vec3 cortex_force(double ks, double l0, const Vec3 &rij)
{
  const double l = rij.norm();
  if (l == 0.0) return Vec3::Zero();
  return (-cortex_tension(ks, l, l0) / l) * rij;
}

/// Dashpot force on node j of edge i-j, nN; node i gets the opposite (S1 eq 1).
/// gamma in nN s/um, vij = v_j - v_i, e = unit vector from i to j. The isotropic dashpot of the
/// source (projected = false) also resists rigid rotation of a cell, the projected one does not.
inline Vec3 dashpot_force(double gamma, const Vec3 &vij, const Vec3 &e, bool projected)
{
  if (projected) return (-gamma * vij.dot(e)) * e;
  return -gamma * vij;
}

}    // namespace dcm

#endif
