// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Random numbers: the generator's published answers, moments, and independence of the keys.
// Seeds are fixed, so a test either always passes or always fails; bounds are 4 to 5 standard
// errors.

#include "law/random.h"
#include "helpers.h"

#include <set>

using namespace dcm;
using namespace dcm_test;

namespace {

using Words = std::array<std::uint32_t, 4>;

// correlation of two streams, in standard errors (1/sqrt n for independent ones)
double correlation(Random a, Random b)
{
  const int n = 20000;
  double sum = 0.0;
  for (int i = 0; i < n; i++) sum += (a.uniform() - 0.5) * (b.uniform() - 0.5) * 12.0;
  return sum / std::sqrt(double(n));
}

}    // namespace

TEST(Random, PhiloxKnownAnswers)
{
  // known answers distributed with the authors' library (Random123, philox4x32 10 rounds)
  const std::uint32_t f = 0xffffffffu;
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (Words{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}));
  EXPECT_EQ(philox4x32({f, f, f, f}, {f, f}),
            (Words{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}));
  EXPECT_EQ(
      philox4x32({0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u}),
      (Words{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}));
}

TEST(Random, SameKeySameNumbers)
{
  Random a(1, 2, 3, RandomPurpose::MOTILITY), b(1, 2, 3, RandomPurpose::MOTILITY);
  for (int i = 0; i < 100; i++) EXPECT_EQ(a.uniform(), b.uniform());
}

TEST(Random, UniformMomentsAndHistogram)
{
  Random random(4, 5, 6);
  const int n = 200000, bins = 50;
  double mean = 0.0, square = 0.0;
  std::vector<int> count(bins, 0);
  for (int i = 0; i < n; i++) {
    const double u = random.uniform();
    ASSERT_GT(u, 0.0);
    ASSERT_LT(u, 1.0);
    mean += u / n;
    square += u * u / n;
    count[int(u * bins)]++;
  }
  EXPECT_NEAR(mean, 0.5, 4.0 * std::sqrt(1.0 / 12.0 / n));
  EXPECT_NEAR(square, 1.0 / 3.0, 4.0 * std::sqrt(4.0 / 45.0 / n));
  double chi2 = 0.0;
  for (int c : count) chi2 += std::pow(c - double(n) / bins, 2) / (double(n) / bins);
  EXPECT_NEAR(chi2, bins - 1, 4.0 * std::sqrt(2.0 * (bins - 1)));
}

TEST(Random, GaussianMoments)
{
  // as fixes use it: one stream per (cell, step), three numbers each
  const int n = 200000;
  double m1 = 0.0, m2 = 0.0, m3 = 0.0, m4 = 0.0;
  Mat3 covariance = Mat3::Zero();
  for (int i = 0; i < n; i++) {
    const Vec3 g = Random(7, i % 100, i / 100, RandomPurpose::MOTILITY).gaussian_vector();
    covariance += g * g.transpose() / n;
    for (int d = 0; d < 3; d++) {
      m1 += g[d] / (3.0 * n);
      m2 += g[d] * g[d] / (3.0 * n);
      m3 += std::pow(g[d], 3) / (3.0 * n);
      m4 += std::pow(g[d], 4) / (3.0 * n);
    }
  }
  EXPECT_NEAR(m1, 0.0, 4.0 * std::sqrt(1.0 / (3.0 * n)));
  EXPECT_NEAR(m2, 1.0, 4.0 * std::sqrt(2.0 / (3.0 * n)));
  EXPECT_NEAR(m3, 0.0, 4.0 * std::sqrt(15.0 / (3.0 * n)));
  EXPECT_NEAR(m4, 3.0, 4.0 * std::sqrt(96.0 / (3.0 * n)));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      EXPECT_NEAR(covariance(i, j), i == j, 5.0 * std::sqrt((i == j ? 2.0 : 1.0) / n));
}

TEST(Random, UnitVectorsAreIsotropic)
{
  const int n = 100000;
  Random random(8, 9, 10);
  Vec3 mean = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (int i = 0; i < n; i++) {
    const Vec3 u = random.unit_vector();
    ASSERT_NEAR(u.norm(), 1.0, 1.0e-14);
    mean += u / n;
    second += u * u.transpose() / n;
  }
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 4.0 * std::sqrt(1.0 / 3.0 / n));
  EXPECT_LT((second - Mat3::Identity() / 3.0).cwiseAbs().maxCoeff(),
            5.0 * std::sqrt(4.0 / 45.0 / n));
}

TEST(Random, KeysAreIndependent)
{
  const auto motility = RandomPurpose::MOTILITY, division = RandomPurpose::DIVISION;
  const Random base(11, 12, 13, motility);
  EXPECT_LT(std::fabs(correlation(base, Random(12, 12, 13, motility))), 4.0);
  EXPECT_LT(std::fabs(correlation(base, Random(11, 13, 13, motility))), 4.0);
  EXPECT_LT(std::fabs(correlation(base, Random(11, 12, 14, motility))), 4.0);
  EXPECT_LT(std::fabs(correlation(base, Random(11, 12, 13, division))), 4.0);
  EXPECT_LT(std::fabs(correlation(base, Random(11, 13, 12, motility))), 4.0);    // swapped

  // the first number as a sequence over cells, and over steps: no correlation of neighbors
  const int n = 20000;
  double cells = 0.0, steps = 0.0;
  for (int i = 0; i < n; i++) {
    auto first = [&](int cell, int step) {
      return Random(11, cell, step, motility).uniform() - 0.5;
    };
    cells += 12.0 * first(i, 0) * first(i + 1, 0);
    steps += 12.0 * first(0, i) * first(0, i + 1);
  }
  EXPECT_LT(std::fabs(cells) / std::sqrt(double(n)), 4.0);
  EXPECT_LT(std::fabs(steps) / std::sqrt(double(n)), 4.0);
}

TEST(Random, NoTwoKeysCollide)
{
  // also where only bits beyond 32 differ
  const std::int64_t big[] = {0,
                              1,
                              2,
                              std::int64_t(1) << 31,
                              std::int64_t(1) << 32,
                              (std::int64_t(1) << 32) + 1,
                              std::int64_t(1) << 48,
                              std::int64_t(1) << 62,
                              -1};
  std::set<double> seen;
  size_t keys = 0;
  for (std::int64_t seed : big)
    for (std::int64_t cell : big)
      for (std::int64_t step : big)
        for (auto purpose :
             {RandomPurpose::GENERAL, RandomPurpose::MOTILITY, RandomPurpose::TRACER}) {
          seen.insert(Random(std::uint64_t(seed), cell, step, purpose).uniform());
          keys++;
        }
  EXPECT_EQ(seen.size(), keys);
}
