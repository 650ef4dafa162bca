// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Apical constriction (S1 eqs 11-13): edges of the junction ribbon and of the apical cap become
// shorter at rest, once per cell. S1 shortens them at once; here the factor runs from 1 to its last
// value with the cell's share of the ramp.

#ifndef DCM_CONSTRICTION_H
#define DCM_CONSTRICTION_H

#include <algorithm>

namespace dcm {

/// Where an edge belongs: to the region that both its faces lie in.
enum class ConstrictedEdge { NONE, RIBBON, CAP };

template <class Region>
ConstrictedEdge constricted_edge(Region a, Region b, Region junction, Region apical)
{
  if (a != b) return ConstrictedEdge::NONE;
  if (a == junction) return ConstrictedEdge::RIBBON;
  return a == apical ? ConstrictedEdge::CAP : ConstrictedEdge::NONE;
}

/// Share of the ramp one step later: it runs up to 1 while the cell constricts, and back to 0 with
/// the same speed when it lets go. step: time step over the time of the ramp. Round-off of the sum
/// does not add a step at either end.
inline double constriction_share(double share, double step, bool constricts)
{
  const double next = constricts ? share + step : share - step;
  if (next > 1.0 - 1.0e-9) return 1.0;
  return next < 1.0e-9 ? 0.0 : next;
}

/// Factor on the rest length of an edge whose last one is `factor`; exactly 1 at share 0.
inline double constriction_factor(double factor, double share)
{
  return 1.0 - (1.0 - factor) * share;
}

/// The rest length of one edge, that others change as well (growth, death): theirs is a factor on
/// what they find, so that the length without constriction takes it, too. Kept beside the length,
/// since dividing a factor out again would lose digits each time.
struct ConstrictedLength {
  double factor;     ///< last one of the ramp, 0: this edge does not constrict
  double base;       ///< rest length without constriction
  double written;    ///< with it, as it was written last

  /// The new rest length, `now` times that without; l0: the present one. Exactly the latter at 1.
  double scaled(double now, double l0)
  {
    if (l0 != written) base *= l0 / written;
    written = base * now;
    return written;
  }

  /// That at a share of the ramp.
  double at(double share, double l0) { return scaled(constriction_factor(factor, share), l0); }
};

}    // namespace dcm

#endif
