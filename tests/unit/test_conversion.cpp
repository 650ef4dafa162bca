// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// What rules of conversion measure, against closed forms.

#include "law/conversion.h"
#include "helpers.h"
#include "law/jkr.h"
#include "law/volume.h"

#include <cmath>

using namespace dcm;
using namespace dcm_test;

TEST(Conversion, ThresholdsKeepWhatIsBetween)
{
  EXPECT_EQ(wanted_form(0.31, 0.3, 0.1), Form::DEFORMABLE);
  EXPECT_EQ(wanted_form(0.3, 0.3, 0.1), Form::ANY);
  EXPECT_EQ(wanted_form(0.1, 0.3, 0.1), Form::ANY);
  EXPECT_EQ(wanted_form(0.09, 0.3, 0.1), Form::SPHERE);
  EXPECT_EQ(wanted_near(9.0, 10.0, 12.0), Form::DEFORMABLE);
  EXPECT_EQ(wanted_near(11.0, 10.0, 12.0), Form::ANY);
  EXPECT_EQ(wanted_near(13.0, 10.0, 12.0), Form::SPHERE);
  EXPECT_EQ(wanted_near(INFINITY, 10.0, 12.0), Form::SPHERE);
}

// a cube pressed with P on every face, and a sphere: the mean pressure is P whatever the shape

TEST(Conversion, UniformPressureIsTheMeanOne)
{
  const double P = 0.37, a = 5.0, R = 4.0;
  double virial = 0.0;
  for (int face = 0; face < 6; face++) virial += P * a * a * (0.5 * a);
  EXPECT_NEAR(mean_pressure(virial, a * a * a), P, 1e-14);

  const Mesh mesh = icosphere(3);
  virial = 0.0;
  for (const auto &f : mesh.faces) {
    const Vec3 p = R * mesh.nodes[f[0]], q = R * mesh.nodes[f[1]], r = R * mesh.nodes[f[2]];
    const Vec3 area = 0.5 * (q - p).cross(r - p);
    virial += P * area.norm() * area.normalized().dot((p + q + r) / 3.0);
  }
  EXPECT_NEAR(mean_pressure(virial, R * R * R * volume(mesh)), P, 1e-12);
}

// a bubble in balance: its pressure p and tension T hold what is outside, p - 2 T / R

TEST(Conversion, WithinOrFromOutsideIsTheSame)
{
  const double p = 0.4, T = 0.3, R = 4.0, area = 4.0 * PI * R * R, V = R * area / 3.0;
  EXPECT_NEAR(mean_pressure(3.0 * p * V - 2.0 * T * area, V), p - 2.0 * T / R, 1e-14);
}

// between two planes, each with the force F at R - delta: 2 F (R - delta) / (3 V)

TEST(Conversion, SphereBetweenTwoPlanes)
{
  const double R = 5.0, delta = 0.6;
  const JKR law = {3.0, R, 0.0};    // Hertz
  const double F = law.force(delta);
  EXPECT_NEAR(F, 4.0 / 3.0 * 3.0 * std::sqrt(R) * std::pow(delta, 1.5), 1e-9 * F);
  const double V = 4.0 / 3.0 * PI * R * R * R;
  EXPECT_NEAR(mean_pressure(2.0 * F * (R - delta), V), F * (R - delta) / (2.0 * PI * R * R * R),
              1e-12);
}

TEST(Conversion, BallIsNotFlattened)
{
  const double R = 5.0;
  EXPECT_EQ(flattening(R, R), 0.0);
  EXPECT_EQ(flattening(1.01 * R, R), 0.0);
  // balls that touch, of any size
  for (const double other : {1.0, 5.0, 20.0})
    EXPECT_NEAR(flattening(Ball{Vec3::Zero(), R}, Ball{Vec3(R + other, 0, 0), other}), 0.0, 1e-15);
}

// a sphere between two planes or equal spheres shows delta / R, half the overlap over the radius

TEST(Conversion, OverlapOfSpheres)
{
  const double R = 5.0, overlap = 1.2;
  const Ball cell = {Vec3(1, 2, 3), R};
  const Ball equal = {Vec3(1, 2 + 2 * R - overlap, 3), R};
  EXPECT_NEAR(flattening(cell, equal), 0.5 * overlap / R, 1e-14);
  EXPECT_EQ(flattening(0.0, R), 1.0);
  // a small ball beside a large one gives way more, in parts of its radius
  const Ball large = {Vec3(1, 2 + 3 * R - overlap, 3), 2 * R};
  EXPECT_GT(flattening(cell, large), flattening(large, cell));
}

// an ellipsoid: 1 - c / cbrt(a b c) of its shortest half axis. The node nearest to its end is off
// by less than an angle theta, so that it is farther from the center by c/2 (a^2/c^2 - 1) theta^2

TEST(Conversion, Ellipsoid)
{
  const double a = 7.0, b = 5.0, c = 3.5, R = std::cbrt(a * b * c);
  for (const int level : {2, 3, 4}) {
    Mesh mesh = icosphere(level);
    double nearest = INFINITY;
    for (Vec3 &x : mesh.nodes) {
      x = Vec3(a * x[0], b * x[1], c * x[2]);
      nearest = std::min(nearest, x.norm());
    }
    const double theta = 1.2 * 1.107 / std::pow(2.0, level) / std::sqrt(3.0);
    const double bound = theta * theta * (0.5 * (a * a / (c * c) - 1.0) + 1.0);
    EXPECT_NEAR(flattening(nearest, ball_radius(volume(mesh))), 1.0 - c / R, bound) << level;
  }
}

// a cell has the flattening of its sphere right after conversion

TEST(Conversion, SphereAndTheCellItBecomes)
{
  const Ball cell = {Vec3::Zero(), 5.0};
  const double V = ball_volume(5.0);
  const std::vector<Ball> neighbors = {{Vec3(0, 0, 9.0), 5.0}, {Vec3(0, 0, -9.4), 5.0}};
  const double as_sphere = flattening(cell, neighbors[0]);
  EXPECT_NEAR(as_sphere, 0.1, 1e-14);
  const auto nodes = fit_between(cell, V, neighbors, icosphere(3));
  double nearest = INFINITY;
  for (const Vec3 &x : nodes) nearest = std::min(nearest, x.norm());
  EXPECT_NEAR(flattening(nearest, 5.0), as_sphere, 0.005);
}
