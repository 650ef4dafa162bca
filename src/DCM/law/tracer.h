// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Brownian tracers among moving closed surfaces whose apical faces let them out and never in
// (S1 "Osmotic effects"), without leaks. Lengths um, times s.
//
// A tracer has a position and a home, the cell it is in, or OUTSIDE. The home is bookkeeping: it
// changes in one place only, where a path from inside meets an open face and the point beyond it
// lies outside all cells. Positions are made to agree with it:
//   settle()  after the surfaces have moved: what a face has swept over goes back to its side
//   walk()    with surfaces at rest: straight pieces, reflected; an end that cannot be verified is
//             not taken
// Everything is decided by the faces within `near` of a point, ties by the IDs of faces: results
// depend neither on the order of faces nor on the voxels that list them.

#ifndef DCM_TRACER_H
#define DCM_TRACER_H

#include "triangle.h"
#include "vector.h"
#include "voxels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace dcm {

/// A face, as tracers see it.
struct TracerFace {
  Vec3 corner[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  Vec3 mid = Vec3::Zero();
  Vec3 normal = Vec3::Zero();    ///< unit, outward; zero for a degenerate face
  double reach = 0.0;            ///< farthest corner from mid
  std::int64_t tag = 0, cell = 0;
  bool open = false;     ///< apical: lets tracers out
  bool shut = false;     ///< in contact with another cell: the slit before it is no place
  bool known = false;    ///< all corners are known

  /// mid, normal and reach from the corners.
  void measure()
  {
    const Vec3 &a = corner[0], &b = corner[1], &c = corner[2];
    const Vec3 twice = (b - a).cross(c - a);
    const double length = twice.norm();
    normal = length > 0.0 ? Vec3(twice / length) : Vec3(Vec3::Zero());
    mid = (a + b + c) / 3.0;
    reach = std::sqrt(
        std::max({(a - mid).squaredNorm(), (b - mid).squaredNorm(), (c - mid).squaredNorm()}));
  }
  Vec3 nearest(const Vec3 &x) const
  {
    return nearest_on_triangle(x, corner[0], corner[1], corner[2]);
  }
};

struct Tracer {
  static constexpr std::int64_t OUTSIDE = 0;
  static constexpr int WEIGHTS = 32768;    ///< sum of the three weights of a caught one

  Vec3 x = Vec3::Zero();
  std::int64_t home = OUTSIDE;    ///< cell it is in
  int host = -1;                  ///< >= 0: caught between surfaces that closed, rides on this face
  int weight[2] = {0, 0};         ///< caught: of the face's second and third corner
};

/// What has happened to tracers.
struct TracerCounts {
  std::int64_t steps = 0, bounces = 0;
  std::int64_t exits = 0;       ///< have left their cell
  std::int64_t swept = 0;       ///< a moving face has passed over them; put back
  std::int64_t caught = 0;      ///< a gap has closed on them
  std::int64_t released = 0;    ///< ... and opened again
  std::int64_t rejected = 0;    ///< the end of a path could not be verified: no move
  std::int64_t capped = 0;      ///< too many reflections: no move
  std::int64_t blocked = 0;     ///< at an open face with another cell right behind it: reflected
  std::int64_t shut_out = 0;    ///< the end lies in a slit that is shut: no move

