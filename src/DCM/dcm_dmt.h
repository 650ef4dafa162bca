// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact law `dmt`: Hertz pressure inside a = sqrt(R delta), cohesive traction -W/h0 where the
// gap of the Hertz solution lies in (0, h0). Continuous in delta, derives from a potential,
// pull-off force 2 pi W R, work of separation of two flats exactly W. See dcm_contact_law.h for
// the interface.

#ifndef DCM_DMT_H
#define DCM_DMT_H

#include "dcm_contact_law.h"

namespace dcm {

struct DmtState : RadialLaw<DmtState> {
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

  double core_p(double r2) const { return hertz * std::sqrt(std::max(0.0, a * a - r2)); }
  /// c from gap(c) = h0, gap(r) = [a sqrt(r^2-a^2) - (2a^2-r^2) acos(a/r)]/(pi R); for
  /// delta <= 0 the gap of the undeformed spheres. Relative error 1e-14.
  static double cohesive_radius(double R, double delta, double h0)
  {
    if (delta <= 1e-9 * h0) return std::sqrt(2.0 * R * (h0 + delta));
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
