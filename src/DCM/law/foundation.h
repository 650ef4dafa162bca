// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact law `foundation`: each surface carries a thin elastic layer that answers to the local
// overlap alone (Winkler's elastic foundation; Johnson, Contact Mechanics, section 4.3), with a
// cohesive traction -W/h0 where the gap lies in (0, h0). With k the stiffness of both layers
// together (pressure/length), the overlap at distance r from the axis is delta - r^2/2R, and
//
//   p(r) = (k/2R) (a^2 - r^2)   r <= a,   a^2 = 2 R delta
//        = -W/h0                a < r <= c,   c^2 = 2 R (delta + h0)
//
// Two flats at overlap delta repel with k delta, whatever R. The body of the cells is the deforming
// mesh; a half-space under each face, as in dmt.h and maugis.h, counts it once more, and the softer
// the flatter the contact. The stress depends on the local gap alone: the law derives from a
// potential, adhesion of two flats does the work W, and the force of spheres,
//
//   F = pi k R delta^2 - 2 pi W R          delta >= 0
//     = -2 pi R (W/h0) (h0 + delta)        -h0 < delta < 0,
//
// has its minimum -2 pi W R at first touch for every k. See contact_law.h for the interface.

#ifndef DCM_FOUNDATION_H
#define DCM_FOUNDATION_H

#include "contact_law.h"

namespace dcm {

/// Stiffness per area of two layers, one on the other (pressure/length): 1/k = sum l (1 - nu^2)/E.
inline double foundation_stiffness(double l1, double E1, double nu1, double l2, double E2,
                                   double nu2)
{
  return 1.0 / (l1 * (1.0 - nu1 * nu1) / E1 + l2 * (1.0 - nu2 * nu2) / E2);
}

struct FoundationState : RadialLaw<FoundationState> {
  static constexpr bool EXACT_CORE = true;
  double K = 0.0;    ///< k/(2R)

  static double reach(const ContactMaterial &m, double R, double delta, bool = false)
  {
    return std::sqrt(std::max(0.0, 2.0 * R * (delta - m.first_touch())));
  }

  bool set(const ContactMaterial &m, double R, double delta, bool = false)
  {
    clear();
    if (!(R > 0.0) || !(m.k > 0.0) || !(delta > m.first_touch())) return false;
    sigma0 = m.sigma0();
    K = 0.5 * m.k / R;
    if (delta > 0.0) {
      a = std::sqrt(2.0 * R * delta);
      const double a4 = 4.0 * R * R * delta * delta;
      Q0a = 0.25 * K * a4;
      Q1a = 2.0 / 15.0 * K * a4 * a;
    }
    c = sigma0 > 0.0 ? std::sqrt(2.0 * R * (delta + m.h0)) : a;
    finish_ring();
    return true;
  }

  void core(double r2, double &q0, double &q1) const
  {
    q0 = K * (0.5 * a * a - 0.25 * r2);
    q1 = K * (a * a / 3.0 - 0.2 * r2);
  }

  double core_p(double r2) const { return K * std::max(0.0, a * a - r2); }

  /// The integrals over a straight edge in the core, see dmt.h: polynomials in h and t.
  /// slope: of dp/d delta = k, over k.
  template <bool SLOPE = false>
  void core_edge(double h, double t0, double t1, double &f, double &normal, double &along,
                 [[maybe_unused]] double *slope = nullptr) const
  {
    const double h2 = h * h, s0 = t0 * t0, s1 = t1 * t1, t = t1 - t0;
    const double cubes = t1 * s1 - t0 * s0;
    const double q1 = K * (a * a / 3.0 - 0.2 * h2);
    f = h * K * ((0.5 * a * a - 0.25 * h2) * t - cubes / 12.0);
    along = 0.5 * h * (s1 - s0) * (q1 - 0.1 * K * (s1 + s0));
    normal = h2 * (q1 * t - K * cubes / 15.0);
    if constexpr (SLOPE) *slope = 0.5 * h * t;
  }

  /// Slopes of this state at the R and delta of its set(): k in the core; both edges of the ring
  /// move alike, d(a^2)/d delta = d(c^2)/d delta = 2 R.
  RadialSlope slope(const ContactMaterial &m, double R, double delta) const
  {
    RadialSlope s;
    s.core = m.k;
    if (delta > 0.0) {
      s.out = m.k * R * delta;
      s.ring = s.out + sigma0 * R;
    } else {
      s.out = -sigma0 * R;
    }
    return s;
  }
};

}    // namespace dcm

#endif
