// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// friction blocks and their solver (law/friction.h, law/friction_solver.h) against dense matrices
// assembled from the formulas, and against Eigen's direct solver

#include "law/friction.h"
#include "law/friction_solver.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

using dcm::ContactBlock;
using dcm::EdgeBlock;
using dcm::FrictionResult;
using dcm::FrictionSolver;
using dcm::FrictionSystem;
using dcm::IsoEdge;
using dcm::Precondition;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

// one process: nothing to send

struct Alone {
  int forwards = 0, reverses = 0, sums = 0;
  void forward(double *) { forwards++; }
  void reverse(double *, int, int) { reverses++; }
  void sum(double *, int) { sums++; }
};

class Random {
 public:
  explicit Random(unsigned seed) : engine(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<>(a, b)(engine); }
  int index(int n) { return std::uniform_int_distribution<>(0, n - 1)(engine); }
  Vector3d unit()
  {
    std::normal_distribution<> normal;
    return Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
  }

 private:
  std::mt19937 engine;
};

Vector3d map3(const double *v)
{
  return Vector3d(v[0], v[1], v[2]);
}

ContactBlock random_contact(Random &random, int nslots)
{
  ContactBlock b = {};
  double wf[3], wg[3], sf = 0.0, sg = 0.0;
  for (int k = 0; k < 3; k++) {
    sf += wf[k] = random.uniform(0.0, 1.0);
    sg += wg[k] = random.uniform(0.0, 1.0);
  }
  for (int k = 0; k < 3; k++) {
    b.w[k] = wf[k] / sf;
    b.w[k + 3] = -wg[k] / sg;
  }
  for (int &n : b.n) n = random.index(nslots);
  const Vector3d u = random.unit();
  for (int k = 0; k < 3; k++) b.u[k] = u[k];
  b.normal = random.uniform(0.0, 40.0);
  b.tangential = random.uniform(0.0, 40.0);
  return b;
}

// a random system with all kinds of blocks; slot 0 (fixed) takes part

FrictionSystem random_system(Random &random, int n, bool with_ecm, bool isotropic = false)
{
  FrictionSystem system;
  system.nowned = system.nall = n;
  system.ecm.assign(n + 1, 0.0);
  if (with_ecm)
    for (int i = 1; i <= n; i++) system.ecm[i] = random.uniform(0.0, 1.0);
  const int first = with_ecm ? 0 : 1;
  auto any = [&]() {
    return first + random.index(n + 1 - first);
  };
  for (int i = 1; i < n; i++) system.iso_edges.push_back({i, i + 1, random.uniform(1.0, 5.0)});
  for (int k = 0; k < 3 * n; k++) {
    const Vector3d e = random.unit();
    const int i = any(), j = any();
    const double along = isotropic ? 0.0 : random.uniform(0.0, 4.0);
    if (i == j) continue;
    system.edges.push_back({i, j, random.uniform(0.0, 2.0), along, {e[0], e[1], e[2]}});
  }
  for (int k = 0; k < 4 * n; k++) {
    ContactBlock b = random_contact(random, n + 1 - first);
    if (isotropic) b.tangential = b.normal;
    for (int &i : b.n) i += first;
    if (k % 3 == 0) {    // a sphere against a face: unused slots repeat an index
      b.n[1] = b.n[2] = b.n[0];
      b.w[0] = 1.0;
      b.w[1] = b.w[2] = 0.0;
    }
    system.contacts.push_back(b);
  }
  system.merge();
  return system;
}

// the matrix, slowly and from the definitions; rows and columns of slot 0 are dropped

MatrixXd dense(const FrictionSystem &system)
{
  const int n = system.nall + 1;
  MatrixXd a = MatrixXd::Zero(3 * n, 3 * n);
  auto add_edge = [&](int i, int j, const Matrix3d &m) {
    a.block<3, 3>(3 * i, 3 * i) += m;
    a.block<3, 3>(3 * j, 3 * j) += m;
    a.block<3, 3>(3 * i, 3 * j) -= m;
    a.block<3, 3>(3 * j, 3 * i) -= m;
  };
  const Matrix3d one = Matrix3d::Identity();
  for (int i = 0; i < n; i++) a.block<3, 3>(3 * i, 3 * i) += system.ecm[i] * one;
  for (const auto &b : system.iso_edges) add_edge(b.i, b.j, b.iso * one);
  for (const auto &b : system.edges) {
    const Vector3d e = map3(b.e);
    add_edge(b.i, b.j, b.iso * one + b.along * e * e.transpose());
  }
  for (const auto &b : system.contacts) {
    const Vector3d u = map3(b.u);
    const Matrix3d m = b.tangential * (one - u * u.transpose()) + b.normal * u * u.transpose();
    for (int k = 0; k < 6; k++)
      for (int l = 0; l < 6; l++) a.block<3, 3>(3 * b.n[k], 3 * b.n[l]) += b.w[k] * b.w[l] * m;
  }
  return a.bottomRightCorner(3 * n - 3, 3 * n - 3);
}

