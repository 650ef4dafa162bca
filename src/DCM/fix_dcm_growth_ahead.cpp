/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// fix dcm/growth: rest state over a cycle, and what fix dcm/motion wants to know ahead of a step

#include "fix_dcm_growth.h"

#include "fix_dcm_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

// `until volume`: the rest volume goes no further than this times that at birth

static constexpr double MOST_GROWTH = 2.5;

/* ----------------------------------------------------------------------
   progress, in growth phases, at which the rest volume stops to grow
------------------------------------------------------------------------- */

double FixDCMGrowth::most() const
{
  return until_volume ? dcm::growth_progress(law, MOST_GROWTH) : 1.0;
}

double FixDCMGrowth::rate(int row) const
{
  return half > 0.0 ? dcm::hill_rate(strain(row), half, exponent) : 1.0;
}

double FixDCMGrowth::volume_at(const Cycle &mine, double progress) const
{
  const double growth = 1.0 - rounding;
  return mine.born * dcm::growth_factor(law, std::min(progress, growth * most()) / growth);
}

double FixDCMGrowth::length_at(double progress) const
{
  const double part = rounding > 0.0 ? (progress - (1.0 - rounding)) / rounding : 1.0;
  return 1.0 - (1.0 - shortening) * std::max(0.0, std::min(1.0, part));
}

/* ----------------------------------------------------------------------
   rest state at the end of a step: that of deformable cells, since only their forces are asked for
   ahead. A phase that ends in the step ends with it, see next_event()
------------------------------------------------------------------------- */

bool FixDCMGrowth::rest_ahead(double dt, std::vector<RestAhead> &ahead)
{
  bool any = false;
  if (half > 0.0) cell->update_all();
  const auto &table = cell->cells();
  for (const int row : table.all_deformable()) {
    const auto &it = table[row];
    if (!((*cycles)(row) > 0.0)) continue;
    const Cycle mine = cycles->load<Cycle>(row);
    if (it.phase == DCMCellTable::GROWING)
      ahead[row].volume0 *=
          volume_at(mine, mine.progress + rate(row) * dt / mine.duration) / it.volume0;
    else if (it.phase == DCMCellTable::ROUNDING)
      ahead[row].length *= length_at(mine.progress + dt / mine.duration) / mine.length;
    else
      continue;
    any = true;
  }
  return any;
}

/* ----------------------------------------------------------------------
   end of growth or of rounding up of any cell, at its present rate; spheres that compression slows
   down are left out, since their strain is not known here
------------------------------------------------------------------------- */

double FixDCMGrowth::next_event()
{
  double first = std::numeric_limits<double>::infinity();
  if (half > 0.0) cell->update_all();
  const auto &table = cell->cells();
  for (int row = 0; row < (int) table.all().size(); row++) {
    if (!((*cycles)(row) > 0.0)) continue;
    const auto &it = table[row];
    if (!it.deformable && half > 0.0) continue;
    const Cycle mine = cycles->load<Cycle>(row);
    double left = 0.0;
    if (it.phase == DCMCellTable::GROWING && !until_volume)
      left = (1.0 - rounding - mine.progress) / std::max(rate(row), 1e-9);
    else if (it.phase == DCMCellTable::ROUNDING)
      left = 1.0 - mine.progress;
    if (left > 1e-9) first = std::min(first, left * mine.duration);
  }
  return first;
}
