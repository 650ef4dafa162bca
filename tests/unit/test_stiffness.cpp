// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Stiffness blocks: products and diagonals against dense matrices assembled from the formulas, the
// laws' own blocks against finite differences of their forces.

#include "law/stiffness.h"
#include "law/cortex.h"
#include "law/hinge.h"
#include "law/mesh.h"
#include "law/volume.h"
#include "helpers.h"

#include <Eigen/Dense>

#include <algorithm>
#include <functional>

using namespace dcm;
using namespace dcm_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double SINGLE = 2.0e-7;      // three times the round-off of single precision
constexpr int ROWS = 2, FIELDS = 2;    // cells of random_system(), blocks of each

struct Alone {
  int sums = 0;
  void sum(double *, int) { sums++; }
  void sum_cells(double *, int) { sums++; }
};

// full matrices over slots 1..n; slot 0 is dropped
class Dense {
 public:
  explicit Dense(int n) : all(MatrixXd::Zero(3 * n + 3, 3 * n + 3)) {}
  void add(int i, int j, const Mat3 &m) { all.block<3, 3>(3 * i, 3 * j) += m; }
  MatrixXd get() const { return all.bottomRightCorner(all.rows() - 3, all.cols() - 3); }

  void add(const EdgeBlock &b)
  {
    const Mat3 m = b.iso * Mat3::Identity() + b.along * vec(b.e) * vec(b.e).transpose();
    for (int i : {b.i, b.j})
      for (int j : {b.i, b.j}) add(i, j, i == j ? m : Mat3(-m));
  }
  void add(const ContactSpring &b)
  {
    const Mat3 m = b.mean.normal * vec(b.mean.u) * vec(b.mean.u).transpose();
    for (const double *w : {b.mean.w, b.tilt[0], b.tilt[1]})
      for (int k = 0; k < 6; k++)
        for (int l = 0; l < 6; l++) add(b.mean.n[k], b.mean.n[l], w[k] * w[l] * m);
  }
  template <int N> void add(const RankOne<N> &b)
  {
    for (int k = 0; k < N; k++)
      for (int l = 0; l < N; l++) add(b.n[k], b.n[l], b.c * vec(b.g[k]) * vec(b.g[l]).transpose());
  }
  void add(const StiffnessSystem &s)
  {
    for (const auto &b : s.edges) add(b);
    for (const auto &b : s.contacts) add(b);
    for (const auto &b : s.hinges) add(b);
    for (const auto &b : s.cells)
      for (size_t k = b.begin; k < b.end; k++)
        for (size_t l = b.begin; l < b.end; l++)
          add(s.nodes[k].n, s.nodes[l].n, b.c * vec(s.nodes[k].g) * vec(s.nodes[l].g).transpose());
    for (const auto &b : s.means)
      for (size_t k = b.begin; k < b.end; k++)
        for (size_t l = b.begin; l < b.end; l++) {
          Mat3 m = Mat3::Zero();
          m(b.axis, b.axis) = b.c * b.share * b.share;
          add(s.members[k], s.members[l], m);
        }
  }

 private:
  MatrixXd all;
};

void set(double *to, const Vec3 &from)
{
  vec(to) = from;
}

std::vector<int> slots(const RankOne<4> &b)
{
  return {b.n, b.n + 4};
}

std::vector<int> slots(const ContactSpring &b)
{
  return {b.mean.n, b.mean.n + 6};
}

