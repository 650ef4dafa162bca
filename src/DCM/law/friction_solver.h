// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Preconditioned conjugate gradients for the friction system (friction.h) or that of a linearly
// implicit step (step_system.h), written once for any number of processes. All messages go through
// a small policy class:
//
//   struct Communicator {
//     void forward(double *x);                       // owned slots of a vector -> their copies
//     void reverse(double *y, int stride, int n);    // add copies to the owned slots, n of stride
//     void sum(double *values, int n);               // sum over all processes
//     void sum_cells(double *values);                // see stiffness.h, if there is stiffness
//   };
//
// One iteration costs one forward, one reverse and two sums.

#ifndef DCM_FRICTION_SOLVER_H
#define DCM_FRICTION_SOLVER_H

#include "friction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace dcm {

enum class Precondition { NONE, JACOBI, BLOCK };

struct FrictionResult {
  enum Status {
    CONVERGED,
    KEPT,             // the initial guess solved the system already and was left as it was
    NOT_CONVERGED,    // more than maxiter iterations
    NOT_FINITE,       // NaN or infinity in forces or friction coefficients
    SINGULAR,         // an unknown without any friction, see zero_slot (-1: on another process)
    INDEFINITE        // p.Ap <= 0: no ECM friction and forces that do not add up to zero
  };
  Status status = CONVERGED;
  int iterations = 0;
  double residual = 0.0;    // |F - A v| / |F|
  double force = 0.0;       // |F|
  int zero_slot = -1;
};

