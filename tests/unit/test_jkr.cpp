// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// JKR contact: pull-off, inverse, limits, energy, the published form of LAMMPS' granular jkr, and
// the contact held back between sister cells.

#include "law/jkr.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

namespace {

const JKR pairs[] = {{2.0, 3.0, 0.1},
                     {450.0e-3, 3.0, 0.1},
                     {1.0, 1.0, 1.0e-9},
                     {1.0e3, 1.0, 1.0e3},
                     {1.0e-6, 1.0e-6, 1.0e-12}};

// slow, obvious radius: bisection on the rising branch, above the fold of delta(a)
double reference_radius(const JKR &jkr, double delta)
{
  double low = std::cbrt(PI * jkr.sigma * jkr.R * jkr.R / (8.0 * jkr.E));
  double high = low + std::sqrt(jkr.R * std::max(delta, 0.0)) + jkr.R;
  while (jkr.overlap_of_radius(high) < delta) high *= 2.0;
  for (int i = 0; i < 200; i++) {
    const double mid = 0.5 * (low + high);
    (jkr.overlap_of_radius(mid) < delta ? low : high) = mid;
  }
  return 0.5 * (low + high);
}

}    // namespace

TEST(Jkr, PullOff)
{
  // the known pull-off force of JKR with work of adhesion W is -1.5 pi W R: sigma is W
  for (const JKR &jkr : pairs) {
    const double d = jkr.pull_off_displacement();
    const double known = -1.5 * PI * jkr.sigma * jkr.R;
    EXPECT_NEAR(jkr.pull_off_force() / known, 1.0, 1.0e-14);
    EXPECT_NEAR(jkr.force(d) / known, 1.0, 1.0e-12);
    // and it is the minimum over the whole range, found by scanning
    double lowest = 0.0;
    for (int i = 0; i <= 2000; i++) {
      const double delta = d + i * (0.5 * jkr.R - d) / 2000;
      lowest = std::min(lowest, jkr.force(delta));
    }
    EXPECT_NEAR(lowest / known, 1.0, 1.0e-12);
    EXPECT_EQ(jkr.force(d * (1.0 + 1.0e-9)), 0.0);    // beyond it: apart
    EXPECT_EQ(jkr.contact_radius(1.1 * d), 0.0);
    EXPECT_EQ(jkr.energy(1.1 * d), 0.0);
  }
}

TEST(Jkr, RadiusInvertsOverlap)
{
  for (const JKR &jkr : pairs) {
    const double d = jkr.pull_off_displacement();
    for (int i = 0; i <= 1000; i++) {
      const double delta = d + i * (0.5 * jkr.R - d) / 1000;
      const double a = jkr.contact_radius(delta);
      ASSERT_NEAR(a / reference_radius(jkr, delta), 1.0, 1.0e-12);
      ASSERT_NEAR(jkr.overlap_of_radius(a), delta, 1.0e-13 * (std::fabs(delta) + a * a / jkr.R));
    }
  }
}

TEST(Jkr, NeverFails)
{
  // 60 decades of adhesion, from pull-off to half a radius
  for (int p = -40; p <= 20; p++) {
    const JKR jkr{1.0, 1.0, std::pow(10.0, p)};
    const double d = jkr.pull_off_displacement();
    double before = 0.0;
    for (double s : {0.0, 1.0e-12, 1.0e-6, 1.0e-3, 0.1, 0.5, 0.9, 1.0}) {
      const double a = jkr.contact_radius(d + s * (0.5 - d));
      ASSERT_TRUE(std::isfinite(a) && a > 0.0) << p << " " << s;
      ASSERT_GE(a, before);
      before = a;
    }
  }
}

TEST(Jkr, HertzLimit)
{
  for (double delta : {1.0e-6, 0.01, 0.5}) {
    const double hertz = 4.0 / 3.0 * 2.0 * std::sqrt(3.0) * std::pow(delta, 1.5);
    EXPECT_NEAR((JKR{2.0, 3.0, 0.0}).force(delta) / hertz, 1.0, 1.0e-14);
    EXPECT_NEAR((JKR{2.0, 3.0, 1.0e-30}).force(delta) / hertz, 1.0, 1.0e-9);
  }
  const JKR none{2.0, 3.0, 0.0};
  EXPECT_EQ(none.force(0.0), 0.0);
  EXPECT_EQ(none.force(-0.1), 0.0);
  EXPECT_EQ(none.contact_radius(0.0), 0.0);
  EXPECT_EQ(none.pull_off_displacement(), 0.0);
}

