// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Which faces are near a point? Space is cut into cubes (voxels), each of which lists all faces
// within a distance of any of its points. One look-up then serves a whole piece of path. A list is
// made when it is first asked for: most of a tissue has no tracer near by. Lengths in um; any
// length unit works.

#ifndef DCM_VOXELS_H
#define DCM_VOXELS_H

#include "vector.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace dcm {

/// Lists of faces by voxel. Faces: whatever has size() and [f] with corner[3], mid, normal (unit),
/// reach (farthest corner from mid) and known; faces not known are left out.
class Voxels {
 public:
  /// Numbers of the faces of one voxel, in ascending order; valid until the next build().
  struct List {
    const int *first = nullptr, *last = nullptr;
    const int *begin() const { return first; }
    const int *end() const { return last; }
    bool empty() const { return first == last; }
  };

  /// Take all faces as they are now, for voxels of this edge that list what is within `_range` of
  /// them. Where the box around the faces would take more than MOST voxels, they become larger:
  /// that changes what a look-up costs, not what is near.
  template <class Faces> void build(Faces &faces, double voxel, double _range)
  {
    range = _range;
    made = 0;
    plates.clear();
    double largest = 0.0;
    Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();
    const int nfaces = int(faces.size());
    for (int f = 0; f < nfaces; f++) {
      const auto &face = faces[f];
      if (!face.known) continue;
      if (plates.empty()) lo = hi = face.corner[0];
      for (const Vec3 &x : face.corner) {
        lo = lo.cwiseMin(x);
        hi = hi.cwiseMax(x);
      }
      plates.push_back({face.mid, face.normal, face.reach, f});
      largest = std::max(largest, face.reach);
    }
    if (plates.empty()) {
      voxels = Grid();
      return;
    }
    const Vec3 room = Vec3::Constant(range + 1.0e-9 * (range + voxel));
    voxels.cut(lo - room, hi + room, voxel);
    lists_of.assign(voxels.count(), NONE);
    farthest = largest + range + HALF_DIAGONAL * voxels.edge;
    bins.cut(lo, hi, 0.5 * farthest);
    sort_plates();
  }

  /// Faces of the voxel that x is in; none beyond the box around the faces.
  List at(const Vec3 &x)
  {
    int u[3];
    if (!voxels.find(x, u)) return {};
    int &number = lists_of[voxels.index(u)];
    if (number == NONE) {
      number = made++;
      if (number == int(lists.size())) lists.emplace_back();
      gather(voxels.center(u), lists[number]);
    }
    const std::vector<int> &list = lists[number];
    return {list.data(), list.data() + list.size()};
  }

  double memory_usage() const
  {
    double bytes = double(sizeof(int)) * double(lists_of.capacity() + first.capacity()) +
                   double(sizeof(Plate)) * double(plates.capacity() + unsorted.capacity());
    for (const auto &list : lists) bytes += double(sizeof(list) + sizeof(int) * list.capacity());
    return bytes;
  }

 private:
  static constexpr double MOST = 4.0e6;
  static constexpr double HALF_DIAGONAL = 0.8660254037844387 * (1.0 + 1.0e-9);
  static constexpr int NONE = -1;

  /// Cubes that fill a box.
  struct Grid {
    Vec3 lo = Vec3::Zero();
    double edge = 1.0;
    int size[3] = {0, 0, 0};

    void cut(const Vec3 &_lo, const Vec3 &hi, double least)
    {
      lo = _lo;
      edge = least;
      while ((hi - lo).array().max(edge).prod() > MOST * edge * edge * edge) edge *= 1.25;
      for (int k = 0; k < 3; k++) size[k] = int((hi[k] - lo[k]) / edge) + 1;
    }
    std::size_t count() const { return std::size_t(size[0]) * size[1] * size[2]; }
    std::size_t index(const int *u) const
    {
      return (std::size_t(u[2]) * size[1] + u[1]) * size[0] + u[0];
    }
    Vec3 center(const int *u) const { return lo + edge * Vec3(u[0] + 0.5, u[1] + 0.5, u[2] + 0.5); }
    bool find(const Vec3 &x, int *u) const
    {
      const Vec3 w = (x - lo) / edge;
      for (int k = 0; k < 3; k++) {
        if (!(w[k] >= 0.0 && w[k] < size[k])) return false;
        u[k] = int(w[k]);
      }
      return true;
    }
    int clamped(double x, int k) const
    {
      return int(std::clamp((x - lo[k]) / edge, 0.0, size[k] - 1.0));
    }
  };

  /// What the test of a voxel needs of a face.
  struct Plate {
    Vec3 mid, normal;
    double reach;
    int face;
  };

  double range = 0.0;
  double farthest = 0.0;        // of the middle of a face from that of a voxel that lists it
  Grid voxels, bins;            // bins: of faces by their middle
  std::vector<int> lists_of;    // by voxel: number of its list, or NONE
  std::vector<std::vector<int>> lists;    // the first `made` are of this build
  int made = 0;
  std::vector<int> first;    // by bin: its plates
  std::vector<Plate> plates, unsorted;

  // by bin, ascending numbers of faces in each

  void sort_plates()
  {
    unsorted.swap(plates);
    std::vector<std::size_t> bin_of(unsorted.size());
    first.assign(bins.count() + 1, 0);
    for (std::size_t n = 0; n < unsorted.size(); n++) {
      int u[3];
      for (int k = 0; k < 3; k++) u[k] = bins.clamped(unsorted[n].mid[k], k);
      bin_of[n] = bins.index(u);
      first[bin_of[n] + 1]++;
    }
    for (std::size_t i = 1; i < first.size(); i++) first[i] += first[i - 1];
    std::vector<int> next(first.begin(), first.end() - 1);
    plates.resize(unsorted.size());
    for (std::size_t n = 0; n < unsorted.size(); n++) plates[next[bin_of[n]]++] = unsorted[n];
  }

  // faces whose inflated ball and slab meet the voxel around `center`

  void gather(const Vec3 &center, std::vector<int> &list) const
  {
    list.clear();
    int u[3], low[3], high[3];
    for (int k = 0; k < 3; k++) {
      low[k] = bins.clamped(center[k] - farthest, k);
      high[k] = bins.clamped(center[k] + farthest, k);
    }
    const double thick = range + HALF_DIAGONAL * voxels.edge;
    for (u[2] = low[2]; u[2] <= high[2]; u[2]++)
      for (u[1] = low[1]; u[1] <= high[1]; u[1]++) {
        u[0] = low[0];
        const std::size_t row = bins.index(u);
        const int end = first[row + std::size_t(high[0] - low[0]) + 1];
        for (int n = first[row]; n < end; n++) {
          const Plate &plate = plates[n];
          const Vec3 d = center - plate.mid;
          const double ball = plate.reach + thick;
          if (d.squaredNorm() <= ball * ball && std::fabs(d.dot(plate.normal)) <= thick)
            list.push_back(plate.face);
        }
      }
    std::sort(list.begin(), list.end());
  }
};

}    // namespace dcm

#endif
