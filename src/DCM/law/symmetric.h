// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Symmetric tensors as six numbers, in the order of LAMMPS: xx, yy, zz, xy, xz, yz.

#ifndef DCM_SYMMETRIC_H
#define DCM_SYMMETRIC_H

#include "vector.h"

#include <array>

namespace dcm {

using Symmetric = std::array<double, 6>;

constexpr int SYMMETRIC_ROW[6] = {0, 1, 2, 0, 0, 1}, SYMMETRIC_COLUMN[6] = {0, 1, 2, 1, 2, 2};

/// Add the symmetric part of a times b.
inline void add_outer(double *six, const Vec3 &a, const Vec3 &b)
{
  for (int k = 0; k < 6; k++) {
    const int i = SYMMETRIC_ROW[k], j = SYMMETRIC_COLUMN[k];
    six[k] += 0.5 * (a[i] * b[j] + a[j] * b[i]);
  }
}

inline Mat3 matrix(const double *six)
{
  Mat3 m;
  for (int k = 0; k < 6; k++) {
    const int i = SYMMETRIC_ROW[k], j = SYMMETRIC_COLUMN[k];
    m(i, j) = m(j, i) = six[k];
  }
  return m;
}

inline Symmetric symmetric(const Mat3 &m)
{
  Symmetric six;
  for (int k = 0; k < 6; k++) six[k] = m(SYMMETRIC_ROW[k], SYMMETRIC_COLUMN[k]);
  return six;
}

}    // namespace dcm

#endif
