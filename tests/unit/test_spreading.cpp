// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Adhesion along a surface: the gradient of -W times the covered area, without net force or torque.

#include "law/spreading.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

TEST(Spreading, GradientOfTheCoveredArea)
{
  Random random(3, 0, 0);
  for (int trial = 0; trial < 20; trial++) {
    const Mat3 turn = random_rotation(random);
    Points x = {turn * Vec3(0.1, 0.2, 0.0), turn * Vec3(1.3, random.uniform(), 0.3),
                turn * Vec3(0.2, 1.5, -0.2 * random.uniform())};
    const double W = 0.1, share = 0.5, covered = 0.3;
    const FaceGeometry f = make_face(x[0], x[1], x[2], 20.0);
    const double cosine = -0.8, part = covered / (f.area * 0.8);
    ASSERT_LT(part, 1.0);
    const double tension = spreading_tension(f, W, share, covered, cosine);
    EXPECT_NEAR(tension, share * W * part, 1e-15);
    // U = -share W part A, part fixed
    const auto energy = [&](const Points &y) {
      return -share * W * part * 0.5 * (y[1] - y[0]).cross(y[2] - y[0]).norm();
    };
    Points force;
    Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
    for (int k = 0; k < 3; k++) {
      force.push_back(spreading_force(f, k, tension));
      sum += force[k];
      torque += x[k].cross(force[k]);
    }
    EXPECT_LT(gradient_error(force, gradient(energy, x, 1e-5)), 1e-8);
    EXPECT_LT(sum.norm(), 1e-16);
    EXPECT_LT(torque.norm(), 1e-16);
  }
}

TEST(Spreading, NoMoreThanTheWholeFace)
{
  const FaceGeometry f = make_face({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 20.0);
  EXPECT_DOUBLE_EQ(spreading_tension(f, 0.1, 1.0, 0.5 * (1.0 + 1e-9), 1.0), 0.1);
  EXPECT_DOUBLE_EQ(spreading_tension(f, 0.1, 0.5, 1.0, 0.0), 0.05);    // edge-on
  EXPECT_DOUBLE_EQ(spreading_tension(f, 0.1, 0.5, 0.0, 1.0), 0.0);
}

// the rim of a contact: tension T on both sides of a line, half of W less on one of them, and the
// angle of Young and Dupre between balance along the contact
TEST(Spreading, YoungAndDupre)
{
  const double T = 0.2, W = 0.14, cosine = 1.0 - W / (2.0 * T), sine = std::sqrt(1 - cosine * cosine);
  const Vec3 a(0, -1, 0), b(0, 1, 0), in(-1.5, 0, 0), out(1.7 * cosine, 0, 1.7 * sine);
  const FaceGeometry inside = make_face(a, b, in, 20.0), outside = make_face(b, a, out, 20.0);
  const double lowered = spreading_tension(inside, W, SPREADING_SHARED, inside.area, 1.0);
  Vec3 rim = Vec3::Zero();
  for (int k : {0, 1}) rim += spreading_force(inside, k, lowered - T) + spreading_force(outside, k, -T);
  EXPECT_NEAR(rim[0], 0.0, 1e-16);
  EXPECT_NEAR(rim[2], T * sine * 2.0 * 0.5, 1e-15);    // borne by the stress across; half the sides
}
