// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact law foundation against quadrature of its stress and the closed forms of spheres and
// flats.

#include "law/foundation.h"
#include "law/contact.h"
#include "law/mesh.h"
#include "helpers.h"

#include <limits>

using namespace dcm;
using namespace dcm_test;

namespace {

constexpr double R = 2.5;

ContactMaterial material(double k = 12.0, double W = 0.1, double h0 = 0.35)
{
  ContactMaterial m;
  m.E = 3.0;
  m.k = k;
  m.W = W;
  m.h0 = h0;
  return m;
}

// as the header states it, from the gap alone
double stress(const ContactMaterial &m, double delta, double r)
{
  const double overlap = delta - 0.5 * r * r / R;
  if (overlap >= 0.0) return m.k * overlap;
  return -overlap < m.h0 ? -m.sigma0() : 0.0;
}

// int_r0^r1 f(r) r^power dr of a polynomial of degree up to 5 in all
template <class F> double quadrature(const F &f, double r0, double r1, int power)
{
  double sum = 0.0;
  for (double g : {-std::sqrt(0.6), 0.0, std::sqrt(0.6)}) {
    const double r = 0.5 * (r0 + r1) + 0.5 * g * (r1 - r0);
    sum += (g == 0.0 ? 8.0 : 5.0) / 18.0 * (r1 - r0) * f(r) * std::pow(r, power);
  }
  return sum;
}

}    // namespace

TEST(Foundation, LayersInSeries)
{
  // two layers take the same pressure and share the overlap
  const double l[2] = {0.25, 0.1}, E[2] = {5.0, 2.0}, nu[2] = {0.4, 0.3}, p = 0.7;
  double overlap = 0.0;
  for (int i : {0, 1}) overlap += p * (1.0 - nu[i] * nu[i]) / E[i] * l[i];
  EXPECT_NEAR(foundation_stiffness(l[0], E[0], nu[0], l[1], E[1], nu[1]), p / overlap, 1e-14);
}

TEST(Foundation, StressAndPrimitives)
{
  const ContactMaterial m = material();
  FoundationState s;
  for (double delta : {-0.3, -1e-6, 0.0, 1e-6, 0.05, 1.0}) {
    ASSERT_TRUE(s.set(m, R, delta));
    EXPECT_NEAR(s.c * s.c, 2.0 * R * (delta + m.h0), 1e-13);
    EXPECT_NEAR(s.c, FoundationState::reach(m, R, delta), 1e-13);
    const auto p = [&](double r) {
      return stress(m, delta, r);
    };
    for (double x : {1e-9, 0.1, 0.5, 0.9, 0.999999}) {
      EXPECT_NEAR(s.p(x * s.c), p(x * s.c), 1e-12) << delta << " " << x;
      const double r = x * s.c, in = std::min(r, s.a);
      EXPECT_NEAR(s.Q0(r),
                  quadrature(p, 0.0, in * (1 - 1e-15), 1) - 0.5 * m.sigma0() * (r * r - in * in),
                  1e-12);
      EXPECT_NEAR(s.Q1(r),
                  quadrature(p, 0.0, in * (1 - 1e-15), 2) -
                      m.sigma0() * (r * r * r - in * in * in) / 3,
                  1e-12);
    }
    EXPECT_EQ(s.p(1.0001 * s.c), 0.0);
  }
}

// the closed forms over an edge against quadrature of the primitives along it
TEST(Foundation, EdgeIntegrals)
{
  FoundationState s;
  ASSERT_TRUE(s.set(material(12.0, 0.0), R, 0.3));
  for (double h : {0.0, -1e-5, 0.4, -0.9}) {
    const double b = std::sqrt(s.a * s.a - h * h);
    for (double x0 : {-1.0, -0.3, 0.0})
      for (double x1 : {0.1, 1.0}) {
        const double t0 = x0 * b, t1 = x1 * b;
        auto over = [&](auto f) {
          return quadrature(
              [&](double t) {
                double q0, q1;
                s.core(h * h + t * t, q0, q1);
                return f(t, q0, q1);
              },
              t0, t1, 0);
        };
        double f, normal, along, slope;
        s.core_edge<true>(h, t0, t1, f, normal, along, &slope);
        EXPECT_NEAR(f, over([&](double, double q0, double) {
                      return q0 * h;
                    }),
                    1e-13);
        EXPECT_NEAR(normal, over([&](double, double, double q1) {
                      return q1 * h * h;
                    }),
                    1e-13);
        EXPECT_NEAR(along, over([&](double t, double, double q1) {
                      return q1 * h * t;
                    }),
                    1e-13);
        EXPECT_NEAR(slope, 0.5 * h * (t1 - t0), 1e-15);
      }
  }
}

