// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Mean stress of bodies, and the virials of forces within them, against closed forms.

#include "law/mean_stress.h"
#include "law/tension.h"
#include "bodies.h"

using namespace dcm;
using namespace dcm_test;

static const Symmetric NONE = {};

static Symmetric virial_of(const Points &f, const std::vector<Vec3> &x)
{
  Symmetric six = {};
  for (size_t i = 0; i < x.size(); i++) add_outer(six.data(), f[i], x[i]);
  return six;
}

static void expect_near(const Symmetric &a, const Symmetric &b, double error)
{
  for (int k = 0; k < 6; k++) EXPECT_NEAR(a[k], b[k], error) << k;
}

// -P n on every face, a third to each node: -P in all directions, whatever the shape and place

TEST(MeanStress, UniformPressureFromOutside)
{
  Random random(3, 0, 0);
  const Mesh mesh = bumpy(2, random);
  const double P = 0.7, V = volume(mesh);
  Points f(mesh.nodes.size(), Vec3::Zero());
  for (const auto &face : mesh.faces)
    for (const int n : face)
      f[n] +=
          face_pressure_force(-P, mesh.nodes[face[0]], mesh.nodes[face[1]], mesh.nodes[face[2]]);
  const Symmetric s = mean_stress(virial_of(f, mesh.nodes).data(), NONE.data(), V);
  expect_near(s, {-P, -P, -P, 0.0, 0.0, 0.0}, 1e-12);

  // from inside it is what the body holds against it: the same with the other sign
  Symmetric within = {};
  add_pressure_virial(within.data(), P, V);
  expect_near(mean_stress(NONE.data(), within.data(), V), s, 1e-12);
}

// a box of height h between two plates with the force F: -F h / V in the direction of the plates

TEST(MeanStress, BoxBetweenPlates)
{
  const double a = 2.0, b = 3.0, h = 4.0, F = 0.9, V = a * b * h;
  const Mesh mesh = box(a, b, h);
  Points f;
  for (const Vec3 &x : mesh.nodes) f.emplace_back(0.0, 0.0, x[2] > 0.0 ? -0.25 * F : 0.25 * F);
  const Symmetric s = mean_stress(virial_of(f, mesh.nodes).data(), NONE.data(), V);
  expect_near(s, {0.0, 0.0, -F * h / V, 0.0, 0.0, 0.0}, 1e-14);
}

// shear: forces without a net torque have a symmetric stress; a torque leaves the symmetric part

TEST(MeanStress, ShearAndTorque)
{
  const double a = 2.0, t = 0.4;
  const Mesh mesh = box(a, a, a);
  Points shear, torque;
  for (const Vec3 &x : mesh.nodes) {
    const double up = x[2] > 0.0 ? 1.0 : -1.0, right = x[0] > 0.0 ? 1.0 : -1.0;
    shear.emplace_back(0.25 * t * a * a * Vec3(up, 0.0, right));
    torque.emplace_back(0.25 * t * a * a * Vec3(up, 0.0, -right));
  }
  const double V = a * a * a;
  expect_near(mean_stress(virial_of(shear, mesh.nodes).data(), NONE.data(), V),
              {0.0, 0.0, 0.0, 0.0, t, 0.0}, 1e-14);
  expect_near(mean_stress(virial_of(torque, mesh.nodes).data(), NONE.data(), V), NONE, 1e-14);
}

// the virial of a tension is that of its forces, face by face

TEST(MeanStress, VirialOfATension)
{
  Random random(8, 0, 0);
  const Mesh mesh = bumpy(1, random);
  const double T = 0.3;
  Points f(mesh.nodes.size(), Vec3::Zero());
  Symmetric six = {};
  for (const auto &face : mesh.faces) {
    const Vec3 &a = mesh.nodes[face[0]], &b = mesh.nodes[face[1]], &c = mesh.nodes[face[2]];
    const Vec3 S = face_area_vector(a, b, c);
    add_tension_virial(six.data(), T, S.norm(), S.normalized());
    const AreaGradient g = area_gradient(a, b, c);
    for (int k = 0; k < 3; k++) f[face[k]] -= T * g.by[k];
  }
  expect_near(six, virial_of(f, mesh.nodes), 1e-12);
  EXPECT_NEAR(six[0] + six[1] + six[2], -2.0 * T * area(mesh), 1e-12);
}

// a bubble in balance: its pressure p and tension T hold -(p - 2 T / R), the pressure from outside

TEST(MeanStress, Bubble)
{
  const double p = 0.4, T = 0.3, R = 4.0;
  double before = 0.0;
  for (int level = 1; level <= 3; level++) {
    const Mesh mesh = ball(level, R);
    Symmetric within = {};
    add_pressure_virial(within.data(), p, volume(mesh));
    for (const auto &f : mesh.faces) {
      const Vec3 S = face_area_vector(mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
      add_tension_virial(within.data(), T, S.norm(), S.normalized());
    }
    const Symmetric s = mean_stress(NONE.data(), within.data(), volume(mesh));
    const double outside = p - 2.0 * T / R, error = std::fabs(s[0] + outside);
    for (int k = 1; k < 3; k++) EXPECT_NEAR(s[k], s[0], 1e-12);
    for (int k = 3; k < 6; k++) EXPECT_NEAR(s[k], 0.0, 1e-12);
    if (level > 1) {
      EXPECT_NEAR(before / error, 4.0, 0.5);
    }
    before = error;
  }
}
