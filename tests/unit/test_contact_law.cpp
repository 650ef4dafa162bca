// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The contact laws against the literal equations (S1 "Contact model"), against quadrature of
// p(r), and against known limits: Hertz, JKR, DMT, Derjaguin.

#include "law/contact_law.h"
#include "law/dmt.h"
#include "law/maugis.h"

#include <gtest/gtest.h>

#include <limits>

using namespace dcm;

namespace {

// units in which A = a, D = delta, F/(pi W R) = F: K = 4E/3 = 1, R = 1, pi W = 1
ContactMaterial unit_material(double lambda)
{
  ContactMaterial m;
  m.E = 0.75;
  m.W = 1.0 / PI;
  m.h0 = 2.0 * m.W / lambda;
  return m;
}

const double LAMBDAS[] = {0.01, 0.03, 0.1, 0.3, 0.5, 0.655, 0.9, 1.0, 2.0, 5.0, 17.0, 20.0, 100.0};

// S1's stress, written as printed
double literal_stress(double r, double a, double c, double E, double R, double sigma0)
{
  if (r > c) return 0.0;
  if (r > a) return -sigma0;
  return 2.0 * E / (PI * R) * std::sqrt(a * a - r * r) -
         sigma0 / PI * std::acos((2.0 * a * a - c * c - r * r) / (c * c - r * r));
}

// int_r0^r1 p(r) r^power dr, with r = r0 + (r1-r0) sin t against the root at r1
template <class F> double quadrature(const F &p, double r0, double r1, int power)
{
  const int n = 2000;
  double sum = 0.0;
  for (int i = 0; i < n; i++)
    for (double g : {-std::sqrt(0.6), 0.0, std::sqrt(0.6)}) {
      const double t = 0.5 * PI * (i + 0.5 + 0.5 * g) / n;
      const double r = r0 + (r1 - r0) * std::sin(t);
      sum += (g == 0.0 ? 8.0 : 5.0) / 18.0 * (r1 - r0) * std::cos(t) * p(r) * std::pow(r, power);
    }
  return sum * 0.5 * PI / n;
}

template <class State> void check_primitives(const State &s, double E, double R)
{
  const double scale = std::max(s.hertz * s.a, s.sigma0);
  const auto p = [&](double r) {
    return s.p(r);
  };
  for (double x : {0.001, 0.02, 0.0316, 0.0317, 0.0632, 0.0633, 0.2, 0.6, 0.95, 1.0}) {
    const double r = x * s.a;
    if (r == 0.0) continue;
    EXPECT_NEAR(s.Q0(r), quadrature(p, 0.0, r, 1), 1e-10 * scale * r * r) << x;
    EXPECT_NEAR(s.Q1(r), quadrature(p, 0.0, r, 2), 1e-10 * scale * r * r * r) << x;
  }
  const double c2 = s.c * s.c;
  for (double x : {0.3, 1.0}) {
    const double r = s.a + x * (s.c - s.a);
    const double q0 = quadrature(p, 0.0, s.a, 1) + quadrature(p, s.a, r, 1);
    const double q1 = quadrature(p, 0.0, s.a, 2) + quadrature(p, s.a, r, 2);
    EXPECT_NEAR(s.Q0(r), q0, 1e-10 * scale * c2);
    EXPECT_NEAR(s.Q1(r), q1, 1e-10 * scale * c2 * s.c);
  }
  EXPECT_EQ(s.Q0(2.0 * s.c), s.Q0c);
  EXPECT_NEAR(s.force(), 2.0 * PI * s.Q0(s.c), 1e-12 * scale * c2);
  EXPECT_EQ(s.p(1.0001 * s.c), 0.0);
  (void) E;
  (void) R;
}

}    // namespace

