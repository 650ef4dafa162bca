// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Surface tension: gradient and balance, closed forms, and a stiffness that bounds the energy.

#include "law/tension.h"
#include "law/mesh.h"
#include "law/stiffness.h"
#include "law/volume.h"
#include "bodies.h"
#include "helpers.h"

#include <Eigen/Dense>

#include <limits>

using namespace dcm;
using namespace dcm_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// of any shape but slivers
Points random_triangle(Random &random)
{
  for (;;) {
    Points x;
    for (int k = 0; k < 3; k++) x.push_back(random.gaussian_vector());
    if (face_quality(x[0], x[1], x[2]) > 0.2) return x;
  }
}

double area_of(const Points &x)
{
  return 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
}

Points force_of(double T, const Points &x)
{
  const AreaGradient g = area_gradient(x[0], x[1], x[2]);
  return {-T * g.by[0], -T * g.by[1], -T * g.by[2]};
}

Points force_of(double T, const Mesh &mesh)
{
  Points f(mesh.nodes.size(), Vec3::Zero());
  for (const auto &face : mesh.faces) {
    const AreaGradient g =
        area_gradient(mesh.nodes[face[0]], mesh.nodes[face[1]], mesh.nodes[face[2]]);
    for (int k = 0; k < 3; k++) f[face[k]] -= T * g.by[k];
  }
  return f;
}

// sides opposite the corners, as the law numbers them
constexpr int FROM[3] = {1, 2, 0}, TO[3] = {2, 0, 1};

void add_edge(MatrixXd &K, int i, int j, double iso)
{
  const Mat3 block = iso * Mat3::Identity();
  K.block<3, 3>(3 * i, 3 * i) += block;
  K.block<3, 3>(3 * j, 3 * j) += block;
  K.block<3, 3>(3 * i, 3 * j) -= block;
  K.block<3, 3>(3 * j, 3 * i) -= block;
}

MatrixXd stiffness_of(double T, const Points &x)
{
  MatrixXd K = MatrixXd::Zero(9, 9);
  const auto iso = tension_stiffness(T, x[0], x[1], x[2]);
  for (int k = 0; k < 3; k++) add_edge(K, FROM[k], TO[k], iso[k]);
  return K;
}

MatrixXd stiffness_of(double T, const Mesh &mesh)
{
  const int n = int(mesh.nodes.size());
  MatrixXd K = MatrixXd::Zero(3 * n, 3 * n);
  for (const auto &face : mesh.faces) {
    const auto iso =
        tension_stiffness(T, mesh.nodes[face[0]], mesh.nodes[face[1]], mesh.nodes[face[2]]);
    for (int k = 0; k < 3; k++) add_edge(K, face[FROM[k]], face[TO[k]], iso[k]);
  }
  return K;
}

// -dF/dx by central differences
MatrixXd hessian_of(double T, Points x, double h)
{
  MatrixXd H(9, 9);
  for (int i = 0; i < 3; i++)
    for (int d = 0; d < 3; d++) {
      const double x0 = x[i][d];
      x[i][d] = x0 + h;
      const Points up = force_of(T, x);
      x[i][d] = x0 - h;
      const Points down = force_of(T, x);
      x[i][d] = x0;
      for (int j = 0; j < 3; j++) H.block<3, 1>(3 * j, 3 * i + d) = -(up[j] - down[j]) / (2.0 * h);
    }
  return H;
}

VectorXd eigenvalues(const MatrixXd &m)
{
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(m).eigenvalues();
}

// orthonormal axes: two in the plane, the normal
Mat3 axes_of(const Points &x)
{
  Mat3 axes;
  axes.col(0) = (x[1] - x[0]).normalized();
  axes.col(2) = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// derivatives, by the nine coordinates, of the in-plane displacement gradient: component i of the
// displacement along axis j
VectorXd gradient_component(const Points &x, int i, int j)
{
  const Mat3 axes = axes_of(x);
  VectorXd g(9);
  for (int k = 0; k < 3; k++) {
    // slope of the function that is 1 at corner k and 0 at the others
    const Vec3 slope = axes.col(2).cross(x[(k + 2) % 3] - x[(k + 1) % 3]) / (2.0 * area_of(x));
    g.segment<3>(3 * k) = slope.dot(axes.col(j)) * axes.col(i);
  }
  return g;
}

bool acute(const Points &x)
{
  for (int k = 0; k < 3; k++)
    if ((x[(k + 1) % 3] - x[k]).dot(x[(k + 2) % 3] - x[k]) < 0.0) return false;
  return true;
}

VectorXd flat(const Points &x)
{
  VectorXd v(3 * int(x.size()));
  for (size_t i = 0; i < x.size(); i++) v.segment<3>(3 * int(i)) = x[i];
  return v;
}

}    // namespace

