// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Which form a cell should have, deformable or center-based: measures that both forms have, and
// two thresholds, so that a cell between them stays as it is [ours].

#ifndef DCM_CONVERSION_H
#define DCM_CONVERSION_H

#include "shape.h"

#include <algorithm>

namespace dcm {

enum class Form { ANY, DEFORMABLE, SPHERE };

/// What a rule asks for at `value`: shape above `on`, none below `off`; off <= on.
inline Form wanted_form(double value, double on, double off)
{
  if (value > on) return Form::DEFORMABLE;
  return value < off ? Form::SPHERE : Form::ANY;
}

/// The same for a distance: shape nearer than `in`, none farther than `out`; in <= out.
inline Form wanted_near(double distance, double in, double out)
{
  return wanted_form(-distance, -in, -out);
}

/// Mean pressure in a body of `volume` (um^3) that others press on, kPa, compression positive: by
/// the theorem of mean stress a third of `virial` over the volume, the sum of the forces on its
/// surface times their way inward to the center (nN um), or what its own forces hold against them.
inline double mean_pressure(double virial, double volume)
{
  return virial / (3.0 * volume);
}

/// By how much of the radius R of the ball of its volume a surface that comes as near to the center
/// as `nearest` is flattened: 0 for a ball, 1 if it reaches the center.
inline double flattening(double nearest, double R)
{
  return std::max(0.0, 1.0 - nearest / R);
}

/// Flattening of `cell` by the plane of equal power to `other`, with which it would be shaped.
inline double flattening(const Ball &cell, const Ball &other)
{
  return flattening(power_plane(cell, other), cell.radius);
}

}    // namespace dcm

#endif
