// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Loads per area on triangles: closed forms, balance, and the gradient of the volume.

#include "law/mesh.h"
#include "law/traction.h"
#include "law/volume.h"
#include "bodies.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

namespace {

Points forces(double P, const Vec3 &t, const Mesh &mesh)
{
  Points force(mesh.nodes.size(), Vec3::Zero());
  for (const auto &f : mesh.faces) {
    const FaceLoad load = face_load(P, t, mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
    for (int i : f) force[i] += load.third;
  }
  return force;
}

}    // namespace

TEST(Traction, ATriangle)
{
  const Vec3 a(0, 0, 2), b(3, 0, 2), c(0, 4, 2);    // area 6, normal z
  FaceLoad load = face_load(0.5, Vec3::Zero(), a, b, c);
  EXPECT_DOUBLE_EQ(load.area, 6.0);
  EXPECT_LT((load.third - Vec3(0, 0, -1)).norm(), 1.0e-15);    // pushes against the normal
  load = face_load(-0.5, Vec3::Zero(), a, b, c);
  EXPECT_LT((load.third - Vec3(0, 0, 1)).norm(), 1.0e-15);    // suction pulls
  load = face_load(0.0, Vec3(1, -2, 3), a, b, c);
  EXPECT_LT((load.third - Vec3(2, -4, 6)).norm(), 1.0e-14);
  load = face_load(0.0, Vec3(1, -2, 3), a, c, b);    // does not turn with the face
  EXPECT_LT((load.third - Vec3(2, -4, 6)).norm(), 1.0e-14);
  load = face_load(0.5, Vec3(1, -2, 3), a, b, c);
  EXPECT_LT((load.third - Vec3(2, -4, 5)).norm(), 1.0e-14);
}

TEST(Traction, ATriangleWithoutArea)
{
  const Vec3 a(0, 0, 2), b(3, 0, 2);
  for (const Vec3 &c : {a, b, Vec3(0.5 * (a + b))}) {
    const FaceLoad load = face_load(2.0, Vec3(1, 2, 3), a, b, c);
    EXPECT_EQ(load.area, 0.0);
    EXPECT_EQ(load.third.norm(), 0.0);
  }
}

TEST(Traction, PressureIsMinusTheGradientOfPV)
{
  Random random(11, 0, 0);
  const Mesh mesh = bumpy(1, random);
  const double P = 0.7;
  const auto energy = [&](const Points &x) {
    double v = 0.0;
    for (const auto &f : mesh.faces) v += face_volume(x[f[0]], x[f[1]], x[f[2]]);
    return P * v;
  };
  const Points f = forces(P, Vec3::Zero(), mesh);
  EXPECT_LT(gradient_error(f, gradient(energy, mesh.nodes, 1.0e-5)), 1.0e-9);
}

TEST(Traction, PressureOnAClosedSurfaceBalances)
{
  Random random(12, 0, 0);
  const Mesh mesh = bumpy(2, random);
  const Points f = forces(0.7, Vec3::Zero(), mesh);
  EXPECT_LT(net_force(f), 1.0e-13 * double(f.size()));
  EXPECT_LT(net_torque(mesh.nodes, f), 1.0e-13 * double(f.size()));
}

TEST(Traction, PressureOnAHalfPushesAsOnItsRim)
{
  // the faces of one half, whatever their shape, bear P times the area vector of the opening
  Mesh mesh = icosphere(3);
  const double P = 0.7;
  Vec3 sum = Vec3::Zero(), opening = Vec3::Zero();
  for (const auto &f : mesh.faces) {
    const Vec3 &a = mesh.nodes[f[0]], &b = mesh.nodes[f[1]], &c = mesh.nodes[f[2]];
    const FaceLoad load = face_load(P, Vec3::Zero(), a, b, c);
    ((a + b + c)[2] > 0.0 ? sum : opening) += 3.0 * load.third;
  }
  EXPECT_LT((sum + opening).norm(), 1.0e-13);
  EXPECT_NEAR(sum[2], -P * PI, 0.03 * P * PI);    // a disk of radius 1, of chords
}

TEST(Traction, AVectorGivesForceTimesAreaAtTheCentroid)
{
  Random random(13, 0, 0);
  const Mesh mesh = bumpy(1, random);
  const Vec3 t(0.3, -0.2, 0.9);
  const Points f = forces(0.0, t, mesh);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero(), moment = Vec3::Zero();
  for (size_t i = 0; i < f.size(); i++) {
    force += f[i];
    torque += mesh.nodes[i].cross(f[i]);
  }
  for (const auto &face : mesh.faces) {
    const Vec3 &a = mesh.nodes[face[0]], &b = mesh.nodes[face[1]], &c = mesh.nodes[face[2]];
    moment += 0.5 * (b - a).cross(c - a).norm() * (a + b + c) / 3.0;
  }
  EXPECT_LT((force - area(mesh) * t).norm(), 1.0e-13 * area(mesh));
  EXPECT_LT((torque - moment.cross(t)).norm(), 1.0e-12);
}
