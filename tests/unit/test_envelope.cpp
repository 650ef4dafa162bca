// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Signed distance to an envelope against closed forms and brute force.

#include "law/envelope.h"
#include "bodies.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

TEST(Envelope, ClosedForms)
{
  const Envelope cube(box(1, 1, 1));
  const double s3 = std::sqrt(3.0), s2 = std::sqrt(2.0);
  EXPECT_NEAR(cube.nearest(Vec3(0.5, 0.5, 0.8)).distance, -0.2, 1.0e-15);
  EXPECT_NEAR(cube.nearest(Vec3(2, 2, 2)).distance, s3, 1.0e-15);
  EXPECT_NEAR(cube.nearest(Vec3(0.4, 2, -1)).distance, s2, 1.0e-15);
  EXPECT_LT((cube.nearest(Vec3(0.4, 2, -1)).point - Vec3(0.4, 1, 0)).norm(), 1.0e-15);
  EXPECT_EQ(cube.nearest(Vec3(1, 0.3, 0.3)).distance, 0.0);
  EXPECT_EQ(cube.nearest(Vec3(1, 1, 1)).distance, 0.0);

  Random random(73, 0, 0);
  const Mesh m = ball(3, 6.0);
  const Envelope sphere(m);
  const double sagitta = 0.5 * std::pow(mean_edge(m), 2) / 6.0;    // mesh below its sphere
  for (int i = 0; i < 300; i++) {
    const double r = 12.0 * random.uniform();
    const double d = sphere.nearest(r * random.unit_vector()).distance;
    EXPECT_GT(d, r - 6.0 - 1.0e-12);
    EXPECT_LT(d, r - 6.0 + sagitta);
  }
  EXPECT_THROW(Envelope{Mesh()}, std::invalid_argument);
}

TEST(Envelope, BruteForce)
{
  Random random(74, 0, 0);
  for (const Mesh &m : {icosphere(1), ball(3, 1), dented(3, 1), spiky(1), spiky(2), spiky(3)}) {
    const Envelope envelope(m);
    int inside = 0;
    for (int i = 0; i < 500; i++) {
      // everywhere, and close to nodes and edges, where the sign is delicate
      Vec3 x = 3.0 * random.uniform() * random.unit_vector();
      const auto &f = m.faces[size_t(random.uniform() * double(m.faces.size()))];
      if (i % 4 == 1) x = m.nodes[f[0]] + 0.05 * random.gaussian_vector();
      if (i % 4 == 2) x = 0.5 * (m.nodes[f[0]] + m.nodes[f[1]]) + 0.05 * random.gaussian_vector();
      const double target = brute_distance(m, x);
      const EnvelopePoint p = envelope.nearest(x);
      EXPECT_NEAR(p.distance, target, 1.0e-13);
      EXPECT_NEAR((x - p.point).norm(), std::fabs(target), 1.0e-13);
      const auto &g = m.faces[p.face];
      EXPECT_LT(triangle_distance(p.point, {m.nodes[g[0]], m.nodes[g[1]], m.nodes[g[2]]}), 1.0e-13);
      // no hint, however wrong, changes the answer
      const int hint = int(random.uniform() * 1.1 * double(m.faces.size()));
      EXPECT_NEAR(envelope.nearest(x, hint).distance, target, 1.0e-13);
      EXPECT_NEAR(envelope.nearest(x, p.face).distance, target, 1.0e-13);
      inside += target < 0.0;
    }
    EXPECT_GT(inside, 50);
    EXPECT_LT(inside, 450);
  }
}
