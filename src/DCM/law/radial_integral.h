// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Integral of a radial stress and of its first moments over a polygon, by the polygon's edges:
// with the primitives Q0 = int p s ds, Q1 = int p s^2 ds and t = angle around the axis
//
//   int p dA = sum over edges int Q0(r) dt,   int p x dA = sum over edges int Q1(r) (cos, sin) dt.
//
// Edges are split where they cross r = a and r = c. Beyond c and in the ring a < r <= c the edge
// integrals have closed forms, in the core r < a they do for law dmt. Law maugis needs Gauss points
// there: dt = cross(p0, p1)/r^2 ds with Q0/r^2 and Q1/r^3 regular, so an edge through the axis is
// nothing special. Edges shared by two polygons cancel to round-off whatever the number of points,
// as long as both sides split them alike; coincident meshes with noise (mirror images) do not, and
// show the Gauss error (1e-3 of the force at lambda = 1 with two points).

#ifndef DCM_RADIAL_INTEGRAL_H
#define DCM_RADIAL_INTEGRAL_H

#include "contact_law.h"
#include "overlap.h"

namespace dcm {

/// Integrals over a polygon: stress and uniform density 1 inside r <= c, with first moments.
struct RadialSums {
  static constexpr bool SLOPE = false;
  double force = 0.0, mx = 0.0, my = 0.0;    ///< int p dA, int p x dA, int p y dA
  double area = 0.0, ax = 0.0, ay = 0.0;     ///< int dA, int x dA, int y dA over r <= c
};

/// The same and d(force)/d delta at fixed polygon, for laws that have it (contact_law.h).
struct RadialSumsAndSlope : RadialSums {
  static constexpr bool SLOPE = true;
  RadialSlope law;       ///< to be set before
  double slope = 0.0;    ///< force/length
};

namespace detail {

  /// Gauss-Legendre nodes and weights on (0, 1), 1 to 4 points.
  inline void gauss_rule(int n, const double *&x, const double *&w)
  {
    static constexpr double node[4][4] = {
        {0.5, 0.0, 0.0, 0.0},
        {0.21132486540518711775, 0.78867513459481288225, 0.0, 0.0},
        {0.11270166537925831148, 0.5, 0.88729833462074168852, 0.0},
        {0.06943184420297371239, 0.33000947820757186760, 0.66999052179242813240,
         0.93056815579702628761}};
    static constexpr double weight[4][4] = {{1.0, 0.0, 0.0, 0.0},
                                            {0.5, 0.5, 0.0, 0.0},
                                            {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0, 0.0},
                                            {0.17392742256872692869, 0.32607257743127307131,
                                             0.32607257743127307131, 0.17392742256872692869}};
    const int i = n < 1 ? 0 : (n > 4 ? 3 : n - 1);
    x = node[i];
    w = weight[i];
  }

  /// The part lo..hi of [0, 1] where |p0 + s d|^2 < radius^2; false if none.
  inline bool inside_circle(double b, double len2, double cross2, double radius, double &lo,
                            double &hi)
  {
    const double disc = len2 * radius * radius - cross2;
    if (!(disc > 0.0)) return false;
    const double root = std::sqrt(disc), inv = 1.0 / len2;
    lo = std::max(0.0, (-b - root) * inv);
    hi = std::min(1.0, (-b + root) * inv);
    return lo < hi;
  }

  /// Sums over the pieces of one kind on one edge, for an integrand with constant Q0 and Q1: the
  /// pieces' angles add up to less than pi, so one complex product and one arc tangent serve them.
  struct Fan {
    double re = 1.0, im = 0.0, ux = 0.0, uy = 0.0;

    /// piece from p to q, cross = p x q
    void add(double px, double py, double qx, double qy, double cross)
    {
      const double dot = px * qx + py * qy;
      const double nre = re * dot - im * cross;
      im = re * cross + im * dot;
      re = nre;
      const double ip = 1.0 / std::sqrt(px * px + py * py);
      const double iq = 1.0 / std::sqrt(qx * qx + qy * qy);
      ux += qy * iq - py * ip;
      uy -= qx * iq - px * ip;
    }

