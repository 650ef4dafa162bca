// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Cells whose shape is a function of time, and tracers to fill them, for the tests of tracers and
// of voxels.

#ifndef DCM_TEST_MOVING_CELLS_H
#define DCM_TEST_MOVING_CELLS_H

#include "law/mesh.h"
#include "law/random.h"
#include "law/solid_angle.h"
#include "law/tracer.h"
#include "helpers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace dcm_test {

using namespace dcm;

constexpr double R = 6.0;

// Cells made of icospheres turned at random (no face lies along an axis), whose shape is a function
// of the direction from the center and of time. Cell IDs from 1.

struct Scene {
  using Faces = std::vector<TracerFace>;
  using Shape = std::function<Vec3(int cell, const Vec3 &u, double t)>;

  Faces faces;
  std::vector<std::array<int, 3>> corners;
  std::vector<Vec3> direction, node;
  std::vector<int> cell_of_node, first_face;
  Shape shape;
  double edge = 0.0;

  Scene(int ncells, int level, std::uint64_t seed, Shape _shape) : shape(std::move(_shape))
  {
    const auto mesh = dcm::icosphere(level);
    for (int c = 0; c < ncells; c++) {
      Random random(seed, c, 0);
      const dcm::Mat3 turn = dcm_test::random_rotation(random);
      const int offset = int(direction.size());
      for (const Vec3 &x : mesh.nodes) {
        direction.push_back(turn * x);
        cell_of_node.push_back(c);
      }
      first_face.push_back(int(faces.size()));
      for (const auto &f : mesh.faces) {
        TracerFace face;
        face.cell = c + 1;
        face.tag = std::int64_t(faces.size()) + 1;
        face.known = true;
        faces.push_back(face);
        corners.push_back({offset + f[0], offset + f[1], offset + f[2]});
      }
    }
    first_face.push_back(int(faces.size()));
    node.assign(direction.size(), Vec3::Zero());
    place(0.0);
    for (const auto &f : faces) edge += (f.corner[1] - f.corner[0]).norm() / double(faces.size());
  }

  // returns the largest displacement of a node
  double place(double t)
  {
    double most = 0.0;
    for (size_t i = 0; i < node.size(); i++) {
      const Vec3 y = shape(cell_of_node[i], direction[i], t);
      most = std::max(most, (y - node[i]).norm());
      node[i] = y;
    }
    for (size_t f = 0; f < faces.size(); f++) {
      for (int k = 0; k < 3; k++) faces[f].corner[k] = node[corners[f][k]];
      faces[f].measure();
    }
    return most;
  }

  double winding(int cell, const Vec3 &x) const
  {
    double sum = 0.0;
    for (int f = first_face[cell - 1]; f < first_face[cell]; f++)
      sum += dcm::face_winding(x, faces[f].corner[0], faces[f].corner[1], faces[f].corner[2]);
    return sum;
  }

  // a tracer at home, or outside all cells
  bool wrong(const Tracer &t) const
  {
    if (t.home != Tracer::OUTSIDE) return winding(int(t.home), t.x) < 0.5;
    for (int c = 1; c < int(first_face.size()); c++)
      if (winding(c, t.x) > 0.5) return true;
    return false;
  }

  // radial coordinate: 1 on the surface of a star-shaped cell of planar faces around the origin
  double lambda(const Vec3 &x) const
  {
    double most = 0.0;
    for (const auto &f : faces) most = std::max(most, x.dot(f.normal) / f.mid.dot(f.normal));
    return most;
  }
};

using Walk = dcm::TracerWalk<Scene::Faces>;

inline Vec3 round_cell(int, const Vec3 &u, double)
{
  return R * u;
}

inline double bumps(int c, const Vec3 &u, double t, double height, double rate)
{
  return height * (std::sin(5.0 * u[0] + 3.0 * u[1] + rate * t + c) *
                       std::cos(4.0 * u[2] - 2.0 * u[0] + 0.7 * rate * t) +
                   0.6 * std::sin(7.0 * u[1] - 3.0 * u[2] + 1.3 * rate * t + 2.0 * c));
}

inline Vec3 step(int tag, std::int64_t n, double rms)
{
  Random random(1, tag, n, RandomPurpose::TRACER);
  return rms / std::sqrt(3.0) * random.gaussian_vector();
}

inline std::vector<Tracer> filled(int number)
{
  std::vector<Tracer> tracers(number);
  Random random(9, 1, 1);
  for (Tracer &t : tracers) {
    t.x = 0.93 * R * std::cbrt(random.uniform()) * random.unit_vector();
    t.home = 1;
  }
  return tracers;
}

}    // namespace dcm_test

#endif
