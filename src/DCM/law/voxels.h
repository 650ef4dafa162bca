// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Which faces are near a point? Space is cut into cubes (voxels), each of which lists all faces
// within a distance of any of its points. One look-up then serves a whole piece of path. Lengths in
// um; any length unit works.

#ifndef DCM_VOXELS_H
#define DCM_VOXELS_H

#include "vector.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace dcm {

/// Lists of faces by voxel. Faces: whatever has size() and [f] with corner[3], mid, normal (unit),
/// reach (farthest corner from mid) and known; faces not known are left out.
class Voxels {
 public:
  /// Numbers of the faces of one voxel, in ascending order.
  struct List {
    const int *first = nullptr, *last = nullptr;
    const int *begin() const { return first; }
    const int *end() const { return last; }
    bool empty() const { return first == last; }
  };

  /// Sort all faces into voxels of this edge that list what is within `range` of them. Where the
  /// box around the faces would take more than MOST voxels, they become larger: that changes what
  /// a look-up costs, not what is near.
  template <class Faces> void build(Faces &faces, double voxel, double range)
  {
    const int nfaces = int(faces.size());
    Vec3 hi;
    bool any = false;
    for (int f = 0; f < nfaces; f++) {
      const auto &face = faces[f];
      if (!face.known) continue;
      for (const Vec3 &x : face.corner) {
        lo = any ? Vec3(lo.cwiseMin(x)) : x;
        hi = any ? Vec3(hi.cwiseMax(x)) : x;
        any = true;
      }
    }
    size[0] = size[1] = size[2] = 0;
    if (!any) return;
    const double edge_room = range + 1.0e-9 * (range + voxel);
    lo.array() -= edge_room;
    hi.array() += edge_room;
    edge = voxel;
    while ((hi - lo).array().max(edge).prod() > MOST * edge * edge * edge) edge *= 1.25;
    for (int k = 0; k < 3; k++) size[k] = int((hi[k] - lo[k]) / edge) + 1;

    entries.clear();
    for (int f = 0; f < nfaces; f++) {
      const auto &face = faces[f];
      if (face.known) enter(face, f, range);
    }
    first.assign((std::size_t) size[0] * size[1] * size[2] + 1, 0);
    for (const auto &entry : entries) first[entry.first + 1]++;
    for (std::size_t i = 1; i < first.size(); i++) first[i] += first[i - 1];
    list.resize(entries.size());
    fill.assign(first.begin(), first.end() - 1);
    for (const auto &entry : entries) list[fill[entry.first]++] = entry.second;
  }

  /// Faces of the voxel that x is in; none beyond the box around the faces.
  List at(const Vec3 &x) const
  {
    const Vec3 u = (x - lo) / edge;
    if (!(u[0] >= 0.0 && u[1] >= 0.0 && u[2] >= 0.0 && u[0] < size[0] && u[1] < size[1] &&
          u[2] < size[2]))
      return {};
    const std::size_t i = index(int(u[0]), int(u[1]), int(u[2]));
    return {list.data() + first[i], list.data() + first[i + 1]};
  }

  /// Number of entries in all lists.
  std::size_t entered() const { return list.size(); }
  double memory_usage() const
  {
    return double(sizeof(int)) * double(first.capacity() + fill.capacity() + list.capacity()) +
           double(sizeof(entries[0])) * double(entries.capacity());
  }

 private:
  static constexpr double MOST = 4.0e6;

  Vec3 lo = Vec3::Zero();
  double edge = 1.0;
  int size[3] = {0, 0, 0};
  std::vector<int> first, fill, list;
  std::vector<std::pair<int, int>> entries;    // voxel, face

  std::size_t index(int i, int j, int k) const
  {
    return ((std::size_t) k * size[1] + j) * size[0] + i;
  }

  // voxels of the inflated box of a face, but those that its inflated ball or slab misses

  template <class Face> void enter(const Face &face, int f, double range)
  {
    const Vec3 low = face.corner[0].cwiseMin(face.corner[1]).cwiseMin(face.corner[2]);
    const Vec3 high = face.corner[0].cwiseMax(face.corner[1]).cwiseMax(face.corner[2]);
    int u[3], v[3];
    for (int k = 0; k < 3; k++) {
      u[k] = std::max(0, int((low[k] - range - lo[k]) / edge));
      v[k] = std::min(size[k] - 1, int((high[k] + range - lo[k]) / edge));
    }
    const double half = HALF_DIAGONAL * edge, thick = range + half, ball = face.reach + thick;
    for (int k = u[2]; k <= v[2]; k++)
      for (int j = u[1]; j <= v[1]; j++)
        for (int i = u[0]; i <= v[0]; i++) {
          const Vec3 d = lo + edge * Vec3(i + 0.5, j + 0.5, k + 0.5) - face.mid;
          if (std::fabs(d.dot(face.normal)) > thick || d.squaredNorm() > ball * ball) continue;
          entries.emplace_back(int(index(i, j, k)), f);
        }
  }

  static constexpr double HALF_DIAGONAL = 0.8660254037844387 * (1.0 + 1.0e-9);
};

}    // namespace dcm

#endif