// blocks of all kinds between slots 0 to n
StiffnessSystem random_system(Random &random, int n)
{
  StiffnessSystem s;
  auto any = [&]() {
    return int(random.uniform() * (n + 1));
  };
  for (int k = 0; k < 2 * n; k++) {
    EdgeBlock b = {any(), any(), random.uniform(), random.uniform(), {}};
    if (b.i == b.j) continue;
    set(b.e, random.unit_vector());
    s.edges.push_back(b);
  }
  for (int k = 0; k < 2 * n; k++) {
    ContactSpring spring = {};
    ContactBlock &b = spring.mean;
    for (int &i : b.n) i = any();    // a node may stand in two slots
    double sf = 0.0, sg = 0.0;
    for (int l = 0; l < 3; l++) {
      sf += b.w[l] = random.uniform();
      sg += b.w[l + 3] = -random.uniform();
    }
    for (int l = 0; l < 3; l++) {
      b.w[l] /= sf;
      b.w[l + 3] /= -sg;
    }
    set(b.u, random.unit_vector());
    b.normal = random.uniform();
    for (auto &tilt : spring.tilt)
      for (int side : {0, 3}) {
        for (int l = 0; l < 2; l++) tilt[side + l] = random.uniform() - 0.5;
        tilt[side + 2] = -tilt[side] - tilt[side + 1];
      }
    s.contacts.push_back(spring);
  }
  for (int k = 0; k < n; k++) {
    RankOne<4> b = {};
    const int first = int(random.uniform() * n);
    for (int l = 0; l < 4; l++) {
      b.n[l] = (first + l) % (n + 1);    // four different ones, the fixed slot among them
      set(b.g[l], random.gaussian_vector());
    }
    for (int k = 0; k < 3; k++) b.g[3][k] = -b.g[0][k] - b.g[1][k] - b.g[2][k];
    b.c = random.uniform();
    s.hinges.push_back(b);
  }
  const int volumes = s.add_field(ROWS), planes = s.add_field(ROWS);
  for (int row : {0, 1}) {    // two cells that share no node
    const int first = 1 + row * (n / 2);
    CellBlock b = {s.nodes.size(), 0, random.uniform(), row, volumes};
    for (int i = first; i < first + n / 2; i++) {
      s.nodes.push_back({i, {}});
      set(s.nodes.back().g, random.gaussian_vector());
    }
    b.end = s.nodes.size();
    s.cells.push_back(b);
    MeanBlock mean = {s.members.size(), 0, random.uniform(), 2.0 / n, 1 + row, row, planes};
    for (int i = first; i < first + n / 2; i++) s.members.push_back(i);
    mean.end = s.members.size();
    s.means.push_back(mean);
  }
  s.merge();
  return s;
}

VectorXd with_fixed(const VectorXd &v)
{
  VectorXd all = VectorXd::Zero(STRIDE * (v.size() / 3 + 1));
  for (int i = 0; i < v.size() / 3; i++) all.segment<3>(STRIDE * (i + 1)) = v.segment<3>(3 * i);
  return all;
}

VectorXd without_fixed(const VectorXd &all)
{
  VectorXd v(3 * (all.size() / STRIDE - 1));
  for (int i = 0; i < v.size() / 3; i++) v.segment<3>(3 * i) = all.segment<3>(STRIDE * (i + 1));
  return v;
}

VectorXd random_vector(Random &random, int n)
{
  return VectorXd::NullaryExpr(n, [&]() {
    return random.gaussian();
  });
}

// -dF/dx by central differences of a force on points
MatrixXd minus_jacobian(const std::function<Points(const Points &)> &force, Points x, double h)
{
  const int n = int(x.size());
  MatrixXd K(3 * n, 3 * n);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) {
      const double x0 = x[i][d];
      x[i][d] = x0 + h;
      const Points up = force(x);
      x[i][d] = x0 - h;
      const Points down = force(x);
      x[i][d] = x0;
      for (int j = 0; j < n; j++) K.block<3, 1>(3 * j, 3 * i + d) = -(up[j] - down[j]) / (2.0 * h);
    }
  return K;
}

double smallest_eigenvalue(const MatrixXd &m)
{
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(m).eigenvalues()[0];
}

double largest_eigenvalue(const MatrixXd &m)
{
  return -smallest_eigenvalue(-m);
}

