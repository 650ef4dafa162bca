// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Growth over a cycle: both laws and their inverse, slowing by compression, moments and cuts of the
// cycle time. Seeds are fixed; bounds on sampled moments are 4 standard errors.

#include "law/growth.h"
#include "helpers.h"

using namespace dcm;

namespace {

const GrowthLaw BOTH[] = {GrowthLaw::LINEAR, GrowthLaw::EXPONENTIAL};

double drawn(double mean, double sd, int cell)
{
  return cycle_time(mean, sd, Random(5, cell, 0, RandomPurpose::CYCLE));
}

}    // namespace

TEST(Growth, FromOnceToTwice)
{
  for (GrowthLaw law : BOTH) {
    EXPECT_DOUBLE_EQ(growth_factor(law, 0.0), 1.0);
    EXPECT_DOUBLE_EQ(growth_factor(law, 1.0), 2.0);
  }
}

TEST(Growth, LinearGrowsByEqualAmounts)
{
  for (double p = 0.0; p < 1.3; p += 0.1)
    EXPECT_NEAR(growth_factor(GrowthLaw::LINEAR, p + 0.1) - growth_factor(GrowthLaw::LINEAR, p),
                0.1, 1.0e-14);
}

TEST(Growth, ExponentialGrowsByEqualFactors)
{
  // dV/dp = V ln 2
  const double tenth = std::exp(0.1 * std::log(2.0));
  for (double p = 0.0; p < 1.3; p += 0.1)
    EXPECT_NEAR(growth_factor(GrowthLaw::EXPONENTIAL, p + 0.1) /
                    growth_factor(GrowthLaw::EXPONENTIAL, p),
                tenth, 1.0e-14);
}

TEST(Growth, ProgressIsTheInverse)
{
  for (GrowthLaw law : BOTH)
    for (double p = 0.0; p <= 1.25; p += 0.05)
      EXPECT_NEAR(growth_progress(law, growth_factor(law, p)), p, 1.0e-14);
}

TEST(Hill, NoneHalfAndFalling)
{
  for (double n : {1.0, 2.0, 4.0}) {
    EXPECT_EQ(hill_rate(0.0, 0.1, n), 1.0);
    EXPECT_EQ(hill_rate(-0.3, 0.1, n), 1.0);    // stretched
    EXPECT_DOUBLE_EQ(hill_rate(0.1, 0.1, n), 0.5);
    EXPECT_DOUBLE_EQ(hill_rate(0.2, 0.1, n), 1.0 / (1.0 + std::pow(2.0, n)));
    for (double s = 0.0; s < 0.5; s += 0.01)
      EXPECT_LT(hill_rate(s + 0.01, 0.1, n), hill_rate(s, 0.1, n));
  }
  EXPECT_NEAR(hill_rate(1.0e-3, 0.1, 4.0), 1.0, 1.1e-8);    // 1 - (s/h)^n
}

TEST(CycleTime, WithoutSpread)
{
  for (int cell = 1; cell < 50; cell++) EXPECT_EQ(drawn(100.0, 0.0, cell), 100.0);
}

TEST(CycleTime, MeanAndDeviation)
{
  // a normal number z with what lies beyond 3 put at 3: <z> = 0, <z^2> = P - 6 phi(3) + 9 (1 - P),
  // P the probability of |z| < 3
  const double inside = std::erf(3.0 / std::sqrt(2.0));
  const double phi = std::exp(-4.5) / std::sqrt(2.0 * PI);
  const double variance = inside - 6.0 * phi + 9.0 * (1.0 - inside);

  const int n = 100000;
  const double mean = 80000.0, sd = 8000.0;
  double sum = 0.0, square = 0.0;
  for (int cell = 1; cell <= n; cell++) {
    const double z = (drawn(mean, sd, cell) - mean) / sd;
    sum += z / n;
    square += z * z / n;
  }
  EXPECT_NEAR(sum, 0.0, 4.0 * std::sqrt(variance / n));
  EXPECT_NEAR(square, variance, 4.0 * std::sqrt(2.0 / n));
}

TEST(CycleTime, CutAtThreeDeviations)
{
  const int n = 100000;
  const double mean = 100.0, sd = 10.0;
  int low = 0, high = 0;
  for (int cell = 1; cell <= n; cell++) {
    const double t = drawn(mean, sd, cell);
    ASSERT_GE(t, mean - 3.0 * sd);
    ASSERT_LE(t, mean + 3.0 * sd);
    low += t == mean - 3.0 * sd;
    high += t == mean + 3.0 * sd;
  }
  const double tail = 0.5 * std::erfc(3.0 / std::sqrt(2.0)) * n;    // 135 of 100,000
  EXPECT_NEAR(low, tail, 4.0 * std::sqrt(tail));
  EXPECT_NEAR(high, tail, 4.0 * std::sqrt(tail));
}

TEST(CycleTime, NeverBelowATenthOfTheMean)
{
  double lowest = 1.0e9;
  for (int cell = 1; cell <= 10000; cell++) lowest = std::min(lowest, drawn(100.0, 60.0, cell));
  EXPECT_DOUBLE_EQ(lowest, 10.0);
}
