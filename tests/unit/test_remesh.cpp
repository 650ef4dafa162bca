// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Remeshing: what stays (numbers, volume, surface, uniform strain, what is bent beyond rest), what
// gets better, and what it keeps its hands off.

#include "law/remesh.h"
#include "bodies.h"
#include "helpers.h"

#include <map>
#include <numeric>
#include <set>

using namespace dcm;
using namespace dcm_test;

namespace {

/// edges shorter by a factor at rest; rest angles as they are, but for what is bent beyond them
RemeshCell cell_of(const Mesh &mesh, double stretch, double bend = 0.0)
{
  RemeshCell cell;
  cell.mesh = mesh;
  for (const auto &h : hinges(mesh)) {
    const auto &x = mesh.nodes;
    cell.l0.push_back((x[h[2]] - x[h[1]]).norm() / stretch);
    cell.theta0.push_back(hinge_angle(x[h[0]], x[h[1]], x[h[2]], x[h[3]]) - bend);
  }
  cell.region.assign(mesh.faces.size(), 0);
  cell.face_class = cell.region;
  cell.pinned.assign(mesh.nodes.size(), 0);
  for (const Vec3 &x : mesh.nodes) cell.v.emplace_back(x[1], x[2], x[0]);
  return cell;
}

/// a ball whose nodes have flowed: sheared, then back on the ball
Mesh flowed(int level, double shear)
{
  return mapped(icosphere(level), [shear](const Vec3 &x) {
    return Vec3(5.0 * Vec3(x[0] + shear * x[1], x[1], x[2]).normalized());
  });
}

Mesh turned(Mesh mesh, const Mat3 &R, const Vec3 &shift)
{
  return mapped(std::move(mesh), [&](const Vec3 &x) {
    return Vec3(R * x + shift);
  });
}

RemeshSettings wanting(double quality)
{
  RemeshSettings set;
  set.quality = quality;
  set.goal = 0.5 * (1.0 + quality);
  set.energy = 10.0;
  return set;
}

/// sum over the edges of length times the angle beyond rest
double bent(const RemeshCell &cell)
{
  double sum = 0.0;
  const auto list = hinges(cell.mesh);
  const auto &x = cell.mesh.nodes;
  for (size_t e = 0; e < list.size(); e++) {
    const auto &h = list[e];
    const double theta = hinge_angle(x[h[0]], x[h[1]], x[h[2]], x[h[3]]);
    sum += (x[h[2]] - x[h[1]]).norm() * std::remainder(theta - cell.theta0[e], 2.0 * PI);
  }
  return sum;
}

/// meshes that want it, of all kinds
std::vector<Mesh> worn()
{
  std::vector<Mesh> list;
  for (const double shear : {1.2, 2.0}) list.push_back(flowed(2, shear));
  list.push_back(flowed(1, 2.0));
  list.push_back(ellipsoid(2, 16, 4, 4));
  list.push_back(ellipsoid(2, 5, 5, 1));
  list.push_back(mapped(flowed(2, 1.5), [](const Vec3 &x) {    // and another shape
    return Vec3(x[0] + 0.3 * x[2], 1.4 * x[1], x[2] * (1.0 + 0.05 * x[0]));
  }));
  Random random(7, 1, 0);
  for (int k = 0; k < 6; k++) {    // nodes scattered along the ball
    const double reach = 0.18 * mean_edge(icosphere(2));
    list.push_back(mapped(icosphere(2), [&](const Vec3 &x) {
      return Vec3(5.0 * (x + reach * random.gaussian_vector()).normalized());
    }));
  }
  return list;
}

}    // namespace