// a hinge between two random triangles of sides around one
Points random_hinge(Random &random)
{
  Points x = {Vec3(0.4, 0.9, 0.3), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.6, -0.8, 0.2)};
  const Mat3 R = random_rotation(random);
  for (Vec3 &v : x) v = R * (v + 0.2 * random.gaussian_vector());
  return x;
}

}    // namespace

/* ---------------------------------------------------------------------- */

TEST(StiffnessBlocks, ProductEqualsDenseMatrix)
{
  Random random(101, 0, 0);
  for (int n : {4, 7, 30}) {
    StiffnessSystem s = random_system(random, n);
    Dense dense(n);
    dense.add(s);
    const MatrixXd K = dense.get();
    const double dt = 3.0;
    const VectorXd v = random_vector(random, 3 * n), before = random_vector(random, 3 * n);
    const VectorXd p = with_fixed(v);
    VectorXd y = with_fixed(before);    // adds to what is there
    Alone comm;
    const double power = s.apply(dt, n + 1, p.data(), y.data(), comm);
    const VectorXd Kv = without_fixed(y) - before;
    EXPECT_LT((Kv - dt * K * v).norm(), SINGLE * dt * (K * v).norm());
    EXPECT_NEAR(power, v.dot(Kv), 1.0e-13 * v.norm() * Kv.norm());
    EXPECT_EQ(y.head(STRIDE).norm(), 0.0);
    for (int i = 0; i <= n; i++) EXPECT_EQ(y[STRIDE * i + 3], 0.0);
    EXPECT_EQ(comm.sums, 1);

    s.clear();    // no cells, no message
    s.merge();
    s.apply(dt, n + 1, p.data(), y.data(), comm);
    EXPECT_EQ(comm.sums, 1);
  }
}

// single precision of the factors must leave no trace in the form of the matrix
TEST(StiffnessBlocks, PackedMatrixIsSymmetricSemidefiniteAndBlindToTranslations)
{
  Random random(107, 0, 0);
  const int n = 15;
  StiffnessSystem s = random_system(random, n);
  s.cells.clear();    // their random gradients see translations
  s.means.clear();    // and so does a plane
  auto inside = [](const auto &b) {
    for (int i : slots(b))
      if (i == 0) return false;
    return true;
  };
  auto outside = [&](const auto &b) {
    return !inside(b);
  };
  s.contacts.erase(std::remove_if(s.contacts.begin(), s.contacts.end(), outside), s.contacts.end());
  s.hinges.erase(std::remove_if(s.hinges.begin(), s.hinges.end(), outside), s.hinges.end());
  s.edges.erase(std::remove_if(s.edges.begin(), s.edges.end(),
                               [](const EdgeBlock &b) {
                                 return b.i == 0 || b.j == 0;
                               }),
                s.edges.end());
  ASSERT_GT(s.contacts.size() * s.hinges.size() * s.edges.size(), 100u);
  s.merge();
  MatrixXd K(3 * n, 3 * n);
  Alone alone;
  for (int c = 0; c < 3 * n; c++) {
    VectorXd y = VectorXd::Zero(STRIDE * (n + 1));
    const VectorXd p = with_fixed(VectorXd::Unit(3 * n, c));
    s.apply(1.0, n + 1, p.data(), y.data(), alone);
    K.col(c) = without_fixed(y);
  }
  EXPECT_LT((K - K.transpose()).norm(), 1.0e-14 * K.norm());
  EXPECT_GT(smallest_eigenvalue(K), -1.0e-13 * K.norm());
  for (int k = 0; k < 3; k++) {
    VectorXd shift = VectorXd::Zero(3 * n);
    for (int i = 0; i < n; i++) shift[3 * i + k] = 1.0;
    EXPECT_LT((K * shift).norm(), 1.0e-13 * K.norm());
  }
}

