// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Division of a deformable cell (S1, "Cell cycle and cell division"). The mother's surface is
// frozen as an envelope and cut by a plane; in each half a round cell grows against envelope and
// plane to force balance with exactly its share of the mother's volume. No physical time passes:
// balance is the minimum of the energy of the simulation's own laws plus that of the walls
// (confined_cell.h), so neither dashpots nor friction play a part.
//
// Units: lengths um, forces nN, pressures and moduli nN/um^2 (= kPa), energies nN um.

#ifndef DCM_DIVISION_H
#define DCM_DIVISION_H

#include "confined_cell.h"
#include "envelope.h"
#include "hinge.h"
#include "lbfgs.h"
#include "mesh.h"
#include "plane_cut.h"
#include "vector.h"
#include "volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace dcm {

/// What a daughter has to reach.
struct DivisionSettings {
  double volume = 0.0;    ///< wanted volume, um^3; 0: that of its half of the envelope
  double rest = 1.0;      ///< rest length of edges over their length in the round cell of `volume`
  double tolerance = 1.0e-3;    ///< largest nodal force left, over ConfinedCell::force_scale()
  int maxiter = 4000;           ///< minimization steps, all volume corrections together
};

/// A daughter in force balance, or how far it came.
struct Daughter {
  Mesh mesh;                         ///< faces and numbering of the round mesh it grew from
  std::vector<double> l0, theta0;    ///< rest state of edges() and hinges() of mesh, um and rad
  double rest;           ///< factor of l0: the one of the settings, below it if slack was taken up
  int iterations;        ///< minimization steps
  double residual;       ///< largest nodal force over ConfinedCell::force_scale()
  double volume;         ///< um^3, within DIVISION_VOLUME of the wanted one if converged
  double rest_volume;    ///< V0 for which pressure(K_V, volume, V0) is in balance, um^3
  double pressure;       ///< of the cell, kPa
  double wall_pressure;    ///< largest pressure of a wall on a node, kPa
  double energy;           ///< cortex + bending + pressure + walls, nN um
  double outside;          ///< largest depth of a node beyond envelope or plane, um
  double quality;          ///< of the worst face, face_quality()
  bool converged;          ///< volume and force balance reached
  std::string problem;     ///< one sentence if the cell cannot be used, otherwise empty
};

/// Relative accuracy of a converged daughter's volume.
constexpr double DIVISION_VOLUME = 1.0e-6;
/// A node farther outside than this fraction of the daughter's radius is a `problem`.
constexpr double DIVISION_OUTSIDE = 0.1;
/// Worse faces (face_quality()) are a `problem`. A triangle stretched by s has 2s/(1 + s^2) of the
/// quality it had; half a mother of 3 : 1 cut lengthwise is 6 : 1, which leaves 0.3. Half of that
/// is no longer a face that follows the shape of the cell but one that has collapsed.
constexpr double DIVISION_QUALITY = 0.15;
/// Shape of a triangle, 4 sqrt(3) area / (sum of squared sides): 1 equilateral, 0 degenerate.
inline double face_quality(const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return 2.0 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / sides;
}

/// Quality of the worst face of a mesh.
inline double worst_face(const Mesh &mesh)
{
  double worst = 1.0;
  for (const auto &f : mesh.faces)
    worst = std::min(worst, face_quality(mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]));
  return worst;
}

namespace division_detail {