TEST(ContactLaw, ArcTangent)
{
  for (double y : {0.0, 1e-300, 1e-8, 0.1, 0.4139, 0.4141, 0.99, 1.0, 1.01, 2.41, 2.42, 1e8, 1e300})
    for (double x : {0.0, 1e-9, 0.5, 1.0, 3.0}) {
      if (x == 0.0 && y == 0.0) continue;
      if (y == 0.0) {
        EXPECT_EQ(detail::atan_quadrant(y, x), 0.0);
        continue;
      }
      EXPECT_NEAR(detail::atan_quadrant(y, x), std::atan2(y, x), 5e-16) << y << " " << x;
      EXPECT_NEAR(detail::angle(-y, -x), std::atan2(-y, -x), 1e-15);
      EXPECT_NEAR(detail::angle(y, -x), std::atan2(y, -x), 1e-15);
    }
  for (double y : {1e-6, 1e-3, 0.1, 0.6}) {
    const long double exact = y - std::atan(static_cast<long double>(y));
    EXPECT_NEAR(detail::atan_deficit(y) / static_cast<double>(exact), 1.0, y < 1e-2 ? 1e-7 : 1e-13);
  }
}

TEST(Maugis, SolvesTheLiteralEquations)
{
  for (double lambda : LAMBDAS) {
    const ContactMaterial m = unit_material(lambda);
    MaugisState s;
    for (double D : {-0.9 * m.h0, -0.3, -1e-3, 0.0, 1e-6, 0.1, 1.0, 30.0, 1000.0}) {
      if (!(D > -m.h0)) continue;
      ASSERT_TRUE(s.set(m, 1.0, D)) << lambda << " " << D;
      ASSERT_GT(s.c, 0.0);
      ASSERT_NEAR(s.lambda, lambda, 1e-14 * lambda);
      if (s.a == 0.0) {
        // contact without touch: gap at the rim is h0, gap on the axis is open
        const double rim = -D + 0.5 * s.c * s.c - 4.0 * s.sigma0 * s.c / (PI * m.E);
        EXPECT_NEAR(rim, m.h0, 1e-12 * m.h0);
        EXPECT_GE(-D - 2.0 * s.sigma0 * s.c / m.E, -1e-12 * m.h0);
        EXPECT_NEAR(s.force(), -PI * s.c * s.c * s.sigma0, 1e-12 * s.c * s.c * s.sigma0);
        continue;
      }
      const long double A = s.a, M = s.c / A, L = lambda;
      const long double y = sqrtl(M * M - 1.0L), t = atanl(y);
      const long double one = L * A * A / 2.0L * (y + (M * M - 2.0L) * t) +
                              4.0L * L * L * A / 3.0L * (y * t - M + 1.0L);
      const long double F = A * A * A - L * A * A * (y + M * M * t);
      const long double delta = A * A - 4.0L / 3.0L * A * L * y;
      // M = c/a loses digits of y where the ring is thin
      const double tol = 1e-13 + 1e-15 / static_cast<double>(y * y);
      EXPECT_NEAR(static_cast<double>(one), 1.0, 10.0 * tol) << lambda << " " << D;
      EXPECT_NEAR(static_cast<double>(delta), D, 10.0 * tol * std::max(1.0, D))
          << lambda << " " << D;
      EXPECT_NEAR(s.force(), static_cast<double>(F), 10.0 * tol * std::max<double>(1.0, A * A * A))
          << lambda << " " << D;
    }
  }
}

TEST(Maugis, PullOffTable)
{
  const double table[][2] = {{0.1, -1.9506}, {0.5, -1.7182}, {1.0, -1.6007},
                             {2.0, -1.5346}, {5.0, -1.5063}, {20.0, -1.5004}};
  for (const auto &row : table) {
    // another scale than the unit one, so that R and E enter
    ContactMaterial m;
    m.E = 3.0;
    m.W = 0.1;
    const double R = 2.5, K = 4.0 / 3.0 * m.E;
    m.h0 = 2.0 * m.W / row[0] * std::cbrt(R / (PI * m.W * K * K));
    const double unit = std::cbrt(PI * PI * m.W * m.W * R / (K * K));
    double lowest = 0.0;
    MaugisState s;
    for (int i = 0; i < 4000; i++)
      if (s.set(m, R, unit * (-1.2 + 0.0005 * i), true))
        lowest = std::min(lowest, s.force() / (PI * m.W * R));
    EXPECT_NEAR(lowest, row[1], 1e-3) << row[0];
  }
}

