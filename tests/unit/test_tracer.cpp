// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// law/tracer.h against closed forms: diffusion, uniform density, narrow escape,
// shares of volume; and no leaks, judged by the solid angle, which the code under test does not
// use. DCM_TRACER_REPEAT=N takes N times the tracers' steps (tools/bench tracer).

#include "moving_cells.h"
#include "law/mesh.h"
#include "law/random.h"
#include "law/tracer.h"
#include "law/voxels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <vector>

using namespace dcm_test;

namespace {

double repeat()
{
  const char *const text = std::getenv("DCM_TRACER_REPEAT");
  return text ? std::max(1.0, std::atof(text)) : 1.0;
}

double cpu_seconds()
{
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1.0e-9 * double(t.tv_nsec);
}

}    // namespace

// Mean square displacement 6 D t within three standard errors.
TEST(Tracer, FreeDiffusion)
{
  Scene::Faces none;
  Voxels voxels;
  Walk walk(none, voxels);
  const int number = 20000, steps = 20;
  const double rms = 0.3;
  double sum = 0.0, squares = 0.0;
  for (int i = 1; i <= number; i++) {
    Tracer t;
    t.x.setZero();
    for (int n = 0; n < steps; n++) walk.walk(t, step(i, n, rms));
    sum += t.x.squaredNorm() / number;
    squares += t.x.squaredNorm() * t.x.squaredNorm() / number;
  }
  const double error = std::sqrt((squares - sum * sum) / number);
  EXPECT_NEAR(sum, steps * rms * rms, 3.0 * error);
  EXPECT_LT(error, 0.01 * sum);
}

// The sign of the nearest face is that of the solid angle, on a bumpy surface and at its edges.
TEST(Tracer, SideEqualsSolidAngle)
{
  Scene scene(1, 2, 5, [](int c, const Vec3 &u, double) {
    return Vec3((R + bumps(c, u, 0.3, 0.8, 1.0)) * u);
  });
  Voxels voxels;
  voxels.build(scene.faces, 0.75, 1.0);
  Walk walk(scene.faces, voxels);
  Random random(11, 0, 0);
  int asked = 0;
  for (int n = 0; n < 20000; n++) {
    const auto &face = scene.faces[int(random.uniform() * scene.faces.size())];
    const int kind = int(3.0 * random.uniform());
    const double a = random.uniform(), b = kind == 2 ? random.uniform() * (1.0 - a) : 0.0;
    const Vec3 target = kind == 0 ? face.corner[0]
                                  : Vec3(face.corner[0] + a * (face.corner[1] - face.corner[0]) +
                                         b * (face.corner[2] - face.corner[0]));
    const Vec3 x = target + 0.3 * random.uniform() * random.unit_vector();
    const auto side = walk.side_of(x, 1, voxels.at(x));
    const double winding = scene.winding(1, x);
    ASSERT_GE(side.face, 0);
    if (std::fabs(winding - 0.5) < 0.45) continue;    // on the surface
    EXPECT_EQ(side.inside(), winding > 0.5);
    asked++;
  }
  EXPECT_GT(asked, 19000);
}

