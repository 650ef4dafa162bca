// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Better faces for a closed surface that has flowed far from the mesh it was made with: edges are
// flipped, nodes taken out where there are too many and put in where there are too few. The
// numbers of nodes, edges and faces stay, so does the volume, and the surface moves by no more than
// a stated distance. The strain of the cortex is carried over to the new edges, and so is what is
// bent beyond the rest angles: doc/fix_dcm_remesh.rst. Lengths um.

#ifndef DCM_REMESH_H
#define DCM_REMESH_H

#include "remesh_surface.h"
#include "self_crossing.h"

#include <Eigen/LU>

namespace dcm {

/// What was done. Nothing is changed if flips, slides and moves are 0.
struct Remeshed {
  RemeshCell cell;
  int flips = 0, slides = 0;
  int moves = 0;                                 ///< nodes taken out and put in elsewhere
  std::vector<char> node_changed;                ///< per node: it is in another place
  std::vector<char> face_changed;                ///< per face: it has other nodes
  double quality_before = 1.0, quality = 1.0;    ///< of the worst face
  double distance = 0.0;    ///< largest between old and new surface, over the mean edge
  double volume = 0.0;      ///< part of the volume that had to be given back
  double area = 1.0;        ///< new area over old
  double energy_before = 0.0, energy = 0.0;    ///< sum of (l - l0)^2 / 2, um^2
};

/// Longest edge over that of the mean face (an equilateral one of its area).
inline double longest_edge(const Mesh &mesh)
{
  double most = 0.0;
  for (const auto &t : mesh.faces)
    for (int k = 0; k < 3; k++)
      most = std::max(most, (mesh.nodes[t[(k + 1) % 3]] - mesh.nodes[t[k]]).squaredNorm());
  return std::sqrt(most / (4.0 / std::sqrt(3.0) * area(mesh) / double(mesh.faces.size())));
}

/// How much a cell needs it: below 1 a face is worse, or an edge longer, than the settings say.
inline double remesh_need(double worst, double longest, const RemeshSettings &set)
{
  return std::min(worst / set.quality, set.longest / longest);
}

namespace remesh_detail {

  constexpr int CANDIDATES = 6;         // faces whose nodes and edges are tried
  constexpr double OPERATIONS = 0.8;    // part of the distance for each, at the first try
  constexpr int TRIES = 4;
  constexpr double NO_ENERGY = 1.0e-20;    // of round-off, per area

  inline double worst_of(const Surface &s)
  {
    double worst = 1.0;
    for (const Face &t : s.f) worst = std::min(worst, s.quality(t));
    return worst;
  }

