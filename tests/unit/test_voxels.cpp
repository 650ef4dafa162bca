// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// law/voxels.h: lists of near faces against all faces, and memory.

#include "law/voxels.h"
#include "moving_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace dcm_test;

// Every face within the range of a point is in the list of its voxel, whatever the voxel's edge.
TEST(Voxels, ListsHoldAllFacesInRange)
{
  Scene scene(2, 2, 3, [](int c, const Vec3 &u, double) {
    return Vec3(R * u + Vec3(10.0 * c, 1.0, -2.0));
  });
  Random random(4, 0, 0);
  for (const double voxel : {0.4, 1.1, 5.0}) {
    Voxels voxels;
    voxels.build(scene.faces, voxel, 0.9);
    for (int n = 0; n < 2000; n++) {
      const Vec3 x(-8.0 + 26.0 * random.uniform(), -7.0 + 16.0 * random.uniform(),
                   -10.0 + 16.0 * random.uniform());
      const auto list = voxels.at(x);
      for (int f = 0; f < int(scene.faces.size()); f++)
        if ((x - scene.faces[f].nearest(x)).norm() <= 0.9) {
          ASSERT_TRUE(std::binary_search(list.begin(), list.end(), f));
        }
    }
  }
  Scene::Faces none;
  Voxels voxels;
  voxels.build(none, 1.0, 1.0);
  EXPECT_TRUE(voxels.at(Vec3(0.0, 0.0, 0.0)).empty());
}

// Two cells that are a thousand voxels apart do not fill memory with what is between.
TEST(Voxels, FarApart)
{
  Scene scene(2, 1, 3, [](int c, const Vec3 &u, double) {
    return Vec3(R * u + Vec3::Constant(3.0e3 * c));
  });
  Voxels voxels;
  voxels.build(scene.faces, 0.5, 1.0);
  EXPECT_LT(voxels.memory_usage(), 1.0e8);
  EXPECT_FALSE(voxels.at(scene.faces.back().mid).empty());
}
