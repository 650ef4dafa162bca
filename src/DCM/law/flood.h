// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Which free faces bound one lumen: what fluid in front of one face can get to in front of another.
// Faces are linked if they share a mesh edge, or if the line between points just above their
// centroids is open: no face cuts it, and it does not lead through the slit between two cells in
// contact, which stand up to h0 apart (S1: tracers cannot access the space between them). Sets of
// linked faces are found by union-find, by tags alone. Lengths in um.

#ifndef DCM_FLOOD_H
#define DCM_FLOOD_H

#include "vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace dcm {

/// A face as the flood sees it.
struct FloodFace {
  std::array<Vec3, 3> corner;
  Vec3 mid, normal;                      ///< centroid; unit, out of the cell
  double reach = 0.0;                    ///< farthest corner from the centroid
  std::int64_t tag = 0, cell = 0;        ///< cell: any ID
  std::array<std::int64_t, 3> vertex;    ///< tags
  bool node = false;                     ///< may be linked
  bool shut = false;                     ///< in contact: the slit in front of it is shut
  bool own = false;                      ///< links to faces of higher tags are decided here

  void measure()
  {
    const Vec3 n = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double length = n.norm();
    normal = length > 0.0 ? Vec3(n / length) : Vec3(Vec3::Zero());
    mid = (corner[0] + corner[1] + corner[2]) / 3.0;
    reach = 0.0;
    for (const Vec3 &x : corner) reach = std::max(reach, (x - mid).norm());
  }
};

struct FloodSettings {
  double range;     ///< largest distance of centroids of linked faces of two cells
  double height;    ///< of the ends of a line above the centroids
  double slit;      ///< two faces in contact that stand closer than this shut the space between
};

/// Does the line from p to q pass through the face, from either side?
inline bool face_cuts(const FloodFace &face, const Vec3 &p, const Vec3 &q)
{
  const double hp = (p - face.corner[0]).dot(face.normal);
  const double hq = (q - face.corner[0]).dot(face.normal);
  if ((hp > 0.0) == (hq > 0.0)) return false;
  // on which side of the three edges does the line pass? Both faces of an edge see one value
  const Vec3 d = q - p, a = face.corner[0] - p, b = face.corner[1] - p, c = face.corner[2] - p;
  const double u0 = d.dot(b.cross(c)), u1 = d.dot(c.cross(a)), u2 = d.dot(a.cross(b));
  const double eps = 1.0e-12 * d.norm() * face.reach * face.reach;
  return (u0 >= -eps && u1 >= -eps && u2 >= -eps) || (u0 <= eps && u1 <= eps && u2 <= eps);
}

/// Height of x over the face, negative behind it; false if x does not lie over the face.
inline bool height_over(const FloodFace &face, const Vec3 &x, double &height)
{
  height = (x - face.corner[0]).dot(face.normal);
  for (int k = 0; k < 3; k++) {
    const Vec3 &a = face.corner[k], &b = face.corner[(k + 1) % 3];
    if ((b - a).cross(x - a).dot(face.normal) < 0.0) return false;
  }
  return true;
}

/// Sets of linked items, numbered from 0.
class Components {
 public:
  explicit Components(int n = 0) { reset(n); }
  void reset(int n)
  {
    parent.resize(n);
    for (int i = 0; i < n; i++) parent[i] = i;
  }
  int root(int i)
  {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  /// The lowest member stands for its set, so that the order of links does not matter.
  void link(int i, int j)
  {
    i = root(i);
    j = root(j);
    parent[std::max(i, j)] = std::min(i, j);
  }
  /// Number of the set of each item, in the order of their lowest members; returns how many.
  int number(std::vector<int> &set)
  {
    int n = 0;
    set.resize(parent.size());
    for (int i = 0; i < (int) parent.size(); i++) set[i] = root(i) == i ? n++ : set[root(i)];
    return n;
  }

 private:
  std::vector<int> parent;
};

/// Faces and who is near them. Buffers are kept from one use to the next.
class FloodSpace {
 public:
  std::vector<FloodFace> faces;
  using Link = std::array<std::int64_t, 2>;    ///< lower tag, higher tag

