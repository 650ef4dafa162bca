// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Moments and shape of bodies against closed forms.

#include "law/cell_shape.h"
#include "bodies.h"

#include <algorithm>
#include <array>

using namespace dcm;
using namespace dcm_test;

using Moments = std::array<double, BODY_MOMENTS>;

static Moments moments_of(const Mesh &mesh)
{
  Moments m = {};
  for (const auto &f : mesh.faces)
    add_moments(m.data(), mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
  return m;
}

static CellShape shape_of(const Mesh &mesh)
{
  return CellShape(moments_of(mesh).data());
}

// int x^2 = a^3 b c / 3, int x y = a^2 b^2 c / 4 of a box with a corner at the origin

TEST(CellShape, MomentsOfABoxAreExact)
{
  const double a = 2.0, b = 3.0, c = 5.0, V = a * b * c;
  const Moments m = moments_of(box(a, b, c));
  const Moments right = {V,
                         0.5 * a * V,
                         0.5 * b * V,
                         0.5 * c * V,
                         a * a * V / 3.0,
                         b * b * V / 3.0,
                         c * c * V / 3.0,
                         0.25 * a * b * V,
                         0.25 * a * c * V,
                         0.25 * b * c * V};
  for (int k = 0; k < BODY_MOMENTS; k++) EXPECT_NEAR(m[k], right[k], 1e-12 * right[k]) << k;

  // variances side^2 / 12: half-axes side sqrt(5/12)
  const CellShape shape(m.data());
  const double sides[3] = {c, b, a};
  for (int k = 0; k < 3; k++) {
    EXPECT_NEAR(shape.axis(k), sides[k] * std::sqrt(5.0 / 12.0), 1e-12);
    EXPECT_NEAR(std::fabs(shape.directions(2 - k, k)), 1.0, 1e-12);
  }
  EXPECT_NEAR(shape.asphericity(), (25.0 - 0.5 * (9.0 + 4.0)) / 12.0, 1e-12);
  EXPECT_NEAR(shape.acylindricity(), (9.0 - 4.0) / 12.0, 1e-12);
  // 1 - 3 (sum of products) / (sum)^2, another form of the same
  EXPECT_NEAR(shape.anisotropy(), 1.0 - 3.0 * (25.0 * 9.0 + 9.0 * 4.0 + 4.0 * 25.0) / (38.0 * 38.0),
              1e-12);
}

TEST(CellShape, CubeHasNoAnisotropy)
{
  const double a = 4.0;
  const Mesh cube = mapped(box(a, a, a), [](const Vec3 &x) {
    return Vec3(x + Vec3(7.0, -3.0, 11.0));
  });
  const CellShape shape = shape_of(cube);
  EXPECT_NEAR(shape.anisotropy(), 0.0, 1e-12);
  EXPECT_NEAR(shape_index(volume(cube), area(cube)), 6.0, 1e-12);
  EXPECT_NEAR(sphericity(volume(cube), area(cube)), std::cbrt(PI / 6.0), 1e-12);
}

// meshes inscribed in the ellipsoid: errors fall by four from level to level. The direction of the
// long axis is exact by symmetry

TEST(CellShape, EllipsoidIsTheLimit)
{
  double before = 0.0;
  for (int level = 1; level <= 4; level++) {
    const CellShape shape = shape_of(ellipsoid(level, 3.0, 6.0, 3.0));
    const double error = std::fabs(shape.axis(0) - 6.0) + std::fabs(shape.axis(1) - 3.0) +
                         std::fabs(shape.axis(2) - 3.0);
    EXPECT_NEAR(shape.longest()[1], 1.0, 1e-12);
    if (level > 1) {
      EXPECT_NEAR(before / error, 4.0, 0.4) << level;
    }
    before = error;
    // b = (36 - 9) / 5, sum = 54 / 5
    if (level == 4) {
      EXPECT_NEAR(shape.anisotropy(), 0.25, 1e-3);
    }
  }
  EXPECT_LT(before, 0.03);
}

TEST(CellShape, BallIsTheLimit)
{
  const double R = 5.0;
  double before[3] = {};
  for (int level = 1; level <= 4; level++) {
    const Mesh mesh = ball(level, R);
    const double V = volume(mesh), A = area(mesh);
    const double error[3] = {1.0 - sphericity(V, A), shape_index(V, A) / std::cbrt(36.0 * PI) - 1.0,
                             R - shape_of(mesh).axis(0)};
    for (int k = 0; k < 3; k++) {
      EXPECT_GT(error[k], 0.0);    // a ball has the least area
      if (level > 1) {
        EXPECT_NEAR(before[k] / error[k], 4.0, 0.5) << k;
      }
      before[k] = error[k];
    }
    EXPECT_LT(shape_of(mesh).anisotropy(), 1e-12);    // by the symmetry of an icosahedron
  }
}

// a linear map F of a ball of radius R: the ellipsoid's axes are those of F, the strain is the log
// of its left stretch, with the ball's own half-axis as reference to the last digit

TEST(CellShape, StrainOfAMappedBallIsHenckys)
{
  const Mesh rest = ball(2, 4.0);
  const double R = shape_of(rest).axis(0);
  Random random(11, 0, 0);
  const Mat3 Q = random_rotation(random), P = random_rotation(random);
  const Vec3 stretch(1.4, 1.1, 0.6);
  const Mat3 F = Q * stretch.asDiagonal() * Q.transpose() * P;    // a rotation first does nothing
  const auto strain = shape_of(mapped(rest, [&](const Vec3 &x) {
                        return Vec3(F * x + Vec3(3.0, 2.0, -5.0));
                      })).strain(R);
  const Mat3 log = Q * Vec3(stretch.array().log()).asDiagonal() * Q.transpose();
  const Symmetric right = symmetric(log);
  for (int k = 0; k < 6; k++) EXPECT_NEAR(strain[k], right[k], 1e-11) << k;
  EXPECT_NEAR(strain[0] + strain[1] + strain[2], std::log(F.determinant()), 1e-11);
}

// an icosphere against the ball of its volume; as doc/compute_dcm_cell.rst says

TEST(CellShape, IcosphereAtRestHasNextToNoStrain)
{
  const double most[3] = {4.1e-4, 2.6e-5, 1.7e-6};
  for (int level = 1; level <= 3; level++) {
    const Mesh mesh = ball(level, 3.0);
    const Symmetric e = shape_of(mesh).strain(ball_radius(volume(mesh)));
    for (int k = 0; k < 3; k++) {
      EXPECT_GT(e[k], 0.9 * most[level - 1]);
      EXPECT_LT(e[k], most[level - 1]);
    }
  }
}

TEST(CellShape, DoesNotDependOnPlaceOrientationOrNumbering)
{
  Random random(5, 0, 0);
  const Mesh mesh = bumpy(2, random);
  const CellShape one = shape_of(mesh);
  const Mat3 Q = random_rotation(random);
  const Vec3 shift = 3.0 * random.gaussian_vector();
  Mesh other = mapped(mesh, [&](const Vec3 &x) {
    return Vec3(Q * x + shift);
  });
  const int n = (int) other.nodes.size();
  std::reverse(other.nodes.begin(), other.nodes.end());
  for (auto &f : other.faces) f = {n - 1 - f[1], n - 1 - f[2], n - 1 - f[0]};
  std::reverse(other.faces.begin(), other.faces.end());
  const CellShape two = shape_of(other);
  for (int k = 0; k < 3; k++) EXPECT_NEAR(two.axis(k), one.axis(k), 1e-10);
  EXPECT_NEAR(std::fabs(two.longest().dot(Q * one.longest())), 1.0, 1e-10);
  EXPECT_NEAR(two.anisotropy(), one.anisotropy(), 1e-12);

  const Mat3 turned = Q * matrix(one.strain(1.0).data()) * Q.transpose();
  const Symmetric strain = two.strain(1.0), right = symmetric(turned);
  for (int k = 0; k < 6; k++) EXPECT_NEAR(strain[k], right[k], 1e-10) << k;
}

// thin beyond what any cell is: all values are numbers, and the short axis is none below zero

TEST(CellShape, FlatAndLongBodiesHaveFiniteValues)
{
  for (const double thin : {1e-3, 1e-6, 1e-9})
    for (const Mesh &mesh : {box(1.0, 1.0, thin), box(1.0, thin, thin)}) {
      const CellShape shape = shape_of(mesh);
      for (int k = 0; k < 3; k++) {
        EXPECT_TRUE(std::isfinite(shape.axis(k)));
        EXPECT_GE(shape.axis(k), 0.0);
      }
      EXPECT_LE(shape.anisotropy(), 1.0 + 1e-12);
      EXPECT_GE(shape.anisotropy(), 0.0);
      EXPECT_NEAR(shape.longest().norm(), 1.0, 1e-12);
    }
}