TEST(Remesh, WhatStays)
{
  int better = 0, tried = 0;
  for (const Mesh &mesh : worn()) {
    const auto set = wanting(0.6);
    const RemeshCell cell = cell_of(mesh, 1.1);
    if (worst_face(mesh) >= set.quality) continue;
    if (!check_mesh(mesh).empty() || self_crossing(mesh)[0] >= 0) continue;
    tried++;
    const Remeshed now = remesh(cell, set);
    const Mesh &m = now.cell.mesh;
    ASSERT_EQ(check_mesh(m), "");    // closed, one piece, genus 0, outward
    EXPECT_LT(self_crossing(m)[0], 0);
    EXPECT_EQ(m.nodes.size(), mesh.nodes.size());
    EXPECT_EQ(m.faces.size(), mesh.faces.size());
    EXPECT_NEAR(volume(m), volume(mesh), 1.0e-12 * volume(mesh));
    if (now.flips + now.slides + now.moves == 0) continue;
    better++;
    EXPECT_GT(remesh_need(worst_face(m), longest_edge(m), set),
              remesh_need(worst_face(mesh), longest_edge(mesh), set));
    EXPECT_EQ(now.quality, worst_face(m));

    // the surface, from points all over both
    double far = 0.0;
    const Envelope before(mesh), after(m);
    const auto probe = [&far](const Mesh &from, const Envelope &to) {
      Random random(1, 2, 0);
      for (const auto &f : from.faces)
        for (int k = 0; k < 5; k++) {
          double a = random.uniform(), b = random.uniform();
          if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
          const Vec3 p = from.nodes[f[0]] + a * (from.nodes[f[1]] - from.nodes[f[0]]) +
                         b * (from.nodes[f[2]] - from.nodes[f[0]]);
          far = std::max(far, std::fabs(to.nearest(p).distance));
        }
    };
    probe(m, before);
    probe(mesh, after);
    EXPECT_LT(far, 1.02 * set.distance * mean_edge(mesh));    // it is measured on a grid

    // a uniform strain is one to the last digits; nothing bent beyond rest is bent
    const auto list = edges(m);
    for (size_t e = 0; e < list.size(); e++)
      EXPECT_NEAR((m.nodes[list[e][1]] - m.nodes[list[e][0]]).norm() / now.cell.l0[e], 1.1, 1e-12);
    EXPECT_NEAR(bent(now.cell), 0.0, 1.0e-10);

    // what nothing has happened to has its values to the last bit
    const auto old = hinges(mesh), fresh = hinges(m);
    size_t same = 0;
    for (size_t e = 0; e < fresh.size(); e++) {
      const auto at = std::find(old.begin(), old.end(), fresh[e]);
      bool still = at != old.end();
      for (const int n : fresh[e]) still = still && m.nodes[n] == mesh.nodes[n];
      if (!still) continue;
      same++;
      EXPECT_EQ(now.cell.l0[e], cell.l0[at - old.begin()]);
      EXPECT_EQ(now.cell.theta0[e], cell.theta0[at - old.begin()]);
    }
    for (size_t n = 0; n < m.nodes.size(); n++)
      EXPECT_EQ(now.node_changed[n] != 0, m.nodes[n] != mesh.nodes[n]);
    for (size_t f = 0; f < m.faces.size(); f++)
      if (!now.face_changed[f]) {
        EXPECT_EQ(m.faces[f], mesh.faces[f]);
      }
  }
  EXPECT_GE(tried, 10);
  EXPECT_GE(better, tried - 1);
}

TEST(Remesh, BentBeyondRest)
{
  // the sum of length times angle beyond rest is kept by each operation; the volume that is given
  // back changes lengths by a little
  const Mesh mesh = flowed(2, 1.2);
  const RemeshCell cell = cell_of(mesh, 1.0, 0.2);
  const Remeshed now = remesh(cell, wanting(0.6));
  ASSERT_GT(now.flips, 0);
  EXPECT_NEAR(bent(now.cell), bent(cell), 0.02 * bent(cell));
}

TEST(Remesh, FlipOfTwoFaces)
{
  // two flat faces, one stretched along x by 2 and by nothing across: the rest length of the new
  // diagonal is that of the way across both, by hand
  const double rest = remesh_detail::to_side(2.0, 2.0, 2.0, 0.5);
  EXPECT_NEAR(rest, std::sqrt(3.0), 1e-15);
  const auto square = remesh_detail::diagonal(std::sqrt(2.0), 1.0, 1.0, 1.0, 1.0);
  EXPECT_NEAR(square.t, 0.5, 1e-15);
  EXPECT_NEAR(square.length, std::sqrt(2.0), 1e-15);
  const auto kite = remesh_detail::diagonal(3.0, std::sqrt(5.0), std::sqrt(2.0) * 1.0,
                                            std::sqrt(2.0), std::sqrt(5.0));
  // a = (0, 0), b = (3, 0), c = (2, 1), d = (1, -1)
  EXPECT_NEAR(kite.t, 0.5, 1e-15);
  EXPECT_NEAR(kite.length, std::sqrt(5.0), 1e-14);
}

