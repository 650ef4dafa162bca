// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Closed triangulated surfaces: icospheres, edges, hinges, measures and a validity check.
// Set-up code: it allocates and is not meant for the time step. Files: mesh_io.h.

#ifndef DCM_MESH_H
#define DCM_MESH_H

#include "vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace dcm {

/// Nodes (um) and faces; a face lists its nodes counter-clockwise seen from outside, from 0.
struct Mesh {
  std::vector<Vec3> nodes;
  std::vector<std::array<int, 3>> faces;
};

namespace mesh_detail {

  /// One side of one face: lo < hi are its nodes, forward tells whether the face runs lo to hi.
  struct HalfEdge {
    int lo, hi, opposite, face;
    bool forward;
  };

  /// All sides of all faces, those of one edge next to each other, forward ones first.
  inline std::vector<HalfEdge> half_edges(const Mesh &mesh)
  {
    std::vector<HalfEdge> half;
    half.reserve(3 * mesh.faces.size());
    for (int f = 0; f < int(mesh.faces.size()); f++)
      for (int k = 0; k < 3; k++) {
        const int p = mesh.faces[f][k], q = mesh.faces[f][(k + 1) % 3];
        half.push_back({std::min(p, q), std::max(p, q), mesh.faces[f][(k + 2) % 3], f, p < q});
      }
    std::sort(half.begin(), half.end(), [](const HalfEdge &a, const HalfEdge &b) {
      if (a.lo != b.lo) return a.lo < b.lo;
      if (a.hi != b.hi) return a.hi < b.hi;
      if (a.forward != b.forward) return a.forward;
      return a.face < b.face;
    });
    return half;
  }

  /// End of the group of half-edges that belongs to the same edge as number i.
  inline size_t group_end(const std::vector<HalfEdge> &half, size_t i)
  {
    size_t j = i + 1;
    while (j < half.size() && half[j].lo == half[i].lo && half[j].hi == half[i].hi) j++;
    return j;
  }

}    // namespace mesh_detail

/// Edges, each once, as (lower node, higher node) in ascending order.
inline std::vector<std::array<int, 2>> edges(const Mesh &mesh)
{
  const auto half = mesh_detail::half_edges(mesh);
  std::vector<std::array<int, 2>> list;
  list.reserve(half.size() / 2);
  for (size_t i = 0; i < half.size(); i = mesh_detail::group_end(half, i))
    list.push_back({half[i].lo, half[i].hi});
  return list;
}

/// Hinges (n1, n2, n3, n4): n2-n3 is the edge, triangle 1 = (n2, n3, n1) and triangle 2 =
/// (n3, n2, n4) are counter-clockwise seen from outside; the order dcm::hinge() expects. On a
/// closed mesh hinge number i sits on edge number i of edges() with n2 < n3. Edges with one face
/// only have no hinge. Throws std::invalid_argument on an edge whose faces do not pair up.
inline std::vector<std::array<int, 4>> hinges(const Mesh &mesh)
{
  const auto half = mesh_detail::half_edges(mesh);
  std::vector<std::array<int, 4>> list;
  list.reserve(half.size() / 2);
  for (size_t i = 0; i < half.size();) {
    const size_t j = mesh_detail::group_end(half, i);
    if (j - i > 2 || (j - i == 2 && half[i].forward == half[i + 1].forward))
      throw std::invalid_argument(
          "mesh edge between nodes " + std::to_string(half[i].lo + 1) + " and " +
          std::to_string(half[i].hi + 1) +
          " does not join two equally oriented faces: run check_mesh() first");
    if (j - i == 2)
      list.push_back({half[i].opposite, half[i].lo, half[i].hi, half[i + 1].opposite});
    i = j;
  }
  return list;
}

/// Enclosed volume, um^3, negative if the mesh is inside out. Taken about the mean node, so that
/// a mesh far from the origin loses no digits.
inline double volume(const Mesh &mesh)
{
  if (mesh.nodes.empty()) return 0.0;
  Vec3 mid = Vec3::Zero();
  for (const Vec3 &x : mesh.nodes) mid += x;
  mid /= double(mesh.nodes.size());
  double v = 0.0;
  for (const auto &f : mesh.faces)
    v += (mesh.nodes[f[0]] - mid).dot((mesh.nodes[f[1]] - mid).cross(mesh.nodes[f[2]] - mid));
  return v / 6.0;
}