  /// Radius of the first ball over its distance to the walls.
  constexpr double START = 0.9;
  /// Growth of radius and rest lengths per stage, and forces over the tolerance that end a stage.
  constexpr double STAGE = 1.25, ROUGH = 100.0;
  /// First trial of a line search: a node moves at most this fraction of the mean rest length.
  constexpr double MOVE = 0.25;
  /// Volume correction begins once the forces are below this multiple of the tolerance.
  constexpr double LOOSE = 10.0;
  /// Bulk modulus over stiffness of the walls against change of lnV, at least, on the way.
  constexpr double SOFTEST = 0.25;
  /// Relative volume error that may be removed by scaling.
  constexpr double SCALED = 1.0e-3;
  /// Volume corrections at most; four or five are usual.
  constexpr int CORRECTIONS = 50;
  /// Growth of rest lengths per stage when a cell that grew with short ones is released.
  constexpr double RELEASE = 1.05;
  /// Rest factors above this leave the cortex slack in nearly any half: it folds whatever the way.
  constexpr double SLACK = 1.1;
  /// A hinge bent farther than this, rad, is a fold: faces lie on each other.
  constexpr double FOLD = 2.6;

  /// Smaller of the distances to plane and envelope, um, negative outside.
  inline double clearance(const Envelope &envelope, const DivisionPlane &plane, const Vec3 &x)
  {
    return std::min(plane.normal.dot(x - plane.point), -envelope.nearest(x).distance);
  }

  /// Center to grow from: the centroid of the half, or, if that lies outside or next to a wall
  /// of a bent half, the point of a grid over the envelope farthest from all walls.
  inline Vec3 start_center(const Envelope &envelope, const DivisionPlane &plane,
                           const Vec3 &centroid, double radius)
  {
    Vec3 best = centroid;
    double most = clearance(envelope, plane, centroid);
    if (most > 0.1 * radius) return best;
    Vec3 lo = envelope.mesh().nodes[0], hi = lo;
    for (const Vec3 &x : envelope.mesh().nodes) {
      lo = lo.cwiseMin(x);
      hi = hi.cwiseMax(x);
    }
    constexpr int n = 16;
    for (int i = 0; i < n * n * n; i++) {
      const Vec3 part((i % n + 0.5) / n, (i / n % n + 0.5) / n, (i / n / n + 0.5) / n);
      const Vec3 x = lo + part.cwiseProduct(hi - lo);
      const double c = clearance(envelope, plane, x);
      if (c > most) {
        most = c;
        best = x;
      }
    }
    return best;
  }

  /// Round mesh as a ball of the given radius.
  inline Eigen::VectorXd ball(const Mesh &round, const Vec3 &center, double radius)
  {
    const double scale = radius / std::cbrt(3.0 * dcm::volume(round) / (4.0 * PI));
    Eigen::VectorXd x(3 * round.nodes.size());
    for (size_t i = 0; i < round.nodes.size(); i++)
      vec(&x[3 * i]) = center + scale * round.nodes[i];
    return x;
  }

  /// Scale positions about their mean.
  inline void inflate(Eigen::VectorXd &x, double factor)
  {
    Vec3 mid = Vec3::Zero();
    for (int i = 0; i < int(x.size()); i += 3) mid += 3.0 / double(x.size()) * vec(&x[i]);
    for (int i = 0; i < int(x.size()); i += 3) vec(&x[i]) = mid + factor * (vec(&x[i]) - mid);
  }

  inline double largest_node(const Eigen::VectorXd &g)
  {
    double m = 0.0;
    for (int i = 0; i < int(g.size()); i += 3) m = std::max(m, vec(&g[i]).squaredNorm());
    return std::sqrt(m);
  }

  /// Rest volume for the wanted volume. In balance, the pressure of the cell is that of walls and
  /// cortex, P(V). With P' = dP/dlnV, V0 has to change by dlnV0 = (1 + P'/K_V) dlnV; P' is first
  /// that of the walls alone, then taken from the last two states.
  class VolumeCorrection {
   public:
    VolumeCorrection(double K_V, double stiffness) : K_V(K_V), slope(stiffness) {}

    double rest_volume(double V0, double V, double wanted)
    {
      const double x = std::log(V), p = pressure(K_V, V, V0);
      if (seen && std::fabs(x - last_x) > 1.0e-6) {
        const double s = (p - last_p) / (x - last_x);
        if (std::isfinite(s)) slope = std::clamp(s, 0.5 * slope, 2.0 * slope);
      }
      seen = true;
      last_x = x;
      last_p = p;
      const double change = (1.0 + slope / K_V) * std::log(wanted / V);
      return V0 * std::exp(std::clamp(change, -0.2, 0.2));
    }

