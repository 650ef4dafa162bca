// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The minimizer against functions whose minimum is known.

#include "law/lbfgs.h"
#include "helpers.h"

#include <Eigen/Dense>

#include <limits>

using namespace dcm;
using namespace dcm_test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double ANYWHERE = 1.0e300;

// x^T A x / 2 - b^T x
struct Quadratic {
  MatrixXd A;
  VectorXd b;
  int calls = 0;
  double operator()(const VectorXd &x, VectorXd &g)
  {
    calls++;
    g = A * x - b;
    return 0.5 * x.dot(A * x) - b.dot(x);
  }
};

// positive definite with eigenvalues from 1 to `condition`
Quadratic random_quadratic(Random &random, int points, double condition)
{
  const int n = 3 * points;
  MatrixXd q = MatrixXd::NullaryExpr(n, n, [&]() {
    return random.gaussian();
  });
  const MatrixXd basis = Eigen::HouseholderQR<MatrixXd>(q).householderQ();
  const VectorXd values = VectorXd::LinSpaced(n, 0.0, std::log(condition)).array().exp().matrix();
  Quadratic f;
  f.A = basis * values.asDiagonal() * basis.transpose();
  f.b = VectorXd::NullaryExpr(n, [&]() {
    return random.gaussian();
  });
  return f;
}

// steps until the gradient is below `goal`; every one must lead down, -1: not in `most` steps
template <class Function>
int minimize(Function &f, VectorXd &x, double goal, double longest, double stiffness, int most)
{
  Lbfgs minimizer;
  VectorXd g;
  double value = f(x, g);
  for (int step = 0; step < most; step++) {
    if (g.norm() < goal) return step;
    const VectorXd before = x;
    const double old = value;
    if (!minimizer.step(f, x, value, g, longest, stiffness)) return -1;
    EXPECT_LE(value, old + 1.0e-13 * std::fabs(old));
    VectorXd fresh;
    EXPECT_EQ(f(x, fresh), value);    // value and gradient belong to x
    EXPECT_EQ(fresh, g);
    for (int i = 0; i < x.size(); i += 3)
      EXPECT_LE((x - before).segment<3>(i).norm(), 4.0 * longest * (1.0 + 1.0e-12));
  }
  return -1;
}

}    // namespace

TEST(Lbfgs, Quadratic)
{
  Random random(81, 0, 0);
  for (double condition : {1.0, 30.0, 1.0e3}) {
    Quadratic f = random_quadratic(random, 10, condition);
    const VectorXd target = f.A.ldlt().solve(f.b);
    VectorXd x = VectorXd::Constant(30, 3.0);
    const int steps = minimize(f, x, 1.0e-9, ANYWHERE, 1.0, 400);
    ASSERT_GE(steps, 0) << condition;
    EXPECT_LT((x - target).norm(), 1.0e-8);
    // Newton's direction from the first step on where the stiffness is right for all variables
    if (condition == 1.0) {
      EXPECT_EQ(steps, 1);
    }
  }
}

TEST(Lbfgs, StepsAreBounded)
{
  Random random(82, 0, 0);
  Quadratic f = random_quadratic(random, 5, 10.0);
  const VectorXd target = f.A.ldlt().solve(f.b);
  VectorXd x = VectorXd::Constant(15, 20.0);
  // minimize() looks at every step; 20 sqrt 3 away in steps of at most 4 x 0.1
  const int steps = minimize(f, x, 1.0e-9, 0.1, 1.0, 2000);
  EXPECT_GE(steps, int((20.0 * std::sqrt(3.0) - target.norm()) / 0.4));
  EXPECT_LT((x - target).norm(), 1.0e-8);
}

TEST(Lbfgs, CurvedValley)
{
  // Rosenbrock's function, twice, in the coordinates of two points
  auto f = [](const VectorXd &x, VectorXd &g) {
    double value = 0.0;
    g.setZero(x.size());
    for (int i = 0; i < x.size(); i += 2) {
      const double u = 1.0 - x[i], v = x[i + 1] - x[i] * x[i];
      value += u * u + 100.0 * v * v;
      g[i] += -2.0 * u - 400.0 * v * x[i];
      g[i + 1] += 200.0 * v;
    }
    return value;
  };
  VectorXd x(6);
  x << -1.2, 1.0, 0.0, 3.0, 2.0, -1.0;
  ASSERT_GE(minimize(f, x, 1.0e-10, ANYWHERE, 100.0, 300), 0);
  EXPECT_LT((x - VectorXd::Ones(6)).norm(), 1.0e-9);
}

