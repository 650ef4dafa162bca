// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Bodies at a given velocity: steps of any length lead to the same place.

#include "law/rigid_motion.h"
#include "helpers.h"

using namespace dcm;

namespace {

RigidMotion turning(double rate)
{
  RigidMotion body;
  body.point = Vec3(1.0, -2.0, 0.5);
  body.axis = Vec3(1.0, 2.0, -2.0) / 3.0;
  body.rate = rate;
  return body;
}

}    // namespace

TEST(RigidMotion, MovesAlong)
{
  RigidMotion body;
  body.velocity = Vec3(0.1, -0.2, 0.3);
  EXPECT_LT((body.mean_velocity(Vec3(4.0, 5.0, 6.0), 7.0) - body.velocity).norm(), 1e-15);
}

// instantaneous velocity omega x r for short steps, with an error that goes with the step
TEST(RigidMotion, TurnsAtItsRate)
{
  const RigidMotion body = turning(0.3);
  const Vec3 x(3.0, 4.0, -1.0), exact = 0.3 * body.axis.cross(x - body.point);
  const double e1 = (body.mean_velocity(x, 1e-3) - exact).norm();
  const double e2 = (body.mean_velocity(x, 5e-4) - exact).norm();
  EXPECT_LT(e1, 1e-3);
  EXPECT_NEAR(e1 / e2, 2.0, 1e-3);
  EXPECT_LT((body.mean_velocity(x, 1e-9) - exact).norm(), 1e-8);
}

// one step as Eigen rotates, and many as one, whatever their lengths
TEST(RigidMotion, StepsOfAnyLengthLeadToTheSamePlace)
{
  const RigidMotion body = turning(2.0);
  const Vec3 start(3.0, 4.0, -1.0);
  const Vec3 right = body.point + Eigen::AngleAxisd(2.0 * 1.7, body.axis).toRotationMatrix() *
                                      (start - body.point);
  for (const auto &steps : {std::vector<double>{1.7}, {0.5, 1.1, 0.1}, {1e-6, 1.7 - 1e-6}}) {
    Vec3 x = start;
    for (const double dt : steps) x += dt * body.mean_velocity(x, dt);
    EXPECT_LT((x - right).norm(), 1e-13);
  }
}

TEST(RigidMotion, LeavesWhatIsOnTheAxis)
{
  const RigidMotion body = turning(2.0);
  EXPECT_LT(body.mean_velocity(body.point + 3.0 * body.axis, 0.4).norm(), 1e-14);
}
