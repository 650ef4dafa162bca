// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Contact kernel: triangulated spheres against the closed form of the spheres, single pairs
// against brute-force quadrature over the common area, balance, symmetry, smoothness, robustness.

#include "law/contact.h"
#include "law/curvature.h"
#include "law/mesh.h"
#include "helpers.h"

#include <limits>
#include <random>

using namespace dcm;
using namespace dcm_test;

namespace {

using Faces = std::vector<FaceGeometry>;

// radii of the faces' spheres from the mesh itself, as the package computes them
std::vector<double> fitted_radii(const Mesh &mesh)
{
  const size_t n = mesh.nodes.size();
  Points laplace(n, Vec3::Zero()), normal(n, Vec3::Zero());
  std::vector<double> area(n, 0.0), radii;
  for (const auto &f : mesh.faces) {
    const FaceCurvature part =
        face_curvature_parts(mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]);
    for (int k = 0; k < 3; k++) {
      laplace[f[k]] += part.laplace[k];
      normal[f[k]] += part.normal[k];
      area[f[k]] += part.area[k];
    }
  }
  for (const auto &f : mesh.faces) {
    double k = 0.0;
    for (int i : f) k += node_curvature(laplace[i], normal[i], area[i]) / 3.0;
    radii.push_back(face_radius(k, 0.0, 0.0, 1.0e6));
  }
  return radii;
}

struct Ball {
  Mesh mesh;    // radius 1
  std::vector<double> radii;

  explicit Ball(int level, bool fitted) : mesh(icosphere(level)), radii(mesh.faces.size(), 1.0)
  {
    if (fitted) radii = fitted_radii(mesh);
  }

  Faces faces(const Mat3 &turn, const Vec3 &shift) const
  {
    Faces out;
    for (size_t i = 0; i < mesh.faces.size(); i++) {
      const auto &t = mesh.faces[i];
      out.push_back(make_face(turn * mesh.nodes[t[0]] + shift, turn * mesh.nodes[t[1]] + shift,
                              turn * mesh.nodes[t[2]] + shift, radii[i]));
    }
    return out;
  }
};

struct Total {
  Vec3 force = Vec3::Zero();    // on g
  Vec3 net = Vec3::Zero(), torque = Vec3::Zero();
  double area = 0.0;
  int pairs = 0;
};

template <class State>
Total all_pairs(const Faces &F, const Faces &G, const ContactMaterial &m, int npoints)
{
  Total t;
  ContactResult r;
  for (const auto &f : F)
    for (const auto &g : G) {
      if (!face_face<State>(f, g, m, npoints, r)) continue;
      t.pairs++;
      t.area += r.area;
      for (int k = 0; k < 3; k++) {
        const Vec3 on_g = r.wg[k] * r.u, on_f = -r.wf[k] * r.u;
        t.force += on_g;
        t.net += on_g + on_f;
        t.torque += g.x[k].cross(on_g) + f.x[k].cross(on_f);
      }
    }
  return t;
}

// material of two unit spheres (R = 1/2) with Maugis parameter lambda
ContactMaterial material(double lambda, double W = 0.01)
{
  ContactMaterial m;
  m.E = 1.0;
  m.W = W;
  const double K = 4.0 / 3.0 * m.E;
  m.h0 = W > 0.0 ? 2.0 * m.W / lambda * std::cbrt(0.5 / (PI * m.W * K * K)) : 0.0;
  return m;
}

// largest of the repulsive and the adhesive part of the force
template <class State> double scale(const State &s)
{
  return std::max(2.0 * PI / 3.0 * s.hertz * s.a * s.a * s.a,
                  PI * s.sigma0 * (s.c * s.c - s.a * s.a));
}

Random rng(int purpose)
{
  return Random(4711, purpose, 0, RandomPurpose{});
}

Vec3 direction(Random &random)
{
  return random_rotation(random).col(0);
}

// integrals over the common area by halving triangles, midpoint rule: shares nothing with the
// edge integration
struct Brute {
  double force = 0.0, wf[3] = {}, wg[3] = {}, area = 0.0;
};

