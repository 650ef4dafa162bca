// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Cortex: one Kelvin-Voigt element (spring and dashpot side by side) per mesh edge. Here is the
// spring; the dashpot is friction, an EdgeBlock of friction.h.
// Source: Van Liedekerke et al. 2022, supplement S1, eqs 1-3.
// Units: lengths um, forces nN, moduli nN/um^2 (= kPa), time s; any consistent set works.

#ifndef DCM_CORTEX_H
#define DCM_CORTEX_H

#include "friction.h"
#include "vector.h"

#include <algorithm>
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

/// Stiffness of an edge, nN/um, slots to be filled in: ks along it, across it tension over length,
/// which is left out where it is negative (a compressed edge gives way sideways).
inline EdgeBlock cortex_stiffness_block(double ks, double l0, const Vec3 &rij)
{
  EdgeBlock b = {};
  const double l = rij.norm();
  if (l == 0.0) return b;
  b.iso = std::max(0.0, cortex_tension(ks, l, l0) / l);
  b.along = ks - b.iso;
  vec(b.e) = rij / l;
  return b;
}

}    // namespace dcm

#endif
