// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The friction system of the overdamped equation of motion (S1, "Equation of motion"):
//
//   Gamma_ECM,i v_i + sum_edges gamma (v_i - v_j) + sum_contacts Gamma_cc (v_f - v_g) = F_i
//
// kept as a sum of contributed blocks and never assembled. Every block is symmetric and positive
// semi-definite by its form, and only sees velocity differences, so that the sum conserves
// momentum; the ECM diagonal alone ties the cells to the surroundings.
//
// Indices are compact unknowns: slot 0 stands for everything that is fixed (velocity 0), then the
// owned unknowns 1..nowned, then those of other processes. A vector holds 3 numbers per slot.
// Units: friction coefficients in force * time / length (um, nN, s: nN s/um).

#ifndef LMP_DCM_FRICTION_H
#define LMP_DCM_FRICTION_H

#include <cmath>
#include <cstddef>
#include <vector>

namespace dcm {

// iso I + along e e^T between i and j, in the form of a graph Laplacian; e a unit vector.
// Edges of the cortex with their dashpot, and pairs of spheres

struct EdgeBlock {
  int i, j;
  double iso, along;
  double e[3];
};

// w w^T (x) [tangential (I - u u^T) + normal u u^T]: friction between two points, each a weighted
// mean of up to three nodes (or one sphere), w = (+wf, -wg), sum(w) = 0; unused slots repeat an
// index with w = 0; u the unit normal of the contact

struct ContactBlock {
  int n[6];
  double w[6];
  double u[3];
  double normal, tangential;
};

// an edge block whose part along e is zero: the usual cortex edge, kept apart since it is a
// quarter of the size

struct IsoEdge {
  int i, j;
  double iso;
};

/* ----------------------------------------------------------------------
   y += block * p, p and y with 3 numbers per slot
------------------------------------------------------------------------- */

inline void add_product(const IsoEdge &b, const double *p, double *y)
{
  const double *pi = p + 3 * (std::size_t) b.i, *pj = p + 3 * (std::size_t) b.j;
  double *yi = y + 3 * (std::size_t) b.i, *yj = y + 3 * (std::size_t) b.j;
  const double fx = b.iso * (pi[0] - pj[0]);
  const double fy = b.iso * (pi[1] - pj[1]);
  const double fz = b.iso * (pi[2] - pj[2]);
  yi[0] += fx;
  yi[1] += fy;
  yi[2] += fz;
  yj[0] -= fx;
  yj[1] -= fy;
  yj[2] -= fz;
}

inline void add_product(const EdgeBlock &b, const double *p, double *y)
{
  const double *pi = p + 3 * (std::size_t) b.i, *pj = p + 3 * (std::size_t) b.j;
  double *yi = y + 3 * (std::size_t) b.i, *yj = y + 3 * (std::size_t) b.j;
  const double dx = pi[0] - pj[0], dy = pi[1] - pj[1], dz = pi[2] - pj[2];
  const double c = b.along * (dx * b.e[0] + dy * b.e[1] + dz * b.e[2]);
  const double fx = b.iso * dx + c * b.e[0];
  const double fy = b.iso * dy + c * b.e[1];
  const double fz = b.iso * dz + c * b.e[2];
  yi[0] += fx;
  yi[1] += fy;
  yi[2] += fz;
  yj[0] -= fx;
  yj[1] -= fy;
  yj[2] -= fz;
}

inline void add_product(const ContactBlock &b, const double *p, double *y)
{
  double dx = 0.0, dy = 0.0, dz = 0.0;
  for (int k = 0; k < 6; k++) {
    const double *pk = p + 3 * (std::size_t) b.n[k];
    dx += b.w[k] * pk[0];
    dy += b.w[k] * pk[1];
    dz += b.w[k] * pk[2];
  }
  const double c = (b.normal - b.tangential) * (dx * b.u[0] + dy * b.u[1] + dz * b.u[2]);
  const double fx = b.tangential * dx + c * b.u[0];
  const double fy = b.tangential * dy + c * b.u[1];
  const double fz = b.tangential * dz + c * b.u[2];
  for (int k = 0; k < 6; k++) {
    double *yk = y + 3 * (std::size_t) b.n[k];
    yk[0] += b.w[k] * fx;
    yk[1] += b.w[k] * fy;
    yk[2] += b.w[k] * fz;
  }
}

/* ----------------------------------------------------------------------
   m += scale (iso I + along e e^T), m a symmetric 3x3 matrix as xx yy zz xy xz yz
------------------------------------------------------------------------- */

inline void add_symmetric(double *m, double scale, double iso, double along, const double *e)
{
  m[0] += scale * (iso + along * e[0] * e[0]);
  m[1] += scale * (iso + along * e[1] * e[1]);
  m[2] += scale * (iso + along * e[2] * e[2]);
  m[3] += scale * along * e[0] * e[1];
  m[4] += scale * along * e[0] * e[2];
  m[5] += scale * along * e[1] * e[2];
}

/* ----------------------------------------------------------------------
   add the diagonal 3x3 blocks of a block to d, 6 numbers per slot
------------------------------------------------------------------------- */

inline void add_diagonal(const IsoEdge &b, double *d)
{
  for (int n : {b.i, b.j})
    for (int k = 0; k < 3; k++) d[6 * (std::size_t) n + k] += b.iso;
}

inline void add_diagonal(const EdgeBlock &b, double *d)
{
  for (int n : {b.i, b.j}) add_symmetric(d + 6 * (std::size_t) n, 1.0, b.iso, b.along, b.e);
}

inline void add_diagonal(const ContactBlock &b, double *d)
{
  // a sum over all pairs of slots with equal index: a node may stand in two slots (both faces
  // of a cell that touches itself, or an unused slot that repeats another)
  for (int k = 0; k < 6; k++) {
    double weight = 0.0;
    for (int l = 0; l < 6; l++)
      if (b.n[l] == b.n[k]) weight += b.w[l];
    add_symmetric(d + 6 * (std::size_t) b.n[k], b.w[k] * weight, b.tangential,
                  b.normal - b.tangential, b.u);
  }
}

/* ----------------------------------------------------------------------
   the blocks of one process and the products with them
------------------------------------------------------------------------- */

struct FrictionSystem {
  int nowned = 0, nall = 0;    // unknowns: owned, owned + those of other processes

