// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Discrete curvature of a triangulated surface and the sphere through a face (S1 "Contact model").
// Units: lengths um, areas um^2, curvatures 1/um. Faces are counter-clockwise seen from outside.
//
// Use: add face_curvature_parts() of every face to its three nodes, then per node
// k = node_curvature(sum laplace, sum normal, sum area), then per face face_radius() of the mean k
// of its nodes; make_face() (contact.h) puts the sphere of that radius through the vertices.
// Node curvatures are averaged as scalars: three unit normals that differ average to less than
// one, so averaging vectors makes spheres too large (1.5 % at 162 nodes).

#ifndef DCM_CURVATURE_H
#define DCM_CURVATURE_H

#include "vector.h"

#include <algorithm>
#include <cmath>

namespace dcm {

/// What one triangle adds to each of its three corners.
struct FaceCurvature {
  double area[3];     ///< mixed Voronoi area, um^2 (Meyer et al. 2003); the three sum to the area
  Vec3 laplace[3];    ///< sum of cot (r_i - r_j) over the two edges, um
  Vec3 normal[3];     ///< weighted normal, 1/um^2: direction of the node normal when summed
};

/// Contributions of the triangle (a, b, c). A triangle of zero area contributes nothing.
/// Normals are weighted by 2A/(l1 l2)^2, l1 and l2 the sides at the corner (Max 1999): exact for
/// any mesh whose nodes lie on a sphere, where area or angle weights are only first or second
/// order.
inline FaceCurvature face_curvature_parts(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  FaceCurvature fc;
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const Vec3 m = ab.cross(-ca);
  const double mm = m.squaredNorm();
  if (!(mm > 0.0)) {
    for (int i = 0; i < 3; i++) {
      fc.area[i] = mm;    // zero, or NaN if a coordinate is: never hidden
      fc.laplace[i].setConstant(mm);
      fc.normal[i].setConstant(mm);
    }
    return fc;
  }

  const double lab = ab.squaredNorm(), lbc = bc.squaredNorm(), lca = ca.squaredNorm();
  const double da = -ab.dot(ca), db = -bc.dot(ab), dc = -ca.dot(bc);
  const double twice = std::sqrt(mm);
  const double inv = 1.0 / twice;
  const double cota = da * inv, cotb = db * inv, cotc = dc * inv;

  fc.laplace[0] = cotb * ca - cotc * ab;
  fc.laplace[1] = cotc * ab - cota * bc;
  fc.laplace[2] = cota * bc - cotb * ca;

  fc.normal[0] = m / (lab * lca);
  fc.normal[1] = m / (lbc * lab);
  fc.normal[2] = m / (lca * lbc);

  if (da >= 0.0 && db >= 0.0 && dc >= 0.0) {
    const double ub = 0.125 * lca * cotb, uc = 0.125 * lab * cotc, ua = 0.125 * lbc * cota;
    fc.area[0] = ub + uc;
    fc.area[1] = uc + ua;
    fc.area[2] = ua + ub;
  } else {
    // obtuse: the Voronoi cell leaves the triangle; half the area to the obtuse corner
    const double quarter = 0.125 * twice;
    fc.area[0] = da < 0.0 ? 2.0 * quarter : quarter;
    fc.area[1] = db < 0.0 ? 2.0 * quarter : quarter;
    fc.area[2] = dc < 0.0 ? 2.0 * quarter : quarter;
  }
  return fc;
}

/// Signed scalar curvature K.N of a node, 1/um, from the sums of the three contributions over its
/// faces: twice the mean curvature, 2/R on a sphere, > 0 where convex.
/// Zero if the node has no area or no normal.
inline double node_curvature(const Vec3 &K_sum, const Vec3 &N_sum, double S)
{
  const double d = 2.0 * S * N_sum.norm();
  return d == 0.0 ? 0.0 : K_sum.dot(N_sum) / d;
}

/// Radius of the sphere that stands for a face, um: 2/kf clipped to [Rmin, Rmax]. A concave or
/// flat face gets Rmax; with negative_allowed a concave one gets -(2/|kf|, clipped likewise).
/// |R| is never below the circumradius r_circ, so that the sphere can pass through the vertices.
inline double face_radius(double kf, double r_circ, double Rmin, double Rmax,
                          bool negative_allowed = false)
{
  const bool concave = kf < 0.0;
  const double k = concave ? (negative_allowed ? -kf : 0.0) : kf;
  double R = k * Rmax > 2.0 ? std::max(2.0 / k, Rmin) : Rmax;
  R = std::max(R, r_circ);
  return concave && negative_allowed ? -R : R;
}

}    // namespace dcm

#endif
