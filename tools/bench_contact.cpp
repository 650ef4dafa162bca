// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Time per face pair of the contact kernel, in ns. Build from the root of the repository:
//   g++ -std=c++17 -O3 -march=native -I/usr/include/eigen3 -Isrc/DCM tools/bench_contact.cpp
// "in contact": pairs with a result, of two rotated icospheres; "near": pairs as a neighbor list
// offers them, within contact range plus skin but without contact; "all near": both together.

#include <algorithm>
#include <ctime>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "law/contact.h"
#include "law/mesh.h"

using namespace dcm;

namespace {

struct Scene {
  std::vector<FaceGeometry> f, g;
  std::vector<std::pair<int, int>> contact, rejected, near;
};

std::vector<FaceGeometry> sphere(int level, double R, const Eigen::Quaterniond &q, const Vec3 &x)
{
  const Mesh mesh = icosphere(level);
  std::vector<FaceGeometry> out;
  for (const auto &t : mesh.faces) {
    Vec3 v[3];
    for (int k = 0; k < 3; k++) v[k] = q * (R * mesh.nodes[t[k]]) + x;
    out.push_back(make_face(v[0], v[1], v[2], R));
  }
  return out;
}

template <class State> Scene make_scene(int level, const ContactMaterial &mat, double overlap)
{
  const double R = 6.0;
  Scene s;
  s.f = sphere(level, R, Eigen::Quaterniond(0.3, 0.5, -0.2, 0.7).normalized(), Vec3::Zero());
  s.g = sphere(level, R, Eigen::Quaterniond(0.9, -0.1, 0.4, 0.2).normalized(),
               Vec3(0.3, -0.2, 0.9).normalized() * (2.0 * R - overlap));
  ContactResult r;
  for (int i = 0; i < static_cast<int>(s.f.size()); i++)
    for (int j = 0; j < static_cast<int>(s.g.size()); j++) {
      const double range = s.f[i].reach + s.g[j].reach + mat.h0 + 0.3;
      if ((s.f[i].mid - s.g[j].mid).norm() > range) continue;
      s.near.emplace_back(i, j);
      if (face_face<State>(s.f[i], s.g[j], mat, 2, r))
        s.contact.emplace_back(i, j);
      else
        s.rejected.emplace_back(i, j);
    }
  return s;
}

template <class State>
double time_pairs(const Scene &s, const std::vector<std::pair<int, int>> &pairs,
                  const ContactMaterial &mat, int npoints)
{
  if (pairs.empty()) return 0.0;
  ContactResult r;
  double best = 1e30, sink = 0.0;
  for (int rep = 0; rep < 6; rep++) {
    const int loops = 1 + 20000 / static_cast<int>(pairs.size());
    const std::clock_t start = std::clock();
    for (int l = 0; l < loops; l++)
      for (const auto &p : pairs)
        if (face_face<State>(s.f[p.first], s.g[p.second], mat, npoints, r)) sink += r.wf[0];
    const double t = 1e9 * double(std::clock() - start) / CLOCKS_PER_SEC;
    best = std::min(best, t / loops / pairs.size());
  }
  volatile double keep = sink;
  (void) keep;
  return best;
}

template <class State>
void report(const char *name, int level, const ContactMaterial &mat, double overlap)
{
  const Scene s = make_scene<State>(level, mat, overlap);
  std::printf("%-7s level %d overlap %.2f: in contact %5.0f %5.0f %5.0f (1-3 points, %zu pairs) | "
              "near, none %4.0f (%zu) | all near %4.0f\n",
              name, level, overlap, time_pairs<State>(s, s.contact, mat, 1),
              time_pairs<State>(s, s.contact, mat, 2), time_pairs<State>(s, s.contact, mat, 3),
              s.contact.size(), time_pairs<State>(s, s.rejected, mat, 2), s.rejected.size(),
              time_pairs<State>(s, s.near, mat, 2));
}

}    // namespace

int main()
{
  ContactMaterial mat;    // um, nN, kPa
  mat.E = 5.0;
  mat.W = 0.1;
  for (double h0 : {0.02, 0.1}) {
    mat.h0 = h0;
    std::printf("h0 = %g um\n", h0);
    for (int level : {2, 3})
      for (double overlap : {0.1, 1.5}) {
        report<DmtState>("dmt", level, mat, overlap);
        report<MaugisState>("maugis", level, mat, overlap);
      }
  }
}