// Paths aimed at vertices and edges, grazing, begun 1e-9 of an edge from the surface: none leaks.
TEST(Tracer, AdversarialPaths)
{
  Scene scene(1, 2, 5, [](int c, const Vec3 &u, double) {
    return Vec3((R + bumps(c, u, 0.3, 0.8, 1.0)) * u);
  });
  Voxels voxels;
  voxels.build(scene.faces, 0.75, 2.2);
  Walk walk(scene.faces, voxels);
  walk.near = 2.2;
  walk.delta = 1.0e-7 * scene.edge;
  walk.most_bounces = 64;
  Random random(12, 0, 0);
  const int number = int(100000 * repeat());
  int leaks = 0, done = 0;
  for (int n = 0; n < number; n++) {
    const auto &face = scene.faces[int(random.uniform() * scene.faces.size())];
    const Vec3 p = face.corner[0], u = face.corner[1] - p, v = face.corner[2] - p;
    const int kind = int(8.0 * random.uniform());
    const double a = random.uniform(), b = random.uniform() * (1.0 - a);
    const Vec3 target = kind == 0   ? p
                        : kind == 1 ? Vec3(p + 0.5 * u)
                        : kind == 2 ? Vec3(p + a * u)
                                    : Vec3(p + a * u + b * v);
    const bool in = random.uniform() < 0.5;
    const double off = kind == 3   ? 2.0e-7 * scene.edge
                       : kind == 4 ? 1.0e-9 * scene.edge
                                   : 0.8 * (0.01 + random.uniform());
    Tracer t;
    t.home = in ? 1 : Tracer::OUTSIDE;
    t.x = kind >= 3 && kind <= 5 ? Vec3(target + (in ? -off : off) * face.normal)
                                 : Vec3(target + 0.9 * random.uniform() * random.unit_vector());
    if (std::fabs(scene.winding(1, t.x) - (in ? 1.0 : 0.0)) > 0.3) continue;    // not a fair start
    Vec3 d;
    if (kind == 3 || kind == 4 || kind == 6) {    // along the face
      d = random.unit_vector();
      d -= (1.0 - (kind == 6 ? 0.0 : 1.0e-9 * (random.uniform() - 0.5))) * d.dot(face.normal) *
           face.normal;
      d = (kind == 6 ? 1.9 : 1.5 * random.uniform()) * d.normalized();
    } else {
      d = (target - t.x) * (kind < 3 ? 2.0 : 1.0 + random.uniform());
    }
    if (d.norm() > 1.95) d *= 1.95 / d.norm();
    walk.walk(t, d);
    done++;
    if (std::fabs(scene.winding(1, t.x) - (in ? 1.0 : 0.0)) > 0.5) leaks++;
  }
  std::printf("  %d paths, %lld bounces, %d leaks, %lld rejected, %lld capped\n", done,
              (long long) walk.count.bounces, leaks, (long long) walk.count.rejected,
              (long long) walk.count.capped);
  EXPECT_EQ(leaks, 0);
  EXPECT_GT(done, 0.65 * number);
  EXPECT_GT(walk.count.bounces, done / 2);
}

// Closed cell at rest: nobody leaves, and the density stays uniform (Kolmogorov-Smirnov on the
// radial coordinate cubed), for steps from a fifth of an edge to two edges.
TEST(Tracer, ClosedCell)
{
  for (const double relative : {0.2, 0.5, 1.0, 2.0}) {
    Scene scene(1, 2, 3, round_cell);
    const double rms = relative * scene.edge;
    Voxels voxels;
    const double near = std::clamp(1.2 * rms, 1.0, 2.2);
    voxels.build(scene.faces, 0.75, near);
    Walk walk(scene.faces, voxels);
    walk.near = near;
    walk.delta = 1.0e-7 * scene.edge;
    const int number = 2000, steps = int(300 * repeat());
    auto tracers = filled(number);
    std::vector<double> cubes;
    int wrong = 0;
    double seconds = 0.0;
    for (int n = 1; n <= steps; n++) {
      const double start = cpu_seconds();
      for (int i = 0; i < number; i++) walk.walk(tracers[i], step(i + 1, n, rms));
      seconds += cpu_seconds() - start;
      // looks far apart, after the first relaxation: R^2 / (pi^2 D) is 6 to 60 steps' time
      if (n % (steps / 3) != 0) continue;
      for (const Tracer &t : tracers) {
        const double lambda = scene.lambda(t.x);
        if (lambda > 1.0 || t.home != 1 || scene.wrong(t)) wrong++;
        if (n == steps) cubes.push_back(lambda * lambda * lambda);
      }
    }
    std::sort(cubes.begin(), cubes.end());
    double distance = 0.0;
    for (size_t i = 0; i < cubes.size(); i++)
      distance = std::max(distance, std::fabs(cubes[i] - (double(i) + 0.5) / double(cubes.size())));
    distance *= std::sqrt(double(cubes.size()));
    std::printf("  step %.1f edges: %lld steps, %d wrong, KS %.2f, %lld rejected, %lld capped, "
                "%.2f bounces and %.0f ns a step\n",
                relative, (long long) walk.count.steps, wrong, distance,
                (long long) walk.count.rejected, (long long) walk.count.capped,
                double(walk.count.bounces) / double(walk.count.steps),
                1.0e9 * seconds / double(walk.count.steps));
    EXPECT_EQ(wrong, 0);
    EXPECT_LT(distance, 1.63);    // 1 %
  }
}