TEST(Remesh, AffineStrain)
{
  // a flat patch that is stretched by different factors along x and y: every edge of any mesh on it
  // has the rest length of the affine map, to the last digits. A box with walls far away is one
  Random random(4, 4, 0);
  int inside = 0;
  for (int trial = 0; trial < 3; trial++) {
    // top of a thick plate, a grid of 9 x 9 with nodes scattered along it
    const int n = 9;
    Mesh mesh;
    for (const double z : {0.0, 4.0})
      for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
          const bool rim = i == 0 || j == 0 || i == n - 1 || j == n - 1;
          const double a = rim || z == 0.0 ? 0.0 : 0.3;
          mesh.nodes.emplace_back(i + a * (2.0 * random.uniform() - 1.0),
                                  j + a * (2.0 * random.uniform() - 1.0), z);
        }
    auto at = [n](int z, int i, int j) {
      return (z * n + i) * n + j;
    };
    for (int i = 0; i + 1 < n; i++)
      for (int j = 0; j + 1 < n; j++) {
        const int a = at(1, i, j), b = at(1, i + 1, j), c = at(1, i + 1, j + 1),
                  d = at(1, i, j + 1);
        mesh.faces.push_back({a, b, c});
        mesh.faces.push_back({a, c, d});
        const int m = n * n;
        mesh.faces.push_back({a - m, c - m, b - m});
        mesh.faces.push_back({a - m, d - m, c - m});
      }
    for (int i = 0; i + 1 < n; i++)
      for (int side = 0; side < 4; side++) {
        const int p = side == 0   ? at(1, i, 0)
                      : side == 1 ? at(1, n - 1, i)
                      : side == 2 ? at(1, n - 1 - i, n - 1)
                                  : at(1, 0, n - 1 - i);
        const int q = side == 0   ? at(1, i + 1, 0)
                      : side == 1 ? at(1, n - 1, i + 1)
                      : side == 2 ? at(1, n - 2 - i, n - 1)
                                  : at(1, 0, n - 2 - i);
        const int m = n * n;
        mesh.faces.push_back({p - m, q - m, q});
        mesh.faces.push_back({p - m, q, p});
      }
    ASSERT_EQ(check_mesh(mesh), "");
    RemeshCell cell = cell_of(mesh, 1.0);
    const auto rest = [](const Vec3 &d) {
      return Vec3(d[0] / 1.5, d[1] / 0.8, d[2]).norm();
    };
    const auto old = edges(mesh);
    for (size_t e = 0; e < old.size(); e++)
      cell.l0[e] = rest(mesh.nodes[old[e][1]] - mesh.nodes[old[e][0]]);
    // the walls and the rim stay as they are
    for (size_t f = 0; f < mesh.faces.size(); f++)
      for (const int v : mesh.faces[f]) cell.face_class[f] |= mesh.nodes[v][2] < 4.0;
    for (size_t v = 0; v < mesh.nodes.size(); v++) {
      const Vec3 &x = mesh.nodes[v];
      cell.pinned[v] = x[2] < 4.0 || x[0] <= 0.0 || x[1] <= 0.0 || x[0] >= n - 1 || x[1] >= n - 1;
    }
    auto set = wanting(0.7);
    set.longest = 10.0;
    const Remeshed now = remesh(cell, set);
    if (now.flips + now.slides == 0) continue;
    const auto list = edges(now.cell.mesh);
    for (size_t e = 0; e < list.size(); e++) {
      const Vec3 d = now.cell.mesh.nodes[list[e][1]] - now.cell.mesh.nodes[list[e][0]];
      EXPECT_NEAR(now.cell.l0[e], rest(d), 1.0e-12);
    }
    for (size_t v = 0; v < mesh.nodes.size(); v++)
      if (cell.pinned[v]) {
        EXPECT_EQ(now.cell.mesh.nodes[v], mesh.nodes[v]);
      }
    for (size_t f = 0; f < mesh.faces.size(); f++)
      if (cell.face_class[f]) {
        EXPECT_EQ(now.cell.mesh.faces[f], mesh.faces[f]);
      }
    inside += now.flips;
  }
  EXPECT_GT(inside, 10);
}

TEST(Remesh, Ball)
{
  // on a ball all stays near it, and the mesh becomes a good one
  auto set = wanting(0.6);
  set.distance = 0.2;
  const Mesh mesh = flowed(2, 2.0);
  const Remeshed now = remesh(cell_of(mesh, 1.0), set);
  EXPECT_LT(worst_face(mesh), 0.35);
  EXPECT_GT(now.quality, 0.75);
  EXPECT_GT(now.moves, 0);
  double inner = 5.0;    // the worn mesh is a polyhedron whose long faces lie deep inside the ball
  for (const auto &f : mesh.faces) {
    const Vec3 &a = mesh.nodes[f[0]], &b = mesh.nodes[f[1]], &c = mesh.nodes[f[2]];
    inner = std::min(inner, nearest_on_triangle(Vec3::Zero(), a, b, c).norm());
  }
  const double far = set.distance * mean_edge(mesh);
  for (const Vec3 &x : now.cell.mesh.nodes) {
    EXPECT_LT(x.norm(), 5.0 + far);
    EXPECT_GT(x.norm(), inner - far);
  }
  EXPECT_NEAR(now.area, 1.0, 0.03);

  // velocities of new nodes lie between: here linear in the place, so that they are those of it,
  // but for what they have moved off the edge and slid
  for (size_t n = 0; n < now.cell.v.size(); n++) EXPECT_LT(now.cell.v[n].norm(), 5.0 + 1e-9);
}

