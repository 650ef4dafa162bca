// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The shape that takes the place of a sphere: volume, flattening by the planes of equal power,
// rotation, valid meshes in random packings.

#include "law/shape.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

namespace {

double sphere(double radius)
{
  return 4.0 / 3.0 * PI * radius * radius * radius;
}

Mesh fitted(const Ball &cell, const std::vector<Ball> &neighbors, const Mesh &round)
{
  return {fit_between(cell, sphere(cell.radius), neighbors, round), round.faces};
}

// neighbors around a cell of radius 5, overlapping it a little, none near another
std::vector<Ball> packing(Random &random, const Vec3 &center)
{
  std::vector<Ball> balls;
  for (int k = 0; k < 40; k++) {
    const Vec3 e = random.unit_vector();
    const double radius = 4.0 + 2.0 * random.uniform();
    const Ball ball = {center + (4.3 + radius) * e, radius};
    const bool free = std::all_of(balls.begin(), balls.end(), [&](const Ball &other) {
      return (other.x - ball.x).norm() > 0.9 * (other.radius + ball.radius);
    });
    if (free) balls.push_back(ball);
  }
  return balls;
}

}    // namespace

TEST(Shape, RoundWithoutNeighbors)
{
  const Ball cell = {{10.0, -20.0, 30.0}, 6.0};
  for (int level : {1, 2, 3}) {
    const Mesh round = icosphere(level);
    // the far one does not touch, the one in the very center has no direction
    const Mesh mesh = fitted(cell, {{cell.x + Vec3(20.0, 0.0, 0.0), 6.0}, cell}, round);
    const double expected = 6.0 * std::cbrt(sphere(1.0) / volume(round));
    for (const Vec3 &x : mesh.nodes) EXPECT_NEAR((x - cell.x).norm(), expected, 1.0e-10);
    EXPECT_NEAR(volume(mesh), sphere(6.0), 1.0e-10 * sphere(6.0));
  }
}

TEST(Shape, VolumeIsKept)
{
  Random random(1, 2, 3);
  const Ball cell = {{1.0, 2.0, 3.0}, 5.0};
  for (int k = 0; k < 50; k++) {
    const auto neighbors = packing(random, cell.x);
    ASSERT_GE(neighbors.size(), 4u);
    const Mesh mesh = fitted(cell, neighbors, icosphere(1 + k % 2));
    EXPECT_NEAR(volume(mesh), sphere(5.0), 1.0e-10 * sphere(5.0));
    EXPECT_EQ(check_mesh(mesh), "");
  }
}

TEST(Shape, OneNeighborEqualRadius)
{
  // two spheres of 5 at 8: flat at 4, where the nodes lie that would be beyond
  const Ball cell = {Vec3::Zero(), 5.0};
  const Mesh mesh = fitted(cell, {{{8.0, 0.0, 0.0}, 5.0}}, icosphere(2));
  int flat = 0;
  double radius = 0.0;
  for (const Vec3 &x : mesh.nodes) {
    EXPECT_LT(x[0], 4.0 + 1.0e-9);    // the scaling has nothing left to make up
    flat += x[0] > 4.0 - 1.0e-9;
    radius = std::max(radius, x.norm());
  }
  EXPECT_GT(flat, 10);
  for (const Vec3 &x : mesh.nodes)
    if (x[0] < 3.9) {
      EXPECT_NEAR(x.norm(), radius, 1.0e-9);    // round elsewhere
    }
  // the cut ball has the volume of the sphere, so its radius is larger by about what is lost: a cap
  // of height h = R - 4, pi h^2 (R - h/3); on a mesh of 162 nodes within 3 %
  double R = 5.0;
  for (int k = 0; k < 100; k++)
    R = std::cbrt(125.0 + 0.75 * (R - 4.0) * (R - 4.0) * (R - (R - 4.0) / 3.0));
  EXPECT_NEAR(radius, R, 0.03 * R);
}

