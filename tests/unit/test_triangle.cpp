// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

#include "law/envelope.h"
#include "law/mesh.h"
#include "law/random.h"
#include "law/solid_angle.h"
#include "law/triangle.h"

#include <gtest/gtest.h>

using dcm::Vec3;

TEST(Triangle, NearestPointAgainstFineSampling)
{
  dcm::Random random(5, 1, 1);
  for (int n = 0; n < 50; n++) {
    const Vec3 a = random.gaussian_vector(), b = random.gaussian_vector(),
               c = random.gaussian_vector(), x = 2.0 * random.gaussian_vector();
    double least = 1.0e300;
    const int m = 200;
    for (int i = 0; i <= m; i++)
      for (int j = 0; j <= m - i; j++)
        least = std::min(least, (a + double(i) / m * (b - a) + double(j) / m * (c - a) - x).norm());
    const double d = (dcm::nearest_on_triangle(x, a, b, c) - x).norm();
    EXPECT_LE(d, least + 1e-12);
    EXPECT_GT(d, least - 0.03);    // the sampling is 1/200 of sides of some 3
  }
}

TEST(Triangle, DegenerateOnesAreSegments)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(2, 0, 0);
  EXPECT_NEAR((dcm::nearest_on_triangle(Vec3(1.5, 1, 0), a, b, c) - Vec3(1.5, 0, 0)).norm(), 0.0,
              1e-15);
  EXPECT_NEAR((dcm::nearest_on_triangle(Vec3(3, 4, 0), a, a, a) - a).norm(), 0.0, 1e-15);
}

TEST(Triangle, SurfaceDistanceIsThatOfTheEnvelope)
{
  dcm::Mesh mesh = dcm::icosphere(2);
  for (Vec3 &x : mesh.nodes)
    x = Vec3(3.0 * x[0], x[1], x[2] * (1.0 - 0.6 * std::exp(-4.0 * x[0] * x[0])));
  const dcm::Envelope envelope(mesh);
  dcm::Random random(7, 1, 1);
  int inside = 0;
  for (int n = 0; n < 400; n++) {
    const Vec3 g = random.gaussian_vector();
    const Vec3 x(2.0 * g[0], 0.7 * g[1], 0.7 * g[2]);
    dcm::SurfaceDistance surface;
    for (const auto &f : mesh.faces)
      surface.add(x, mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
    const double d = envelope.nearest(x).distance;
    EXPECT_NEAR(surface.distance(), std::fabs(d), 1e-12);
    EXPECT_EQ(surface.inside(), d < 0.0);
    inside += d < 0.0;
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(inside, 350);
}

TEST(Triangle, EdgesOfACubeTellTheSide)
{
  // the nearest point of all these lies on an edge or corner
  dcm::Mesh mesh;
  for (int k = 0; k < 8; k++) mesh.nodes.push_back(Vec3(k & 1, (k >> 1) & 1, k >> 2));
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  ASSERT_EQ(dcm::check_mesh(mesh), "");
  for (const Vec3 &x :
       {Vec3(-1, -1, 0.5), Vec3(2, 2, 2), Vec3(-0.1, 0.5, 1.2), Vec3(1.5, -0.5, 1.5)}) {
    dcm::SurfaceDistance surface;
    for (const auto &f : mesh.faces)
      surface.add(x, mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
    EXPECT_FALSE(surface.inside());
  }
  dcm::SurfaceDistance surface;
  for (const auto &f : mesh.faces)
    surface.add(Vec3(0.5, 0.5, 0.5), mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
  EXPECT_TRUE(surface.inside());
  EXPECT_NEAR(surface.distance(), 0.5, 1e-15);
}

TEST(Triangle, CornerOfMixedFacesTellsTheSide)
{
  // a sharp apex over a dented ring: from beside it some faces are seen from the front, some from
  // the back; against the winding number of the whole surface
  dcm::Mesh mesh = dcm::icosphere(2);
  for (size_t k = 0; k < mesh.nodes.size(); k++)
    mesh.nodes[k] *= k % 3 ? 1.0 : 1.0 + 2.0 * (k % 2) - 0.6 * (k % 5 == 0);
  dcm::Random random(8, 1, 1);
  int inside = 0, corners = 0;
  for (int n = 0; n < 600; n++) {
    const Vec3 x = 1.2 * random.gaussian_vector();
    dcm::SurfaceDistance surface;
    double winding = 0.0, corner = 1e9;
    for (const auto &f : mesh.faces) {
      const Vec3 a = mesh.nodes[f[0]], b = mesh.nodes[f[1]], c = mesh.nodes[f[2]];
      surface.add(x, a, b, c);
      winding += dcm::face_winding(x, a, b, c);
      corner = std::min(corner, (x - a).norm());
    }
    EXPECT_EQ(surface.inside(), winding > 0.5);
    inside += winding > 0.5;
    corners += corner < surface.distance() * (1.0 + 1e-9);
  }
  EXPECT_GT(inside, 50);
  EXPECT_GT(corners, 25);
}