    /// Pressure that changes lnV by this much, kPa.
    double stiffness(double change) const { return (K_V + slope) * change; }

   private:
    double K_V, slope, last_x = 0.0, last_p = 0.0;
    bool seen = false;
  };

  /// Give a cell in balance exactly the wanted volume: scale it, a change far below what its
  /// shape is known to, and keep its pressure. False, with nothing changed, if this leaves forces
  /// above the tolerance.
  inline bool set_volume(ConfinedCell &cell, Eigen::VectorXd &x, double wanted, double tolerance)
  {
    const double v = cell.enclosed(x), old = cell.V0;
    Eigen::VectorXd y = x, g;
    inflate(y, std::cbrt(wanted / v));
    cell.V0 = old * wanted / v;
    cell.energy(y, g);
    if (largest_node(g) <= tolerance) {
      x = y;
      return true;
    }
    cell.V0 = old;
    return false;
  }

  /// Minimizer of the energy of a cell, with the state it has reached.
  class Relaxation {
   public:
    Eigen::VectorXd x;
    int steps = 0;

    Relaxation(ConfinedCell &cell, const DivisionSettings &settings, Eigen::VectorXd start) :
        x(std::move(start)), cell(cell), settings(settings),
        tolerance(settings.tolerance * cell.force_scale())
    {
      for (double l : cell.l0) edge += l / double(cell.l0.size());
    }

    /// Steps until the largest nodal force is below a multiple of the tolerance; false if none
    /// leads lower or there are too many.
    bool descend(double multiple)
    {
      double value = cell.energy(x, g);
      auto function = [&](const Eigen::VectorXd &y, Eigen::VectorXd &gy) {
        return cell.energy(y, gy);
      };
      for (; largest_node(g) > multiple * tolerance; steps++)
        if (steps >= settings.maxiter ||
            !minimizer.step(function, x, value, g, MOVE * edge, 4.0 * cell.material.ks))
          return false;
      return true;
    }

    /// Grow a ball of `size` times the final radius to full size. The rest state grows with it,
    /// so that the cell stays taut: edges shorter than at rest would fold where walls hold them.
    void grow(double size)
    {
      const double V0 = cell.V0;
      const std::vector<double> l0 = cell.l0;
      while (size < 1.0) {
        set_size(V0, l0, size);
        descend(ROUGH);
        const double factor = std::min(STAGE, 1.0 / size);
        size = factor * size > 1.0 - 1.0e-9 ? 1.0 : factor * size;
        inflate(x, factor);
      }
      set_size(V0, l0, 1.0);
    }

    /// Lengthen the rest lengths of a balanced cell by a factor, in stages.
    void release(double factor)
    {
      const std::vector<double> l0 = cell.l0;
      for (double done = 1.0; done < factor;) {
        done = std::min(RELEASE * done, factor);
        for (size_t n = 0; n < l0.size(); n++) cell.l0[n] = done * l0[n];
        descend(LOOSE);
      }
    }

    /// Force balance at the wanted volume.
    void balance(double wanted)
    {
      const DivisionMaterial &m = cell.material;
      VolumeCorrection correction(m.K_V, m.wall * cell.radius() / 3.0);
      double goal = LOOSE;
      for (int n = 0; n < CORRECTIONS && steps < settings.maxiter; n++) {
        const bool lower = descend(goal);
        const double v = cell.enclosed(x), error = std::fabs(v / wanted - 1.0);
        if (error < SCALED && largest_node(g) <= tolerance &&
            set_volume(cell, x, wanted, tolerance))
          return;
        if (!lower && error < DIVISION_VOLUME) return;    // round-off: no lower point exists
        cell.V0 = correction.rest_volume(cell.V0, v, wanted);
        // forces left over make the volume uncertain: by less than the error to be corrected next
        const double uncertain = correction.stiffness(0.1 * error) * cell.radius() / m.ks;
        goal = std::clamp(uncertain / settings.tolerance, 0.01, LOOSE);
      }
    }

