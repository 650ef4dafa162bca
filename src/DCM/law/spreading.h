// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Adhesion along a surface. The energy -W A of an area A in contact drives its growth in two ways:
// the stress across the gap closes the wedge at the rim, and the area itself grows where it is
// stretched, which lowers the tension of the surfaces there. At the rim the stress across gives
// the balance normal to the contact, and what follows here that along it,
//
//   T cos(theta) = T - W/2      for each of two cells of tension T: Young and Dupre,
//
// which contact stresses, all along one axis, cannot give. Two deformable faces share W, a face
// before something rigid has it all. The share of a face that is covered is kept fixed, so that the
// force is W times the gradient of its area: no net force and no net torque on any face.
// Units: um, nN; W in nN/um.

#ifndef DCM_SPREADING_H
#define DCM_SPREADING_H

#include "contact.h"

namespace dcm {

/// Part of W that belongs to each of two faces, and to a face before a sphere.
constexpr double SPREADING_SHARED = 0.5, SPREADING_ALONE = 1.0;

/// By how much the tension of a face is lowered, nN/um.
/// \param covered area in contact, projected along the axis, um^2
/// \param cosine  between the axis and the normal of the face, of either sign
inline double spreading_tension(const FaceGeometry &f, double W, double share, double covered,
                                double cosine)
{
  const double projected = f.area * std::fabs(cosine);
  return projected > covered ? share * W * covered / projected : share * W;
}

/// Force on vertex k of a face whose tension is lowered.
inline Vec3 spreading_force(const FaceGeometry &f, int k, double tension)
{
  return 0.5 * tension * f.n.cross(f.x[(k + 2) % 3] - f.x[(k + 1) % 3]);
}

}    // namespace dcm

#endif
