// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Johnson-Kendall-Roberts contact of two center-based cells (S1 eqs 14-15) and the apparent
// modulus that lets it follow a dense tissue.
// Units: lengths um, forces nN, moduli nN/um^2 (= kPa), sigma nN/um, energies nN um.
//
// sigma is the work of adhesion of the pair per unit area (W in JKR's paper): pull-off is
// -1.5 pi sigma R, independent of E. LAMMPS' pair granular jkr takes gamma = sigma/2.
//
// Two misprints of the source are mended: in eq 14 the root covers a^3, in eq 15 it covers a (as
// printed neither has the right unit); delta is counted positive in compression.

#ifndef DCM_JKR_H
#define DCM_JKR_H

#include "friction_blocks.h"
#include "vector.h"

#include <algorithm>
#include <cmath>

namespace dcm {

/// Effective modulus of a pair, nN/um^2: 1/((1 - nu1^2)/E1 + (1 - nu2^2)/E2).
inline double effective_modulus(double E1, double nu1, double E2, double nu2)
{
  return 1.0 / ((1.0 - nu1 * nu1) / E1 + (1.0 - nu2 * nu2) / E2);
}

/// Effective radius of a pair, um: 1/(1/R1 + 1/R2).
inline double effective_radius(double R1, double R2)
{
  return R1 * R2 / (R1 + R2);
}

/// Apparent Young modulus of a cell in a dense tissue, nN/um^2: E + sum_k a_k d^k, powers 1 to 4
/// (S1, after eq 15), with d = mean over neighbors of 1 - distance/(sum of reference radii).
/// A cell under tension (d < 0) keeps E: the fit is one of compression.
inline double apparent_modulus(double E, const double a[4], double d)
{
  d = std::max(d, 0.0);
  return E + d * (a[0] + d * (a[1] + d * (a[2] + d * a[3])));
}

/// JKR contact of one pair: effective modulus E > 0, effective radius R > 0, work of adhesion
/// sigma >= 0 (0 is Hertz). Overlap delta = R_i + R_j - distance, > 0 in compression. Forces are
/// positive when they push the cells apart.
///
/// Contact is made at first touch (delta >= 0) and then kept down to pull_off_displacement();
/// who has touched whom is the caller's memory. Below it every function returns zero.
struct JKR {
  double E, R, sigma;

  /// Overlap at which the pair separates under load control, um (<= 0).
  double pull_off_displacement() const
  {
    const double s = PI * sigma / (8.0 * E);
    return -std::cbrt(3.0 * s * s * R);
  }

  /// Force at that overlap, nN: -1.5 pi sigma R, the strongest pull.
  double pull_off_force() const { return -1.5 * PI * sigma * R; }

  /// Contact radius, um, on the stable branch. Closed form, no iteration: with a = a0 y^2,
  /// a0^3 = 2 pi sigma R^2/E, S1 eq 15 becomes y^4 - y = delta R/a0^2, solved by Ferrari's
  /// method arranged without cancellation.
  double contact_radius(double delta) const
  {
    // a little slack: compilers may evaluate the same root once exactly, once not quite
    if (delta < (1.0 + 1.0e-12) * pull_off_displacement()) return 0.0;
    const double a0 = std::cbrt(2.0 * PI * sigma * R * R / E);
    const double hertz = std::sqrt(R * std::max(delta, 0.0));
    // adhesion below round-off: also catches sigma = 0, where y would be infinite
    if (a0 < 1.0e-12 * hertz || a0 == 0.0) return hertz;

    const double D = delta * R / (a0 * a0);
    // resolvent m^3 + D m = 1/8; its discriminant is positive down to the fold, beyond pull-off
    const double third = D / 3.0;
    const double u = std::cbrt(0.0625 + std::sqrt(0.00390625 + third * third * third));
    const double v = third / u;
    const double m = 0.125 / (u * u + third + v * v);
    const double w = std::sqrt(2.0 * m);
    const double y = 0.5 * (w + std::sqrt(2.0 / w - w * w));
    return a0 * y * y;
  }

  /// Force as a function of the contact radius, nN (S1 eq 14).
  double force_of_radius(double a) const
  {
    return 4.0 * E * a * a * a / (3.0 * R) - std::sqrt(8.0 * PI * sigma * E * a * a * a);
  }

