// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Hinges: sign, gradient, balance, and the bending rigidity of whole surfaces.

#include "law/cortex.h"
#include "law/hinge.h"
#include "law/mesh.h"
#include "helpers.h"

#include <Eigen/SparseCholesky>

#include <limits>

using namespace dcm;
using namespace dcm_test;

namespace {

Hinge hinge_of(double kb, double theta0, const Points &x)
{
  return hinge(kb, theta0, x[0], x[1], x[2], x[3]);
}

double angle_of(const Points &x)
{
  return hinge_angle(x[0], x[1], x[2], x[3]);
}

Points forces(const Hinge &h)
{
  return {h.f1, h.f2, h.f3, h.f4};
}

// a hinge on the x axis folded by theta > 0 to the convex side, outside is +z
Points folded(double theta)
{
  const double c = std::cos(0.5 * theta), s = std::sin(0.5 * theta);
  return {{0.3, 1.1 * c, -1.1 * s}, {0, 0, 0}, {1, 0, 0}, {0.8, -0.9 * c, -0.9 * s}};
}

// slow, obvious angle: arc cosine between unit normals, sign from the side the apex lies on
double reference_angle(const Points &x)
{
  const Vec3 n1 = (x[2] - x[1]).cross(x[0] - x[1]).normalized();
  const Vec3 n2 = (x[1] - x[2]).cross(x[3] - x[2]).normalized();
  const double angle = std::acos(std::clamp(n1.dot(n2), -1.0, 1.0));
  return n2.dot(x[0] - x[1]) < 0.0 ? angle : -angle;
}

// sum of (1 - cos theta) over one site of a sixfold lattice of spacing h at the origin, divided
// by the site's area; place() puts lattice points onto a surface with outward normal +z
template <class Place> double lattice_bending(double h, double orientation, const Place &place)
{
  double sum = 0.0;
  auto dir = [&](int k) {
    const double phi = orientation + k * PI / 3.0;
    return Eigen::Vector2d(h * std::cos(phi), h * std::sin(phi));
  };
  for (int k = 0; k < 3; k++) {
    // edge from the origin in direction k, its triangles have the apices in k + 1 and k - 1
    const Eigen::Vector2d zero(0.0, 0.0);
    const Hinge hg =
        hinge(1.0, 0.0, place(dir(k + 1)), place(zero), place(dir(k)), place(dir(k - 1)));
    sum += hg.energy;
  }
  return sum / (0.5 * std::sqrt(3.0) * h * h);
}

}    // namespace

TEST(Hinge, BendingStiffnessIsThatOfAPlate)
{
  // plate: integral of z^2 E/(1 - nu^2) over the thickness, midpoint rule as the slow reference
  const double E = 2.0, h = 0.3, nu = 0.5;
  const int n = 20000;
  double sum = 0.0;
  for (int i = 0; i < n; i++) {
    const double z = h * ((i + 0.5) / n - 0.5);
    sum += z * z * E / (1.0 - nu * nu) * h / n;
  }
  EXPECT_NEAR(bending_stiffness(E, h) / sum, 1.0, 1.0e-8);
  EXPECT_NEAR(bending_stiffness(E, h, 0.0) / bending_stiffness(E, h), 0.75, 1.0e-14);
}

TEST(Hinge, SignAndSize)
{
  for (double theta : {-3.1, -1.5, -1.0e-3, 0.0, 1.0e-7, 0.4, 1.6, 3.1}) {
    EXPECT_NEAR(angle_of(folded(theta)), theta, 1.0e-14);
    EXPECT_NEAR(hinge_of(2.5, 0.2, folded(theta)).energy, 2.5 * (1.0 - std::cos(theta - 0.2)),
                1.0e-14);
  }
  // a closed convex surface has positive angles only
  const Mesh mesh = icosphere(2);
  for (const auto &q : hinges(mesh))
    EXPECT_GT(hinge_angle(mesh.nodes[q[0]], mesh.nodes[q[1]], mesh.nodes[q[2]], mesh.nodes[q[3]]),
              0.0);
}

TEST(Hinge, AngleAgainstReference)
{
  Random random(3, 0, 0);
  for (int trial = 0; trial < 200; trial++) {
    const Points x = {random.gaussian_vector(), random.gaussian_vector(), random.gaussian_vector(),
                      random.gaussian_vector()};
    EXPECT_NEAR(angle_of(x), reference_angle(x), 1.0e-6);
  }
}