  /// After the faces have been filled in and measured.
  void sort(const FloodSettings &to)
  {
    set = to;
    double reach = 0.0;
    lo = Vec3::Constant(0.0);
    if (!faces.empty()) lo = faces[0].mid;
    Vec3 hi = lo;
    for (const auto &face : faces) {
      reach = std::max(reach, face.reach);
      lo = lo.cwiseMin(face.mid);
      hi = hi.cwiseMax(face.mid);
    }
    // what may cut a line that leaves a face of a bin lies in this bin or one next to it
    largest = reach;
    width = std::max(set.range + set.height + reach, 1.0e-6 * (hi - lo).maxCoeff() + 1.0e-300);
    for (int k = 0; k < 3; k++) count[k] = (int) std::min(1000.0, (hi[k] - lo[k]) / width) + 1;
    first.assign((size_t) count[0] * count[1] * count[2] + 1, 0);
    for (const auto &face : faces) first[bin(face.mid) + 1]++;
    for (size_t b = 1; b < first.size(); b++) first[b] += first[b - 1];
    fill.assign(first.begin(), first.end() - 1);
    member.resize(faces.size());
    for (int f = 0; f < (int) faces.size(); f++) member[fill[bin(faces[f].mid)]++] = f;
  }

  /// Face of another cell that lies in front of the centroid of f, nearest to it and opposite,
  /// at most range away; -1: none.
  int opposite(int f) const
  {
    int found = -1;
    double least = set.range;
    const FloodFace &face = faces[f];
    near(face.mid, [&](int g) {
      const FloodFace &other = faces[g];
      if (other.cell == face.cell || other.normal.dot(face.normal) > -0.3) return;
      const double distance = (other.mid - face.mid).norm();
      if (distance < least || (distance == least && found >= 0 && other.tag < faces[found].tag)) {
        least = distance;
        found = g;
      }
    });
    return found;
  }

  /// Links between nodes, each decided by the owner of the face with the lower tag. Gaps are not
  /// looked into for faces that are linked already by a way around.
  void find_links(std::vector<Link> &links)
  {
    links.clear();
    known.reset((int) faces.size());
    mesh_links(links);
    for (int f = 0; f < (int) faces.size(); f++)
      if (faces[f].own && faces[f].node) gap_links(f, links);
  }

  /// Is the way open between points just above the centroids of two faces?
  bool see_each_other(const FloodFace &f, const FloodFace &g) const
  {
    list.clear();
    near(f.mid, [this](int h) {
      list.push_back(h);
    });
    return open(f, g);
  }

 private:
  FloodSettings set = {0.0, 0.0, 0.0};
  Vec3 lo = Vec3::Zero();
  double width = 1.0, largest = 0.0;
  int count[3] = {1, 1, 1};
  std::vector<int> first, fill, member;
  mutable std::vector<int> list;
  Components known;
  struct Side {
    std::int64_t lo, hi;
    int face;
  };
  std::vector<Side> sides;

  void place(const Vec3 &x, int *at) const
  {
    for (int k = 0; k < 3; k++)
      at[k] = (int) std::max(0.0, std::min(count[k] - 1.0, std::floor((x[k] - lo[k]) / width)));
  }
  size_t bin(const Vec3 &x) const
  {
    int at[3];
    place(x, at);
    return ((size_t) at[2] * count[1] + at[1]) * count[0] + at[0];
  }
  template <class Use> void near(const Vec3 &x, Use &&use) const
  {
    int at[3];
    place(x, at);
    for (int k = std::max(0, at[2] - 1); k <= std::min(count[2] - 1, at[2] + 1); k++)
      for (int j = std::max(0, at[1] - 1); j <= std::min(count[1] - 1, at[1] + 1); j++)
        for (int i = std::max(0, at[0] - 1); i <= std::min(count[0] - 1, at[0] + 1); i++) {
          const size_t b = ((size_t) k * count[1] + j) * count[0] + i;
          for (int m = first[b]; m < first[b + 1]; m++) use(member[m]);
        }
  }