VectorXd random_vector(Random &random, int n)
{
  VectorXd v(n);
  for (int i = 0; i < n; i++) v[i] = random.uniform(-1.0, 1.0);
  return v;
}

// vectors of the solver: slot 0 first, four numbers per slot

VectorXd with_fixed(const VectorXd &v)
{
  const int n = (int) v.size() / 3;
  VectorXd all = VectorXd::Zero(dcm::STRIDE * (n + 1));
  for (int i = 0; i < n; i++) all.segment<3>(dcm::STRIDE * (i + 1)) = v.segment<3>(3 * i);
  return all;
}

VectorXd without_fixed(const VectorXd &all)
{
  const int n = (int) all.size() / dcm::STRIDE - 1;
  VectorXd v(3 * n);
  for (int i = 0; i < n; i++) v.segment<3>(3 * i) = all.segment<3>(dcm::STRIDE * (i + 1));
  return v;
}

VectorXd product(const FrictionSystem &system, const VectorXd &v)
{
  const VectorXd p = with_fixed(v);
  VectorXd y = VectorXd::Constant(p.size(), 7.0);    // apply() overwrites
  const double power = system.apply(p.data(), y.data());
  EXPECT_NEAR(power, p.dot(y), 1e-13 * p.norm() * y.norm());
  EXPECT_EQ(y.head(dcm::STRIDE).norm(), 0.0);
  return without_fixed(y);
}

}    // namespace

/* ---------------------------------------------------------------------- */

TEST(FrictionBlocks, ProductEqualsDenseMatrix)
{
  Random random(1);
  for (int n : {1, 2, 5, 30, -30}) {
    const bool isotropic = n < 0;
    n = std::abs(n);
    const FrictionSystem system = random_system(random, n, true, isotropic);
    EXPECT_EQ(system.isotropic(), isotropic);
    const MatrixXd a = dense(system);
    const VectorXd v = random_vector(random, 3 * n);
    EXPECT_LT((product(system, v) - a * v).norm(), 1e-13 * (a * v).norm()) << n;
  }
}

TEST(FrictionBlocks, DiagonalEqualsDenseMatrix)
{
  Random random(2);
  const int n = 20;
  const FrictionSystem system = random_system(random, n, true);
  const MatrixXd a = dense(system);
  std::vector<double> d(6 * (n + 1), 7.0);
  system.diagonal_blocks(d.data());
  for (int i = 1; i <= n; i++) {
    const double *m = &d[6 * i];
    Matrix3d block;
    block << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
    EXPECT_LT((block - a.block<3, 3>(3 * i - 3, 3 * i - 3)).norm(), 1e-13 * block.norm()) << i;
  }
}

TEST(FrictionBlocks, SymmetricPositiveDefinite)
{
  Random random(3);
  const MatrixXd a = dense(random_system(random, 25, true));
  EXPECT_LT((a - a.transpose()).norm(), 1e-14 * a.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues()[0], 0.0);
}

// without ECM friction and fixed atoms only velocity differences count: forces sum to zero for
// any velocity, and a rigid translation meets no resistance

TEST(FrictionBlocks, MomentumIsConservedWithoutECM)
{
  Random random(4);
  const int n = 40;
  const FrictionSystem system = random_system(random, n, false);
  const VectorXd y = product(system, random_vector(random, 3 * n));
  Vector3d sum = Vector3d::Zero();
  double scale = 0.0;
  for (int i = 0; i < n; i++) {
    sum += y.segment<3>(3 * i);
    scale += y.segment<3>(3 * i).norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * scale);

  VectorXd rigid(3 * n);
  for (int i = 0; i < n; i++) rigid.segment<3>(3 * i) = Vector3d(1.0, -2.0, 0.5);
  EXPECT_LT(product(system, rigid).norm(), 1e-12 * y.norm());
}

