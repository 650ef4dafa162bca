// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The contact law of examples/extend: force of two spheres in closed form, primitives against
// numerical integration, triangulated spheres through the kernel that pair_style dcm/contact calls.

#include "../../examples/extend/winkler.h"
#include "helpers.h"
#include "law/contact.h"
#include "law/mesh.h"

using namespace dcm;
using namespace dcm_test;

namespace {

constexpr double E = 3.0, H0 = 0.04;

ContactMaterial material(double W)
{
  ContactMaterial m;
  m.E = E;
  m.W = W;
  m.h0 = H0;
  return m;
}

// repulsion of Hertz at the same overlap, adhesion of two rigid spheres

double force_of_spheres(double R, double delta, double W)
{
  if (delta < 0.0) return -2.0 * PI * W * R * (delta + H0) / H0;
  return 4.0 / 3.0 * E * std::sqrt(R) * std::pow(delta, 1.5) - 2.0 * PI * W * R;
}

}    // namespace

TEST(Winkler, ForceOfTwoSpheres)
{
  for (const double W : {0.0, 0.02})
    for (const double R : {0.5, 3.0})
      for (const double delta : {-0.03, 0.0, 1e-6, 0.01, 0.3}) {
        WinklerState s;
        const bool touching = delta > (W > 0.0 ? -H0 : 0.0);
        EXPECT_EQ(s.set(material(W), R, delta), touching);
        const double expected = touching ? force_of_spheres(R, delta, W) : 0.0;
        EXPECT_NEAR(s.force(), expected, 1e-14 + 1e-13 * std::fabs(expected));
        EXPECT_LE(s.c, WinklerState::reach(material(W), R, delta) * (1.0 + 1e-15));
      }
}

TEST(Winkler, EndsWhereAdhesionDoes)
{
  WinklerState s;
  EXPECT_FALSE(s.set(material(0.02), 1.0, -H0));
  EXPECT_FALSE(s.set(material(0.0), 1.0, -1e-12));
  EXPECT_EQ(s.force(), 0.0);
}

// Q0 = int p s ds and Q1 = int p s^2 ds by the midpoint rule on either side of r = a

TEST(Winkler, PrimitivesOfTheStress)
{
  WinklerState s;
  ASSERT_TRUE(s.set(material(0.02), 0.7, 0.05));
  ASSERT_GT(s.c, s.a);
  const int n = 2000;
  double Q0 = 0.0, Q1 = 0.0;
  for (const auto &[from, to] : {std::pair(0.0, s.a), std::pair(s.a, s.c)})
    for (int i = 0; i < n; i++) {
      const double h = (to - from) / n, r = from + (i + 0.5) * h;
      Q0 += h * s.p(r) * r;
      Q1 += h * s.p(r) * r * r;
      const double size = s.middle * s.a * s.a;
      EXPECT_NEAR(s.Q0(r + 0.5 * h), Q0, 1e-6 * size);
      EXPECT_NEAR(s.Q1(r + 0.5 * h), Q1, 1e-6 * size * s.a);
    }
  EXPECT_NEAR(s.p(s.a), 0.0, 1e-14);    // the core ends without a step
}

// the loops of pair_style dcm/contact, on two icospheres turned at random: two Gauss points
// integrate the law exactly, so that any number from two on gives the closed form

TEST(Winkler, TriangulatedSpheres)
{
  Random random(4711, 1, 0, RandomPurpose{});
  const Mesh mesh = icosphere(2);
  const auto ball = [&](const Vec3 &shift) {
    const Mat3 turn = random_rotation(random);
    std::vector<FaceGeometry> faces;
    for (const auto &t : mesh.faces)
      faces.push_back(make_face(turn * mesh.nodes[t[0]] + shift, turn * mesh.nodes[t[1]] + shift,
                                turn * mesh.nodes[t[2]] + shift, 1.0));
    return faces;
  };
  for (const double W : {0.0, 0.02})
    for (const double delta : {0.03, 0.2})
      for (int points = 2; points <= 4; points++) {
        const Vec3 along = random_rotation(random).col(0);
        const auto F = ball(Vec3::Zero()), G = ball((2.0 - delta) * along);
        Vec3 force = Vec3::Zero();
        ContactResult r;
        for (const auto &f : F)
          for (const auto &g : G)
            if (face_face<WinklerState>(f, g, material(W), points, r)) force += r.force * r.u;
        const double expected = force_of_spheres(0.5, delta, W);
        EXPECT_LT((force - expected * along).norm(), 1e-10 * E) << delta << " " << points;
      }
}