  void add(int f, int g, std::vector<Link> &links)
  {
    const int low = faces[f].tag < faces[g].tag ? f : g, high = low == f ? g : f;
    if (faces[low].tag == faces[high].tag) return;    // two images of one face
    known.link(f, g);
    if (faces[low].own) links.push_back({faces[low].tag, faces[high].tag});
  }

  void mesh_links(std::vector<Link> &links)
  {
    sides.clear();
    for (int f = 0; f < (int) faces.size(); f++)
      for (int k = 0; k < 3 && faces[f].node; k++) {
        const auto a = faces[f].vertex[k], b = faces[f].vertex[(k + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), f});
      }
    std::sort(sides.begin(), sides.end(), [](const Side &a, const Side &b) {
      return a.lo != b.lo ? a.lo < b.lo : a.hi != b.hi ? a.hi < b.hi : a.face < b.face;
    });
    for (size_t i = 0; i < sides.size(); i++)
      for (size_t j = i + 1;
           j < sides.size() && sides[j].lo == sides[i].lo && sides[j].hi == sides[i].hi; j++)
        add(sides[i].face, sides[j].face, links);
  }

  void gap_links(int f, std::vector<Link> &links)
  {
    const FloodFace &face = faces[f];
    list.clear();
    near(face.mid, [this, &face](int g) {
      const double most = set.range + set.height + faces[g].reach;
      if ((faces[g].mid - face.mid).squaredNorm() < most * most) list.push_back(g);
    });
    for (const int g : list) {
      const FloodFace &other = faces[g];
      if (!other.node || other.cell == face.cell || other.tag < face.tag) continue;
      if ((other.mid - face.mid).squaredNorm() > set.range * set.range) continue;
      if (known.root(f) == known.root(g)) continue;
      if (open(face, other)) add(f, g, links);
    }
  }

  // list holds what may be in the way

  bool open(const FloodFace &f, const FloodFace &g) const
  {
    const Vec3 p = f.mid + set.height * f.normal, q = g.mid + set.height * g.normal;
    const Vec3 middle = 0.5 * (p + q);
    const double half = 0.5 * (q - p).norm();
    bool contact = false;
    for (const int h : list) {
      const FloodFace &it = faces[h];
      const double most = half + it.reach;
      if ((it.mid - middle).squaredNorm() > most * most) continue;
      if (face_cuts(it, p, q)) return false;
      contact = contact || it.shut;
    }
    if (!contact || set.slit == 0.0) return true;
    const int n = std::max(3, (int) (2.0 * half / (0.1 * largest)));
    for (int k = 1; k < n; k++)
      if (in_slit(p + (double) k / n * (q - p))) return false;
    return true;
  }

  // between two faces in contact, of two cells and opposite

  bool in_slit(const Vec3 &x) const
  {
    for (size_t m = 0; m < list.size(); m++) {
      const FloodFace &a = faces[list[m]];
      double below, above;
      if (!lies_over(a, x, below)) continue;
      for (size_t n = m + 1; n < list.size(); n++) {
        const FloodFace &b = faces[list[n]];
        if (b.cell == a.cell || b.normal.dot(a.normal) > -0.5 || !lies_over(b, x, above)) continue;
        if (below + above <= set.slit) return true;
      }
    }
    return false;
  }
  bool lies_over(const FloodFace &it, const Vec3 &x, double &height) const
  {
    if (!it.shut) return false;
    const double most = it.reach + set.slit;
    return (x - it.mid).squaredNorm() < most * most && height_over(it, x, height) &&
           height >= 0.0 && height <= set.slit;
  }
};

/// A mark falls only when this part of its face is in contact; it is set below the threshold
/// theta: the difference keeps faces at a rim from flickering. [ours]
constexpr double MARK_FALLS = 0.5;

/// May the face be marked? contact: the part of its area in contact with other cells.
inline bool may_be_marked(double contact, double theta, bool marked)
{
  return contact < theta || (marked && contact <= MARK_FALLS);
}

}    // namespace dcm

#endif
