// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Regions of a surface by cones, the ribbon of tight junctions, and the vectors of polarity.

#include "law/mesh.h"
#include "law/polarity.h"
#include "law/volume.h"
#include "helpers.h"

#include <algorithm>
#include <numeric>
#include <set>

using namespace dcm;
using namespace dcm_test;

namespace {

Vec3 middle(const Mesh &mesh, const std::array<int, 3> &f)
{
  return (mesh.nodes[f[0]] + mesh.nodes[f[1]] + mesh.nodes[f[2]]) / 3.0;
}

double face_area(const Mesh &mesh, const std::array<int, 3> &f)
{
  return face_area_vector(mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]).norm();
}

/// Region of each face of a mesh around the origin.
std::vector<int> regions(const Mesh &mesh, const SurfaceCones &cones, const Vec3 &A, const Vec3 &P)
{
  std::vector<int> all;
  for (const auto &f : mesh.faces)
    all.push_back(cones.region(A, P, direction(middle(mesh, f))));
  return all;
}

/// Share of the surface in a region.
double share(const Mesh &mesh, const std::vector<int> &region, int which)
{
  double sum = 0.0;
  for (size_t f = 0; f < mesh.faces.size(); f++)
    if (region[f] == which) sum += face_area(mesh, mesh.faces[f]);
  return sum / area(mesh);
}

/// Apical vector and one perpendicular to it, at random.
std::pair<Vec3, Vec3> vectors(Random &random)
{
  const Vec3 A = random.unit_vector();
  return {A, polar_vector(random.unit_vector(), A, -1)};
}

SurfaceCones only(double polar, double apical, double basal)
{
  SurfaceCones cones;
  cones.polar = polar;
  cones.apical = apical;
  cones.basal = basal;
  return cones;
}

/// A cap, belt or ribbon is cut out along faces: its border is uncertain by half a row of faces,
/// all to the same side at the worst.
double border(const Mesh &mesh, double cosine)
{
  return 0.5 * std::sin(std::acos(cosine)) * 0.87 * mean_edge(mesh);
}

/// Faces that share a node (or an edge: two nodes) with one of `from`.
std::set<int> around(const Mesh &mesh, const std::set<int> &from, int shared)
{
  std::set<int> found;
  for (size_t f = 0; f < mesh.faces.size(); f++)
    for (const int g : from) {
      int same = 0;
      for (const int v : mesh.faces[f])
        same += std::count(mesh.faces[g].begin(), mesh.faces[g].end(), v) > 0;
      if (same >= shared) found.insert((int) f);
    }
  return found;
}

std::set<int> faces_in(const std::vector<int> &region, int which)
{
  std::set<int> found;
  for (size_t f = 0; f < region.size(); f++)
    if (region[f] == which) found.insert((int) f);
  return found;
}

}    // namespace

TEST(Polarity, SharesOfARoundCell)
{
  // the area of a zone of a sphere goes with its height: 1 - a for two cones, a for the belt,
  // (1 - b)/2 for a cap, (hi - lo)/2 for a ribbon; error O(edge)
  Random random(31, 0, 0);
  for (int level : {2, 3, 4}) {
    const Mesh mesh = icosphere(level);
    for (int n = 0; n < 5; n++) {
      const auto [A, P] = vectors(random);
      SurfaceCones cones = only(0.7, NO_REGION, NO_REGION);
      const double edge = 2.0 * border(mesh, 0.7) / 2.0;
      EXPECT_NEAR(share(mesh, regions(mesh, cones, A, P), POLAR), 0.3, 2.0 * edge) << level;
      cones.belt = true;
      EXPECT_NEAR(share(mesh, regions(mesh, cones, A, P), POLAR), 0.7, 2.0 * edge) << level;
      const auto caps = regions(mesh, only(NO_REGION, 0.6, 0.8), A, P);
      EXPECT_NEAR(share(mesh, caps, APICAL), 0.2, border(mesh, 0.6)) << level;
      EXPECT_NEAR(share(mesh, caps, BASAL), 0.1, border(mesh, 0.8)) << level;
      cones = only(NO_REGION, 0.6, NO_REGION);
      cones.low = 0.1;
      cones.high = 0.6;
      EXPECT_NEAR(share(mesh, regions(mesh, cones, A, P), JUNCTION), 0.25,
                  border(mesh, 0.1) + border(mesh, 0.6))
          << level;
    }
  }
}

TEST(Polarity, SharesConverge)
{
  // averaged over directions, the error falls with the mesh: faces are cut at random
  Random random(32, 0, 0);
  double error[3];
  for (int level = 2; level <= 4; level++) {
    const Mesh mesh = icosphere(level);
    double sum = 0.0;
    for (int n = 0; n < 40; n++) {
      const auto [A, P] = vectors(random);
      sum += std::fabs(share(mesh, regions(mesh, only(0.7, 0.5, 0.5), A, P), APICAL) - 0.25);
    }
    error[level - 2] = sum / 40.0;
  }
  EXPECT_LT(error[2], 0.5 * error[1]);
  EXPECT_LT(error[1], 0.6 * error[0]);
}

