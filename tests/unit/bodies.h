// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Closed meshes and a material for the tests of division and of what it stands on, and the distance
// to a mesh by brute force.

#ifndef DCM_TEST_BODIES_H
#define DCM_TEST_BODIES_H

#include "law/confined_cell.h"
#include "law/mesh.h"
#include "helpers.h"

#include <functional>

namespace dcm_test {

using namespace dcm;

/// hepatoblast of the bile-duct scene: E_cor 5 kPa, h_cor 0.5 um, K_V 2.5 kPa
inline const DivisionMaterial HEPATOBLAST = {cortex_stiffness(5.0, 0.5, CortexStiffness::AREA),
                                             bending_stiffness(5.0, 0.5), 2.5};

inline Mesh mapped(Mesh m, const std::function<Vec3(const Vec3 &)> &map)
{
  for (Vec3 &x : m.nodes) x = map(x);
  return m;
}

inline Mesh ball(int level, double R)
{
  return mapped(icosphere(level), [=](const Vec3 &x) {
    return Vec3(R * x);
  });
}

inline Mesh ellipsoid(int level, double a, double b, double c)
{
  return mapped(icosphere(level), [=](const Vec3 &x) {
    return Vec3(a * x[0], b * x[1], c * x[2]);
  });
}

/// a ball with a deep dent around a direction
inline Mesh dented(int level, double R, const Vec3 &at = Vec3(1, 2, 2) / 3.0)
{
  return mapped(icosphere(level), [=](const Vec3 &x) {
    return Vec3(R * (1.0 - 0.5 * std::exp((x.dot(at) - 1.0) / 0.15)) * x);
  });
}

/// concave and convex edges of any kind: radius scattered from node to node
inline Mesh spiky(int level)
{
  Random random(3, level, 0);
  return mapped(icosphere(level), [&](const Vec3 &x) {
    return Vec3((1.0 + 1.5 * random.uniform()) * x);
  });
}

/// an ellipsoid away from the origin, its nodes scattered by a tenth of an edge
inline Mesh bumpy(int level, Random &random)
{
  const double noise = 0.1 * mean_edge(icosphere(level));
  const Vec3 shift = random.gaussian_vector();
  return mapped(icosphere(level), [&](const Vec3 &x) {
    return Vec3(Vec3(x[0], 1.3 * x[1], 0.8 * x[2]) + noise * random.gaussian_vector() + shift);
  });
}

inline Mesh box(double a, double b, double c)
{
  Mesh m;
  for (int i = 0; i < 8; i++) m.nodes.emplace_back(a * (i & 1), b * ((i >> 1) & 1), c * (i >> 2));
  m.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

/// distance to a triangle, independent of the header: the foot of the normal if all three sides
/// have it on their inner side, otherwise the nearest of all three segments
inline double triangle_distance(const Vec3 &x, const std::array<Vec3, 3> &t)
{
  const Vec3 m = (t[1] - t[0]).cross(t[2] - t[0]);
  bool inside = true;
  double d = 1.0e300;
  for (int k = 0; k < 3; k++) {
    const Vec3 e = t[(k + 1) % 3] - t[k], p = x - t[k];
    inside = inside && m.dot(e.cross(p)) >= 0.0;
    d = std::min(d, (p - std::clamp(p.dot(e) / e.squaredNorm(), 0.0, 1.0) * e).norm());
  }
  return inside ? std::fabs((x - t[0]).dot(m)) / m.norm() : d;
}

/// signed distance by brute force; the sign from the solid angle of all faces (4 pi or 0)
inline double brute_distance(const Mesh &mesh, const Vec3 &x)
{
  double d = 1.0e300, angle = 0.0;
  for (const auto &f : mesh.faces) {
    const std::array<Vec3, 3> t = {mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]};
    d = std::min(d, triangle_distance(x, t));
    const Vec3 a = t[0] - x, b = t[1] - x, c = t[2] - x;
    angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return angle > 2.0 * PI ? -d : d;
}

}    // namespace dcm_test

#endif
