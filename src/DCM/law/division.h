// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Division of a deformable cell (S1, "Cell cycle and cell division"). The mother's surface is
// frozen as an envelope and cut by a plane; in each half a round cell grows against envelope and
// plane to force balance with exactly its share of the mother's volume. No physical time passes:
// balance is the minimum of the energy of the simulation's own laws plus that of the walls
// (confined_cell.h), so neither dashpots nor friction play a part. The minimization is in
// relaxation.h; here are the tries, and the judgement of what came out.
//
// Units: lengths um, forces nN, pressures and moduli nN/um^2 (= kPa), energies nN um.

#ifndef DCM_DIVISION_H
#define DCM_DIVISION_H

#include "confined_cell.h"
#include "envelope.h"
#include "hinge.h"
#include "mesh.h"
#include "plane_cut.h"
#include "relaxation.h"
#include "vector.h"
#include "volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace dcm {

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

/// A node farther outside than this fraction of the daughter's radius is a `problem`.
constexpr double DIVISION_OUTSIDE = 0.1;
/// Worse faces (face_quality()) are a `problem`. A triangle stretched by s has 2s/(1 + s^2) of the
/// quality it had; half a mother of 3 : 1 cut lengthwise is 6 : 1, which leaves 0.3. Half of that
/// is no longer a face that follows the shape of the cell but one that has collapsed.
constexpr double DIVISION_QUALITY = 0.15;

namespace division_detail {

  /// Bulk modulus over stiffness of the walls against change of lnV, at least, on the way.
  constexpr double SOFTEST = 0.25;
  /// Rest factors above this leave the cortex slack in nearly any half: it folds whatever the way.
  constexpr double SLACK = 1.1;
  /// A hinge bent farther than this, rad, is a fold: faces lie on each other.
  constexpr double FOLD = 2.6;

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