TEST(StiffnessBlocks, DiagonalEqualsDenseMatrix)
{
  Random random(102, 0, 0);
  const int n = 20;
  const StiffnessSystem s = random_system(random, n);
  Dense dense(n);
  dense.add(s);
  const MatrixXd K = dense.get();
  const double dt = 3.0;
  std::vector<double> d(6 * (n + 1), 0.25);    // adds to what is there
  s.add_diagonal(dt, d.data());
  for (int i = 1; i <= n; i++) {
    const double *m = &d[6 * i];
    Mat3 block;
    block << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
    const Mat3 target = dt * K.block<3, 3>(3 * i - 3, 3 * i - 3) + Mat3::Constant(0.25);
    EXPECT_LT((block - target).norm(), 1.0e-13 * target.norm()) << i;
  }
}

TEST(StiffnessBlocks, SymmetricPositiveSemidefinite)
{
  Random random(103, 0, 0);
  Dense dense(15);
  dense.add(random_system(random, 15));
  const MatrixXd K = dense.get();
  EXPECT_LT((K - K.transpose()).norm(), 1.0e-14 * K.norm());
  EXPECT_GT(smallest_eigenvalue(K), -1.0e-13 * K.norm());
}

TEST(StiffnessBlocks, CellSharedByProcesses)
{
  // nodes of each cell on two processes: their products and powers add up to those of one
  Random random(104, 0, 0);
  const int n = 12;
  StiffnessSystem whole = random_system(random, n), part[2];
  whole.edges.clear();
  whole.contacts.clear();
  whole.hinges.clear();
  whole.merge();
  whole.cells.front().row = -1;    // one over more than a cell
  for (int rank : {0, 1}) {
    const auto has = [&](int slot) {
      return (slot % 3 == 0) == (rank == 0);
    };
    StiffnessSystem &mine = part[rank];
    for (int k = 0; k < FIELDS; k++) mine.add_field(ROWS);
    for (CellBlock b : whole.cells) {
      const size_t begin = mine.nodes.size();
      for (; b.begin < b.end; b.begin++)
        if (has(whole.nodes[b.begin].n)) mine.nodes.push_back(whole.nodes[b.begin]);
      b.begin = begin;
      b.end = mine.nodes.size();
      mine.cells.push_back(b);
    }
    for (MeanBlock b : whole.means) {
      const size_t begin = mine.members.size();
      for (; b.begin < b.end; b.begin++)
        if (has(whole.members[b.begin])) mine.members.push_back(whole.members[b.begin]);
      b.begin = begin;
      b.end = mine.members.size();
      mine.means.push_back(b);
    }
  }

  const VectorXd p = with_fixed(random_vector(random, 3 * n));
  const VectorXd zero = VectorXd::Zero(p.size());
  Alone alone;
  VectorXd y = zero;
  const double power = whole.apply(2.0, n + 1, p.data(), y.data(), alone);

  // first round: what each process would send; second: each receives the sum
  struct Listen {
    std::vector<double> cells, wide;
    void sum_cells(double *v, int width) { cells.assign(v, v + ROWS * width); }
    void sum(double *v, int n) { wide.assign(v, v + n); }
  } sent[2];
  struct Answer {
    std::vector<double> cells, wide;
    void sum_cells(double *v, int) { std::copy(cells.begin(), cells.end(), v); }
    void sum(double *v, int n) { std::copy(wide.begin(), wide.begin() + n, v); }
  } answer;
  VectorXd half[2] = {zero, zero};
  for (int rank : {0, 1}) part[rank].apply(2.0, n + 1, p.data(), half[rank].data(), sent[rank]);
  ASSERT_EQ(sent[0].wide.size(), 1u);
  answer.wide = {sent[0].wide[0] + sent[1].wide[0]};
  ASSERT_EQ(sent[0].cells.size(), size_t(ROWS * FIELDS));
  for (int k = 0; k < ROWS * FIELDS; k++)
    answer.cells.push_back(sent[0].cells[k] + sent[1].cells[k]);
  double shares = 0.0;
  for (int rank : {0, 1}) {
    half[rank].setZero();
    shares += part[rank].apply(2.0, n + 1, p.data(), half[rank].data(), answer);
    EXPECT_GT(half[rank].norm(), 0.0);
  }
  EXPECT_LT((half[0] + half[1] - y).norm(), 1.0e-13 * y.norm());
  EXPECT_NEAR(shares, power, 1.0e-13 * power);
}

