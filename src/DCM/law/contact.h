// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact of two triangles of cell surfaces, or of a triangle and a sphere (S1 "Contact model").
// Each triangle stands for its circumscribing sphere; the stress of the contact of the two spheres
// (law: maugis.h, dmt.h or foundation.h) is integrated over the common part of the two triangles,
// projected along the axis u through the sphere centers. All forces are parallel to u and are
// spread with barycentric weights in that projection: they balance, and so do their torques.
//
// A pair enters and leaves with a common part of area zero, and a face that looks away from the
// other sphere has a projection of negative area: no test cuts a pair off at finite force, except
// where the law itself jumps (maugis at delta = -h0).

#ifndef DCM_CONTACT_H
#define DCM_CONTACT_H

#include "contact_law.h"
#include "dmt.h"
#include "foundation.h"
#include "maugis.h"
#include "overlap.h"
#include "radial_integral.h"

#include <type_traits>

namespace dcm {

/// A triangle with its circumscribing sphere. What rejects a pair stands first (cache lines).
struct FaceGeometry {
  Vec3 center;           ///< center of the sphere
  Vec3 n;                ///< outward unit normal; zero for a degenerate triangle
  Vec3 mid;              ///< centroid
  double R;              ///< radius of the sphere; negative: concave, center outside the cell
  double reach;          ///< largest distance of a vertex from mid
  Vec3 x[3];             ///< vertices, counter-clockwise seen from outside
  double radius_circ;    ///< circumradius
  double area;
};

/// Result of one contact, see face_face().
struct ContactResult {
  Vec3 u;                 ///< unit vector from the sphere of f to that of g, out of f
  double delta;           ///< overlap of the spheres, > 0: compression
  double force;           ///< along u, > 0 repulsive: g is pushed along +u, f along -u
  double wf[3], wg[3];    ///< each sums to force: vertex k of f gets -wf[k] u, of g +wg[k] u
  double area;            ///< part of the common polygon with r <= c
  double bf[3], bg[3];    ///< barycentric weights (sum 1, within 0..1) of that part's centroid
  double slope;           ///< dF/d delta at fixed polygon, of either sign; only if asked for
  double moment[3];    ///< second moments xx, xy, yy of that part per area, about its centroid, in
                       ///< the frame of u (detail::frame): with the slope only
  double tilt;         ///< face_sphere() with LOCAL_GAP: cosine between u and the sphere's
                       ///< surface there, for facing(): none beside its equator; else 1

  /// Count the contact by a weight only; the slope, which few ask for, is left as it is.
  void scale(double weight)
  {
    force *= weight;
    area *= weight;
    for (double *w : {wf, wg})
      for (int k = 0; k < 3; k++) w[k] *= weight;
  }
};

/// Face from its vertices and the radius of its sphere (curvature.h), R < 0 for concave.
/// The sphere passes through the three vertices. Where it cannot (|R| near or below the
/// circumradius, as for slivers), |R| is raised and the center pulled to the normal through the
/// middle of the triangle, continuously, so that the result is always finite.
inline FaceGeometry make_face(const Vec3 &x0, const Vec3 &x1, const Vec3 &x2, double R)
{
  FaceGeometry f;
  f.x[0] = x0;
  f.x[1] = x1;
  f.x[2] = x2;
  f.mid = (x0 + x1 + x2) / 3.0;
  const Vec3 u = x1 - x0, v = x2 - x0;
  const Vec3 m = u.cross(v);
  const double mm = m.squaredNorm(), uu = u.squaredNorm(), vv = v.squaredNorm();
  const double twice = std::sqrt(mm);
  f.area = 0.5 * twice;
  f.reach = std::sqrt(std::max((x0 - f.mid).squaredNorm(),
                               std::max((x1 - f.mid).squaredNorm(), (x2 - f.mid).squaredNorm())));
  f.R = R;
  if (!(mm > 1e-24 * uu * vv)) {
    f.n.setZero();
    f.center = f.mid;
    f.radius_circ = f.reach;
    return f;
  }
  f.n = m / twice;
  const Vec3 w = (vv * m.cross(u) - uu * m.cross(v)) / (2.0 * mm);
  f.radius_circ = w.norm();
  Vec3 foot = x0 + w;
  double rho2 = f.radius_circ * f.radius_circ;
  const double size = std::fabs(R);
  if (rho2 > 0.75 * size * size) {
    // least squares instead of exact: the foot moves at most R/2 away from the middle
    const Vec3 off = foot - f.mid;
    const double len = off.norm();
    if (len > 0.5 * size) foot = f.mid + off * (0.5 * size / len);
    rho2 =
        ((x0 - foot).squaredNorm() + (x1 - foot).squaredNorm() + (x2 - foot).squaredNorm()) / 3.0;
    const double raised = std::sqrt(std::max(size * size, rho2 / 0.75));
    f.R = R < 0.0 ? -raised : raised;
  }
  const double depth = std::sqrt(std::max(0.0, f.R * f.R - rho2));
  f.center = foot - (f.R < 0.0 ? -depth : depth) * f.n;
  return f;
}

namespace detail {

