// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact law `maugis`: Maugis-Dugdale adhesion of elastic half-spaces (S1 "Contact model").
// See contact_law.h for the interface. In the units
//
//   K = 4E/3, unit_d = (pi^2 W^2 R/K^2)^(1/3), unit_a = sqrt(R unit_d),
//   lambda = 2 sigma0 (R/(pi W K^2))^(1/3), A = a/unit_a, C = c/unit_a, D = delta/unit_d
//
// and with y = sqrt(c^2/a^2 - 1) the first Maugis equation is a quadratic for A, so that the whole
// branch A(y), D(y) is explicit and only D(y) = D has to be inverted. D(y) falls from infinity (y
// = 0, Hertz) to the pull-off under displacement control, which is never above D = -h0/unit_d:
// there is exactly one state for every overlap delta > -h0.
// For small lambda the branch ends at a = 0 before that; it goes on as cohesive contact without
// touch (uniform traction over r < c, Kim, McMeeking & Johnson 1998), which closes the gap between
// a = 0 and delta = -h0 continuously and gives the DMT limit.
//
// A new contact needs delta > -h0. With `existing` the stretched neck is followed further, down to
// the pull-off under displacement control (-0.91 unit_d for large lambda).

#ifndef DCM_MAUGIS_H
#define DCM_MAUGIS_H

#include "contact_law.h"

namespace dcm {

struct MaugisState : RadialLaw<MaugisState> {
  static constexpr bool EXACT_CORE = false;
  static constexpr bool LOCAL_GAP = false;
  double hertz = 0.0;        ///< 2 E/(pi R)
  double k = 0.0;            ///< c^2 - a^2
  double root_k = 0.0;       ///< sqrt(k)
  double dugdale = 0.0;      ///< sigma0/pi
  double core_base = 0.0;    ///< value of the Dugdale part of Q0 at r = 0
  double lambda = 0.0;       ///< Maugis parameter, 0 if W = 0
  int iterations = 0;        ///< Newton steps of the last set()

  /// C <= sqrt(D) + sqrt(1.4^2 + 2 h0/unit_d): JKR and rigid limits combined; checked over all
  /// lambda by the unit test.
  static double reach(const ContactMaterial &m, double R, double delta, bool = false)
  {
    const double open = std::sqrt(R * std::max(delta, 0.0));
    if (!(m.W > 0.0)) return open;
    const double K = 4.0 / 3.0 * m.E;
    const double unit_d = PI * m.W * std::cbrt(R / (PI * m.W * K * K));
    return open + std::sqrt(R * (1.96 * unit_d + 2.0 * m.h0));
  }

  bool set(const ContactMaterial &m, double R, double delta, bool existing = false)
  {
    clear();
    lambda = 0.0;
    iterations = 0;
    k = root_k = dugdale = core_base = 0.0;
    if (!(R > 0.0) || !(m.E > 0.0)) return false;
    if (!(delta > m.first_touch()) && !(existing && m.W > 0.0)) return false;
    hertz = 2.0 * m.E / (PI * R);
    sigma0 = m.sigma0();
    if (!(sigma0 > 0.0)) {
      if (!(delta > 0.0)) return false;
      a = c = std::sqrt(R * delta);
    } else {
      const double K = 4.0 / 3.0 * m.E;
      const double s = std::cbrt(R / (PI * m.W * K * K));
      const double unit_d = PI * m.W * s;
      const double unit_a = std::sqrt(R * unit_d);
      lambda = 2.0 * sigma0 * s;
      double A, y, C;
      if (!solve(lambda, delta / unit_d, A, y, C, iterations)) {
        clear();
        return false;
      }
      a = A * unit_a;
      c = C * unit_a;
      root_k = A > 0.0 ? a * y : c;
      k = root_k * root_k;
      dugdale = sigma0 / PI;
      // B(0), see core_q0
      core_base = A > 0.0 ? c * c * detail::atan_quadrant(y, 1.0) + root_k * a : 0.5 * PI * c * c;
    }
    // primitives at r = a, where asin sqrt(k/w) = theta = pi/2
    const double a3 = a * a * a;
    Q0a = hertz * a3 / 3.0 + dugdale * (0.5 * PI * k - core_base);
    Q1a = hertz * PI / 16.0 * a * a3 -
          dugdale * PI / 3.0 * (a3 + root_k * (0.5 * a * a + c * c) - c * c * c);
    finish_ring();
    return true;
  }

  double core_p(double r2) const
  {
    const double w = std::sqrt(std::max(0.0, a * a - r2));
    return hertz * w - 2.0 * dugdale * (w + root_k > 0.0 ? detail::atan_quadrant(root_k, w) : 0.0);
  }

