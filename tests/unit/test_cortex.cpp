// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Cortex springs and dashpots against lattice elasticity, an inflated sphere and creep.

#include "law/cortex.h"
#include "law/friction.h"
#include "law/mesh.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

namespace {

// energy per area of a sixfold lattice of edge length 1 under a uniform strain; one site owns
// three edges and the area sqrt(3)/2, and by symmetry no node moves beyond the uniform strain
double lattice_energy(double ks, double orientation, const Eigen::Matrix2d &strain)
{
  double u = 0.0;
  for (int k = 0; k < 3; k++) {
    const double phi = orientation + k * PI / 3.0;
    const Eigen::Vector2d e(std::cos(phi), std::sin(phi));
    u += cortex_energy(ks, (e + strain * e).norm(), 1.0);
  }
  return u / (0.5 * std::sqrt(3.0));
}

// force on node j of a dashpot between i (held) and j: the friction system of one edge
Vec3 dashpot_force(double gamma, const Vec3 &v, const Vec3 &e, bool projected)
{
  FrictionSystem system;
  system.nowned = system.nall = 2;
  system.ecm.assign(3, 0.0);
  if (projected)
    system.edges.push_back({1, 2, 0.0, gamma, {e[0], e[1], e[2]}});
  else
    system.iso_edges.push_back({1, 2, gamma});
  system.merge();
  double p[3 * STRIDE] = {}, y[3 * STRIDE];
  vec(p + 2 * STRIDE) = v;
  system.apply(p, y);
  return -vec(y + 2 * STRIDE);
}

struct Moduli {
  double area, shear;
};

// moduli of the lattice from second differences of its energy; both kinds of shear
Moduli lattice_moduli(double ks, double orientation)
{
  const double s = 1.0e-4;
  auto second = [&](const Eigen::Matrix2d &m) {
    return (lattice_energy(ks, orientation, s * m) + lattice_energy(ks, orientation, -s * m)) /
           (s * s);
  };
  Eigen::Matrix2d iso = Eigen::Matrix2d::Identity(), shear1, shear2;
  shear1 << 0.0, 0.5, 0.5, 0.0;
  shear2 << 0.5, 0.0, 0.0, -0.5;
  EXPECT_NEAR(second(shear1), second(shear2), 1.0e-6 * ks);    // isotropic
  return {second(iso) / 4.0, second(shear1)};
}

}    // namespace

TEST(Cortex, FlatSheetModuli)
{
  const double ks = 1.7;
  for (double orientation : {0.0, 0.3, PI / 6.0}) {
    const Moduli m = lattice_moduli(ks, orientation);
    EXPECT_NEAR(m.area, std::sqrt(3.0) / 2.0 * ks, 1.0e-6 * ks);
    EXPECT_NEAR(m.shear, std::sqrt(3.0) / 4.0 * ks, 1.0e-6 * ks);
    const double young = 4.0 * m.area * m.shear / (m.area + m.shear);
    const double poisson = (m.area - m.shear) / (m.area + m.shear);
    EXPECT_NEAR(young, 2.0 / std::sqrt(3.0) * ks, 1.0e-6 * ks);
    EXPECT_NEAR(poisson, 1.0 / 3.0, 1.0e-6);
  }
}

TEST(Cortex, StiffnessMatchesTheChosenModulus)
{
  const double E = 3.0, h = 0.4, nu = 0.5;
  const Moduli m = lattice_moduli(cortex_stiffness(E, h, CortexStiffness::AREA), 0.1);
  EXPECT_NEAR(m.area, E * h / (2.0 * (1.0 - nu)), 1.0e-5);
  const Moduli n = lattice_moduli(cortex_stiffness(E, h, CortexStiffness::YOUNG), 0.1);
  EXPECT_NEAR(4.0 * n.area * n.shear / (n.area + n.shear), E * h, 1.0e-5);
  // the source's spring is 4/3 too stiff for the Young modulus
  EXPECT_NEAR(cortex_stiffness(E, h, CortexStiffness::AREA) /
                  cortex_stiffness(E, h, CortexStiffness::YOUNG),
              4.0 / 3.0, 1.0e-14);
}