  /// Does a face of radius R meet another of radius `other` as a cavity meets a ball?
  inline bool cavity(double R, double other)
  {
    return R < 0.0 && other > 0.0 && -R > 2.0 * other;
  }

  /// Sphere of a face as its partner meets it: as it is, or, if concave and not met as a cavity,
  /// mirrored through the plane of the face and so convex.
  inline void sphere_met(const FaceGeometry &f, bool as_cavity, Vec3 &center, double &R)
  {
    center = f.center;
    R = f.R;
    if (!(R < 0.0) || as_cavity) return;
    center = f.center - 2.0 * f.n * f.n.dot(f.center - f.mid);
    R = -f.R;
  }

  /// Can a face have a part within c of the axis through origin along u?
  inline bool near_axis(const FaceGeometry &f, const Vec3 &origin, const Vec3 &u, double c)
  {
    const Vec3 off = f.mid - origin;
    const double along = off.dot(u), bound = c + f.reach;
    return off.squaredNorm() - along * along < bound * bound;
  }

  /// Two unit vectors that make a right-handed frame with u (Duff et al. 2017).
  inline void frame(const Vec3 &u, Vec3 &e1, Vec3 &e2)
  {
    const double sign = std::copysign(1.0, u[2]);
    const double p = -1.0 / (sign + u[2]);
    const double q = u[0] * u[1] * p;
    e1 = Vec3(1.0 + sign * u[0] * u[0] * p, sign * q, -sign * u[0]);
    e2 = Vec3(q, sign + u[1] * u[1] * p, -u[1]);
  }

  /// Projection relative to the axis; flip: keep counter-clockwise a face seen from inside.
  inline void project(const FaceGeometry &f, const Vec3 &origin, const Vec3 &e1, const Vec3 &e2,
                      bool flip, Triangle2 &t)
  {
    for (int k = 0; k < 3; k++) {
      const Vec3 d = f.x[k] - origin;
      const int i = flip ? (3 - k) % 3 : k;
      t.x[i] = d.dot(e1);
      t.y[i] = d.dot(e2);
    }
  }

  // projections smaller than this part of their squared size are seen edge-on: no area, no force
  constexpr double EDGE_ON = 1e-9;

  inline bool edge_on(double twice_area, double reach)
  {
    return !(twice_area > EDGE_ON * reach * reach);
  }

  /// Integral of (barycentric weight k) x density, from integral and moments of the density.
  inline void barycentric(const Triangle2 &t, double inv2area, double f, double mx, double my,
                          double w[3])
  {
    // moments about a corner: the axis may be far from the triangle
    const double ux = t.x[1] - t.x[0], uy = t.y[1] - t.y[0];
    const double vx = t.x[2] - t.x[0], vy = t.y[2] - t.y[0];
    const double px = mx - f * t.x[0], py = my - f * t.y[0];
    w[1] = (px * vy - py * vx) * inv2area;
    w[2] = (ux * py - uy * px) * inv2area;
    w[0] = f - w[1] - w[2];
  }

  /// The same for the centroid of an area inside the triangle: weights in [0, 1], sum 1.
  inline void centroid_weights(const Triangle2 &t, double inv2area, const RadialSums &s,
                               double b[3])
  {
    const double inv = 1.0 / s.area;
    barycentric(t, inv2area, 1.0, s.ax * inv, s.ay * inv, b);
    double total = 0.0;
    for (int k = 0; k < 3; k++) {
      b[k] = std::min(1.0, std::max(0.0, b[k]));
      total += b[k];
    }
    for (int k = 0; k < 3; k++) b[k] /= total;
  }

