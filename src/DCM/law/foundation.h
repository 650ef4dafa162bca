// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact law `foundation`: each surface carries a thin elastic layer that answers to the local
// overlap alone (Winkler's elastic foundation; Johnson, Contact Mechanics, section 4.3) and sticks
// to the other one: pulled, it gives way elastically up to the traction sigma0, which then holds
// until the gap is h0 (a trapezoidal cohesive law). With k the stiffness of both layers together
// (pressure/length), the overlap at distance r from the axis is delta - r^2/2R, and
//
//   p(r) = (k/2R) (a^2 - r^2) - sigma0   r <= a,       a^2 = 2 R (delta + sigma0/k)
//        = -sigma0                       a < r <= c,   c^2 = 2 R (delta + h0)
//
// that is k times the overlap, down to -sigma0. To separate flats takes the work W:
//
//   sigma0 h0 - sigma0^2/2k = W,   sigma0 = k h0 (1 - sqrt(1 - 2W/(k h0^2))),   h0 >= sqrt(2W/k)
//
// (foundation_range: a layer stretches by sqrt(2W/k) before it lets go). Two flats at overlap delta
// repel with k delta, whatever R. The stress is continuous where surfaces touch. With a traction
// -W/h0 up to touch and none from there on, flats that are pulled sit on the jump, and no time step
// is short enough for them to come to rest. The body of the cells is the deforming mesh; a
// half-space under each face, as in dmt.h and maugis.h, counts it once more, and the softer the
// flatter the contact. The stress depends on the local gap alone: the law derives from a potential,
// and the force of spheres,
//
//   F = pi k R delta^2 - 2 pi W R           delta >= -sigma0/k
//     = -2 pi R sigma0 (h0 + delta)         -h0 < delta < -sigma0/k,
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

/// Shortest range of adhesion (length) of layers of stiffness k with the work of adhesion W.
inline double foundation_range(double k, double W)
{
  return W > 0.0 ? std::sqrt(2.0 * W / k) : 0.0;
}

/// Traction that adhering layers bear (stress), 0 without adhesion; with h0 below the shortest
/// range that which stretches them by h0, at less work than W.
inline double foundation_strength(const ContactMaterial &m)
{
  if (!(m.W > 0.0)) return 0.0;
  const double pull = m.k * m.h0, x = 2.0 * m.W / (pull * m.h0);
  return x < 1.0 ? pull * x / (1.0 + std::sqrt(1.0 - x)) : pull;
}

struct FoundationState : RadialLaw<FoundationState> {
  static constexpr bool EXACT_CORE = true;
  static constexpr bool LOCAL_GAP = true;
  double K = 0.0;    ///< k/(2R)

  static double reach(const ContactMaterial &m, double R, double delta, bool = false)
  {
    return std::sqrt(std::max(0.0, 2.0 * R * (delta - m.first_touch())));
  }

  bool set(const ContactMaterial &m, double R, double delta, bool = false)
  {
    clear();
    if (!(R > 0.0) || !(m.k > 0.0) || !(delta > m.first_touch())) return false;
    sigma0 = foundation_strength(m);
    K = 0.5 * m.k / R;
    const double a2 = 2.0 * R * (delta + sigma0 / m.k);
    if (a2 > 0.0) {
      a = std::sqrt(a2);
      Q0a = a2 * (0.25 * K * a2 - 0.5 * sigma0);
      Q1a = a2 * a * (2.0 / 15.0 * K * a2 - sigma0 / 3.0);
    }
    c = sigma0 > 0.0 ? std::sqrt(2.0 * R * (delta + m.h0)) : a;
    finish_ring();
    return true;
  }

  void core(double r2, double &q0, double &q1) const
  {
    q0 = K * (0.5 * a * a - 0.25 * r2) - 0.5 * sigma0;
    q1 = K * (a * a / 3.0 - 0.2 * r2) - sigma0 / 3.0;
  }

  double core_p(double r2) const { return K * std::max(0.0, a * a - r2) - sigma0; }

  /// The integrals over a straight edge in the core, see dmt.h: polynomials in h and t.
  /// slope: of dp/d delta = k, over k.
  template <bool SLOPE = false>
  void core_edge(double h, double t0, double t1, double &f, double &normal, double &along,
                 [[maybe_unused]] double *slope = nullptr) const
  {
    const double h2 = h * h, s0 = t0 * t0, s1 = t1 * t1, t = t1 - t0;
    const double cubes = t1 * s1 - t0 * s0;
    double q0, q1;
    core(h2, q0, q1);
    f = h * (q0 * t - K * cubes / 12.0);
    along = 0.5 * h * (s1 - s0) * (q1 - 0.1 * K * (s1 + s0));
    normal = h2 * (q1 * t - K * cubes / 15.0);
    if constexpr (SLOPE) *slope = 0.5 * h * t;
  }

  /// Slopes of this state at the R and delta of its set(): k in the core, at whose edge the stress
  /// is continuous; at the edge of the ring it jumps by sigma0, and d(c^2)/d delta = 2 R.
  RadialSlope slope(const ContactMaterial &m, double R, double) const
  {
    RadialSlope s;
    s.core = m.k;
    s.ring = 0.5 * m.k * a * a;
    s.out = s.ring - sigma0 * R;
    return s;
  }
};

}    // namespace dcm

#endif
