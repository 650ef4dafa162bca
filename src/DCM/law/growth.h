// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Growth over a cell cycle (S1 "Cell cycle and cell division"): rest volume as a function of the
// progress through the growth phase, slowing by compression, cycle times.

#ifndef DCM_GROWTH_H
#define DCM_GROWTH_H

#include "random.h"

#include <algorithm>
#include <cmath>

namespace dcm {

enum class GrowthLaw { LINEAR, EXPONENTIAL };

/// Rest volume over rest volume at birth, 1 at progress 0 and 2 at progress 1; both laws may go on
/// beyond.
inline double growth_factor(GrowthLaw law, double progress)
{
  return law == GrowthLaw::LINEAR ? 1.0 + progress : std::exp2(progress);
}

/// Progress at which a cell is `factor` times its volume at birth; inverse of growth_factor().
inline double growth_progress(GrowthLaw law, double factor)
{
  return law == GrowthLaw::LINEAR ? factor - 1.0 : std::log2(factor);
}

/// Factor on the growth rate of a cell compressed by a volumetric strain 1 - V/V0: a falling Hill
/// function, 1 for none or for a stretched cell, 1/2 at strain `half`.
inline double hill_rate(double strain, double half, double exponent)
{
  return strain > 0.0 ? 1.0 / (1.0 + std::pow(strain / half, exponent)) : 1.0;
}

/// Cycle time of one cell (s): normal with mean and sd, cut at 3 sd and at a tenth of the mean.
inline double cycle_time(double mean, double sd, Random random)
{
  const double z = std::max(-3.0, std::min(3.0, random.gaussian()));
  return std::max(0.1 * mean, mean + sd * z);
}

}    // namespace dcm

#endif
