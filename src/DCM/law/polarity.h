// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Polarity of a cell: apical vector A, polar vector P perpendicular to it, and the regions of the
// surface that follow from both (S1 eqs 7-11). N is the unit vector from the cell's center to the
// middle of a face. All vectors are unit vectors, or zero: none.

#ifndef DCM_POLARITY_H
#define DCM_POLARITY_H

#include "vector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dcm {

/// Regions of the surface; the numbers stand in restart and data files.
enum FaceRegion { LATERAL, POLAR, APICAL, JUNCTION, BASAL };

/// A cosine that no face reaches: this region is empty.
constexpr double NO_REGION = 2.0;

/// Where the regions begin, as cosines; those of a cell, since the ribbon may follow its mesh.
struct SurfaceCones {
  double polar = 0.7;         ///< a of S1: |P.N| above it, or below it with belt
  double apical = 0.7;        ///< b of S1: A.N above it
  double basal = 0.7;         ///< A.N below minus this
  double low = NO_REGION;     ///< ribbon of tight junctions: low < A.N < high
  double high = NO_REGION;    ///< of the ribbon
  bool belt = false;          ///< |P.N| < a, as eq 7 of S1 is printed, in place of the two cones

  /// Region of a face: the first that fits of junction, apical, polar, basal, lateral.
  FaceRegion region(const Vec3 &A, const Vec3 &P, const Vec3 &N) const
  {
    const double height = A.dot(N);
    if (height > low && height < high) return JUNCTION;
    if (height > apical) return APICAL;
    const double along = std::fabs(P.dot(N));
    if (belt ? along < polar : along > polar) return POLAR;
    return height < -basal ? BASAL : LATERAL;
  }
};

/// Edge of the equilateral triangle that has the mean area of n faces: the mean edge of a good
/// mesh, without looking at its edges.
inline double equal_edge(double area, int nfaces)
{
  return std::sqrt(4.0 / std::sqrt(3.0) * area / nfaces);
}

/// Width of the ribbon in edges. Middles of faces that share an edge are 0.58 edges apart, of faces
/// that share a node at most 1.15, so that no face reaches across; rows of faces are 0.87 edges
/// high: the ribbon is one to two faces thick, however fine the mesh.
constexpr double RIBBON_EDGES = 1.2;

/// Lower cosine of a ribbon right below the apical cap, on a cell of radius R.
inline double ribbon_low(double apical, double edge, double R)
{
  return std::cos(std::min(PI, std::acos(apical) + RIBBON_EDGES * edge / R));
}

/// Width of a ribbon along the surface of a cell of radius R.
inline double ribbon_width(double low, double high, double R)
{
  return (std::acos(low) - std::acos(high)) * R;
}

/// Sum of vectors of length 0 to some 1000, rounded to 2^-30 each: integers, so that neither the
/// order of faces nor their distribution over processes matters.
struct VectorSum {
  std::int64_t sum[3] = {0, 0, 0};

  static constexpr double UNIT = 0x1p-30;

  void add(const Vec3 &v)
  {
    for (int k = 0; k < 3; k++) sum[k] += std::llround(v[k] / UNIT);
  }
  Vec3 value() const { return UNIT * Vec3(double(sum[0]), double(sum[1]), double(sum[2])); }
};

/// A vector made a unit vector; zero if it is not longer than `least`.
inline Vec3 direction(const Vec3 &v, double least = 0.0)
{
  const double length = v.norm();
  return length > least ? Vec3(v / length) : Vec3(Vec3::Zero());
}

/// In a planar scene nothing points along the axis (0, 1, 2; < 0: not planar).
inline Vec3 in_plane(Vec3 v, int axis)
{
  if (axis >= 0) v[axis] = 0.0;
  return v;
}

/// Polar vector to an apical vector: what is left of P without its part along A; in a planar scene
/// the one of the two directions perpendicular to A that P is nearer to. Zero if P has no such
/// part. Projected twice, since the first leaves round-off of the part taken away.
inline Vec3 polar_vector(const Vec3 &P, const Vec3 &A, int axis)
{
  if (axis >= 0) {
    const Vec3 side = Vec3::Unit(axis).cross(A);
    const double along = side.dot(P);
    return along == 0.0 ? Vec3(Vec3::Zero()) : Vec3(along > 0.0 ? side : -side);
  }
  const Vec3 once = direction(P - P.dot(A) * A, 1.0e-6);
  return direction(once - once.dot(A) * A);
}

}    // namespace dcm

#endif