TEST(Lbfgs, KeepsOffWhereThereIsNoValue)
{
  // x - ln x: minimum at 1, infinite for x <= 0, where the first full step would lead
  for (double none : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    int outside = 0;
    auto f = [&](const VectorXd &x, VectorXd &g) {
      g.setZero(x.size());
      if (x.minCoeff() <= 0.0) {
        outside++;
        return none;
      }
      g = 1.0 - x.array().inverse();
      return x.sum() - x.array().log().sum();
    };
    VectorXd x(3), g;
    x << 5.0, 0.4, 30.0;
    ASSERT_GE(minimize(f, x, 1.0e-10, ANYWHERE, 0.01, 200), 0);
    EXPECT_LT((x - VectorXd::Ones(3)).norm(), 1.0e-9);
    EXPECT_GT(outside, 0);
  }
}

TEST(Lbfgs, NothingChangesWithoutALowerPoint)
{
  Random random(83, 0, 0);
  Quadratic f = random_quadratic(random, 2, 4.0);
  f.b.setZero();
  VectorXd x = VectorXd::Zero(6), g;
  double value = f(x, g);
  Lbfgs minimizer;
  EXPECT_FALSE(minimizer.step(f, x, value, g, 1.0, 1.0));    // at the minimum
  EXPECT_EQ(x, VectorXd::Zero(6));
  EXPECT_EQ(value, 0.0);

  // a gradient that lies: uphill either way, and bounded work to find out
  int calls = 0;
  auto lie = [&](const VectorXd &y, VectorXd &gy) {
    calls++;
    gy = -y;
    return 0.5 * y.squaredNorm();
  };
  x.setOnes();
  value = lie(x, g);
  const VectorXd before = g;
  EXPECT_FALSE(minimizer.step(lie, x, value, g, 1.0, 1.0));
  EXPECT_EQ(x, VectorXd::Ones(6));
  EXPECT_EQ(g, before);
  EXPECT_EQ(value, 3.0);
  EXPECT_LT(calls, 100);
}

TEST(Lbfgs, StepsTurnWithTheSystem)
{
  // springs between points, bounded steps: the same way in turned coordinates
  Random random(84, 0, 0);
  const int points = 6;
  Points rest;
  for (int i = 0; i < points; i++) rest.push_back(random.gaussian_vector());
  auto springs = [&](const VectorXd &x, VectorXd &g) {
    double value = 0.0;
    g.setZero(x.size());
    for (int i = 0; i < points; i++)
      for (int j = 0; j < i; j++) {
        const Vec3 d = x.segment<3>(3 * i) - x.segment<3>(3 * j);
        const double l = d.norm(), stretch = l - (rest[i] - rest[j]).norm();
        value += 0.5 * stretch * stretch;
        g.segment<3>(3 * i) += stretch / l * d;
        g.segment<3>(3 * j) -= stretch / l * d;
      }
    return value;
  };
  const Mat3 R = random_rotation(random);
  VectorXd x(3 * points), y(3 * points), gx, gy;
  for (int i = 0; i < points; i++) {
    x.segment<3>(3 * i) = 2.0 * rest[i] + 0.3 * random.gaussian_vector();
    y.segment<3>(3 * i) = R * x.segment<3>(3 * i);
  }
  Lbfgs first, second;
  double a = springs(x, gx), b = springs(y, gy);
  for (int step = 0; step < 8; step++) {
    ASSERT_TRUE(first.step(springs, x, a, gx, 0.2, 1.0));
    ASSERT_TRUE(second.step(springs, y, b, gy, 0.2, 1.0));
    EXPECT_NEAR(a, b, 1.0e-10 * a);
    for (int i = 0; i < points; i++)
      EXPECT_LT((R * x.segment<3>(3 * i) - y.segment<3>(3 * i)).norm(), 1.0e-9);
  }
}
