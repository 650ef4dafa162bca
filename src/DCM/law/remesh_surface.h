// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Operations of remeshing on a closed surface: flip of an edge, slide of a node, a node taken out,
// a node put in. Each carries what belongs to the edges it replaces and is refused where the
// surface would move or turn too far; which of them are done is decided in remesh.h. Lengths um.

#ifndef DCM_REMESH_SURFACE_H
#define DCM_REMESH_SURFACE_H

#include "envelope.h"
#include "hinge.h"
#include "mesh.h"
#include "triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

namespace dcm {

struct RemeshSettings {
  double quality = 0.4;     ///< a cell with a face worse than this is remeshed
  double goal = 0.55;       ///< until its worst face is as good as this, if that can be
  double longest = 3.0;     ///< as is one with an edge longer than this many edges of the mean face
  double distance = 0.1;    ///< the surface moves by no more, in mean edges
  double angle = PI / 4;    ///< nor does it turn by more, rad
  bool load = false;        ///< the springs carry the load they carried, instead of their strains
  double energy = 0.25;     ///< nor does the energy of the springs change by more, in parts of it
};

/// A cell as the law takes it and gives it back. l0 and theta0 belong to edges(mesh).
struct RemeshCell {
  Mesh mesh;
  std::vector<double> l0, theta0;
  std::vector<int> region;        ///< per face; what comes of a face has its region
  std::vector<int> face_class;    ///< per face; nothing is done across a border of classes
  std::vector<char> pinned;       ///< per node; it stays where it is, and none is put next to it
  std::vector<Vec3> v;            ///< per node; new ones lie between two and get their mean
};

namespace remesh_detail {

  constexpr int MOST = 16, DEGREE = 9;     // edges of a node: stored, made
  constexpr double CONVEX = 0.02;          // a new edge crosses the old one this far from its ends
  constexpr double SIZES = 0.1;            // weight of unlike areas beside bad shapes
  constexpr double GAIN = 0.01;            // least decrease of the cost, so that it comes to an end
  constexpr int SWEEPS = 30, SHORT = 3;    // of flips and slides: at most, in a trial

  using Face = std::array<int, 3>;
  using Sides = std::array<double, 3>;

  struct Star {
    int n = 0;
    std::array<int, MOST> face;

    void add(int f) { face[n++] = f; }
    void drop(int f) { n = int(std::remove(face.begin(), face.begin() + n, f) - face.begin()); }
  };

  /// Length from corner c of a triangle to the point at t of the side from a to b (Stewart).
  inline double to_side(double ca, double cb, double ab, double t)
  {
    return std::sqrt((1.0 - t) * ca * ca + t * cb * cb - t * (1.0 - t) * ab * ab);
  }

  /// The other diagonal of two triangles on ab, laid flat: where it crosses ab, and how long it is.
  struct Diagonal {
    double t, length;
  };

  inline Diagonal diagonal(double ab, double ca, double cb, double da, double db)
  {
    auto foot = [ab](double a, double b) {
      return 0.5 * (ab * ab + a * a - b * b) / ab;
    };
    const double xc = foot(ca, cb), xd = foot(da, db);
    const double yc = std::sqrt(std::max(0.0, ca * ca - xc * xc));
    const double yd = std::sqrt(std::max(0.0, da * da - xd * xd));
    if (!(yc + yd > 0.0)) return {-1.0, 0.0};
    return {(xc + (xd - xc) * yc / (yc + yd)) / ab, std::hypot(xc - xd, yc + yd)};
  }

  inline double wrapped(double angle)
  {
    return std::remainder(angle, 2.0 * PI);
  }

  /// The surface while it is worked on. Each edge has its values in both its faces.
  class Surface {
   public:
    std::vector<Vec3> x, v;
    std::vector<Face> f;
    std::vector<Sides> l0, bent;    // of the side from corner k to k + 1; bent: theta - theta0
    std::vector<int> hint;          // a face of the surface as it was that is near
    std::vector<double> cost;
    std::vector<int> region, face_class;
    std::vector<Star> star;
    std::vector<char> pinned, moved, changed;
    double mean_area = 0.0, most_off = 0.0, least_cosine = 0.0, goal = 1.0;
    std::shared_ptr<const Envelope> was;
    int flips = 0, slides = 0;
    int node = -1;    // one that is out, with its two faces
    std::array<int, 2> faces = {-1, -1};

