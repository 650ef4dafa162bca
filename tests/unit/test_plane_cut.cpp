// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Plane cuts against closed forms: halves, their centroids, long axes and frames.

#include "law/plane_cut.h"
#include "bodies.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

namespace {

DivisionPlane flipped(const DivisionPlane &p)
{
  return {p.point, -p.normal};
}

}    // namespace

TEST(PlaneCut, CutsOfABox)
{
  const Mesh cube = box(1, 1, 1);
  Half h = positive_half(cube, {Vec3(0.3, 9, 9), Vec3::UnitX()});
  EXPECT_NEAR(h.volume, 0.7, 1.0e-14);
  EXPECT_LT((h.centroid - Vec3(0.65, 0.5, 0.5)).norm(), 1.0e-14);
  // a corner: tetrahedron of volume 1/48 with its centroid at 1/8 on each axis
  h = positive_half(cube, {Vec3(0.5, 0, 0), -Vec3(1, 1, 1).normalized()});
  EXPECT_NEAR(h.volume, 1.0 / 48.0, 1.0e-15);
  EXPECT_LT((h.centroid - Vec3::Constant(0.125)).norm(), 1.0e-14);
  // beside the body, and through a face of it
  EXPECT_EQ(positive_half(cube, {Vec3(2, 0, 0), Vec3::UnitX()}).volume, 0.0);
  EXPECT_NEAR(positive_half(cube, {Vec3(-1, 0, 0), Vec3::UnitX()}).volume, 1.0, 1.0e-15);
  EXPECT_NEAR(positive_half(cube, {Vec3(0, 0, 0), Vec3::UnitX()}).volume, 1.0, 1.0e-15);
}

TEST(PlaneCut, HalvesInClosedForm)
{
  EXPECT_NEAR(halving_plane(box(3, 2, 1), Vec3(0, 5, 0)).point[1], 1.0, 1.0e-13);
  // above height z of a unit tetrahedron lies (1 - z)^3 of it: its centroid (1/4) does not halve it
  Mesh tetrahedron;
  tetrahedron.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_NEAR(halving_plane(tetrahedron, Vec3::UnitZ()).point[2], 1.0 - std::cbrt(0.5), 1.0e-13);
  EXPECT_THROW(halving_plane(tetrahedron, Vec3::Zero()), std::invalid_argument);
  EXPECT_THROW(halving_plane(Mesh(), Vec3::UnitX()), std::invalid_argument);
}

TEST(PlaneCut, HalvesAnyBody)
{
  Random random(71, 0, 0);
  for (const Mesh &body :
       {icosphere(2), ellipsoid(3, 3, 1, 2), box(1, 2, 5), dented(3, 6), spiky(2)})
    for (int i = 0; i < 5; i++) {
      const Mat3 R = random_rotation(random);
      const Vec3 shift = 100.0 * random.gaussian_vector();
      const Mesh m = mapped(body, [&](const Vec3 &x) {
        return Vec3(R * x + shift);
      });
      const DivisionPlane p = halving_plane(m, 3.0 * random.unit_vector());
      EXPECT_NEAR(p.normal.norm(), 1.0, 1.0e-15);
      const Half a = positive_half(m, p), b = positive_half(m, flipped(p));
      const double V = volume(m);
      EXPECT_NEAR(a.volume, b.volume, 1.0e-10 * V);
      EXPECT_NEAR(a.volume + b.volume, V, 1.0e-12 * V);
      // the plane moves with the body
      const DivisionPlane q = halving_plane(body, R.transpose() * p.normal);
      EXPECT_NEAR(p.normal.dot(R * q.point + shift - p.point), 0.0, 1.0e-9);
    }
}

TEST(PlaneCut, CentroidOfHalfABall)
{
  double last = 1.0;
  for (int level = 1; level <= 4; level++) {
    const Mesh m = ball(level, 4.0);
    const DivisionPlane p = halving_plane(m, Vec3(1, 2, 3));
    const Half h = positive_half(m, p);
    const double error = (h.centroid - 1.5 * p.normal).norm() / 1.5;
    EXPECT_LT(error, 0.5 * std::pow(mean_edge(m) / 4.0, 2));
    EXPECT_LT(error, 0.4 * last);    // second order in the edge
    last = error;
  }
}

TEST(PlaneCut, LongAxis)
{
  Random random(72, 0, 0);
  const Mesh body = ellipsoid(2, 1, 1.5, 3);
  for (int i = 0; i < 20; i++) {
    const Mat3 R = random_rotation(random);
    const Vec3 shift = 10.0 * random.gaussian_vector();
    Mesh m = mapped(body, [&](const Vec3 &x) {
      return Vec3(R * x + shift);
    });
    const Vec3 axis = long_axis(m);
    EXPECT_NEAR(axis.norm(), 1.0, 1.0e-14);
    EXPECT_NEAR(std::fabs(axis.dot(R.col(2))), 1.0, 1.0e-12);
    int largest;
    axis.cwiseAbs().maxCoeff(&largest);
    EXPECT_GT(axis[largest], 0.0);
    // numbering of nodes and faces
    const int n = int(m.nodes.size());
    std::reverse(m.nodes.begin(), m.nodes.end());
    for (auto &f : m.faces) f = {n - 1 - f[1], n - 1 - f[2], n - 1 - f[0]};
    std::reverse(m.faces.begin(), m.faces.end());
    EXPECT_LT((long_axis(m) - axis).norm(), 1.0e-10);
  }
  // of the volume, not of the nodes: a box with all its mesh in one corner would mislead those
  EXPECT_LT((long_axis(box(1, 3, 2)) - Vec3::UnitY()).norm(), 1.0e-12);
}

TEST(PlaneCut, SecondMomentOfABox)
{
  const double a = 1.0, b = 2.0, c = 3.0, V = a * b * c;
  const Mesh m = mapped(box(a, b, c), [](const Vec3 &x) {
    return Vec3(x + Vec3(30, -20, 10));
  });
  const Mat3 target = V / 12.0 * Vec3(a * a, b * b, c * c).asDiagonal().toDenseMatrix();
  EXPECT_LT((second_moment(m) - target).norm(), 1.0e-11 * target.norm());
}

TEST(PlaneCut, FrameFollowsTheBody)
{
  Random random(78, 0, 0);
  const Mesh body = box(1, 2, 5);
  for (int i = 0; i < 20; i++) {
    const Mat3 R = random_rotation(random);
    const Mesh m = mapped(body, [&](const Vec3 &x) {
      return Vec3(R * x);
    });
    // across x the box is longest along z, across z along y
    for (const auto &axes : {std::array<int, 2>{0, 2}, std::array<int, 2>{2, 1}}) {
      const Mat3 frame = plane_frame(m, R.col(axes[0]));
      EXPECT_LT((frame.col(2) - R.col(axes[0])).norm(), 1.0e-12);
      EXPECT_NEAR(std::fabs(frame.col(0).dot(R.col(axes[1]))), 1.0, 1.0e-12);
      EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).norm(), 1.0e-12);
      EXPECT_NEAR(frame.determinant(), 1.0, 1.0e-12);
    }
  }
  // as long in all directions of the plane: next to the coordinate axis closest to it
  const Mat3 frame = plane_frame(box(2, 2, 2), Vec3(0.6, 0.0, 0.8));
  EXPECT_LT((frame.col(0) - Vec3::UnitY()).norm(), 1.0e-12);
}