// Mean time to leave through a cap: narrow escape, V/(4 D a) with the terms of order a/R of one
// window in a sphere (Cheviakov, Ward and Straube, Multiscale Model. Simul. 8 (2010) 836), and
// nobody leaves elsewhere.
TEST(Tracer, NarrowEscape)
{
  Scene scene(1, 2, 17, round_cell);
  double cap = 0.0, volume = 0.0;
  const Vec3 axis(1.0, 0.0, 0.0);
  for (auto &f : scene.faces) {
    const double area = 0.5 * (f.corner[1] - f.corner[0]).cross(f.corner[2] - f.corner[0]).norm();
    f.open = f.mid.normalized().dot(axis) > 0.87;
    if (f.open) cap += area;
    volume += area * f.mid.dot(f.normal) / 3.0;
  }
  Voxels voxels;
  voxels.build(scene.faces, 0.75, 1.0);
  Walk walk(scene.faces, voxels);
  walk.delta = 1.0e-7 * scene.edge;
  const double rms = 0.3, D = 0.01, dt = rms * rms / (6.0 * D);
  const int number = int(800 * repeat());
  double sum = 0.0, squares = 0.0;
  int elsewhere = 0, back = 0;
  auto tracers = filled(number);
  for (int i = 0; i < number; i++) {
    Tracer &t = tracers[i];
    int n = 0;
    while (t.home != Tracer::OUTSIDE) walk.walk(t, step(i + 1, ++n, rms));
    sum += n * dt / number;
    squares += n * dt * n * dt / number;
    // within a step of the open faces, and outside for good
    if (t.x.normalized().dot(axis) < 0.87 - 0.25) elsewhere++;
    for (int m = 0; m < 100; m++) walk.walk(t, step(i + 1, ++n, rms));
    if (t.home != Tracer::OUTSIDE || scene.wrong(t)) back++;
  }
  const double a = std::sqrt(cap / PI), leading = volume / (4.0 * D * a);
  const double e = a / std::cbrt(0.75 * volume / PI);
  const double escape =
      leading * (1.0 + e / PI * (std::log(2.0 / e) - 1.8 - 2.0 * std::log(2.0) + 1.5));
  const double error = std::sqrt((squares - sum * sum) / number);
  std::printf(
      "  mean exit time %.0f +- %.0f s, narrow escape %.0f s, V/(4 D a) %.0f s; %lld exits\n", sum,
      error, escape, leading, (long long) walk.count.exits);
  // 5 %, or three standard errors of this sample
  EXPECT_NEAR(sum, escape, std::max(0.05 * escape, 3.0 * error));
  EXPECT_EQ(walk.count.exits, number);
  EXPECT_EQ(elsewhere, 0);
  EXPECT_EQ(back, 0);
}

