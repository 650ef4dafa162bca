// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Slopes of the contact forces, for implicit steps: closed forms against finite differences of the
// forces, over random common parts of faces, across kinks, and for whole spheres; the block made of
// a slope against the Jacobian of the law.

#include "law/contact_tilt.h"
#include "law/jkr.h"
#include "law/mesh.h"
#include "law/stiffness.h"
#include "helpers.h"

#include <Eigen/Dense>

using namespace dcm;
using namespace dcm_test;

namespace {

Random rng(int purpose)
{
  return Random(4712, purpose, 0, RandomPurpose{});
}

ContactMaterial material(double W = 0.1, double h0 = 0.35)
{
  ContactMaterial m;
  m.E = 2.98;
  m.W = W;
  m.h0 = h0;
  m.k = 12.0;
  return m;
}

double force_of(const ContactResult &r)
{
  return r.force;
}

// two faces of random shape that look at each other across a gap or overlap
struct Pair {
  Vec3 x[2][3];
  double R[2];

  explicit Pair(Random &random)
  {
    const Mat3 turn = random_rotation(random);
    const double gap = 0.9 * random.uniform() - 0.6;    // -0.6: overlap, 0.3: apart
    for (int side : {0, 1}) {
      const double phase = 2.0 * PI * random.uniform();
      const Vec3 off(0.8 * random.uniform(), 0.8 * random.uniform(), side ? gap : 0.0);
      for (int k = 0; k < 3; k++) {
        const double angle = phase + (side ? -1 : 1) * 2.0 * PI * k / 3.0 + 0.5 * random.uniform();
        const double r = 0.7 + 0.6 * random.uniform();
        x[side][k] = turn * (off + Vec3(r * std::cos(angle), r * std::sin(angle),
                                        0.1 * (random.uniform() - 0.5)));
      }
      R[side] = 5.0 + 60.0 * random.uniform() * random.uniform();
    }
  }
  FaceGeometry face(int side, const Vec3 &shift = Vec3::Zero()) const
  {
    return make_face(x[side][0] + shift, x[side][1] + shift, x[side][2] + shift, R[side]);
  }
};

template <class State> class ContactSlope : public testing::Test {
};
using Laws = testing::Types<DmtState, MaugisState, FoundationState>;
TYPED_TEST_SUITE(ContactSlope, Laws);

template <class State> constexpr bool exact(const State &)
{
  return State::EXACT_CORE;    // else a secant
}

}    // namespace

// moving g along u changes neither u nor the projections: the derivative at fixed polygon
TYPED_TEST(ContactSlope, IsTheDerivativeAlongTheAxis)
{
  Random random = rng(1);
  const bool closed = exact(TypeParam());
  int met = 0, negative = 0, kinks = 0;
  for (int trial = 0; trial < 20000; trial++) {
    const Pair pair(random);
    const ContactMaterial m = material(trial % 5 ? 0.1 : 0.0, trial % 3 ? 0.35 : 0.1);
    const FaceGeometry f = pair.face(0);
    ContactResult r, plain;
    if (!face_face<TypeParam, true>(f, pair.face(1), m, 2, r)) continue;
    ASSERT_TRUE((face_face<TypeParam>(f, pair.face(1), m, 2, plain)));
    // asking for the slope changes nothing else, but how the compiler orders the sums
    ASSERT_NEAR(force_of(plain), force_of(r), 1e-13 * (1.0 + std::fabs(force_of(r))));
    ASSERT_NEAR(plain.area, r.area, 1e-13 * (1.0 + r.area));
    auto slope = [&](double e) {
      double side[2] = {0.0, 0.0};
      for (int k : {0, 1}) {
        ContactResult moved;
        if (face_face<TypeParam>(f, pair.face(1, (k ? e : -e) * r.u), m, 2, moved))
          side[k] = moved.force;
      }
      return (side[0] - side[1]) / (2.0 * e);
    };
    const double e = closed ? 1e-6 : 0.02 * m.h0, numeric = slope(e), wider = slope(2.0 * e);
    met++;
    if (r.slope < 0.0) negative++;
    const double scale = m.E + m.sigma0();
    // a circle that passes through a corner, or first touch: the derivative has a root or a jump
    if (std::fabs(numeric - wider) > (closed ? 1e-5 : 0.05) * scale) {
      kinks++;
      continue;
    }
    if (m.W == 0.0 && !closed) continue;    // narrower there
    ASSERT_NEAR(r.slope, numeric, (closed ? 2e-5 : 1e-9) * scale) << trial << " " << r.delta;
  }
  EXPECT_GT(met, 5000);
  // softening of the ring is seen; layers that stick have it at the outer edge only
  if (closed) {
    EXPECT_GT(negative, met / (TypeParam::LOCAL_GAP ? 100 : 50));
  }
  EXPECT_LT(kinks, met / 20);
}

