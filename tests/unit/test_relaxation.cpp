// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Steps of the growth of one daughter: where it starts, how its rest volume is corrected, force
// balance of a cell that meets no wall.

#include "law/relaxation.h"
#include "bodies.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;
using namespace dcm::division_detail;

namespace {

// a daughter of volume V in a room whose walls it does not reach
struct FreeCell {
  static constexpr double V = 300.0;
  Envelope room{dcm_test::ball(1, 40.0)};
  DivisionPlane plane{Vec3(1, -2, 3), Vec3::UnitZ()};
  Vec3 center{Vec3(2, 1, 15)};
  Mesh round = icosphere(2);
  ConfinedCell cell;
  DivisionSettings settings;

  explicit FreeCell(double rest) : cell(room, plane, round, HEPATOBLAST, V, rest) {}
  Eigen::VectorXd start(double size) const
  {
    return division_detail::ball(round, center, size * cell.radius());
  }
};

}    // namespace

TEST(Relaxation, StartsAsFarFromTheWallsAsCanBe)
{
  // half a ball of 6: the largest ball within has radius 3, its center 3 above the plane
  const Envelope envelope(dcm_test::ball(3, 6.0));
  const DivisionPlane plane = {Vec3::Zero(), Vec3(1, 2, 2) / 3.0};
  const double r = ball_radius(PI * 144.0);
  EXPECT_NEAR(clearance(envelope, plane, 2.0 * plane.normal), 2.0, 1.0e-12);
  EXPECT_NEAR(clearance(envelope, plane, -2.0 * plane.normal), -2.0, 1.0e-12);
  const Vec3 centroid = 2.25 * plane.normal;    // 3/8 of the radius: roomy, and kept
  EXPECT_EQ(start_center(envelope, plane, centroid, r), centroid);
  // a centroid without room, as that of a bent half: the best point of a grid of 12/16
  for (const Vec3 &poor : {Vec3(-2.0 * plane.normal), Vec3(8.0 * plane.normal)}) {
    const Vec3 best = start_center(envelope, plane, poor, r);
    EXPECT_GT(clearance(envelope, plane, best), 2.95 - 0.5 * std::sqrt(3.0) * 0.75);
    EXPECT_LE(clearance(envelope, plane, best), 3.0);
  }
}

TEST(Relaxation, BallsAndInflation)
{
  const Mesh round = icosphere(1);
  Mesh mesh = round;
  Eigen::VectorXd x = division_detail::ball(round, Vec3(3, 4, 5), 2.0);
  auto measure = [&]() {
    for (size_t i = 0; i < mesh.nodes.size(); i++) mesh.nodes[i] = vec(&x[3 * i]);
    return volume(mesh);
  };
  EXPECT_NEAR(measure(), ball_volume(2.0), 1.0e-12 * ball_volume(2.0));
  inflate(x, 1.5);
  EXPECT_NEAR(measure(), ball_volume(3.0), 1.0e-12 * ball_volume(3.0));
  Vec3 mid = Vec3::Zero();
  for (const Vec3 &node : mesh.nodes) mid += node / double(mesh.nodes.size());
  EXPECT_LT((mid - Vec3(3, 4, 5)).norm(), 1.0e-13);
}

TEST(Relaxation, VolumeCorrectionOfALinearPressure)
{
  // walls and cortex that answer P = p0 + S ln(V/wanted): with K_V ln(V0/V) = P, V follows from V0
  const double K_V = 2.0, S = 7.0, p0 = 0.3, wanted = 100.0;
  auto balanced = [&](double V0) {
    return std::exp((K_V * std::log(V0) - p0 + S * std::log(wanted)) / (K_V + S));
  };
  // the right slope lands on the volume at once, a wrong one once it has seen two states
  for (double guess : {S, 0.7 * S, 1.6 * S}) {
    VolumeCorrection correction(K_V, guess);
    double V0 = 105.0 * std::exp(p0 / K_V);
    for (int n = 0; n < (guess == S ? 1 : 2); n++)
      V0 = correction.rest_volume(V0, balanced(V0), wanted);
    EXPECT_NEAR(balanced(V0), wanted, 1.0e-10 * wanted) << guess;
    EXPECT_NEAR(std::log(V0 / wanted), p0 / K_V, 1.0e-10);
    EXPECT_NEAR(correction.stiffness(0.01), 0.01 * (K_V + S), 1.0e-8);
  }
  // far off it goes by a fifth of ln V0 at most
  VolumeCorrection correction(K_V, S);
  EXPECT_NEAR(correction.rest_volume(50.0, 20.0, wanted), 50.0 * std::exp(0.2), 1.0e-12);
  EXPECT_NEAR(correction.rest_volume(50.0, 900.0, wanted), 50.0 * std::exp(-0.2), 1.0e-12);
}

