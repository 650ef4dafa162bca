// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Bending of the cortex: a hinge on every edge between two triangles (S1 eqs 4-5).
// Units: lengths um, forces nN, energies nN um, angles rad.
//
// Atom order: triangle 1 = (x2, x3, x1) and triangle 2 = (x3, x2, x4), both counter-clockwise
// seen from outside; x2-x3 is the hinge edge. The angle is zero for a flat hinge, positive where
// the surface is convex.
//
// S1 turns the moment into forces M/l n on the outer nodes and only asks that all four forces sum
// to zero; an equal split on the hinge nodes then leaves a net torque. Here the forces are the
// exact gradient of the energy, so that net force and net torque both vanish.

#ifndef DCM_HINGE_H
#define DCM_HINGE_H

#include "stiffness.h"
#include "vector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dcm {

/// Bending constant of a hinge, nN um: E h^3 / (12 (1 - nu^2)) (S1 eq 5).
inline double bending_stiffness(double E, double h, double nu = 0.5)
{
  return E * h * h * h / (12.0 * (1.0 - nu * nu));
}

/// Forces on the four atoms of a hinge (nN) and its energy (nN um).
struct Hinge {
  Vec3 f1, f2, f3, f4;
  double energy;
};

/// A triangle whose height over the hinge edge is below this fraction of its longest side counts
/// as degenerate: round-off then decides its normal.
constexpr double HINGE_SLIVER = 1.0e-10;

/// Signed angle between the normals of the two triangles, rad, in (-pi, pi], > 0 where convex.
/// A triangle of exactly zero area gives 0; the result is never NaN for finite input.
inline double hinge_angle(const Vec3 &x1, const Vec3 &x2, const Vec3 &x3, const Vec3 &x4)
{
  const Vec3 e = x3 - x2, a = x1 - x2, b = x4 - x2;
  const Vec3 m1 = e.cross(a), m2 = b.cross(e);
  // (m1 x m2).e = -e^2 (a.m2), because m2 is normal to e
  return std::atan2(-e.norm() * a.dot(m2), m1.dot(m2));
}

/// Energy U = kb (1 - cos(theta - theta0)) and its exact negative gradient (moment: S1 eq 4).
/// kb in nN um, theta0 in rad. If one of the triangles is degenerate (see HINGE_SLIVER) the angle
/// is undefined: forces and energy are zero, so the result stays finite. Runs once per hinge and
/// step, so it works with sine and cosine of the angle and never computes the angle itself.
inline Hinge hinge(double kb, double theta0, const Vec3 &x1, const Vec3 &x2, const Vec3 &x3,
                   const Vec3 &x4)
{
  const Vec3 e = x3 - x2, a = x1 - x2, b = x4 - x2;
  const Vec3 m1 = e.cross(a), m2 = b.cross(e);
  const double ee = e.squaredNorm(), aa = a.squaredNorm(), bb = b.squaredNorm();
  const double ae = a.dot(e), be = b.dot(e);
  const double mm1 = m1.squaredNorm(), mm2 = m2.squaredNorm();

  Hinge h;
  // squared longest sides; |m| = edge length times height over it. Written so that NaN passes on.
  const double longest1 = std::max({ee, aa, ee + aa - 2.0 * ae});
  const double longest2 = std::max({ee, bb, ee + bb - 2.0 * be});
  constexpr double tiny = HINGE_SLIVER * HINGE_SLIVER;
  if (mm1 <= tiny * ee * longest1 || mm2 <= tiny * ee * longest2 ||
      mm1 * mm2 < std::numeric_limits<double>::min()) {
    h.f1 = h.f2 = h.f3 = h.f4 = Vec3::Zero();
    h.energy = 0.0;
    return h;
  }

  const double l = std::sqrt(ee), scale = 1.0 / std::sqrt(mm1 * mm2);
  double sine = -l * a.dot(m2) * scale, cosine = m1.dot(m2) * scale;
  if (theta0 != 0.0) {
    const double s0 = std::sin(theta0), c0 = std::cos(theta0), s = sine;
    sine = s * c0 - cosine * s0;
    cosine = cosine * c0 + s * s0;
  }

  // 1 - cos loses all digits for a nearly relaxed hinge, sin^2/(1 + cos) does not
  h.energy = kb * (cosine > 0.0 ? sine * sine / (1.0 + cosine) : 1.0 - cosine);
  const double moment = kb * sine;

  // dtheta/dx1 = -n1/height1; the opposite force acts at the foot of the height on the edge,
  // shared between x2 and x3 by the lever rule: this is what makes the torque vanish
  h.f1 = (moment * l / mm1) * m1;
  h.f4 = (moment * l / mm2) * m2;
  const double t1 = ae / ee, t4 = be / ee;
  h.f3 = -t1 * h.f1 - t4 * h.f4;
  h.f2 = (t1 - 1.0) * h.f1 + (t4 - 1.0) * h.f4;
  return h;
}

/// Stiffness of a hinge, slots to be filled in: c = kb cos(theta - theta0), nN um, and g the
/// gradient of theta, 1/um; at theta = theta0 that is all of -dF/dx. Zero beyond a right angle from
/// there, where the hinge gives way, and for a degenerate triangle. cosine, sine: of theta0.
inline RankOne<4> hinge_stiffness(double kb, double cosine, double sine, const Vec3 &x1,
                                  const Vec3 &x2, const Vec3 &x3, const Vec3 &x4)
{
  RankOne<4> b = {};
  const Vec3 e = x3 - x2, a = x1 - x2, d = x4 - x2;
  const Vec3 m1 = e.cross(a), m2 = d.cross(e);
  const double ee = e.squaredNorm(), aa = a.squaredNorm(), dd = d.squaredNorm();
  const double ae = a.dot(e), de = d.dot(e);
  const double mm1 = m1.squaredNorm(), mm2 = m2.squaredNorm();
  const double longest1 = std::max({ee, aa, ee + aa - 2.0 * ae});
  const double longest2 = std::max({ee, dd, ee + dd - 2.0 * de});
  constexpr double tiny = HINGE_SLIVER * HINGE_SLIVER;
  if (mm1 <= tiny * ee * longest1 || mm2 <= tiny * ee * longest2 ||
      mm1 * mm2 < std::numeric_limits<double>::min())
    return b;

  const double l = std::sqrt(ee), scale = 1.0 / std::sqrt(mm1 * mm2);
  b.c = kb * std::max(0.0, scale * (m1.dot(m2) * cosine - l * a.dot(m2) * sine));
  const double t1 = ae / ee, t4 = de / ee;
  const Vec3 g1 = (-l / mm1) * m1, g4 = (-l / mm2) * m2;
  vec(b.g[0]) = g1;
  vec(b.g[1]) = (t1 - 1.0) * g1 + (t4 - 1.0) * g4;
  vec(b.g[2]) = -t1 * g1 - t4 * g4;
  vec(b.g[3]) = g4;
  return b;
}

inline RankOne<4> hinge_stiffness(double kb, double theta0, const Vec3 &x1, const Vec3 &x2,
                                  const Vec3 &x3, const Vec3 &x4)
{
  return hinge_stiffness(kb, std::cos(theta0), std::sin(theta0), x1, x2, x3, x4);
}

}    // namespace dcm

#endif
