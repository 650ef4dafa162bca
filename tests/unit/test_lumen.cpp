// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Measures of a lumen on walls of known shape: a mesh inside out, and a tube.

#include "law/lumen.h"
#include "bodies.h"
#include "helpers.h"
#include "law/mesh.h"

#include <algorithm>
#include <limits>

using namespace dcm;
using namespace dcm_test;

namespace {

// the cells around the mesh: their normals point into it
Mesh inside_out(Mesh mesh)
{
  for (auto &f : mesh.faces) std::swap(f[1], f[2]);
  return mesh;
}

LumenSums measure(const Mesh &wall, const Vec3 &center, int axis = 2, double at = 0.0)
{
  LumenSums sums;
  for (const auto &f : wall.faces) {
    const Vec3 a = wall.nodes[f[0]] - center, b = wall.nodes[f[1]] - center,
               c = wall.nodes[f[2]] - center;
    add_face(sums, a, b, c);
    add_section(sums, a, b, c, axis, at - center[axis]);
  }
  return sums;
}

// a prism over a regular polygon along z, open at both ends, seen from inside
Mesh tube(int n, double radius, double lo, double hi)
{
  Mesh mesh;
  for (int i = 0; i < n; i++)
    for (const double z : {lo, hi}) {
      const double phi = 2.0 * PI * i / n;
      mesh.nodes.push_back({radius * std::cos(phi), radius * std::sin(phi), z});
    }
  for (int i = 0; i < n; i++) {
    const int a = 2 * i, b = 2 * ((i + 1) % n);
    mesh.faces.push_back({a, b + 1, b});
    mesh.faces.push_back({a, a + 1, b + 1});
  }
  return mesh;
}

}    // namespace

TEST(Lumen, InvertedIcosphere)
{
  for (const Vec3 &center : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.1)}) {
    const Mesh body = icosphere(2);
    const LumenSums sums = measure(inside_out(body), center, 2, 0.21);
    EXPECT_NEAR(sums.volume, volume(body), 1.0e-13);
    EXPECT_NEAR(sums.area, area(body), 1.0e-12);
    EXPECT_LT(sums.closure(), 1.0e-15);
    // the polygon: corners where edges go through the plane, by angle
    std::vector<Vec3> corners;
    for (const auto &e : edges(body)) {
      const Vec3 &p = body.nodes[e[0]], &q = body.nodes[e[1]];
      const double hp = p[2] - 0.21, hq = q[2] - 0.21;
      if (hp * hq < 0.0) corners.push_back(p + hp / (hp - hq) * (q - p));
    }
    std::sort(corners.begin(), corners.end(), [](const Vec3 &a, const Vec3 &b) {
      return std::atan2(a[1], a[0]) < std::atan2(b[1], b[0]);
    });
    double S = 0.0, L = 0.0;
    for (size_t i = 0; i < corners.size(); i++) {
      const Vec3 &p = corners[i], &q = corners[(i + 1) % corners.size()];
      S += 0.5 * (p[0] * q[1] - p[1] * q[0]);
      L += (q - p).norm();
    }
    EXPECT_GT(corners.size(), 20u);
    EXPECT_NEAR(sums.section, S, 1.0e-13);
    EXPECT_NEAR(sums.perimeter, L, 1.0e-13);
    EXPECT_LT(sums.missing_outline(), 1.0e-15);
    EXPECT_NEAR(sums.circularity(), 4.0 * PI * S / (L * L), 1.0e-13);
  }
}

TEST(Lumen, SectionsAcrossAnyAxis)
{
  const Mesh wall = inside_out(box(1, 2, 3));
  const Vec3 center(0.4, 0.9, 1.3);
  const double expected[] = {6.0, 3.0, 2.0}, around[] = {10.0, 8.0, 6.0};
  for (int axis = 0; axis < 3; axis++) {
    const LumenSums sums = measure(wall, center, axis, 0.37);
    EXPECT_NEAR(sums.section, expected[axis], 1.0e-14);
    EXPECT_NEAR(sums.perimeter, around[axis], 1.0e-14);
    EXPECT_NEAR(sums.volume, 6.0, 1.0e-14);
  }
  EXPECT_EQ(measure(wall, center, 2, 3.5).perimeter, 0.0);
  EXPECT_EQ(LumenSums().circularity(), 0.0);
}