    /// False if a node has more edges than can be stored.
    bool begin(const RemeshCell &cell, const RemeshSettings &set, double part);

    double total() const
    {
      double sum = 0.0;
      for (const double c : cost) sum += c;
      return sum;
    }
    double quality(const Face &t) const { return face_quality(x[t[0]], x[t[1]], x[t[2]]); }
    double length(int a, int b) const { return (x[b] - x[a]).norm(); }
    Vec3 twice_area(const Face &t) const { return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]); }
    Vec3 normal_of(int n) const
    {
      Vec3 sum = Vec3::Zero();
      for (int k = 0; k < star[n].n; k++) sum += twice_area(f[star[n].face[k]]);
      return sum.normalized();
    }

    double flip_gain(int face, int k) const;    // decrease of the cost, 0: not allowed
    void flip(int face, int k);
    bool take_out(int n);
    bool put_in(int a, int b);    // the node that is out, on this edge
    bool slide(int n);
    void smooth(std::vector<int> where, int sweeps);

    int find(int a, int b) const    // the face that runs from a to b
    {
      for (int k = 0; k < star[a].n; k++) {
        const Face &t = f[star[a].face[k]];
        if (t[(corner(t, a) + 1) % 3] == b) return star[a].face[k];
      }
      return -1;
    }
    static int corner(const Face &t, int n) { return t[0] == n ? 0 : t[1] == n ? 1 : 2; }

   private:
    struct Two {    // faces (a, b, c) and (b, a, d)
      int f1, f2, k1, k2, a, b, c, d;
    };

