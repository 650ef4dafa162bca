// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Choice of steps by comparison with half of their length, on modes that relax alone.

#include "law/accuracy.h"
#include "law/half_step.h"
#include "helpers.h"

using namespace dcm;

namespace {

// backward Euler for dx/dt = -rate x from 1, as fix dcm/motion takes its steps; the largest error
struct Relaxation {
  double worst = 0.0, longest = 0.0;
  int steps = 0, checks = 0;

  Relaxation(double A, double rate, double floor, double end)
  {
    HalfStep half;
    half.accuracy = A;
    half.floor = floor;
    double x = 1.0, t = 0.0, wanted = 1e-3 / rate;
    while (t < end) {
      double h = std::min(wanted, end - t);
      const auto v = [&](double step) {
        return -rate * x / (1.0 + step * rate);
      };
      if (half.due(h)) {
        checks++;
        const double most = half.excess(h * std::fabs(v(h) - v(0.5 * h)), h * std::fabs(v(h)));
        half.take(h, most);
        if (most > HalfStep::REJECTED) h *= 0.5;
      }
      x += h * v(h);
      t += h;
      steps++;
      worst = std::max(worst, std::fabs(x - std::exp(-rate * t)));
      longest = std::max(longest, h);
      wanted = std::min(1.5 * h, half.limit);
    }
  }
};

}    // namespace

// rho = h rate/2 <= A: steps of 2 A / rate, and backward Euler is off by h rate/2 of x at most
TEST(HalfStep, KeepsTheAccuracyOfARelaxation)
{
  for (const double A : {0.1, 0.02, 0.005}) {
    const Relaxation run(A, 0.3, 0.0, 20.0);
    EXPECT_LT(run.worst, A);
    EXPECT_GT(run.worst, 0.1 * A);
    EXPECT_NEAR(run.longest * 0.3, 2.0 * A, 0.4 * A);
    EXPECT_LT(run.checks, run.steps / 3);
  }
}

// time has no unit of its own
TEST(HalfStep, DoesNotDependOnTheUnitOfTime)
{
  const Relaxation slow(0.02, 1e-4, 1e-4, 5e4), fast(0.02, 1e2, 1e-4, 5e-2);
  EXPECT_EQ(slow.steps, fast.steps);
  EXPECT_NEAR(slow.worst, fast.worst, 1e-9);
}

// what is left to move below the floor does not hold up the run
TEST(HalfStep, FloorLetsCellsRest)
{
  const Relaxation without(0.01, 1.0, 0.0, 100.0), with(0.01, 1.0, 1e-4, 100.0);
  EXPECT_GT(without.steps, 4000);
  EXPECT_LT(with.steps, 600);
  EXPECT_LT(with.worst, 0.01);
}

TEST(HalfStep, ErrorsGoAsTheAccuracyWhereTheFloorDecides)
{
  // a cell so large against its way, which is 1, that A of the way is less than the floor
  const double R = 100.0, coarse = 0.04, fine = 0.01;
  const Relaxation one(coarse, 0.01, accuracy_floor(coarse, R), 500.0);
  const Relaxation other(fine, 0.01, accuracy_floor(fine, R), 500.0);
  EXPECT_NEAR(one.worst / other.worst, coarse / fine, 0.35 * coarse / fine);
}

TEST(HalfStep, ChecksWhatIsLongerAtOnce)
{
  HalfStep half;
  half.accuracy = 0.1;
  EXPECT_TRUE(half.due(1.0));
  half.take(1.0, 0.5);
  EXPECT_FALSE(half.due(1.0));
  EXPECT_TRUE(half.due(1.6));
  half.take(1.6, 0.5);
  for (int k = 1; k < HalfStep::EVERY; k++) EXPECT_FALSE(half.due(1.6));
  EXPECT_TRUE(half.due(1.6));

  HalfStep none;
  EXPECT_FALSE(none.due(1.0));
}

TEST(Accuracy, LengthsScaleWithTheCells)
{
  EXPECT_DOUBLE_EQ(accuracy_step(0.02, 12.0), 2.0 * accuracy_step(0.02, 6.0));
  EXPECT_DOUBLE_EQ(accuracy_floor(0.02, 12.0), 2.0 * accuracy_floor(0.02, 6.0));
  EXPECT_NEAR(mesh_error(mesh_nodes(0.03)), 0.03, 1e-12);
  EXPECT_NEAR(range_error(1e-3, 7e-3), range_error(1.0, 7.0), 1e-12);
  EXPECT_LE(accuracy_tolerance(0.2), 1e-2);
}
