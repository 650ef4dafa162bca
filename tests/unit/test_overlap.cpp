// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Overlap of two triangles against a slow reference: all corners inside the other triangle and all
// crossings of edges, ordered around their mean.

#include "law/overlap.h"

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

using namespace dcm;

namespace {

struct Measure {
  double area = 0.0, mx = 0.0, my = 0.0;
};

Measure measure(const Boundary2 &b)
{
  Measure m;
  for (int i = 0; i < b.n; i++) {
    const double cross = b.x0[i] * b.y1[i] - b.x1[i] * b.y0[i];
    m.area += cross / 2.0;
    m.mx += cross * (b.x0[i] + b.x1[i]) / 6.0;
    m.my += cross * (b.y0[i] + b.y1[i]) / 6.0;
  }
  return m;
}

Measure reference(const Triangle2 &f, const Triangle2 &g)
{
  std::vector<std::pair<double, double>> pts;
  const auto inside = [](const Triangle2 &t, double x, double y) {
    for (int j = 0; j < 3; j++) {
      const int n = (j + 1) % 3;
      if ((t.x[n] - t.x[j]) * (y - t.y[j]) - (t.y[n] - t.y[j]) * (x - t.x[j]) < 0.0) return false;
    }
    return true;
  };
  for (int k = 0; k < 3; k++) {
    if (inside(g, f.x[k], f.y[k])) pts.emplace_back(f.x[k], f.y[k]);
    if (inside(f, g.x[k], g.y[k])) pts.emplace_back(g.x[k], g.y[k]);
    for (int j = 0; j < 3; j++) {
      const int kn = (k + 1) % 3, jn = (j + 1) % 3;
      const double ax = f.x[kn] - f.x[k], ay = f.y[kn] - f.y[k];
      const double bx = g.x[jn] - g.x[j], by = g.y[jn] - g.y[j];
      const double det = ax * by - ay * bx;
      if (det == 0.0) continue;
      const double cx = g.x[j] - f.x[k], cy = g.y[j] - f.y[k];
      const double t = (cx * by - cy * bx) / det, s = (cx * ay - cy * ax) / det;
      if (t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0)
        pts.emplace_back(f.x[k] + t * ax, f.y[k] + t * ay);
    }
  }
  Measure m;
  if (pts.size() < 3) return m;
  double x = 0.0, y = 0.0;
  for (const auto &p : pts) {
    x += p.first / pts.size();
    y += p.second / pts.size();
  }
  std::sort(pts.begin(), pts.end(), [&](const auto &p, const auto &q) {
    return std::atan2(p.second - y, p.first - x) < std::atan2(q.second - y, q.first - x);
  });
  for (size_t i = 0; i < pts.size(); i++) {
    const auto &p = pts[i], &q = pts[(i + 1) % pts.size()];
    const double cross = p.first * q.second - q.first * p.second;
    m.area += cross / 2.0;
    m.mx += cross * (p.first + q.first) / 6.0;
    m.my += cross * (p.second + q.second) / 6.0;
  }
  return m;
}

class Triangles {
 public:
  Triangle2 any()
  {
    Triangle2 t;
    do {
      for (int k = 0; k < 3; k++) {
        t.x[k] = uniform(rng);
        t.y[k] = uniform(rng);
      }
      if (t.twice_area() < 0.0) {
        std::swap(t.x[1], t.x[2]);
        std::swap(t.y[1], t.y[2]);
      }
    } while (!(t.twice_area() > 0.0));
    return t;
  }
  std::mt19937 rng{7};
  std::uniform_real_distribution<double> uniform{-1.0, 1.0};
};

void expect_closed(const Boundary2 &b, double tol)
{
  double x = 0.0, y = 0.0;
  for (int i = 0; i < b.n; i++) {
    x += b.x1[i] - b.x0[i];
    y += b.y1[i] - b.y0[i];
  }
  ASSERT_LE(b.n, Boundary2::MAXSEG);
  ASSERT_NEAR(x, 0.0, tol);
  ASSERT_NEAR(y, 0.0, tol);
}

}    // namespace

TEST(Overlap, RandomTrianglesAgainstReference)
{
  Triangles random;
  int hits = 0;
  for (int i = 0; i < 20000; i++) {
    const Triangle2 f = random.any(), g = random.any();
    Boundary2 b;
    const bool hit = triangle_overlap(f, g, b);
    const Measure ref = reference(f, g);
    if (!hit) {
      ASSERT_LT(ref.area, 1e-9);
      continue;
    }
    hits++;
    const Measure m = measure(b);
    expect_closed(b, 1e-7);
    ASSERT_NEAR(m.area, ref.area, 1e-8);
    ASSERT_NEAR(m.mx, ref.mx, 1e-8);
    ASSERT_NEAR(m.my, ref.my, 1e-8);
  }
  EXPECT_GT(hits, 5000);
}

TEST(Overlap, ClipAgreesAndExchangeIsSymmetric)
{
  Triangles random;
  for (int i = 0; i < 5000; i++) {
    const Triangle2 f = random.any(), g = random.any();
    Boundary2 fg, gf;
    ASSERT_EQ(triangle_overlap(f, g, fg), triangle_overlap(g, f, gf));
    ASSERT_NEAR(measure(fg).area, measure(gf).area, 1e-13);
    Polygon2 p;
    clip_triangles(f, g, p);
    double area = 0.0;
    for (int k = 0; k < p.n; k++) {
      const int n = (k + 1) % p.n;
      area += 0.5 * (p.x[k] * p.y[n] - p.x[n] * p.y[k]);
    }
    ASSERT_NEAR(measure(fg).area, area, 1e-8);
  }
}

