// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Choice of the time step of the linearly implicit Euler scheme by its local error.
//
// A step of length h with velocity v_new, after one with v_old, leaves out h^2/2 dv/dt, of which
//
//   err = (h/2) max |v_new - v_old|                                              (length)
//
// is an estimate that costs nothing; |...| is the root mean square over the nodes of a cell. It is
// known before the step is taken, so that a step that is too long is solved again with a shorter
// one and nothing has to be undone. err may be
// tol for a step of the longest length, and grows with the square root of h below it: halfway
// between an error per step, which lets slow drifts add up, and one per time, which makes short
// transients costly [ours].
//
// Steps are longest * 2^(-k/4): round-off in a velocity then hardly ever changes a step, and runs
// on different numbers of processes take the same ones. Only a step that ends at a given time has a
// length of its own.
// Units: um, s.

#ifndef DCM_STEP_CONTROL_H
#define DCM_STEP_CONTROL_H

#include <algorithm>
#include <cmath>

namespace dcm {

class StepControl {
 public:
  double tolerance = 0.0, least = 0.0, longest = 0.0;

  /// The next shorter step of the grid, or `least`: the largest one that is not above h.
  double round_down(double h) const
  {
    if (h >= longest) return longest;
    const double k = std::ceil(4.0 * std::log2(longest / h) - 1e-9);
    return std::max(least, longest * std::exp2(-0.25 * k));
  }

  /// Error allowed in a step of length h.
  double allowed(double h) const { return tolerance * std::sqrt(h / longest); }

  /// Is there no shorter step to try?
  bool shortest(double h) const { return h <= least * (1.0 + 1e-6); }

  /// May a step of length h with this error be taken? The shortest one always is.
  bool accepts(double h, double err) const { return shortest(h) || err <= 2.0 * allowed(h); }

  /// Step to try after one of length h with this error: err grows with h^2, what is allowed with
  /// its root. At most 1.5 times as long; below a fifth only where that is tried again.
  double next(double h, double err) const
  {
    const double ratio = err > 0.0 ? allowed(h) / err : 1e30;
    const double factor = 0.9 * std::cbrt(ratio * ratio);    // (h'/h)^(3/2) = ratio
    return round_down(std::max(least, h * std::max(0.2, std::min(1.5, factor))));
  }

  /// Length of a step that is to end at the next of some given times, `left` from now: h, or what
  /// is left if that is less, or half of it if one step would leave a very short one.
  double until(double h, double left) const
  {
    if (left <= h * (1.0 + 1e-9)) return std::max(left, std::min(least, h));
    return left < 2.0 * h ? 0.5 * left : h;
  }
};

}    // namespace dcm

#endif