TEST(FrictionBlocks, DissipationOfOneContact)
{
  ContactBlock b = {{1, 1, 1, 2, 2, 2}, {1, 0, 0, -1, 0, 0}, {0, 0, 1}, 5.0, 3.0};
  FrictionSystem system;
  system.nowned = system.nall = 2;
  system.ecm.assign(3, 0.0);
  system.contacts.push_back(b);
  system.merge();
  VectorXd v = VectorXd::Zero(6);
  v[2] = 1.0;    // approach along the normal
  EXPECT_DOUBLE_EQ(v.dot(product(system, v)), 5.0);
  v[2] = 0.0;
  v[0] = 1.0;    // sliding
  EXPECT_DOUBLE_EQ(v.dot(product(system, v)), 3.0);
}

TEST(FrictionBlocks, InverseOfDiagonalBlock)
{
  Random random(5);
  for (int k = 0; k < 50; k++) {
    double m[6] = {0, 0, 0, 0, 0, 0}, inv[6];
    for (int l = 0; l < 3; l++) {
      const Vector3d u = random.unit();
      dcm::add_symmetric(m, 1.0, u.data());
      m[l] += 0.1;
    }
    Matrix3d a, b;
    a << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
    ASSERT_TRUE(dcm::invert_symmetric(m, inv));
    b << inv[0], inv[3], inv[4], inv[3], inv[1], inv[5], inv[4], inv[5], inv[2];
    EXPECT_LT((a * b - Matrix3d::Identity()).norm(), 1e-7);
  }
  double inv[6];
  const double zero[6] = {0, 0, 0, 0, 0, 0};
  const double planar[6] = {1, 1, 0, 0, 0, 0};
  const double nan[6] = {NAN, 1, 1, 0, 0, 0};
  EXPECT_FALSE(dcm::invert_symmetric(zero, inv));
  EXPECT_TRUE(dcm::invert_symmetric(planar, inv));
  EXPECT_FALSE(dcm::invert_symmetric(nan, inv));
}

/* ----------------------------------------------------------------------
   a system that has been merged before is, to the last bit, what a new one would be
------------------------------------------------------------------------- */

namespace {

FrictionSystem fresh(const FrictionSystem &system)
{
  FrictionSystem copy;
  copy.nowned = system.nowned;
  copy.nall = system.nall;
  copy.ecm = system.ecm;
  copy.iso_edges = system.iso_edges;
  copy.edges = system.edges;
  copy.contacts = system.contacts;
  copy.merge();
  return copy;
}

bool same_bits(const VectorXd &a, const VectorXd &b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0;
}

void expect_as_fresh(FrictionSystem &system, Random &random)
{
  system.merge();
  const FrictionSystem other = fresh(system);
  EXPECT_EQ(system.diagonal(), other.diagonal());
  const VectorXd p = with_fixed(random_vector(random, 3 * system.nall));
  VectorXd y = VectorXd::Zero(p.size()), z = y;
  EXPECT_EQ(system.apply(p.data(), y.data()), other.apply(p.data(), z.data()));
  EXPECT_TRUE(same_bits(y, z));
  EXPECT_GT(y.norm(), 0.0);
}

}    // namespace

class Merge : public ::testing::Test {
 protected:
  Random random{11};
  FrictionSystem system = random_system(random, 60, true);
  std::vector<ContactBlock> &contacts = system.contacts;

  void expect_as_new()
  {
    expect_as_fresh(system, random);
    expect_as_fresh(system, random);    // and again, with nothing changed but the values
    for (auto &b : contacts) b.tangential *= random.uniform(0.5, 2.0);
    for (auto &b : system.edges) b.iso *= random.uniform(0.5, 2.0);
    for (auto &b : system.iso_edges) b.iso *= random.uniform(0.5, 2.0);
    expect_as_fresh(system, random);
  }
  ContactBlock another() { return random_contact(random, system.nall + 1); }
};

TEST_F(Merge, TheSameBlocks)
{
  expect_as_new();
}

TEST_F(Merge, BlocksGone)
{
  for (int where : {0, 60, 70}) {
    contacts.erase(contacts.begin() + where, contacts.begin() + where + 3);
    expect_as_new();
    contacts.erase(contacts.begin() + where, contacts.begin() + where + 50);
    expect_as_new();
  }
  contacts.pop_back();
  expect_as_new();
  contacts.clear();
  expect_as_new();
  system.edges.clear();
  expect_as_new();
  system.iso_edges.clear();
  system.merge();
  EXPECT_EQ(system.diagonal(), fresh(system).diagonal());
}