  void add(const TracerCounts &other)
  {
    steps += other.steps;
    bounces += other.bounces;
    exits += other.exits;
    swept += other.swept;
    caught += other.caught;
    released += other.released;
    rejected += other.rejected;
    capped += other.capped;
    blocked += other.blocked;
    shut_out += other.shut_out;
  }
};

/// Moves tracers among faces. Faces: size() and [f], a TracerFace. One per process.
template <class Faces> class TracerWalk {
 public:
  /// Nearest face of one cell.
  struct Side {
    double d2 = std::numeric_limits<double>::infinity(), height = 0.0;
    int face = -1;    // -1: none within `near`
    Vec3 point = Vec3::Zero();
    bool inside() const { return height < 0.0; }
  };

  double near = 1.0;          ///< faces within this of a point decide; longest piece of a path
  double delta = 1.0e-7;      ///< distance kept from a face after meeting it
  int most_bounces = 32;      ///< in one piece
  double shut_range = 0.0;    ///< > 0: outside no place whose nearest face is shut and nearer
  // reflecting planes: for all tracers, and those that are outside have their own as well
  Vec3 wall_lo = Vec3::Constant(-ENDLESS), wall_hi = Vec3::Constant(ENDLESS);
  Vec3 outer_lo = Vec3::Constant(-ENDLESS), outer_hi = Vec3::Constant(ENDLESS);
  TracerCounts count;

  TracerWalk(Faces &_faces, Voxels &_voxels) : faces(_faces), voxels(_voxels) {}

  /// Nearest face of a cell. Of several equally near (at an edge or corner), the one seen most from
  /// the front or the back: its side is the side of the surface.
  Side side_of(const Vec3 &x, std::int64_t cell, const Voxels::List &list)
  {
    double least = near * near;
    ties.clear();
    for (const int f : list) {
      const TracerFace &face = faces[f];
      if (face.cell != cell) continue;
      const double height = (x - face.mid).dot(face.normal);
      if (height * height > least * WIDE) continue;
      const Vec3 point = face.nearest(x);
      const double d2 = (x - point).squaredNorm();
      if (d2 > least * (1.0 + TIE) + TINY) continue;
      if (d2 < least) {
        least = d2;
        std::size_t n = 0;
        for (const Side &it : ties)
          if (it.d2 <= least * (1.0 + TIE) + TINY) ties[n++] = it;
        ties.resize(n);
      }
      Side side;
      side.d2 = d2;
      side.height = height;
      side.face = f;
      side.point = point;
      ties.push_back(side);
    }
    Side best;
    for (const Side &it : ties) {
      if (best.face >= 0) {
        const double a = std::fabs(it.height), b = std::fabs(best.height);
        if (a < b || (a == b && faces[it.face].tag > faces[best.face].tag)) continue;
      }
      best = it;
    }
    return best;
  }

  /// May a tracer of this home be at x? Where no face of a cell is near, nobody can have changed
  /// sides. wrong: the face it is behind, of the cell it is in most deeply.
  bool right_place(const Vec3 &x, std::int64_t home, Side *wrong = nullptr)
  {
    const auto list = voxels.at(x);
    if (home != Tracer::OUTSIDE) {
      const Side side = side_of(x, home, list);
      const bool ok = side.face < 0 || side.inside();
      if (!ok && wrong) *wrong = side;
      return ok;
    }
    bool ok = true;
    seen.clear();
    for (const int f : list) {
      const std::int64_t cell = faces[f].cell;
      if (std::find(seen.begin(), seen.end(), cell) != seen.end()) continue;
      seen.push_back(cell);
      const Side side = side_of(x, cell, list);
      if (side.face < 0 || !side.inside()) continue;
      if (!wrong) return false;
      const bool deeper = ok || side.d2 > wrong->d2 ||
                          (side.d2 == wrong->d2 && faces[side.face].tag < faces[wrong->face].tag);
      if (deeper) *wrong = side;
      ok = false;
    }
    return ok;
  }

  /// Is the face nearest to x in front of it and within the range of the rule, a shut one? Faces
  /// that share the nearest edge or node are as near up to round-off, which must not choose among
  /// them: one that is shut is enough.
  bool in_slit(const Vec3 &x)
  {
    if (!(shut_range > 0.0)) return false;
    constexpr double SAME = 1.0e-9;
    const double most = shut_range * shut_range;
    double least = most;
    bool any = false, shut = false;
    for (const int f : voxels.at(x)) {
      const TracerFace &face = faces[f];
      const double height = (x - face.mid).dot(face.normal);
      if (height < -delta || height * height > most) continue;
      const double d2 = (x - face.nearest(x)).squaredNorm();
      if (d2 > (any ? least + SAME * most : most)) continue;
      shut = face.shut || (shut && d2 >= least - SAME * most);
      least = std::min(least, d2);
      any = true;
    }
    return shut;
  }

  /// The surfaces have moved by at most `moved` since the tracer was where it belongs. False: its
  /// cell has no place for it (home stays, position too).
  bool settle(Tracer &t, double moved)
  {
    if (t.host >= 0) {
      ride(t);
      return true;
    }
    const double slack = moved + TOLERANCE * delta;
    bool close = false;
    for (const int f : voxels.at(t.x)) {
      const TracerFace &face = faces[f];
      if (t.home != Tracer::OUTSIDE && face.cell != t.home) continue;
      const Vec3 d = t.x - face.mid;
      if (std::fabs(d.dot(face.normal)) > slack) continue;
      const double r = face.reach + slack;
      if (d.squaredNorm() <= r * r) {
        close = true;
        break;
      }
    }
    Side wrong;
    if (!close || right_place(t.x, t.home, &wrong)) return true;
    count.swept++;
    return put_back(t, wrong);
  }

  /// A step of Brownian motion or drift. The cell may change to OUTSIDE.
  void walk(Tracer &t, Vec3 d)
  {
    count.steps++;
    if (t.host >= 0) return;
    const double length = d.norm();
    const int pieces = length > near ? int(length / near) + 1 : 1;
    d /= pieces;
    for (int p = 0; p < pieces; p++) d = piece(t, d);
  }

  /// Call mark(f) for all faces within `range` (at most `near`) that an outside tracer is in front
  /// of.
  template <class Mark> void touch(const Vec3 &x, double range, Mark &&mark)
  {
    for (const int f : voxels.at(x)) {
      const TracerFace &face = faces[f];
      const double height = (x - face.mid).dot(face.normal);
      if (height < 0.0 || height > range) continue;
      if ((x - face.nearest(x)).squaredNorm() <= range * range) mark(f);
    }
  }

 private:
  static constexpr double ENDLESS = 1.0e300, TIE = 1.0e-10, TINY = 1.0e-30;
  static constexpr double WIDE = 1.0 + 1.0e-9;    // what round-off of heights may hide
  static constexpr double TOLERANCE = 4.0;    // in delta: a start behind a plane, still before it
  static constexpr double EDGE = 1.0e-12;     // dilation of faces: nothing passes between two
  static constexpr int TRIES = 12, MOST_DOUBLED = 8;    // of put_back()

  Faces &faces;
  Voxels &voxels;
  std::vector<Side> ties;
  std::vector<std::int64_t> seen;

  // onto the surface, delta to the tracer's side of it; farther from it in later tries

  bool put_back(Tracer &t, Side wrong)
  {
    const bool outside = t.home == Tracer::OUTSIDE;
    const Side first = wrong;
    for (int k = 0; k < TRIES; k++) {
      const TracerFace &face = faces[wrong.face];
      const double offset = delta * (1 << std::min(k, MOST_DOUBLED));
      const Vec3 y = wrong.point + (outside ? offset : -offset) * face.normal;
      Side next;
      if (right_place(y, t.home, &next)) {
        t.x = y;
        return true;
      }
      if (!outside) {    // at a sharp corner, toward the middle of the face
        const Vec3 z = 0.999 * wrong.point + 0.001 * face.mid - offset * face.normal;
        if (right_place(z, t.home, &next)) {
          t.x = z;
          return true;
        }
      }
      wrong = next;
    }
    if (!outside) return below_any_face(t);
    catch_on(t, first);
    return true;
  }

  // the last resort inside: below the middle of the nearest faces of the cell

  bool below_any_face(Tracer &t)
  {
    struct Spot {
      double d2;
      int face;
    };
    std::vector<Spot> spots;
    for (const int f : voxels.at(t.x))
      if (faces[f].cell == t.home) spots.push_back({(t.x - faces[f].mid).squaredNorm(), f});
    std::sort(spots.begin(), spots.end(), [this](const Spot &a, const Spot &b) {
      return a.d2 != b.d2 ? a.d2 < b.d2 : faces[a.face].tag < faces[b.face].tag;
    });
    for (const Spot &spot : spots)
      for (const double offset : {1.0e-3 * faces[spot.face].reach, delta}) {
        const Vec3 y = faces[spot.face].mid - offset * faces[spot.face].normal;
        if (!right_place(y, t.home)) continue;
        t.x = y;
        return true;
      }
    return false;
  }

  void catch_on(Tracer &t, const Side &side)
  {
    count.caught++;
    t.host = side.face;
    const TracerFace &face = faces[side.face];
    const Vec3 u = face.corner[1] - face.corner[0], v = face.corner[2] - face.corner[0],
               p = side.point - face.corner[0];
    const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), pu = p.dot(u), pv = p.dot(v);
    const double det = uu * vv - uv * uv;
    const double second = det > 0.0 ? (vv * pu - uv * pv) / det : 0.0;
    const double third = det > 0.0 ? (uu * pv - uv * pu) / det : 0.0;
    const int all = Tracer::WEIGHTS;    // whole numbers: kept exactly by any file
    t.weight[0] = std::clamp(int(std::lround(second * all)), 0, all);
    t.weight[1] = std::clamp(int(std::lround(third * all)), 0, all - t.weight[0]);
    t.x = ridden(t);
  }