// near every kink the slope stays between its values on both sides, and bounded
TYPED_TEST(ContactSlope, AcrossKinks)
{
  const ContactMaterial m = material();
  Pair pair = [] {
    Random random = rng(2);
    return Pair(random);
  }();
  for (int side : {0, 1}) {    // plane, parallel, equal: the axis through the middle, corners alike
    for (int k = 0; k < 3; k++) {
      const double angle = (side ? -1 : 1) * 2.0 * PI * k / 3.0;
      pair.x[side][k] = Vec3(std::cos(angle), std::sin(angle), 0.0);
    }
    pair.R[side] = 6.0;
  }
  ContactResult r;
  double last = 0.0, force = 0.0, area = 0.0, work = 0.0;
  const double step = 1e-5;
  for (double gap = 0.6; gap > -0.6; gap -= step) {
    const bool met =
        face_face<TypeParam, true>(pair.face(0), pair.face(1, Vec3(0, 0, gap)), m, 2, r);
    const double now = met ? r.slope : 0.0;
    ASSERT_TRUE(std::isfinite(now)) << gap;
    ASSERT_LT(std::fabs(now), 20.0 * (m.E + m.sigma0() * pair.R[0])) << gap;
    if (met) {
      if (area > 0.0) work += 0.5 * (now + last) * step;
      if (area == 0.0) force = r.force;
      area = r.area;
    }
    last = now;
  }
  // its integral is the force, kinks included
  EXPECT_NEAR(force + work, r.force, (exact(TypeParam()) ? 1e-3 : 2e-2) * (1.0 + r.force));
}

// the force of two spheres of radius 1 by their exact gap, for law foundation
double force_by_gap(const ContactMaterial &m, double delta)
{
  const int n = 100000;
  double sum = 0.0;
  for (int i = 0; i < n; i++) {
    const double height = 0.8 + 0.2 * (i + 0.5) / n, overlap = 2.0 * height - 2.0 + delta;
    const double p = overlap > m.first_touch() ? std::max(m.k * overlap, -foundation_strength(m))
                                               : 0.0;
    sum += p * 2.0 * PI * height * 0.2 / n;
  }
  return sum;
}