  void core(double r2, double &q0, double &q1) const
  {
    const double a2 = a * a, c2 = c * c;
    const double w = std::sqrt(std::max(0.0, a2 - r2));
    q0 = hertz * detail::hertz_q0(a, w);
    if (!(root_k > 0.0) || r2 < SERIES * a2) {
      q1 = hertz * detail::hertz_q1(a, r2, w);
      if (root_k > 0.0) {
        q0 += dugdale_series(r2, 0);
        q1 += dugdale_series(r2, 1);
      }
      return;
    }
    const double r = std::sqrt(r2), inv = 1.0 / (r * r2);
    const double phi = detail::atan_quadrant(root_k, w);    // asin sqrt(k/(c^2-r^2))
    const double theta = detail::atan_quadrant(r, w);       // asin(r/a)
    const double psi = detail::atan_quadrant(root_k * r, c * w);
    // B(r) - B(0), B = (c^2-r^2) phi + sqrt(k (a^2-r^2))
    q0 += dugdale * ((c2 - r2) * phi + root_k * w - core_base) * (r * inv);
    const double bracket = c2 * c * psi - root_k * (0.5 * (a2 * theta - r * w) + c2 * theta);
    q1 = 0.125 * hertz * (a2 * a2 * theta - r * (a2 - 2.0 * r2) * w) * inv -
         2.0 / 3.0 * dugdale * (phi - bracket * inv);
  }

  /// Dimensionless state for Maugis parameter lambda and overlap D: contact radius A, y =
  /// sqrt(c^2/a^2 - 1), cohesive radius C. The branch of largest A. False beyond pull-off.
  static bool solve(double lambda, double D, double &A, double &y, double &C, int &iterations)
  {
    // end of the touching branch, A = 0: pi lambda C^2/4 + (4 lambda^2/3)(pi/2 - 1) C = 1
    const double b0 = 4.0 / 3.0 * lambda * lambda * (0.5 * PI - 1.0);
    const double C0 = 2.0 / (b0 + std::sqrt(b0 * b0 + PI * lambda));
    const double D0 = -4.0 / 3.0 * lambda * C0;
    const double h = 2.0 / (PI * lambda);
    iterations = 0;
    if (D <= D0 && D > -h) return untouched(lambda, D + h, A, y, C);

    double upper = 40.0;    // of ln y
    if (D <= -h) {
      double Dmin;
      upper = pull_off(lambda, Dmin);
      if (D < Dmin)
        return D <= D0 && Dmin >= D0 * (1.0 + 1e-12) && C0 > 8.0 * lambda / (3.0 * PI)
                   ? untouched(lambda, D + h, A, y, C)
                   : false;
    }

    invert(lambda, D, start(lambda, D, D0), -40.0, upper, A, y, iterations);
    C = A * std::sqrt(1.0 + y * y);
    return true;
  }

  /// D on the touching branch, its derivative with respect to y, and A.
  static double branch(double lambda, double y, double &A, double &slope)
  {
    double dA;
    return branch(lambda, y, A, slope, dA);
  }

  static double branch(double lambda, double y, double &A, double &slope, double &dA)
  {
    double phi;
    const double f = detail::gap_function(y, phi);
    const double y2 = y * y, m = std::sqrt(1.0 + y2);
    const double c1 = 4.0 / 3.0 * lambda * lambda;
    const double b = c1 * y * (phi - y / (1.0 + m));
    const double S = std::sqrt(b * b + 2.0 * lambda * f);
    const double q = y / (1.0 + y2);
    const double df = 2.0 * y * (phi + q);
    const double db = c1 * (phi + q - y / m);
    A = 2.0 / (b + S);
    dA = -A * (0.5 * lambda * df * A + db) / S;
    slope = 2.0 * A * dA - 4.0 / 3.0 * lambda * (A + y * dA);
    return A * A - 4.0 / 3.0 * A * lambda * y;
  }

 private:
  static constexpr double SERIES = 1e-3;    ///< (r/a)^2 below which the closed forms cancel

  /// Cohesive contact with a = 0: C^2/2 - (8 lambda/(3 pi)) C = D + h0.
  static bool untouched(double lambda, double gap, double &A, double &y, double &C)
  {
    const double q = 8.0 * lambda / (3.0 * PI);
    const double disc = q * q + 2.0 * gap;
    if (!(disc >= 0.0)) return false;
    A = y = 0.0;
    C = q + std::sqrt(disc);
    return true;
  }

  /// Safeguarded Newton iteration for ln y in [lo, hi] from s; bisection where Newton leaves the
  /// bracket, so it ends for any start.
  static void invert(double lambda, double D, double s, double lo, double hi, double &A, double &y,
                     int &iterations)
  {
    s = std::min(s, hi);
    y = std::exp(s);
    for (iterations = 1; iterations < 80; iterations++) {
      double slope, dA;
      const double err = branch(lambda, y, A, slope, dA) - D;
      if (err > 0.0)
        lo = s;
      else
        hi = s;
      double step = -err / (y * slope);
      if (std::fabs(step) < 2e-7) {    // quadratic: the rest is below round-off of D
        A += dA * y * step;
        y += y * step;
        return;
      }
      step = std::min(std::max(step, -3.0), 3.0);
      if (!(s + step > lo && s + step < hi)) step = 0.5 * (lo + hi) - s;
      s += step;
      y = std::fabs(step) < 0.01 ? y * (1.0 + step * (1.0 + 0.5 * step)) : std::exp(s);
    }
  }