/* ---------------------------------------------------------------------- */

TEST(Tension, MinusGradientOfTensionTimesArea)
{
  Random random(201, 0, 0);
  const double T = 0.37;
  for (int trial = 0; trial < 100; trial++) {
    const Points x = random_triangle(random);
    auto energy = [&](const Points &y) {
      return T * area_of(y);
    };
    EXPECT_LT(gradient_error(force_of(T, x), gradient(energy, x, 1.0e-5)), 1.0e-8);
    EXPECT_NEAR(area_gradient(x[0], x[1], x[2]).area, area_of(x), 1.0e-14 * area_of(x));
  }
}

TEST(Tension, NoNetForceNoNetTorque)
{
  Random random(202, 0, 0);
  for (int trial = 0; trial < 100; trial++) {
    const Points x = random_triangle(random);
    EXPECT_LT(net_force(force_of(0.8, x)), 1.0e-14);
    EXPECT_LT(net_torque(x, force_of(0.8, x)), 1.0e-14);
  }
}

TEST(Tension, ForceOfAnEquilateralTriangle)
{
  // pulls each corner toward the middle with T times half the side
  const Vec3 a(0, 0, 0), b(2, 0, 0), c(1, std::sqrt(3.0), 0);
  const Points f = force_of(0.5, {a, b, c});
  const Vec3 middle = (a + b + c) / 3.0;
  EXPECT_LT((f[0] - 0.5 * (middle - a).normalized()).norm(), 1.0e-15);
  EXPECT_LT((f[1] - 0.5 * (middle - b).normalized()).norm(), 1.0e-15);
  EXPECT_LT((f[2] - 0.5 * (middle - c).normalized()).norm(), 1.0e-15);
}

TEST(Tension, TurnsWithTheTriangleAndScalesWithItsSide)
{
  Random random(203, 0, 0);
  for (int trial = 0; trial < 50; trial++) {
    const Points x = random_triangle(random), f = force_of(0.8, x);
    const Mat3 R = random_rotation(random);
    const Vec3 shift = 3.0 * random.gaussian_vector();
    Points y;
    for (const Vec3 &v : x) y.push_back(4.0 * (R * v + shift));
    const Points g = force_of(0.8, y);
    for (int k = 0; k < 3; k++) EXPECT_LT((g[k] - 4.0 * R * f[k]).norm(), 1.0e-13 * largest(g));
    const auto here = tension_stiffness(0.8, x[0], x[1], x[2]);
    const auto there = tension_stiffness(0.8, y[0], y[1], y[2]);
    for (int k = 0; k < 3; k++) EXPECT_NEAR(here[k], there[k], 1.0e-12);
  }
}

TEST(Tension, NumberingDoesNotMatter)
{
  Random random(204, 0, 0);
  for (int trial = 0; trial < 50; trial++) {
    const Points x = random_triangle(random), f = force_of(0.8, x);
    const auto iso = tension_stiffness(0.8, x[0], x[1], x[2]);
    for (const auto &p : {std::array<int, 3>{1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}}) {
      const Points g = force_of(0.8, {x[p[0]], x[p[1]], x[p[2]]});
      const auto other = tension_stiffness(0.8, x[p[0]], x[p[1]], x[p[2]]);
      for (int k = 0; k < 3; k++) {
        EXPECT_LT((g[k] - f[p[k]]).norm(), 1.0e-14 * largest(f));
        EXPECT_NEAR(other[k], iso[p[k]], 1.0e-14 * (iso[0] + iso[1] + iso[2]));
      }
    }
  }
}

TEST(Tension, ConstantForceWhateverTheStretch)
{
  // a strip pulled out: the force on its end is T times its width at any length
  for (double length : {0.5, 1.0, 7.0}) {
    const Vec3 a(0, 0, 0), b(length, 0, 0), c(length, 2, 0), d(0, 2, 0);
    const Points one = force_of(0.3, {a, b, c}), two = force_of(0.3, {a, c, d});
    EXPECT_NEAR((one[1] + one[2] + two[1])[0], -0.3 * 2.0, 1.0e-15);
  }
}