// two spheres of triangles: slopes add up to that of the spheres, exactly, since all pairs share
// the axis; with the exact gap, linear over each polygon, to second order in the edges of 0.15
TYPED_TEST(ContactSlope, OfWholeSpheres)
{
  const Mesh ball = icosphere(3);
  Random random = rng(3);
  for (double W : {0.0, 0.01}) {
    const ContactMaterial m = material(W, 0.02);
    for (double delta : {-0.01, 0.01, 0.04}) {
      const Vec3 shift = (2.0 - delta) * random_rotation(random).col(0);
      const Mat3 turn = random_rotation(random);
      std::vector<FaceGeometry> F, G;
      for (const auto &t : ball.faces) {
        Vec3 a[3];
        for (int k = 0; k < 3; k++) a[k] = ball.nodes[t[k]];
        F.push_back(make_face(a[0], a[1], a[2], 1.0));
        for (auto &y : a) y = turn * y + shift;
        G.push_back(make_face(a[0], a[1], a[2], 1.0));
      }
      double sum = 0.0, with_sphere = 0.0;
      ContactResult r;
      for (const auto &f : F) {
        if (face_sphere<TypeParam, true>(f, shift, 1.0, m, 4, r)) with_sphere += r.slope;
        for (const auto &g : G)
          if (face_face<TypeParam, true>(f, g, m, 4, r)) sum += r.slope;
      }
      auto force = [&](double d) {
        TypeParam s;
        if (TypeParam::LOCAL_GAP) return force_by_gap(m, d);
        return s.set(m, 0.5, d) ? s.force() : 0.0;
      };
      const double e = TypeParam::LOCAL_GAP ? 1e-4
                       : exact(TypeParam()) ? 1e-7
                                            : 0.02 * (W > 0.0 ? m.h0 : delta);
      const double whole = (force(delta + e) - force(delta - e)) / (2.0 * e);
      const double scale = m.E + m.sigma0();
      if (W == 0.0 && delta < 0.0) {
        EXPECT_EQ(sum, 0.0);
        continue;
      }
      const double tolerance = TypeParam::LOCAL_GAP ? 2e-3 : exact(TypeParam()) ? 1e-6 : 1e-3;
      EXPECT_NEAR(sum, whole, tolerance * scale) << W << " " << delta;
      EXPECT_NEAR(with_sphere, whole, tolerance * scale) << W << " " << delta;
    }
  }
}

/* ----------------------------------------------------------------------
   the block of a contact against the Jacobian of its forces
------------------------------------------------------------------------- */

namespace {

using Eigen::MatrixXd;

// -dF/dx over the six vertices, along u at both ends; radii of the spheres unchanged. Across u
// single pairs lose what their neighbors win, as edges move.
template <class State> MatrixXd minus_jacobian(Pair pair, const ContactMaterial &m, const Vec3 &u)
{
  auto forces = [&]() {
    Eigen::VectorXd F = Eigen::VectorXd::Zero(6);
    ContactResult r;
    if (!face_face<State>(pair.face(0), pair.face(1), m, 2, r)) return F;
    for (int k = 0; k < 3; k++) {
      F[k] = -r.wf[k] * u.dot(r.u);
      F[3 + k] = r.wg[k] * u.dot(r.u);
    }
    return F;
  };
  MatrixXd K(6, 6);
  const double h = 1e-6;
  for (int i = 0; i < 6; i++) {
    Vec3 &x = pair.x[i / 3][i % 3];
    const Vec3 x0 = x;
    x = x0 + h * u;
    const Eigen::VectorXd up = forces();
    x = x0 - h * u;
    K.col(i) = -(up - forces()) / (2.0 * h);
    x = x0;
  }
  return K;
}

// slope w w^T, w the weights of both faces against each other
MatrixXd block(double slope, const double *wf, const double *wg)
{
  Eigen::VectorXd w(6);
  for (int k = 0; k < 3; k++) {
    w[k] = wf[k];
    w[3 + k] = -wg[k];
  }
  return std::max(0.0, slope) * w * w.transpose();
}

// the part that resists tilt
MatrixXd tilt_block(const FaceGeometry &f, const FaceGeometry &g, const ContactResult &r)
{
  double wf[2][3], wg[2][3];
  contact_tilt(f, r.u, r.moment, wf);
  contact_tilt(g, r.u, r.moment, wg);
  return block(r.slope, wf[0], wg[0]) + block(r.slope, wf[1], wg[1]);
}

}    // namespace

