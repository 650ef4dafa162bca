// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Overlap of two triangles in a plane, as the closed boundary of the common polygon. Radial
// stresses are integrated along that boundary, so the order of its segments is of no interest and
// each edge of one triangle is simply cut by the three lines of the other.

#ifndef DCM_OVERLAP_H
#define DCM_OVERLAP_H

#include <algorithm>
#include <cmath>

namespace dcm {

/// Corners of a triangle in the plane, counter-clockwise; any length unit.
struct Triangle2 {
  double x[3], y[3];

  double twice_area() const
  {
    return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  }
};

/// Most corners of a clipped triangle: six, and what round-off adds where corners lie on the lines
/// that clip. A line cuts between corners on different sides, so that 3 corners become at most 4, 6
/// and 9.
constexpr int MAX_OVERLAP = 9;

/// Directed boundary segments of a convex polygon; the polygon lies to their left.
struct Boundary2 {
  static constexpr int MAXSEG = MAX_OVERLAP;
  int n = 0;
  double x0[MAXSEG], y0[MAXSEG], x1[MAXSEG], y1[MAXSEG];

  void add(double ax, double ay, double bx, double by)
  {
    x0[n] = ax;
    y0[n] = ay;
    x1[n] = bx;
    y1[n] = by;
    n++;
  }
};

/// Corners of a convex polygon in order, counter-clockwise.
struct Polygon2 {
  static constexpr int MAXCORNER = MAX_OVERLAP;
  int n = 0;
  double x[MAXCORNER], y[MAXCORNER];
};

/// Sutherland-Hodgman clip of triangle f by triangle g. Slower than triangle_overlap(), but its
/// result is a closed polygon whatever the round-off: used where edges or corners coincide.
inline void clip_triangles(const Triangle2 &f, const Triangle2 &g, Polygon2 &out)
{
  Polygon2 poly[2];
  poly[0].n = 3;
  for (int k = 0; k < 3; k++) {
    poly[0].x[k] = f.x[k];
    poly[0].y[k] = f.y[k];
  }
  int now = 0;
  for (int j = 0; j < 3 && poly[now].n > 0; j++) {
    const int jn = (j + 1) % 3;
    const double ex = g.x[jn] - g.x[j], ey = g.y[jn] - g.y[j];
    const Polygon2 &in = poly[now];
    Polygon2 &res = poly[1 - now];
    res.n = 0;
    double px = in.x[in.n - 1], py = in.y[in.n - 1];
    double ps = ex * (py - g.y[j]) - ey * (px - g.x[j]);
    for (int i = 0; i < in.n; i++) {
      const double qx = in.x[i], qy = in.y[i];
      const double qs = ex * (qy - g.y[j]) - ey * (qx - g.x[j]);
      if ((ps > 0.0) != (qs > 0.0)) {
        const double t = ps / (ps - qs);
        res.x[res.n] = px + t * (qx - px);
        res.y[res.n] = py + t * (qy - py);
        res.n++;
      }
      if (qs > 0.0) {
        res.x[res.n] = qx;
        res.y[res.n] = qy;
        res.n++;
      }
      px = qx;
      py = qy;
      ps = qs;
    }
    now = 1 - now;
  }
  out = poly[now];
  if (out.n < 3) out.n = 0;
}

namespace detail {

  /// Signed distances (times edge length) of the corners of f from the lines of g.
  inline void line_distances(const Triangle2 &f, const Triangle2 &g, double s[3][3])
  {
    for (int j = 0; j < 3; j++) {
      const int jn = (j + 1) % 3;
      const double ex = g.x[jn] - g.x[j], ey = g.y[jn] - g.y[j];
      const double off = ex * g.y[j] - ey * g.x[j];
      for (int k = 0; k < 3; k++) s[j][k] = ex * f.y[k] - ey * f.x[k] - off;
    }
  }

  /// Pieces of the edges of f inside the three half-planes with signed distances s.
  inline void edges_inside(const Triangle2 &f, const double s[3][3], Boundary2 &out)
  {
    for (int k = 0; k < 3; k++) {
      const int kn = (k + 1) % 3;
      double lo = 0.0, hi = 1.0;
      for (int j = 0; j < 3; j++) {
        const double sa = s[j][k], sb = s[j][kn];
        const double t = sa / (sa - sb);
        if (sb > sa) {
          if (sa < 0.0) lo = std::max(lo, sb > 0.0 ? t : 2.0);
        } else {
          if (sb < 0.0) hi = std::min(hi, sa > 0.0 ? t : -1.0);
        }
      }
      if (lo < hi) {
        const double dx = f.x[kn] - f.x[k], dy = f.y[kn] - f.y[k];
        out.add(lo > 0.0 ? f.x[k] + lo * dx : f.x[k], lo > 0.0 ? f.y[k] + lo * dy : f.y[k],
                hi < 1.0 ? f.x[k] + hi * dx : f.x[kn], hi < 1.0 ? f.y[k] + hi * dy : f.y[kn]);
      }
    }
  }

}    // namespace detail

/// Boundary of the common part of two counter-clockwise triangles of positive area.
/// \return false if they do not overlap (one of the six edge lines separates them)
inline bool triangle_overlap(const Triangle2 &f, const Triangle2 &g, Boundary2 &out)
{
  double sf[3][3], sg[3][3];
  out.n = 0;
  detail::line_distances(f, g, sf);
  for (int j = 0; j < 3; j++)
    if (!(std::max(std::max(sf[j][0], sf[j][1]), sf[j][2]) > 0.0)) return false;
  detail::line_distances(g, f, sg);
  double size = 0.0;
  for (int j = 0; j < 3; j++) {
    const double m = std::max(std::max(sg[j][0], sg[j][1]), sg[j][2]);
    if (!(m > 0.0)) return false;
    size = std::max(size, m);
  }

  // a corner of one triangle on a line of the other (mirror images, shared edges): the two sides
  // may disagree on who is inside, and a boundary part be counted twice or not at all
  double nearest = size;
  for (int j = 0; j < 3; j++)
    for (int k = 0; k < 3; k++)
      nearest = std::min(nearest, std::min(std::fabs(sf[j][k]), std::fabs(sg[j][k])));
  if (nearest > 1e-7 * size) {
    detail::edges_inside(f, sf, out);
    detail::edges_inside(g, sg, out);
    return out.n >= 3;
  }

  Polygon2 poly;
  clip_triangles(f, g, poly);
  for (int k = 0; k < poly.n; k++) {
    const int kn = k + 1 < poly.n ? k + 1 : 0;
    out.add(poly.x[k], poly.y[k], poly.x[kn], poly.y[kn]);
  }
  return out.n >= 3;
}

}    // namespace dcm

#endif