TEST(Tension, LaplaceOnASphere)
{
  // the virial of any surface is -2 T A; the pressure that holds it, 2 T A/(3 V), is 2 T/R up to
  // the square of the edge
  const double T = 0.2, R = 3.0;
  double before = 0.0;
  for (int level : {1, 2, 3, 4}) {
    for (const Mesh &mesh : {ball(level, R), dented(level, R)}) {
      const Points f = force_of(T, mesh);
      Vec3 all = Vec3::Zero();
      double virial = 0.0, lengths = 0.0;
      for (size_t i = 0; i < f.size(); i++) {
        all += f[i];
        lengths += f[i].norm();
        virial += mesh.nodes[i].dot(f[i]);
      }
      EXPECT_LT(all.norm(), 1.0e-15 * lengths);    // round-off of the sum
      EXPECT_NEAR(virial, -2.0 * T * area(mesh), 1.0e-12 * T * area(mesh));
    }
    // held by its pressure, each node of the ball is pulled inward as much as it is pushed outward
    const Mesh mesh = ball(level, R);
    Points sum = force_of(T, mesh);
    const double p = 2.0 * T * area(mesh) / (3.0 * volume(mesh));
    for (const auto &face : mesh.faces)
      for (int i : face)
        sum[i] +=
            face_pressure_force(p, mesh.nodes[face[0]], mesh.nodes[face[1]], mesh.nodes[face[2]]);
    double outward = 0.0;
    for (size_t i = 0; i < sum.size(); i++) outward += mesh.nodes[i].dot(sum[i]);
    EXPECT_LT(std::fabs(outward), 1.0e-12 * T * area(mesh));
    const double error = p / (2.0 * T / R) - 1.0;
    EXPECT_GT(error, 0.0);
    if (level > 1) {
      EXPECT_NEAR(std::log2(before / error), 2.0, 0.1) << level;
    }
    before = error;
  }
}

TEST(Tension, DegenerateTriangles)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0);
  for (const Vec3 &flat : {a, b, Vec3(0.5, 0, 0), Vec3(3, 0, 0), Vec3(0.5, 1.0e-12, 0)}) {
    const AreaGradient g = area_gradient(a, b, flat);
    EXPECT_EQ(g.area, 0.0);
    for (const Vec3 &by : g.by) EXPECT_EQ(by.norm(), 0.0);
    for (double iso : tension_stiffness(1.0, a, b, flat)) EXPECT_EQ(iso, 0.0);
  }
  for (const Vec3 &x : area_gradient(a, a, a).by) EXPECT_EQ(x.norm(), 0.0);
  // a thin one is not degenerate: its forces are those of its long sides
  const AreaGradient thin = area_gradient(a, b, Vec3(0.5, 1.0e-6, 0));
  EXPECT_NEAR(thin.area, 0.5e-6, 1.0e-18);
  EXPECT_NEAR(thin.by[2][1], 0.5, 1.0e-10);
  // tiny and huge ones
  for (double s : {1.0e-60, 1.0e60}) {
    const AreaGradient g = area_gradient(s * a, s * b, s * Vec3(0, 1, 0));
    EXPECT_NEAR(g.area, 0.5 * s * s, 1.0e-14 * s * s);
    EXPECT_NEAR(g.by[2][1], 0.5 * s, 1.0e-14 * s);
  }
}

TEST(Tension, CoordinatesThatAreNoNumbersAreNotHidden)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const AreaGradient g = area_gradient(Vec3(nan, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0));
  EXPECT_TRUE(std::isnan(g.area));
  EXPECT_TRUE(std::isnan(g.by[0].sum()));
}

/* ---------------------------------------------------------------------- */

