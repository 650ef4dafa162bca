// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact law `dmt`: Hertz pressure inside a = sqrt(R delta), cohesive traction -W/h0 where the
// gap of the Hertz solution lies in (0, h0). Continuous in delta, derives from a potential, force
// -2 pi W R at first touch (delta = 0), work of separation of two flats exactly W. The pull-off
// force is 2 pi W R in the law's own limit, small Maugis parameter (lambda < 0.1, see
// maugis.h); beyond, tension goes on growing after first touch: 2.04 pi W R at lambda =
// 0.5, 2.14 at 1, 2.61 at 3, 3.77 at 10. See contact_law.h for the interface.

#ifndef DCM_DMT_H
#define DCM_DMT_H

#include "contact_law.h"

namespace dcm {

struct DmtState : RadialLaw<DmtState> {
  static constexpr bool EXACT_CORE = true;
  static constexpr bool LOCAL_GAP = false;
  double hertz = 0.0;    ///< 2 E/(pi R)

  /// The Hertz gap exceeds that of the undeformed spheres, whence the bound on c.
  static double reach(const ContactMaterial &m, double R, double delta, bool = false)
  {
    return std::sqrt(std::max(0.0, 2.0 * R * (delta - m.first_touch())));
  }

  bool set(const ContactMaterial &m, double R, double delta, bool = false)
  {
    clear();
    if (!(R > 0.0) || !(delta > m.first_touch())) return false;
    sigma0 = m.sigma0();
    hertz = 2.0 * m.E / (PI * R);
    if (delta > 0.0) {
      a = std::sqrt(R * delta);
      Q0a = hertz * a * a * a / 3.0;
      Q1a = hertz * PI / 16.0 * a * a * a * a;
    }
    c = sigma0 > 0.0 ? cohesive_radius(R, delta, m.h0) : a;
    finish_ring();
    return true;
  }

  void core(double r2, double &q0, double &q1) const
  {
    const double w = std::sqrt(std::max(0.0, a * a - r2));
    q0 = hertz * detail::hertz_q0(a, w);
    q1 = hertz * detail::hertz_q1(a, r2, w);
  }

  /// The integrals over a straight edge in the core, in closed form: the edge at signed distance h
  /// from the axis, from t0 to t1 along it. f = int p dA, moments across and along the edge.
  /// By parts, with w = sqrt(a^2-r^2) and dQ1 = r dQ0 = p r^2 dr:
  ///   int Q0 h/r^2 dt   = (k/3) [a^3 (theta - chi) + h (3a^2-h^2)/2 asin(t/b) + h t w/2],
  ///                       tan theta = t/h, tan chi = a t/(h w), b^2 = a^2 - h^2, k = 2 E/(pi R)
  ///   int Q1 h t/r^3 dt = h [Q0 - Q1/r],   int Q1 h^2/r^3 dt = [Q1 t/r] - int p t^2 dt
  /// slope: int (a - w) h/r^2 dt = a (theta - chi) + h asin(t/b), the edge integral of the slope
  /// dp/d delta = (E/pi)/w over E/pi.
  template <bool SLOPE = false>
  void core_edge(double h, double t0, double t1, double &f, double &normal, double &along,
                 [[maybe_unused]] double *slope = nullptr) const
  {
    const double a2 = a * a, a3 = a * a2, h2 = h * h, b2 = std::max(0.0, a2 - h2);
    const double s0 = t0 * t0, s1 = t1 * t1;
    const double w0 = std::sqrt(std::max(0.0, b2 - s0)), w1 = std::sqrt(std::max(0.0, b2 - s1));
    const double r0 = std::sqrt(h2 + s0), r1 = std::sqrt(h2 + s1);
    // theta - chi at both ends: arguments of complex numbers of positive real part
    const double re0 = h2 * w0 + a * s0, im0 = h * t0 * (w0 - a);
    const double re1 = h2 * w1 + a * s1, im1 = h * t1 * (w1 - a);
    const double lag = detail::angle(im1 * re0 - re1 * im0, re0 * re1 + im0 * im1);
    const double arc = detail::angle(t1 * w0 - t0 * w1, w0 * w1 + t0 * t1);
    if constexpr (SLOPE) *slope = a * lag + h * arc;
    const double k3 = hertz / 3.0;
    f = k3 * (a3 * lag + 0.5 * h * ((3.0 * a2 - h2) * arc + t1 * w1 - t0 * w0));
    // Q1/r
    const double k8 = 0.125 * hertz;
    const double q0 =
        r0 > 0.0 ? k8 * (a2 * a2 * detail::atan_quadrant(r0, w0) / r0 - (a2 - 2.0 * r0 * r0) * w0)
                 : 0.0;
    const double q1 =
        r1 > 0.0 ? k8 * (a2 * a2 * detail::atan_quadrant(r1, w1) / r1 - (a2 - 2.0 * r1 * r1) * w1)
                 : 0.0;
    along = h * (k3 * (w0 * w0 * w0 - w1 * w1 * w1) - q1 + q0);
    normal = q1 * t1 - q0 * t0 -
             k8 * (b2 * b2 * arc - t1 * (b2 - 2.0 * s1) * w1 + t0 * (b2 - 2.0 * s0) * w0);
  }

