// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Rest state that a mother hands down to her daughters: one factor on the rest lengths of a round
// cell, from the area her surface has when all its edges are at rest. Lengths um.

#ifndef DCM_REST_STATE_H
#define DCM_REST_STATE_H

#include "mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace dcm {

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

}    // namespace dcm

#endif