TEST(Foundation, ForceOfSpheres)
{
  for (double k : {1.0, 12.0, 1000.0})
    for (double h0 : {0.02, 0.35}) {
      const ContactMaterial m = material(k, 0.1, h0);
      FoundationState s;
      EXPECT_FALSE(s.set(m, R, -h0));
      double lowest = 0.0;
      for (int i = 1; i <= 4000; i++) {
        const double delta = h0 * (-1.0 + i / 2000.0);
        ASSERT_TRUE(s.set(m, R, delta));
        const double F = delta >= 0.0 ? PI * k * R * delta * delta - 2.0 * PI * m.W * R
                                      : -2.0 * PI * R * m.sigma0() * (h0 + delta);
        ASSERT_NEAR(s.force(), F, 1e-11 * (1.0 + k)) << delta;
        lowest = std::min(lowest, s.force());
      }
      // the pull-off force, whatever the stiffness: at first touch
      EXPECT_NEAR(lowest, -2.0 * PI * m.W * R, 1e-12);
      ASSERT_TRUE(s.set(m, R, 0.0));
      EXPECT_NEAR(s.force(), lowest, 1e-12);
    }
}

TEST(Foundation, Flats)
{
  const ContactMaterial m = material();
  FoundationState s;
  // pressure k delta whatever the radius
  for (double radius : {1e2, 1e6}) {
    ASSERT_TRUE(s.set(m, radius, 0.05));
    EXPECT_NEAR(s.p(0.0), m.k * 0.05, 1e-12);
  }
  // work of separation, from touch to beyond the range
  const int n = 3000;
  double work = 0.0;
  for (int i = 0; i < n; i++)
    if (s.set(m, 1e9, -1.5 * m.h0 * (i + 0.5) / n)) work -= s.p(0.0) * 1.5 * m.h0 / n;
  EXPECT_NEAR(work, m.W, 1e-3 * m.W);
}

TEST(Foundation, DerivesFromAPotential)
{
  // U = int u(gap) dA with u' = stress: its derivative by delta is the force
  const ContactMaterial m = material();
  auto energy = [&](double delta) {
    const int n = 200000;
    const double rmax = std::sqrt(2.0 * R * (delta + m.h0));
    double U = 0.0;
    for (int i = 0; i < n; i++) {
      const double r = rmax * (i + 0.5) / n, overlap = delta - 0.5 * r * r / R;
      const double u = overlap > 0.0 ? 0.5 * m.k * overlap * overlap - m.W
                                     : -m.sigma0() * (m.h0 + overlap);
      U += u * 2.0 * PI * r * rmax / n;
    }
    return U;
  };
  for (double delta : {-0.2, -0.01, 0.02, 0.4}) {
    FoundationState s;
    ASSERT_TRUE(s.set(m, R, delta));
    const double e = 1e-3;
    const double third = PI * m.k * R * e * e / 3.0;    // F''/6 e^2 of the difference
    EXPECT_NEAR(s.force(), (energy(delta + e) - energy(delta - e)) / (2.0 * e), third + 1e-6);
  }
}

TEST(Foundation, RejectsNonsense)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ContactMaterial m = material();
  FoundationState s;
  EXPECT_FALSE(s.set(m, -1.0, 0.1));
  EXPECT_FALSE(s.set(m, 0.0, 0.1));
  EXPECT_FALSE(s.set(m, nan, 0.1));
  EXPECT_FALSE(s.set(m, R, nan));
  EXPECT_FALSE(s.set(material(0.0), R, 0.1));
  EXPECT_FALSE(s.set(material(nan), R, 0.1));
  EXPECT_FALSE(s.set(material(12.0, 0.0), R, -1e-6));    // no adhesion: no contact across a gap
  EXPECT_FALSE(s.set(material(12.0, 0.0), R, 0.0));
}

// Surfaces of triangles give the force of the spheres they stand for: of two deformable cells, and
// of one and a center-based cell, which is the same contact on both sides of a border between them
TEST(Foundation, CellAndSphereAlike)
{
  const Mesh ball = icosphere(2);
  Random random(5, 0, 0);
  const ContactMaterial m = material(12.0, 0.1, 0.05);
  for (double delta : {-0.03, 0.0, 0.02, 0.08}) {
    const Mat3 turn = random_rotation(random);
    const Vec3 u = random_rotation(random).col(0), shift = (2.0 - delta) * u;
    std::vector<FaceGeometry> F, G;
    for (const auto &t : ball.faces) {
      const Vec3 &a = ball.nodes[t[0]], &b = ball.nodes[t[1]], &c = ball.nodes[t[2]];
      F.push_back(make_face(a, b, c, 1.0));
      G.push_back(make_face(turn * a + shift, turn * b + shift, turn * c + shift, 1.0));
    }
    Vec3 faces = Vec3::Zero(), mixed = Vec3::Zero();
    ContactResult r;
    for (const auto &f : F) {
      if (face_sphere<FoundationState>(f, shift, 1.0, m, 1, r)) mixed += r.force * r.u;
      for (const auto &g : G)
        if (face_face<FoundationState>(f, g, m, 1, r)) faces += r.force * r.u;
    }
    FoundationState s;
    ASSERT_TRUE(s.set(m, 0.5, delta));
    EXPECT_LT((faces - s.force() * u).norm(), 1e-10) << delta;
    EXPECT_LT((mixed - s.force() * u).norm(), 1e-10) << delta;
  }
}