template <class Communicator> class FrictionSolver {
 public:
  double tolerance = 1e-6;
  int maxiter = 500;
  Precondition precondition = Precondition::BLOCK;
  std::vector<int> given;    // owned slots that are not solved for: b and x are 0 there

  // solve A x = b; system: a FrictionSystem (merged) or what has the same nowned, nall, apply(),
  // isotropic(), diagonal() and diagonal_blocks(); b and x with STRIDE numbers per slot, b for
  // owned slots (slot 0 = fixed = 0), x has room for all and holds the initial guess; on return
  // also the copies of other processes' unknowns. keep > 0: leave x alone if it solves the system
  // to keep * tolerance (a restart)

  template <class System>
  FrictionResult solve(const System &system, const double *b, double *x, Communicator &comm,
                       double keep = 0.0)
  {
    const std::size_t n = STRIDE * ((std::size_t) system.nowned + 1);
    const std::size_t nall = STRIDE * ((std::size_t) system.nall + 1);
    r.resize(n);
    p.resize(nall);
    q.resize(nall);
    FrictionResult result;
    result.zero_slot = factor(system, comm);

    // r = b - A x

    for (int k = 0; k < STRIDE; k++) x[k] = r[k] = 0.0;
    comm.forward(x);
    system.apply(x, q.data(), comm);
    comm.reverse(q.data(), STRIDE, 3);
    leave_out_given();
    double sums[4] = {0.0, 0.0, 0.0, (result.zero_slot >= 0) ? 1.0 : 0.0};
    for (std::size_t i = STRIDE; i < n; i++) {
      r[i] = b[i];
      sums[1] += b[i] * b[i];
      p[i] = 0.0;
    }
    reduce_residual(n, 1.0, sums);
    comm.sum(sums, 4);
    double rz = sums[0], rr = sums[2];
    result.force = std::sqrt(sums[1]);

    if (sums[3] > 0.0) return finish(result, FrictionResult::SINGULAR, rr);
    if (!std::isfinite(sums[1]) || !std::isfinite(rr))
      return finish(result, FrictionResult::NOT_FINITE, rr);

    const double goal = tolerance * tolerance * sums[1];
    if (keep > 0.0 && rr <= keep * keep * goal) return finish(result, FrictionResult::KEPT, rr);
    if (sums[1] == 0.0) {    // no force, no motion
      std::fill(x, x + nall, 0.0);
      return finish(result, FrictionResult::CONVERGED, 0.0);
    }

    double alpha = 0.0, beta = 0.0;
    while (rr > goal) {
      if (result.iterations == maxiter) return finish(result, FrictionResult::NOT_CONVERGED, rr);
      result.iterations++;

      advance(n, alpha, beta, x);
      comm.forward(p.data());
      double pq = system.apply(p.data(), q.data(), comm);
      comm.reverse(q.data(), STRIDE, 3);
      leave_out_given();
      comm.sum(&pq, 1);
      if (!std::isfinite(pq)) return finish(result, FrictionResult::NOT_FINITE, rr);
      if (pq <= 0.0) return finish(result, FrictionResult::INDEFINITE, rr);

      alpha = rz / pq;
      double both[3] = {0.0, 0.0, 0.0};
      reduce_residual(n, alpha, both);
      comm.sum(both, 3);
      if (!std::isfinite(both[2])) return finish(result, FrictionResult::NOT_FINITE, both[2]);
      beta = both[0] / rz;
      rz = both[0];
      rr = both[2];
    }
    advance(n, alpha, beta, x);
    comm.forward(x);
    return finish(result, FrictionResult::CONVERGED, rr);
  }

  double memory_usage() const
  {
    return (double) sizeof(double) *
           (r.capacity() + p.capacity() + q.capacity() + scalar.capacity() + blocks.capacity());
  }

 private:
  std::vector<double> r, p, q;    // residual, direction, A direction; capacity is kept
  std::vector<double> scalar;     // inverse diagonal per slot, if it is the same in x, y and z
  std::vector<double> blocks;     // inverse diagonal blocks else, 6 per slot
  bool by_scalar = true;

  // the preconditioner; returns the slot of an unknown without friction, -1 if there is none

  template <class System> int factor(const System &system, Communicator &comm)
  {
    double directed = system.isotropic() ? 0.0 : 1.0;
    comm.sum(&directed, 1);
    by_scalar = (directed == 0.0) || precondition == Precondition::NONE;
    int zero = -1;

    if (by_scalar) {
      // without friction along directions, blocks and diagonal are the same
      scalar = system.diagonal();
      comm.reverse(scalar.data(), 1, 1);
      for (const int i : given) scalar[i] = 1.0;
      for (int i = 1; i <= system.nowned; i++) {
        if (scalar[i] == 0.0 && zero < 0 && directed == 0.0) zero = i;
        scalar[i] = (scalar[i] == 0.0) ? 0.0 : 1.0 / scalar[i];
        if (precondition == Precondition::NONE && std::isfinite(scalar[i])) scalar[i] = 1.0;
      }
      return zero;
    }

    blocks.resize(6 * ((std::size_t) system.nall + 1));
    double *d = blocks.data();
    system.diagonal_blocks(d);
    comm.reverse(d, 6, 6);
    for (const int i : given)
      for (int k = 0; k < 6; k++) d[6 * (std::size_t) i + k] = k < 3 ? 1.0 : 0.0;
    for (int i = 1; i <= system.nowned; i++) {
      double *m = d + 6 * (std::size_t) i;
      double block[6] = {m[0], m[1], m[2], m[3], m[4], m[5]};
      if (precondition == Precondition::JACOBI) block[3] = block[4] = block[5] = 0.0;
      if (invert_symmetric(block, m)) continue;
      const double trace = block[0] + block[1] + block[2];
      if (trace == 0.0 && zero < 0) zero = i;
      for (int k = 0; k < 6; k++)
        m[k] = (trace == 0.0) ? 0.0 : std::numeric_limits<double>::quiet_NaN();
    }
    return zero;
  }

  // rows of unknowns that are given: no residual, and so no direction

  void leave_out_given()
  {
    for (const int i : given)
      for (int k = 0; k < STRIDE; k++) q[STRIDE * (std::size_t) i + k] = 0.0;
  }

  // z = M^-1 r of one slot

  void condition(std::size_t i, double *z) const
  {
    const double *ri = &r[STRIDE * i];
    if (by_scalar) {
      for (int k = 0; k < STRIDE; k++) z[k] = scalar[i] * ri[k];
    } else {
      const double *m = &blocks[6 * i];
      z[0] = m[0] * ri[0] + m[3] * ri[1] + m[4] * ri[2];
      z[1] = m[3] * ri[0] + m[1] * ri[1] + m[5] * ri[2];
      z[2] = m[4] * ri[0] + m[5] * ri[1] + m[2] * ri[2];
      z[3] = 0.0;
    }
  }

  // r -= alpha q; adds this process' part of r.M^-1 r to sums[0] and of r.r to sums[2]

  void reduce_residual(std::size_t n, double alpha, double *sums)
  {
    double rz[STRIDE] = {0.0, 0.0, 0.0, 0.0}, rr[STRIDE] = {0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = 1; i < n / STRIDE; i++) {
      double *ri = &r[STRIDE * i];
      const double *qi = &q[STRIDE * i];
      double z[STRIDE];
      for (int k = 0; k < STRIDE; k++) ri[k] -= alpha * qi[k];
      condition(i, z);
      for (int k = 0; k < STRIDE; k++) rz[k] += ri[k] * z[k];
      for (int k = 0; k < STRIDE; k++) rr[k] += ri[k] * ri[k];
    }
    sums[0] += rz[0] + rz[1] + rz[2];
    sums[2] += rr[0] + rr[1] + rr[2];
  }

  // x += alpha p, then p = M^-1 r + beta p

  void advance(std::size_t n, double alpha, double beta, double *x)
  {
    for (std::size_t i = 1; i < n / STRIDE; i++) {
      double *pi = &p[STRIDE * i], *xi = x + STRIDE * i;
      double z[STRIDE];
      condition(i, z);
      for (int k = 0; k < STRIDE; k++) xi[k] += alpha * pi[k];
      for (int k = 0; k < STRIDE; k++) pi[k] = z[k] + beta * pi[k];
    }
  }

  FrictionResult finish(FrictionResult result, FrictionResult::Status status, double rr) const
  {
    result.status = status;
    result.residual = (result.force > 0.0) ? std::sqrt(rr) / result.force : std::sqrt(rr);
    return result;
  }
};

}    // namespace dcm

#endif