TEST(Overlap, HexagonNestedAndDisjoint)
{
  // a star of two regular triangles of side sqrt 3: hexagon of side sqrt(3)/3, area sqrt(3)/2
  Triangle2 f, g;
  for (int k = 0; k < 3; k++) {
    const double t = 2.0 * std::acos(-1.0) * k / 3.0;
    f.x[k] = std::cos(t);
    f.y[k] = std::sin(t);
    g.x[k] = -f.x[k];
    g.y[k] = -f.y[k];
  }
  Boundary2 b;
  ASSERT_TRUE(triangle_overlap(f, g, b));
  EXPECT_EQ(b.n, 6);
  EXPECT_NEAR(measure(b).area, std::sqrt(3.0) / 2.0, 1e-14);

  Triangle2 small = f;
  for (int k = 0; k < 3; k++) {
    small.x[k] = 0.1 * f.x[k];
    small.y[k] = 0.1 * f.y[k];
  }
  ASSERT_TRUE(triangle_overlap(f, small, b));
  EXPECT_NEAR(measure(b).area, 0.005 * f.twice_area(), 1e-15);
  ASSERT_TRUE(triangle_overlap(small, f, b));
  EXPECT_NEAR(measure(b).area, 0.005 * f.twice_area(), 1e-15);

  for (int k = 0; k < 3; k++) small.x[k] += 3.0;
  EXPECT_FALSE(triangle_overlap(f, small, b));
}

// coincident triangles, shared edges and corners, exactly and with noise of every size: mirror
// images of one another are the rule in symmetric scenes
TEST(Overlap, CoincidentTrianglesWithNoise)
{
  Triangles random;
  for (int i = 0; i < 30000; i++) {
    const Triangle2 f = random.any();
    if (f.twice_area() < 0.05) continue;
    Triangle2 g = f;
    const double noise = i % 10 == 0 ? 0.0 : std::pow(10.0, -2.0 - i % 16);
    const int shift = i % 3;
    for (int k = 0; k < 3; k++) {
      g.x[k] = f.x[(k + shift) % 3] + noise * random.uniform(random.rng);
      g.y[k] = f.y[(k + shift) % 3] + noise * random.uniform(random.rng);
    }
    Boundary2 b;
    ASSERT_TRUE(triangle_overlap(f, g, b));
    ASSERT_NEAR(measure(b).area, 0.5 * f.twice_area(), 1e-13 + 10.0 * noise) << noise;
    // neighbor across an edge: nothing in common but noise
    Triangle2 h;
    h.x[0] = g.x[1];
    h.y[0] = g.y[1];
    h.x[1] = g.x[0];
    h.y[1] = g.y[0];
    h.x[2] = g.x[0] + g.x[1] - g.x[2];
    h.y[2] = g.y[0] + g.y[1] - g.y[2];
    b.n = 0;
    triangle_overlap(f, h, b);
    ASSERT_NEAR(measure(b).area, 0.0, 1e-13 + 10.0 * noise);
    // half of f: one corner moved to the middle of an edge
    h = f;
    h.x[1] = 0.5 * (f.x[1] + f.x[2]) + noise * random.uniform(random.rng);
    h.y[1] = 0.5 * (f.y[1] + f.y[2]) + noise * random.uniform(random.rng);
    ASSERT_TRUE(triangle_overlap(f, h, b));
    ASSERT_NEAR(measure(b).area, 0.25 * f.twice_area(), 1e-13 + 10.0 * noise);
    ASSERT_TRUE(triangle_overlap(h, f, b));
    ASSERT_NEAR(measure(b).area, 0.25 * f.twice_area(), 1e-13 + 10.0 * noise);
  }
}

TEST(Overlap, SliversStayFinite)
{
  Triangles random;
  for (int i = 0; i < 100000; i++) {
    Triangle2 f = random.any(), g = random.any();
    const double thin = std::pow(10.0, -(i % 18));
    const double t = random.uniform(random.rng);
    f.x[2] = f.x[0] + t * (f.x[1] - f.x[0]) + thin * random.uniform(random.rng);
    f.y[2] = f.y[0] + t * (f.y[1] - f.y[0]) + thin * random.uniform(random.rng);
    if (!(f.twice_area() > 0.0)) continue;
    if (i % 3 == 0)
      for (int k = 0; k < 2; k++) {
        g.x[k] = f.x[1 - k];
        g.y[k] = f.y[1 - k];
      }
    if (!(g.twice_area() > 0.0)) continue;
    Boundary2 b;
    triangle_overlap(f, g, b);
    ASSERT_LE(b.n, Boundary2::MAXSEG);
    const double area = measure(b).area;
    ASSERT_TRUE(std::isfinite(area));
    ASSERT_GE(area, -1e-12);
    ASSERT_LE(area, 0.5 * std::min(f.twice_area(), g.twice_area()) * (1.0 + 1e-6) + 1e-12);
  }
}
