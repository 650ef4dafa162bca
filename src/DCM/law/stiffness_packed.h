// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Blocks of a stiffness packed for products. A solve reads all of them some thirty times, and how
// fast that goes is a matter of bytes: numbers are rounded to single precision and what follows
// from others is left out, so that a hinge takes 56 bytes instead of 120. Sums are in double
// precision.
//
// What is rounded are the factors of a block, not its entries: it stays symmetric, positive
// semidefinite, and without effect on a translation, to double precision, since the last weight or
// direction is what makes the sum zero. K itself changes by 1e-7, and it may be any positive
// semidefinite matrix (step_system.h).
//
// Products take a slot's four numbers at once (friction_blocks.h). What they leave in the fourth
// number of y is void.

#ifndef DCM_STIFFNESS_PACKED_H
#define DCM_STIFFNESS_PACKED_H

#include "friction_blocks.h"

#include <cmath>
#include <cstddef>

namespace dcm {

// three floats and one behind them, which counts for nothing as long as it is a number

inline Slot packed_slot(const float *numbers)
{
  return Eigen::Map<const Eigen::Array<float, STRIDE, 1>>(numbers).cast<double>();
}

/* ----------------------------------------------------------------------
   iso I + along e e^T between i and j
------------------------------------------------------------------------- */

struct PackedEdge {
  float e[3], along, iso;
  int i, j;

  explicit PackedEdge(const EdgeBlock &b) :
      e{(float) b.e[0], (float) b.e[1], (float) b.e[2]}, along((float) b.along), iso((float) b.iso),
      i(b.i), j(b.j)
  {
  }

  double product(double dt, const double *p, double *y) const
  {
    const std::size_t a = STRIDE * (std::size_t) i, b = STRIDE * (std::size_t) j;
    const Slot d = slot(p + a) - slot(p + b), u = packed_slot(e);
    const Slot f = dt * ((double) iso * d + ((double) along * (d * u).sum()) * u);
    slot(y + a) += f;
    slot(y + b) -= f;
    return (f * d).sum();
  }
};

/* ----------------------------------------------------------------------
   c (g_1, ..., g_4) (g_1, ..., g_4)^T: g times the root of c; g_4 = -g_1 - g_2 - g_3
------------------------------------------------------------------------- */

struct PackedHinge {
  float g[9], none = 0.0F;
  int n[4];

  template <class RankOne> explicit PackedHinge(const RankOne &b)
  {
    const double root = std::sqrt(b.c);
    for (int l = 0; l < 3; l++)
      for (int k = 0; k < 3; k++) g[3 * l + k] = (float) (root * b.g[l][k]);
    for (int l = 0; l < 4; l++) n[l] = b.n[l];
  }

  double product(double dt, const double *p, double *y) const
  {
    std::size_t s[4];
    for (int l = 0; l < 4; l++) s[l] = STRIDE * (std::size_t) n[l];
    const Slot g0 = packed_slot(g), g1 = packed_slot(g + 3), g2 = packed_slot(g + 6);
    const Slot last = slot(p + s[3]);
    const double d =
        (g0 * (slot(p + s[0]) - last) + g1 * (slot(p + s[1]) - last) + g2 * (slot(p + s[2]) - last))
            .sum();
    const double f = dt * d;
    slot(y + s[0]) += f * g0;
    slot(y + s[1]) += f * g1;
    slot(y + s[2]) += f * g2;
    slot(y + s[3]) -= f * (g0 + g1 + g2);
    return f * d;
  }
};

/* ----------------------------------------------------------------------
   slope u u^T between two weighted means of three: u times the root of the slope; the weights of
   the first three sum to 1, of the others to -1
------------------------------------------------------------------------- */

struct PackedContact {
  float u[3], none = 0.0F, w[4];
  int n[6];

  explicit PackedContact(const ContactBlock &b)
  {
    const double root = std::sqrt(b.normal);
    for (int k = 0; k < 3; k++) u[k] = (float) (root * b.u[k]);
    for (int l = 0; l < 2; l++) {
      w[l] = (float) b.w[l];
      w[l + 2] = (float) b.w[l + 3];
    }
    for (int l = 0; l < 6; l++) n[l] = b.n[l];
  }

  double product(double dt, const double *p, double *y) const
  {
    const double weight[6] = {w[0], w[1], 1.0 - w[0] - w[1], w[2], w[3], -1.0 - w[2] - w[3]};
    Slot s = Slot::Zero();
    for (int l = 0; l < 6; l++) s += weight[l] * slot(p + STRIDE * (std::size_t) n[l]);
    const Slot axis = packed_slot(u);
    const double d = (s * axis).sum();
    const Slot f = (dt * d) * axis;
    for (int l = 0; l < 6; l++) slot(y + STRIDE * (std::size_t) n[l]) += weight[l] * f;
    return dt * d * d;
  }
};

}    // namespace dcm

#endif