TEST(Remesh, GoodMeshIsLeftAlone)
{
  for (const Mesh &mesh : {ball(1, 5.0), ball(3, 5.0), ellipsoid(2, 6, 5, 4), dented(2, 5.0)}) {
    const RemeshSettings set;
    ASSERT_GE(worst_face(mesh), set.quality);
    const Remeshed now = remesh(cell_of(mesh, 1.2), set);
    EXPECT_EQ(now.flips + now.slides + now.moves, 0);
    EXPECT_EQ(now.cell.mesh.nodes, mesh.nodes);
    EXPECT_EQ(now.cell.mesh.faces, mesh.faces);
  }
  // nor is one that has just been remeshed
  auto set = wanting(0.6);
  set.distance = 0.2;
  const Remeshed once = remesh(cell_of(flowed(2, 2.0), 1.0), set);
  ASSERT_GE(once.quality, set.quality);
  const Remeshed twice = remesh(once.cell, set);
  EXPECT_EQ(twice.flips + twice.slides + twice.moves, 0);
}

TEST(Remesh, TurnedAndRenumbered)
{
  // no two edges are alike, so that none of two equal gains is first by round-off
  Random random(11, 1, 0);
  const Mesh mesh = mapped(flowed(2, 1.3), [&random](const Vec3 &x) {
    return Vec3(x + 0.03 * random.gaussian_vector());
  });
  const auto set = wanting(0.6);
  const Remeshed one = remesh(cell_of(mesh, 1.1), set);
  ASSERT_GT(one.flips, 0);
  const Mat3 R = random_rotation(random);
  const Vec3 shift(3.0, -2.0, 1.0);
  const Remeshed other = remesh(cell_of(turned(mesh, R, shift), 1.1), set);
  EXPECT_EQ(other.flips, one.flips);
  EXPECT_EQ(other.cell.mesh.faces, one.cell.mesh.faces);
  for (size_t n = 0; n < mesh.nodes.size(); n++)
    EXPECT_LT((other.cell.mesh.nodes[n] - R * one.cell.mesh.nodes[n] - shift).norm(), 1.0e-9);

  // nodes in another order: another way, the same good
  Mesh mixed = mesh;
  std::vector<int> to(mesh.nodes.size());
  std::iota(to.begin(), to.end(), 0);
  for (size_t n = to.size() - 1; n > 0; n--)
    std::swap(to[n], to[size_t(random.uniform() * double(n))]);
  for (size_t n = 0; n < to.size(); n++) mixed.nodes[to[n]] = mesh.nodes[n];
  for (auto &f : mixed.faces)
    for (int &v : f) v = to[v];
  const Remeshed third = remesh(cell_of(mixed, 1.1), set);
  EXPECT_GE(third.quality, 0.9 * one.quality);
  EXPECT_NEAR(third.area, one.area, 0.01);
}

