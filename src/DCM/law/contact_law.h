// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// What the contact laws (maugis.h, dmt.h, foundation.h) have in common. A law is a state of one
// contact of two spheres with a radial stress p(r), compression positive, r = distance from the
// axis through the sphere centers:
//
//   p(r) = the law's own            r <= a        ("core")
//        = -sigma0                  a < r <= c    ("ring": uniform cohesive traction)
//        = 0                        r > c
//
// and is used as a template parameter, with
//
//   bool set(const ContactMaterial &, double R, double delta, bool existing = false)
//        state from effective radius and overlap; false: no contact. `existing`: the pair was in
//        contact before, only of interest to laws with a neck (maugis)
//   static double reach(const ContactMaterial &, double R, double delta)
//        upper bound of c, cheap, to reject a pair before the state is computed
//   a, c, sigma0             core and cohesive radius, cohesive stress
//   core(r2, q0, q1)         q0 = Q0/r^2 and q1 = Q1/r^3 for r <= a, regular at r = 0
//   core_p(r2)               p for r <= a
//   EXACT_CORE               true: core_edge() gives the edge integrals in closed form; false: by
//                            Gauss points of core()
//   LOCAL_GAP                true: the exact gap of spheres, see gap_beside_axis() in contact.h;
//                            false: delta - r^2/2R everywhere, as S1
//   p(r), Q0(r), Q1(r)       Q0 = int_0^r p s ds, Q1 = int_0^r p s^2 ds
//   force()                  2 pi Q0(c), the force on the full circle
//
// For an implicit step, a law of exact core also gives the slope of its force at fixed polygon,
// dF/d delta = int dp/d delta dA, which takes d Q0/d delta at fixed r in the places of Q0:
//
//   slope(material, R, delta)   RadialSlope: in the ring, beyond c, and what core_edge<true>()
//                               is to be multiplied with
//
// Laws without it are differenced, see contact.h.
//
// Units are whatever is consistent: lengths um, forces nN, stresses kPa in all decks.

#ifndef DCM_CONTACT_LAW_H
#define DCM_CONTACT_LAW_H

#include <algorithm>
#include <cmath>

#include "vector.h"

namespace dcm {

/// Range of adhesion where the deck gives none: the larger of this length, um, and this part of
/// the mean edge.
constexpr double H0_LEAST = 0.35, H0_AUTO = 0.22;

/// Parameters of the contact of two surfaces.
struct ContactMaterial {
  double E = 0.0;     ///< effective modulus: 1/E = (1-nu_f^2)/E_f + (1-nu_g^2)/E_g (stress)
  double W = 0.0;     ///< work of adhesion (force/length); 0: no adhesion
  double h0 = 0.0;    ///< range of adhesion (length), S1: 2e-8 m; needed if W > 0
  double gn = 0.0;    ///< friction per area along the contact normal (stress time/length)
  double gt = 0.0;    ///< friction per area across it
  double k = 0.0;     ///< stiffness per area of law foundation (pressure/length)

  /// Cohesive stress W/h0.
  double sigma0() const { return W > 0.0 && h0 > 0.0 ? W / h0 : 0.0; }
  /// Smallest overlap of a new contact: surfaces closer than h0.
  double first_touch() const { return W > 0.0 ? -h0 : 0.0; }
};

/// d Q0/d delta at fixed distance from the axis (force/length per angle), see top of file.
struct RadialSlope {
  double core = 0.0;    ///< factor of the edge integrals in the core
  double ring = 0.0;    ///< a < r <= c
  double out = 0.0;     ///< r > c: softens (< 0) where the ring moves outwards faster than the core
};

namespace detail {