TEST(Hinge, ForceIsGradient)
{
  Random random(4, 0, 0);
  std::vector<Points> cases = {folded(0.0),  folded(1.0e-4), folded(0.3),
                               folded(-0.8), folded(3.0),    folded(-3.0)};
  for (int trial = 0; trial < 30; trial++)
    cases.push_back({random.gaussian_vector(), random.gaussian_vector(), random.gaussian_vector(),
                     random.gaussian_vector()});
  for (const Points &x : cases)
    for (double theta0 : {0.25, -1.0, 2.5}) {
      auto energy = [&](const Points &y) {
        return hinge_of(1.3, theta0, y).energy;
      };
      const Points f = forces(hinge_of(1.3, theta0, x));
      // the step follows the smallest height: the angle varies over that length
      const double height = std::min((x[2] - x[1]).cross(x[0] - x[1]).norm(),
                                     (x[2] - x[1]).cross(x[3] - x[1]).norm()) /
                            (x[2] - x[1]).norm();
      EXPECT_LT(gradient_error(f, gradient(energy, x, 2.0e-5 * std::min(1.0, height))), 1.0e-6);
    }
}

TEST(Hinge, MomentIsDerivativeOfEnergy)
{
  // turning triangle 1 about the edge by dtheta does the work M dtheta, M = kb sin(theta - theta0)
  for (double theta : {-1.0, 0.1, 0.7}) {
    const Points x = folded(theta);
    const Hinge h = hinge_of(2.0, 0.3, x);
    const double height = 1.1;
    EXPECT_NEAR(h.f1.norm() * height, std::fabs(2.0 * std::sin(theta - 0.3)), 1.0e-14);
  }
}

TEST(Hinge, NoNetForceNoNetTorque)
{
  Random random(5, 0, 0);
  for (int trial = 0; trial < 200; trial++) {
    const Points x = {random.gaussian_vector(), random.gaussian_vector(), random.gaussian_vector(),
                      random.gaussian_vector()};
    const Points f = forces(hinge_of(1.0, random.gaussian(), x));
    EXPECT_LT(net_force(f), 1.0e-12);
    EXPECT_LT(net_torque(x, f), 1.0e-12);
  }
}

TEST(Hinge, RotationAndRenumbering)
{
  Random random(6, 0, 0);
  for (int trial = 0; trial < 20; trial++) {
    Points x = folded(random.uniform());
    const Points f = forces(hinge_of(1.0, 0.1, x));
    const Points g = forces(hinge_of(1.0, 0.1, {x[3], x[2], x[1], x[0]}));
    for (int i = 0; i < 4; i++) EXPECT_LT((f[i] - g[3 - i]).norm(), 1.0e-13);
    const Mat3 rotation = random_rotation(random);
    const Vec3 shift = random.gaussian_vector();
    for (Vec3 &v : x) v = rotation * v + shift;
    const Points t = forces(hinge_of(1.0, 0.1, x));
    for (int i = 0; i < 4; i++) EXPECT_LT((rotation * f[i] - t[i]).norm(), 1.0e-13);
  }
}

