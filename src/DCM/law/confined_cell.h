// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// A cell that grows against walls, a closed envelope and a plane that cuts it: its energy and
// forces, those of the simulation's own laws (cortex.h, hinge.h, volume.h) plus those
// of the walls. For the division of cells, see division.h.
//
// Walls are elastic foundations on one side: pressure = wall * depth on the node's share of area,
// towards the nearest wall point, without friction. The share is that of the round rest mesh and
// constant, so that the force is the gradient of an energy. Walls act on nodes: where the envelope
// is concave, the middle of a face can stick out by second order in the edge length.
//
// Units: lengths um, forces nN, pressures and moduli nN/um^2 (= kPa), energies nN um.

#ifndef DCM_CONFINED_CELL_H
#define DCM_CONFINED_CELL_H

#include "cortex.h"
#include "envelope.h"
#include "hinge.h"
#include "mesh.h"
#include "plane_cut.h"
#include "vector.h"
#include "volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace dcm {

/// Elastic constants of a daughter and of the walls it grows against.
struct DivisionMaterial {
  double ks;            ///< cortex spring constant, nN/um (cortex_stiffness())
  double kb;            ///< bending constant, nN um (bending_stiffness())
  double K_V;           ///< bulk modulus, kPa
  double wall = 0.0;    ///< wall pressure per depth, nN/um^3; 0: division_wall()
  bool flat = false;    ///< hinges at rest when flat, not at the angles of the round cell
};

/// Depth at which a wall bears the pressure ks/radius, in units of the daughter's radius.
constexpr double DIVISION_WALL = 1.0 / 60.0;

/// Default wall stiffness, nN/um^3: ks / (DIVISION_WALL r^2), r the radius of a ball of `volume`.
/// A round cell that fills half a ball is stretched by about 9 % and presses with 0.6 to 0.9 ks/r
/// (with 2562 to 162 nodes), so nodes lie less than 0.02 r behind the walls. Stiffer walls are no
/// gain: the corner between plane and envelope, which the round rim leaves empty, then has to be
/// made up by pressure (twice the stiffness: 1.4 times the pressure at 162 nodes).
inline double division_wall(double ks, double volume)
{
  return ks / (DIVISION_WALL * std::pow(ball_radius(volume), 2));
}

/// A cell in one half of an envelope: its energy and forces as a function of the node positions.
class ConfinedCell {
 public:
  /// The cell lives where normal . (x - plane.point) >= 0. round: unit sphere mesh; scaled to
  /// `volume` (um^3) it gives rest angles, shares of area and, times `rest`, the rest lengths.
  /// The envelope must outlive the object.
  ConfinedCell(const Envelope &envelope, const DivisionPlane &plane, const Mesh &round,
               const DivisionMaterial &material, double volume, double rest);

  /// Energy, nN um, and its gradient, nN, at positions (x1 y1 z1 x2 ...), um; infinite with a
  /// zero gradient where the volume is not positive. Not const: it remembers nearest faces.
  double energy(const Eigen::VectorXd &x, Eigen::VectorXd &gradient);

  double enclosed(const Eigen::VectorXd &x) const;    ///< volume, um^3
  /// Depth of point i of x beyond plane and beyond envelope, um, negative inside.
  std::array<double, 2> depths(const Eigen::VectorXd &x, int i) const;
  double radius() const { return size; }    ///< of a ball of the cell's volume, um
  /// Unit of residual forces, nN: pressure ks/radius on the mean share of a node. A residual of
  /// 1e-3 of it is like a pressure wrong by 1e-3 ks/radius, whatever the resolution.
  double force_scale() const { return material.ks / size * mean_share; }

  double V0;                         ///< rest volume, um^3, to be adjusted from outside
  std::vector<double> l0, theta0;    ///< rest lengths (um) and angles (rad)
  DivisionMaterial material;         ///< with its wall stiffness filled in

 private:
  const Envelope &envelope;
  DivisionPlane plane;
  std::vector<std::array<int, 3>> faces;
  std::vector<std::array<int, 2>> edge;
  std::vector<std::array<int, 4>> bend;
  std::vector<double> share;    // of the nodes, um^2
  double size, mean_share;

  // the last query of each node: it stays inside as long as it moves less than its clearance
  struct Query {
    Vec3 at;
    double clearance;
    int face;
  };
  std::vector<Query> query;

  double cortex(const Eigen::VectorXd &x, Eigen::VectorXd &g) const;
  double walls(const Eigen::VectorXd &x, Eigen::VectorXd &g);
};