    double turn() const { return angle(im, re); }
  };

}    // namespace detail

/// Add the integrals over the polygon with the given boundary; coordinates relative to the axis.
/// \param npoints Gauss points per piece of edge in the core, 1 to 4
template <class State, class Sums>
inline void radial_integral(const State &s, const Boundary2 &poly, int npoints, Sums &sum)
{
  const double *node, *weight;
  detail::gauss_rule(npoints, node, weight);
  npoints = npoints < 1 ? 1 : (npoints > 4 ? 4 : npoints);

  const double a2 = s.a * s.a, c2 = s.c * s.c;
  const double ring0 = s.Q0a + 0.5 * s.sigma0 * a2;
  const double ring1 = s.Q1a + s.sigma0 * a2 * s.a / 3.0;

  const auto outside = [&](const detail::Fan &fan) {
    const double turn = fan.turn();
    sum.force += s.Q0c * turn;
    sum.mx += s.Q1c * fan.ux;
    sum.my += s.Q1c * fan.uy;
    sum.area += 0.5 * c2 * turn;
    sum.ax += c2 * s.c / 3.0 * fan.ux;
    sum.ay += c2 * s.c / 3.0 * fan.uy;
    if constexpr (Sums::SLOPE) sum.slope += sum.law.out * turn;
  };
  const auto ring_edge = [&](const detail::Fan &fan) {
    const double turn = fan.turn();
    sum.force += ring0 * turn;
    sum.mx += ring1 * fan.ux;
    sum.my += ring1 * fan.uy;
    if constexpr (Sums::SLOPE) sum.slope += sum.law.ring * turn;
  };

  // first the circle r = c: many polygons lie beyond it, some enclose it
  double len2s[Boundary2::MAXSEG], crosses[Boundary2::MAXSEG], dots[Boundary2::MAXSEG];
  double los[Boundary2::MAXSEG], his[Boundary2::MAXSEG];
  bool met = false, enclosed = true;
  for (int e = 0; e < poly.n; e++) {
    const double x0 = poly.x0[e], y0 = poly.y0[e];
    const double dx = poly.x1[e] - x0, dy = poly.y1[e] - y0;
    const double len2 = dx * dx + dy * dy;
    const double cross = x0 * dy - y0 * dx, b = x0 * dx + y0 * dy;
    len2s[e] = len2;
    crosses[e] = cross;
    dots[e] = b;
    los[e] = his[e] = 0.0;
    if (detail::inside_circle(b, len2, cross * cross, s.c, los[e], his[e]))
      met = true;
    else
      his[e] = los[e] = 0.0;
    if (!(cross > 0.0)) enclosed = false;
  }
  if (!met) {
    if (enclosed && poly.n > 0) {
      sum.force += 2.0 * PI * s.Q0c;
      sum.area += PI * c2;
      if constexpr (Sums::SLOPE) sum.slope += 2.0 * PI * sum.law.out;
    }
    return;
  }

  for (int e = 0; e < poly.n; e++) {
    const double len2 = len2s[e], cross = crosses[e], b = dots[e], lo = los[e], hi = his[e];
    if (!(len2 > 0.0)) continue;
    const double x0 = poly.x0[e], y0 = poly.y0[e], x1 = poly.x1[e], y1 = poly.y1[e];
    const double dx = x1 - x0, dy = y1 - y0;
    if (!(lo < hi)) {
      detail::Fan out;
      out.add(x0, y0, x1, y1, cross);
      outside(out);
      continue;
    }

    // lx..hx: the piece within c
    const double lx = x0 + lo * dx, ly = y0 + lo * dy, hx = x0 + hi * dx, hy = y0 + hi * dy;
    if (lo > 0.0 || hi < 1.0) {
      detail::Fan out;
      if (lo > 0.0) out.add(x0, y0, lx, ly, cross * lo);
      if (hi < 1.0) out.add(hx, hy, x1, y1, cross * (1.0 - hi));
      outside(out);
    }
    const double within = cross * (hi - lo);
    sum.area += 0.5 * within;
    sum.ax += within * (lx + hx) / 6.0;
    sum.ay += within * (ly + hy) / 6.0;

    double la = 0.0, ha = 0.0;
    const bool core = a2 > 0.0 && detail::inside_circle(b, len2, cross * cross, s.a, la, ha);
    if (!core) {
      if (a2 > 0.0) {
        detail::Fan ring;
        ring.add(lx, ly, hx, hy, within);
        ring_edge(ring);
      }
      sum.force -= 0.5 * s.sigma0 * within;
      sum.mx -= s.sigma0 * within * (lx + hx) / 6.0;
      sum.my -= s.sigma0 * within * (ly + hy) / 6.0;
      continue;
    }
    if (la > lo || ha < hi) {
      detail::Fan ring;
      const double px = x0 + la * dx, py = y0 + la * dy, qx = x0 + ha * dx, qy = y0 + ha * dy;
      if (la > lo) {
        const double part = cross * (la - lo);
        ring.add(lx, ly, px, py, part);
        sum.force -= 0.5 * s.sigma0 * part;
        sum.mx -= s.sigma0 * part * (lx + px) / 6.0;
        sum.my -= s.sigma0 * part * (ly + py) / 6.0;
      }
      if (ha < hi) {
        const double part = cross * (hi - ha);
        ring.add(qx, qy, hx, hy, part);
        sum.force -= 0.5 * s.sigma0 * part;
        sum.mx -= s.sigma0 * part * (hx + qx) / 6.0;
        sum.my -= s.sigma0 * part * (hy + qy) / 6.0;
      }
      ring_edge(ring);
    }

    if constexpr (State::EXACT_CORE) {
      const double len = std::sqrt(len2), inv = 1.0 / len;
      const double tx = dx * inv, ty = dy * inv, h = cross * inv, t = b * inv;
      double f, normal, along;
      if constexpr (Sums::SLOPE) {
        double slope;
        s.template core_edge<true>(h, t + la * len, t + ha * len, f, normal, along, &slope);
        sum.slope += sum.law.core * slope;
      } else {
        s.core_edge(h, t + la * len, t + ha * len, f, normal, along);
      }
      sum.force += f;
      sum.mx += normal * ty + along * tx;
      sum.my += along * ty - normal * tx;
      continue;
    }
    const double span = ha - la;
    for (int i = 0; i < npoints; i++) {
      const double t = la + span * node[i];
      const double x = x0 + t * dx, y = y0 + t * dy;
      const double rr = std::min(x * x + y * y, a2);
      double q0, q1;
      s.core(rr, q0, q1);
      const double w = weight[i] * span * cross;
      sum.force += w * q0;
      sum.mx += w * q1 * x;
      sum.my += w * q1 * y;
    }
  }
}

}    // namespace dcm

#endif