// Three cells that wobble, turn, touch and part: no tracer on the wrong side, none without a place,
// none comes back in, those caught in closing gaps come free again.
TEST(Tracer, MovingCells)
{
  struct Case {
    int level;
    double speed, step;    // displacement of the fastest node and rms step, in edges
  };
  for (const Case &it :
       {Case{2, 0.02, 0.3}, Case{2, 0.1, 0.05}, Case{2, 0.1, 1.0}, Case{3, 0.1, 2.0}}) {
    auto gap = [](double t) {
      return 0.2 + 0.3 * std::sin(0.37 * t);    // closed for a third of the time
    };
    Scene scene(3, it.level, 7, [gap](int c, const Vec3 &u, double t) {
      auto axis = [t](int k) {
        const double a = 2.0 * PI * k / 3.0 + 0.02 * t;
        return Vec3(std::cos(a), std::sin(a), 0.0);
      };
      Vec3 y = 6.1 * axis(c) + Vec3(0.0, 0.0, 0.2 * std::sin(0.11 * t + c)) +
               (R + bumps(c, u, t, 0.35, 0.5)) * u;
      for (int k = 1; k <= 2; k++) {    // flattened toward both neighbors
        const Vec3 toward = (axis((c + k) % 3) - axis(c)).normalized();
        const double over = y.dot(toward) + 0.5 * gap(t);
        if (over > 0.0) y -= over * toward;
      }
      return y;
    });
    for (auto &f : scene.faces) {    // open toward the axis
      const double a = 2.0 * PI * double(f.cell - 1) / 3.0;
      const Vec3 toward(-std::cos(a), -std::sin(a), 0.0);
      f.open = toward.dot((f.mid + 6.1 * toward).normalized()) > 0.8;
    }
    const double rms = it.step * scene.edge, near = std::clamp(1.3 * rms, 1.0, 2.2);
    Voxels voxels;
    voxels.build(scene.faces, 0.75, 1.1 * near);
    Walk walk(scene.faces, voxels);
    walk.near = near;
    walk.delta = 1.0e-7 * scene.edge;
    walk.wall_lo = Vec3(-16.0, -16.0, -9.0);
    walk.wall_hi = -walk.wall_lo;
    std::vector<Tracer> tracers;
    Random random(5, 0, 0);
    while (tracers.size() < 1000) {
      Tracer t;
      t.x = Vec3(-16.0 + 32.0 * random.uniform(), -16.0 + 32.0 * random.uniform(),
                 -9.0 + 18.0 * random.uniform());
      int within = 0;
      for (int c = 1; c <= 3; c++)
        if (scene.winding(c, t.x) > 0.5) {
          within++;
          t.home = c;
        }
      if (within < 2 && (within == 1 || random.uniform() < 0.4)) tracers.push_back(t);
    }
    const double dt = 0.01 * it.speed * scene.edge / scene.place(0.01);
    scene.place(0.0);
    const int steps = int(400 * repeat());
    double t = 0.0, moved_since = 0.0;
    int wrong = 0, reentered = 0, without = 0, asked = 0;
    for (int n = 1; n <= steps; n++) {
      t += dt;
      const double moved = scene.place(t);
      moved_since += moved;
      if (moved_since > 0.09 * near) {
        voxels.build(scene.faces, 0.75, 1.1 * near);
        moved_since = 0.0;
      }
      for (size_t i = 0; i < tracers.size(); i++) {
        const auto home = tracers[i].home;
        if (!walk.settle(tracers[i], moved)) without++;
        walk.walk(tracers[i], step(int(i) + 1, n, rms));
        if (tracers[i].home != home && tracers[i].home != Tracer::OUTSIDE) reentered++;
      }
      if (n % (steps / 8) != 0) continue;
      for (const auto &it : tracers)
        if (it.host < 0) {
          asked++;
          wrong += scene.wrong(it);
        }
    }
    const auto &count = walk.count;
    std::printf("  level %d, %.2f and %.2f edges a step: %lld steps, wrong %d of %d, swept %lld, "
                "caught %lld, released %lld, exits %lld, rejected %lld, capped %lld, blocked "
                "%lld\n",
                it.level, it.speed, it.step, (long long) count.steps, wrong, asked,
                (long long) count.swept, (long long) count.caught, (long long) count.released,
                (long long) count.exits, (long long) count.rejected, (long long) count.capped,
                (long long) count.blocked);
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(reentered, 0);
    EXPECT_EQ(without, 0);
    EXPECT_GT(count.swept, 0);
    EXPECT_GT(count.exits, 0);
  }
}

