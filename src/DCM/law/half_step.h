// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Step length by a relative accuracy: how far is a step from two of half its length?
//
// The linearly implicit step of length h moves a cell by h v_h, (Gamma + h K) v_h = F. For a mode
// that relaxes at the rate lambda, v_h = v / (1 + h lambda), and what a step of half the length
// would begin with differs by
//
//   rho = |v_h - v_h/2| / |v_h|  =  (h lambda / 2) / (1 + h lambda / 2),
//
// which is the relative error of backward Euler's motion over the time of the relaxation, to
// leading order in h. It also sees a K that is not that of the forces, as where contacts grow and
// their softening is left out: there velocities hardly change from step to step, and yet are too
// small. |...| is the root mean square over the nodes of a cell. A step may have
//
//   h |v_h - v_h/2|  <=  A h |v_h| + floor
//
// in every cell. The floor lets cells rest that hardly move. One more solution in some steps,
// EVERY, and where the step has become longer. Units: um, s.

#ifndef DCM_HALF_STEP_H
#define DCM_HALF_STEP_H

#include <algorithm>
#include <cmath>
#include <limits>

namespace dcm {

struct HalfStep {
  static constexpr int EVERY = 4;            ///< steps from one check to the next [ours]
  static constexpr double LONGER = 1.5;      ///< or one so many times as long as the last checked
  static constexpr double REJECTED = 2.0;    ///< excess from which a step is not taken

  double accuracy = 0.0;    ///< A, relative; 0: not in use
  double floor = 0.0;       ///< length

  // state of a run, which restart files hold

  double limit = std::numeric_limits<double>::infinity();    ///< of the coming steps
  double checked = 0.0;                                      ///< length of the last checked step
  int since = 0;                                             ///< steps that came after it

  /// Is a step of length h to be checked? To be called once a step.
  bool due(double h)
  {
    since++;
    return accuracy > 0.0 && (since >= EVERY || h > LONGER * checked);
  }

  /// How much too far a cell is off, 1: just allowed. off: h |v_h - v_h/2|, way: h |v_h|.
  double excess(double off, double way) const { return off / (accuracy * way + floor); }

  /// The largest excess of a step of length h: sets the limit of the coming steps. What is off
  /// grows with h^2, the way with h.
  void take(double h, double most)
  {
    most = std::max(most, 1e-6);
    const double factor = most > 1.0 ? 1.0 / most : 1.0 / std::sqrt(most);
    limit = 0.9 * h * std::min(4.0, std::max(0.25, factor));
    checked = h;
    since = 0;
  }
};

}    // namespace dcm

#endif
