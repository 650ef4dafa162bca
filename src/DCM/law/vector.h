// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Vectors shared by all law headers. The laws know no LAMMPS type: positions and forces stored
// by LAMMPS as double[3] enter through vec(), which copies nothing.

#ifndef DCM_VECTOR_H
#define DCM_VECTOR_H

#include <Eigen/Core>
#include <Eigen/Geometry>    // cross product

namespace dcm {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

constexpr double PI = 3.14159265358979323846;

/// View three consecutive doubles (a row of LAMMPS' x, v or f) as a vector; writing changes them.
inline Eigen::Map<Vec3> vec(double *p)
{
  return Eigen::Map<Vec3>(p);
}

/// Read-only view of three consecutive doubles.
inline Eigen::Map<const Vec3> vec(const double *p)
{
  return Eigen::Map<const Vec3>(p);
}

}    // namespace dcm

#endif