TEST_F(Merge, BlocksAdded)
{
  for (int where : {0, 120, (int) contacts.size()}) {
    contacts.insert(contacts.begin() + where, another());
    expect_as_new();
    for (int k = 0; k < 30; k++) contacts.insert(contacts.begin() + where, another());
    expect_as_new();
  }
  system.edges.insert(system.edges.begin() + 2, {1, 7, 0.3, 0.0, {1.0, 0.0, 0.0}});
  expect_as_new();
  system.iso_edges.push_back({3, 60, 2.0});
  expect_as_new();
}

TEST_F(Merge, BlocksInAnotherOrder)
{
  std::swap(contacts[10], contacts[200]);
  expect_as_new();
  std::reverse(contacts.begin() + 5, contacts.begin() + 30);
  expect_as_new();
  std::reverse(contacts.begin(), contacts.end());
  expect_as_new();
  std::swap(system.iso_edges.front(), system.iso_edges.back());
  expect_as_new();
}

TEST_F(Merge, WeightsAndCoefficientsThatVanishAndComeBack)
{
  const ContactBlock before = contacts[40];
  for (int k = 0; k < 6; k++) {
    contacts[40].w[k] = 0.0;
    expect_as_new();
  }
  contacts[40] = before;
  expect_as_new();
  std::swap(contacts[40].n[1], contacts[40].n[4]);
  expect_as_new();
  contacts[41].tangential = 0.0;
  expect_as_new();
  system.edges[3].iso = 0.0;
  expect_as_new();
  system.edges[3].iso = 1.0;
  expect_as_new();
}

TEST_F(Merge, MoreSlotsFewerSlotsOtherNumbers)
{
  system.nall += 5;    // ghosts that a contact has asked for
  system.ecm.resize(system.nall + 1, 0.0);
  expect_as_new();
  contacts[7].n[2] = system.nall;
  expect_as_new();
  for (auto &b : contacts)
    for (int &n : b.n) n = n > 0 ? system.nall + 1 - n : 0;
  expect_as_new();
  const FrictionSystem small = random_system(random, 8, true);
  system.nowned = system.nall = small.nall;
  system.ecm = small.ecm;
  system.iso_edges = small.iso_edges;
  system.edges = small.edges;
  contacts = small.contacts;
  expect_as_new();
}

TEST_F(Merge, ManyStepsOfComingAndGoing)
{
  for (int step = 0; step < 300; step++) {
    for (int k = random.index(4); k > 0 && contacts.size() > 50; k--)
      contacts.erase(contacts.begin() + random.index((int) contacts.size()));
    for (int k = random.index(4); k > 0; k--)
      contacts.insert(contacts.begin() + random.index((int) contacts.size()), another());
    expect_as_fresh(system, random);
  }
}

/* ---------------------------------------------------------------------- */

class Solve : public ::testing::TestWithParam<Precondition> {};