    double cost_of(const Face &t) const
    {
      const double q = std::max(1.0e-6, quality(t));
      const double size = std::log(std::max(1.0e-9, 0.5 * twice_area(t).norm() / mean_area));
      return (1.0 / q - 1.0) * (1.0 / q - 1.0) + SIZES * size * size;
    }
    bool joined(int a, int b) const { return find(a, b) >= 0 || find(b, a) >= 0; }
    bool turned(const Vec3 &n, const Vec3 &m) const    // too far
    {
      return !(n.dot(m) >= least_cosine * n.norm() * m.norm()) || n.norm() == 0.0;
    }
    Two two(int face, int k) const
    {
      Two it = {};
      it.f1 = face;
      it.k1 = k;
      it.a = f[face][k];
      it.b = f[face][(k + 1) % 3];
      it.c = f[face][(k + 2) % 3];
      it.f2 = find(it.b, it.a);
      it.k2 = corner(f[it.f2], it.b);
      it.d = f[it.f2][(it.k2 + 2) % 3];
      return it;
    }
    bool off(const Vec3 &p, int near) const    // too far from the surface as it was
    {
      return std::fabs(was->nearest(p, near).distance) > most_off;
    }
    bool off(const Face &t, int near) const    // of a new face: its middle and those of its sides
    {
      const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
      return off((a + b + c) / 3.0, near) || off(0.5 * (a + b), near) || off(0.5 * (b + c), near) ||
             off(0.5 * (c + a), near);
    }
    double apart(const Vec3 &p, const std::vector<Face> &there) const
    {
      double least = std::numeric_limits<double>::infinity();
      for (const Face &t : there)
        least = std::min(least, (p - nearest_on_triangle(p, x[t[0]], x[t[1]], x[t[2]])).norm());
      return least;
    }
    Diagonal flat(const Two &it) const
    {
      return diagonal(length(it.a, it.b), length(it.c, it.a), length(it.c, it.b),
                      length(it.d, it.a), length(it.d, it.b));
    }
    double rest_of(const Two &it, double t) const
    {
      const Sides &r1 = l0[it.f1], &r2 = l0[it.f2];
      const double ab = r1[it.k1];
      return to_side(r1[(it.k1 + 2) % 3], r1[(it.k1 + 1) % 3], ab, t) +
             to_side(r2[(it.k2 + 1) % 3], r2[(it.k2 + 2) % 3], ab, t);
    }
    void set_face(int face, const Face &t, const Sides &rest, const Sides &bend)
    {
      f[face] = t;
      l0[face] = rest;
      bent[face] = bend;
      changed[face] = 1;
      cost[face] = cost_of(t);
      hint[face] = was->nearest((x[t[0]] + x[t[1]] + x[t[2]]) / 3.0, hint[face]).face;
    }
    bool slide_to(int n, const Vec3 &target, double least_gain);
    void add_bend(int a, int b, double more)    // on both sides
    {
      for (const auto &e : {std::array<int, 2>{a, b}, std::array<int, 2>{b, a}}) {
        const int face = find(e[0], e[1]);
        if (face >= 0) bent[face][corner(f[face], e[0])] += more;
      }
    }
  };

  inline bool Surface::begin(const RemeshCell &cell, const RemeshSettings &set, double part)
  {
    x = cell.mesh.nodes;
    v = cell.v;
    f = cell.mesh.faces;
    region = cell.region;
    face_class = cell.face_class;
    pinned = cell.pinned;
    moved.assign(x.size(), 0);
    changed.assign(f.size(), 0);
    hint.resize(f.size());
    std::iota(hint.begin(), hint.end(), 0);
    l0.resize(f.size());
    bent.resize(f.size());
    cost.resize(f.size());
    star.resize(x.size());
    for (int n = 0; n < int(f.size()); n++)
      for (const int node : f[n]) {
        if (star[node].n == MOST) return false;
        star[node].add(n);
      }
    const auto list = hinges(cell.mesh);
    double sum = 0.0;
    for (size_t e = 0; e < list.size(); e++) {
      const auto &h = list[e];
      const double bend = wrapped(hinge_angle(x[h[0]], x[h[1]], x[h[2]], x[h[3]]) - cell.theta0[e]);
      sum += length(h[1], h[2]);
      for (const auto &side : {std::array<int, 2>{h[1], h[2]}, std::array<int, 2>{h[2], h[1]}}) {
        const int face = find(side[0], side[1]), k = corner(f[face], side[0]);
        l0[face][k] = cell.l0[e];
        bent[face][k] = bend;
      }
    }
    mean_area = area(cell.mesh) / double(f.size());
    most_off = part * set.distance * sum / double(list.size());
    was = std::make_shared<const Envelope>(cell.mesh);
    least_cosine = std::cos(set.angle);
    goal = set.goal;
    for (size_t n = 0; n < f.size(); n++) cost[n] = cost_of(f[n]);
    return true;
  }

  inline double Surface::flip_gain(int face, int k) const
  {
    const Two it = two(face, k);
    if (face_class[it.f1] != face_class[it.f2]) return 0.0;
    if (star[it.a].n < 5 || star[it.b].n < 5) return 0.0;
    if (star[it.c].n >= DEGREE || star[it.d].n >= DEGREE || joined(it.c, it.d)) return 0.0;
    const Face t1 = {it.a, it.d, it.c}, t2 = {it.d, it.b, it.c};
    const double gain = cost[it.f1] + cost[it.f2] - cost_of(t1) - cost_of(t2);
    if (!(gain > GAIN)) return 0.0;
    const double worse = std::min(quality(f[it.f1]), quality(f[it.f2]));
    if (worse >= goal || std::min(quality(t1), quality(t2)) < worse) return 0.0;
    const Diagonal flat_one = flat(it);
    if (!(flat_one.t > CONVEX && flat_one.t < 1.0 - CONVEX)) return 0.0;
    if (!(rest_of(it, flat_one.t) > 0.0)) return 0.0;
    const Vec3 old = twice_area(f[it.f1]) + twice_area(f[it.f2]);
    if (turned(twice_area(t1), old) || turned(twice_area(t2), old)) return 0.0;
    return off(t1, hint[it.f1]) || off(t2, hint[it.f2]) ? 0.0 : gain;
  }

  inline void Surface::flip(int face, int k)
  {
    const Two it = two(face, k);
    const Diagonal one = flat(it);
    const double l = length(it.c, it.d);
    const double rest = l * rest_of(it, one.t) / one.length;
    const double bend = bent[it.f1][it.k1] * length(it.a, it.b) / l;
    const int bc = (it.k1 + 1) % 3, ca = (it.k1 + 2) % 3, ad = (it.k2 + 1) % 3,
              db = (it.k2 + 2) % 3;
    const Sides r1 = l0[it.f1], r2 = l0[it.f2], b1 = bent[it.f1], b2 = bent[it.f2];
    set_face(it.f1, {it.a, it.d, it.c}, {r2[ad], rest, r1[ca]}, {b2[ad], bend, b1[ca]});
    set_face(it.f2, {it.d, it.b, it.c}, {r2[db], r1[bc], rest}, {b2[db], b1[bc], bend});
    star[it.b].drop(it.f1);
    star[it.d].add(it.f1);
    star[it.a].drop(it.f2);
    star[it.c].add(it.f2);
  }

  /// The faces around the node become fewer by two: its edges are flipped one after the other, best
  /// new face first, until three are left, and with the last face there is nothing at it.
  inline bool Surface::take_out(int n)
  {
    const int k = star[n].n;
    if (pinned[n] || k > DEGREE) return false;
    std::vector<int> w, around;
    int at = star[n].face[0];
    Vec3 normal = Vec3::Zero();
    for (int i = 0; i < k; i++) {
      const int c = corner(f[at], n);
      if (face_class[at] != face_class[star[n].face[0]]) return false;
      around.push_back(at);
      w.push_back(f[at][(c + 1) % 3]);
      normal += twice_area(f[at]);
      at = find(n, f[at][(c + 2) % 3]);
    }
    const std::vector<int> ring = w;
    std::vector<Face> old;
    for (const int face : around) old.push_back(f[face]);

    // spokes to w[i], sides from w[i] to w[i + 1]

    std::vector<double> spoke, spoke_bend, side, side_bend;
    for (const int face : around) {
      const int c = corner(f[face], n);
      spoke.push_back(l0[face][c]);
      spoke_bend.push_back(bent[face][c]);
      side.push_back(l0[face][(c + 1) % 3]);
      side_bend.push_back(bent[face][(c + 1) % 3]);
    }
    struct New {
      Face t;
      Sides rest, bend;
    };
    std::vector<New> made;
    std::vector<std::array<int, 2>> across;
    std::vector<int> degree;
    for (const int node : ring) degree.push_back(star[node].n - 1);
    auto degree_of = [&](int node) -> int & {
      return degree[std::find(ring.begin(), ring.end(), node) - ring.begin()];
    };
    while (w.size() > 3) {
      const int m = int(w.size());
      int best = -1;
      double best_quality = 0.0, best_rest = 0.0;
      for (int i = 0; i < m; i++) {
        const int h = (i + m - 1) % m, j = (i + 1) % m;
        const Face ear = {w[h], w[i], w[j]};
        const double q = quality(ear);
        if (q <= best_quality || degree_of(w[i]) < 4 || joined(w[h], w[j])) continue;
        if (std::find(across.begin(), across.end(), std::array<int, 2>{w[j], w[h]}) != across.end())
          continue;
        if (turned(twice_area(ear), normal)) continue;
        const Diagonal one = diagonal(length(n, w[i]), length(w[j], n), length(w[j], w[i]),
                                      length(w[h], n), length(w[h], w[i]));
        if (!(one.t > CONVEX && one.t < 1.0 - CONVEX)) continue;
        const double rest = to_side(spoke[j], side[i], spoke[i], one.t) +
                            to_side(spoke[h], side[h], spoke[i], one.t);
        if (!(rest > 0.0)) continue;
        best = i;
        best_quality = q;
        best_rest = length(w[h], w[j]) * rest / one.length;
      }
      if (best < 0) return false;
      const int i = best, h = (i + m - 1) % m, j = (i + 1) % m;
      const double bend = spoke_bend[i] * length(n, w[i]) / length(w[h], w[j]);
      made.push_back(
          {{w[h], w[i], w[j]}, {side[h], side[i], best_rest}, {side_bend[h], side_bend[i], bend}});
      across.push_back({w[h], w[j]});
      degree_of(w[h])++;
      degree_of(w[j])++;
      side[h] = best_rest;
      side_bend[h] = bend;
      for (auto *const list : {&spoke, &spoke_bend, &side, &side_bend})
        list->erase(list->begin() + i);
      w.erase(w.begin() + i);
    }
    made.push_back({{w[0], w[1], w[2]},
                    {side[0], side[1], side[2]},
                    {side_bend[0], side_bend[1], side_bend[2]}});
    if (turned(twice_area(made.back().t), normal)) return false;
    for (size_t i = 0; i < ring.size(); i++)
      if (degree[i] < 4 || degree[i] > std::max(DEGREE, star[ring[i]].n)) return false;
    std::vector<Face> there;
    for (const New &it : made) there.push_back(it.t);
    if (apart(x[n], there) > most_off) return false;
    for (const Face &t : there)
      if (off(t, hint[around[0]])) return false;

    // what the last three spokes were bent beyond rest is shared out to the sides, by length

    double sum = 0.0, lengths = 0.0;
    for (int i = 0; i < 3; i++) {
      sum += spoke_bend[i] * length(n, w[i]);
      lengths += length(w[i], w[(i + 1) % 3]);
    }
    std::vector<int> regions;
    for (const Face &t : there) {
      const Vec3 mid = (x[t[0]] + x[t[1]] + x[t[2]]) / 3.0;
      int nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (int i = 0; i < k; i++) {
        const double d = apart(mid, {old[i]});
        if (d < least) {
          least = d;
          nearest = i;
        }
      }
      regions.push_back(region[around[nearest]]);
    }
    for (size_t i = 0; i < ring.size(); i++) {
      star[ring[i]].drop(around[i]);
      star[ring[i]].drop(around[(i + ring.size() - 1) % ring.size()]);
    }
    for (size_t i = 0; i < made.size(); i++) {
      const int face = around[i];
      set_face(face, made[i].t, made[i].rest, made[i].bend);
      region[face] = regions[i];
      for (const int node : made[i].t) star[node].add(face);
    }
    for (int i = 0; i < 3; i++) add_bend(w[i], w[(i + 1) % 3], sum / lengths);
    node = n;
    faces = {around[k - 2], around[k - 1]};
    star[n].n = 0;
    for (const int face : faces) cost[face] = 0.0;
    return true;
  }

  /// On the surface through the ends of the edge that has their normals (a cubic), no farther from
  /// the faces than allowed.
  inline bool Surface::put_in(int a, int b)
  {
    const int face = find(a, b);
    if (face < 0) return false;
    const Two it = two(face, corner(f[face], a));
    const int kind = face_class[faces[0]];
    if (pinned[a] || pinned[b] || face_class[it.f1] != kind || face_class[it.f2] != kind)
      return false;
    if (star[it.c].n >= DEGREE || star[it.d].n >= DEGREE) return false;
    const Vec3 along = x[b] - x[a], na = normal_of(a), nb = normal_of(b);
    Vec3 out = (along.dot(nb) * nb - along.dot(na) * na) / 8.0;
    const Vec3 middle = 0.5 * (x[a] + x[b]);
    for (int k = 0; off(middle + out, hint[face]); k++) {
      if (k == 3) return false;
      out *= 0.5;
    }
    const double l = along.norm();
    const Sides r1 = l0[it.f1], r2 = l0[it.f2], b1 = bent[it.f1], b2 = bent[it.f2];
    const int bc = (it.k1 + 1) % 3, ca = (it.k1 + 2) % 3, ad = (it.k2 + 1) % 3,
              db = (it.k2 + 2) % 3;
    const double rest_c = to_side(r1[ca], r1[bc], r1[it.k1], 0.5);
    const double rest_d = to_side(r2[ad], r2[db], r2[it.k2], 0.5);
    const double flat_c = to_side(length(it.c, a), length(it.c, b), l, 0.5);
    const double flat_d = to_side(length(it.d, a), length(it.d, b), l, 0.5);
    if (!(rest_c > 0.0 && rest_d > 0.0 && flat_c > 0.0 && flat_d > 0.0)) return false;

    const int m = node;
    const Vec3 before = x[m], n1 = twice_area(f[it.f1]), n2 = twice_area(f[it.f2]);
    x[m] = middle + out;
    const Face t1 = {a, m, it.c}, t2 = {m, b, it.c}, t3 = {m, a, it.d}, t4 = {b, m, it.d};
    if (turned(twice_area(t1), n1) || turned(twice_area(t2), n1) || turned(twice_area(t3), n2) ||
        turned(twice_area(t4), n2) || off(t1, hint[it.f1]) || off(t2, hint[it.f1]) ||
        off(t3, hint[it.f2]) || off(t4, hint[it.f2])) {
      x[m] = before;
      return false;
    }
    v[m] = 0.5 * (v[a] + v[b]);
    const double ma = length(m, a), mb = length(m, b), strain = r1[it.k1] / l;
    const double ra = ma * strain, rb = mb * strain, rc = length(m, it.c) * rest_c / flat_c,
                 rd = length(m, it.d) * rest_d / flat_d;
    const double bend = b1[it.k1] * l / (ma + mb);
    hint[faces[0]] = hint[it.f1];
    hint[faces[1]] = hint[it.f2];
    set_face(it.f1, t1, {ra, rc, r1[ca]}, {bend, 0.0, b1[ca]});
    set_face(faces[0], t2, {rb, r1[bc], rc}, {bend, b1[bc], 0.0});
    set_face(it.f2, t3, {ra, r2[ad], rd}, {bend, b2[ad], 0.0});
    set_face(faces[1], t4, {rb, rd, r2[db]}, {bend, 0.0, b2[db]});
    region[faces[0]] = region[it.f1];
    region[faces[1]] = region[it.f2];
    star[b].drop(it.f1);
    star[b].add(faces[0]);
    star[b].drop(it.f2);
    star[b].add(faces[1]);
    star[it.c].add(faces[0]);
    star[it.d].add(faces[1]);
    star[m].n = 0;
    for (const int g : {it.f1, faces[0], it.f2, faces[1]}) star[m].add(g);
    moved[m] = 1;
    node = -1;
    return true;
  }

  /// A node slides along the surface: in the plane in which the volume stays. The star is laid flat
  /// around it; each new edge is straight there and takes its rest length from the faces it
  /// crosses.
  inline bool Surface::slide_to(int n, const Vec3 &target, double least_gain)
  {
    const int k = star[n].n;
    std::vector<int> around, w;
    int at = star[n].face[0];
    Vec3 normal = Vec3::Zero();
    double before = 0.0, worst = 1.0;
    for (int i = 0; i < k; i++) {
      if (face_class[at] != face_class[star[n].face[0]]) return false;
      around.push_back(at);
      w.push_back(f[at][(corner(f[at], n) + 1) % 3]);
      normal += twice_area(f[at]);
      worst = std::min(worst, quality(f[at]));
      before += cost[at];
      at = find(n, f[at][(corner(f[at], n) + 2) % 3]);
    }
    if (worst >= goal) return false;    // what is good stays as it is
    const Vec3 from = x[n], to = from + (target - from) -
                                 normal.dot(target - from) / normal.squaredNorm() * normal;

    // the new faces

    x[n] = to;
    double after = 0.0;
    bool good = true;
    for (const int face : around) {
      const Vec3 now = twice_area(f[face]);
      x[n] = from;
      good = good && !turned(now, twice_area(f[face]));
      x[n] = to;
      after += cost_of(f[face]);
    }
    good = good && before - after > least_gain;
    for (int i = 0; i < k && good; i++) good = !off(f[around[i]], hint[around[i]]);
    good = good && !off(to, hint[around[0]]);
    std::vector<Face> there;
    for (const int face : around) there.push_back(f[face]);
    good = good && apart(from, there) <= most_off;
    x[n] = from;
    if (!good) return false;

    // the face it comes to lie in: to = from + u A + v B in the sight along the normal

    int j = -1;
    double u = 0.0, t0 = 0.0;
    for (int i = 0; i < k && j < 0; i++) {
      const Vec3 A = x[w[i]] - from, B = x[w[(i + 1) % k]] - from, d = to - from;
      const double det = A.cross(B).dot(normal);
      if (!(det > 0.0)) return false;
      u = d.cross(B).dot(normal) / det;
      t0 = A.cross(d).dot(normal) / det;
      if (u >= 0.0 && t0 >= 0.0 && u + t0 <= 1.0) j = i;
    }
    if (j < 0) return false;

    // faces as they lie flat: lengths of spokes, angles between them, products at rest

    std::vector<double> l(k), angle(k), rest(k), product(k);
    for (int i = 0; i < k; i++) {
      const int c = corner(f[around[i]], n);
      l[i] = length(n, w[i]);
      rest[i] = l0[around[i]][c];
    }
    double whole = 0.0;
    for (int i = 0; i < k; i++) {
      const int h = (i + 1) % k;
      const double side = length(w[i], w[h]);
      const double side0 = l0[around[i]][(corner(f[around[i]], n) + 1) % 3];
      angle[i] = std::acos(
          std::clamp((l[i] * l[i] + l[h] * l[h] - side * side) / (2.0 * l[i] * l[h]), -1.0, 1.0));
      product[i] = 0.5 * (rest[i] * rest[i] + rest[h] * rest[h] - side0 * side0);
      whole += angle[i];
    }
    auto at_rest = [&](int i, double p, double q) {    // of p A + q B in face i
      const double a = rest[i], b = rest[(i + 1) % k];
      return std::sqrt(p * p * a * a + q * q * b * b + 2.0 * p * q * product[i]);
    };
    const double px = u * l[j] + t0 * l[(j + 1) % k] * std::cos(angle[j]),
                 py = t0 * l[(j + 1) % k] * std::sin(angle[j]);
    const double turn = std::atan2(py, px);    // from spoke j
    std::vector<double> fresh(k), place(k, 0.0);
    for (int i = 1; i < k; i++)
      place[(j + i) % k] = place[(j + i - 1) % k] + angle[(j + i - 1) % k];
    for (int i = 0; i < k; i++) {
      // counter-clockwise over spokes j + 1 .. i, or clockwise over j .. i
      const double left = i == j ? whole - turn : place[i] - turn;
      const bool ccw = left <= whole - left;
      const double bend_by = ccw ? left : whole - left;
      if (!(bend_by < PI)) return false;
      const double r = std::hypot(px, py);
      const double wx = l[i] * std::cos(bend_by), wy = l[i] * std::sin(bend_by);
      const double flat_length = std::hypot(wx - r, wy);
      double sum = 0.0, p = u, q = t0, way = ccw ? angle[j] - turn : turn;
      int face = j;
      while (true) {
        const int m = ccw ? (face + 1) % k : face;    // the spoke on that side
        if (m == i) {
          sum += ccw ? at_rest(face, -p, 1.0 - q) : at_rest(face, 1.0 - p, -q);
          break;
        }
        // the line from (r, 0) to w meets the spoke in direction `way`
        const double s = std::sin(way), c = std::cos(way);
        const double cut = r * wy / (wy * c - (wx - r) * s);
        const double t = cut / l[m];
        if (!(t >= 0.0 && t <= 1.0)) return false;
        sum += ccw ? at_rest(face, -p, t - q) : at_rest(face, t - p, -q);
        face = ccw ? (face + 1) % k : (face + k - 1) % k;
        p = ccw ? t : 0.0;
        q = ccw ? 0.0 : t;
        way += angle[face];
      }
      if (!(sum > 0.0) || !(flat_length > 0.0)) return false;
      fresh[i] = (x[w[i]] - to).norm() * sum / flat_length;
    }

    x[n] = to;
    moved[n] = 1;
    for (int i = 0; i < k; i++) {
      const double ratio = l[i] / length(n, w[i]);
      const int face = around[i], last = around[(i + k - 1) % k];
      const int c = corner(f[face], n), d = (corner(f[last], n) + 2) % 3;
      l0[face][c] = l0[last][d] = fresh[i];
      bent[face][c] *= ratio;
      bent[last][d] *= ratio;
    }
    for (const int face : around) cost[face] = cost_of(f[face]);
    return true;
  }

  /// To the middle of its ring, or to that of its faces weighted by area, or part of the way.
  inline bool Surface::slide(int n)
  {
    if (pinned[n] || star[n].n == 0) return false;
    Vec3 ring = Vec3::Zero(), heavy = Vec3::Zero();
    double weight = 0.0;
    for (int i = 0; i < star[n].n; i++) {
      const Face &t = f[star[n].face[i]];
      const double a = twice_area(t).norm();
      ring += x[t[(corner(t, n) + 1) % 3]] / double(star[n].n);
      heavy += a * (x[t[0]] + x[t[1]] + x[t[2]]) / 3.0;
      weight += a;
    }
    heavy /= weight;
    for (const double part : {1.0, 0.5, 0.25})
      for (const Vec3 &to : {ring, heavy})
        if (slide_to(n, x[n] + part * (to - x[n]), GAIN)) return true;
    return false;
  }

  /// Flips, those that gain most first, and slides, among these faces and their neighbors.
  inline void Surface::smooth(std::vector<int> where, int sweeps)
  {
    struct Flip {
      double gain;
      int a, b;
    };
    for (int sweep = 0; sweep < sweeps && !where.empty(); sweep++) {
      std::vector<std::array<int, 2>> sides;    // each edge once, from its lower node
      for (const int face : where)
        for (int k = 0; k < 3; k++)
          sides.push_back({std::min(f[face][k], f[face][(k + 1) % 3]),
                           std::max(f[face][k], f[face][(k + 1) % 3])});
      std::sort(sides.begin(), sides.end());
      sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
      std::vector<Flip> list;
      for (const auto &it : sides) {
        const int face = find(it[0], it[1]);
        const double gain = flip_gain(face, corner(f[face], it[0]));
        if (gain > 0.0) list.push_back({gain, it[0], it[1]});
      }
      std::sort(list.begin(), list.end(), [](const Flip &p, const Flip &q) {
        if (p.gain != q.gain) return p.gain > q.gain;
        return p.a != q.a ? p.a < q.a : p.b < q.b;
      });
      std::vector<int> next, nodes;
      auto with_neighbors = [&](int g) {
        next.push_back(g);
        for (int s = 0; s < 3; s++) next.push_back(find(f[g][(s + 1) % 3], f[g][s]));
      };
      for (const Flip &it : list) {
        const int face = find(it.a, it.b);
        if (face < 0) continue;
        const int k = corner(f[face], it.a), other = find(it.b, it.a);
        if (!(flip_gain(face, k) > 0.0)) continue;
        flip(face, k);
        flips++;
        with_neighbors(face);
        with_neighbors(other);
      }
      for (const int face : where) nodes.insert(nodes.end(), f[face].begin(), f[face].end());
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      for (const int n : nodes) {
        if (!slide(n)) continue;
        slides++;
        for (int i = 0; i < star[n].n; i++) with_neighbors(star[n].face[i]);
      }
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
      where.swap(next);
    }
  }

}    // namespace remesh_detail

}    // namespace dcm

#endif