/// Surface area, um^2.
inline double area(const Mesh &mesh)
{
  double s = 0.0;
  for (const auto &f : mesh.faces)
    s += (mesh.nodes[f[1]] - mesh.nodes[f[0]]).cross(mesh.nodes[f[2]] - mesh.nodes[f[0]]).norm();
  return 0.5 * s;
}

/// Mean edge length, um. Zero for a mesh without faces.
inline double mean_edge(const Mesh &mesh)
{
  const auto list = edges(mesh);
  double sum = 0.0;
  for (const auto &e : list) sum += (mesh.nodes[e[1]] - mesh.nodes[e[0]]).norm();
  return list.empty() ? 0.0 : sum / double(list.size());
}

/// Shape of a triangle, 4 sqrt(3) area / (sum of squared sides): 1 equilateral, 0 degenerate.
inline double face_quality(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return 2.0 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / sides;
}

/// Quality of the worst face of a mesh.
inline double worst_face(const Mesh &mesh)
{
  double worst = 1.0;
  for (const auto &f : mesh.faces)
    worst = std::min(worst, face_quality(mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]));
  return worst;
}

/// Icosphere with all nodes on the unit sphere: an icosahedron, every face split into four at its
/// edge midpoints `level` times, new nodes pushed out to the sphere each time. Levels 1 to 5 give
/// 42, 162, 642, 2562 and 10242 nodes; anything else throws std::invalid_argument.
inline Mesh icosphere(int level)
{
  if (level < 1 || level > 5)
    throw std::invalid_argument("icosphere level " + std::to_string(level) +
                                " is not available: use 1 to 5 (42 to 10242 nodes)");
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  Mesh mesh;
  mesh.nodes = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3 &x : mesh.nodes) x.normalize();
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};

  for (int i = 0; i < level; i++) {
    const auto list = edges(mesh);    // sorted: an edge is found by bisection
    const int nold = int(mesh.nodes.size());
    for (const auto &e : list)
      mesh.nodes.push_back((mesh.nodes[e[0]] + mesh.nodes[e[1]]).normalized());
    auto middle = [&](int p, int q) {
      const std::array<int, 2> e = {std::min(p, q), std::max(p, q)};
      return nold + int(std::lower_bound(list.begin(), list.end(), e) - list.begin());
    };
    std::vector<std::array<int, 3>> fine;
    fine.reserve(4 * mesh.faces.size());
    for (const auto &f : mesh.faces) {
      const int a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      fine.push_back({f[0], a, c});
      fine.push_back({f[1], b, a});
      fine.push_back({f[2], c, b});
      fine.push_back({a, b, c});
    }
    mesh.faces.swap(fine);
  }
  return mesh;
}

/// A face below this fraction of the mean face area counts as degenerate.
constexpr double MESH_SMALL_AREA = 1.0e-6;
/// A face whose height is below this fraction of its longest side counts as degenerate.
constexpr double MESH_FLAT_FACE = 1.0e-4;