template <class State>
void brute(const State &s, const Vec3 v[3], const Vec3 &axis, const Vec3 &u, const FaceGeometry &g,
           const FaceGeometry &f, int depth, Brute &b)
{
  if (depth > 0) {
    const Vec3 m0 = 0.5 * (v[1] + v[2]), m1 = 0.5 * (v[2] + v[0]), m2 = 0.5 * (v[0] + v[1]);
    const Vec3 c[4][3] = {{v[0], m2, m1}, {m2, v[1], m0}, {m1, m0, v[2]}, {m0, m1, m2}};
    for (const auto &t : c) brute(s, t, axis, u, g, f, depth - 1, b);
    return;
  }
  const Vec3 x = (v[0] + v[1] + v[2]) / 3.0;
  // barycentric weights in projection along u: x + t u in the plane of the triangle
  const auto weights = [&](const FaceGeometry &t, double w[3]) {
    const Vec3 n = t.n;
    const Vec3 y = x + u * ((t.x[0] - x).dot(n) / u.dot(n));
    for (int k = 0; k < 3; k++)
      w[k] = 0.5 * n.dot((t.x[(k + 1) % 3] - y).cross(t.x[(k + 2) % 3] - y)) / t.area;
    return w[0] > 0.0 && w[1] > 0.0 && w[2] > 0.0;
  };
  double wf[3], wg[3];
  weights(f, wf);
  if (!weights(g, wg)) return;
  const Vec3 off = x - axis;
  const double r = (off - u * off.dot(u)).norm();
  if (r > s.c) return;
  const double dA = 0.5 * (v[1] - v[0]).cross(v[2] - v[0]).dot(u);
  const double p = s.p(r);
  b.force += p * dA;
  b.area += dA;
  for (int k = 0; k < 3; k++) {
    b.wf[k] += p * wf[k] * dA;
    b.wg[k] += p * wg[k] * dA;
  }
}

}    // namespace

// smooth in the cosine, as between two and one: 1/2 in the middle, no slope at the ends
TEST(Facing, FadesOutBetweenTwoAngles)
{
  const double deg = EIGEN_PI / 180.0;
  const Facing usual, narrow{std::cos(20.0 * deg), std::cos(10.0 * deg)};
  for (const auto &[weight, full, none] :
       {std::tuple(usual, 40.0, 50.0), std::tuple(narrow, 10.0, 20.0)}) {
    const double a = std::cos(none * deg), b = std::cos(full * deg), e = 1e-4 * (b - a);
    EXPECT_EQ(weight(a - e), 0.0);
    EXPECT_EQ(weight(b + e), 1.0);
    EXPECT_EQ(weight(-b), 0.0);
    EXPECT_NEAR(weight(0.5 * (a + b)), 0.5, 1e-12);
    EXPECT_NEAR(weight(a + e), 0.0, 1e-6);
    EXPECT_NEAR(weight(b - e), 1.0, 1e-6);
  }
}

TEST(FaceSphere, PassesThroughTheVertices)
{
  Random random = rng(20);
  for (int trial = 0; trial < 100; trial++) {
    const Vec3 x[3] = {random.gaussian_vector(), random.gaussian_vector(),
                       random.gaussian_vector()};
    const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
    const double r = make_face(x[0], x[1], x[2], 1.0).radius_circ;
    for (double R : {1.2 * r, 5.0 * r, -3.0 * r}) {
      const FaceGeometry f = make_face(x[0], x[1], x[2], R);
      EXPECT_EQ(f.R, R);
      EXPECT_LT((f.n - n).norm(), 1.0e-12);
      for (const Vec3 &v : x) EXPECT_NEAR((v - f.center).norm(), std::fabs(R), 1.0e-10 * (1.0 + r));
      EXPECT_LT((f.center - f.mid).dot(n) * R, 0.0);    // behind the face when convex
    }
  }
}

TEST(FaceSphere, FacesOfAnIcosphereFindTheCommonOne)
{
  // fitted from the mesh alone; the radii are exact although no mean of normals is
  const Ball ball(2, true);
  const Vec3 shift(30, -20, 10);
  for (const FaceGeometry &f : ball.faces(Mat3::Identity(), shift)) {
    EXPECT_NEAR(f.R, 1.0, 1.0e-11);
    EXPECT_LT((f.center - shift).norm(), 1.0e-9);
  }
}

