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

// of sigma0 h0 - sigma0^2/2k = W, by bisection between W/h0 and k h0
double strength(const ContactMaterial &m)
{
  double low = m.W / m.h0, high = m.k * m.h0;
  for (int i = 0; i < 200; i++) {
    const double mid = 0.5 * (low + high);
    (mid * m.h0 - 0.5 * mid * mid / m.k < m.W ? low : high) = mid;
  }
  return low;
}

// as the header states it, from the gap alone
double stress(const ContactMaterial &m, double sigma0, double delta, double r)
{
  const double overlap = delta - 0.5 * r * r / R;
  return -overlap < m.h0 ? std::max(m.k * overlap, -sigma0) : 0.0;
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
  const double sigma0 = strength(m);
  FoundationState s;
  for (double delta : {-0.3, -1e-6, 0.0, 1e-6, 0.05, 1.0}) {
    ASSERT_TRUE(s.set(m, R, delta));
    EXPECT_NEAR(s.c * s.c, 2.0 * R * (delta + m.h0), 1e-13);
    EXPECT_NEAR(s.c, FoundationState::reach(m, R, delta), 1e-13);
    const auto p = [&](double r) {
      return stress(m, sigma0, delta, r);
    };
    for (double x : {1e-9, 0.1, 0.5, 0.9, 0.999999}) {
      EXPECT_NEAR(s.p(x * s.c), p(x * s.c), 1e-12) << delta << " " << x;
      const double r = x * s.c, in = std::min(r, s.a);
      EXPECT_NEAR(s.Q0(r),
                  quadrature(p, 0.0, in * (1 - 1e-15), 1) - 0.5 * sigma0 * (r * r - in * in),
                  1e-12);
      EXPECT_NEAR(s.Q1(r),
                  quadrature(p, 0.0, in * (1 - 1e-15), 2) - sigma0 * (r * r * r - in * in * in) / 3,
                  1e-12);
    }
    EXPECT_EQ(s.p(1.0001 * s.c), 0.0);
  }
}