inline ConfinedCell::ConfinedCell(const Envelope &envelope, const DivisionPlane &plane,
                                  const Mesh &round, const DivisionMaterial &material,
                                  double volume, double rest) :
    V0(volume),
    material(material), envelope(envelope), plane(plane), faces(round.faces), edge(edges(round)),
    bend(hinges(round)), share(round.nodes.size(), 0.0)
{
  size = ball_radius(volume);
  if (material.wall == 0.0) this->material.wall = division_wall(material.ks, volume);
  const double scale = std::cbrt(volume / dcm::volume(round));
  const auto &x = round.nodes;
  for (const auto &e : edge) l0.push_back(rest * scale * (x[e[1]] - x[e[0]]).norm());
  for (const auto &h : bend)
    theta0.push_back(material.flat ? 0.0 : hinge_angle(x[h[0]], x[h[1]], x[h[2]], x[h[3]]));
  for (const auto &f : faces) {
    const double s = scale * scale * face_area_vector(x[f[0]], x[f[1]], x[f[2]]).norm() / 3.0;
    for (int i : f) share[i] += s;
  }
  mean_share = scale * scale * area(round) / double(x.size());
  query.assign(x.size(), {plane.point, 0.0, -1});
}

inline double ConfinedCell::enclosed(const Eigen::VectorXd &x) const
{
  double v = 0.0;
  for (const auto &f : faces)
    v += face_volume(vec(&x[3 * f[0]]) - plane.point, vec(&x[3 * f[1]]) - plane.point,
                     vec(&x[3 * f[2]]) - plane.point);
  return v;
}

inline std::array<double, 2> ConfinedCell::depths(const Eigen::VectorXd &x, int i) const
{
  const Vec3 r = vec(&x[3 * i]);
  return {plane.normal.dot(plane.point - r), envelope.nearest(r, query[i].face).distance};
}

inline double ConfinedCell::cortex(const Eigen::VectorXd &x, Eigen::VectorXd &g) const
{
  double u = 0.0;
  for (size_t n = 0; n < edge.size(); n++) {
    const int i = 3 * edge[n][0], j = 3 * edge[n][1];
    const Vec3 rij = vec(&x[j]) - vec(&x[i]), f = cortex_force(material.ks, l0[n], rij);
    vec(&g[j]) -= f;
    vec(&g[i]) += f;
    u += cortex_energy(material.ks, rij.norm(), l0[n]);
  }
  for (size_t n = 0; n < bend.size(); n++) {
    const auto &q = bend[n];
    const Hinge h = hinge(material.kb, theta0[n], vec(&x[3 * q[0]]), vec(&x[3 * q[1]]),
                          vec(&x[3 * q[2]]), vec(&x[3 * q[3]]));
    vec(&g[3 * q[0]]) -= h.f1;
    vec(&g[3 * q[1]]) -= h.f2;
    vec(&g[3 * q[2]]) -= h.f3;
    vec(&g[3 * q[3]]) -= h.f4;
    u += h.energy;
  }
  return u;
}

inline double ConfinedCell::walls(const Eigen::VectorXd &x, Eigen::VectorXd &g)
{
  double u = 0.0;
  for (size_t i = 0; i < share.size(); i++) {
    const Vec3 r = vec(&x[3 * i]);
    const double stiffness = material.wall * share[i];
    const double beyond = plane.normal.dot(plane.point - r);
    if (beyond > 0.0) {
      u += 0.5 * stiffness * beyond * beyond;
      vec(&g[3 * i]) -= stiffness * beyond * plane.normal;
    }
    Query &last = query[i];
    if ((r - last.at).squaredNorm() < last.clearance * last.clearance) continue;
    const EnvelopePoint p = envelope.nearest(r, last.face);
    last = {r, std::max(0.0, -p.distance), p.face};
    if (p.distance > 0.0) {
      u += 0.5 * stiffness * p.distance * p.distance;
      vec(&g[3 * i]) += stiffness * (r - p.point);    // depth times direction, never divides by it
    }
  }
  return u;
}

inline double ConfinedCell::energy(const Eigen::VectorXd &x, Eigen::VectorXd &gradient)
{
  gradient.setZero(x.size());
  const double v = enclosed(x);
  if (!(v > 0.0)) return std::numeric_limits<double>::infinity();
  const double p = pressure(material.K_V, v, V0);
  for (const auto &f : faces) {
    const auto a = vec(&x[3 * f[0]]), b = vec(&x[3 * f[1]]), c = vec(&x[3 * f[2]]);
    const Vec3 third = face_pressure_force(p, a, b, c);
    for (int i : f) vec(&gradient[3 * i]) -= third;
  }
  const double inside = pressure_energy(material.K_V, v, V0);
  const double elastic = cortex(x, gradient);
  return inside + elastic + walls(x, gradient);
}

}    // namespace dcm

#endif