  /// dF/d delta as a function of the contact radius, nN/um; 0 at pull-off and above it before.
  double slope_of_radius(double a) const
  {
    const double root = std::sqrt(a);
    const double dF = 4.0 * E * a * a / R - 1.5 * std::sqrt(8.0 * PI * sigma * E) * root;
    const double ddelta =
        2.0 * a / R - (sigma > 0.0 ? 0.5 * std::sqrt(2.0 * PI * sigma / E) / root : 0.0);
    return dF > 0.0 && ddelta > 0.0 ? dF / ddelta : 0.0;
  }

  /// Overlap as a function of the contact radius, um (S1 eq 15).
  double overlap_of_radius(double a) const
  {
    return a * a / R - std::sqrt(2.0 * PI * sigma * a / E);
  }

  /// Contact radius at which the stable branch has a force, um; force >= pull_off_force().
  double radius_of_force(double force) const
  {
    // eq 14 is quadratic in a^1.5
    const double k = 4.0 * E / (3.0 * R), b = std::sqrt(8.0 * PI * sigma * E);
    const double s = 0.5 * (b + std::sqrt(std::max(b * b + 4.0 * k * force, 0.0))) / k;
    return std::cbrt(s * s);
  }

  /// Force at an overlap, nN.
  double force(double delta) const { return force_of_radius(contact_radius(delta)); }

  /// Energy at an overlap, nN um, elastic and adhesive: force = dU/d delta. Positive at pull-off
  /// (bending the neck takes work), zero without contact.
  double energy(double delta) const
  {
    const double a = contact_radius(delta);
    const double c = std::sqrt(2.0 * PI * sigma / E);
    return E * a * a *
           (8.0 * a * a * a / (15.0 * R * R) - 4.0 * c * a * std::sqrt(a) / (3.0 * R) +
            0.5 * c * c);
  }
};

/// JKR contact that is held back, as between two sister cells, which a division leaves deep inside
/// each other: softer by a factor and with a limit to its repulsion. Either alone, or both.
///
/// `scale` >= 0 multiplies E and sigma together. That is JKR of a softer pair with the contact
/// radius, the neck and the pull-off displacement of the full one, whose force and energy are
/// those of the full law times scale: a ramp to 1 changes nothing but the force.
/// `most` > 0 (0: no limit) is the largest repulsive force, nN, whatever the overlap; attraction
/// is not limited. The contact radius stays that of the overlap.
struct HeldJKR {
  JKR full;
  double scale, most;

  /// Part of the full law's force that is left at a contact radius, 0 to max(1, scale).
  double part_of_radius(double a) const
  {
    const double force = full.force_of_radius(a);
    return most > 0.0 && scale * force > most ? most / force : scale;
  }

  /// Force as a function of the contact radius, nN: min(scale F, most).
  double force_of_radius(double a) const
  {
    const double force = scale * full.force_of_radius(a);
    return most > 0.0 ? std::min(force, most) : force;
  }

  /// dF/d delta as a function of the contact radius, nN/um; none at the limit.
  double slope_of_radius(double a) const
  {
    const bool limited = most > 0.0 && scale * full.force_of_radius(a) > most;
    return limited ? 0.0 : scale * full.slope_of_radius(a);
  }

  /// Force at an overlap, nN.
  double force(double delta) const { return force_of_radius(full.contact_radius(delta)); }

  /// Energy at an overlap, nN um: force = dU/d delta at fixed scale and most, so linear beyond
  /// the overlap at which the limit begins.
  double energy(double delta) const
  {
    if (!(most > 0.0 && scale * full.force(delta) > most)) return scale * full.energy(delta);
    const double begin = full.overlap_of_radius(full.radius_of_force(most / scale));
    return scale * full.energy(begin) + most * (delta - begin);
  }
};

/// Stiffness of a force that two spheres exert along the line through their centers, for a linearly
/// implicit step: the positive semidefinite part of -dF/dx,
///
///   (dF/d delta) u u^T - (F/d) (I - u u^T),
///
/// force > 0 pushing them apart, del from i to j and not zero. Indices are the caller's.
inline EdgeBlock central_stiffness_block(double force, double slope, const Vec3 &del)
{
  const double d = del.norm();
  EdgeBlock b = {};
  b.iso = std::max(0.0, -force / d);
  b.along = std::max(0.0, slope) - b.iso;
  vec(b.e) = del / d;
  return b;
}

}    // namespace dcm

#endif