   private:
    ConfinedCell &cell;
    const DivisionSettings &settings;
    const double tolerance;
    double edge = 0.0;    // mean rest length of the full-grown cell, um
    Eigen::VectorXd g;
    Lbfgs minimizer;

    void set_size(double V0, const std::vector<double> &l0, double size)
    {
      cell.V0 = size * size * size * V0;
      for (size_t n = 0; n < l0.size(); n++) cell.l0[n] = size * l0[n];
    }
  };

  inline void check_input(const Mesh &round, const DivisionMaterial &m, const DivisionSettings &s)
  {
    const std::string fault = check_mesh(round);
    if (!fault.empty()) throw std::invalid_argument("division: round mesh: " + fault);
    if (!(m.ks > 0.0 && m.kb >= 0.0 && m.K_V > 0.0 && m.wall >= 0.0))
      throw std::invalid_argument(
          "division: ks and K_V must be positive, kb and wall not negative");
    if (!(s.volume >= 0.0 && s.rest > 0.0 && s.tolerance > 0.0))
      throw std::invalid_argument(
          "division: rest and tolerance must be positive, the volume not negative");
    if (s.maxiter < 1) throw std::invalid_argument("division: maxiter must be at least 1");
  }

  /// What is wrong with the shape of a daughter.
  inline std::string problem(const ConfinedCell &cell, const Daughter &d)
  {
    const std::string fault = check_mesh(d.mesh);
    if (!fault.empty()) return fault;
    const auto &x = d.mesh.nodes;
    for (const auto &q : hinges(d.mesh))
      if (std::fabs(hinge_angle(x[q[0]], x[q[1]], x[q[2]], x[q[3]])) > FOLD)
        return "the surface is folded at the edge between nodes " + std::to_string(q[1] + 1) +
               " and " + std::to_string(q[2] + 1);
    if (d.outside > DIVISION_OUTSIDE * cell.radius())
      return "a node lies " + std::to_string(d.outside / cell.radius()) +
             " radii outside its half of the mother: the half may be too bent or too thin for "
             "the mesh";
    if (d.quality < DIVISION_QUALITY)
      return "a face has collapsed to quality " + std::to_string(d.quality);
    return "";
  }

  /// All numbers of a daughter from its state, and what is wrong with it.
  inline Daughter judge(ConfinedCell &cell, const Eigen::VectorXd &x, const Mesh &round,
                        double wanted, const DivisionSettings &settings, int iterations)
  {
    Daughter d;
    d.mesh.faces = round.faces;
    for (int i = 0; i < int(x.size()); i += 3) d.mesh.nodes.push_back(vec(&x[i]));
    d.l0 = cell.l0;
    d.theta0 = cell.theta0;
    d.iterations = iterations;
    Eigen::VectorXd g;
    d.energy = cell.energy(x, g);
    d.residual = largest_node(g) / cell.force_scale();
    d.volume = cell.enclosed(x);
    d.rest_volume = cell.V0;
    d.pressure = pressure(cell.material.K_V, d.volume, cell.V0);
    d.outside = 0.0;
    for (int i = 0; i < int(d.mesh.nodes.size()); i++)
      for (double depth : cell.depths(x, i)) d.outside = std::max(d.outside, depth);
    d.wall_pressure = cell.material.wall * d.outside;
    d.quality = worst_face(d.mesh);
    d.converged =
        d.residual <= settings.tolerance && std::fabs(d.volume / wanted - 1.0) <= DIVISION_VOLUME;
    d.problem = problem(cell, d);
    return d;
  }