// A face under the same pressure everywhere, by a sphere so large that all of it is in contact:
// int w w^T dA = A/12 (1 + I), in closed form
TEST(ContactTilt, OfAWholeFace)
{
  Random random = rng(5);
  for (int trial = 0; trial < 50; trial++) {
    const Mat3 turn = random_rotation(random);
    Vec3 x[3];
    for (int k = 0; k < 3; k++) {
      const double angle = 2.0 * PI * k / 3.0 + random.uniform();
      x[k] = turn * Vec3(std::cos(angle), std::sin(angle), 0.0);
    }
    const FaceGeometry f = make_face(x[0], x[1], x[2], 1e4);
    ContactResult r;
    ASSERT_TRUE((face_sphere<FoundationState, true>(f, f.mid + (1e4 - 0.1) * f.n, 1e4,
                                                    material(0.0), 2, r)));
    EXPECT_NEAR(r.area, f.area, 1e-6 * f.area);
    double t[2][3];
    contact_tilt(f, r.u, r.moment, t);
    Mat3 found = Vec3(r.bf[0], r.bf[1], r.bf[2]) * Vec3(r.bf[0], r.bf[1], r.bf[2]).transpose();
    for (int m = 0; m < 2; m++) {
      EXPECT_NEAR(t[m][0] + t[m][1] + t[m][2], 0.0, 1e-14);
      found += Vec3(t[m][0], t[m][1], t[m][2]) * Vec3(t[m][0], t[m][1], t[m][2]).transpose();
    }
    const Mat3 target = (Mat3::Constant(1.0) + Mat3::Identity()) / 12.0;
    EXPECT_LT((found - target).norm(), 1e-5);
  }
}

// The stress of law foundation depends on the local gap alone, so that K is nearly int (dp/d delta)
// w w^T. The mean, with the weights of the contact area, leaves out a fifth of it, most of it
// stiffness against tilt; with the tilts half of that remains (the stress is not the same all
// over). The weights of the force would do as well as the mean without adhesion, but not where
// pressure and adhesion balance.
TEST(ContactStiffness, IsTheLargestPartOfTheJacobian)
{
  Random random = rng(4);
  int met = 0;
  double rest = 0.0, rest_of_mean = 0.0, worst = 0.0, worst_adhesive = 0.0, worst_by_force = 0.0;
  for (int trial = 0; trial < 4000; trial++) {
    Pair pair(random);
    for (int side : {0, 1}) {
      pair.R[side] = 60.0;
      for (Vec3 &x : pair.x[side]) x *= 0.5;
    }
    const ContactMaterial m = material(trial % 2 ? 0.1 : 0.0);
    ContactResult r;
    const FaceGeometry f = pair.face(0), g = pair.face(1);
    if (!face_face<FoundationState, true>(f, g, m, 2, r) || !(r.slope > 0.0)) continue;
    if (Facing()(f.n.dot(r.u)) * Facing()(-g.n.dot(r.u)) < 1.0) continue;
    const MatrixXd full = minus_jacobian<FoundationState>(pair, m, r.u);
    const MatrixXd K = 0.5 * (full + full.transpose()), mean = block(r.slope, r.bf, r.bg);
    const MatrixXd B = mean + tilt_block(f, g, r);
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<MatrixXd>(B).eigenvalues()[0], -1e-12 * B.norm());
    const double error = (K - B).norm() / K.norm();
    if (m.W == 0.0) {
      met++;
      rest += error;
      rest_of_mean += (K - mean).norm() / K.norm();
      worst = std::max(worst, error);
      continue;
    }
    double wf[3], wg[3];
    for (int k = 0; k < 3; k++) {
      wf[k] = r.wf[k] / r.force;
      wg[k] = r.wg[k] / r.force;
    }
    worst_adhesive = std::max(worst_adhesive, error);
    worst_by_force = std::max(worst_by_force, (K - block(r.slope, wf, wg)).norm() / K.norm());
  }
  EXPECT_GT(met, 500);
  std::printf("left out: %.3f, by the mean alone %.3f; worst %.3f %.3f\n", rest / met,
              rest_of_mean / met, worst, worst_adhesive);
  EXPECT_LT(rest_of_mean / met, 0.25);
  EXPECT_LT(rest / met, 0.5 * rest_of_mean / met);
  EXPECT_LT(worst, 0.7);
  EXPECT_LT(worst_adhesive, 1.01);    // never worse than none
  EXPECT_GT(worst_by_force, 10.0);
}