TEST(Cortex, ForceIsGradient)
{
  Random random(1, 0, 0);
  for (int trial = 0; trial < 20; trial++) {
    const Points x = {random.gaussian_vector(), random.gaussian_vector()};
    const double ks = 2.3, l0 = 0.2 + 2.0 * random.uniform();
    auto energy = [&](const Points &y) {
      return cortex_energy(ks, (y[1] - y[0]).norm(), l0);
    };
    const Vec3 f = cortex_force(ks, l0, x[1] - x[0]);
    EXPECT_LT(gradient_error({-f, f}, gradient(energy, x, 1.0e-5)), 1.0e-6);
    const Mat3 rotation = random_rotation(random);
    EXPECT_LT((cortex_force(ks, l0, rotation * (x[1] - x[0])) - rotation * f).norm(),
              1.0e-13 * f.norm());
  }
  // a stretched edge pulls j back to i
  EXPECT_DOUBLE_EQ(cortex_force(2.0, 1.0, Vec3(1.5, 0, 0))[0], -1.0);
  EXPECT_DOUBLE_EQ(cortex_tension(2.0, 1.5, 1.0), 1.0);
  EXPECT_EQ(cortex_force(2.0, 1.0, Vec3::Zero()), Vec3::Zero());
}

TEST(Cortex, InflatedIcosphere)
{
  // uniform inflation by eps; the pressure follows from virtual work, p dV = dU, and K_A from
  // p = 4 K_A eps / R. Both converge with the square of the edge: extrapolate from two levels.
  const double ks = 1.0, eps = 1.0e-6;
  double modulus[2];
  for (int level = 4; level <= 5; level++) {
    const Mesh mesh = icosphere(level);
    double work = 0.0;
    for (const auto &e : edges(mesh)) {
      const Vec3 r = mesh.nodes[e[1]] - mesh.nodes[e[0]];
      work -= cortex_force(ks, r.norm(), (1.0 + eps) * r).dot(r);
    }
    const double p = work / (3.0 * volume(mesh));
    modulus[level - 4] = p / (4.0 * eps) / ks;
  }
  EXPECT_NEAR((4.0 * modulus[1] - modulus[0]) / 3.0, 0.8756, 1.0e-4);
}

TEST(Cortex, TwoNodeCreep)
{
  // node i held, node j pulled along the edge: F = k x + gamma v at every moment
  const double ks = 2.0, gamma = 3.0, l0 = 1.0, pull = 0.3, dt = 0.01;
  const Vec3 e = Vec3(1.0, 2.0, -2.0) / 3.0;
  for (bool projected : {false, true}) {
    auto velocity = [&](double x) {
      // the dashpot force is linear in v: its value at unit speed is the friction coefficient
      const double friction = -dashpot_force(gamma, e, e, projected).dot(e);
      return (pull + cortex_force(ks, l0, (l0 + x) * e).dot(e)) / friction;
    };
    double x = 0.0;
    for (int step = 1; step <= 500; step++) {
      const double k1 = velocity(x), k2 = velocity(x + 0.5 * dt * k1);
      const double k3 = velocity(x + 0.5 * dt * k2), k4 = velocity(x + dt * k3);
      x += dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      const double t = step * dt;
      ASSERT_NEAR(x, pull / ks * (1.0 - std::exp(-ks * t / gamma)), 1.0e-10);
    }
  }
}

TEST(Cortex, DashpotAndRigidRotation)
{
  const Vec3 e(1.0, 0.0, 0.0), rotation(0.0, 0.7, 0.0), stretch(0.7, 0.0, 0.0);
  const double gamma = 2.0;
  EXPECT_EQ(dashpot_force(gamma, rotation, e, true), Vec3::Zero());
  EXPECT_EQ(dashpot_force(gamma, rotation, e, false), -gamma * rotation);
  EXPECT_EQ(dashpot_force(gamma, stretch, e, true), dashpot_force(gamma, stretch, e, false));
  // never adds energy
  Random random(2, 0, 0);
  for (int i = 0; i < 100; i++) {
    const Vec3 v = random.gaussian_vector(), u = random.unit_vector();
    EXPECT_LE(dashpot_force(gamma, v, u, true).dot(v), 0.0);
    EXPECT_LE(dashpot_force(gamma, v, u, false).dot(v), 0.0);
  }
}