  /// The share of each vertex of a face in a contact, ContactResult's w and b.
  inline void spread(const Triangle2 &t, double twice_area, const RadialSums &sum, double w[3],
                     double b[3])
  {
    const double inv2area = 1.0 / twice_area;
    barycentric(t, inv2area, sum.force, sum.mx, sum.my, w);
    centroid_weights(t, inv2area, sum, b);
  }

  /// Square of the distance from the axis to the centroid of a polygon.
  inline double middle(const Boundary2 &poly)
  {
    double area = 0.0, x = 0.0, y = 0.0;
    for (int i = 0; i < poly.n; i++) {
      const double ax = poly.x0[i] - poly.x0[0], ay = poly.y0[i] - poly.y0[0];
      const double bx = poly.x1[i] - poly.x0[0], by = poly.y1[i] - poly.y0[0];
      const double cross = ax * by - ay * bx;
      area += cross;
      x += cross * (ax + bx);
      y += cross * (ay + by);
    }
    const double third = area > 0.0 ? 1.0 / (3.0 * area) : 0.0;
    x = poly.x0[0] + third * x;
    y = poly.y0[0] + third * y;
    return x * x + y * y;
  }

  /// Second moments of a polygon about its centroid, per area, times area/(its own): what part of
  /// it a contact takes is not known better.
  inline void second_moments(const Boundary2 &poly, double area, double moment[3])
  {
    double whole = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (int i = 0; i < poly.n; i++) {
      const double ax = poly.x0[i] - poly.x0[0], ay = poly.y0[i] - poly.y0[0];
      const double bx = poly.x1[i] - poly.x0[0], by = poly.y1[i] - poly.y0[0];
      const double cross = ax * by - ay * bx;
      whole += cross / 2.0;
      x += cross * (ax + bx) / 6.0;
      y += cross * (ay + by) / 6.0;
      xx += cross * (ax * ax + ax * bx + bx * bx) / 12.0;
      yy += cross * (ay * ay + ay * by + by * by) / 12.0;
      xy += cross * (2.0 * (ax * ay + bx * by) + ax * by + bx * ay) / 24.0;
    }
    const double inv = whole > 0.0 ? 1.0 / whole : 0.0, share = std::min(1.0, area * inv);
    x *= inv;
    y *= inv;
    moment[0] = share * std::max(0.0, xx * inv - x * x);
    moment[1] = share * (xy * inv - x * y);
    moment[2] = share * std::max(0.0, yy * inv - y * y);
  }

  /// The gap of two spheres beside their axis. With s = r^2 the overlap is
  ///
  ///   o(s) = sqrt(Rf^2 - s) + sqrt(Rg^2 - s) - d    (signs of the radii at the roots)
  ///
  /// which Hertz takes as delta - s/2R, for contacts that are small against the spheres. Faces are
  /// small against theirs, but far from the axis where surfaces are tilted: at 45 degrees Hertz is
  /// off by 4 % of R, micrometers for flat faces. Here o is linear in s about the middle of the
  /// polygon, which gives delta and R their values for this polygon.
  inline void gap_beside_axis(double Rf, double Rg, double sensed, double s, double &delta,
                              double &R)
  {
    constexpr double LOWEST = 0.25;    // no farther out than 60 degrees, where vertices are not on
                                       // their sphere (make_face)
    const double hf = std::copysign(std::sqrt(std::max(LOWEST * Rf * Rf, Rf * Rf - s)), Rf);
    const double hg = std::copysign(std::sqrt(std::max(LOWEST * Rg * Rg, Rg * Rg - s)), Rg);
    R = hf * hg / (hf + hg);
    delta = hf + hg - sensed + 0.5 * s / R;
  }

  template <class State, bool SLOPE>
  using Sums = std::conditional_t<SLOPE && State::EXACT_CORE, RadialSumsAndSlope, RadialSums>;

