// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// A closed mesh cut by a plane: volume and centroid of a part, the plane that halves the volume,
// and the long axis of the body. Set-up code. Units: um; any length unit works.
//
// With the origin on the plane, the section itself spans no volume with it: the tetrahedra over
// the clipped faces alone sum to the part's volume and moments, convex or not.

#ifndef DCM_PLANE_CUT_H
#define DCM_PLANE_CUT_H

#include "mesh.h"
#include "vector.h"
#include "volume.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace dcm {

/// A plane; normal is a unit vector and points to the side of daughter 0.
struct DivisionPlane {
  Vec3 point, normal;
};

/// One part of a body cut by a plane.
struct Half {
  double volume;    ///< um^3
  Vec3 centroid;    ///< um; the plane's point if the part is empty
};

namespace plane_cut_detail {

  /// Mean node: an origin near the mesh, for the digits.
  inline Vec3 middle(const Mesh &mesh)
  {
    Vec3 mid = Vec3::Zero();
    for (const Vec3 &x : mesh.nodes) mid += x;
    return mesh.nodes.empty() ? mid : Vec3(mid / double(mesh.nodes.size()));
  }

  /// The part of triangle a, b, c (heights ha, hb, hc over the plane) above the plane: a polygon
  /// of n corners, n = 0, 3 or 4.
  inline int clip(const Vec3 *corner[3], const double height[3], Vec3 polygon[4])
  {
    int n = 0;
    for (int k = 0; k < 3; k++) {
      const int next = (k + 1) % 3;
      if (height[k] >= 0.0) polygon[n++] = *corner[k];
      if ((height[k] >= 0.0) != (height[next] >= 0.0)) {
        const double part = height[k] / (height[k] - height[next]);
        polygon[n++] = *corner[k] + part * (*corner[next] - *corner[k]);
      }
    }
    return n;
  }

}    // namespace plane_cut_detail

/// Volume and centroid of the part of a closed mesh on the positive side of a plane.
inline Half positive_half(const Mesh &mesh, const DivisionPlane &plane)
{
  const Vec3 mid = plane_cut_detail::middle(mesh);
  const Vec3 origin = mid - plane.normal.dot(mid - plane.point) * plane.normal;
  double sum = 0.0;
  Vec3 moment = Vec3::Zero();
  for (const auto &f : mesh.faces) {
    Vec3 x[3], polygon[4];
    const Vec3 *corner[3];
    double height[3];
    for (int k = 0; k < 3; k++) {
      x[k] = mesh.nodes[f[k]] - origin;
      corner[k] = &x[k];
      height[k] = plane.normal.dot(x[k]);
    }
    const int n = plane_cut_detail::clip(corner, height, polygon);
    for (int k = 2; k < n; k++) {
      const double v = face_volume(polygon[0], polygon[k - 1], polygon[k]);
      sum += v;
      moment += 0.25 * v * (polygon[0] + polygon[k - 1] + polygon[k]);
    }
  }
  if (!(sum > 0.0)) return {std::max(sum, 0.0), plane.point};
  return {sum, origin + moment / sum};
}

/// Plane with the given normal (any length) that halves the volume of a closed mesh, convex or
/// not, by bisection; its point lies below the mean node. A plane through the
/// centroid gives unequal daughters unless the mother is symmetric.
/// Throws std::invalid_argument if the normal has no direction or the mesh no positive volume.
inline DivisionPlane halving_plane(const Mesh &mother, const Vec3 &normal)
{
  const double length = normal.norm();
  if (!(length > 0.0) || !std::isfinite(length))
    throw std::invalid_argument("division: the normal of the plane has no direction");
  const double whole = volume(mother);
  if (!(whole > 0.0)) throw std::invalid_argument("division: the mother has no positive volume");
  const Vec3 mid = plane_cut_detail::middle(mother), n = normal / length;
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (const Vec3 &x : mother.nodes) {
    lo = std::min(lo, n.dot(x - mid));
    hi = std::max(hi, n.dot(x - mid));
  }
  double offset = 0.5 * (lo + hi);
  for (int i = 0; i < 100 && offset > lo && offset < hi; i++) {
    const double above = positive_half(mother, {mid + offset * n, n}).volume;
    (above > 0.5 * whole ? lo : hi) = offset;
    if (std::fabs(above - 0.5 * whole) < 1.0e-14 * whole) break;
    offset = 0.5 * (lo + hi);
  }
  return {mid + offset * n, n};
}

/// Second moment of the volume enclosed by a mesh about its centroid, um^5.
inline Mat3 second_moment(const Mesh &mesh)
{
  const Vec3 mid = plane_cut_detail::middle(mesh);
  double sum = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto &f : mesh.faces) {
    const Vec3 a = mesh.nodes[f[0]] - mid, b = mesh.nodes[f[1]] - mid, c = mesh.nodes[f[2]] - mid;
    const double v = face_volume(a, b, c);
    const Vec3 s = a + b + c;
    sum += v;
    first += 0.25 * v * s;
    second +=
        0.05 * v * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  return second - first * first.transpose() / sum;
}

/// Longest principal axis of the body enclosed by a mesh: unit eigenvector of the largest
/// eigenvalue of the second moment of its volume. Its component of largest magnitude is positive.
/// For a body without one longest axis, like a ball, round-off decides.
inline Vec3 long_axis(const Mesh &mesh)
{
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(second_moment(mesh));
  Vec3 axis = solver.eigenvectors().col(2);    // eigenvalues ascend
  int largest;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0.0 ? Vec3(-axis) : axis;
}

/// Rotation that turns z to the unit normal of a plane and x to the direction within the plane in
/// which the body is longest. For a body as long in all these directions (within 1e-6), x goes
/// next to the coordinate axis closest to the plane instead, so that round-off decides nothing.
inline Mat3 plane_frame(const Mesh &mesh, const Vec3 &normal)
{
  int least;
  normal.cwiseAbs().minCoeff(&least);
  const Vec3 u = (Vec3::Unit(least) - normal[least] * normal).normalized(), v = normal.cross(u);
  const Mat3 m = second_moment(mesh);
  const double uu = u.dot(m * u), vv = v.dot(m * v), uv = u.dot(m * v);
  Mat3 frame;
  frame.col(2) = normal;
  frame.col(0) = u;
  if (std::hypot(uu - vv, 2.0 * uv) > 1.0e-6 * (uu + vv)) {
    const double angle = 0.5 * std::atan2(2.0 * uv, uu - vv);
    frame.col(0) = std::cos(angle) * u + std::sin(angle) * v;
  }
  frame.col(1) = normal.cross(frame.col(0));
  return frame;
}

}    // namespace dcm

#endif
