// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Shape of a deformable cell that takes the place of a sphere among neighbors: a ball flattened by
// the planes of equal power between it and each neighbor, of exactly the sphere's volume.

#ifndef DCM_SHAPE_H
#define DCM_SHAPE_H

#include "mesh.h"

#include <algorithm>
#include <vector>

namespace dcm {

/// A neighboring cell as a ball: center (um, next to the cell's image) and radius (um).
struct Ball {
  Vec3 x;
  double radius;
};

/// A cell with a plane nearer than this part of its radius has too little room to be shaped: it
/// lies deep inside a neighbor, as a sister does right after a division.
constexpr double SHAPE_NEAREST = 0.7;

/// Distance of the plane of equal power to `other` from the center of `cell`, um; negative if the
/// center is on its far side.
inline double power_plane(const Ball &cell, const Ball &other)
{
  const double d = (other.x - cell.x).norm();
  return d > 0.0 ? 0.5 * (d + (cell.radius * cell.radius - other.radius * other.radius) / d) : 0.0;
}

/// Is there room for fit_between()?
inline bool has_room(const Ball &cell, const std::vector<Ball> &neighbors)
{
  return std::all_of(neighbors.begin(), neighbors.end(), [&](const Ball &other) {
    return power_plane(cell, other) >= SHAPE_NEAREST * cell.radius;
  });
}

namespace shape_detail {

  /// Distance from the center along unit vector e to the first plane or the ball of radius R.
  inline double reach(const Vec3 &e, double R, const std::vector<std::pair<Vec3, double>> &planes)
  {
    double r = R;
    for (const auto &plane : planes) {
      const double along = e.dot(plane.first);
      if (along > 0.0) r = std::min(r, plane.second / along);
    }
    return r;
  }

}    // namespace shape_detail

/// Nodes of `round` (closed mesh about the origin), drawn out to the surface of `cell` cut by the
/// planes of equal power to its neighbors, then scaled so that the mesh has `volume` (um^3). The
/// ball's radius grows until the cut one has that volume, at most by half; what is still missing
/// is made up by scaling. Needs has_room().
inline std::vector<Vec3> fit_between(const Ball &cell, double volume,
                                     const std::vector<Ball> &neighbors, const Mesh &round)
{
  std::vector<std::pair<Vec3, double>> planes;    // normal and distance
  for (const Ball &other : neighbors) {
    const Vec3 d = other.x - cell.x;
    const double length = d.norm();
    if (!(length > 0.0) || length > 1.5 * cell.radius + other.radius) continue;
    planes.emplace_back(d / length, power_plane(cell, other));
  }

  Mesh mesh = round;
  auto draw = [&](double R) {
    for (size_t n = 0; n < round.nodes.size(); n++) {
      const Vec3 e = round.nodes[n].normalized();
      mesh.nodes[n] = shape_detail::reach(e, R, planes) * e;
    }
    return dcm::volume(mesh);
  };
  double low = 0.5 * cell.radius, high = 1.5 * cell.radius;
  for (int k = 0; k < 50; k++) {
    const double mid = 0.5 * (low + high);
    (draw(mid) < volume ? low : high) = mid;
  }
  const double scale = std::cbrt(volume / draw(high));
  for (Vec3 &x : mesh.nodes) x = cell.x + scale * x;
  return mesh.nodes;
}

}    // namespace dcm

#endif
