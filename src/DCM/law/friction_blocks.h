// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The blocks a friction system is made of (friction.h), and the products with one of them.
// Indices are unknowns, 0 for all that is fixed. Every block is symmetric and positive
// semi-definite by its form, and only sees velocity differences.
// Units: friction coefficients in force * time / length (um, nN, s: nN s/um).

#ifndef DCM_FRICTION_BLOCKS_H
#define DCM_FRICTION_BLOCKS_H

#include <Eigen/Core>

#include <cstddef>
#include <initializer_list>

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

// iso I between i and j: the usual cortex edge

struct IsoEdge {
  int i, j;
  double iso;
};

constexpr int STRIDE = 4;    // numbers per slot of a vector

// the numbers of a slot, taken together

using Slot = Eigen::Array<double, STRIDE, 1>;

inline Eigen::Map<const Slot> slot(const double *numbers)
{
  return Eigen::Map<const Slot>(numbers);
}

inline Eigen::Map<Slot> slot(double *numbers)
{
  return Eigen::Map<Slot>(numbers);
}

/* ----------------------------------------------------------------------
   y += (the part of a block along its direction) * p; returns p . (that part) p
------------------------------------------------------------------------- */

inline double add_along(const EdgeBlock &b, const double *p, double *y)
{
  const double *pi = p + STRIDE * (std::size_t) b.i, *pj = p + STRIDE * (std::size_t) b.j;
  double *yi = y + STRIDE * (std::size_t) b.i, *yj = y + STRIDE * (std::size_t) b.j;
  double d = 0.0;
  for (int k = 0; k < 3; k++) d += (pi[k] - pj[k]) * b.e[k];
  const double c = b.along * d;
  for (int k = 0; k < 3; k++) yi[k] += c * b.e[k];
  for (int k = 0; k < 3; k++) yj[k] -= c * b.e[k];
  return c * d;
}

inline double add_along(const ContactBlock &b, const double *p, double *y)
{
  double d = 0.0;
  for (int l = 0; l < 6; l++) {
    const double *pl = p + STRIDE * (std::size_t) b.n[l];
    d += b.w[l] * (pl[0] * b.u[0] + pl[1] * b.u[1] + pl[2] * b.u[2]);
  }
  const double c = (b.normal - b.tangential) * d;
  for (int l = 0; l < 6; l++) {
    double *yl = y + STRIDE * (std::size_t) b.n[l];
    for (int k = 0; k < 3; k++) yl[k] += c * b.w[l] * b.u[k];
  }
  return c * d;
}

/* ----------------------------------------------------------------------
   add c e e^T to a symmetric 3x3 matrix kept as xx yy zz xy xz yz
------------------------------------------------------------------------- */

inline void add_symmetric(double *m, double c, const double *e)
{
  m[0] += c * e[0] * e[0];
  m[1] += c * e[1] * e[1];
  m[2] += c * e[2] * e[2];
  m[3] += c * e[0] * e[1];
  m[4] += c * e[0] * e[2];
  m[5] += c * e[1] * e[2];
}

/* ----------------------------------------------------------------------
   add the diagonal 3x3 blocks of the part along the direction to d, 6 numbers per slot
------------------------------------------------------------------------- */

inline void add_diagonal(const EdgeBlock &b, double *d)
{
  for (int n : {b.i, b.j}) add_symmetric(d + 6 * (std::size_t) n, b.along, b.e);
}

inline void add_diagonal(const ContactBlock &b, double *d)
{
  // a node may stand in two slots: an unused slot repeats another, a cell may touch itself
  for (int k = 0; k < 6; k++) {
    double weight = 0.0;
    for (int l = 0; l < 6; l++)
      if (b.n[l] == b.n[k]) weight += b.w[l];
    add_symmetric(d + 6 * (std::size_t) b.n[k], b.w[k] * weight * (b.normal - b.tangential), b.u);
  }
}

}    // namespace dcm

#endif