  Vec3 ridden(const Tracer &t)
  {
    const TracerFace &face = faces[t.host];
    const double unit = 1.0 / Tracer::WEIGHTS, second = unit * t.weight[0],
                 third = unit * t.weight[1];
    return (1.0 - second - third) * face.corner[0] + second * face.corner[1] +
           third * face.corner[2];
  }

  // free again where the point above the face is outside all cells

  void ride(Tracer &t)
  {
    t.x = ridden(t);
    const Vec3 y = t.x + delta * faces[t.host].normal;
    if (!right_place(y, Tracer::OUTSIDE)) return;
    t.x = y;
    t.host = -1;
    count.released++;
  }

  // the face met first on x + t d, 0 <= t <= 1, from the tracer's side: what is left behind is met
  // again only from the other side, so that no tolerance guards against it

  int first_hit(const Vec3 &x, const Vec3 &d, std::int64_t home, const Voxels::List &list,
                double &at)
  {
    const bool outside = home == Tracer::OUTSIDE;
    const double length = d.norm();
    int hit = -1;
    at = 1.0;
    for (const int f : list) {
      const TracerFace &face = faces[f];
      if (!outside && face.cell != home) continue;
      double along = d.dot(face.normal), gap = (face.mid - x).dot(face.normal);
      if (outside) {
        along = -along;
        gap = -gap;
      }
      if (!(along > 0.0) || gap < -TOLERANCE * delta || gap > along * at * (1.0 + EDGE)) continue;
      // on which side of the three edges does the line pass? the two faces of an edge see the same
      // number, up to sign
      const Vec3 a = face.corner[0] - x, b = face.corner[1] - x, c = face.corner[2] - x;
      const double u = d.dot(b.cross(c)), v = d.dot(c.cross(a)), w = d.dot(a.cross(b));
      const double eps = EDGE * length * face.reach * face.reach;
      if (!(u >= -eps && v >= -eps && w >= -eps) && !(u <= eps && v <= eps && w <= eps)) continue;
      const double t = std::max(0.0, gap / along);
      if (t > at || (hit >= 0 && t == at && face.tag > faces[hit].tag)) continue;
      at = t;
      hit = f;
    }
    return hit;
  }

