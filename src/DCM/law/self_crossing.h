// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Does a closed surface run through itself? Its topology and volume may be sound and it is still no
// surface of a cell. Set-up code: it allocates and is not meant for the time step.

#ifndef DCM_SELF_CROSSING_H
#define DCM_SELF_CROSSING_H

#include "mesh.h"

namespace dcm {

/// Does the segment p-q run through the inside of triangle a, b, c? One that only touches its rim,
/// or lies in its plane, does not.
inline bool pierces(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const Vec3 n = (b - a).cross(c - a);
  const double hp = n.dot(p - a), hq = n.dot(q - a);
  if (!(hp * hq < 0.0)) return false;
  const Vec3 d = q - p;    // volumes of the tetrahedra on p-q and each side have one sign inside
  const double u = d.dot((a - p).cross(b - p)), v = d.dot((b - p).cross(c - p)),
               w = d.dot((c - p).cross(a - p));
  return (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
}

/// Two faces of a mesh that cross each other, from 0; {-1, -1}: there are none. Faces that share a
/// node are compared by the sides that do not end at it. Faces are swept along x, so that only
/// those that overlap in space are compared.
inline std::array<int, 2> self_crossing(const Mesh &mesh)
{
  struct Box {
    Vec3 lo, hi;
    int face;
  };
  std::vector<Box> boxes;
  for (int f = 0; f < int(mesh.faces.size()); f++) {
    const auto &v = mesh.faces[f];
    const Vec3 &a = mesh.nodes[v[0]], &b = mesh.nodes[v[1]], &c = mesh.nodes[v[2]];
    boxes.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), f});
  }
  std::sort(boxes.begin(), boxes.end(), [](const Box &s, const Box &t) {
    return s.lo[0] < t.lo[0];
  });
  auto through = [&mesh](const std::array<int, 3> &s, const std::array<int, 3> &t) {
    const Vec3 &a = mesh.nodes[t[0]], &b = mesh.nodes[t[1]], &c = mesh.nodes[t[2]];
    for (int k = 0; k < 3; k++) {
      const int p = s[k], q = s[(k + 1) % 3];
      if (std::find(t.begin(), t.end(), p) != t.end() ||
          std::find(t.begin(), t.end(), q) != t.end())
        continue;
      if (pierces(mesh.nodes[p], mesh.nodes[q], a, b, c)) return true;
    }
    return false;
  };
  for (size_t i = 0; i < boxes.size(); i++)
    for (size_t j = i + 1; j < boxes.size() && boxes[j].lo[0] <= boxes[i].hi[0]; j++) {
      const Box &s = boxes[i], &t = boxes[j];
      if ((t.lo.array() > s.hi.array()).any() || (s.lo.array() > t.hi.array()).any()) continue;
      if (through(mesh.faces[s.face], mesh.faces[t.face]) ||
          through(mesh.faces[t.face], mesh.faces[s.face]))
        return {std::min(s.face, t.face), std::max(s.face, t.face)};
    }
  return {-1, -1};
}

}    // namespace dcm

#endif
