// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Relaxation of a daughter (division.h): a ball grows between envelope and plane to full size, then
// its rest volume is corrected until force balance comes with exactly the wanted volume. Works on
// a ConfinedCell; minimizer: lbfgs.h.
//
// Units: lengths um, forces nN, pressures and moduli nN/um^2 (= kPa), energies nN um.

#ifndef DCM_RELAXATION_H
#define DCM_RELAXATION_H

#include "confined_cell.h"
#include "envelope.h"
#include "lbfgs.h"
#include "mesh.h"
#include "plane_cut.h"
#include "vector.h"
#include "volume.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace dcm {

/// What a daughter has to reach.
struct DivisionSettings {
  double volume = 0.0;    ///< wanted volume, um^3; 0: that of its half of the envelope
  double rest = 1.0;      ///< rest length of edges over their length in the round cell of `volume`
  double tolerance = 1.0e-3;    ///< largest nodal force left, over ConfinedCell::force_scale()
  int maxiter = 4000;           ///< minimization steps, all volume corrections together
};

/// Relative accuracy of a converged daughter's volume.
constexpr double DIVISION_VOLUME = 1.0e-6;

namespace division_detail {

  /// Radius of the first ball over its distance to the walls.
  constexpr double START = 0.9;
  /// Growth of radius and rest lengths per stage, and forces over the tolerance that end a stage.
  constexpr double STAGE = 1.25, ROUGH = 100.0;
  /// First trial of a line search: a node moves at most this fraction of the mean rest length.
  constexpr double MOVE = 0.25;
  /// Volume correction begins once the forces are below this multiple of the tolerance.
  constexpr double LOOSE = 10.0;
  /// Relative volume error that may be removed by scaling.
  constexpr double SCALED = 1.0e-3;
  /// Volume corrections at most; four or five are usual.
  constexpr int CORRECTIONS = 50;
  /// Growth of rest lengths per stage when a cell that grew with short ones is released.
  constexpr double RELEASE = 1.05;

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

}    // namespace division_detail

}    // namespace dcm

#endif
