// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Division: plane cuts against closed forms, the envelope against brute force, and daughters
// against force balance, exact volumes, symmetry and rotation.

#include "law/division.h"
#include "helpers.h"

#include <functional>

using namespace dcm;
using namespace dcm_test;

namespace {

// hepatoblast of the bile-duct scene: E_cor 5 kPa, h_cor 0.5 um, K_V 2.5 kPa
const DivisionMaterial HEPATOBLAST = {cortex_stiffness(5.0, 0.5, CortexStiffness::AREA),
                                      bending_stiffness(5.0, 0.5), 2.5};

Mesh mapped(Mesh m, const std::function<Vec3(const Vec3 &)> &map)
{
  for (Vec3 &x : m.nodes) x = map(x);
  return m;
}

Mesh ball(int level, double R)
{
  return mapped(icosphere(level), [=](const Vec3 &x) {
    return Vec3(R * x);
  });
}

Mesh ellipsoid(int level, double a, double b, double c)
{
  return mapped(icosphere(level), [=](const Vec3 &x) {
    return Vec3(a * x[0], b * x[1], c * x[2]);
  });
}

// a ball with a deep dent around a direction
Mesh dented(int level, double R, const Vec3 &at = Vec3(1, 2, 2) / 3.0)
{
  return mapped(icosphere(level), [=](const Vec3 &x) {
    return Vec3(R * (1.0 - 0.5 * std::exp((x.dot(at) - 1.0) / 0.15)) * x);
  });
}

// concave and convex edges of any kind: radius scattered from node to node
Mesh spiky(int level)
{
  Random random(3, level, 0);
  return mapped(icosphere(level), [&](const Vec3 &x) {
    return Vec3((1.0 + 1.5 * random.uniform()) * x);
  });
}

Mesh box(double a, double b, double c)
{
  Mesh m;
  for (int i = 0; i < 8; i++) m.nodes.emplace_back(a * (i & 1), b * ((i >> 1) & 1), c * (i >> 2));
  m.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

DivisionPlane flipped(const DivisionPlane &p)
{
  return {p.point, -p.normal};
}

// distance to a triangle, independent of the header: the foot of the normal if all three sides
// have it on their inner side, otherwise the nearest of all three segments
double triangle_distance(const Vec3 &x, const std::array<Vec3, 3> &t)
{
  const Vec3 m = (t[1] - t[0]).cross(t[2] - t[0]);
  bool inside = true;
  double d = 1.0e300;
  for (int k = 0; k < 3; k++) {
    const Vec3 e = t[(k + 1) % 3] - t[k], p = x - t[k];
    inside = inside && m.dot(e.cross(p)) >= 0.0;
    d = std::min(d, (p - std::clamp(p.dot(e) / e.squaredNorm(), 0.0, 1.0) * e).norm());
  }
  return inside ? std::fabs((x - t[0]).dot(m)) / m.norm() : d;
}

// signed distance by brute force; the sign from the solid angle of all faces (4 pi or 0)
double brute_distance(const Mesh &mesh, const Vec3 &x)
{
  double d = 1.0e300, angle = 0.0;
  for (const auto &f : mesh.faces) {
    const std::array<Vec3, 3> t = {mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]};
    d = std::min(d, triangle_distance(x, t));
    const Vec3 a = t[0] - x, b = t[1] - x, c = t[2] - x;
    angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return angle > 2.0 * PI ? -d : d;
}

double radius(double volume)
{
  return std::cbrt(3.0 * volume / (4.0 * PI));
}

// both daughters of a mother, checked for everything that holds for any of them
std::array<Daughter, 2> divide(const Mesh &mother, const Vec3 &normal, int level, double outside,
                               double quality)
{
  const DivisionPlane plane = halving_plane(mother, normal);
  const Envelope envelope(mother);
  std::array<Daughter, 2> pair;
  double sum = 0.0;
  for (int side : {0, 1}) {
    Daughter &d = pair[side];
    d = grow_daughter(envelope, plane, side, icosphere(level), HEPATOBLAST, DivisionSettings());
    EXPECT_TRUE(d.converged) << d.residual;
    EXPECT_EQ(d.problem, "");
    EXPECT_EQ(check_mesh(d.mesh), "");
    EXPECT_LE(d.residual, 1.0e-3);
    EXPECT_NEAR(volume(d.mesh), 0.5 * volume(mother), 1.0e-5 * volume(mother));
    EXPECT_NEAR(pressure(HEPATOBLAST.K_V, volume(d.mesh), d.rest_volume), d.pressure, 1.0e-6);
    EXPECT_GT(d.pressure, 0.0);
    EXPECT_LT(d.outside, outside * radius(d.volume));
    EXPECT_GT(worst_face(d.mesh), quality);
    // outside, once more by brute force
    double depth = 0.0;
    for (const Vec3 &x : d.mesh.nodes) {
      const double beyond = (side ? 1.0 : -1.0) * plane.normal.dot(x - plane.point);
      depth = std::max({depth, beyond, brute_distance(mother, x)});
    }
    EXPECT_NEAR(d.outside, depth, 1.0e-9);
    sum += volume(d.mesh);
  }
  EXPECT_NEAR(sum, volume(mother), 1.0e-3 * volume(mother));
  return pair;
}

void expect_twins(const std::array<Daughter, 2> &pair)
{
  EXPECT_NEAR(pair[0].pressure, pair[1].pressure, 1.0e-3 * pair[0].pressure);
  EXPECT_NEAR(pair[0].energy, pair[1].energy, 1.0e-3 * pair[0].energy);
}

}    // namespace

TEST(DivisionPlane, CutsOfABox)
{
  const Mesh cube = box(1, 1, 1);
  Half h = positive_half(cube, {Vec3(0.3, 9, 9), Vec3::UnitX()});
  EXPECT_NEAR(h.volume, 0.7, 1.0e-14);
  EXPECT_LT((h.centroid - Vec3(0.65, 0.5, 0.5)).norm(), 1.0e-14);
  // a corner: tetrahedron of volume 1/48 with its centroid at 1/8 on each axis
  h = positive_half(cube, {Vec3(0.5, 0, 0), -Vec3(1, 1, 1).normalized()});
  EXPECT_NEAR(h.volume, 1.0 / 48.0, 1.0e-15);
  EXPECT_LT((h.centroid - Vec3::Constant(0.125)).norm(), 1.0e-14);
  // beside the body, and through a face of it
  EXPECT_EQ(positive_half(cube, {Vec3(2, 0, 0), Vec3::UnitX()}).volume, 0.0);
  EXPECT_NEAR(positive_half(cube, {Vec3(-1, 0, 0), Vec3::UnitX()}).volume, 1.0, 1.0e-15);
  EXPECT_NEAR(positive_half(cube, {Vec3(0, 0, 0), Vec3::UnitX()}).volume, 1.0, 1.0e-15);
}

TEST(DivisionPlane, HalvesInClosedForm)
{
  EXPECT_NEAR(halving_plane(box(3, 2, 1), Vec3(0, 5, 0)).point[1], 1.0, 1.0e-13);
  // above height z of a unit tetrahedron lies (1 - z)^3 of it: its centroid (1/4) does not halve it
  Mesh tetrahedron;
  tetrahedron.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_NEAR(halving_plane(tetrahedron, Vec3::UnitZ()).point[2], 1.0 - std::cbrt(0.5), 1.0e-13);
  EXPECT_THROW(halving_plane(tetrahedron, Vec3::Zero()), std::invalid_argument);
  EXPECT_THROW(halving_plane(Mesh(), Vec3::UnitX()), std::invalid_argument);
}

TEST(DivisionPlane, HalvesAnyBody)
{
  Random random(71, 0, 0);
  for (const Mesh &body :
       {icosphere(2), ellipsoid(3, 3, 1, 2), box(1, 2, 5), dented(3, 6), spiky(2)})
    for (int i = 0; i < 5; i++) {
      const Mat3 R = random_rotation(random);
      const Vec3 shift = 100.0 * random.gaussian_vector();
      const Mesh m = mapped(body, [&](const Vec3 &x) {
        return Vec3(R * x + shift);
      });
      const DivisionPlane p = halving_plane(m, 3.0 * random.unit_vector());
      EXPECT_NEAR(p.normal.norm(), 1.0, 1.0e-15);
      const Half a = positive_half(m, p), b = positive_half(m, flipped(p));
      const double V = volume(m);
      EXPECT_NEAR(a.volume, b.volume, 1.0e-10 * V);
      EXPECT_NEAR(a.volume + b.volume, V, 1.0e-12 * V);
      // the plane moves with the body
      const DivisionPlane q = halving_plane(body, R.transpose() * p.normal);
      EXPECT_NEAR(p.normal.dot(R * q.point + shift - p.point), 0.0, 1.0e-9);
    }
}

TEST(DivisionPlane, CentroidOfHalfABall)
{
  double last = 1.0;
  for (int level = 1; level <= 4; level++) {
    const Mesh m = ball(level, 4.0);
    const DivisionPlane p = halving_plane(m, Vec3(1, 2, 3));
    const Half h = positive_half(m, p);
    const double error = (h.centroid - 1.5 * p.normal).norm() / 1.5;
    EXPECT_LT(error, 0.5 * std::pow(mean_edge(m) / 4.0, 2));
    EXPECT_LT(error, 0.4 * last);    // second order in the edge
    last = error;
  }
}

TEST(DivisionPlane, LongAxis)
{
  Random random(72, 0, 0);
  const Mesh body = ellipsoid(2, 1, 1.5, 3);
  for (int i = 0; i < 20; i++) {
    const Mat3 R = random_rotation(random);
    const Vec3 shift = 10.0 * random.gaussian_vector();
    Mesh m = mapped(body, [&](const Vec3 &x) {
      return Vec3(R * x + shift);
    });
    const Vec3 axis = long_axis(m);
    EXPECT_NEAR(axis.norm(), 1.0, 1.0e-14);
    EXPECT_NEAR(std::fabs(axis.dot(R.col(2))), 1.0, 1.0e-12);
    int largest;
    axis.cwiseAbs().maxCoeff(&largest);
    EXPECT_GT(axis[largest], 0.0);
    // numbering of nodes and faces
    const int n = int(m.nodes.size());
    std::reverse(m.nodes.begin(), m.nodes.end());
    for (auto &f : m.faces) f = {n - 1 - f[1], n - 1 - f[2], n - 1 - f[0]};
    std::reverse(m.faces.begin(), m.faces.end());
    EXPECT_LT((long_axis(m) - axis).norm(), 1.0e-10);
  }
  // of the volume, not of the nodes: a box with all its mesh in one corner would mislead those
  EXPECT_LT((long_axis(box(1, 3, 2)) - Vec3::UnitY()).norm(), 1.0e-12);
}

TEST(Envelope, ClosedForms)
{
  const Envelope cube(box(1, 1, 1));
  const double s3 = std::sqrt(3.0), s2 = std::sqrt(2.0);
  EXPECT_NEAR(cube.nearest(Vec3(0.5, 0.5, 0.8)).distance, -0.2, 1.0e-15);
  EXPECT_NEAR(cube.nearest(Vec3(2, 2, 2)).distance, s3, 1.0e-15);
  EXPECT_NEAR(cube.nearest(Vec3(0.4, 2, -1)).distance, s2, 1.0e-15);
  EXPECT_LT((cube.nearest(Vec3(0.4, 2, -1)).point - Vec3(0.4, 1, 0)).norm(), 1.0e-15);
  EXPECT_EQ(cube.nearest(Vec3(1, 0.3, 0.3)).distance, 0.0);
  EXPECT_EQ(cube.nearest(Vec3(1, 1, 1)).distance, 0.0);

  Random random(73, 0, 0);
  const Mesh m = ball(3, 6.0);
  const Envelope sphere(m);
  const double sagitta = 0.5 * std::pow(mean_edge(m), 2) / 6.0;    // mesh below its sphere
  for (int i = 0; i < 300; i++) {
    const double r = 12.0 * random.uniform();
    const double d = sphere.nearest(r * random.unit_vector()).distance;
    EXPECT_GT(d, r - 6.0 - 1.0e-12);
    EXPECT_LT(d, r - 6.0 + sagitta);
  }
  EXPECT_THROW(Envelope{Mesh()}, std::invalid_argument);
}

TEST(Envelope, BruteForce)
{
  Random random(74, 0, 0);
  for (const Mesh &m : {icosphere(1), ball(3, 1), dented(3, 1), spiky(1), spiky(2), spiky(3)}) {
    const Envelope envelope(m);
    int inside = 0;
    for (int i = 0; i < 500; i++) {
      // everywhere, and close to nodes and edges, where the sign is delicate
      Vec3 x = 3.0 * random.uniform() * random.unit_vector();
      const auto &f = m.faces[size_t(random.uniform() * double(m.faces.size()))];
      if (i % 4 == 1) x = m.nodes[f[0]] + 0.05 * random.gaussian_vector();
      if (i % 4 == 2) x = 0.5 * (m.nodes[f[0]] + m.nodes[f[1]]) + 0.05 * random.gaussian_vector();
      const double target = brute_distance(m, x);
      const EnvelopePoint p = envelope.nearest(x);
      EXPECT_NEAR(p.distance, target, 1.0e-13);
      EXPECT_NEAR((x - p.point).norm(), std::fabs(target), 1.0e-13);
      const auto &g = m.faces[p.face];
      EXPECT_LT(triangle_distance(p.point, {m.nodes[g[0]], m.nodes[g[1]], m.nodes[g[2]]}), 1.0e-13);
      // no hint, however wrong, changes the answer
      const int hint = int(random.uniform() * 1.1 * double(m.faces.size()));
      EXPECT_NEAR(envelope.nearest(x, hint).distance, target, 1.0e-13);
      EXPECT_NEAR(envelope.nearest(x, p.face).distance, target, 1.0e-13);
      inside += target < 0.0;
    }
    EXPECT_GT(inside, 50);
    EXPECT_LT(inside, 450);
  }
}

TEST(Division, GradientOfTheEnergy)
{
  Random random(75, 0, 0);
  const Mesh mother = dented(2, 6.0);
  const Envelope envelope(mother);
  const Mesh round = icosphere(1);
  const DivisionPlane plane = halving_plane(mother, Vec3(2, -1, 0.3));
  const double V = 0.5 * volume(mother);
  ConfinedCell cell(envelope, plane, round, HEPATOBLAST, V, 0.9);
  cell.V0 = 1.1 * V;
  // a rough ball, partly behind the plane and partly behind the envelope
  const Vec3 center = plane.point + 2.5 * plane.normal;
  Points x;
  for (const Vec3 &e : round.nodes) x.push_back(center + 5.0 * e + 0.2 * random.gaussian_vector());
  auto flat = [](const Points &p) {
    Eigen::VectorXd v(3 * p.size());
    for (size_t i = 0; i < p.size(); i++) vec(&v[3 * i]) = p[i];
    return v;
  };
  Eigen::VectorXd g;
  int behind[2] = {0, 0};
  for (size_t i = 0; i < x.size(); i++) {
    const auto depth = cell.depths(flat(x), int(i));
    for (int k : {0, 1}) behind[k] += depth[k] > 0.0;
  }
  EXPECT_GT(behind[0], 5);
  EXPECT_GT(behind[1], 5);
  const Points numeric = gradient(
      [&](const Points &p) {
        return cell.energy(flat(p), g);
      },
      x, 1e-5);
  cell.energy(flat(x), g);
  Points force;
  for (size_t i = 0; i < x.size(); i++) force.push_back(-vec(&g[3 * i]));
  EXPECT_LT(gradient_error(force, numeric), 1.0e-6);

  // inside out: not finite numbers but an energy no line search accepts
  for (Vec3 &p : x) p = 2.0 * center - p;
  EXPECT_EQ(cell.energy(flat(x), g), std::numeric_limits<double>::infinity());
  EXPECT_EQ(g.norm(), 0.0);
}

TEST(Division, RoundMother)
{
  const double outside[3] = {0.04, 0.02, 0.02}, quality[3] = {0.7, 0.8, 0.85};
  for (int level = 1; level <= 3; level++)
    for (const Vec3 &n : {Vec3(0, 0, 1), Vec3(1, 2, 3)}) {
      const Mesh mother = ball(level, 6.0);
      const auto pair = divide(mother, n, level, outside[level - 1], quality[level - 1]);
      expect_twins(pair);
      // each on its own side: the centroid of half a ball, within the rounding of the rim
      for (int side : {0, 1}) {
        Vec3 mid = Vec3::Zero();
        for (const Vec3 &x : pair[side].mesh.nodes) mid += x / double(pair[side].mesh.nodes.size());
        EXPECT_NEAR((side ? -1.0 : 1.0) * mid.dot(n.normalized()), 0.375 * 6.0, 0.1 * 6.0);
      }
    }
}

TEST(Division, MeshOfAnotherResolution)
{
  for (int level : {1, 3}) expect_twins(divide(ball(2, 6.0), Vec3(1, 0, 2), level, 0.05, 0.7));
}

TEST(Division, Ellipsoids)
{
  // quality: halves cut lengthwise are 3 : 1 : 1/2, two stretches of 2 and more on a round mesh
  for (int level : {1, 2}) {
    const Mesh flat = ellipsoid(level, 9, 9, 3), oblong = ellipsoid(level, 12, 4, 4);
    expect_twins(divide(flat, Vec3(0, 0, 1), level, 0.08, 0.5));
    expect_twins(divide(flat, Vec3(1, 0, 0), level, 0.06, 0.4));
    expect_twins(divide(oblong, Vec3(1, 0, 0), level, 0.06, 0.7));
    expect_twins(divide(oblong, Vec3(0, 0, 1), level, 0.1, 0.4));
  }
}

TEST(Division, RestFactor)
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

TEST(Division, LongMothersOfAnyTriangulation)
{
  // prestress from taut to far too slack, either kind of hinges, any plane: always two sound cells
  Random random(77, 0, 0);
  DivisionMaterial material = HEPATOBLAST;
  DivisionSettings settings;
  int shorter = 0, n = 0;
  for (const Vec3 &axes : {Vec3(12, 4, 4), Vec3(10, 4, 4), Vec3(9, 9, 3), Vec3(11, 6, 4)})
    for (double rest : {0.95, 1.05, 1.1, 1.2})
      for (int level : {1, 2}) {
        if (level == 2 && rest == 1.05) continue;    // for time
        const Mat3 before = random_rotation(random), after = random_rotation(random);
        const Mesh mother = mapped(icosphere(level), [&](const Vec3 &x) {
          return Vec3(after * Vec3(axes.cwiseProduct(before * x)));
        });
        const Vec3 normals[4] = {after.col(0), after.col(2), (after.col(0) + after.col(2)),
                                 random.unit_vector()};
        const DivisionPlane plane = halving_plane(mother, normals[n++ % 4]);
        material.flat = random.uniform() < 0.5;
        settings.rest = rest;
        for (int side : {0, 1}) {
          const Daughter d =
              grow_daughter(mother, plane, side, icosphere(level), material, settings);
          EXPECT_TRUE(d.converged);
          EXPECT_EQ(d.problem, "");
          EXPECT_GE(worst_face(d.mesh), DIVISION_QUALITY);
          EXPECT_NEAR(volume(d.mesh), 0.5 * volume(mother), 1.0e-5 * volume(mother));
          EXPECT_LE(d.iterations, 2 * settings.maxiter);
          EXPECT_LE(d.rest, rest);
          EXPECT_GE(d.rest, std::min(rest, 0.9));    // only slack is taken up
          shorter += d.rest < rest;
          // what it says is what the rest lengths have
          const Mesh round = icosphere(level);
          const double unit = mean_edge(round) * std::cbrt(0.5 * volume(mother) / volume(round));
          double sum = 0.0;
          for (double l : d.l0) sum += l / double(d.l0.size());
          EXPECT_NEAR(sum, d.rest * unit, 1.0e-5 * unit);
        }
      }
  EXPECT_GE(shorter, 16);
}

TEST(Division, DentedMother)
{
  for (int level : {1, 2}) {
    const Mesh mother = dented(level, 6.0);
    // the mesh of the dented ball has mirror planes here, too
    expect_twins(divide(dented(level, 6.0, Vec3::UnitZ()), Vec3(1, 0, 0), level, 0.05, 0.5));
    divide(mother, Vec3(2, -1, 0), level, 0.05, 0.5);
    divide(mother, Vec3(1, 2, 2), level, 0.05, 0.5);
  }
}

TEST(Division, ForcesOfTheWallsCancel)
{
  const Mesh mother = ball(2, 6.0);
  const Envelope envelope(mother);
  const DivisionPlane plane = halving_plane(mother, Vec3(1, 2, 3));
  DivisionSettings settings;
  settings.tolerance = 1.0e-6;
  const Daughter d = grow_daughter(envelope, plane, 0, icosphere(2), HEPATOBLAST, settings);
  EXPECT_TRUE(d.converged);
  EXPECT_LE(d.residual, 1.0e-6);

  const double r = radius(d.volume), wall = division_wall(HEPATOBLAST.ks, d.volume);
  const Mesh round = mapped(icosphere(2), [&](const Vec3 &x) {
    return Vec3(x * std::cbrt(d.volume / volume(icosphere(2))));
  });
  std::vector<double> share(round.nodes.size(), 0.0);
  for (const auto &f : round.faces)
    for (int i : f)
      share[i] +=
          face_area_vector(round.nodes[f[0]], round.nodes[f[1]], round.nodes[f[2]]).norm() / 3;
  // forces of the cell itself sum to zero whatever its shape, so those of the walls must as well
  Vec3 from_plane = Vec3::Zero(), from_envelope = Vec3::Zero();
  double virial = 0.0;
  for (size_t i = 0; i < share.size(); i++) {
    const Vec3 &x = d.mesh.nodes[i];
    Vec3 f = Vec3::Zero();
    f += wall * share[i] * std::max(0.0, plane.normal.dot(plane.point - x)) * plane.normal;
    from_plane += f;
    const EnvelopePoint p = envelope.nearest(x);
    if (p.distance > 0.0) {
      from_envelope += wall * share[i] * (p.point - x);
      f += wall * share[i] * (p.point - x);
    }
    virial += f.dot(x);
  }
  EXPECT_LT((from_plane + from_envelope).norm(), 1.0e-5 * from_plane.norm());
  // the plane carries the excess of the pressure over the cortex: below pressure times section
  EXPECT_GT(from_plane.norm(), 0.4 * d.pressure * PI * 36.0);
  EXPECT_LT(from_plane.norm(), d.pressure * PI * 36.0);

  // virial: 3 p V + sum of wall forces . x = sum of tension . length; hinges know no scale
  double tension = 0.0;
  const auto edge = edges(d.mesh);
  for (size_t n = 0; n < edge.size(); n++) {
    const double l = (d.mesh.nodes[edge[n][1]] - d.mesh.nodes[edge[n][0]]).norm();
    tension += cortex_tension(HEPATOBLAST.ks, l, d.l0[n]) * l;
  }
  EXPECT_NEAR(3.0 * d.pressure * d.volume + virial, tension, 1.0e-5 * tension);
  EXPECT_NEAR(d.wall_pressure, wall * d.outside, 1.0e-12);
  EXPECT_LT(d.outside, 0.02 * r);
}

TEST(Division, FreeDaughter)
{
  // smaller than its half: it touches nothing and stays the round cell
  const Mesh mother = ball(2, 6.0), round = icosphere(2);
  DivisionSettings settings;
  settings.volume = 0.02 * volume(mother);
  const DivisionPlane plane = halving_plane(mother, Vec3::UnitX());
  Daughter d = grow_daughter(mother, plane, 1, round, HEPATOBLAST, settings);
  EXPECT_TRUE(d.converged);
  EXPECT_EQ(d.problem, "");
  EXPECT_EQ(d.outside, 0.0);
  EXPECT_LT(d.energy, 1.0e-6);
  EXPECT_NEAR(d.pressure, 0.0, 1.0e-3);
  EXPECT_NEAR(d.rest_volume, settings.volume, 1.0e-3 * settings.volume);

  // rounded up by short edges: p = 4 K_A eps/R with K_A = 0.8756 ks (MODEL.md, section 1)
  settings.rest = 0.99;
  d = grow_daughter(mother, plane, 1, round, HEPATOBLAST, settings);
  const double eps = 1.0 / settings.rest - 1.0;
  const double target = 4.0 * 0.8756 * HEPATOBLAST.ks * eps / radius(settings.volume);
  EXPECT_TRUE(d.converged);
  EXPECT_NEAR(d.pressure, target, 0.03 * target);
}

TEST(Division, BulkModulusDoesNotMatter)
{
  // at a given volume, pressure is what walls and cortex need; only the rest volume follows K_V
  const Mesh mother = ball(2, 6.0);
  const DivisionPlane plane = halving_plane(mother, Vec3(0, 0, 1));
  DivisionMaterial soft = HEPATOBLAST, hard = HEPATOBLAST;
  soft.K_V = 0.02;
  hard.K_V = 50.0;
  const Daughter a = grow_daughter(mother, plane, 0, icosphere(2), soft, DivisionSettings());
  const Daughter b = grow_daughter(mother, plane, 0, icosphere(2), hard, DivisionSettings());
  EXPECT_TRUE(a.converged);
  EXPECT_TRUE(b.converged);
  EXPECT_NEAR(a.pressure, b.pressure, 2.0e-3 * a.pressure);
  EXPECT_NEAR(std::log(a.rest_volume / a.volume), a.pressure / 0.02, 1.0e-9);
  EXPECT_NEAR(b.rest_volume, b.volume * std::exp(b.pressure / 50.0), 1.0e-9 * b.volume);
}

TEST(Division, TurnsWithTheMother)
{
  // Node by node where mother and plane share symmetry planes. Otherwise there are several shallow
  // minima, because without friction the mesh slips around in its half almost for nothing, and
  // round-off chooses among them: pressure and energy agree within 3 %.
  Random random(76, 0, 0);
  const Mesh mother = ellipsoid(2, 9, 6, 5);
  for (const Vec3 &n : {Vec3(1, 0, 0), Vec3(Vec3(1, 2, 3).normalized())}) {
    const Daughter d = grow_daughter(mother, halving_plane(mother, n), 0, icosphere(2), HEPATOBLAST,
                                     DivisionSettings());
    for (int i = 0; i < 3; i++) {
      const Mat3 R = random_rotation(random);
      const Vec3 shift(50, -20, 30);
      const Mesh turned = mapped(mother, [&](const Vec3 &x) {
        return Vec3(R * x + shift);
      });
      const Daughter e = grow_daughter(turned, halving_plane(turned, R * n), 0, icosphere(2),
                                       HEPATOBLAST, DivisionSettings());
      const double same = n[0] == 1.0 ? 1.0e-4 : 3.0e-2;
      EXPECT_TRUE(e.converged);
      EXPECT_NEAR(e.pressure, d.pressure, same * d.pressure);
      EXPECT_NEAR(e.energy, d.energy, same * d.energy);
      // plane_frame() has no sign: half a turn of the icosphere renumbers its nodes
      double error = 0.0;
      for (const Vec3 &x : d.mesh.nodes) {
        double nearest = 1.0e300;
        for (const Vec3 &y : e.mesh.nodes) nearest = std::min(nearest, (R * x + shift - y).norm());
        error = std::max(error, nearest);
      }
      EXPECT_LT(error, (n[0] == 1.0 ? 1.0e-3 : 0.15) * radius(d.volume));
    }
  }
}

TEST(Division, SameInputSameOutput)
{
  const Mesh mother = dented(1, 6.0);
  const DivisionPlane plane = halving_plane(mother, Vec3(1, 0, 0));
  const Daughter a = grow_daughter(mother, plane, 0, icosphere(1), HEPATOBLAST, DivisionSettings());
  const Daughter b = grow_daughter(mother, plane, 0, icosphere(1), HEPATOBLAST, DivisionSettings());
  EXPECT_EQ(a.mesh.nodes, b.mesh.nodes);
  EXPECT_EQ(a.rest_volume, b.rest_volume);
}

TEST(Division, SaysWhatItCannotDo)
{
  const Mesh mother = ball(1, 6.0), round = icosphere(1);
  const DivisionPlane plane = halving_plane(mother, Vec3(0, 0, 1));
  DivisionSettings settings;
  settings.maxiter = 5;
  Daughter d = grow_daughter(mother, plane, 0, round, HEPATOBLAST, settings);
  EXPECT_FALSE(d.converged);
  EXPECT_GT(d.residual, settings.tolerance);
  EXPECT_LE(d.iterations, 2 * settings.maxiter);
  for (const Vec3 &x : d.mesh.nodes) EXPECT_TRUE(x.allFinite());

  settings = DivisionSettings();    // twice what fits
  settings.volume = volume(mother);
  d = grow_daughter(mother, plane, 0, round, HEPATOBLAST, settings);
  EXPECT_NE(d.problem.find("outside its half"), std::string::npos) << d.problem;
  EXPECT_TRUE(std::isfinite(d.energy));

  settings = DivisionSettings();
  const DivisionPlane beside = {Vec3(0, 0, 100), Vec3::UnitZ()};
  EXPECT_THROW(grow_daughter(mother, beside, 0, round, HEPATOBLAST, settings),
               std::invalid_argument);
  Mesh open = round;
  open.faces.pop_back();
  EXPECT_THROW(grow_daughter(mother, plane, 0, open, HEPATOBLAST, settings), std::invalid_argument);
  EXPECT_THROW(grow_daughter(open, plane, 0, round, HEPATOBLAST, settings), std::invalid_argument);
  DivisionMaterial bad = HEPATOBLAST;
  bad.K_V = 0.0;
  EXPECT_THROW(grow_daughter(mother, plane, 0, round, bad, settings), std::invalid_argument);
  settings.tolerance = std::nan("");
  EXPECT_THROW(grow_daughter(mother, plane, 0, round, HEPATOBLAST, settings),
               std::invalid_argument);
}