/// Check that a mesh can be the surface of a cell: one closed, outward oriented sphere-like
/// surface of faces with area. Returns an empty string, or one sentence naming the first fault
/// found, its nodes or faces (numbered from 1 in mesh order) and the remedy where there is one.
inline std::string check_mesh(const Mesh &mesh)
{
  using std::to_string;
  const int nn = int(mesh.nodes.size()), nf = int(mesh.faces.size());
  auto node = [](int i) {
    return "node " + to_string(i + 1);
  };
  auto face = [](int f) {
    return "face " + to_string(f + 1);
  };
  if (nn == 0 || nf == 0) return "the mesh has no " + std::string(nn == 0 ? "nodes" : "faces");

  for (int i = 0; i < nn; i++)
    if (!mesh.nodes[i].allFinite()) return node(i) + " has a coordinate that is not finite";

  std::vector<int> used(nn, 0);
  for (int f = 0; f < nf; f++) {
    const auto &v = mesh.faces[f];
    for (int i : v) {
      if (i < 0 || i >= nn)
        return face(f) + " refers to " + node(i) + ", but the mesh has nodes 1 to " + to_string(nn);
      used[i]++;
    }
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      return face(f) + " is degenerate: it names a node twice";
  }
  for (int i = 0; i < nn; i++)
    if (!used[i]) return node(i) + " is isolated: no face uses it, remove it";

  // duplicates: sorted by x, equal within round-off of the mesh's size and place
  double size = 0.0;
  for (const Vec3 &x : mesh.nodes) size = std::max(size, (x - mesh.nodes[0]).cwiseAbs().maxCoeff());
  if (size == 0.0) return "all nodes of the mesh lie in one point";
  const double same = 1.0e-9 * size;
  std::vector<int> order(nn);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    return mesh.nodes[i][0] < mesh.nodes[j][0];
  });
  for (int i = 0; i < nn; i++)
    for (int j = i + 1; j < nn; j++) {
      const Vec3 d = mesh.nodes[order[j]] - mesh.nodes[order[i]];
      if (d[0] > same) break;
      if (d.norm() <= same)
        return node(std::min(order[i], order[j])) + " and " + node(std::max(order[i], order[j])) +
               " lie in the same place: merge duplicate nodes";
    }

  // every edge joins two faces that run along it in opposite directions
  const auto half = mesh_detail::half_edges(mesh);
  const auto list = edges(mesh);
  for (size_t i = 0; i < half.size();) {
    const size_t j = mesh_detail::group_end(half, i);
    const std::string edge =
        "the edge between nodes " + to_string(half[i].lo + 1) + " and " + to_string(half[i].hi + 1);
    if (j - i == 1)
      return "the surface is open: " + edge + " belongs to " + face(half[i].face) +
             " only, close the hole";
    if (j - i > 2)
      return "the surface is not a manifold: " + edge + " is shared by " + to_string(j - i) +
             " faces, among them faces " + to_string(half[i].face + 1) + ", " +
             to_string(half[i + 1].face + 1) + " and " + to_string(half[i + 2].face + 1);
    if (half[i].forward == half[i + 1].forward)
      return "the faces are not oriented alike: faces " + to_string(half[i].face + 1) + " and " +
             to_string(half[i + 1].face + 1) + " run along " + edge +
             " in the same direction, flip one of them";
    i = j;
  }

  // areas, relative to the mesh and to the face's own sides
  const double mean = area(mesh) / nf;
  for (int f = 0; f < nf; f++) {
    const Vec3 u = mesh.nodes[mesh.faces[f][1]] - mesh.nodes[mesh.faces[f][0]];
    const Vec3 v = mesh.nodes[mesh.faces[f][2]] - mesh.nodes[mesh.faces[f][0]];
    const double twice = u.cross(v).norm();
    const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
    if (0.5 * twice <= MESH_SMALL_AREA * mean || twice <= MESH_FLAT_FACE * longest)
      return face(f) + " is degenerate: its three nodes lie on a line or nearly so";
  }

  // one component: join the ends of every edge
  std::vector<int> root(nn);
  std::iota(root.begin(), root.end(), 0);
  auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const auto &e : list) root[find(e[0])] = find(e[1]);
  for (int i = 1; i < nn; i++)
    if (find(i) != find(0))
      return "the mesh has more than one component: " + node(i) + " is not connected to node 1";

  // a node where two surfaces touch: walking from face to face around it misses some of its faces
  std::vector<std::vector<std::array<int, 2>>> around(nn);
  for (const auto &v : mesh.faces)
    for (int k = 0; k < 3; k++) around[v[k]].push_back({v[(k + 1) % 3], v[(k + 2) % 3]});
  for (int i = 0; i < nn; i++) {
    auto &fan = around[i];
    size_t steps = 0;
    int at = fan[0][0];
    do {
      for (const auto &side : fan)
        if (side[0] == at) {
          at = side[1];
          break;
        }
      steps++;
    } while (at != fan[0][0] && steps < fan.size());
    if (steps != fan.size())
      return "the surface is not a manifold: it touches itself at " + node(i);
  }

  const int euler = nn - int(list.size()) + nf;
  if (euler != 2)
    return "the surface is not a sphere: its Euler characteristic (nodes - edges + faces) is " +
           to_string(euler) + ", not 2, it has a handle";

  if (!(volume(mesh) > 0.0)) return "the mesh is inside out (negative volume): flip all faces";
  return "";
}

}    // namespace dcm

#endif
