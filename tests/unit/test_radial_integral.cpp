// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Integrals of a radial stress over polygons, for a stress whose integrals have closed forms.
// The laws of the contact: test_contact_law.cpp and test_contact.cpp.

#include "law/radial_integral.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

namespace {

// p = r^2 in the core, -sigma0 in the ring: polynomials, on which two Gauss points are exact
struct Parabola : RadialLaw<Parabola> {
  static constexpr bool EXACT_CORE = false;

  Parabola(double _a, double _c, double _sigma0)
  {
    a = _a;
    c = _c;
    sigma0 = _sigma0;
    Q0a = a * a * a * a / 4.0;
    Q1a = a * a * a * a * a / 5.0;
    finish_ring();
  }
  void core(double r2, double &q0, double &q1) const
  {
    q0 = r2 / 4.0;
    q1 = r2 / 5.0;
  }
  double core_p(double r2) const { return r2; }
};

using Corners = std::vector<Eigen::Vector2d>;

Boundary2 boundary(const Corners &x)
{
  Boundary2 b;
  for (size_t k = 0; k < x.size(); k++) {
    const auto &y = x[(k + 1) % x.size()];
    b.add(x[k][0], x[k][1], y[0], y[1]);
  }
  return b;
}

RadialSums integral(const Parabola &law, const Corners &x, int npoints = 2)
{
  RadialSums s;
  radial_integral(law, boundary(x), npoints, s);
  return s;
}

Corners rectangle(double x0, double x1, double y0, double y1)
{
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

void expect_equal(const RadialSums &a, const RadialSums &b, double tolerance)
{
  EXPECT_NEAR(a.force, b.force, tolerance);
  EXPECT_NEAR(a.mx, b.mx, tolerance);
  EXPECT_NEAR(a.my, b.my, tolerance);
  EXPECT_NEAR(a.area, b.area, tolerance);
  EXPECT_NEAR(a.ax, b.ax, tolerance);
  EXPECT_NEAR(a.ay, b.ay, tolerance);
}

const Parabola LAW(1.2, 2.0, 0.7);

}    // namespace

TEST(RadialIntegral, PolygonAroundTheContact)
{
  const RadialSums s = integral(LAW, rectangle(-3, 4, -2.5, 5));
  const double a = LAW.a, c = LAW.c;
  RadialSums t;
  t.force = PI * std::pow(a, 4) / 2.0 - PI * LAW.sigma0 * (c * c - a * a);
  t.area = PI * c * c;
  expect_equal(s, t, 1.0e-13);
  EXPECT_NEAR(LAW.force(), t.force, 1.0e-13);
}

TEST(RadialIntegral, PolygonBesideTheContact)
{
  expect_equal(integral(LAW, rectangle(2.1, 3, -1, 1)), RadialSums(), 0.0);
  // its corner just beyond the circle
  expect_equal(integral(LAW, rectangle(1.5, 3, 1.5, 3)), RadialSums(), 0.0);
  expect_equal(integral(LAW, {}), RadialSums(), 0.0);
}

TEST(RadialIntegral, RectangleWithinTheCore)
{
  // x^2 + y^2 and its moments over x0..x1, y0..y1
  const double x0 = -0.3, x1 = 0.8, y0 = 0.1, y1 = 0.7;
  auto power = [](double lo, double hi, int n) {
    return (std::pow(hi, n + 1) - std::pow(lo, n + 1)) / (n + 1);
  };
  auto X = [&](int n) {
    return power(x0, x1, n);
  };
  auto Y = [&](int n) {
    return power(y0, y1, n);
  };
  RadialSums t;
  t.force = X(2) * Y(0) + X(0) * Y(2);
  t.mx = X(3) * Y(0) + X(1) * Y(2);
  t.my = X(2) * Y(1) + X(0) * Y(3);
  t.area = X(0) * Y(0);
  t.ax = X(1) * Y(0);
  t.ay = X(0) * Y(1);
  for (int np : {2, 3, 4}) expect_equal(integral(LAW, rectangle(x0, x1, y0, y1), np), t, 1.0e-14);
  // one point is not exact here: the test sees the rule
  EXPECT_GT(std::fabs(integral(LAW, rectangle(x0, x1, y0, y1), 1).force - t.force), 1.0e-4);
}

TEST(RadialIntegral, RectangleWithinTheRing)
{
  const double x0 = 1.25, x1 = 1.6, y0 = -0.4, y1 = 0.8, A = (x1 - x0) * (y1 - y0);
  const RadialSums s = integral(LAW, rectangle(x0, x1, y0, y1));
  RadialSums t;
  t.area = A;
  t.ax = 0.5 * (x0 + x1) * A;
  t.ay = 0.5 * (y0 + y1) * A;
  t.force = -LAW.sigma0 * t.area;
  t.mx = -LAW.sigma0 * t.ax;
  t.my = -LAW.sigma0 * t.ay;
  expect_equal(s, t, 1.0e-14);
}

TEST(RadialIntegral, EdgesThroughTheAxis)
{
  // half and quarter of the contact, turned by any angle
  const double c = LAW.c, q1 = LAW.Q1(c);
  for (double turn : {0.0, 0.3, 2.0, 4.4}) {
    const Eigen::Rotation2Dd R(turn);
    auto turned = [&](Corners x) {
      for (auto &v : x) v = R * v;
      return x;
    };
    auto target = [&](double part, double reach, const Eigen::Vector2d &along) {
      // integral of cos over the sector is `reach` along its middle
      const Eigen::Vector2d e = reach * (R * along);
      RadialSums t;
      t.force = part * LAW.force();
      t.area = part * PI * c * c;
      t.mx = q1 * e[0];
      t.my = q1 * e[1];
      t.ax = c * c * c / 3.0 * e[0];
      t.ay = c * c * c / 3.0 * e[1];
      return t;
    };
    expect_equal(integral(LAW, turned(rectangle(-5, 5, 0, 5))),
                 target(0.5, 2.0, Eigen::Vector2d(0, 1)), 1.0e-13);
    expect_equal(integral(LAW, turned(rectangle(0, 5, 0, 5))),
                 target(0.25, std::sqrt(2.0), Eigen::Vector2d(1, 1).normalized()), 1.0e-13);
  }
}

TEST(RadialIntegral, PartsAddUp)
{
  // a polygon that crosses both circles, cut along a random line: the shared edge cancels
  Random random(91, 0, 0);
  for (int trial = 0; trial < 200; trial++) {
    Corners x;
    const double shift = 2.0 * random.uniform();
    for (int k = 0; k < 4; k++) {
      const double t = 0.5 * PI * (k + 0.8 * random.uniform());
      x.emplace_back(shift + 2.0 * std::cos(t), 2.0 * std::sin(t));
    }
    const RadialSums whole = integral(LAW, x);
    RadialSums parts;
    radial_integral(LAW, boundary({x[0], x[1], x[2]}), 2, parts);
    radial_integral(LAW, boundary({x[0], x[2], x[3]}), 2, parts);
    expect_equal(whole, parts, 1.0e-12);
  }
}

TEST(RadialIntegral, AgainstAreaQuadrature)
{
  // midpoints of a fine grid of a triangle over core, ring and beyond
  const Corners x = {{-0.5, -1.0}, {2.5, 0.2}, {0.3, 1.9}};
  const RadialSums s = integral(LAW, x);
  RadialSums t;
  const int n = 1500;
  const Eigen::Vector2d u = (x[1] - x[0]) / n, v = (x[2] - x[0]) / n;
  const double dA = 0.5 * (u[0] * v[1] - u[1] * v[0]);
  for (int i = 0; i < n; i++)
    for (int j = 0; i + j < n; j++)
      for (int up : {0, 1}) {
        if (up && i + j + 1 >= n) continue;
        const double third = (1.0 + up) / 3.0;
        const Eigen::Vector2d y = x[0] + (i + third) * u + (j + third) * v;
        const double r = y.norm(), p = LAW.p(r);
        t.force += p * dA;
        t.mx += p * y[0] * dA;
        t.my += p * y[1] * dA;
        if (r > LAW.c) continue;
        t.area += dA;
        t.ax += y[0] * dA;
        t.ay += y[1] * dA;
      }
  expect_equal(s, t, 1.0e-3);
}
