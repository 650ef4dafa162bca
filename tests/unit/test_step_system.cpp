// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The system of an implicit step: its product and its solution against the dense matrix, and what
// the scheme does to one mode whose motion is known.

#include "law/step_system.h"
#include "law/cortex.h"
#include "law/friction_solver.h"
#include "law/step_control.h"
#include "helpers.h"

#include <Eigen/Dense>

using namespace dcm;
using namespace dcm_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Alone {
  void forward(double *) {}
  void reverse(double *, int, int) {}
  void sum(double *, int) {}
  void sum_cells(double *, int) {}
};

// a ring of n nodes with dashpots, springs and one volume-like block over all of them
struct Ring {
  FrictionSystem friction;
  StiffnessSystem stiffness;
  int n;

  Ring(int _n, Random &random) : n(_n)
  {
    friction.nowned = friction.nall = n;
    friction.ecm.assign(n + 1, 0.0);
    for (int i = 1; i <= n; i++) {
      const int j = i % n + 1;
      friction.ecm[i] = 0.2 + random.uniform();
      friction.iso_edges.push_back({i, j, 1.0 + random.uniform()});
      const Vec3 r(random.uniform() + 0.2, random.uniform(), random.uniform());
      EdgeBlock spring = cortex_stiffness_block(3.0, 0.8 * r.norm(), r);
      spring.i = i;
      spring.j = j;
      stiffness.edges.push_back(spring);
      stiffness.nodes.push_back({i, {random.uniform(), random.uniform(), random.uniform()}});
    }
    stiffness.cells.push_back({0, stiffness.nodes.size(), 5.0});
    friction.merge();
    stiffness.merge();
  }

  // column by column, from the products of the two parts
  MatrixXd dense(double dt)
  {
    Alone alone;
    MatrixXd all(3 * n, 3 * n);
    std::vector<double> p(STRIDE * (n + 1)), y(p.size());
    for (int c = 0; c < 3 * n; c++) {
      std::fill(p.begin(), p.end(), 0.0);
      p[STRIDE * (1 + c / 3) + c % 3] = 1.0;
      friction.apply(p.data(), y.data());
      stiffness.apply(dt, n + 1, p.data(), y.data(), alone);
      for (int r = 0; r < 3 * n; r++) all(r, c) = y[STRIDE * (1 + r / 3) + r % 3];
    }
    return all;
  }
};

}    // namespace

