// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Rest area and rest factor that a mother hands down, against the areas they stand for.

#include "law/rest_state.h"
#include "bodies.h"
#include "helpers.h"

using namespace dcm;
using namespace dcm_test;

TEST(RestState, RestFactor)
{
  // lengths of the mesh itself, times the prestress, whatever her resolution and rest volume
  for (int level : {1, 2, 3}) {
    const Mesh round = icosphere(2);
    for (const Mesh &mother : {ball(level, 6.0), ellipsoid(level, 12, 4, 4)}) {
      std::vector<double> l0;
      for (const auto &e : edges(mother))
        l0.push_back(0.95 * (mother.nodes[e[1]] - mother.nodes[e[0]]).norm());
      EXPECT_NEAR(rest_area(mother, l0), 0.95 * 0.95 * area(mother), 1.0e-10 * area(mother));
      const double rest = rest_factor(mother, l0, volume(mother), round);
      EXPECT_GT(rest, 0.93);
      EXPECT_LT(rest, 1.05);
      EXPECT_NEAR(rest_factor(mother, l0, 8.0 * volume(mother), round), 0.5 * rest, 1.0e-12);
    }
    std::vector<double> l0(edges(round).size(), 1.0);
    EXPECT_NEAR(rest_area(round, l0), double(round.faces.size()) * std::sqrt(0.1875), 1.0e-10);
    l0[0] = 3.0;    // longer than a way around: its two faces count for nothing
    EXPECT_NEAR(rest_area(round, l0), double(round.faces.size() - 2) * std::sqrt(0.1875), 1.0e-10);
  }
}
