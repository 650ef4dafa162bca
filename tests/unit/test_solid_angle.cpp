// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Solid angles that are known: of a corner, of the side of a cube, of a rectangle, of surfaces.

#include "law/solid_angle.h"
#include "bodies.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

TEST(SolidAngle, Octant)
{
  const Vec3 x(0.3, -0.2, 0.9);
  for (const double r : {1.0e-3, 1.0, 1.0e3}) {
    const Vec3 a = x + r * Vec3::UnitX(), b = x + 2.0 * r * Vec3::UnitY(),
               c = x + 0.5 * r * Vec3::UnitZ();
    EXPECT_NEAR(face_winding(x, a, b, c), 0.125, 1.0e-12);
    EXPECT_NEAR(face_winding(x, a, c, b), -0.125, 1.0e-12);
  }
}

TEST(SolidAngle, SideOfACube)
{
  const Mesh cube = box(2, 2, 2);
  double side = 0.0;
  for (const auto &f : cube.faces) {
    const Vec3 &a = cube.nodes[f[0]], &b = cube.nodes[f[1]], &c = cube.nodes[f[2]];
    if (a[0] == 2.0 && b[0] == 2.0 && c[0] == 2.0) side += face_winding(Vec3(1, 1, 1), a, b, c);
  }
  EXPECT_NEAR(side, 1.0 / 6.0, 1.0e-14);
}

TEST(SolidAngle, ClosedSurfaces)
{
  for (const Mesh &mesh : {icosphere(2), dented(2, 1.0), box(1, 1, 1)})
    for (const bool inside : {true, false}) {
      const Vec3 x = inside ? Vec3(0.1, 0.2, 0.15) : Vec3(3.0, -2.0, 0.5);
      double sum = 0.0;
      for (const auto &f : mesh.faces)
        sum += face_winding(x, mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
      EXPECT_NEAR(sum, inside ? 1.0 : 0.0, 1.0e-13);
    }
}

TEST(SolidAngle, EdgeOnAndNothing)
{
  EXPECT_EQ(face_winding(Vec3::Zero(), {1, 0, 0}, {2, 0, 0}, {1, 1, 0}), 0.0);
  EXPECT_EQ(face_winding(Vec3::Zero(), {1, 0, 0}, {1, 0, 0}, {1, 1, 1}), 0.0);
}
