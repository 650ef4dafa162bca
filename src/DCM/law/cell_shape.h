// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Shape of a body with a closed triangulated surface, from the second moments of its volume.
// Lengths in um. Faces are counter-clockwise seen from outside.

#ifndef DCM_CELL_SHAPE_H
#define DCM_CELL_SHAPE_H

#include "symmetric.h"
#include "vector.h"
#include "volume.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace dcm {

/// Moments of the volume inside a closed surface, about the origin, which has to be near: volume,
/// integrals of x (3) and of x times x (6). Numbers in a row, to be summed over processes.
constexpr int BODY_MOMENTS = 10;

/// Add those of the tetrahedron of the origin and a face; exact (signed, as face_volume()).
inline void add_moments(double *moments, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const double v = face_volume(a, b, c);
  const Vec3 s = a + b + c;
  moments[0] += v;
  for (int k = 0; k < 3; k++) moments[1 + k] += 0.25 * v * s[k];
  for (int k = 0; k < 6; k++) {
    const int i = SYMMETRIC_ROW[k], j = SYMMETRIC_COLUMN[k];
    moments[4 + k] += 0.05 * v * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
  }
}

/// The ellipsoid whose volume has the same variance of position in every direction as the body:
/// half-axes a = sqrt(5 lambda) by the eigenvalues lambda of that tensor, longest first. Its volume
/// is that of the body only if this is an ellipsoid itself.
struct CellShape {
  double lambda[3];    ///< um^2, largest first
  Mat3 directions;     ///< columns: unit vectors, in the same order

  explicit CellShape(const double *moments)
  {
    const double v = moments[0];
    const Vec3 mid = vec(moments + 1) / v;
    const Mat3 spread = matrix(moments + 4) / v - mid * mid.transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(spread);
    for (int k = 0; k < 3; k++) {
      lambda[k] = std::max(0.0, eigen.eigenvalues()[2 - k]);
      directions.col(k) = eigen.eigenvectors().col(2 - k);
    }
  }

  double axis(int k) const { return std::sqrt(5.0 * lambda[k]); }

  /// Unit vector along the longest axis, its largest component positive.
  Vec3 longest() const
  {
    const Vec3 d = directions.col(0);
    int most;
    d.cwiseAbs().maxCoeff(&most);
    return d[most] < 0.0 ? Vec3(-d) : d;
  }

  /// Theodorou and Suter 1985, as LAMMPS' compute gyration/shape, um^2 and without unit.
  double asphericity() const { return lambda[0] - 0.5 * (lambda[1] + lambda[2]); }
  double acylindricity() const { return lambda[1] - lambda[2]; }
  double anisotropy() const
  {
    const double b = asphericity(), c = acylindricity(), sum = lambda[0] + lambda[1] + lambda[2];
    return (b * b + 0.75 * c * c) / (sum * sum);
  }

  /// Hencky strain of the ellipsoid against a ball of radius R.
  Symmetric strain(double R) const
  {
    Mat3 e = Mat3::Zero();
    for (int k = 0; k < 3; k++)
      e += std::log(axis(k) / R) * directions.col(k) * directions.col(k).transpose();
    return symmetric(e);
  }
};

/// Area of the ball of the same volume over that of the body: 1 for a ball, else less.
inline double sphericity(double volume, double area)
{
  return std::cbrt(36.0 * PI * volume * volume) / area;
}

/// A / V^(2/3): (36 pi)^(1/3) = 4.836 for a ball, else more.
inline double shape_index(double volume, double area)
{
  return area / std::cbrt(volume * volume);
}

}    // namespace dcm

#endif