TEST(Jkr, FirstTouch)
{
  // at delta = 0: a^3 = 2 pi sigma R^2/E, F = -(4/3) pi sigma R (8/9 of pull-off)
  for (const JKR &jkr : pairs) {
    EXPECT_NEAR(jkr.contact_radius(0.0) / std::cbrt(2.0 * PI * jkr.sigma * jkr.R * jkr.R / jkr.E),
                1.0, 1.0e-13);
    EXPECT_NEAR(jkr.force(0.0) / (-4.0 / 3.0 * PI * jkr.sigma * jkr.R), 1.0, 1.0e-13);
  }
}

TEST(Jkr, ForceIsDerivativeOfEnergy)
{
  const JKR jkr = pairs[0];
  const double d = jkr.pull_off_displacement(), h = 1.0e-5;
  for (double delta : {0.9 * d, 0.5 * d, 0.01, 0.2, 1.0}) {
    const double slope = (jkr.energy(delta + h) - jkr.energy(delta - h)) / (2.0 * h);
    EXPECT_NEAR(slope / jkr.force(delta), 1.0, 1.0e-6);
  }
}

TEST(Jkr, RadiusInvertsForce)
{
  for (const JKR &jkr : pairs)
    for (double delta : {0.0, 0.01 * jkr.R, 0.5 * jkr.R, 3.0 * jkr.R}) {
      const double a = jkr.contact_radius(delta);
      EXPECT_NEAR(jkr.radius_of_force(jkr.force_of_radius(a)) / a, 1.0, 1.0e-11);
    }
  EXPECT_EQ((JKR{2.0, 3.0, 0.0}).radius_of_force(0.0), 0.0);
  // the branch ends at pull-off
  const JKR &jkr = pairs[0];
  EXPECT_NEAR(jkr.radius_of_force(jkr.pull_off_force()) /
                  jkr.contact_radius(jkr.pull_off_displacement()),
              1.0, 1.0e-6);
}

TEST(HeldJkr, ScaleIsJkrOfASofterPair)
{
  for (const JKR &jkr : pairs)
    for (double scale : {1.0e-3, 0.3, 1.0}) {
      const HeldJKR held{jkr, scale, 0.0};
      const JKR soft{scale * jkr.E, jkr.R, scale * jkr.sigma};
      const double d = jkr.pull_off_displacement();
      EXPECT_NEAR(soft.pull_off_displacement() / d, 1.0, 1.0e-14);
      for (double s : {0.0, 0.2, 1.0, 3.0}) {
        const double delta = d + s * (jkr.R - d);
        const double unit = scale * std::fabs(jkr.pull_off_force());
        EXPECT_NEAR(soft.contact_radius(delta) / jkr.contact_radius(delta), 1.0, 1.0e-12);
        EXPECT_NEAR(held.force(delta), soft.force(delta),
                    1.0e-11 * (unit + std::fabs(soft.force(delta))));
        EXPECT_NEAR(held.energy(delta), soft.energy(delta),
                    1.0e-11 * (unit * jkr.R + std::fabs(soft.energy(delta))));
      }
    }
}

TEST(HeldJkr, NothingHeldIsTheFullLaw)
{
  for (const JKR &jkr : pairs)
    for (double s : {-0.5, 0.0, 0.1, 1.0, 2.0}) {
      const double delta = s < 0.0 ? 0.5 * jkr.pull_off_displacement() : s * jkr.R;
      const HeldJKR none{jkr, 1.0, 0.0}, far{jkr, 1.0, 1.0e3 * jkr.E * jkr.R * jkr.R};
      EXPECT_EQ(none.force(delta), jkr.force(delta));
      EXPECT_EQ(none.energy(delta), jkr.energy(delta));
      EXPECT_EQ(none.part_of_radius(jkr.contact_radius(delta)), 1.0);
      EXPECT_EQ(far.force(delta), jkr.force(delta));
      EXPECT_EQ(far.energy(delta), jkr.energy(delta));
    }
}