TEST(Polarity, FirstThatFits)
{
  SurfaceCones cones = only(0.5, 0.6, 0.6);
  cones.low = 0.3;
  cones.high = 0.7;
  const Vec3 A = Vec3::UnitZ(), P = Vec3::UnitX();
  auto at = [&](double height, double along) {
    return cones.region(A, P,
                        Vec3(along, std::sqrt(1.0 - height * height - along * along), height));
  };
  EXPECT_EQ(at(0.65, 0.0), JUNCTION);    // apical as well
  EXPECT_EQ(at(0.4, 0.9), JUNCTION);     // polar as well
  EXPECT_EQ(at(0.75, 0.6), APICAL);      // polar as well
  EXPECT_EQ(at(-0.65, 0.6), POLAR);      // basal as well
  EXPECT_EQ(at(-0.65, -0.6), POLAR);
  EXPECT_EQ(at(-0.65, 0.1), BASAL);
  EXPECT_EQ(at(0.0, 0.1), LATERAL);
  cones.belt = true;
  EXPECT_EQ(at(0.0, 0.1), POLAR);
  EXPECT_EQ(at(0.0, 0.6), LATERAL);
  EXPECT_EQ(at(-0.65, 0.6), BASAL);
}

TEST(Polarity, OffIsOff)
{
  // without a ribbon and a basal side: A.N never reaches their cosines, round-off included
  SurfaceCones cones;
  cones.basal = NO_REGION;
  EXPECT_EQ(cones.region(Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitZ()), APICAL);
  EXPECT_EQ(cones.region(Vec3::UnitZ(), Vec3::UnitX(), -Vec3::UnitZ()), LATERAL);
}

TEST(Polarity, RibbonIsOneToTwoFacesThick)
{
  // on 162, 642 and 2562 nodes, in any direction: the cap and what lies below the ribbon have no
  // edge in common, and two steps over nodes lead through the ribbon everywhere
  Random random(33, 0, 0);
  for (int level : {2, 3, 4}) {
    const Mesh mesh = icosphere(level);
    const double R = ball_radius(volume(mesh));
    const double edge = equal_edge(area(mesh), (int) mesh.faces.size());
    EXPECT_NEAR(edge / mean_edge(mesh), 1.0, 0.02);
    for (int n = 0; n < (level == 4 ? 2 : 6); n++) {
      const auto [A, P] = vectors(random);
      for (const double b : {0.5, 0.7, 0.87}) {
        SurfaceCones cones = only(NO_REGION, b, NO_REGION);
        cones.high = b;
        cones.low = ribbon_low(b, edge, R);
        const auto region = regions(mesh, cones, A, P);
        const auto cap = faces_in(region, APICAL), ribbon = faces_in(region, JUNCTION);
        for (const int f : around(mesh, cap, 2)) EXPECT_NE(region[f], LATERAL) << level << " " << b;
        const auto near = around(mesh, around(mesh, cap, 1), 1);
        size_t reached = 0;
        for (const int f : ribbon) reached += near.count(f);
        EXPECT_EQ(reached, ribbon.size()) << level << " " << b;

        // thickness by area, in rows of faces of 0.866 edges, on the middle of the ribbon
        const double middle_angle = 0.5 * (std::acos(cones.low) + std::acos(b));
        const double length = 2.0 * PI * R * std::sin(middle_angle);
        const double rows =
            share(mesh, region, JUNCTION) * area(mesh) / length / (0.5 * std::sqrt(3.0) * edge);
        EXPECT_GT(rows, 1.0) << level << " " << b;
        EXPECT_LT(rows, 2.0) << level << " " << b;
      }
    }
  }
}

TEST(Polarity, RibbonWidth)
{
  for (const double b : {0.2, 0.7, 0.95}) {
    const double low = ribbon_low(b, 0.5, 6.0);
    EXPECT_NEAR(ribbon_width(low, b, 6.0), RIBBON_EDGES * 0.5, 1.0e-13) << b;
  }
  EXPECT_EQ(ribbon_low(0.1, 10.0, 1.0), -1.0);    // a cell of a few faces: down to the other pole
}

TEST(Polarity, PerpendicularToRoundOff)
{
  Random random(34, 0, 0);
  for (int n = 0; n < 100000; n++) {
    const Vec3 A = random.unit_vector();
    Vec3 P = random.unit_vector();
    if (n % 2) P = direction(A + 1.0e-4 * polar_vector(P, A, -1));    // nearly parallel
    const Vec3 now = polar_vector(P, A, -1);
    ASSERT_NEAR(now.norm(), 1.0, 1.0e-15);
    ASSERT_LT(std::fabs(now.dot(A)), 1.0e-15);
    ASSERT_GT(now.dot(P), 0.0);
  }
  EXPECT_EQ(polar_vector(Vec3::UnitX(), Vec3::UnitX(), -1), Vec3(Vec3::Zero()));
  EXPECT_EQ(polar_vector(Vec3::Zero(), Vec3::UnitX(), -1), Vec3(Vec3::Zero()));
}

