// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// A cell between walls: its energy against finite differences and closed forms.

#include "law/confined_cell.h"
#include "bodies.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

TEST(ConfinedCell, GradientOfTheEnergy)
{
  Random random(75, 0, 0);
  const Mesh mother = dented(2, 6.0);
  const Envelope envelope(mother);
  const Mesh round = icosphere(1);
  const DivisionPlane plane = halving_plane(mother, Vec3(2, -1, 0.3));
  const double V = 0.5 * volume(mother);
  ConfinedCell cell(envelope, plane, round, HEPATOBLAST, V, 0.9);
  cell.V0 = 1.1 * V;
  // a rough ball, partly behind the plane and partly behind the envelope
  const Vec3 center = plane.point + 2.5 * plane.normal;
  Points x;
  for (const Vec3 &e : round.nodes) x.push_back(center + 5.0 * e + 0.2 * random.gaussian_vector());
  auto flat = [](const Points &p) {
    Eigen::VectorXd v(3 * p.size());
    for (size_t i = 0; i < p.size(); i++) vec(&v[3 * i]) = p[i];
    return v;
  };
  Eigen::VectorXd g;
  int behind[2] = {0, 0};
  for (size_t i = 0; i < x.size(); i++) {
    const auto depth = cell.depths(flat(x), int(i));
    for (int k : {0, 1}) behind[k] += depth[k] > 0.0;
  }
  EXPECT_GT(behind[0], 5);
  EXPECT_GT(behind[1], 5);
  const Points numeric = gradient(
      [&](const Points &p) {
        return cell.energy(flat(p), g);
      },
      x, 1e-5);
  cell.energy(flat(x), g);
  Points force;
  for (size_t i = 0; i < x.size(); i++) force.push_back(-vec(&g[3 * i]));
  EXPECT_LT(gradient_error(force, numeric), 1.0e-6);

  // inside out: not finite numbers but an energy no line search accepts
  for (Vec3 &p : x) p = 2.0 * center - p;
  EXPECT_EQ(cell.energy(flat(x), g), std::numeric_limits<double>::infinity());
  EXPECT_EQ(g.norm(), 0.0);
}

TEST(ConfinedCell, AtRestWallsAreAllThereIs)
{
  // the round rest shape, its lowest nodes behind the plane: energy and forces of springs
  const Mesh room = ball(1, 100.0), round = icosphere(2);
  const Envelope envelope(room);
  const double r = 4.0, V = ball_volume(r), scale = std::cbrt(V / volume(round));
  const Vec3 n = Vec3(1, -2, 2) / 3.0;
  const DivisionPlane plane = {Vec3(1, 2, 3), n};
  ConfinedCell cell(envelope, plane, round, HEPATOBLAST, V, 1.0);
  Eigen::VectorXd x(3 * round.nodes.size()), g;
  for (size_t i = 0; i < round.nodes.size(); i++)
    vec(&x[3 * i]) = plane.point + 3.5 * n + scale * round.nodes[i];
  EXPECT_NEAR(cell.enclosed(x), V, 1.0e-12 * V);
  EXPECT_NEAR(cell.radius(), r, 1.0e-14 * r);

  Points force(round.nodes.size(), Vec3::Zero());
  std::vector<double> share(round.nodes.size(), 0.0);
  for (const auto &f : round.faces)
    for (int i : f)
      share[i] += scale * scale / 6.0 *
                  (round.nodes[f[1]] - round.nodes[f[0]])
                      .cross(round.nodes[f[2]] - round.nodes[f[0]])
                      .norm();
  double energy = 0.0, total = 0.0;
  int behind = 0;
  for (size_t i = 0; i < share.size(); i++) {
    const double depth = -3.5 - scale * n.dot(round.nodes[i]);
    EXPECT_NEAR(cell.depths(x, int(i))[0], depth, 1.0e-13);
    total += share[i];
    if (depth <= 0.0) continue;
    behind++;
    energy += 0.5 * division_wall(HEPATOBLAST.ks, V) * share[i] * depth * depth;
    force[i] = division_wall(HEPATOBLAST.ks, V) * share[i] * depth * n;
  }
  EXPECT_GT(behind, 3);
  EXPECT_NEAR(cell.energy(x, g), energy, 1.0e-11 * energy);
  for (size_t i = 0; i < share.size(); i++)
    EXPECT_LT((vec(&g[3 * i]) + force[i]).norm(), 1.0e-11 * largest(force));
  // pressure ks/r on the mean share of a node
  EXPECT_NEAR(cell.force_scale() * double(share.size()), HEPATOBLAST.ks / r * total, 1.0e-11);
}

TEST(ConfinedCell, WallBearsThePressureOfTheCortex)
{
  for (double r : {2.0, 6.0}) {
    const double pressure = division_wall(3.0, ball_volume(r)) * DIVISION_WALL * r;
    EXPECT_NEAR(pressure, 3.0 / r, 1.0e-13);
  }
}