TEST(Hinge, SliversStayFinite)
{
  const double eps = std::numeric_limits<double>::epsilon();
  for (double height : {0.0, 1.0e-300, 1.0e-160, eps, 1.0e-12, 1.0e-9, 1.0e-3}) {
    // apex close to the edge's line; apex next to an edge end; very short hinge edge
    for (const Points &x : {Points{{0.4, height, 0}, {0, 0, 0}, {1, 0, 0}, {0.5, -1, 0.2}},
                            Points{{height, height, 0}, {0, 0, 0}, {1, 0, 0}, {0.5, -1, 0.2}},
                            Points{{0.4, 1, 0.3}, {0, 0, 0}, {height, 0, 0}, {0.5, -1, 0.2}},
                            Points{{2, height, 0}, {0, 0, 0}, {1, 0, 0}, {-1, -height, 0.0}}}) {
      const Hinge h = hinge_of(1.0, 0.3, x);
      for (const Vec3 &v : forces(h)) EXPECT_TRUE(v.allFinite()) << height;
      EXPECT_TRUE(std::isfinite(h.energy)) << height;
      EXPECT_TRUE(std::isfinite(angle_of(x))) << height;
    }
  }
  // degenerate: no force at all
  const Hinge h = hinge_of(1.0, 0.3, {{0.4, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0.5, -1, 0.2}});
  EXPECT_EQ(largest(forces(h)), 0.0);
  EXPECT_EQ(h.energy, 0.0);
  // the same in any unit of length
  const Hinge big = hinge_of(1.0, 0.0, {{0.3e9, 1e9, -1e9}, {0, 0, 0}, {1e9, 0, 0}, {0, -1e9, 0}});
  const Hinge small =
      hinge_of(1.0, 0.0, {{0.3e-9, 1e-9, -1e-9}, {0, 0, 0}, {1e-9, 0, 0}, {0, -1e-9, 0}});
  EXPECT_NEAR(big.energy, small.energy, 1.0e-14);
  EXPECT_NEAR(big.f1.norm() * 1e18 / small.f1.norm(), 1.0, 1.0e-13);
  // NaN goes in, NaN comes out: an exploded run must not look calm
  EXPECT_TRUE(std::isnan(
      hinge_of(1.0, 0.0, {{std::nan(""), 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, -1, 0}}).energy));
}

TEST(Hinge, CylinderRigidity)
{
  // bent to a cylinder the energy per area is kappa/(2 R^2), kappa = (sqrt 3/2) kb, for every
  // orientation of the lattice; the error is O((h/R)^2)
  const double R = 1.0, h = 1.0e-3;
  for (double orientation : {0.0, 0.2, PI / 6.0, 1.0}) {
    const double density = lattice_bending(h, orientation, [&](const Eigen::Vector2d &p) {
      return Vec3(p[0], R * std::sin(p[1] / R), R * std::cos(p[1] / R) - R);
    });
    EXPECT_NEAR(2.0 * R * R * density, std::sqrt(3.0) / 2.0, 1.0e-5);
  }
}

TEST(Hinge, SphereSum)
{
  // a fine sixfold lattice on a sphere, scaled up from one site to the whole surface
  const double R = 1.0, h = 1.0e-3;
  for (double orientation : {0.0, 0.4}) {
    const double density = lattice_bending(h, orientation, [&](const Eigen::Vector2d &p) {
      return Vec3(p[0], p[1], std::sqrt(R * R - p.squaredNorm()) - R);
    });
    EXPECT_NEAR(4.0 * PI * R * R * density, 4.0 * PI / std::sqrt(3.0), 1.0e-4);
  }
  // icospheres: their triangles are not equilateral; independent computation gave 7.49 to 7.52
  for (int level = 2; level <= 5; level++) {
    const Mesh mesh = icosphere(level);
    double sum = 0.0;
    for (const auto &q : hinges(mesh))
      sum += hinge(1.0, 0.0, mesh.nodes[q[0]], mesh.nodes[q[1]], mesh.nodes[q[2]], mesh.nodes[q[3]])
                 .energy;
    EXPECT_GT(sum, 7.485);
    EXPECT_LT(sum, 7.525);
  }
}