  /// One node out of where there are many and in where faces are bad or edges long, and flips
  /// around both: whichever of some candidates is best. False if none makes it better.
  inline bool move_node(Surface &s)
  {
    std::vector<int> bad(s.f.size());
    std::iota(bad.begin(), bad.end(), 0);
    const int most = std::min(CANDIDATES, int(bad.size()));
    auto head = [most](std::vector<int> &list, auto &&before) {
      std::partial_sort(list.begin(), list.begin() + std::min(most, int(list.size())), list.end(),
                        before);
      list.resize(std::min(most, int(list.size())));
    };
    head(bad, [&s](int f, int g) {
      return s.cost[f] != s.cost[g] ? s.cost[f] > s.cost[g] : f < g;
    });

    std::vector<double> around(s.x.size(), 0.0);
    for (size_t f = 0; f < s.f.size(); f++)
      for (const int n : s.f[f]) around[n] += s.twice_area(s.f[f]).norm();
    std::vector<int> nodes(s.x.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    head(nodes, [&around](int n, int m) {
      return around[n] != around[m] ? around[n] < around[m] : n < m;
    });
    for (const int f : bad) nodes.insert(nodes.end(), s.f[f].begin(), s.f[f].end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());

    const double before = s.total();
    Surface best;
    double least = std::numeric_limits<double>::infinity();
    for (const int n : nodes) {
      Surface trial = s;
      std::vector<int> where(s.star[n].face.begin(), s.star[n].face.begin() + s.star[n].n);
      if (!trial.take_out(n)) continue;
      where.erase(std::remove_if(where.begin(), where.end(),
                                 [&trial](int f) {
                                   return f == trial.faces[0] || f == trial.faces[1];
                                 }),
                  where.end());
      trial.smooth(where, SHORT);
      const double cost = trial.total();
      if (cost >= least) continue;
      least = cost;
      best = std::move(trial);
    }
    if (best.x.empty()) return false;

    struct Edge {
      double length;
      int a, b;
    };
    std::vector<Edge> list;
    auto is_out = [&best](int f) {
      return f == best.faces[0] || f == best.faces[1];
    };
    for (int f = 0; f < int(best.f.size()); f++)
      for (int k = 0; k < 3 && !is_out(f); k++) {
        const int a = best.f[f][k], b = best.f[f][(k + 1) % 3];
        if (a < b) list.push_back({best.length(a, b), a, b});
      }
    std::sort(list.begin(), list.end(), [](const Edge &p, const Edge &q) {
      return p.length != q.length ? p.length > q.length : p.a != q.a ? p.a < q.a : p.b < q.b;
    });
    list.resize(std::min(list.size(), size_t(CANDIDATES)));
    for (const int f : bad)
      for (int k = 0; k < 3 && !is_out(f); k++)
        list.push_back({0.0, best.f[f][k], best.f[f][(k + 1) % 3]});

    Surface last;
    least = before - GAIN;
    for (const Edge &e : list) {
      Surface trial = best;
      if (!trial.put_in(e.a, e.b)) continue;
      const Star &star = trial.star[best.node];
      trial.smooth({star.face.begin(), star.face.begin() + star.n}, SHORT);
      const double cost = trial.total();
      if (cost >= least) continue;
      least = cost;
      last = std::move(trial);
    }
    if (last.x.empty() || worst_of(last) < worst_of(s)) return false;
    s = std::move(last);
    return true;
  }

  /// Give back the volume: nodes of what has changed move along their normals, all alike. The part
  /// of it, or none if the surface would have to move farther than it may.
  inline double give_back(Surface &s, double volume0)
  {
    std::vector<char> chosen(s.x.size(), 0);
    for (size_t f = 0; f < s.f.size(); f++)
      for (const int n : s.f[f])
        if ((s.changed[f] || s.moved[n]) && !s.pinned[n]) chosen[n] = 1;
    std::vector<Vec3> normal(s.x.size(), Vec3::Zero());
    for (size_t n = 0; n < s.x.size(); n++)
      if (chosen[n]) normal[n] = s.normal_of(int(n));
    const double missing = volume0 - volume({s.x, s.f});
    double way = 0.0, now = missing;
    for (int k = 0; k < 20 && std::fabs(now) > 1.0e-14 * volume0; k++) {
      double slope = 0.0;    // dV/dx of a corner: a third of the area vector of its faces
      for (const Face &t : s.f)
        for (int c = 0; c < 3; c++)
          slope += s.x[t[(c + 1) % 3]].cross(s.x[t[(c + 2) % 3]]).dot(normal[t[c]]) / 6.0;
      if (!(slope > 0.0)) return std::numeric_limits<double>::quiet_NaN();
      const double h = now / slope;
      way += h;
      for (size_t n = 0; n < s.x.size(); n++) s.x[n] += h * normal[n];
      now = volume0 - volume({s.x, s.f});
    }
    if (!(std::fabs(way) <= s.most_off) || !(std::fabs(now) < 1.0e-12 * volume0))
      return std::numeric_limits<double>::quiet_NaN();
    for (size_t n = 0; n < s.x.size(); n++) s.moved[n] |= chosen[n];
    return missing / volume0;
  }

  /// Largest distance between two surfaces, at points of the faces that are not in both: corners
  /// and a grid between them.
  inline double apart(const Surface &now, const Mesh &before)
  {
    const Mesh mesh = {now.x, now.f};
    const Envelope after(mesh);
    double most = 0.0;
    for (size_t f = 0; f < now.f.size(); f++) {
      bool touched = now.changed[f] != 0;
      for (const int n : now.f[f]) touched = touched || now.moved[n];
      if (!touched) continue;
      for (const bool fresh : {true, false}) {
        const Mesh &from = fresh ? mesh : before;
        const Envelope &to = fresh ? *now.was : after;
        const Face &t = from.faces[f];
        int hint = -1;
        for (int a = 0; a <= 6; a++)
          for (int b = 0; a + b <= 6; b++) {
            const int c = 6 - a - b;
            const Vec3 p =
                (a * from.nodes[t[0]] + b * from.nodes[t[1]] + c * from.nodes[t[2]]) / 6.0;
            const EnvelopePoint near = to.nearest(p, hint);
            hint = near.face;
            most = std::max(most, std::fabs(near.distance));
          }
      }
    }
    return most;
  }

  inline double spring_energy(const Mesh &mesh, const std::vector<double> &l0)
  {
    double sum = 0.0;
    const auto list = edges(mesh);
    for (size_t e = 0; e < list.size(); e++) {
      const double d = (mesh.nodes[list[e][1]] - mesh.nodes[list[e][0]]).norm() - l0[e];
      sum += 0.5 * d * d;
    }
    return sum;
  }

}    // namespace remesh_detail

namespace remesh_detail {

