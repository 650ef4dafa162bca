// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Apical constriction: which edges, the ramp to the last digit, and rest lengths that others
// change.

#include "law/constriction.h"
#include "helpers.h"

using namespace dcm;

TEST(Constriction, AnEdgeBelongsWhereBothFacesDo)
{
  enum Region { LATERAL, APICAL, JUNCTION };
  const auto edge = [](Region a, Region b) {
    return constricted_edge(a, b, JUNCTION, APICAL);
  };
  EXPECT_EQ(edge(JUNCTION, JUNCTION), ConstrictedEdge::RIBBON);
  EXPECT_EQ(edge(APICAL, APICAL), ConstrictedEdge::CAP);
  EXPECT_EQ(edge(LATERAL, LATERAL), ConstrictedEdge::NONE);
  EXPECT_EQ(edge(JUNCTION, APICAL), ConstrictedEdge::NONE);
  EXPECT_EQ(edge(APICAL, JUNCTION), ConstrictedEdge::NONE);
  EXPECT_EQ(edge(LATERAL, APICAL), ConstrictedEdge::NONE);
}

TEST(Constriction, TheRampTakesItsTimeToTheStep)
{
  for (int steps : {1, 3, 7, 300, 4999}) {
    double share = 0.0;
    for (int n = 1; n <= steps; n++) {
      EXPECT_LT(share, 1.0);
      share = constriction_share(share, 1.0 / steps, true);
    }
    EXPECT_EQ(share, 1.0) << steps;
    EXPECT_EQ(constriction_share(share, 1.0 / steps, true), 1.0);
    for (int n = 1; n <= steps; n++) {
      EXPECT_GT(share, 0.0);
      share = constriction_share(share, 1.0 / steps, false);
    }
    EXPECT_EQ(share, 0.0) << steps;
    EXPECT_EQ(constriction_share(share, 1.0 / steps, false), 0.0);
  }
}

TEST(Constriction, NoRampIsOneStep)
{
  for (double step : {1.0, 4.0}) {
    EXPECT_EQ(constriction_share(0.0, step, true), 1.0);
    EXPECT_EQ(constriction_share(1.0, step, false), 0.0);
  }
}

TEST(Constriction, TheFactorIsLinearInTheShare)
{
  EXPECT_EQ(constriction_factor(0.7, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(constriction_factor(0.7, 1.0), 0.7);
  EXPECT_DOUBLE_EQ(constriction_factor(0.5, 0.5), 0.75);
}

TEST(Constriction, TheLengthComesBackToTheLastBit)
{
  const double l0 = 1.0 / 3.0;
  ConstrictedLength length = {0.7, l0, l0};
  double now = l0;
  for (int n = 1; n <= 100; n++) now = length.at(n / 100.0, now);
  EXPECT_DOUBLE_EQ(now, 0.7 * l0);
  for (int n = 99; n >= 0; n--) now = length.at(n / 100.0, now);
  EXPECT_EQ(now, l0);
}

TEST(Constriction, GrowthBetweenIsKept)
{
  ConstrictedLength length = {0.5, 2.0, 2.0};
  double now = length.at(0.4, 2.0);
  now *= 1.25;
  now = length.at(1.0, now);
  EXPECT_DOUBLE_EQ(now, 0.5 * 2.5);
  now *= 0.95;
  now *= 1.01;
  EXPECT_DOUBLE_EQ(length.at(0.0, now), 2.5 * 0.95 * 1.01);
}

TEST(Constriction, AnyFactorIsOnTheLengthWithoutIt)
{
  const double l0 = 1.0 / 3.0;
  ConstrictedLength length = {1.0, l0, l0};
  double now = l0;
  for (const double factor : {1.3, 0.2, 0.9}) {
    now = length.scaled(factor, now);
    EXPECT_DOUBLE_EQ(now, factor * l0);
  }
  EXPECT_EQ(length.scaled(1.0, now), l0);
}