template <class State> class Contact : public testing::Test {
};
using Laws = testing::Types<DmtState, MaugisState>;
TYPED_TEST_SUITE(Contact, Laws);

TYPED_TEST(Contact, ExactSpheresGiveTheClosedForm)
{
  Random random = rng(1);
  const Ball ball(2, false);
  for (double lambda : {0.1, 1.0, 17.0})
    for (double delta : {0.05, 0.2}) {
      const ContactMaterial m = material(lambda);
      TypeParam s;
      ASSERT_TRUE(s.set(m, 0.5, delta));
      double worst = 0.0, worst_area = 0.0;
      for (int i = 0; i < 8; i++) {
        const Vec3 e = direction(random);
        const Faces F = ball.faces(random_rotation(random), Vec3::Zero());
        const Faces G = ball.faces(random_rotation(random), (2.0 - delta) * e);
        for (int np = 1; np <= 4; np++) {
          const Total t = all_pairs<TypeParam>(F, G, m, np);
          worst = std::max(worst, (t.force - s.force() * e).norm() / scale(s));
          worst_area = std::max(worst_area, std::fabs(t.area / (PI * s.c * s.c) - 1.0));
        }
      }
      // edges between pairs cancel, so that even one point leaves round-off only
      EXPECT_LT(worst, 1e-11) << lambda << " " << delta;
      EXPECT_LT(worst_area, 1e-11);
    }
}

// a face's share of the force is where Gauss points count
TYPED_TEST(Contact, NodalForcesConvergeWithPoints)
{
  Random random = rng(2);
  const Ball ball(2, false);
  for (double lambda : {0.1, 17.0}) {
    const ContactMaterial m = material(lambda);
    TypeParam s;
    ASSERT_TRUE(s.set(m, 0.5, 0.05));
    double error[5] = {};
    for (int i = 0; i < 4; i++) {
      const Vec3 e = direction(random);
      const Faces F = ball.faces(random_rotation(random), Vec3::Zero());
      const Faces G = ball.faces(random_rotation(random), 1.95 * e);
      for (const auto &f : F)
        for (const auto &g : G) {
          ContactResult r, best;
          if (!face_face<TypeParam>(f, g, m, 4, best)) continue;
          for (int np = 1; np < 4; np++) {
            ASSERT_TRUE(face_face<TypeParam>(f, g, m, np, r));
            for (int k = 0; k < 3; k++)
              error[np] = std::max(error[np], std::fabs(r.wf[k] - best.wf[k]) / scale(s));
          }
        }
    }
    EXPECT_LT(error[1], 2e-2) << lambda;
    EXPECT_LT(error[2], 3e-3) << lambda;
    EXPECT_LT(error[3], 1e-3) << lambda;
    std::printf("lambda %g: nodal error %.1e %.1e %.1e of the force, 1-3 points\n", lambda,
                error[1], error[2], error[3]);
  }
}

TYPED_TEST(Contact, FittedSpheresHertz)
{
  for (int level : {2, 3}) {
    Random random = rng(10 + level);
    const Ball ball(level, true);
    for (double overlap : {0.02, 0.1}) {
      const ContactMaterial m = material(1.0, 0.0);
      TypeParam s;
      ASSERT_TRUE(s.set(m, 0.5, overlap));
      double worst = 0.0, mean = 0.0;
      const int n = level == 2 ? 30 : 20;
      for (int i = 0; i < n; i++) {
        const Vec3 e = direction(random);
        const Faces F = ball.faces(random_rotation(random), Vec3::Zero());
        const Faces G = ball.faces(random_rotation(random), (2.0 - overlap) * e);
        const double ratio = all_pairs<TypeParam>(F, G, m, 2).force.dot(e) / s.force();
        worst = std::max(worst, std::fabs(ratio - 1.0));
        mean += ratio / n;
      }
      EXPECT_LT(worst, level == 2 ? 5e-4 : 1e-4) << overlap;
      std::printf("%zu nodes, overlap %.2f: mean %.6f, largest deviation %.1e\n",
                  ball.mesh.nodes.size(), overlap, mean, worst);
    }
  }
}