/* ----------------------------------------------------------------------
   spheres
------------------------------------------------------------------------- */

TEST(JkrSlope, IsTheDerivative)
{
  for (const JKR &jkr : {JKR{2.0, 3.0, 0.1}, JKR{0.45, 3.0, 0.1}, JKR{2.0, 3.0, 0.0}}) {
    const double begin = jkr.pull_off_displacement(), range = 0.5 * jkr.R - begin;
    for (int i = 1; i <= 1000; i++) {
      const double delta = begin + i * range / 1000, e = 1e-6 * range;
      const double numeric = (jkr.force(delta + e) - jkr.force(delta - e)) / (2.0 * e);
      const double slope = jkr.slope_of_radius(jkr.contact_radius(delta));
      ASSERT_NEAR(slope / numeric, 1.0, 1e-5) << i;
      for (double most : {0.0, 0.4})
        for (double scale : {0.3, 1.0}) {
          const HeldJKR held = {jkr, scale, most};
          const double low = held.force(delta - e), high = held.force(delta + e);
          if (most > 0.0 && low < most && high >= most) continue;    // the kink
          ASSERT_NEAR(held.slope_of_radius(jkr.contact_radius(delta)), (high - low) / (2.0 * e),
                      1e-5 * numeric);
        }
    }
    // at pull-off, where the branch ends with slope zero
    EXPECT_LT(jkr.slope_of_radius(jkr.contact_radius(begin)), 1e-6 * jkr.E * jkr.R);
    EXPECT_EQ(jkr.slope_of_radius(0.0), 0.0);
  }
}

TEST(JkrSlope, BlockIsThePositivePartOfTheJacobian)
{
  Random random = rng(5);
  const JKR jkr = {2.0, 3.0, 0.1};
  for (double delta : {-0.02, 0.001, 0.5}) {    // attraction twice, repulsion
    const Vec3 del = (12.0 - delta) * random_rotation(random).col(0);
    auto force = [&](const Vec3 &y) {
      return Vec3(jkr.force(12.0 - y.norm()) * y / y.norm());
    };
    Mat3 J;
    const double h = 1e-5;
    for (int k = 0; k < 3; k++) {
      const Vec3 e = h * Vec3::Unit(k);
      J.col(k) = -(force(del + e) - force(del - e)) / (2.0 * h);
    }
    const double a = jkr.contact_radius(delta);
    const EdgeBlock b =
        central_stiffness_block(jkr.force_of_radius(a), jkr.slope_of_radius(a), del);
    const Mat3 K = b.iso * Mat3::Identity() + b.along * vec(b.e) * vec(b.e).transpose();
    EXPECT_GE(b.iso, 0.0);
    EXPECT_GE(b.iso + b.along, 0.0);
    const Eigen::SelfAdjointEigenSolver<Mat3> solved(J);
    Mat3 positive = Mat3::Zero();
    for (int k = 0; k < 3; k++)
      positive += std::max(0.0, solved.eigenvalues()[k]) * solved.eigenvectors().col(k) *
                  solved.eigenvectors().col(k).transpose();
    EXPECT_LT((K - positive).norm(), 1e-6 * J.norm()) << delta;
    EXPECT_EQ(b.iso > 0.0, jkr.force_of_radius(a) < 0.0);
  }
  const EdgeBlock none = central_stiffness_block(0.0, 0.0, Vec3(1, 0, 0));
  EXPECT_EQ(none.iso, 0.0);
  EXPECT_EQ(none.along, 0.0);
}