TEST(StepSystem, solution_is_that_of_the_dense_matrix)
{
  Random random(101, 0, 0);
  Ring ring(7, random);
  Alone alone;
  for (const double dt : {0.1, 3.0, 100.0}) {
    const MatrixXd A = ring.dense(dt);
    EXPECT_LT((A - A.transpose()).norm(), 1e-13 * A.norm());
    EXPECT_GT(A.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
    VectorXd b(3 * ring.n);
    std::vector<double> rhs(STRIDE * (ring.n + 1), 0.0), v(rhs.size(), 0.0);
    for (int r = 0; r < 3 * ring.n; r++)
      rhs[STRIDE * (1 + r / 3) + r % 3] = b[r] = random.uniform() - 0.5;
    FrictionSolver<Alone> solver;
    solver.tolerance = 1e-12;
    const auto found =
        solver.solve(StepSystem(ring.friction, ring.stiffness, dt), rhs.data(), v.data(), alone);
    EXPECT_EQ(found.status, FrictionResult::CONVERGED);
    const VectorXd expected = A.ldlt().solve(b);
    for (int r = 0; r < 3 * ring.n; r++)
      EXPECT_NEAR(v[STRIDE * (1 + r / 3) + r % 3], expected[r], 1e-9 * expected.norm()) << dt;
  }
}

// unknowns that are given: the others solve the reduced system, by elimination in the dense matrix.
// Rows of the given ones, whose own diagonal may be zero, do not matter
TEST(StepSystem, unknowns_that_are_given_are_left_out)
{
  Random random(103, 0, 0);
  Ring ring(7, random);
  Alone alone;
  const double dt = 3.0;
  const MatrixXd A = ring.dense(dt);
  VectorXd b(21), x = VectorXd::Zero(21);
  for (int r = 0; r < 21; r++) b[r] = random.uniform() - 0.5;
  std::vector<int> free, held;
  for (int r = 0; r < 21; r++) (r / 3 == 1 || r / 3 == 4 ? held : free).push_back(r);
  for (const int r : held) x[r] = random.uniform() - 0.5;
  const VectorXd less = b - A * x;
  const int n = (int) free.size();
  MatrixXd inner(n, n);
  VectorXd right(n);
  for (int r = 0; r < n; r++) {
    right[r] = less[free[r]];
    for (int c = 0; c < n; c++) inner(r, c) = A(free[r], free[c]);
  }
  const VectorXd solved = inner.ldlt().solve(right);
  for (int r = 0; r < n; r++) x[free[r]] = solved[r];
  std::vector<double> rhs(STRIDE * 8, 0.0), v(rhs.size(), 0.0);
  for (const int r : free) rhs[STRIDE * (1 + r / 3) + r % 3] = less[r];
  for (const auto how : {Precondition::BLOCK, Precondition::JACOBI, Precondition::NONE}) {
    std::fill(v.begin(), v.end(), 0.0);
    FrictionSolver<Alone> solver;
    solver.tolerance = 1e-12;
    solver.precondition = how;
    solver.given = {2, 5};
    const auto found =
        solver.solve(StepSystem(ring.friction, ring.stiffness, dt), rhs.data(), v.data(), alone);
    EXPECT_EQ(found.status, FrictionResult::CONVERGED);
    for (const int r : free) EXPECT_NEAR(v[STRIDE * (1 + r / 3) + r % 3], x[r], 1e-9 * x.norm());
    for (const int r : held) EXPECT_EQ(v[STRIDE * (1 + r / 3) + r % 3], 0.0);
  }
}

// one spring between two nodes: its length relaxes as u' = -2 ks/gamma u, gamma on each node. Euler
// backward: u/(1 + 2 ks dt/gamma) each step, for any dt, since the force is linear along the edge
TEST(StepSystem, one_spring_relaxes_as_backward_euler_does)
{
  const double ks = 2.0, gamma = 0.5;
  for (const double dt : {0.01, 1.0, 1e4}) {
    double x[2] = {0.0, 1.3};
    const double l0 = 1.0, u0 = x[1] - x[0] - l0;
    Alone alone;
    double u = u0;
    for (int step = 0; step < 5; step++) {
      FrictionSystem friction;
      StiffnessSystem stiffness;
      friction.nowned = friction.nall = 2;
      friction.ecm = {0.0, gamma, gamma};
      friction.merge();
      EdgeBlock spring = cortex_stiffness_block(ks, l0, Vec3(x[1] - x[0], 0.0, 0.0));
      spring.i = 1;
      spring.j = 2;
      stiffness.edges.push_back(spring);
      stiffness.merge();
      const double f = ks * (x[1] - x[0] - l0);
      std::vector<double> rhs = {0, 0, 0, 0, f, 0, 0, 0, -f, 0, 0, 0}, v(12, 0.0);
      FrictionSolver<Alone> solver;
      solver.tolerance = 1e-14;
      solver.solve(StepSystem(friction, stiffness, dt), rhs.data(), v.data(), alone);
      x[0] += dt * v[4];
      x[1] += dt * v[8];
      u /= 1.0 + 2.0 * ks * dt / gamma;
      EXPECT_NEAR(x[1] - x[0] - l0, u, 1e-7 * u0) << dt;    // K in single precision
      EXPECT_NEAR(x[0] + x[1], 1.3, 1e-12);
    }
  }
}

TEST(StepControl, steps_are_on_a_grid_between_the_limits)
{
  StepControl control;
  control.tolerance = 0.01;
  control.least = 1.0;
  control.longest = 64.0;
  EXPECT_EQ(control.round_down(100.0), 64.0);
  EXPECT_EQ(control.round_down(64.0), 64.0);
  EXPECT_EQ(control.round_down(32.0), 32.0);
  EXPECT_NEAR(control.round_down(63.9), 64.0 * std::exp2(-0.25), 1e-12);
  EXPECT_EQ(control.round_down(0.3), 1.0);
  for (double h = 1.0; h < 64.0; h *= 1.07) {
    const double down = control.round_down(h);
    EXPECT_LE(down, h * (1.0 + 1e-12));
    EXPECT_GE(down, std::max(1.0, h * std::exp2(-0.25)) * (1.0 - 1e-9));
    EXPECT_NEAR(control.round_down(down), down, 1e-12 * down);    // stays where it is
    const double k = 4.0 * std::log2(64.0 / down);
    if (down > 1.0) {
      EXPECT_NEAR(k, std::round(k), 1e-9);
    }
    EXPECT_LE(control.next(h, 0.0), 1.5 * h * (1.0 + 1e-12));
  }
  EXPECT_TRUE(control.accepts(1.0, 1e9));
  EXPECT_TRUE(control.accepts(64.0, 0.02));
  EXPECT_FALSE(control.accepts(64.0, 0.0201));
  EXPECT_NEAR(control.allowed(16.0), 0.005, 1e-15);
}

TEST(StepControl, a_step_ends_at_an_event_and_leaves_no_short_one_before_it)
{
  StepControl control;
  control.least = 1.0;
  control.longest = 64.0;
  EXPECT_EQ(control.until(10.0, 1e300), 10.0);
  EXPECT_EQ(control.until(10.0, 25.0), 10.0);
  EXPECT_EQ(control.until(10.0, 12.0), 6.0);
  EXPECT_EQ(control.until(10.0, 10.0), 10.0);
  EXPECT_EQ(control.until(10.0, 4.0), 4.0);
  EXPECT_EQ(control.until(10.0, 0.25), 1.0);    // not below the shortest: past it
  EXPECT_EQ(control.until(0.5, 0.25), 0.5);
}

// v = a t: the estimate is the step's error a h^2/2 itself, and the steps settle where that is what
// is allowed, tol sqrt(h/longest), but for the safety factor and the grid
TEST(StepControl, settles_where_the_error_is_what_is_allowed)
{
  StepControl control;
  control.tolerance = 0.02;
  control.least = 1e-3;
  control.longest = 60.0;
  for (const double a : {1e-6, 1e-4, 1e-2}) {
    double h = 1.0;
    for (int step = 0; step < 60; step++) {
      double err = 0.5 * h * h * a;
      while (!control.accepts(h, err)) {
        h = control.next(h, err);
        err = 0.5 * h * h * a;
      }
      h = control.next(h, err);
    }
    const double ideal = std::pow(2.0 * control.tolerance / (a * std::sqrt(60.0)), 2.0 / 3.0);
    const double expected = std::min(60.0, 0.9 * ideal);
    EXPECT_LE(h, expected * (1.0 + 1e-9)) << a;
    EXPECT_GE(h, expected * std::exp2(-0.5)) << a;
  }
}
