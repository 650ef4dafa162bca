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
   slope u u^T between two weighted means of three, and for two tilts (ContactSpring): u times the
   root of the slope. Of three weights the last follows from their sum, 1 and -1 for the means
------------------------------------------------------------------------- */

struct PackedContact {
  float u[3], none = 0.0F, w[3][4];
  int n[6];

  template <class Spring> explicit PackedContact(const Spring &b)
  {
    const double root = std::sqrt(b.mean.normal);
    for (int k = 0; k < 3; k++) u[k] = (float) (root * b.mean.u[k]);
    const double *const from[3] = {b.mean.w, b.tilt[0], b.tilt[1]};
    for (int m = 0; m < 3; m++)
      for (int l = 0; l < 2; l++) {
        w[m][l] = (float) from[m][l];
        w[m][l + 2] = (float) from[m][l + 3];
      }
    for (int l = 0; l < 6; l++) n[l] = b.mean.n[l];
  }

  double product(double dt, const double *p, double *y) const
  {
    // velocities along the axis, in each surface against that of its last node
    const Slot axis = packed_slot(u);
    double v[6];
    for (int l = 0; l < 6; l++) v[l] = (slot(p + STRIDE * (std::size_t) n[l]) * axis).sum();
    const double a[4] = {v[0] - v[2], v[1] - v[2], v[3] - v[5], v[4] - v[5]};
    double d[3] = {v[2] - v[5], 0.0, 0.0};
    for (int m = 0; m < 3; m++)
      for (int l = 0; l < 4; l++) d[m] += (double) w[m][l] * a[l];

    double f[6];
    for (int l = 0; l < 4; l++)
      f[l + l / 2] = dt * (w[0][l] * d[0] + w[1][l] * d[1] + w[2][l] * d[2]);
    f[2] = dt * d[0] - f[0] - f[1];
    f[5] = -dt * d[0] - f[3] - f[4];
    for (int l = 0; l < 6; l++) slot(y + STRIDE * (std::size_t) n[l]) += f[l] * axis;
    return dt * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }
};

}    // namespace dcm

#endif
