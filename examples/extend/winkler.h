// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact law `foundation`, the worked example of doc/howto_extend.rst: an elastic layer on a rigid
// ground (Winkler's mattress), whose pressure at a point depends on the overlap there alone:
//
//   p(r) = k (delta - r^2/(2R)),   r <= a = sqrt(2 R delta)
//
// with k = 0.60 E/a, the stiffness at which it carries Hertz' force at Hertz' overlap (Johnson,
// Contact Mechanics, 1985, section 4.3). Nothing bulges outside the contact, so the gap there is
// that of the undeformed spheres, r^2/(2R) - delta, and the cohesive traction -W/h0 reaches to
// c = sqrt(2 R (delta + h0)). The forces are
//
//   F = 4/3 E sqrt(R) delta^(3/2) - 2 pi W R   for delta >= 0.
//
// See law/contact_law.h for the interface and for units.

#ifndef DCM_WINKLER_H
#define DCM_WINKLER_H

#include "law/contact_law.h"

namespace dcm {

struct WinklerState : RadialLaw<WinklerState> {
  static constexpr bool EXACT_CORE = false;
  static constexpr bool LOCAL_GAP = false;    // a polynomial: Gauss points do it
  double middle = 0.0;                        ///< pressure on the axis
  double inverse = 0.0;                       ///< 1/a^2

  static double reach(const ContactMaterial &m, double R, double delta, bool = false)
  {
    return std::sqrt(std::max(0.0, 2.0 * R * (delta - m.first_touch())));
  }

  bool set(const ContactMaterial &m, double R, double delta, bool = false)
  {
    clear();
    middle = inverse = 0.0;
    if (!(R > 0.0) || !(delta > m.first_touch())) return false;
    sigma0 = m.sigma0();
    if (delta > 0.0) {
      a = std::sqrt(2.0 * R * delta);
      middle = 4.0 * m.E / (3.0 * PI) * std::sqrt(delta / R);
      inverse = 1.0 / (a * a);
      Q0a = middle * a * a / 4.0;
      Q1a = middle * a * a * a * 2.0 / 15.0;
    }
    c = sigma0 > 0.0 ? std::sqrt(2.0 * R * (delta + m.h0)) : a;
    finish_ring();
    return true;
  }

  /// Q0 = middle (r^2/2 - r^4/(4 a^2)), Q1 = middle (r^3/3 - r^5/(5 a^2))
  void core(double r2, double &q0, double &q1) const
  {
    q0 = middle * (1.0 / 2.0 - r2 * inverse / 4.0);
    q1 = middle * (1.0 / 3.0 - r2 * inverse / 5.0);
  }

  double core_p(double r2) const { return middle * (1.0 - r2 * inverse); }
};

}    // namespace dcm

#endif