  /// Virial of the springs, for a spring constant of 1: sum of (l - l0) / l d d^T, um^2.
  inline Mat3 spring_virial(const Mesh &mesh, const std::vector<double> &l0)
  {
    Mat3 sum = Mat3::Zero();
    const auto list = edges(mesh);
    for (size_t e = 0; e < list.size(); e++) {
      const Vec3 d = mesh.nodes[list[e][1]] - mesh.nodes[list[e][0]];
      sum += (1.0 - l0[e] / d.norm()) * d * d.transpose();
    }
    return sum;
  }

  /// Give edges (chosen ones) a strain more, the same tensor for all, with which the springs have
  /// this virial. False if an edge would have to be shorter at rest than a tenth of what it is.
  inline bool carry_load(const Mesh &mesh, const std::vector<char> &chosen, const Mat3 &virial,
                         std::vector<double> &l0)
  {
    constexpr int P[6] = {0, 1, 2, 0, 0, 1}, Q[6] = {0, 1, 2, 1, 2, 2};
    Eigen::Matrix<double, 6, 6> system = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> missing;
    const Mat3 lack = virial - spring_virial(mesh, l0);
    const auto list = edges(mesh);
    std::vector<Eigen::Matrix<double, 6, 1>> way(list.size());
    for (size_t e = 0; e < list.size(); e++) {
      if (!chosen[e]) continue;
      const Vec3 d = mesh.nodes[list[e][1]] - mesh.nodes[list[e][0]];
      for (int k = 0; k < 6; k++)    // strain along the edge of a unit of each component
        way[e][k] = (P[k] == Q[k] ? 1.0 : 2.0) * d[P[k]] * d[Q[k]] / d.squaredNorm();
      for (int k = 0; k < 6; k++) system.row(k) += d[P[k]] * d[Q[k]] * way[e].transpose();
    }
    for (int k = 0; k < 6; k++) missing[k] = lack(P[k], Q[k]);
    const auto solver = system.fullPivLu();
    if (!solver.isInvertible()) return false;
    const Eigen::Matrix<double, 6, 1> strain = solver.solve(missing);
    for (size_t e = 0; e < list.size(); e++) {
      if (!chosen[e]) continue;
      const double l = (mesh.nodes[list[e][1]] - mesh.nodes[list[e][0]]).norm();
      l0[e] -= l * strain.dot(way[e]);
      if (!(l0[e] > 0.1 * l)) return false;
    }
    return true;
  }

  /// Nothing done.
  inline Remeshed as_it_was(const RemeshCell &cell)
  {
    Remeshed it;
    it.cell = cell;
    it.node_changed.assign(cell.mesh.nodes.size(), 0);
    it.face_changed.assign(cell.mesh.faces.size(), 0);
    it.quality_before = it.quality = worst_face(cell.mesh);
    it.energy_before = it.energy = spring_energy(cell.mesh, cell.l0);
    return it;
  }