  double core_p(double r2) const { return hertz * std::sqrt(std::max(0.0, a * a - r2)); }

  /// Slopes of this state at the R and delta of its set(). The ring: its inner edge gives way,
  /// d(a^2)/d delta = R. Beyond: its outer edge moves out, d(c^2)/d delta = 2 R where the surfaces
  /// are not deformed, else, with c^2 = a^2 (1 + y^2) and f(y) = pi h0/delta (gap_function),
  /// R [1 + y^2 - f/(f'/2y)].
  RadialSlope slope(const ContactMaterial &m, double R, double delta) const
  {
    RadialSlope s;
    s.core = 0.5 * hertz * R;    // E/pi
    if (a > 0.0) s.ring = s.core * a + 0.5 * sigma0 * R;
    s.out = s.ring;
    if (!(sigma0 > 0.0)) return s;
    double growth = 2.0 * R;
    if (!undeformed(delta, m.h0)) {
      const double y2 = std::max(0.0, c * c / (a * a) - 1.0), y = std::sqrt(y2);
      double phi;
      const double f = detail::gap_function(y, phi);
      if (y > 0.0) growth = R * (1.0 + y2 - f / (phi + y / (1.0 + y2)));
    }
    s.out -= 0.5 * sigma0 * growth;
    return s;
  }

  /// Is the gap that of undeformed spheres?
  static bool undeformed(double delta, double h0) { return delta <= 1e-9 * h0; }

  /// c from gap(c) = h0, gap(r) = [a sqrt(r^2-a^2) - (2a^2-r^2) acos(a/r)]/(pi R); for
  /// delta <= 0 the gap of the undeformed spheres. Relative error 1e-14.
  static double cohesive_radius(double R, double delta, double h0)
  {
    if (undeformed(delta, h0)) return std::sqrt(2.0 * R * (h0 + delta));
    // with r = a sqrt(1+y^2): gap = a^2 f(y)/(pi R), a^2 = R delta; two Newton steps of third
    // order from a start that is right at both ends
    const double target = PI * h0 / delta;
    const double t = std::cbrt(0.75 * target);
    double y = t * std::sqrt(1.0 + 0.849 * t * t / (t + 3.18));
    for (int it = 0; it < 2; it++) {
      double phi;
      const double f = detail::gap_function(y, phi) - target;
      const double s = y / (1.0 + y * y);
      const double d1 = 2.0 * y * (phi + s);
      const double d2 = 2.0 * (phi + s) + 2.0 * s + 2.0 * s * (1.0 - y * y) / (1.0 + y * y);
      const double newton = f / d1;
      y -= newton / (1.0 - 0.5 * newton * d2 / d1);
    }
    return std::sqrt(R * delta * (1.0 + y * y));
  }
};

}    // namespace dcm

#endif