  /// x - atan(x), accurate relative to itself; |x| <= 0.66 (rational form of the Cephes library).
  inline double atan_deficit(double x)
  {
    const double z = x * x;
    const double p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z -
                       7.500855792314704667340e1) *
                          z -
                      1.228866684490136173410e2) *
                         z -
                     6.485021904942025371773e1;
    const double q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z +
                       4.328810604912902668951e2) *
                          z +
                      4.853903996359136964868e2) *
                         z +
                     1.945506571482613964425e2;
    return -x * z * p / q;
  }

  /// atan(y/x) for y >= 0, x >= 0, not both zero; error below 2 ulp.
  inline double atan_quadrant(double y, double x)
  {
    const bool low = y < 0.414 * x;
    const bool high = x < 0.414 * y;
    const double num = low ? y : (high ? -x : y - x);
    const double den = low ? x : (high ? y : y + x);
    const double base = low ? 0.0 : (high ? 0.5 * PI : 0.25 * PI);
    const double z = num / den;
    return base + (z - atan_deficit(z));
  }

  /// Angle of (x, y) in [-pi, pi]; 0 for the null vector.
  inline double angle(double y, double x)
  {
    const double ax = std::fabs(x), ay = std::fabs(y);
    if (!(ax + ay > 0.0)) return 0.0;
    double t = atan_quadrant(ay, ax);
    if (x < 0.0) t = PI - t;
    return y < 0.0 ? -t : t;
  }

  /// f(y) = y + (y^2 - 1) atan y, y >= 0, which both laws need: the elastic gap at r = a
  /// sqrt(1 + y^2) outside a Hertz contact is a^2 f(y)/(pi R). phi receives atan y.
  inline double gap_function(double y, double &phi)
  {
    if (y < 0.41) {
      const double deficit = atan_deficit(y);
      phi = y - deficit;
      return deficit + y * y * phi;
    }
    phi = atan_quadrant(y, 1.0);
    return y + (y * y - 1.0) * phi;
  }

  /// Hertz part of Q0/r^2 over 2 E/(pi R), w = sqrt(a^2 - r^2).
  inline double hertz_q0(double a, double w)
  {
    return (a * a + a * w + w * w) / (3.0 * (a + w));
  }

  /// Hertz part of Q1/r^3 over 2 E/(pi R). The closed form cancels for small r: series there.
  inline double hertz_q1(double a, double r2, double w)
  {
    const double a2 = a * a;
    if (r2 < 4e-3 * a2) {
      const double z = r2 / a2;
      return a *
             (1.0 / 3.0 - z * (0.1 + z * (1.0 / 56.0 + z * (1.0 / 144.0 + z * (5.0 / 1408.0)))));
    }
    const double r = std::sqrt(r2);
    return (a2 * a2 * atan_quadrant(r, w) - r * (a2 - 2.0 * r2) * w) / (8.0 * r * r2);
  }

}    // namespace detail

/// Parts of a law that follow from a, c, sigma0 and the core integrals; see top of file.
template <class Law> struct RadialLaw {
  double a = 0.0, c = 0.0, sigma0 = 0.0;
  double Q0a = 0.0, Q1a = 0.0;    ///< primitives at r = a
  double Q0c = 0.0, Q1c = 0.0;    ///< primitives at r >= c

  double Q0(double r) const
  {
    if (r >= c) return Q0c;
    if (r > a) return Q0a - 0.5 * sigma0 * (r * r - a * a);
    double q0, q1;
    law().core(r * r, q0, q1);
    return r * r * q0;
  }

  double Q1(double r) const
  {
    if (r >= c) return Q1c;
    if (r > a) return Q1a - sigma0 * (r * r * r - a * a * a) / 3.0;
    double q0, q1;
    law().core(r * r, q0, q1);
    return r * r * r * q1;
  }

  double p(double r) const
  {
    if (r > c) return 0.0;
    if (r > a || !(a > 0.0)) return -sigma0;
    return law().core_p(r * r);
  }

  double force() const { return 2.0 * PI * Q0c; }

 protected:
  void clear() { a = c = sigma0 = Q0a = Q1a = Q0c = Q1c = 0.0; }

  void finish_ring()
  {
    Q0c = Q0a - 0.5 * sigma0 * (c * c - a * a);
    Q1c = Q1a - sigma0 * (c * c * c - a * a * a) / 3.0;
  }

 private:
  const Law &law() const { return static_cast<const Law &>(*this); }
};

}    // namespace dcm

#endif