TEST(Lumen, ACellIsNoLumen)
{
  const LumenSums sums = measure(icosphere(1), Vec3::Zero());
  EXPECT_LT(sums.volume, 0.0);
  EXPECT_LT(sums.section, 0.0);
}

TEST(Lumen, SlabOfATube)
{
  const int n = 12;
  const double R = 4.0, S = 0.5 * n * R * R * std::sin(2.0 * PI / n);
  const double L = 2.0 * n * R * std::sin(PI / n);
  const Mesh wall = tube(n, R, -5.0, 7.0);
  for (const Vec3 &center : {Vec3(0, 0, 0), Vec3(1.0, 0.5, -2.0)}) {
    LumenSums sums;
    for (const auto &f : wall.faces) {
      const Vec3 a = wall.nodes[f[0]] - center, b = wall.nodes[f[1]] - center,
                 c = wall.nodes[f[2]] - center;
      add_face_in_slab(sums, a, b, c, 2, -1.0 - center[2], 1.5 - center[2]);
      add_section(sums, a, b, c, 2, 0.5 - center[2]);
    }
    EXPECT_NEAR(sums.volume, 2.5 * S, 1.0e-12);
    EXPECT_NEAR(sums.area, 2.5 * L, 1.0e-12);
    EXPECT_LT(sums.closure(), 1.0e-14);
    EXPECT_NEAR(sums.section, S, 1.0e-12);
    EXPECT_NEAR(sums.perimeter, L, 1.0e-12);
  }
  // a side of twelve is missing: so much of the outline
  LumenSums open;
  for (size_t f = 2; f < wall.faces.size(); f++) {
    const auto &v = wall.faces[f];
    add_section(open, wall.nodes[v[0]], wall.nodes[v[1]], wall.nodes[v[2]], 2, 0.0);
  }
  EXPECT_NEAR(open.missing_outline(), 1.0 / 11.0, 1.0e-13);
}

TEST(Lumen, Covered)
{
  const auto covered = [](const Mesh &wall, const Vec3 &center, auto &&counts) {
    LumenSums sums;
    for (const auto &f : wall.faces) {
      const Vec3 a = wall.nodes[f[0]] - center, b = wall.nodes[f[1]] - center,
                 c = wall.nodes[f[2]] - center;
      if (counts(Vec3((a + b + c) / 3.0))) add_covered(sums, a, b, c);
    }
    return sums.covered;
  };
  const auto all = [](const Vec3 &) {
    return true;
  };
  const Mesh sphere = inside_out(icosphere(2)), cube = inside_out(box(2, 2, 2));
  const Vec3 mid(1, 1, 1);
  for (const Vec3 &center : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.1)})
    EXPECT_NEAR(covered(sphere, center, all), 1.0, 1.0e-13);
  EXPECT_NEAR(covered(inside_out(dented(2, 3)), Vec3::Zero(), all), 1.0, 1.0e-13);
  EXPECT_NEAR(covered(sphere, Vec3(2, 1, 0), all), 0.0, 1.0e-13);
  EXPECT_NEAR(covered(icosphere(2), Vec3::Zero(), all), -1.0, 1.0e-13);    // a cell is no lumen
  const auto side = [](const Vec3 &x) {
    return x[1] > 0.999;
  };
  EXPECT_NEAR(covered(cube, mid, side), 1.0 / 6.0, 1.0e-14);
  // of an octahedron, which has a face in each octant
  Mesh octahedron;
  for (int k = 0; k < 6; k++) octahedron.nodes.push_back((k < 3 ? 1.0 : -1.0) * Vec3::Unit(k % 3));
  for (int k = 0; k < 8; k++) {
    const int x = k & 1 ? 3 : 0, y = k & 2 ? 4 : 1, z = k & 4 ? 5 : 2;
    const bool turned = ((k & 1) + (k >> 1 & 1) + (k >> 2)) % 2;
    octahedron.faces.push_back({x, turned ? y : z, turned ? z : y});
  }
  EXPECT_NEAR(covered(octahedron, Vec3::Zero(), all), 1.0, 1.0e-14);
  const auto octant = [](const Vec3 &x) {
    return x.minCoeff() > 0.0;
  };
  EXPECT_NEAR(covered(octahedron, Vec3::Zero(), octant), 0.125, 1.0e-14);
}