TYPED_TEST(Contact, ForceAndTorqueBalance)
{
  Random random = rng(3);
  for (bool fitted : {false, true}) {
    const Ball ball(2, fitted);
    for (double W : {0.0, 0.01})
      for (double delta : {-0.01, 0.05, 0.3}) {
        const ContactMaterial m = material(1.0, W);
        TypeParam s;
        if (!s.set(m, 0.5, delta)) continue;
        const Vec3 e = direction(random), x0(2.0, -1.0, 3.0);
        const Faces F = ball.faces(random_rotation(random), x0);
        const Faces G = ball.faces(random_rotation(random), x0 + (2.0 - delta) * e);
        const Total t = all_pairs<TypeParam>(F, G, m, 2);
        EXPECT_GT(t.pairs, 0);
        EXPECT_LT(t.net.norm(), 1e-12 * scale(s));
        EXPECT_LT(t.torque.norm(), 1e-12 * scale(s) * 4.0);
      }
  }
}

TYPED_TEST(Contact, ExchangeOfTheTwoFaces)
{
  Random random = rng(4);
  const Ball ball(2, true);
  const ContactMaterial m = material(1.0);
  TypeParam s;
  ASSERT_TRUE(s.set(m, 0.5, 0.1));
  const Faces F = ball.faces(random_rotation(random), Vec3::Zero());
  const Faces G = ball.faces(random_rotation(random), 1.9 * direction(random));
  int pairs = 0;
  for (const auto &f : F)
    for (const auto &g : G) {
      ContactResult a, b;
      const bool hit = face_face<TypeParam>(f, g, m, 2, a);
      const bool back = face_face<TypeParam>(g, f, m, 2, b);
      if (hit != back) {    // common area of the size of round-off
        ASSERT_LT(hit ? a.area : b.area, 1e-13);
        continue;
      }
      if (!hit) continue;
      pairs++;
      const double eps = 1e-12 * scale(s);
      ASSERT_NEAR((a.u + b.u).norm(), 0.0, 1e-15);
      ASSERT_NEAR(a.force, b.force, eps);
      ASSERT_NEAR(a.area, b.area, 1e-13);
      for (int k = 0; k < 3; k++) {
        ASSERT_NEAR(a.wf[k], b.wg[k], eps);
        ASSERT_NEAR(a.wg[k], b.wf[k], eps);
      }
    }
  EXPECT_GT(pairs, 50);
}

TYPED_TEST(Contact, SinglePairsAgainstAreaQuadrature)
{
  Random random = rng(5);
  const Ball ball(2, true);
  for (double lambda : {0.3, 5.0}) {
    const ContactMaterial m = material(lambda);
    const Faces F = ball.faces(random_rotation(random), Vec3::Zero());
    const Faces G = ball.faces(random_rotation(random), 1.9 * direction(random));
    int pairs = 0;
    for (const auto &f : F)
      for (const auto &g : G) {
        ContactResult r;
        if (!face_face<TypeParam>(f, g, m, 4, r) || pairs >= 25) continue;
        if (r.area < 0.1 * std::min(f.area, g.area)) continue;
        pairs++;
        const double R = f.R * g.R / (f.R + g.R);
        TypeParam s;
        ASSERT_TRUE(s.set(m, R, r.delta));
        Vec3 v[3];    // f in projection
        for (int k = 0; k < 3; k++) v[k] = f.x[k] - r.u * (f.x[k] - f.center).dot(r.u);
        Brute b;
        brute(s, v, f.center, r.u, g, f, 8, b);
        const double peak = std::max(s.hertz * s.a, s.sigma0) * f.area;
        ASSERT_NEAR(r.area, b.area, 5e-3 * f.area);
        ASSERT_NEAR(r.force, b.force, 5e-3 * peak);
        for (int k = 0; k < 3; k++) {
          ASSERT_NEAR(r.wf[k], b.wf[k], 5e-3 * peak);
          ASSERT_NEAR(r.wg[k], b.wg[k], 5e-3 * peak);
        }
        double sf = 0.0, sg = 0.0;
        for (int k = 0; k < 3; k++) {
          sf += r.bf[k];
          sg += r.bg[k];
          ASSERT_GE(r.bf[k], 0.0);
          ASSERT_GE(r.bg[k], 0.0);
        }
        ASSERT_NEAR(sf, 1.0, 1e-14);
        ASSERT_NEAR(sg, 1.0, 1e-14);
        // the same point on both sides, seen along u
        Vec3 pf = Vec3::Zero(), pg = Vec3::Zero();
        for (int k = 0; k < 3; k++) {
          pf += r.bf[k] * f.x[k];
          pg += r.bg[k] * g.x[k];
        }
        const Vec3 off = pg - pf;
        ASSERT_NEAR((off - r.u * off.dot(r.u)).norm(), 0.0, 1e-11);
      }
    EXPECT_GE(pairs, 10);
  }
}