  /// Slope of a law's force at fixed polygon by a secant, narrow against the range of adhesion: for
  /// laws that have none in closed form. Where there is no contact on one side, that of the other.
  template <class State>
  double secant(const ContactMaterial &mat, double R, double delta, const Boundary2 &poly,
                int npoints, bool existing, double force)
  {
    constexpr double WIDTH = 0.02;
    const double e = WIDTH * (mat.sigma0() > 0.0 ? mat.h0 : delta);
    double side[2] = {force, force}, span = 0.0;
    for (int k = 0; k < 2; k++) {
      State state;
      if (!state.set(mat, R, k ? delta + e : delta - e, existing)) continue;
      RadialSums sum;
      radial_integral(state, poly, npoints, sum);
      side[k] = sum.force;
      span += e;
    }
    return span > 0.0 ? (side[1] - side[0]) / span : 0.0;
  }

}    // namespace detail

/// How far a face looks along the axis of a contact, from the cosine between its normal and the
/// axis: 0 when tilted by more than `none` degrees, 1 below `full`, smooth between. Faces of
/// surfaces that touch look at each other; what the sphere of a tilted face reports beside an edge
/// or fold of its own cell is no contact. For the caller: the law itself is exact at any tilt.
struct Facing {
  double none = 0.64278760968653933, full = 0.76604444311897804;    // cosines: 50, 40 degrees