TEST(Relaxation, GrowsToTheRoundCellAtRest)
{
  FreeCell f(1.0);
  Relaxation relaxation(f.cell, f.settings, f.start(0.3));
  const std::vector<double> l0 = f.cell.l0;
  relaxation.grow(0.3);
  EXPECT_EQ(f.cell.V0, FreeCell::V);    // full-grown: the rest state it was given
  EXPECT_EQ(f.cell.l0, l0);
  relaxation.balance(FreeCell::V);
  EXPECT_NEAR(f.cell.enclosed(relaxation.x), FreeCell::V, DIVISION_VOLUME * FreeCell::V);
  Eigen::VectorXd g;
  EXPECT_LT(f.cell.energy(relaxation.x, g), 1.0e-6);
  EXPECT_LE(largest_node(g), f.settings.tolerance * f.cell.force_scale());
}

TEST(Relaxation, PressureOfATautCell)
{
  // all edges l at rest at 0.98 l: the round cell is in balance at p = 4 K_A 0.02/R, with
  // K_A = 0.8756 ks (Cortex.InflatedIcosphere)
  const double rest = 0.98;
  FreeCell f(rest);
  Relaxation relaxation(f.cell, f.settings, f.start(1.0));
  relaxation.balance(FreeCell::V);
  const double V = f.cell.enclosed(relaxation.x), p = pressure(HEPATOBLAST.K_V, V, f.cell.V0);
  EXPECT_NEAR(V, FreeCell::V, DIVISION_VOLUME * FreeCell::V);
  const double target = 4.0 * 0.8756 * HEPATOBLAST.ks * (1.0 - rest) / f.cell.radius();
  EXPECT_NEAR(p, target, 0.03 * target);    // 162 nodes

  // released to the round cell's own lengths it has no pressure
  const std::vector<double> l0 = f.cell.l0;
  relaxation.release(1.0 / rest);
  for (size_t n = 0; n < l0.size(); n++) EXPECT_NEAR(f.cell.l0[n], l0[n] / rest, 1.0e-14);
  relaxation.balance(FreeCell::V);
  EXPECT_NEAR(pressure(HEPATOBLAST.K_V, f.cell.enclosed(relaxation.x), f.cell.V0), 0.0,
              2.0 * f.settings.tolerance * HEPATOBLAST.ks / f.cell.radius());
}

TEST(Relaxation, SetVolumeAllOrNothing)
{
  FreeCell f(1.0);
  Eigen::VectorXd x = f.start(1.0);
  const Eigen::VectorXd before = x;
  const double wanted = 1.001 * FreeCell::V;
  EXPECT_FALSE(set_volume(f.cell, x, wanted, 0.0));
  EXPECT_EQ(x, before);
  EXPECT_EQ(f.cell.V0, FreeCell::V);
  const double p = pressure(HEPATOBLAST.K_V, f.cell.enclosed(x), f.cell.V0);
  EXPECT_TRUE(set_volume(f.cell, x, wanted, f.cell.force_scale()));
  EXPECT_NEAR(f.cell.enclosed(x), wanted, 1.0e-12 * wanted);
  EXPECT_NEAR(pressure(HEPATOBLAST.K_V, f.cell.enclosed(x), f.cell.V0), p, 1.0e-12);
}

TEST(Relaxation, NoMoreStepsThanAllowed)
{
  FreeCell f(0.9);
  f.settings.maxiter = 3;
  Relaxation relaxation(f.cell, f.settings, f.start(0.5));
  EXPECT_FALSE(relaxation.descend(1.0e-3));
  EXPECT_EQ(relaxation.steps, 3);
}