// Two flat cells and a gap, opposite faces in contact: while the slit is shut nobody gets into one
// below the range of the rule; a wider one, or one that is open, holds its share of the volume.
TEST(Tracer, Slit)
{
  struct Case {
    double gap, range;
  };
  for (const Case &it : {Case{0.2, 0.35}, Case{0.3, 0.0}, Case{0.8, 0.35}, Case{-0.05, 0.0}}) {
    const double gap = it.gap;
    Scene scene(2, 2, 13, [gap](int c, const Vec3 &u, double) {
      const double sign = c ? 1.0 : -1.0;
      Vec3 y = Vec3(0.0, 0.0, 5.0 * sign) + R * u;
      if (sign * y[2] < 0.5 * gap) y[2] = 0.5 * sign * gap;
      return y;
    });
    // in contact: what is flat and nearer than the range of adhesion
    for (auto &f : scene.faces)
      f.shut = gap < 0.35 && std::fabs(f.mid[2]) < 0.5 * std::fabs(gap) + 1.0e-6;
    const double rms = 0.3, half = 5.0, high = 1.5;
    Voxels voxels;
    voxels.build(scene.faces, 0.75, 1.0);
    Walk walk(scene.faces, voxels);
    walk.delta = 1.0e-7 * scene.edge;
    walk.shut_range = it.range;
    walk.wall_lo = Vec3(-half, -half, -high);
    walk.wall_hi = -walk.wall_lo;
    // the middle of the gap, and its share of the volume by points thrown at random
    // which ends where the nearest face may be one of the rim, which is not flat and not shut
    double radius = 2.0;
    for (const auto &f : scene.faces)
      if (it.range > 0.0 && gap < it.range && !f.shut) {
        const Vec3 axis(0.0, 0.0, std::copysign(0.5 * gap, f.mid[2]));
        radius = std::min(radius, (f.nearest(axis) - axis).norm() - 0.5 * gap - 0.01);
      }
    auto in_gap = [&](const Vec3 &x) {
      return x.head<2>().norm() < radius && std::fabs(x[2]) <= 0.5 * std::fabs(gap) + 1.0e-9;
    };
    Random random(5, 0, 0);
    std::vector<Tracer> tracers;
    double free = 0.0;
    const int thrown = 40000, number = 1000;
    for (int n = 0; n < thrown; n++) {
      Tracer t;
      t.x = Vec3(half * (2.0 * random.uniform() - 1.0), half * (2.0 * random.uniform() - 1.0),
                 high * (2.0 * random.uniform() - 1.0));
      if (scene.wrong(t)) continue;
      free += 1.0 / thrown;
      // begin anywhere outside, where slits are shut not in them
      if (int(tracers.size()) < number && !(it.range > 0.0 && gap < it.range && walk.in_slit(t.x)))
        tracers.push_back(t);
    }
    const double volume = 8.0 * half * half * high * free;
    const double share = std::max(0.0, gap) * PI * radius * radius / volume;
    const int steps = int(600 * repeat()), burn = steps / 4;
    std::vector<double> seen(tracers.size(), 0.0);
    int wrong = 0, looks = 0;
    for (int n = 1; n <= steps; n++) {
      for (size_t i = 0; i < tracers.size(); i++) walk.walk(tracers[i], step(int(i) + 1, n, rms));
      if (n < burn || n % 5 != 0) continue;
      looks++;
      for (size_t i = 0; i < tracers.size(); i++) seen[i] += in_gap(tracers[i].x);
    }
    for (const Tracer &t : tracers) wrong += scene.wrong(t);
    double mean = 0.0, squares = 0.0;
    for (const double n : seen) {
      mean += n / looks / double(seen.size());
      squares += n * n / looks / looks / double(seen.size());
    }
    const double error = std::sqrt((squares - mean * mean) / double(seen.size()));
    const double error_free = share * std::sqrt((1.0 - free) / free / thrown);
    std::printf("  gap %5.2f, shut below %.2f: share %.4f +- %.4f, of the volume %.4f\n", gap,
                it.range, mean, error, share);
    EXPECT_EQ(wrong, 0);
    if (gap < it.range || gap < 0.0) {
      EXPECT_EQ(mean, 0.0);
    } else {
      EXPECT_NEAR(mean, share, 3.0 * std::hypot(error, error_free));
    }
  }
}

