// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// A rigid body that moves at a given velocity and turns at a given rate about an axis in space.
// Units: um, s, rad/s.

#ifndef DCM_RIGID_MOTION_H
#define DCM_RIGID_MOTION_H

#include "vector.h"

#include <cmath>

namespace dcm {

struct RigidMotion {
  Vec3 velocity = Vec3::Zero();
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();    // of rotation; axis of length 1
  double rate = 0.0;

  /// Mean velocity over a time dt of what is at x: dt times it leads to where the body will be,
  /// however far it turns, so that steps do not widen the body.
  Vec3 mean_velocity(const Vec3 &x, double dt) const
  {
    const double angle = rate * dt, half = std::sin(0.5 * angle);
    const Vec3 across = axis.cross(x - point);
    return velocity + (std::sin(angle) * across + 2.0 * half * half * axis.cross(across)) / dt;
  }
};

}    // namespace dcm

#endif