TEST(Lumen, WhatATubeCovers)
{
  // a square tube of half width d, cut off at -h and h: each side is a rectangle at distance d, of
  // solid angle 4 atan(d h/(d sqrt(2 d^2 + h^2)))
  const double d = 1.5, h = 2.0;
  const Mesh wall = tube(4, d * std::sqrt(2.0), -5.0, 7.0);
  LumenSums sums, none;
  for (const auto &f : wall.faces) {
    const Vec3 &a = wall.nodes[f[0]], &b = wall.nodes[f[1]], &c = wall.nodes[f[2]];
    add_covered_in_slab(sums, a, b, c, 2, -h, h);
    add_covered_in_slab(none, a, b, c, 2, 8.0, 9.0);
  }
  EXPECT_NEAR(sums.covered, 4.0 * std::atan(h / std::sqrt(2.0 * d * d + h * h)) / PI, 1.0e-13);
  EXPECT_EQ(none.covered, 0.0);
}

TEST(Lumen, MeasuresTurnWithTheLumen)
{
  Random random(17, 0, 0);
  const Mesh body = dented(2, 3);
  const LumenSums before = measure(inside_out(body), Vec3::Zero());
  for (int i = 0; i < 5; i++) {
    const Mat3 R = random_rotation(random);
    const Vec3 shift = random.gaussian_vector();
    const Mesh turned = mapped(body, [&](const Vec3 &x) {
      return Vec3(R * x + shift);
    });
    const LumenSums after = measure(inside_out(turned), shift);
    EXPECT_NEAR(after.volume, before.volume, 1.0e-12 * before.volume);
    EXPECT_NEAR(after.area, before.area, 1.0e-12 * before.area);
  }
}

TEST(Lumen, ForceIsTheGradientOfPV)
{
  Mesh wall = inside_out(dented(2, 3));
  const double P = 0.3, h = 1.0e-5;
  std::vector<Vec3> force(wall.nodes.size(), Vec3::Zero());
  Vec3 net = Vec3::Zero(), torque = Vec3::Zero();
  double scale = 0.0;
  for (const auto &f : wall.faces) {
    const Vec3 n =
        0.5 * (wall.nodes[f[1]] - wall.nodes[f[0]]).cross(wall.nodes[f[2]] - wall.nodes[f[0]]);
    for (const int v : f) force[v] += lumen_force(P, n.norm(), n.normalized());
    scale += P * n.norm();
  }
  for (size_t i = 0; i < force.size(); i++) {
    net += force[i];
    torque += wall.nodes[i].cross(force[i]);
  }
  EXPECT_LT(net.norm(), 1.0e-14 * scale);
  EXPECT_LT(torque.norm(), 1.0e-14 * scale);
  for (size_t i = 0; i < wall.nodes.size(); i += 5)
    for (int k = 0; k < 3; k++) {
      const double x = wall.nodes[i][k];
      double V[2];
      for (int side = 0; side < 2; side++) {
        wall.nodes[i][k] = side ? x + h : x - h;
        V[side] = measure(wall, Vec3::Zero()).volume;
      }
      wall.nodes[i][k] = x;
      EXPECT_NEAR(force[i][k], P * (V[1] - V[0]) / (2.0 * h), 1.0e-9);
    }
}

TEST(Lumen, Solute)
{
  // 310 K: RT = 2.577 kPa um^3 per attomole
  EXPECT_NEAR(osmotic_pressure(10.0, 2.577, 100.0, 1.0), 0.2577, 1.0e-15);
  EXPECT_NEAR(osmotic_pressure(10.0, 2.577, 0.1, 1.0), 25.77, 1.0e-13);
  EXPECT_NEAR(osmotic_pressure(10.0, 2.577, -5.0, 1.0), 25.77, 1.0e-13);
  EXPECT_EQ(secreted(1.0, 0.5, std::numeric_limits<double>::infinity(), 4.0), 3.0);
  // to rate * loss, in steps of any size
  EXPECT_NEAR(secreted(0.0, 0.5, 100.0, 1.0e5), 50.0, 1.0e-12);
  const double half = secreted(secreted(7.0, 0.5, 100.0, 30.0), 0.5, 100.0, 30.0);
  EXPECT_NEAR(half, secreted(7.0, 0.5, 100.0, 60.0), 1.0e-12);
}