TEST(Maugis, NeverFailsAboveTheCutoffAndIsContinuous)
{
  for (double lambda = 0.008; lambda < 130.0; lambda *= 1.17) {
    const ContactMaterial m = unit_material(lambda);
    MaugisState s, t;
    EXPECT_FALSE(s.set(m, 1.0, -m.h0 * 1.0000001));
    EXPECT_TRUE(s.set(m, 1.0, -m.h0 * 0.9999999));
    // the largest overlap: half a radius of cells whose size is 1e4 adhesive lengths
    for (double x = 1e-9; x < 1e4; x *= 1.03) {
      const double D = -m.h0 + x;
      ASSERT_TRUE(s.set(m, 1.0, D)) << lambda << " " << D;
      ASSERT_LT(s.iterations, 79);
      ASSERT_TRUE(std::isfinite(s.force()));
      ASSERT_LE(s.a, s.c);
      ASSERT_LE(s.c, MaugisState::reach(m, 1.0, D) * (1.0 + 1e-12)) << lambda << " " << D;
      const double eps = 1e-7 * (std::fabs(D) + 1e-3);
      ASSERT_TRUE(t.set(m, 1.0, D + eps));
      ASSERT_GT(t.c, 0.0);
      // |dF/dD| is of the order of the stiffness of the contact circle
      ASSERT_NEAR(t.force(), s.force(), 2e3 * eps * (1.0 + s.c)) << lambda << " " << D;
    }
    // neck: one connected branch below the cutoff, then nothing
    bool gone = false;
    for (double D = 0.0; D > -m.h0 - 2.0; D -= 0.003) {
      const bool contact = s.set(m, 1.0, D, true);
      ASSERT_FALSE(gone && contact) << lambda << " " << D;
      gone = !contact;
      if (contact) {
        ASSERT_TRUE(std::isfinite(s.force()));
        ASSERT_LE(s.c, MaugisState::reach(m, 1.0, D, true) * (1.0 + 1e-12)) << lambda << " " << D;
      }
    }
    EXPECT_TRUE(gone);
  }
}

TEST(Maugis, JkrLimitAndNeck)
{
  // JKR: F = A^3 - sqrt(6 A^3), D = A^2 - (2/3) sqrt(6 A)
  const ContactMaterial m = unit_material(100.0);
  MaugisState s;
  for (double A : {1.2, 2.0, 4.0}) {
    const double D = A * A - 2.0 / 3.0 * std::sqrt(6.0 * A);
    ASSERT_TRUE(s.set(m, 1.0, D, true));
    EXPECT_NEAR(s.a, A, 1e-3);
    EXPECT_NEAR(s.force(), A * A * A - std::sqrt(6.0 * A * A * A), 1e-2);
  }
  EXPECT_TRUE(s.set(m, 1.0, -0.905, true));
  EXPECT_FALSE(s.set(m, 1.0, -0.915, true));
  EXPECT_FALSE(s.set(m, 1.0, -0.5));
}

TEST(Maugis, StressAndPrimitives)
{
  for (double lambda : LAMBDAS) {
    const ContactMaterial m = unit_material(lambda);
    MaugisState s;
    for (double D : {-0.5 * m.h0, -0.2, 0.0, 1.0, 30.0}) {
      if (!s.set(m, 1.0, D)) continue;
      for (double x : {0.0, 0.3, 0.9, 0.999}) {
        const double r = x * s.a;
        EXPECT_NEAR(s.p(r), literal_stress(r, s.a, s.c, m.E, 1.0, s.sigma0),
                    1e-6 * (s.sigma0 + s.hertz * s.a));
      }
      check_primitives(s, m.E, 1.0);
    }
  }
}

template <class State> class BothLaws : public testing::Test {
};
using Laws = testing::Types<DmtState, MaugisState>;
TYPED_TEST_SUITE(BothLaws, Laws);