TEST(Shape, PlaneOfEqualPower)
{
  // a point of the plane has the same tangent length to both spheres: |x|^2 - 25 = |x - d|^2 - 49
  const Ball cell = {Vec3::Zero(), 5.0}, other = {{0.0, 10.5, 0.0}, 7.0};
  const Mesh mesh = fitted(cell, {other}, icosphere(3));
  double most = 0.0;
  Vec3 top = Vec3::Zero();
  for (const Vec3 &x : mesh.nodes)
    if (x[1] > most) {
      most = x[1];
      top = x;
    }
  EXPECT_NEAR(top.squaredNorm() - 25.0, (top - other.x).squaredNorm() - 49.0, 1.0e-6);
}

TEST(Shape, BothSidesShareThePlane)
{
  const Ball a = {{1.0, 0.0, 0.0}, 5.0}, b = {{7.0, 5.0, 2.0}, 4.5};
  const Vec3 n = (b.x - a.x).normalized();
  double from_a = -1.0e9, from_b = 1.0e9;
  for (const Vec3 &x : fitted(a, {b}, icosphere(2)).nodes) from_a = std::max(from_a, n.dot(x));
  for (const Vec3 &x : fitted(b, {a}, icosphere(2)).nodes) from_b = std::min(from_b, n.dot(x));
  EXPECT_NEAR(from_a, from_b, 1.0e-9);
}

TEST(Shape, WhatIsMissingIsMadeUpByScaling)
{
  // six spheres leave a cube of edge 2 x 3.5: the mesh fills it at most and is then scaled to the
  // volume of the sphere, all in proportion
  const Ball cell = {Vec3::Zero(), 5.0};
  std::vector<Ball> neighbors;
  for (int d = 0; d < 3; d++)
    for (double s : {-7.0, 7.0}) neighbors.push_back({s * Vec3::Unit(d), 5.0});
  EXPECT_TRUE(has_room(cell, neighbors));
  const Mesh mesh = fitted(cell, neighbors, icosphere(3));
  EXPECT_NEAR(volume(mesh), sphere(5.0), 1.0e-10 * sphere(5.0));
  EXPECT_EQ(check_mesh(mesh), "");
  const double half = mesh.nodes[0].cwiseAbs().maxCoeff();
  for (const Vec3 &x : mesh.nodes) EXPECT_NEAR(x.cwiseAbs().maxCoeff(), half, 1.0e-10);
  // a full cube would have half its edge cbrt(volume) = 4.03; chamfered edges need a little more
  EXPECT_GT(2.0 * half, std::cbrt(sphere(5.0)));
  EXPECT_LT(2.0 * half, 1.05 * std::cbrt(sphere(5.0)));
}

TEST(Shape, RoomForAShape)
{
  // planes at half the distance of equal spheres, 0.7 of the radius is the least
  const Ball cell = {Vec3::Zero(), 5.0};
  EXPECT_TRUE(has_room(cell, {}));
  EXPECT_TRUE(has_room(cell, {{{7.01, 0.0, 0.0}, 5.0}}));
  EXPECT_FALSE(has_room(cell, {{{7.01, 0.0, 0.0}, 5.0}, {{0.0, 6.99, 0.0}, 5.0}}));
  EXPECT_FALSE(has_room(cell, {{{2.0, 0.0, 0.0}, 8.0}}));    // center beyond the plane
}

TEST(Shape, TurnsWithItsSurroundings)
{
  Random random(4, 5, 6);
  const Ball cell = {Vec3::Zero(), 5.0};
  const Mesh round = icosphere(2);
  for (int k = 0; k < 5; k++) {
    const auto neighbors = packing(random, cell.x);
    const Mat3 turn = random_rotation(random);
    auto turned = neighbors;
    for (Ball &ball : turned) ball.x = turn * ball.x;
    Mesh turned_round = round;
    for (Vec3 &x : turned_round.nodes) x = turn * x;
    const Mesh a = fitted(cell, neighbors, round), b = fitted(cell, turned, turned_round);
    for (size_t n = 0; n < a.nodes.size(); n++)
      EXPECT_LT((turn * a.nodes[n] - b.nodes[n]).norm(), 1.0e-10);
  }
}
