// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// How deep two triangles are behind each other along a direction. The triangles are flat, so that
// the overlap is linear over the common part of their projections and largest in a corner of it:
// nothing hides between the middles of coarse faces. Lengths in um.

#ifndef DCM_FACE_OVERLAP_H
#define DCM_FACE_OVERLAP_H

#include "contact.h"

namespace dcm {

/// The place where two faces overlap most, as a point of each.
struct FaceOverlap {
  Vec3 on_f, on_g;
  double depth = 0.0;    ///< (on_f - on_g) . u, negative: a gap everywhere
};

/// No overlap of f and g along u exceeds this.
inline double overlap_bound(const FaceGeometry &f, const FaceGeometry &g, const Vec3 &u)
{
  double far = f.x[0].dot(u), near = g.x[0].dot(u);
  for (int k = 1; k < 3; k++) {
    far = std::max(far, f.x[k].dot(u));
    near = std::min(near, g.x[k].dot(u));
  }
  return far - near;
}

/// \param u unit vector out of f, into g
/// \return false if the projections along u have nothing in common, or a face is seen edge-on
inline bool face_overlap(const FaceGeometry &f, const FaceGeometry &g, const Vec3 &u,
                         FaceOverlap &out)
{
  Vec3 e1, e2;
  detail::frame(u, e1, e2);
  Triangle2 tf, tg;
  detail::project(f, f.mid, e1, e2, false, tf);
  detail::project(g, f.mid, e1, e2, true, tg);
  if (detail::edge_on(tf.twice_area(), f.reach) || detail::edge_on(tg.twice_area(), g.reach))
    return false;
  Polygon2 common;
  clip_triangles(tf, tg, common);
  // height of a face's plane over the point (x, y) of the projection
  const auto on = [&](const FaceGeometry &face, double x, double y) -> Vec3 {
    const Vec3 foot = f.mid + x * e1 + y * e2;
    return foot + u * (face.n.dot(face.mid - foot) / face.n.dot(u));
  };
  bool any = false;
  for (int k = 0; k < common.n; k++) {
    const Vec3 a = on(f, common.x[k], common.y[k]), b = on(g, common.x[k], common.y[k]);
    const double depth = (a - b).dot(u);
    if (any && !(depth > out.depth)) continue;
    any = true;
    out = {a, b, depth};
  }
  return any;
}

}    // namespace dcm

#endif