  std::vector<double> ecm;    // per slot: scalar diagonal; parts of it may lie on any process
  std::vector<IsoEdge> iso_edges;
  std::vector<EdgeBlock> edges;
  std::vector<ContactBlock> contacts;

  // y = A p of this process' blocks; slots of other processes are to be added to their owners

  void apply(const double *p, double *y) const
  {
    const std::size_t n = (std::size_t) nall + 1;
    for (std::size_t i = 0; i < n; i++)
      for (int k = 0; k < 3; k++) y[3 * i + k] = ecm[i] * p[3 * i + k];
    for (const auto &b : iso_edges) add_product(b, p, y);
    for (const auto &b : edges) add_product(b, p, y);
    for (const auto &b : contacts) add_product(b, p, y);
    y[0] = y[1] = y[2] = 0.0;
  }

  // diagonal 3x3 blocks of A, 6 numbers per slot

  void diagonal(double *d) const
  {
    const std::size_t n = (std::size_t) nall + 1;
    for (std::size_t i = 0; i < n; i++) {
      d[6 * i] = d[6 * i + 1] = d[6 * i + 2] = ecm[i];
      d[6 * i + 3] = d[6 * i + 4] = d[6 * i + 5] = 0.0;
    }
    for (const auto &b : iso_edges) add_diagonal(b, d);
    for (const auto &b : edges) add_diagonal(b, d);
    for (const auto &b : contacts) add_diagonal(b, d);
    for (int k = 0; k < 6; k++) d[k] = 0.0;
  }
};

/* ----------------------------------------------------------------------
   inverse of a symmetric 3x3 block; a nearly singular one (two coplanar projected dashpots and
   nothing else) is shifted by a tiny part of its trace: the inverse only preconditions
   false if the block is zero or not finite
------------------------------------------------------------------------- */

inline bool invert_symmetric(const double *m, double *inverse)
{
  const double trace = m[0] + m[1] + m[2];
  if (!(trace > 0.0) || !std::isfinite(trace)) return false;
  const double shift = 1e-10 * trace;
  const double a = m[0] + shift, b = m[1] + shift, c = m[2] + shift;
  const double d = m[3], e = m[4], f = m[5];
  const double ca = b * c - f * f, cd = e * f - d * c, ce = d * f - e * b;
  const double det = a * ca + d * cd + e * ce;
  if (!(det > 0.0)) {    // lost to round-off: fall back to the scalar mean
    for (int k = 0; k < 3; k++) inverse[k] = 3.0 / trace;
    for (int k = 3; k < 6; k++) inverse[k] = 0.0;
    return true;
  }
  const double s = 1.0 / det;
  inverse[0] = s * ca;
  inverse[1] = s * (a * c - e * e);
  inverse[2] = s * (a * b - d * d);
  inverse[3] = s * cd;
  inverse[4] = s * ce;
  inverse[5] = s * (d * e - a * f);
  return true;
}

}    // namespace dcm

#endif
