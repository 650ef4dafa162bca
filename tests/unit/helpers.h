// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Shared by the unit tests: random rotations and vectors, central differences, sums of forces.

#ifndef DCM_TEST_HELPERS_H
#define DCM_TEST_HELPERS_H

#include "law/random.h"
#include "law/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dcm_test {

using dcm::Mat3;
using dcm::Vec3;
using Points = std::vector<Vec3>;

/// Rotation drawn uniformly: a normalized quaternion of four normals.
inline Mat3 random_rotation(dcm::Random &random)
{
  const double w = random.gaussian(), x = random.gaussian(), y = random.gaussian(),
               z = random.gaussian();
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

/// Gradient of a function of points by central differences with step h: error O(h^2).
template <class Energy> Points gradient(const Energy &energy, Points x, double h)
{
  Points g(x.size());
  for (size_t i = 0; i < x.size(); i++)
    for (int d = 0; d < 3; d++) {
      const double x0 = x[i][d];
      x[i][d] = x0 + h;
      const double up = energy(x);
      x[i][d] = x0 - h;
      const double down = energy(x);
      x[i][d] = x0;
      g[i][d] = (up - down) / (2.0 * h);
    }
  return g;
}

/// Largest length in a list of vectors.
inline double largest(const Points &f)
{
  double m = 0.0;
  for (const Vec3 &v : f) m = std::max(m, v.norm());
  return m;
}

/// Largest |f + grad U|, relative to the largest force: zero for the exact gradient.
inline double gradient_error(const Points &f, const Points &grad)
{
  double m = 0.0;
  for (size_t i = 0; i < f.size(); i++) m = std::max(m, (f[i] + grad[i]).norm());
  return m / largest(f);
}

/// Length of the summed forces, relative to the largest one.
inline double net_force(const Points &f)
{
  Vec3 sum = Vec3::Zero();
  for (const Vec3 &v : f) sum += v;
  return sum.norm() / largest(f);
}

/// Length of the summed torques, relative to the largest force times the largest extent.
inline double net_torque(const Points &x, const Points &f)
{
  Vec3 sum = Vec3::Zero();
  double extent = 0.0;
  for (size_t i = 0; i < f.size(); i++) {
    sum += (x[i] - x[0]).cross(f[i]);
    extent = std::max(extent, (x[i] - x[0]).norm());
  }
  return sum.norm() / (largest(f) * extent);
}

}    // namespace dcm_test

#endif