TEST_P(Solve, AgreesWithDirectSolver)
{
  Random random(6);
  for (int n : {1, 3, 20, 60, -60}) {
    const bool isotropic = n < 0;
    n = std::abs(n);
    const FrictionSystem system = random_system(random, n, true, isotropic);
    const VectorXd force = random_vector(random, 3 * n);
    const VectorXd direct = dense(system).ldlt().solve(force);

    FrictionSolver<Alone> solver;
    solver.tolerance = 1e-12;
    solver.precondition = GetParam();
    Alone comm;
    const VectorXd b = with_fixed(force);
    VectorXd x = with_fixed(random_vector(random, 3 * n));
    const FrictionResult result = solver.solve(system, b.data(), x.data(), comm);
    EXPECT_EQ(result.status, FrictionResult::CONVERGED);
    EXPECT_LE(result.residual, 1e-12);
    EXPECT_LT((without_fixed(x) - direct).norm(), 1e-9 * direct.norm()) << n;
    EXPECT_NEAR(result.force, force.norm(), 1e-14 * force.norm());

    // two sums, one forward and one reverse an iteration
    EXPECT_LE(comm.sums, 2 * result.iterations + 2);
    EXPECT_LE(comm.forwards, result.iterations + 2);
    EXPECT_LE(comm.reverses, result.iterations + 2);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Solve,
                         ::testing::Values(Precondition::BLOCK, Precondition::JACOBI,
                                           Precondition::NONE));

TEST(FrictionSolver, WarmStartNeedsNoIterationAndKeepsEveryBit)
{
  Random random(7);
  const int n = 40;
  const FrictionSystem system = random_system(random, n, true);
  const VectorXd b = with_fixed(random_vector(random, 3 * n));
  VectorXd x = VectorXd::Zero(dcm::STRIDE * (n + 1));
  FrictionSolver<Alone> solver;
  Alone comm;
  ASSERT_EQ(solver.solve(system, b.data(), x.data(), comm).status, FrictionResult::CONVERGED);
  const VectorXd before = x;
  const FrictionResult again = solver.solve(system, b.data(), x.data(), comm, 2.0);
  EXPECT_EQ(again.status, FrictionResult::KEPT);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_TRUE(x == before);

  // a changed force is not mistaken for the old one
  const VectorXd changed = 1.001 * b;
  EXPECT_EQ(solver.solve(system, changed.data(), x.data(), comm, 2.0).status,
            FrictionResult::CONVERGED);
}

TEST(FrictionSolver, NoForceNoMotion)
{
  Random random(8);
  const int n = 10;
  const FrictionSystem system = random_system(random, n, true);
  const VectorXd b = VectorXd::Zero(dcm::STRIDE * (n + 1));
  VectorXd x = with_fixed(random_vector(random, 3 * n));
  FrictionSolver<Alone> solver;
  Alone comm;
  const FrictionResult result = solver.solve(system, b.data(), x.data(), comm, 2.0);
  EXPECT_EQ(result.status, FrictionResult::CONVERGED);
  EXPECT_EQ(x.norm(), 0.0);
}

// an enclosed tissue: no ECM friction anywhere; balanced forces have a solution up to a rigid
// translation, which CG leaves as the initial guess had it; unbalanced ones have none

TEST(FrictionSolver, EnclosedTissueWithBalancedForces)
{
  Random random(9);
  const int n = 40;
  const FrictionSystem system = random_system(random, n, false);
  VectorXd force = random_vector(random, 3 * n);
  Vector3d mean = Vector3d::Zero();
  for (int i = 0; i < n; i++) mean += force.segment<3>(3 * i) / n;
  for (int i = 0; i < n; i++) force.segment<3>(3 * i) -= mean;
  const VectorXd b = with_fixed(force);
  VectorXd x = VectorXd::Zero(dcm::STRIDE * (n + 1));
  FrictionSolver<Alone> solver;
  solver.tolerance = 1e-9;
  Alone comm;
  const FrictionResult result = solver.solve(system, b.data(), x.data(), comm);
  EXPECT_EQ(result.status, FrictionResult::CONVERGED);
  const VectorXd v = without_fixed(x);
  EXPECT_LT((product(system, v) - force).norm(), 2e-9 * force.norm());
  EXPECT_LT(v.norm(), 10.0 * force.norm());    // no runaway translation

  VectorXd pushed = b;
  pushed[dcm::STRIDE] += 1.0;
  x.setZero();
  const auto status = solver.solve(system, pushed.data(), x.data(), comm).status;
  EXPECT_TRUE(status == FrictionResult::NOT_CONVERGED || status == FrictionResult::INDEFINITE);
}

TEST(FrictionSolver, ReportsWhatItCannotSolve)
{
  Random random(10);
  const int n = 20;
  FrictionSystem system = random_system(random, n, true);
  VectorXd b = with_fixed(random_vector(random, 3 * n));
  VectorXd x = VectorXd::Zero(dcm::STRIDE * (n + 1));
  FrictionSolver<Alone> solver;
  Alone comm;

  solver.maxiter = 2;
  FrictionResult result = solver.solve(system, b.data(), x.data(), comm);
  EXPECT_EQ(result.status, FrictionResult::NOT_CONVERGED);
  EXPECT_EQ(result.iterations, 2);
  EXPECT_GT(result.residual, solver.tolerance);
  solver.maxiter = 500;

  VectorXd bad = b;
  bad[dcm::STRIDE + 1] = NAN;
  x.setZero();
  EXPECT_EQ(solver.solve(system, bad.data(), x.data(), comm).status, FrictionResult::NOT_FINITE);

  FrictionSystem broken = system;
  broken.contacts[3].normal = NAN;
  broken.contacts[3].n[0] = 4;
  broken.merge();
  x.setZero();
  EXPECT_EQ(solver.solve(broken, b.data(), x.data(), comm).status, FrictionResult::NOT_FINITE);

  FrictionSystem alone;    // slot 2 has no friction of any kind
  alone.nowned = alone.nall = 3;
  alone.ecm = {0.0, 1.0, 0.0, 1.0};
  alone.iso_edges.push_back({1, 3, 1.0});
  alone.merge();
  const VectorXd three = with_fixed(VectorXd::Ones(9));
  VectorXd v = VectorXd::Zero(three.size());
  result = solver.solve(alone, three.data(), v.data(), comm);
  EXPECT_EQ(result.status, FrictionResult::SINGULAR);
  EXPECT_EQ(result.zero_slot, 2);
}