namespace {

// bending length (kappa/Y)^(1/4) sqrt(R) of the lattice on a sphere of radius 1, solved for kb
double hinge_constant(double length, double ks)
{
  return std::pow(length, 4) / 0.75 * ks;
}

// F/w of a thin sphere of radius 1 under two opposite point loads, from its normal modes P_l: the
// lattice's moduli lambda = mu = (sqrt 3/4) ks, kappa = (sqrt 3/2) kb, kappa_G = -(2/sqrt 3) kb;
// the tangential part of each mode is eliminated
double shell_series(double kb, double ks)
{
  const double mu = 0.25 * std::sqrt(3.0) * ks, lambda = mu;
  const double kappa = 0.5 * std::sqrt(3.0) * kb, gauss = -2.0 / std::sqrt(3.0) * kb;
  double compliance = 1.0 / (2.0 * PI) / (4.0 * (lambda + mu));
  for (int l = 2; l < 20000; l += 2) {
    const double L = double(l) * (l + 1);
    const double bend = kappa * L * L + gauss * L;
    const double tt = lambda * L * L + 2.0 * mu * (L * L - L) + bend;
    const double tw = -2.0 * (lambda + mu) * L - bend;
    const double ww = 4.0 * (lambda + mu) + bend;
    compliance += (2 * l + 1) / (2.0 * PI) / (ww - tw * tw / tt);
  }
  return 1.0 / compliance;
}

// the same for a mesh of springs and hinges at rest: linear response, stiffness matrix by
// differences of the forces
double shell_stiffness(int level, double kb, double ks)
{
  const Mesh mesh = icosphere(level);
  const int n = int(mesh.nodes.size());
  std::vector<Eigen::Triplet<double>> entries;
  const double step = 1.0e-5 * mean_edge(mesh);
  auto add = [&](const std::vector<int> &atoms, const auto &force) {
    Points x;
    for (int a : atoms) x.push_back(mesh.nodes[a]);
    for (size_t i = 0; i < atoms.size(); i++)
      for (int d = 0; d < 3; d++) {
        Points up = x, down = x;
        up[i][d] += step;
        down[i][d] -= step;
        const Points fu = force(up), fd = force(down);
        for (size_t j = 0; j < atoms.size(); j++)
          for (int c = 0; c < 3; c++)
            entries.emplace_back(3 * atoms[j] + c, 3 * atoms[i] + d,
                                 -(fu[j][c] - fd[j][c]) / (2.0 * step));
      }
  };
  for (const auto &e : edges(mesh)) {
    const double l0 = (mesh.nodes[e[1]] - mesh.nodes[e[0]]).norm();
    add({e[0], e[1]}, [&](const Points &x) {
      const Vec3 f = cortex_force(ks, l0, x[1] - x[0]);
      return Points{-f, f};
    });
  }
  for (const auto &q : hinges(mesh)) {
    const double theta0 =
        hinge_angle(mesh.nodes[q[0]], mesh.nodes[q[1]], mesh.nodes[q[2]], mesh.nodes[q[3]]);
    add({q[0], q[1], q[2], q[3]}, [&](const Points &x) {
      return forces(hinge_of(kb, theta0, x));
    });
  }
  // a trace of ground stiffness removes the rigid motions, which the balanced load does not excite
  for (int i = 0; i < 3 * n; i++) entries.emplace_back(i, i, 1.0e-7 * ks);
  Eigen::SparseMatrix<double> stiffness(3 * n, 3 * n);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(stiffness);
  EXPECT_EQ(solver.info(), Eigen::Success);

  // load a sixfold node (all but the first twelve are) and its antipode
  const int north = 100;
  const Vec3 axis = mesh.nodes[north];
  int south = 0;
  for (int i = 0; i < n; i++)
    if ((mesh.nodes[i] + axis).norm() < (mesh.nodes[south] + axis).norm()) south = i;
  EXPECT_LT((mesh.nodes[south] + axis).norm(), 1.0e-12);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * n);
  load.segment<3>(3 * north) = -axis;
  load.segment<3>(3 * south) = axis;
  const Eigen::VectorXd u = solver.solve(load);
  return -1.0 / u.segment<3>(3 * north).dot(axis);
}

}    // namespace

TEST(Hinge, PointLoadedShell)
{
  // Reissner: F/w = 8 sqrt(kappa Y)/R = 8 sqrt(kb ks)/R, the limit of a thin shell
  const double ks = 1.0;
  for (double length : {0.01, 0.02}) {
    const double kb = hinge_constant(length, ks);
    EXPECT_NEAR(shell_series(kb, ks) / (8.0 * std::sqrt(kb * ks)), 1.0, 0.005);
  }
  // a mesh cannot resolve that limit; at a bending length of 0.2 R it comes to the full series
  const double kb = hinge_constant(0.2, ks), exact = shell_series(kb, ks);
  const double coarse = shell_stiffness(3, kb, ks) / exact - 1.0;
  const double fine = shell_stiffness(4, kb, ks) / exact - 1.0;
  std::printf("point-loaded shell, F/w relative to exact: %+.3f at 642, %+.3f at 2562 nodes\n",
              coarse, fine);
  EXPECT_LT(std::fabs(fine), 0.06);
  EXPECT_LT(std::fabs(fine), 0.5 * std::fabs(coarse));
}