  double operator()(double cosine) const
  {
    const double s = std::min(std::max((cosine - none) / (full - none), 0.0), 1.0);
    return s * s * (3.0 - 2.0 * s);
  }
};

/// Contact of two faces.
/// \param npoints  Gauss points per edge piece inside the core of the contact, 1 to 4
/// \param existing the pair was in contact before: law maugis then keeps its neck below -h0
/// \tparam SLOPE   give out.slope and moment as well; moving g along u by s changes the force by
/// -slope s \return false, cheaply, where there is none: faces that look away from each other, are
/// too far,
///         do not overlap in projection, or whose sphere centers coincide (no axis)
///
/// A concave face (R < 0) meets a convex one of less than half its radius as a ball in a cavity:
/// axis out of the cavity's wall, delta = R_f + R_g + d, 1/R = 1/R_f + 1/R_g. Where that does not
/// define a point contact (conforming radii, two concave faces) the concave face counts as convex
/// with the same |R|.
template <class State, bool SLOPE = false>
bool face_face(const FaceGeometry &f, const FaceGeometry &g, const ContactMaterial &mat,
               int npoints, ContactResult &out, bool existing = false)
{
  const bool as_cavity = detail::cavity(f.R, g.R) || detail::cavity(g.R, f.R);
  const double sense = as_cavity ? -1.0 : 1.0;
  Vec3 cf, cg;
  double Rf, Rg;
  detail::sphere_met(f, as_cavity, cf, Rf);
  detail::sphere_met(g, as_cavity, cg, Rg);
  const Vec3 axis = sense * (cg - cf);
  // written so that NaN fails each test
  if (!(f.n.dot(axis) > 0.0 && g.n.dot(axis) < 0.0)) return false;

  const double d2 = axis.squaredNorm();
  const Vec3 dm = g.mid - f.mid;
  const double along = dm.dot(axis);
  const double bound = f.reach + g.reach;
  if (!(dm.squaredNorm() * d2 - along * along < bound * bound * d2)) return false;
  const double d = std::sqrt(d2);
  if (!(d > 1e-12 * (std::fabs(Rf) + std::fabs(Rg)))) return false;
  double delta = Rf + Rg - sense * d;
  if (!existing && !(delta > mat.first_touch())) return false;
  const Vec3 u = axis / d;

  double R = Rf * Rg / (Rf + Rg);
  if (!existing) {
    // distance of the triangles from the axis against the largest possible contact radius
    const double cmax = State::reach(mat, R, delta);
    if (!(detail::near_axis(f, cf, u, cmax) && detail::near_axis(g, cf, u, cmax))) return false;
  }

  Vec3 e1, e2;
  detail::frame(u, e1, e2);
  Triangle2 tf, tg;
  detail::project(f, cf, e1, e2, false, tf);
  detail::project(g, cf, e1, e2, true, tg);
  const double af = tf.twice_area(), ag = tg.twice_area();
  if (detail::edge_on(af, f.reach) || detail::edge_on(ag, g.reach)) return false;
  Boundary2 poly;
  if (!triangle_overlap(tf, tg, poly)) return false;
  if (State::LOCAL_GAP) detail::gap_beside_axis(Rf, Rg, sense * d, detail::middle(poly), delta, R);

  State state;
  if (!state.set(mat, R, delta, existing)) return false;
  detail::Sums<State, SLOPE> sum;
  if constexpr (sum.SLOPE) sum.law = state.slope(mat, R, delta);
  radial_integral(state, poly, npoints, sum);
  if (!(sum.area > 0.0)) return false;
  if constexpr (sum.SLOPE)
    out.slope = sum.slope;
  else if constexpr (SLOPE)
    out.slope = detail::secant<State>(mat, R, delta, poly, npoints, existing, sum.force);
  if constexpr (SLOPE) detail::second_moments(poly, sum.area, out.moment);

  out.u = u;
  out.delta = delta;
  out.force = sum.force;
  out.area = sum.area;
  detail::spread(tf, af, sum, out.wf, out.bf);
  detail::spread(tg, ag, sum, out.wg, out.bg);
  std::swap(out.wg[1], out.wg[2]);    // g was projected with its vertices in reverse
  std::swap(out.bg[1], out.bg[2]);
  return true;
}

/// Contact of a face and a whole sphere (centre-based cell): as face_face() without a triangle on
/// the other side. The sphere gets +force u at its center: wg = {force, 0, 0}, bg = {1, 0, 0}.
/// A single face is pushed off-axis, so its torque is balanced only in the sum over the faces under
/// the sphere (exactly where they share one sphere). Concave faces: as in face_face().
template <class State, bool SLOPE = false>
bool face_sphere(const FaceGeometry &f, const Vec3 &center, double radius,
                 const ContactMaterial &mat, int npoints, ContactResult &out, bool existing = false)
{
  // a sphere whose center is behind the face's plane does not touch it from outside; the fictitious
  // sphere of a flat face reaches far beyond the face and would find an overlap there
  if (!(radius > 0.0) || !(f.n.dot(center - f.mid) > 0.0)) return false;
  const bool as_cavity = detail::cavity(f.R, radius);
  const double sense = as_cavity ? -1.0 : 1.0;
  Vec3 cf;
  double Rf;
  detail::sphere_met(f, as_cavity, cf, Rf);
  const Vec3 axis = sense * (center - cf);
  if (!(f.n.dot(axis) > 0.0)) return false;
  const double d = axis.norm();
  if (!(d > 1e-12 * (std::fabs(Rf) + radius))) return false;
  double delta = Rf + radius - sense * d;
  if (!existing && !(delta > mat.first_touch())) return false;
  const Vec3 u = axis / d;

  double R = Rf * radius / (Rf + radius);
  if (!existing && !detail::near_axis(f, cf, u, State::reach(mat, R, delta))) return false;

  Vec3 e1, e2;
  detail::frame(u, e1, e2);
  Triangle2 tf;
  detail::project(f, cf, e1, e2, false, tf);
  const double af = tf.twice_area();
  if (detail::edge_on(af, f.reach)) return false;
  Boundary2 poly;
  for (int k = 0; k < 3; k++) {
    const int kn = (k + 1) % 3;
    poly.add(tf.x[k], tf.y[k], tf.x[kn], tf.y[kn]);
  }
  out.tilt = 1.0;
  if (State::LOCAL_GAP) {
    const double s = detail::middle(poly);
    detail::gap_beside_axis(Rf, radius, sense * d, s, delta, R);
    out.tilt = std::sqrt(std::max(0.0, 1.0 - s / (radius * radius)));
  }
  State state;
  if (!state.set(mat, R, delta, existing)) return false;
  detail::Sums<State, SLOPE> sum;
  if constexpr (sum.SLOPE) sum.law = state.slope(mat, R, delta);
  radial_integral(state, poly, npoints, sum);
  if (!(sum.area > 0.0)) return false;
  if constexpr (sum.SLOPE)
    out.slope = sum.slope;
  else if constexpr (SLOPE)
    out.slope = detail::secant<State>(mat, R, delta, poly, npoints, existing, sum.force);
  if constexpr (SLOPE) detail::second_moments(poly, sum.area, out.moment);

  out.u = u;
  out.delta = delta;
  out.force = sum.force;
  out.area = sum.area;
  detail::spread(tf, af, sum, out.wf, out.bf);
  out.wg[0] = sum.force;
  out.wg[1] = out.wg[2] = 0.0;
  out.bg[0] = 1.0;
  out.bg[1] = out.bg[2] = 0.0;
  return true;
}

}    // namespace dcm

#endif