  /// Rough ln y: A between Hertz-DMT and JKR, y from the limits of the first equation.
  static double rough_start(double lambda, double D)
  {
    const double l2 = lambda * lambda;
    const double A = std::sqrt(std::max(D, 0.0) + 1.92 * l2 / (l2 + 0.5) + 0.05);
    const double ya = std::cbrt(1.5 / (lambda * A * A));
    const double yb = std::sqrt(1.5 / A) / lambda;
    return std::log(ya * yb / (ya + yb));
  }

  /// Table of ln y over ln lambda and ln(D - D0), where it is smooth, for the start of the
  /// iteration only: the result does not depend on it.
  struct StartTable {
    static constexpr int NL = 40, NT = 100;
    static constexpr double L0 = -5.3, DL = 11.0 / (NL - 1);    // lambda 0.005 to 300
    static constexpr double T0 = -9.3, DT = 21.0 / (NT - 1);    // D - D0 1e-4 to 1e5
    double value[NL][NT];

    StartTable()
    {
      for (int i = 0; i < NL; i++) {
        const double lambda = std::exp(L0 + i * DL);
        const double D0 = touch_end(lambda);
        double Dmin;
        const double upper = pull_off(lambda, Dmin);
        for (int j = 0; j < NT; j++) {
          // below the pull-off there is nothing: any smooth value will do
          const double D = std::max(D0 + std::exp(T0 + j * DT), Dmin + 1e-3);
          double A, y;
          int it;
          invert(lambda, D, rough_start(lambda, D), -40.0, upper, A, y, it);
          value[i][j] = std::log(y);
        }
      }
    }
  };

  static double start(double lambda, double D, double D0)
  {
    static const StartTable table;
    const double l = (std::log(lambda) - StartTable::L0) / StartTable::DL;
    const double t = D > D0 ? (std::log(D - D0) - StartTable::T0) / StartTable::DT : -1.0;
    if (!(l >= 1.0 && l < StartTable::NL - 2.0 && t >= 1.0 && t < StartTable::NT - 2.0))
      return rough_start(lambda, D);
    const int i = static_cast<int>(l), j = static_cast<int>(t);
    double wl[4], wt[4];
    cubic(l - i, wl);
    cubic(t - j, wt);
    double sum = 0.0;
    for (int p = 0; p < 4; p++) {
      const double *v = &table.value[i - 1 + p][j - 1];
      sum += wl[p] * (wt[0] * v[0] + wt[1] * v[1] + wt[2] * v[2] + wt[3] * v[3]);
    }
    return sum;
  }

  /// Weights of the cubic through the points -1, 0, 1, 2 at x.
  static void cubic(double x, double w[4])
  {
    w[0] = -x * (x - 1.0) * (x - 2.0) / 6.0;
    w[1] = (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0;
    w[2] = -(x + 1.0) * x * (x - 2.0) / 2.0;
    w[3] = (x + 1.0) * x * (x - 1.0) / 6.0;
  }

  /// D at the end of the touching branch, a = 0.
  static double touch_end(double lambda)
  {
    const double b0 = 4.0 / 3.0 * lambda * lambda * (0.5 * PI - 1.0);
    return -8.0 / 3.0 * lambda / (b0 + std::sqrt(b0 * b0 + PI * lambda));
  }

  /// ln y of the smallest overlap on the touching branch, for necks only.
  static double pull_off(double lambda, double &Dmin)
  {
    double lo = -40.0, hi = 18.0, A, slope;
    for (int it = 0; it < 60; it++) {
      const double mid = 0.5 * (lo + hi);
      branch(lambda, std::exp(mid), A, slope);
      if (slope < 0.0)
        lo = mid;
      else
        hi = mid;
    }
    Dmin = branch(lambda, std::exp(lo), A, slope);
    return lo;
  }

  /// Dugdale part of Q0/r^2 (moment 0) or Q1/r^3 (moment 1) as a power series in r^2.
  double dugdale_series(double r2, int moment) const
  {
    const double a2 = a * a, c2 = c * c;
    const double al = 1.0 / a2, ga = 1.0 / c2;
    const double scale = 0.5 * root_k / (a * c2) * r2;
    const double v1 = 0.5 * al + ga;
    const double v2 = 0.375 * al * al + 0.5 * al * ga + ga * ga;
    const double v3 =
        0.3125 * al * al * al + 0.375 * al * al * ga + 0.5 * al * ga * ga + ga * ga * ga;
    const double phi0 = detail::atan_quadrant(root_k, a);
    // int_0^1 phi(r x) x^(1+moment) dx
    const double e = 2.0 + moment;
    const double sum =
        phi0 / e + scale * (1.0 / (e + 2.0) +
                            r2 * (v1 / (2.0 * (e + 4.0)) +
                                  r2 * (v2 / (3.0 * (e + 6.0)) + r2 * v3 / (4.0 * (e + 8.0)))));
    return -2.0 * dugdale * sum;
  }
};

}    // namespace dcm

#endif