  // the plane met first; a tracer that is beyond one may come back

  int first_wall(const Vec3 &x, const Vec3 &d, std::int64_t home, double &at) const
  {
    int hit = -1;
    for (int k = 0; k < 3; k++) {
      double lo = wall_lo[k], hi = wall_hi[k];
      if (home == Tracer::OUTSIDE) {
        lo = std::max(lo, outer_lo[k]);
        hi = std::min(hi, outer_hi[k]);
      }
      const double y = x[k] + d[k];
      const bool up = d[k] > 0.0 && y > hi, down = d[k] < 0.0 && y < lo;
      if (!up && !down) continue;
      const double t = std::max(0.0, ((up ? hi : lo) - x[k]) / d[k]);
      if (hit >= 0 && t >= at) continue;
      at = t;
      hit = k;
    }
    return hit;
  }

  // one piece; returns the next one. A rejected piece turns back: then the way there and the way
  // back are equally likely, also over several pieces, and the density stays uniform

  Vec3 piece(Tracer &t, const Vec3 &whole)
  {
    const Tracer start = t;
    const auto list = voxels.at(t.x);
    Vec3 x = t.x, d = whole, next = whole;
    std::int64_t home = t.home;
    int bounces = 0;
    for (;;) {
      double at_face = 1.0, at_wall = 1.0;
      const int f = list.empty() ? -1 : first_hit(x, d, home, list, at_face);
      const int wall = first_wall(x, d, home, at_wall);
      if (f < 0 && wall < 0) break;
      count.bounces++;
      if (++bounces > most_bounces) {
        count.capped++;
        return -whole;
      }
      if (wall >= 0 && (f < 0 || at_wall < at_face)) {
        x += at_wall * d;
        d *= 1.0 - at_wall;
        d[wall] = -d[wall];
        next[wall] = -next[wall];
        continue;
      }
      const TracerFace &face = faces[f];
      const Vec3 hit = x + at_face * d;
      d *= 1.0 - at_face;
      if (home != Tracer::OUTSIDE && face.open) {
        const Vec3 y = hit + delta * face.normal;
        if (right_place(y, Tracer::OUTSIDE)) {
          home = Tracer::OUTSIDE;
          x = y;
          continue;
        }
        count.blocked++;
      }
      x = hit + (home == Tracer::OUTSIDE ? delta : -delta) * face.normal;
      d -= 2.0 * d.dot(face.normal) * face.normal;
      next -= 2.0 * next.dot(face.normal) * face.normal;
    }
    x += d;
    if (bounces && !right_place(x, home)) {
      count.rejected++;
      return -whole;
    }
    if (home == Tracer::OUTSIDE && in_slit(x) && !(start.home == home && in_slit(start.x))) {
      count.shut_out++;
      return -whole;
    }
    if (home != start.home) count.exits++;
    t.x = x;
    t.home = home;
    return next;
  }
};

}    // namespace dcm

#endif