// no tick as triangle pairs come and go, sliding (g moves around f) and rolling (g turns too)
TYPED_TEST(Contact, SlidingAndRollingIsSmooth)
{
  Random random = rng(6);
  for (bool uneven : {false, true})
    for (double lambda : {0.3, 17.0})
      for (double delta : {0.02, 0.1}) {
        // curvature of a sphere's mesh is exact: make the radii differ, and with them every axis
        Ball ball(2, true);
        if (uneven)
          for (double &R : ball.radii) R *= 1.0 + 0.004 * (random.uniform() - 0.5);
        const ContactMaterial m = material(lambda);
        TypeParam s;
        ASSERT_TRUE(s.set(m, 0.5, delta));
        const Mat3 qf = random_rotation(random), qg = random_rotation(random);
        const Mat3 frame = random_rotation(random);
        const Faces F = ball.faces(qf, Vec3::Zero());
        double worst = 0.0;
        for (bool roll : {false, true})
          for (int i = 0; i < 15; i++) {
            Vec3 force[3];
            for (int k = 0; k < 3; k++) {
              const double angle = 0.023 * i + 1e-6 * k;
              const Eigen::AngleAxisd turn(angle, frame.col(2));
              const Vec3 e = turn * frame.col(0).eval();
              const Mat3 spin = roll ? Mat3((turn * turn).toRotationMatrix() * qg) : qg;
              // in the turning frame, so that the smooth trend is gone
              const Vec3 f =
                  all_pairs<TypeParam>(F, ball.faces(spin, (2.0 - delta) * e), m, 2).force;
              force[k] = turn.inverse() * f;
            }
            worst = std::max(worst, (force[1] - force[0]).norm());
            worst = std::max(worst, (force[2] - 2.0 * force[1] + force[0]).norm());
          }
        EXPECT_LT(worst, 1e-5 * scale(s)) << uneven << " " << lambda << " " << delta;
        std::printf("%s radii, lambda %g, overlap %g: largest change in 1e-6 R is %.1e\n",
                    uneven ? "uneven" : "equal", lambda, delta, worst / scale(s));
      }
}

TYPED_TEST(Contact, FaceSphereClosedForm)
{
  Random random = rng(7);
  const Ball ball(2, false), fit(2, true);
  const double radius = 0.7, R = radius / (1.0 + radius);
  for (double lambda : {0.1, 1.0, 17.0})
    for (double delta : {-1e-3, 0.05, 0.1}) {
      const ContactMaterial m = material(lambda);
      TypeParam s;
      ASSERT_TRUE(s.set(m, R, delta));
      const Vec3 e = direction(random), x0(1.0, 2.0, 3.0);
      const Mat3 q = random_rotation(random);
      const Vec3 center = x0 + (1.0 + radius - delta) * e;
      for (bool fitted : {false, true}) {
        Vec3 on_sphere = Vec3::Zero(), net = Vec3::Zero(), torque = Vec3::Zero();
        double area = 0.0;
        ContactResult r;
        for (const auto &f : (fitted ? fit : ball).faces(q, x0)) {
          if (!face_sphere<TypeParam>(f, center, radius, m, 2, r)) continue;
          area += r.area;
          on_sphere += r.wg[0] * r.u;
          net += r.wg[0] * r.u;
          torque += (center - x0).cross(r.wg[0] * r.u);
          for (int k = 0; k < 3; k++) {
            net -= r.wf[k] * r.u;
            torque -= (f.x[k] - x0).cross(r.wf[k] * r.u);
          }
        }
        const double tol = fitted ? 2e-2 : 1e-11;
        EXPECT_LT((on_sphere - s.force() * e).norm(), tol * scale(s)) << lambda << " " << delta;
        EXPECT_NEAR(area / (PI * s.c * s.c), 1.0, tol);
        EXPECT_LT(net.norm(), 1e-12 * scale(s));
        if (!fitted) {
          EXPECT_LT(torque.norm(), 1e-11 * scale(s));
        }
      }
    }
}