/* ---------------------------------------------------------------------- */

TEST(CortexStiffness, StretchedEdgeIsTheHessian)
{
  Random random(105, 0, 0);
  for (int trial = 0; trial < 20; trial++) {
    const Points x = {random.gaussian_vector(), random.gaussian_vector()};
    const double ks = 2.3, l = (x[1] - x[0]).norm();
    for (double l0 : {0.5 * l, l, 1.4 * l}) {
      auto force = [&](const Points &y) {
        const Vec3 f = cortex_force(ks, l0, y[1] - y[0]);
        return Points{-f, f};
      };
      EdgeBlock b = cortex_stiffness_block(ks, l0, x[1] - x[0]);
      b.i = 1;
      b.j = 2;
      Dense dense(2);
      dense.add(b);
      const MatrixXd K = dense.get(), hessian = minus_jacobian(force, x, 1.0e-6 * l);
      EXPECT_GE(smallest_eigenvalue(K), -1.0e-13 * ks);
      if (l0 <= l) {
        EXPECT_LT((K - hessian).norm(), 1.0e-7 * hessian.norm());
      } else {    // what is left out only makes it softer
        EXPECT_EQ(b.iso, 0.0);
        EXPECT_LT(largest_eigenvalue(hessian - K), 1.0e-7 * ks);
        EXPECT_LT(smallest_eigenvalue(hessian), -0.1 * ks);
      }
    }
  }
  const EdgeBlock none = cortex_stiffness_block(2.0, 1.0, Vec3::Zero());
  EXPECT_EQ(none.iso, 0.0);
  EXPECT_EQ(none.along, 0.0);
}

TEST(HingeStiffness, GradientOfTheAngle)
{
  Random random(106, 0, 0);
  for (int trial = 0; trial < 50; trial++) {
    const Points x = random_hinge(random);
    auto angle = [](const Points &y) {
      return hinge_angle(y[0], y[1], y[2], y[3]);
    };
    const Points numeric = gradient(angle, x, 1.0e-6);
    const RankOne<4> b = hinge_stiffness(1.0, 0.0, x[0], x[1], x[2], x[3]);
    Points minus;
    for (int k = 0; k < 4; k++) minus.push_back(-vec(b.g[k]));
    EXPECT_LT(gradient_error(minus, numeric), 1.0e-7);
    // no stiffness against translation and rotation
    EXPECT_LT(net_force(minus), 1.0e-13);
    EXPECT_LT(net_torque(x, minus), 1.0e-13);
  }
}