  /// One way to grow a daughter.
  struct Way {
    double rest;     ///< rest factor to grow with, if the one of the settings is larger
    bool release;    ///< give back the rest factor of the settings before the last balance
    double wall;     ///< factor on the stiffness of the walls
    double turn;     ///< angle of the round mesh about the normal of the plane, rad
  };

  /// In the order of the tries. A cortex longer at rest than its half gives room for is compressed
  /// and folds where walls hold it, more so when it grows slowly. It keeps its faces in order if it
  /// grows taut and is released at the end; if it folds even then, the slack is taken up for good.
  /// Thin tips need walls that give way less, and sometimes another mesh.
  constexpr double ASKED = std::numeric_limits<double>::infinity();
  constexpr Way WAYS[] = {{ASKED, false, 1.0, 0.0}, {0.85, true, 1.0, 0.0},
                          {1.0, false, 1.0, 0.0},   {0.9, false, 1.0, 0.0},
                          {ASKED, false, 2.0, 0.0}, {1.0, false, 2.0, 0.6},
                          {0.9, false, 2.0, 1.2}};

  /// Nothing new or nothing to hope for: slack that is not there or far too much of it.
  inline bool pointless(const Way &way, double rest)
  {
    const bool asked = way.release || way.rest == ASKED;
    return asked ? rest > SLACK : rest <= way.rest && way.wall == 1.0;
  }

  inline bool good(const Daughter &d)
  {
    return d.converged && d.problem.empty();
  }

  /// Whether a is the better result of two.
  inline bool better(const Daughter &a, const Daughter &b)
  {
    if (good(a) != good(b)) return good(a);
    if (a.converged != b.converged) return a.converged;
    if (a.problem.empty() != b.problem.empty()) return a.problem.empty();
    return a.quality > b.quality;
  }

  /// One try. round: turned to the plane; inward: its normal points into the half.
  inline Daughter grow_one(const Envelope &mother, const DivisionPlane &inward,
                           const Vec3 &centroid, Mesh round, const DivisionMaterial &material,
                           const DivisionSettings &settings, const Way &way)
  {
    const double wanted = settings.volume, rest = std::min(settings.rest, way.rest);
    ConfinedCell cell(mother, inward, round, material, wanted, rest);
    cell.material.wall *= way.wall;
    const Vec3 center = start_center(mother, inward, centroid, cell.radius());
    const double room = START * clearance(mother, inward, center) / cell.radius();
    const double size = std::clamp(room, 0.05, 1.0);
    Relaxation relaxation(cell, settings, ball(round, center, size * cell.radius()));
    // The balanced state does not depend on the bulk modulus, the way to it does: one far below
    // the stiffness of the walls takes many corrections of V0. V0 of the real one follows from p.
    const double stiff = SOFTEST * cell.material.wall * cell.radius() / 3.0;
    cell.material.K_V = std::max(material.K_V, stiff);
    relaxation.grow(size);
    relaxation.balance(wanted);
    if (way.release && rest < settings.rest) {
      relaxation.release(settings.rest / rest);
      relaxation.balance(wanted);
    }
    const double v = cell.enclosed(relaxation.x), p = pressure(cell.material.K_V, v, cell.V0);
    cell.material.K_V = material.K_V;
    cell.V0 = v * std::exp(p / material.K_V);
    Daughter d = judge(cell, relaxation.x, round, wanted, settings, relaxation.steps);
    d.rest = way.release ? settings.rest : rest;
    return d;
  }

}    // namespace division_detail

/// Area of the faces of a mesh whose edges() have these lengths, um^2. A face whose lengths close
/// to no triangle has none.
inline double rest_area(const Mesh &mesh, const std::vector<double> &l0)
{
  const auto edge = edges(mesh);    // sorted
  auto length2 = [&](int i, int j) {
    const std::array<int, 2> e = {std::min(i, j), std::max(i, j)};
    const double l = l0.at(std::lower_bound(edge.begin(), edge.end(), e) - edge.begin());
    return l * l;
  };
  double sum = 0.0;
  for (const auto &f : mesh.faces) {    // Heron: 16 A^2 = 4 a^2 b^2 - (a^2 + b^2 - c^2)^2
    const double a = length2(f[0], f[1]), b = length2(f[1], f[2]), c = length2(f[2], f[0]);
    sum += 0.25 * std::sqrt(std::max(0.0, 4.0 * a * b - (a + b - c) * (a + b - c)));
  }
  return sum;
}

