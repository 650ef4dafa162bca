// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Preconditioned conjugate gradients for the friction system (dcm_friction.h), written once for any
// number of processes. All messages go through a small policy class:
//
//   struct Communicator {
//     void forward(double *x);             // owned slots -> copies on other processes, 3 per slot
//     void reverse(double *y, int n);      // add copies to the owned slots, n numbers per slot
//     void sum(double *values, int n);     // sum over all processes
//   };
//
// One iteration costs one forward, one reverse and two sums.

#ifndef LMP_DCM_FRICTION_SOLVER_H
#define LMP_DCM_FRICTION_SOLVER_H

#include "dcm_friction.h"

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

  // solve A x = b; b and x with 3 numbers per owned slot (slot 0 = fixed = 0), x has room for all
  // slots and holds the initial guess; on return also the copies of other processes' unknowns.
  // keep > 0: leave x alone if it solves the system to keep * tolerance (a restart)

  FrictionResult solve(const FrictionSystem &system, const double *b, double *x, Communicator &comm,
                       double keep = 0.0)
  {
    const std::size_t n = 3 * ((std::size_t) system.nowned + 1);
    const std::size_t nall = 3 * ((std::size_t) system.nall + 1);
    resize(n, nall);
    FrictionResult result;
    result.zero_slot = factor(system, comm);

    // r = b - A x

    x[0] = x[1] = x[2] = 0.0;
    comm.forward(x);
    system.apply(x, q.data());
    comm.reverse(q.data(), 3);
    double sums[4] = {0.0, 0.0, 0.0, (result.zero_slot >= 0) ? 1.0 : 0.0};
    for (std::size_t i = 3; i < n; i++) {
      r[i] = b[i] - q[i];
      sums[1] += b[i] * b[i];
      sums[2] += r[i] * r[i];
    }
    sums[0] = condition(n);
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

    std::copy(z.begin(), z.begin() + n, p.begin());
    while (rr > goal) {
      if (result.iterations == maxiter) return finish(result, FrictionResult::NOT_CONVERGED, rr);
      result.iterations++;

      comm.forward(p.data());
      system.apply(p.data(), q.data());
      comm.reverse(q.data(), 3);
      double pq = 0.0;
      for (std::size_t i = 3; i < n; i++) pq += p[i] * q[i];
      comm.sum(&pq, 1);
      if (!std::isfinite(pq)) return finish(result, FrictionResult::NOT_FINITE, rr);
      if (pq <= 0.0) return finish(result, FrictionResult::INDEFINITE, rr);

      const double alpha = rz / pq;
      for (std::size_t i = 3; i < n; i++) {
        x[i] += alpha * p[i];
        r[i] -= alpha * q[i];
      }
      double both[2] = {0.0, 0.0};
      both[0] = condition(n);
      for (std::size_t i = 3; i < n; i++) both[1] += r[i] * r[i];
      comm.sum(both, 2);
      if (!std::isfinite(both[1])) return finish(result, FrictionResult::NOT_FINITE, both[1]);
      const double beta = both[0] / rz;
      rz = both[0];
      rr = both[1];
      for (std::size_t i = 3; i < n; i++) p[i] = z[i] + beta * p[i];
    }
    comm.forward(x);
    return finish(result, FrictionResult::CONVERGED, rr);
  }

  double memory_usage() const
  {
    return (double) sizeof(double) *
           (r.capacity() + z.capacity() + p.capacity() + q.capacity() + inverse.capacity());
  }

 private:
  std::vector<double> r, z, p, q;    // residual, preconditioned residual, direction, A direction
  std::vector<double> inverse;       // of the diagonal blocks, 6 per slot

  // capacity is kept, so that nothing is allocated from one step to the next

  void resize(std::size_t n, std::size_t nall)
  {
    r.resize(n);
    z.resize(n);
    r[0] = r[1] = r[2] = z[0] = z[1] = z[2] = 0.0;
    p.resize(nall);
    q.resize(nall);
    inverse.resize(2 * nall);
  }

  // inverses of the diagonal blocks; the slot of an unknown without friction or -1

  int factor(const FrictionSystem &system, Communicator &comm)
  {
    double *d = inverse.data();
    system.diagonal(d);
    comm.reverse(d, 6);
    int zero = -1;
    for (int i = 1; i <= system.nowned; i++) {
      double *m = d + 6 * (std::size_t) i;
      double block[6] = {m[0], m[1], m[2], m[3], m[4], m[5]};
      if (precondition != Precondition::BLOCK) block[3] = block[4] = block[5] = 0.0;
      if (!invert_symmetric(block, m)) {
        const double trace = block[0] + block[1] + block[2];
        if (trace == 0.0 && zero < 0) zero = i;
        for (int k = 0; k < 6; k++)
          m[k] = (trace == 0.0) ? 0.0 : std::numeric_limits<double>::quiet_NaN();
      } else if (precondition == Precondition::NONE) {
        for (int k = 0; k < 6; k++) m[k] = (k < 3) ? 1.0 : 0.0;
      }
    }
    return zero;
  }

  // z = M^-1 r; returns this process' part of r.z

  double condition(std::size_t n)
  {
    double rz = 0.0;
    const double *m = inverse.data() + 6;
    for (std::size_t i = 3; i < n; i += 3, m += 6) {
      z[i] = m[0] * r[i] + m[3] * r[i + 1] + m[4] * r[i + 2];
      z[i + 1] = m[3] * r[i] + m[1] * r[i + 1] + m[5] * r[i + 2];
      z[i + 2] = m[4] * r[i] + m[5] * r[i + 1] + m[2] * r[i + 2];
      rz += z[i] * r[i] + z[i + 1] * r[i + 1] + z[i + 2] * r[i + 2];
    }
    return rz;
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