// the closed forms over an edge against quadrature of the primitives along it
TEST(Foundation, EdgeIntegrals)
{
  FoundationState s;
  for (double W : {0.0, 0.1})
    for (double h : {0.0, -1e-5, 0.4, -0.9}) {
      ASSERT_TRUE(s.set(material(12.0, W), R, 0.3));
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
      const ContactMaterial m = material(k, 0.1, std::max(h0, 1.0001 * foundation_range(k, 0.1)));
      const double sigma0 = strength(m);
      FoundationState s;
      EXPECT_FALSE(s.set(m, R, -m.h0));
      double lowest = 0.0;
      for (int i = 1; i <= 4000; i++) {
        const double delta = m.h0 * (-1.0 + i / 2000.0);
        ASSERT_TRUE(s.set(m, R, delta));
        const double F = delta >= -sigma0 / k ? PI * k * R * delta * delta - 2.0 * PI * m.W * R
                                              : -2.0 * PI * R * sigma0 * (m.h0 + delta);
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
  // continuous at touch
  double side[2];
  for (int k : {0, 1}) {
    ASSERT_TRUE(s.set(m, 1e6, k ? 1e-9 : -1e-9));
    side[k] = s.p(0.0);
  }
  EXPECT_NEAR(side[1] - side[0], 2e-9 * m.k, 1e-12);
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
  const double sigma0 = strength(m);
  auto energy = [&](double delta) {
    const int n = 200000;
    const double rmax = std::sqrt(2.0 * R * (delta + m.h0));
    double U = 0.0;
    for (int i = 0; i < n; i++) {
      const double r = rmax * (i + 0.5) / n, overlap = delta - 0.5 * r * r / R;
      const double u = overlap > -sigma0 / m.k ? 0.5 * m.k * overlap * overlap - m.W
                                               : -sigma0 * (m.h0 + overlap);
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

// a layer stretches before it lets go: the range at which the traction has no plateau
TEST(Foundation, ShortestRange)
{
  ContactMaterial m = material();
  m.h0 = foundation_range(m.k, m.W);
  EXPECT_NEAR(0.5 * m.k * m.h0 * m.h0, m.W, 1e-14);
  EXPECT_NEAR(foundation_strength(m), m.k * m.h0, 1e-7);
  EXPECT_EQ(foundation_range(m.k, 0.0), 0.0);
  // below it the layer would bear more than it takes to stretch it that far
  m.h0 *= 0.5;
  EXPECT_NEAR(foundation_strength(m), m.k * m.h0, 1e-14);
  // of a soft long-range contact that of W/h0
  m.h0 = 100.0;
  EXPECT_NEAR(foundation_strength(m), m.W / m.h0, 1e-6 * m.W);
}

// Surfaces of triangles give the force of the spheres they stand for, by their exact gap: of two
// deformable cells, and of one and a center-based cell, which is the same contact on both sides of
// a border between them. The gap is linear in r^2 over a face: error of second order in its size
TEST(Foundation, CellAndSphereAlike)
{
  const ContactMaterial m = material(12.0, 0.1, 0.15);
  const double sigma0 = strength(m);
  const int n = 200000;
  double error[2][2] = {};
  for (int fine : {0, 1}) {
    const Mesh ball = icosphere(2 + fine);
    Random random(5, 0, 0);
    for (double delta : {-0.03, 0.0, 0.02, 0.2}) {
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
      double exact = 0.0;
      for (int i = 0; i < n; i++) {
        const double s = 0.5 * (i + 0.5) / n, overlap = 2.0 * std::sqrt(1.0 - s) - 2.0 + delta;
        exact += stress(m, sigma0, overlap, 0.0) * PI * 0.5 / n;
      }
      error[0][fine] = std::max(error[0][fine], (faces - exact * u).norm());
      error[1][fine] = std::max(error[1][fine], (mixed - exact * u).norm());
    }
  }
  for (const auto &e : error) {
    EXPECT_LT(e[0], 0.02 * 2.0 * PI * m.W * 0.5);
    EXPECT_LT(e[1], 0.4 * e[0]);
  }
}

// faces on flat spheres that are tilted against each other, or stand beside the equator of a
// center-based cell: their spheres overlap by micrometers where they do not, and Hertz' parabola
// has them overlap as well
TEST(Foundation, NoContactAcrossAGap)
{
  const ContactMaterial m = material(12.0, 0.1, 0.35);
  const double flat = 58.0, tilt = 48.0 * PI / 180.0;
  const auto face = [&](const Vec3 &at, const Vec3 &normal) {
    const Vec3 e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
    return make_face(at + 0.6 * e1, at - 0.3 * e1 + 0.5 * e2, at - 0.3 * e1 - 0.5 * e2, flat);
  };
  ContactResult r;
  for (double gap : {1.3, 1.8, 3.0}) {
    const FaceGeometry f = face(Vec3(0, 0, 0), Vec3(std::sin(tilt), std::cos(tilt), 0));
    const FaceGeometry g = face(Vec3(0, gap, 0), Vec3(std::sin(tilt), -std::cos(tilt), 0));
    EXPECT_FALSE(face_face<FoundationState>(f, g, m, 1, r)) << gap;
    // Hertz' parabola sees an overlap
    const Vec3 axis = g.center - f.center, off = f.mid - f.center;
    const double along = off.dot(axis.normalized()), r2 = off.squaredNorm() - along * along;
    if (gap < 2.0) {
      EXPECT_GT(2.0 * flat - axis.norm() - r2 / flat, 1.0);
    }
  }
  const FaceGeometry f = face(Vec3(0, 0, 0), Vec3(0, 0, 1));
  const Vec3 sphere(6.7, 0.0, 0.7);
  EXPECT_TRUE(!face_sphere<FoundationState>(f, sphere, 6.0, m, 1, r) || Facing()(r.tilt) == 0.0);
  ASSERT_TRUE(face_sphere<FoundationState>(f, Vec3(1.0, 0.0, 5.8), 6.0, m, 1, r));
  EXPECT_EQ(Facing()(r.tilt), 1.0);
}