TEST(HeldJkr, LimitOfTheForce)
{
  for (const JKR &jkr : {pairs[0], pairs[1], JKR{2.0, 3.0, 0.0}})
    for (double scale : {1.0, 0.25}) {
      const double cap = 0.3 * scale * jkr.force(0.5 * jkr.R);
      const HeldJKR held{jkr, scale, cap};
      const double begin = jkr.overlap_of_radius(jkr.radius_of_force(cap / scale));
      ASSERT_GT(begin, 0.0);
      ASSERT_LT(begin, 0.5 * jkr.R);

      // the full law below, the limit above, and no step between
      EXPECT_EQ(held.force(0.9 * begin), scale * jkr.force(0.9 * begin));
      EXPECT_EQ(held.force(1.1 * begin), cap);
      EXPECT_EQ(held.force(3.0 * jkr.R), cap);
      const double near = 1.0e-9 * begin;
      EXPECT_NEAR(held.force(begin - near) / cap, 1.0, 1.0e-8);
      EXPECT_NEAR(held.force(begin + near) / cap, 1.0, 1.0e-8);
      EXPECT_NEAR(held.energy(begin + near), held.energy(begin - near), 3.0 * near * cap);

      // attraction is not limited
      const double d = 0.9 * jkr.pull_off_displacement();
      EXPECT_EQ(held.force(d), scale * jkr.force(d));

      // and the part left times the full force is the force
      for (double delta : {0.5 * begin, 2.0 * begin}) {
        const double a = jkr.contact_radius(delta);
        EXPECT_NEAR(held.part_of_radius(a) * jkr.force(delta), held.force(delta), 1.0e-14 * cap);
      }
    }
}

TEST(HeldJkr, ForceIsDerivativeOfEnergy)
{
  for (double scale : {1.0, 0.25})
    for (double most : {0.0, 0.1, 0.5}) {
      const JKR jkr = pairs[0];
      const HeldJKR held{jkr, scale, most};
      const double d = jkr.pull_off_displacement(), h = 1.0e-5;
      for (double delta : {0.9 * d, 0.5 * d, 0.01, 0.05, 0.2, 0.5, 1.0, 4.0}) {
        const double slope = (held.energy(delta + h) - held.energy(delta - h)) / (2.0 * h);
        EXPECT_NEAR(slope, held.force(delta), 1.0e-6 * std::fabs(held.force(delta)) + 1.0e-9);
      }
    }
}

TEST(Jkr, AgreesWithTheFormOfPairGranular)
{
  // LAMMPS manual, pair granular jkr: F = 4 E a^3/(3R) - 2 pi a^2 sqrt(4 gamma E/(pi a)),
  // delta = a^2/R - 2 sqrt(pi gamma a/E), where gamma is half the work of adhesion
  for (const JKR &jkr : pairs) {
    const double gamma = 0.5 * jkr.sigma, E = jkr.E, R = jkr.R;
    for (double s : {0.0, 0.3, 1.0}) {
      const double d = jkr.pull_off_displacement();
      const double delta = d + s * (0.5 * R - d);
      const double a = jkr.contact_radius(delta);
      const double hertz = 4.0 * E * a * a * a / (3.0 * R);
      const double force = hertz - 2.0 * PI * a * a * std::sqrt(4.0 * gamma * E / (PI * a));
      EXPECT_NEAR(jkr.force(delta), force, 1.0e-12 * (hertz + std::fabs(force)));
      EXPECT_NEAR(a * a / R - 2.0 * std::sqrt(PI * gamma * a / E), delta,
                  1.0e-12 * (std::fabs(delta) + a * a / R));
    }
  }
}

TEST(Jkr, EffectiveValues)
{
  EXPECT_NEAR(effective_modulus(2.0, 0.5, 2.0, 0.5), 2.0 / 1.5, 1.0e-15);
  EXPECT_NEAR(effective_modulus(1.0, 0.0, 3.0, 0.5), 1.0 / (1.0 + 0.25), 1.0e-15);
  EXPECT_NEAR(effective_radius(6.0, 3.0), 2.0, 1.0e-15);
}

TEST(Jkr, ApparentModulus)
{
  const double a[4] = {1.0, -2.0, 3.0, 5.0}, d = 0.3;
  double sum = 0.45;
  for (int k = 0; k < 4; k++) sum += a[k] * std::pow(d, k + 1);
  EXPECT_NEAR(apparent_modulus(0.45, a, d), sum, 1.0e-15);
  EXPECT_EQ(apparent_modulus(0.45, a, 0.0), 0.45);
  EXPECT_EQ(apparent_modulus(0.45, a, -0.3), 0.45);
}