/// Rest factor (DivisionSettings::rest) a mother hands down: the one with which a round cell of
/// her rest volume has her rest area. Not from mean lengths: at rest in the shape of 3 : 1, her
/// edges are longer by a quarter than those of the round cell of her volume but her surface only
/// by 9 %, and daughters with edges that long have no room for them.
inline double rest_factor(const Mesh &mother, const std::vector<double> &l0, double rest_volume,
                          const Mesh &round)
{
  const double scale = std::cbrt(rest_volume / volume(round));
  return std::sqrt(rest_area(mother, l0) / area(round)) / scale;
}

/// Grow the daughter on one side of the plane (0: where the normal points, 1: the other). round:
/// closed mesh of a unit sphere, e.g. icosphere(2); the daughter keeps its numbering. It is turned
/// by plane_frame(), so that nothing depends on the axes of the simulation and the daughters of a
/// symmetric mother are alike. Without symmetry there are several balanced states close to each
/// other (pressure within some 1 %), among which round-off can choose: the same input gives the
/// same output on one machine, not on all.
/// A result that is not converged or has a `problem` is followed by tries on other ways, some with
/// shorter rest lengths than asked for (Daughter::rest). A rest factor above 1.1 is shortened at
/// once. The best result is returned, after 2 settings.maxiter steps at most: read `converged` and
/// `problem`.
/// Throws std::invalid_argument for values out of range and a plane that leaves the half empty.
inline Daughter grow_daughter(const Envelope &mother, const DivisionPlane &plane, int side,
                              const Mesh &round, const DivisionMaterial &material,
                              const DivisionSettings &settings)
{
  using namespace division_detail;
  check_input(round, material, settings);
  const DivisionPlane inward = {plane.point, side == 0 ? plane.normal : Vec3(-plane.normal)};
  const Half half = positive_half(mother.mesh(), inward);
  const double wanted = settings.volume > 0.0 ? settings.volume : half.volume;
  if (!(half.volume > 0.01 * wanted))
    throw std::invalid_argument("division: the plane leaves a half of " +
                                std::to_string(half.volume) + " um^3 for a daughter of " +
                                std::to_string(wanted) + " um^3");

  DivisionSettings mine = settings;
  mine.volume = wanted;
  Daughter best;
  int used = 0;
  for (const Way &way : WAYS) {
    if (pointless(way, settings.rest)) continue;
    // the same rotation on both sides: an icosphere looks alike from opposite sides
    const Mat3 frame =
        Eigen::AngleAxisd(way.turn, plane.normal) * plane_frame(mother.mesh(), plane.normal);
    Mesh turned = round;
    for (Vec3 &x : turned.nodes) x = frame * x;
    mine.maxiter = std::min(settings.maxiter, 2 * settings.maxiter - used);
    const Daughter d = grow_one(mother, inward, half.centroid, turned, material, mine, way);
    if (used == 0 || better(d, best)) best = d;
    used += d.iterations;
    if (good(best) || used >= 2 * settings.maxiter) break;
  }
  best.iterations = used;
  return best;
}

/// The same for a mother given as a mesh. Build the Envelope once to grow both daughters.
inline Daughter grow_daughter(const Mesh &mother, const DivisionPlane &plane, int side,
                              const Mesh &round, const DivisionMaterial &material,
                              const DivisionSettings &settings)
{
  return grow_daughter(Envelope(mother), plane, side, round, material, settings);
}

}    // namespace dcm

#endif