// identical triangles face to face: every edge coincides
TYPED_TEST(Contact, MirrorImages)
{
  const Ball ball(2, false);
  const ContactMaterial m = material(1.0);
  const double delta = 0.05;
  TypeParam s;
  ASSERT_TRUE(s.set(m, 0.5, delta));
  for (double noise : {0.0, 1e-16, 1e-12, 1e-9, 1e-7}) {
    std::mt19937 gen(3);
    std::uniform_real_distribution<double> uniform(-noise, noise);
    Faces F = ball.faces(Mat3::Identity(), Vec3::Zero()), G;
    for (const auto &f : F) {
      Vec3 v[3];
      for (int k = 0; k < 3; k++)
        v[k] = Vec3(2.0 - delta - f.x[k][0], f.x[k][1], f.x[k][2]) +
               Vec3(0.0, uniform(gen), uniform(gen));
      G.push_back(make_face(v[0], v[2], v[1], 1.0));
    }
    const Total t = all_pairs<TypeParam>(F, G, m, 2);
    // noise makes the mesh overlap itself, by its own size, and splits edges anywhere: without a
    // closed form the Gauss error of the pieces no longer cancels
    const double gauss = TypeParam::EXACT_CORE || noise == 0.0 ? 0.0 : 5e-3;
    EXPECT_NEAR(t.force[0] / s.force(), 1.0, 1e-11 + 1e3 * noise + gauss) << noise;
  }
}

TYPED_TEST(Contact, ConcaveFaces)
{
  // a ball of radius 1 in a cavity of radius 3: flip the cavity's faces inside out
  const double cavity = 3.0, delta = 0.02;
  const Mesh mesh = icosphere(3);
  Random random = rng(8);
  const ContactMaterial m = material(1.0, 0.0);
  const Mat3 q = random_rotation(random);
  Faces F;
  for (const auto &t : mesh.faces)
    F.push_back(make_face(q * mesh.nodes[t[0]] * cavity, q * mesh.nodes[t[2]] * cavity,
                          q * mesh.nodes[t[1]] * cavity, -cavity));
  EXPECT_NEAR(F[0].center.norm(), 0.0, 1e-12);
  const Vec3 e = direction(random);
  const Faces G = Ball(3, false).faces(random_rotation(random), (cavity - 1.0 + delta) * e);
  TypeParam s;
  ASSERT_TRUE(s.set(m, 1.5, delta));
  const Total t = all_pairs<TypeParam>(F, G, m, 2);
  EXPECT_LT((t.force + s.force() * e).norm(), 1e-10 * s.force());
  const Total swapped = all_pairs<TypeParam>(G, F, m, 2);
  EXPECT_LT((t.force + swapped.force).norm(), 1e-10 * s.force());

  Vec3 sum = Vec3::Zero();
  ContactResult r;
  for (const auto &f : F)
    if (face_sphere<TypeParam>(f, (cavity - 1.0 + delta) * e, 1.0, m, 2, r)) sum += r.force * r.u;
  EXPECT_LT((sum + s.force() * e).norm(), 1e-10 * s.force());
}