// A gap closes on 1000 tracers and opens again: all are caught, none is inside a cell, all come
// free. Also at 0.1 um between cells of 642 nodes.
TEST(Tracer, GapCloses)
{
  double gap = 0.1;
  Scene scene(2, 3, 13, [&gap](int c, const Vec3 &u, double) {
    const double sign = c ? 1.0 : -1.0;
    Vec3 y = Vec3(0.0, 0.0, 5.0 * sign) + R * u;
    if (sign * y[2] < 0.5 * gap) y[2] = 0.5 * sign * gap;
    return y;
  });
  Voxels voxels;
  voxels.build(scene.faces, 0.75, 1.2);
  Walk walk(scene.faces, voxels);
  walk.delta = 1.0e-7 * scene.edge;
  std::vector<Tracer> tracers(1000);
  Random random(8, 0, 0);
  for (Tracer &t : tracers) {
    const double r = 2.0 * std::sqrt(random.uniform()), phi = 2.0 * PI * random.uniform();
    t.x = Vec3(r * std::cos(phi), r * std::sin(phi), 0.09 * (random.uniform() - 0.5));
  }
  for (int n = 0; n < 40; n++) {
    gap = 0.1 - 0.01 * std::min(n, 39 - n);    // to -0.09 and back
    const double moved = scene.place(0.0);
    for (size_t i = 0; i < tracers.size(); i++) {
      ASSERT_TRUE(walk.settle(tracers[i], moved));
      walk.walk(tracers[i], step(int(i) + 1, n, 0.02));
      if (tracers[i].host < 0) {
        ASSERT_FALSE(scene.wrong(tracers[i])) << n;
      }
    }
    const auto caught = std::count_if(tracers.begin(), tracers.end(), [](const Tracer &t) {
      return t.host >= 0;
    });
    if (gap < -0.005) {
      EXPECT_GT(caught, 900) << gap;
    } else if (n > 30 && gap > 0.02) {
      EXPECT_EQ(caught, 0) << gap;
    }
  }
  EXPECT_EQ(walk.count.caught, walk.count.released);
}

// What a walk does depends neither on the order of the faces nor on the voxels.
TEST(Tracer, IndependentOfOrderAndVoxels)
{
  Scene scene(1, 2, 5, [](int c, const Vec3 &u, double) {
    return Vec3((R + bumps(c, u, 0.3, 0.8, 1.0)) * u);
  });
  Scene::Faces reversed(scene.faces.rbegin(), scene.faces.rend());
  Voxels coarse, fine;
  coarse.build(scene.faces, 2.0, 1.7);
  fine.build(reversed, 0.5, 1.5);
  Walk one(scene.faces, coarse), other(reversed, fine);
  for (Walk *walk : {&one, &other}) {
    walk->near = 1.5;
    walk->delta = 1.0e-7 * scene.edge;
  }
  auto a = filled(500), b = a;
  for (int n = 1; n <= 200; n++)
    for (size_t i = 0; i < a.size(); i++) {
      // half of them to corners and edges, where several faces are met at once
      const auto &face = scene.faces[(i * 31 + n) % scene.faces.size()];
      const Vec3 target = n % 4 ? face.corner[0] : Vec3(0.5 * (face.corner[0] + face.corner[1]));
      const Vec3 d = i % 2 && (target - a[i].x).norm() < 3.0 ? Vec3(2.0 * (target - a[i].x))
                                                             : step(int(i) + 1, n, 1.5);
      one.walk(a[i], d);
      other.walk(b[i], d);
      ASSERT_EQ(a[i].x, b[i].x);
      ASSERT_EQ(a[i].home, b[i].home);
    }
  EXPECT_EQ(one.count.bounces, other.count.bounces);
}