TEST(TensionStiffness, PositiveSemidefiniteAndAboveTheHessian)
{
  Random random(205, 0, 0);
  const double T = 0.6;
  int obtuse = 0;
  for (int trial = 0; trial < 100; trial++) {
    const Points x = random_triangle(random);
    obtuse += !acute(x);
    const MatrixXd K = stiffness_of(T, x), H = hessian_of(T, x, 1.0e-5);
    EXPECT_GE(eigenvalues(K)[0], -1.0e-13 * K.norm());
    EXPECT_GE(eigenvalues(K - H)[0], -1.0e-7 * H.norm());
    EXPECT_LT(eigenvalues(H)[0], -0.1 * T);    // H itself will not do
  }
  EXPECT_GT(obtuse, 20);
  EXPECT_LT(obtuse, 80);
}

TEST(TensionStiffness, WithoutObtuseAnglesOnlyTheShearsAreAdded)
{
  Random random(206, 0, 0);
  const double T = 0.6;
  for (int trial = 0; trial < 100; trial++) {
    const Points x = random_triangle(random);
    if (!acute(x)) continue;
    const MatrixXd K = stiffness_of(T, x), H = hessian_of(T, x, 1.0e-5);
    const VectorXd stretch = gradient_component(x, 0, 0) - gradient_component(x, 1, 1);
    const VectorXd shear = gradient_component(x, 0, 1) + gradient_component(x, 1, 0);
    const MatrixXd shears =
        T * area_of(x) * (stretch * stretch.transpose() + shear * shear.transpose());
    EXPECT_LT((K - H - shears).norm(), 1.0e-7 * K.norm());
  }
}

TEST(TensionStiffness, ExactWhereNothingShears)
{
  Random random(207, 0, 0);
  const double T = 0.6;
  for (int trial = 0; trial < 100; trial++) {
    const Points x = random_triangle(random);
    if (!acute(x)) continue;
    const MatrixXd D = stiffness_of(T, x) - hessian_of(T, x, 1.0e-5);
    const Vec3 N = axes_of(x).col(2), turn = random.gaussian_vector(), shift(0.3, -1.0, 0.2);
    Points u;    // out of the plane by any amount; turned, swollen and shifted
    for (const Vec3 &v : x) u.push_back(random.gaussian() * N + turn.cross(v) + 0.7 * v + shift);
    EXPECT_LT((D * flat(u)).norm(), 1.0e-6 * T * flat(u).norm());
  }
}

TEST(TensionStiffness, LargeDisplacementsStayBelowTheBound)
{
  // T A(x + u) <= T A(x) - u.F + u.Ku/2 for any u
  Random random(208, 0, 0);
  const double T = 0.6;
  for (double size : {0.01, 1.0, 100.0})
    for (int trial = 0; trial < 200; trial++) {
      const Points x = random_triangle(random);
      Points y = x;
      for (Vec3 &v : y) v += size * random.gaussian_vector();
      const VectorXd u = flat(y) - flat(x);
      const double bound =
          T * area_of(x) - u.dot(flat(force_of(T, x))) + 0.5 * u.dot(stiffness_of(T, x) * u);
      EXPECT_LE(T * area_of(y), bound + 1.0e-13 * std::fabs(bound));
    }
}

TEST(TensionStiffness, AStepOfAnyLengthLowersTheEnergy)
{
  // (g + dt K) v = F dissipates dt g v^2 at least, on a mesh with obtuse and thin triangles
  Mesh start = spiky(1);
  Random random(209, 0, 0);
  for (Vec3 &x : start.nodes) x += 0.1 * random.gaussian_vector();
  const double T = 0.6, friction = 0.3;
  const int n = 3 * int(start.nodes.size());
  for (double dt : {0.01, 1.0, 100.0, 1.0e4}) {
    Mesh mesh = start;
    for (int step = 0; step < 5; step++) {
      const double before = T * area(mesh);
      const MatrixXd A = friction * MatrixXd::Identity(n, n) + dt * stiffness_of(T, mesh);
      const VectorXd v = A.llt().solve(flat(force_of(T, mesh)));
      for (size_t i = 0; i < mesh.nodes.size(); i++) mesh.nodes[i] += dt * v.segment<3>(3 * int(i));
      const double lost = dt * friction * v.squaredNorm();
      EXPECT_LE(T * area(mesh), before - lost + 1.0e-12 * before) << dt << " " << step;
      EXPECT_GT(lost, 0.0);
    }
  }
}

TEST(TensionStiffness, NoTensionHasNone)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  for (double T : {0.0, -1.0})
    for (double iso : tension_stiffness(T, a, b, c)) EXPECT_EQ(iso, 0.0);
}