TYPED_TEST(Contact, NoAxisNoContact)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  const ContactMaterial m = material(1.0);
  const FaceGeometry f = make_face(a, b, c, 2.0);
  FaceGeometry g = make_face(a, c, b, 2.0);
  ContactResult r;
  g.center = f.center;
  EXPECT_FALSE(face_face<TypeParam>(f, g, m, 2, r));
  EXPECT_FALSE(face_face<TypeParam>(f, f, m, 2, r));
  EXPECT_FALSE(face_sphere<TypeParam>(f, f.center, 1.0, m, 2, r));
  EXPECT_FALSE(face_sphere<TypeParam>(f, Vec3(0, 0, 1), 0.0, m, 2, r));
  const FaceGeometry flat = make_face(a, b, 2.0 * b, 2.0), point = make_face(a, a, a, 2.0);
  EXPECT_FALSE(face_face<TypeParam>(flat, g, m, 2, r));
  EXPECT_FALSE(face_face<TypeParam>(point, g, m, 2, r));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const FaceGeometry bad = make_face(Vec3(nan, 0, 0), b, c, 2.0);
  EXPECT_FALSE(face_face<TypeParam>(bad, g, m, 2, r));
  EXPECT_FALSE(face_face<TypeParam>(g, bad, m, 2, r));
  EXPECT_FALSE(face_sphere<TypeParam>(bad, Vec3(0, 0, 1), 1.0, m, 2, r));
}

TYPED_TEST(Contact, RandomAndSliverPairsStayFinite)
{
  std::mt19937 gen(12);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] {
    return Vec3(uniform(gen), uniform(gen), uniform(gen));
  };
  ContactMaterial m = material(1.0);
  int hits = 0;
  for (int i = 0; i < 200000; i++) {
    const double thin = std::pow(10.0, -(i % 19) / 1.5);
    // two faces near z = 0 looking at each other, of any shape
    Vec3 a[3], b[3];
    for (int k = 0; k < 3; k++) {
      a[k] = vector();
      b[k] = vector();
      a[k][2] *= 0.1;
      b[k][2] *= 0.1;
    }
    if (i % 2) a[2] = a[0] + uniform(gen) * (a[1] - a[0]) + thin * vector();
    if (i % 4 == 0) b[2] = b[0] + thin * vector();
    if (i % 8 == 3) b[0] = a[1], b[1] = a[0];
    if ((a[1] - a[0]).cross(a[2] - a[0])[2] < 0.0) std::swap(a[1], a[2]);
    if ((b[1] - b[0]).cross(b[2] - b[0])[2] > 0.0) std::swap(b[1], b[2]);
    const double lambda = std::pow(10.0, 2.0 * uniform(gen));
    m = material(lambda, i % 5 ? 0.01 : 0.0);
    const double Rf = std::pow(10.0, uniform(gen)) * (i % 7 ? 1.0 : -1.0);
    const double Rg = std::pow(10.0, uniform(gen)) * (i % 11 ? 1.0 : -1.0);
    const FaceGeometry f = make_face(a[0], a[1], a[2], Rf), g = make_face(b[0], b[1], b[2], Rg);
    ASSERT_TRUE(f.center.allFinite() && std::isfinite(f.R));
    ContactResult r;
    bool hit = face_face<TypeParam>(f, g, m, 1 + i % 4, r, i % 3 == 0);
    for (int kind = 0; kind < 2; kind++) {
      if (hit) {
        hits++;
        ASSERT_TRUE(r.u.allFinite() && std::isfinite(r.force) && std::isfinite(r.area));
        double sf = 0.0, sg = 0.0, size = std::fabs(r.force);
        for (int k = 0; k < 3; k++) {
          ASSERT_TRUE(std::isfinite(r.wf[k]) && std::isfinite(r.wg[k]));
          ASSERT_TRUE(r.bf[k] >= 0.0 && r.bf[k] <= 1.0 && r.bg[k] >= 0.0 && r.bg[k] <= 1.0);
          sf += r.wf[k];
          sg += r.wg[k];
          size = std::max(size, std::max(std::fabs(r.wf[k]), std::fabs(r.wg[k])));
        }
        ASSERT_NEAR(sf, r.force, 1e-13 * size);
        ASSERT_NEAR(sg, r.force, 1e-13 * size);
      }
      hit = face_sphere<TypeParam>(f, Vec3(0.2, 0.1, 0.5), 0.6, m, 2, r);
    }
  }
  EXPECT_GT(hits, 10000);
}