TEST(Remesh, ClassesRegionsAndPinnedNodes)
{
  const Mesh mesh = flowed(2, 1.3);
  RemeshCell cell = cell_of(mesh, 1.0);
  for (size_t f = 0; f < mesh.faces.size(); f++) {
    const auto &t = mesh.faces[f];
    const Vec3 mid = mesh.nodes[t[0]] + mesh.nodes[t[1]] + mesh.nodes[t[2]];
    cell.face_class[f] = mid[2] > 0.0;
    cell.region[f] = mid[0] > 0.0;
  }
  for (size_t n = 0; n < mesh.nodes.size(); n += 5) cell.pinned[n] = 1;
  const Remeshed now = remesh(cell, wanting(0.6));
  ASSERT_GT(now.flips + now.slides, 0);
  double area_before = 0.0, area_after = 0.0, region_before = 0.0, region_after = 0.0;
  const auto piece = [](const Mesh &m, size_t f) {
    const auto &t = m.faces[f];
    return 0.5 * (m.nodes[t[1]] - m.nodes[t[0]]).cross(m.nodes[t[2]] - m.nodes[t[0]]).norm();
  };
  // the border of the classes has the same edges
  std::set<std::array<int, 2>> border[2];
  for (const Mesh *m : {&mesh, &now.cell.mesh}) {
    std::map<std::array<int, 2>, int> side;
    for (size_t f = 0; f < m->faces.size(); f++)
      for (int k = 0; k < 3; k++)
        side[{m->faces[f][k], m->faces[f][(k + 1) % 3]}] = cell.face_class[f];
    for (const auto &it : side)
      if (it.second && !side[{it.first[1], it.first[0]}]) border[m == &mesh].insert(it.first);
  }
  EXPECT_EQ(border[0], border[1]);
  for (size_t f = 0; f < mesh.faces.size(); f++) {
    area_before += cell.face_class[f] * piece(mesh, f);
    area_after += cell.face_class[f] * piece(now.cell.mesh, f);
    region_before += cell.region[f] * piece(mesh, f);
    region_after += now.cell.region[f] * piece(now.cell.mesh, f);
  }
  EXPECT_NEAR(area_after, area_before, 0.03 * area_before);
  EXPECT_NEAR(region_after, region_before, 0.1 * region_before);
  for (size_t n = 0; n < mesh.nodes.size(); n++)
    if (cell.pinned[n]) {
      EXPECT_EQ(now.cell.mesh.nodes[n], mesh.nodes[n]);
    }
}

TEST(Remesh, AsFarAsItMay)
{
  // the less the surface may move, the less is done, and never more than allowed
  const Mesh mesh = flowed(2, 1.6);
  for (const double distance : {0.01, 0.03, 0.1, 0.3}) {
    auto set = wanting(0.6);
    set.distance = distance;
    const Remeshed now = remesh(cell_of(mesh, 1.0), set);
    EXPECT_LE(now.distance, distance);
    EXPECT_GE(now.quality, now.quality_before);
  }
}

TEST(Remesh, EnergyChangesByNoMore)
{
  // stretched along x and pressed along y: springs of one constant cannot have the same
  // energy on another mesh
  Mesh mesh = ball(2, 5.0);
  RemeshCell cell = cell_of(mesh, 1.0);
  cell.mesh = mapped(mesh, [](const Vec3 &x) {
    return Vec3(2.2 * x[0], 0.6 * x[1], x[2]);
  });
  auto set = wanting(0.6);
  ASSERT_LT(worst_face(cell.mesh), set.quality);
  set.energy = 10.0;
  const Remeshed free = remesh(cell, set);
  const double change = std::fabs(free.energy / free.energy_before - 1.0);
  ASSERT_GT(free.flips, 0);
  ASSERT_GT(change, 0.02);
  set.energy = 1.01 * change;
  EXPECT_EQ(remesh(cell, set).flips, free.flips);
  for (const double part : {0.99, 0.5, 0.1}) {
    set.energy = part * change;
    const Remeshed now = remesh(cell, set);
    EXPECT_LE(std::fabs(now.energy / now.energy_before - 1.0), set.energy);
  }
}

TEST(Remesh, LoadIsCarried)
{
  // a stretched cell: the springs have the same virial on the other mesh, and what is far from all
  // changes has its rest lengths
  RemeshCell cell = cell_of(ball(2, 5.0), 1.0);
  cell.mesh = mapped(cell.mesh, [](const Vec3 &x) {
    return Vec3(2.2 * x[0], 0.75 * x[1] + 0.5 * x[0], x[2]);
  });
  auto set = wanting(0.55);
  set.goal = 0.6;
  ASSERT_LT(worst_face(cell.mesh), set.quality);
  const Remeshed strain = remesh(cell, set);
  ASSERT_GT(strain.flips, 0);
  set.load = true;
  const Remeshed load = remesh(cell, set);
  ASSERT_EQ(load.cell.mesh.faces, strain.cell.mesh.faces);
  const Mat3 before = remesh_detail::spring_virial(cell.mesh, cell.l0);
  const auto lacks = [&before](const Remeshed &now) {
    return (remesh_detail::spring_virial(now.cell.mesh, now.cell.l0) - before).norm() /
           before.norm();
  };
  EXPECT_LT(lacks(load), 1.0e-12);
  EXPECT_GT(lacks(strain), 1.0e-3);
  size_t same = 0;
  for (size_t e = 0; e < load.cell.l0.size(); e++) same += load.cell.l0[e] == strain.cell.l0[e];
  EXPECT_GT(same, 0u);
  EXPECT_LT(same, load.cell.l0.size());
}
