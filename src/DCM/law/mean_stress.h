// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Mean stress in a body, nN/um^2 (= kPa), tension positive: by the theorem of mean stress the sum
// over what acts on it from outside of force times position, over its volume. Six numbers, as in
// symmetric.h.

#ifndef DCM_MEAN_STRESS_H
#define DCM_MEAN_STRESS_H

#include "symmetric.h"

namespace dcm {

/// Virials, the sum over nodes of force times position (nN um), of forces within a body. Of a
/// pressure p in a volume V; the sum over the nodes is exact, since faces are plane.
inline void add_pressure_virial(double *six, double p, double V)
{
  for (int k = 0; k < 3; k++) six[k] += p * V;
}

/// Of a tension T (nN/um) in a face of the given area and unit normal.
inline void add_tension_virial(double *six, double T, double area, const Vec3 &n)
{
  for (int k = 0; k < 6; k++) {
    const int i = SYMMETRIC_ROW[k], j = SYMMETRIC_COLUMN[k];
    six[k] -= T * area * ((i == j ? 1.0 : 0.0) - n[i] * n[j]);
  }
}

/// Mean stress of a body: `all`, the virial of all forces on its nodes, less that of those which
/// act within it is that of those from outside.
inline Symmetric mean_stress(const double *all, const double *within, double V)
{
  Symmetric s;
  for (int k = 0; k < 6; k++) s[k] = (all[k] - within[k]) / V;
  return s;
}

}    // namespace dcm

#endif
