// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// A load per area on the triangles of a surface: a pressure from outside, which turns with the
// triangle, and a dead traction, which keeps its direction; both per present area. Not in S1.
// Units: lengths um, areas um^2, pressures and tractions nN/um^2 (= kPa), forces nN.
// Faces are counter-clockwise seen from outside.

#ifndef DCM_TRACTION_H
#define DCM_TRACTION_H

#include "vector.h"

namespace dcm {

/// Load on a triangle, nN, and its area, um^2. Each corner bears a third, so that force and torque
/// are those of an even load, whose resultant goes through the centroid.
struct FaceLoad {
  Vec3 third;
  double area;
};

/// P > 0 pushes inward, P < 0 is suction; t is the traction. With P alike on all faces of a closed
/// surface the forces are exactly -P dV/dr, without net force and net torque. A load on part of a
/// surface, or one that differs from face to face, has no potential, nor has t, whose force grows
/// with the area.
inline FaceLoad face_load(double P, const Vec3 &t, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const Vec3 twice = (b - a).cross(c - a);    // two areas along the outward normal
  FaceLoad load;
  load.area = 0.5 * twice.norm();
  load.third = (load.area / 3.0) * t - (P / 6.0) * twice;
  return load;
}

}    // namespace dcm

#endif
