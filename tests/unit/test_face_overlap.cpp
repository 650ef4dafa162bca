// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Deepest overlap of two triangles along a direction, against cases known by hand and samples.

#include "law/face_overlap.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

namespace {

FaceGeometry face(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  return make_face(a, b, c, 10.0);
}

}    // namespace

TEST(FaceOverlap, FlatsThatShareACorner)
{
  // parallel, 0.3 behind each other, only the corners of both in front of each other
  const FaceGeometry f = face({0, 0, 0}, {2, 0, 0}, {0, 2, 0});
  const FaceGeometry g = face({0.4, 0.5, -0.3}, {0.4, 3.5, -0.3}, {3.4, 0.5, -0.3});
  FaceOverlap most;
  ASSERT_TRUE(face_overlap(f, g, Vec3::UnitZ(), most));
  EXPECT_NEAR(most.depth, 0.3, 1e-14);
  EXPECT_NEAR(most.on_f[2], 0.0, 1e-14);
  EXPECT_NEAR(most.on_g[2], -0.3, 1e-14);
  EXPECT_GE(overlap_bound(f, g, Vec3::UnitZ()), most.depth);
  const FaceGeometry beside = face({2.1, 2.1, -0.3}, {2.1, 3.5, -0.3}, {3.4, 2.1, -0.3});
  EXPECT_FALSE(face_overlap(f, beside, Vec3::UnitZ(), most));
}

TEST(FaceOverlap, TipOverAFlat)
{
  // a corner 0.2 deep, the middle in front of the flat
  const FaceGeometry f = face({0, 0, 0.2}, {1, -0.5, -0.7}, {1, 0.5, -0.7});
  const FaceGeometry g = face({-5, -5, 0}, {-5, 5, 0}, {5, 0, 0});
  EXPECT_LT(f.mid[2], 0.0);
  FaceOverlap most;
  ASSERT_TRUE(face_overlap(f, g, Vec3::UnitZ(), most));
  EXPECT_NEAR(most.depth, 0.2, 1e-13);
  EXPECT_LT((most.on_f - Vec3(0, 0, 0.2)).norm(), 1e-13);
  EXPECT_LT(most.on_g.norm(), 1e-13);
}

TEST(FaceOverlap, NoSampleIsDeeper)
{
  Random random(11, 0, 0);
  int met = 0;
  for (int trial = 0; trial < 200; trial++) {
    const Mat3 turn = random_rotation(random);
    auto corner = [&](double z) -> Vec3 {
      return turn * Vec3(2 * random.uniform(), 2 * random.uniform(), z + random.uniform());
    };
    const Vec3 u = turn.col(2);
    FaceGeometry f = face(corner(0), corner(0), corner(0));
    FaceGeometry g = face(corner(0.2), corner(0.2), corner(0.2));
    if (f.n.dot(u) < 0.0) f = face(f.x[0], f.x[2], f.x[1]);
    if (g.n.dot(u) > 0.0) g = face(g.x[0], g.x[2], g.x[1]);
    if (f.n.dot(u) < 0.1 || g.n.dot(u) > -0.1) continue;
    double deepest = -1e300;
    for (int i = 0; i <= 60; i++)
      for (int j = 0; i + j <= 60; j++) {
        const Vec3 p = f.x[0] + (i * (f.x[1] - f.x[0]) + j * (f.x[2] - f.x[0])) / 60.0;
        // along u to the plane of g, inside the triangle?
        const Vec3 q = p + u * (g.n.dot(g.mid - p) / g.n.dot(u));
        bool inside = true;
        for (int k = 0; k < 3; k++)
          inside = inside && (g.x[(k + 1) % 3] - g.x[k]).cross(q - g.x[k]).dot(g.n) >= 0.0;
        if (inside) deepest = std::max(deepest, (p - q).dot(u));
      }
    FaceOverlap most;
    if (!face_overlap(f, g, u, most)) {
      EXPECT_LT(deepest, -1e200);
      continue;
    }
    if (deepest < -1e200) continue;    // a common part between the samples
    met++;
    EXPECT_GE(most.depth, deepest - 1e-12);
    EXPECT_LE(most.depth, overlap_bound(f, g, u) + 1e-12);
    EXPECT_NEAR((most.on_f - most.on_g).dot(u), most.depth, 1e-12);
    EXPECT_LT((most.on_f - most.on_g).cross(u).norm(), 1e-12);
    EXPECT_NEAR(f.n.dot(most.on_f - f.mid), 0.0, 1e-11);
    EXPECT_NEAR(g.n.dot(most.on_g - g.mid), 0.0, 1e-11);
  }
  EXPECT_GT(met, 30);
}