TEST(HingeStiffness, GaussNewtonPartOfTheHessian)
{
  Random random(107, 0, 0);
  const double kb = 0.7;
  for (int trial = 0; trial < 20; trial++) {
    const Points x = random_hinge(random);
    const double theta = hinge_angle(x[0], x[1], x[2], x[3]);
    auto angle_gradient = [](const Points &y) {
      const RankOne<4> b = hinge_stiffness(1.0, 0.0, y[0], y[1], y[2], y[3]);
      Points minus;
      for (int k = 0; k < 4; k++) minus.push_back(-vec(b.g[k]));
      return minus;
    };
    const MatrixXd second = minus_jacobian(angle_gradient, x, 1.0e-5);    // of theta
    for (double off : {0.0, 0.3, -1.0, 2.0}) {
      const double theta0 = theta - off;
      auto force = [&](const Points &y) {
        const Hinge h = hinge(kb, theta0, y[0], y[1], y[2], y[3]);
        return Points{h.f1, h.f2, h.f3, h.f4};
      };
      RankOne<4> b = hinge_stiffness(kb, theta0, x[0], x[1], x[2], x[3]);
      for (int k = 0; k < 4; k++) b.n[k] = k + 1;
      Dense dense(4);
      dense.add(b);
      const MatrixXd K = dense.get(), hessian = minus_jacobian(force, x, 1.0e-5);
      EXPECT_GE(smallest_eigenvalue(K), -1.0e-13 * (1.0 + K.norm()));
      EXPECT_NEAR(b.c, kb * std::max(0.0, std::cos(off)), 1.0e-14);
      // at the rest angle it is all there is, elsewhere the curvature of theta is left out
      if (off < 0.5 * PI) {
        EXPECT_LT((hessian - K - kb * std::sin(off) * second).norm(),
                  1.0e-6 * (1.0 + hessian.norm()));
      } else {
        EXPECT_EQ(K.norm(), 0.0);
      }
      if (off == 0.0) {
        EXPECT_LT((hessian - K).norm(), 1.0e-7 * (1.0 + hessian.norm()));
      }
    }
  }
}

TEST(HingeStiffness, SliversHaveNone)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0.3, 0.7, 0.1);
  for (const Vec3 &flat : {a, b, Vec3(0.5, 0, 0)})
    for (bool first : {true, false}) {
      const RankOne<4> s = first ? hinge_stiffness(1.0, 0.2, flat, a, b, c)
                                 : hinge_stiffness(1.0, 0.2, c, a, b, flat);
      for (const auto &g : s.g) EXPECT_EQ(vec(g).norm(), 0.0);
    }
}

TEST(PressureStiffness, GaussNewtonPartOfTheHessian)
{
  Random random(108, 0, 0);
  Mesh mesh = icosphere(1);
  for (Vec3 &x : mesh.nodes) x = 2.0 * x + 0.1 * random.gaussian_vector();
  const double K_V = 1.7, V = volume(mesh);
  const int n = int(mesh.nodes.size());
  auto volume_of = [&](const Points &y) {
    Mesh moved = mesh;
    moved.nodes = y;
    return volume(moved);
  };
  auto pushed = [&](const Points &y, double p) {
    Points f(n, Vec3::Zero());
    for (const auto &face : mesh.faces)
      for (int i : face) f[i] += face_pressure_force(p, y[face[0]], y[face[1]], y[face[2]]);
    return f;
  };

  // G as the docstring says
  StiffnessSystem s;
  for (int i = 0; i < n; i++) s.nodes.push_back({i + 1, {0.0, 0.0, 0.0}});
  for (const auto &f : mesh.faces)
    for (int i : f)
      vec(s.nodes[i].g) +=
          face_area_vector(mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]) / 3.0;
  s.cells.push_back({0, s.nodes.size(), pressure_stiffness(K_V, V)});
  const Points dV = gradient(volume_of, mesh.nodes, 1.0e-5);
  for (int i = 0; i < n; i++) EXPECT_LT((dV[i] - vec(s.nodes[i].g)).norm(), 1.0e-8);

  Dense dense(n);
  dense.add(s);
  const MatrixXd K = dense.get();
  const MatrixXd second = minus_jacobian(
      [&](const Points &y) {
        return pushed(y, -1.0);
      },
      mesh.nodes, 1.0e-5);    // of V
  for (double V0 : {V, 1.2 * V, 0.9 * V}) {
    const MatrixXd hessian = minus_jacobian(
        [&](const Points &y) {
          return pushed(y, pressure(K_V, volume_of(y), V0));
        },
        mesh.nodes, 1.0e-5);
    // p = 0: all there is; else less p times the curvature of V
    EXPECT_LT((hessian - K + pressure(K_V, V, V0) * second).norm(), 1.0e-7 * hessian.norm());
    if (V0 == V) {
      EXPECT_LT((hessian - K).norm(), 1.0e-7 * hessian.norm());
    }
  }
}