TEST(Polarity, Plane)
{
  Random random(35, 0, 0);
  for (int axis = 0; axis < 3; axis++)
    for (int n = 0; n < 1000; n++) {
      const Vec3 A = direction(in_plane(random.unit_vector(), axis)), old = random.unit_vector();
      const Vec3 P = polar_vector(old, A, axis);
      EXPECT_EQ(A[axis], 0.0);
      EXPECT_EQ(P[axis], 0.0);
      EXPECT_LT(std::fabs(P.dot(A)), 1.0e-16);    // fused multiply-add leaves a rounding
      EXPECT_NEAR(P.norm(), 1.0, 1.0e-15);
      EXPECT_GE(P.dot(old), 0.0);
    }
  EXPECT_EQ(in_plane(Vec3(1, 2, 3), -1), Vec3(1, 2, 3));
}

TEST(Polarity, SumOfFreeFacesOfACap)
{
  // all faces with N.e > c of a sphere: the sum points along e, with (1 - c^2)/4 per face there is
  const Mesh mesh = icosphere(4);
  Random random(36, 0, 0);
  for (const double c : {-0.5, 0.0, 0.6}) {
    const Vec3 e = random.unit_vector();
    VectorSum sum;
    for (const auto &f : mesh.faces) {
      const Vec3 N = direction(middle(mesh, f));
      if (N.dot(e) > c) sum.add(N);
    }
    const Vec3 A = direction(sum.value());
    EXPECT_GT(A.dot(e), std::cos(0.02)) << c;
    EXPECT_NEAR(sum.value().norm() / mesh.faces.size(), 0.25 * (1.0 - c * c), 0.02) << c;
  }
  VectorSum all;    // free all around: no direction
  for (const auto &f : mesh.faces) all.add(direction(middle(mesh, f)));
  EXPECT_LT(all.value().norm(), 1.0e-5);
  EXPECT_EQ(direction(all.value(), 0.5), Vec3(Vec3::Zero()));
}

TEST(Polarity, NoOrderOfFaces)
{
  const Mesh mesh = icosphere(3);
  Random random(37, 0, 0);
  const Vec3 e = random.unit_vector();
  std::vector<Vec3> N;
  for (const auto &f : mesh.faces)
    if (middle(mesh, f).dot(e) > 0.3) N.push_back(direction(middle(mesh, f)));
  VectorSum forward, backward;
  for (const Vec3 &v : N) forward.add(v);
  std::reverse(N.begin(), N.end());
  for (const Vec3 &v : N) backward.add(v);
  for (int k = 0; k < 3; k++) EXPECT_EQ(forward.sum[k], backward.sum[k]);
  Vec3 plain = Vec3::Zero();
  for (const Vec3 &v : N) plain += v;
  // each of the vectors is rounded by half a unit at most
  EXPECT_LT((forward.value() - plain).norm(), 0.5 * std::sqrt(3.0) * VectorSum::UNIT * N.size());
}

TEST(Polarity, InvariantUnderRotation)
{
  Random random(38, 0, 0);
  Mesh mesh = icosphere(2);
  const auto [A, P] = vectors(random);
  SurfaceCones cones;
  cones.low = 0.2;
  cones.high = 0.5;
  const auto before = regions(mesh, cones, A, P);
  VectorSum sum;
  for (size_t f = 0; f < mesh.faces.size(); f++)
    if (before[f] == APICAL) sum.add(direction(middle(mesh, mesh.faces[f])));
  const Mat3 turn = random_rotation(random);
  for (Vec3 &x : mesh.nodes) x = turn * x;
  EXPECT_EQ(regions(mesh, cones, turn * A, turn * P), before);
  VectorSum turned;
  for (size_t f = 0; f < mesh.faces.size(); f++)
    if (before[f] == APICAL) turned.add(direction(middle(mesh, mesh.faces[f])));
  EXPECT_LT((direction(turned.value()) - turn * direction(sum.value())).norm(), 1.0e-8);
}

TEST(Polarity, InvariantUnderNumbering)
{
  Random random(39, 0, 0);
  Mesh mesh = icosphere(2);
  const auto [A, P] = vectors(random);
  const SurfaceCones cones;
  const auto before = regions(mesh, cones, A, P);
  for (auto &f : mesh.faces) std::rotate(f.begin(), f.begin() + 1, f.end());
  EXPECT_EQ(regions(mesh, cones, A, P), before);
  std::reverse(mesh.faces.begin(), mesh.faces.end());
  auto after = regions(mesh, cones, A, P);
  std::reverse(after.begin(), after.end());
  EXPECT_EQ(after, before);
}
