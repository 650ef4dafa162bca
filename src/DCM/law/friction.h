// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The friction system of the overdamped equation of motion (S1, "Equation of motion"):
//
//   Gamma_ECM,i v_i + sum_edges gamma (v_i - v_j) + sum_contacts Gamma_cc (v_f - v_g) = F_i
//
// as a sum of contributed blocks. Every block is symmetric and positive semi-definite by its form,
// and only sees velocity differences, so that the sum conserves momentum; the ECM diagonal alone
// ties the cells to the surroundings.
//
// The isotropic part of all blocks acts alike on x, y and z: merge() sums it into one sparse matrix
// of scalars (friction_matrix.h). Some ten blocks per node shrink to four entries that way. What is
// left of a block, friction along one direction, stays as it is.
//
// Indices are compact unknowns: slot 0 stands for everything that is fixed (velocity 0), then the
// owned unknowns 1..nowned, then those of other processes. A vector holds 4 numbers per slot, the
// fourth always zero, since processors like to work on four at a time.
// Units: friction coefficients in force * time / length (um, nN, s: nN s/um).

#ifndef DCM_FRICTION_H
#define DCM_FRICTION_H

#include "friction_blocks.h"
#include "friction_matrix.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace dcm {

/* ----------------------------------------------------------------------
   the blocks of one process and the products with them
------------------------------------------------------------------------- */

class FrictionSystem {
 public:
  int nowned = 0, nall = 0;    // unknowns: owned, owned + those of other processes

  std::vector<double> ecm;    // per slot: scalar diagonal; parts of it may lie on any process
  std::vector<IsoEdge> iso_edges;
  std::vector<EdgeBlock> edges;
  std::vector<ContactBlock> contacts;

  // to be called when all blocks are there and again after any has changed

  void merge()
  {
    matrix.sum(ecm, iso_edges, edges, contacts);
    directed.clear();
    for (std::size_t m = 0; m < edges.size(); m++)
      if (edges[m].along != 0.0) directed.push_back((int) m);
    directed_contacts.clear();
    for (std::size_t m = 0; m < contacts.size(); m++)
      if (contacts[m].normal != contacts[m].tangential) directed_contacts.push_back((int) m);
  }

  // scalar diagonal of the isotropic part, per slot, this process' share

  const std::vector<double> &diagonal() const { return matrix.diagonal; }

  // is there friction that depends on the direction?

  bool isotropic() const { return directed.empty() && directed_contacts.empty(); }

  // y = A p of this process' blocks; slots of other processes are to be added to their owners.
  // Returns this process' share of p . A p

  double apply(const double *p, double *y) const
  {
    const std::size_t n = (std::size_t) nall + 1;
    double sum[STRIDE] = {0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < n; i++)
      for (int k = 0; k < STRIDE; k++) y[STRIDE * i + k] = matrix.diagonal[i] * p[STRIDE * i + k];
    for (std::size_t i = 1; i < n; i++) {
      double pi[STRIDE], yi[STRIDE];
      for (int k = 0; k < STRIDE; k++) pi[k] = p[STRIDE * i + k];
      for (int k = 0; k < STRIDE; k++) yi[k] = y[STRIDE * i + k];
      for (int m = matrix.first[i]; m < matrix.first[i + 1]; m++) {
        const auto &[column, value] = matrix.entries[m];
        const double *pj = p + STRIDE * (std::size_t) column;
        double *yj = y + STRIDE * (std::size_t) column;
        for (int k = 0; k < STRIDE; k++) yi[k] += value * pj[k];
        for (int k = 0; k < STRIDE; k++) yj[k] += value * pi[k];
      }
      for (int k = 0; k < STRIDE; k++) y[STRIDE * i + k] = yi[k];    // complete: columns are > i
      for (int k = 0; k < STRIDE; k++) sum[k] += pi[k] * yi[k];
    }
    double along = 0.0;
    for (int m : directed) along += add_along(edges[m], p, y);
    for (int m : directed_contacts) along += add_along(contacts[m], p, y);
    for (int k = 0; k < STRIDE; k++) y[k] = 0.0;
    return sum[0] + sum[1] + sum[2] + along;
  }

  template <class Communicator> double apply(const double *p, double *y, Communicator &) const
  {
    return apply(p, y);
  }

  // diagonal 3x3 blocks of A, 6 numbers per slot

  void diagonal_blocks(double *d) const
  {
    const std::size_t n = (std::size_t) nall + 1;
    for (std::size_t i = 0; i < n; i++)
      for (int k = 0; k < 6; k++) d[6 * i + k] = (k < 3) ? matrix.diagonal[i] : 0.0;
    for (int m : directed) add_diagonal(edges[m], d);
    for (int m : directed_contacts) add_diagonal(contacts[m], d);
    for (int k = 0; k < 6; k++) d[k] = 0.0;
  }

  double memory_usage() const
  {
    return (double) sizeof(IsoEdge) * iso_edges.capacity() +
           (double) sizeof(EdgeBlock) * edges.capacity() +
           (double) sizeof(ContactBlock) * contacts.capacity() +
           (double) sizeof(int) * (directed.capacity() + directed_contacts.capacity()) +
           (double) sizeof(double) * ecm.capacity() + matrix.memory_usage();
  }

 private:
  FrictionMatrix matrix;                           // the isotropic part
  std::vector<int> directed, directed_contacts;    // blocks with a part along their direction
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