  /// One try, in which each operation keeps within `part` of the distance, and faces as good as the
  /// goal stay what they are, or not (widely); what it has come to is for the caller to judge.
  inline Remeshed attempt(const RemeshCell &cell, const RemeshSettings &set, double part,
                          bool widely)
  {
    Remeshed result = as_it_was(cell);
    Surface s;
    if (!s.begin(cell, set, part)) return result;
    if (widely) s.goal = 1.0;
    std::vector<int> all(s.f.size());
    std::iota(all.begin(), all.end(), 0);
    s.smooth(all, SWEEPS);
    const int most = int(s.x.size());
    int moves = 0;
    while (moves < most && (worst_of(s) < set.goal || longest_edge({s.x, s.f}) > set.longest) &&
           move_node(s))
      moves++;
    if (moves) s.smooth(all, SWEEPS);
    if (s.flips + s.slides + moves == 0) return result;

    // strains stay what they are where the surface moves to give back the volume

    const std::vector<Vec3> before = s.x;
    const double back = give_back(s, volume(cell.mesh));
    if (!std::isfinite(back)) return result;
    for (size_t f = 0; f < s.f.size(); f++)
      for (int k = 0; k < 3; k++) {
        const int a = s.f[f][k], b = s.f[f][(k + 1) % 3];
        if (s.moved[a] || s.moved[b]) s.l0[f][k] *= s.length(a, b) / (before[b] - before[a]).norm();
      }

    result.flips = s.flips;
    result.slides = s.slides;
    result.moves = moves;
    result.volume = back;
    result.cell.mesh = {s.x, s.f};
    result.cell.region = s.region;
    result.cell.v = s.v;
    result.node_changed = s.moved;
    result.face_changed = s.changed;
    result.cell.l0.clear();
    result.cell.theta0.clear();
    const auto old = edges(cell.mesh);    // sorted
    std::vector<char> fresh;
    for (const auto &h : hinges(result.cell.mesh)) {
      const int face = s.find(h[1], h[2]), other = s.find(h[2], h[1]);
      const int k = Surface::corner(s.f[face], h[1]);
      const bool touched = s.changed[face] || s.changed[other] || s.moved[h[0]] || s.moved[h[1]] ||
                           s.moved[h[2]] || s.moved[h[3]];
      const auto at = std::lower_bound(old.begin(), old.end(), std::array<int, 2>{h[1], h[2]});
      const double theta = hinge_angle(s.x[h[0]], s.x[h[1]], s.x[h[2]], s.x[h[3]]);
      fresh.push_back(touched);
      result.cell.l0.push_back(s.l0[face][k]);
      result.cell.theta0.push_back(touched ? wrapped(theta - s.bent[face][k])
                                           : cell.theta0[at - old.begin()]);
    }
    if (!check_mesh(result.cell.mesh).empty()) return as_it_was(cell);
    if (set.load &&
        !carry_load(result.cell.mesh, fresh, spring_virial(cell.mesh, cell.l0), result.cell.l0))
      return as_it_was(cell);
    result.quality = worst_face(result.cell.mesh);
    result.distance = apart(s, cell.mesh) / mean_edge(cell.mesh);
    result.area = area(result.cell.mesh) / area(cell.mesh);
    result.energy = spring_energy(result.cell.mesh, result.cell.l0);
    return result;
  }

}    // namespace remesh_detail

/// The cell with better faces, or as it was where nothing better is within the settings. Edges that
/// nothing has happened to have their values to the last bit.
inline Remeshed remesh(const RemeshCell &cell, const RemeshSettings &set)
{
  const double need = remesh_need(worst_face(cell.mesh), longest_edge(cell.mesh), set);
  if (need >= 1.0 || !check_mesh(cell.mesh).empty()) return remesh_detail::as_it_was(cell);
  const bool crossed = self_crossing(cell.mesh)[0] >= 0;
  Remeshed best = remesh_detail::as_it_was(cell);
  double best_need = need, part = remesh_detail::OPERATIONS;
  for (int k = 0; k < remesh_detail::TRIES && best_need < 1.0; k++) {
    Remeshed result = remesh_detail::attempt(cell, set, part, k > 0);
    const Mesh &mesh = result.cell.mesh;
    const double now = remesh_need(result.quality, longest_edge(mesh), set);
    if (result.distance > set.distance)
      part *= std::clamp(0.9 * set.distance / result.distance, 0.3, 0.7);
    else if (k > 0 && now <= best_need)
      break;
    if (result.distance > set.distance || now <= best_need) continue;
    if (!crossed && self_crossing(mesh)[0] >= 0) continue;
    if (std::fabs(result.energy - result.energy_before) >
        set.energy * result.energy_before + remesh_detail::NO_ENERGY * area(mesh))
      continue;
    best_need = now;
    best = std::move(result);
  }
  return best;
}

}    // namespace dcm

#endif