TYPED_TEST(BothLaws, HertzWithoutAdhesion)
{
  ContactMaterial m;
  m.E = 2.0;
  TypeParam s;
  for (double h0 : {0.0, 0.1}) {
    m.h0 = h0;
    EXPECT_FALSE(s.set(m, 3.0, -1e-3));
    EXPECT_FALSE(s.set(m, 3.0, 0.0));
    EXPECT_FALSE(s.set(m, 3.0, -1e-3, true));
    for (double delta : {1e-6, 0.1, 1.5}) {
      ASSERT_TRUE(s.set(m, 3.0, delta));
      EXPECT_NEAR(s.a * s.a, 3.0 * delta, 1e-14);
      EXPECT_EQ(s.a, s.c);
      EXPECT_NEAR(s.force() / (4.0 / 3.0 * m.E * std::sqrt(3.0 * delta) * delta), 1.0, 1e-14);
      check_primitives(s, m.E, 3.0);
    }
  }
}

TYPED_TEST(BothLaws, RejectsNonsense)
{
  const ContactMaterial m = unit_material(1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TypeParam s;
  EXPECT_FALSE(s.set(m, -1.0, 0.1));
  EXPECT_FALSE(s.set(m, 0.0, 0.1));
  EXPECT_FALSE(s.set(m, nan, 0.1));
  EXPECT_FALSE(s.set(m, 1.0, nan));
}

TEST(Dmt, CohesiveRadiusFromTheGap)
{
  ContactMaterial m;
  m.E = 3.0;
  m.W = 0.1;
  const double R = 2.5;
  for (double h0 : {0.001, 0.02, 0.4}) {
    m.h0 = h0;
    DmtState s;
    for (double delta : {1e-7, 1e-5, 1e-3, 0.01, 0.05, 0.3, 1.2}) {
      ASSERT_TRUE(s.set(m, R, delta));
      const long double a = s.a, r = s.c;
      const long double gap =
          (a * sqrtl(r * r - a * a) - (2.0L * a * a - r * r) * acosl(a / r)) / (PI * R);
      EXPECT_NEAR(static_cast<double>(gap) / h0, 1.0, 1e-9 + 1e-13 * delta / h0)
          << h0 << " " << delta;
      EXPECT_LE(s.c, DmtState::reach(m, R, delta) * (1.0 + 1e-14));
      check_primitives(s, m.E, R);
    }
    for (double delta : {-0.99 * h0, -0.3 * h0, 0.0}) {
      ASSERT_TRUE(s.set(m, R, delta));
      EXPECT_NEAR(s.c * s.c, 2.0 * R * (h0 + delta), 1e-13);
      check_primitives(s, m.E, R);
    }
  }
}

TEST(Dmt, PullOffContinuityAndCutoff)
{
  ContactMaterial m;
  m.E = 3.0;
  m.W = 0.1;
  const double R = 2.5;
  for (double h0 : {0.001, 0.02, 0.4}) {
    m.h0 = h0;
    DmtState s;
    double lowest = 0.0, last = 0.0;
    EXPECT_FALSE(s.set(m, R, -h0));
    for (int i = 1; i < 40000; i++) {
      ASSERT_TRUE(s.set(m, R, -h0 + 1e-4 * h0 * i));
      const double F = s.force() / (PI * m.W * R);
      EXPECT_NEAR(F, last, 1e-3 * (1.0 + std::fabs(F) + m.E * std::sqrt(R * h0) * h0)) << i;
      last = F;
      lowest = std::min(lowest, F);
    }
    // exactly 2 pi W R at first touch; where the range is short against the elastic deformation
    // (lambda > 0.1) the tension still grows a little after that
    EXPECT_LE(lowest, -2.0 + 1e-3);
    ASSERT_TRUE(s.set(m, R, 0.0));
    EXPECT_NEAR(s.force() / (PI * m.W * R), -2.0, 1e-12);
    // across delta = 0, where the state changes form
    DmtState below, above;
    below.set(m, R, -1e-13 * h0);
    above.set(m, R, 3e-9 * h0);
    EXPECT_NEAR(below.force(), above.force(), 1e-7 * std::fabs(below.force()));
  }
}

// closed edge integrals against quadrature of Q0 and Q1 along the edge, also through the axis and
// with ends on the circle r = a
TEST(Dmt, EdgeIntegralsInTheCore)
{
  ContactMaterial m;
  m.E = 3.0;
  DmtState s;
  ASSERT_TRUE(s.set(m, 2.5, 0.3));
  const double a = s.a, F = s.force();
  for (double h : {0.0, 1e-14 * a, -1e-5 * a, 0.1 * a, -0.5 * a, 0.9 * a, 0.9999 * a}) {
    const double b = std::sqrt(a * a - h * h);
    for (double x0 : {-1.0, -0.7, -1e-3, 0.0, 0.3})
      for (double x1 : {-0.6, 1e-9, 0.4, 0.95, 1.0}) {
        if (x1 <= x0) continue;
        const double t0 = x0 * b, t1 = x1 * b;
        double f = 0.0, normal = 0.0, along = 0.0;
        const int n = 20000;
        for (int i = 0; i < n; i++) {
          // t = b sin(v): no root at the ends
          const double v0 = std::asin(x0), v1 = std::asin(x1);
          const double v = v0 + (v1 - v0) * (i + 0.5) / n;
          const double t = b * std::sin(v), dt = b * std::cos(v) * (v1 - v0) / n;
          double q0, q1;
          s.core(std::min(a * a, h * h + t * t), q0, q1);
          f += q0 * h * dt;
          normal += q1 * h * h * dt;
          along += q1 * h * t * dt;
        }
        double g, gn, ga;
        s.core_edge(h, t0, t1, g, gn, ga);
        ASSERT_NEAR(g, f, 1e-8 * F) << h << " " << x0 << " " << x1;
        ASSERT_NEAR(gn, normal, 1e-8 * F * a) << h << " " << x0 << " " << x1;
        ASSERT_NEAR(ga, along, 1e-8 * F * a) << h << " " << x0 << " " << x1;
      }
  }
}

// the pull-off force belongs to the law's own limit, small lambda; beyond, it exceeds 2 pi W R
TEST(Dmt, PullOffOverLambda)
{
  const double table[][2] = {{0.001, -2.0},  {0.01, -2.0},   {0.03, -2.0},   {0.1, -2.0005},
                             {0.5, -2.0366}, {1.0, -2.1393}, {10.0, -3.7691}};
  for (const auto &row : table) {
    const ContactMaterial m = unit_material(row[0]);
    DmtState s;
    double lowest = 0.0;
    for (int i = 0; i < 3000; i++)
      if (s.set(m, 1.0, 0.0005 * i)) lowest = std::min(lowest, s.force());
    EXPECT_NEAR(lowest, row[1], 1e-3) << row[0];
  }
}

TEST(Dmt, WorkOfSeparationOfFlats)
{
  ContactMaterial m;
  m.E = 3.0;
  m.W = 0.1;
  m.h0 = 0.02;
  // nearly flat: stress on the axis while the gap opens from 0 to beyond h0
  const int n = 2000;
  double work = 0.0;
  for (int i = 0; i < n; i++) {
    DmtState s;
    const double gap = 1.5 * m.h0 * (i + 0.5) / n;
    if (s.set(m, 1e6, -gap)) work -= s.p(0.0) * 1.5 * m.h0 / n;
  }
  EXPECT_NEAR(work, m.W, 1e-3 * m.W);
}

// rigid range: F = -dU/ddelta with U = - int (W - sigma0 gap) dA over gap(r) = r^2/(2R) - delta <
// h0
TEST(Dmt, ForceDerivesFromTheAdhesionEnergy)
{
  ContactMaterial m;
  m.E = 3.0;
  m.W = 0.1;
  m.h0 = 0.02;
  const double R = 2.5;
  const auto energy = [&](double delta) {
    const int n = 20000;
    const double rmax = std::sqrt(2.0 * R * (m.h0 + delta));
    double u = 0.0;
    for (int i = 0; i < n; i++) {
      const double r = rmax * (i + 0.5) / n;
      u -= (m.W - m.W / m.h0 * (0.5 * r * r / R - delta)) * 2.0 * PI * r * rmax / n;
    }
    return u;
  };
  for (double delta : {-0.9 * m.h0, -0.5 * m.h0, -0.1 * m.h0}) {
    const double eps = 1e-4 * m.h0;
    DmtState s;
    ASSERT_TRUE(s.set(m, R, delta));
    // overlap grows against repulsion: dU/ddelta = +F
    const double slope = (energy(delta + eps) - energy(delta - eps)) / (2.0 * eps);
    EXPECT_NEAR(s.force() / slope, 1.0, 1e-6);
  }
}
