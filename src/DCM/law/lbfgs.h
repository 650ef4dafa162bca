// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Minimum of a smooth function of many points in space: limited-memory BFGS (Nocedal & Wright,
// Numerical Optimization, chapter 7) with a bracketing line search for the weak Wolfe conditions.
// Bounded work, no exceptions; a function value that is not finite counts as too high.

#ifndef DCM_LBFGS_H
#define DCM_LBFGS_H

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

// GCC 12 takes what its own AVX-512 intrinsics leave undefined on purpose for a use of an
// uninitialized variable (GCC bug 105593), in every dot product below
#if __GNUC__ == 12
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace dcm {

/// Remembers the last steps and gradient changes of one minimization. The history may outlive a
/// small change of the function between two steps.
class Lbfgs {
 public:
  using Vector = Eigen::VectorXd;

  explicit Lbfgs(int pairs = 20) : memory(pairs) {}

  /// One step downhill. f(x, g) returns the value and fills the gradient g. On entry `value` and
  /// g belong to x; on success (true) all three have moved on. longest: bound on the change of
  /// any one variable. stiffness: second derivative expected, for the first step only.
  /// False: no lower point found, also not along the gradient; nothing has changed.
  template <class Function>
  bool step(Function &&f, Vector &x, double &value, Vector &g, double longest, double stiffness)
  {
    for (int attempt = 0; attempt < 2; attempt++) {
      direction(g, stiffness);
      if (!(d.dot(g) < 0.0)) {    // round-off spoilt the history
        pairs.clear();
        d = -g / stiffness;
        if (!(d.dot(g) < 0.0)) return false;
      }
      // of points, not of coordinates: the same steps whichever way the system is turned
      const double largest =
          Eigen::Map<const Eigen::Matrix3Xd>(d.data(), 3, d.size() / 3).colwise().norm().maxCoeff();
      if (largest > longest) d *= longest / largest;
      if (search(f, x, value, g)) return true;
      if (pairs.empty()) return false;
      pairs.clear();    // once more along the gradient
    }
    return false;
  }

 private:
  struct Pair {
    Vector s, y;
    double sy;
  };

  static constexpr double ARMIJO = 1.0e-4, WOLFE = 0.9;
  static constexpr double ROUND_OFF = 1.0e-14;    // of the value: below, the slope decides alone
  static constexpr int TRIALS = 40;

  size_t memory;
  std::vector<Pair> pairs;    // oldest first
  Vector d, trial, gtrial;

  // two-loop recursion: d = -(approximate inverse Hessian) g
  void direction(const Vector &g, double stiffness)
  {
    std::vector<double> a(pairs.size());
    d = -g;
    for (size_t i = pairs.size(); i-- > 0;) {
      a[i] = pairs[i].s.dot(d) / pairs[i].sy;
      d -= a[i] * pairs[i].y;
    }
    d *= pairs.empty() ? 1.0 / stiffness : pairs.back().sy / pairs.back().y.squaredNorm();
    for (size_t i = 0; i < pairs.size(); i++)
      d += (a[i] - pairs[i].y.dot(d) / pairs[i].sy) * pairs[i].s;
  }

  // The full step first; halve where the value is too high, double where the slope is too steep.
  // A point that is low enough but still too steep is taken if the trials run out.
  template <class Function> bool search(Function &&f, Vector &x, double &value, Vector &g)
  {
    const double slope = d.dot(g), slack = ROUND_OFF * std::fabs(value);
    double low = 0.0, high = std::numeric_limits<double>::infinity(), t = 1.0;
    for (int i = 0; i < TRIALS; i++) {
      trial = x + t * d;
      const double v = f(trial, gtrial);
      const bool fine = std::isfinite(v) && gtrial.allFinite();
      if (!fine || v > value + ARMIJO * t * slope + slack) {
        high = t;
      } else if (gtrial.dot(d) < WOLFE * slope && i + 1 < TRIALS && t < 4.0) {
        low = t;    // t < 4: the caller's bound on the step holds within this factor
      } else {
        accept(x, value, g, v);
        return true;
      }
      t = std::isfinite(high) ? 0.5 * (low + high) : 2.0 * t;
      if (t == low || t == high) break;
    }
    return false;
  }

  void accept(Vector &x, double &value, Vector &g, double v)
  {
    Pair pair = {trial - x, gtrial - g, 0.0};
    pair.sy = pair.s.dot(pair.y);
    if (pair.sy > 1.0e-12 * pair.s.norm() * pair.y.norm()) {    // keeps the matrix positive
      if (pairs.size() == memory) pairs.erase(pairs.begin());
      pairs.push_back(std::move(pair));
    }
    x = trial;
    g = gtrial;
    value = v;
  }
};

}    // namespace dcm

#if __GNUC__ == 12
#pragma GCC diagnostic pop
#endif

#endif
