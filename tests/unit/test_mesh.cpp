// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Meshes: icospheres, edges and hinges, files, and every fault check_mesh() must name.

#include "law/hinge.h"
#include "law/mesh.h"
#include "law/mesh_io.h"
#include "law/mesh_overlap.h"
#include "law/self_crossing.h"
#include "helpers.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

#include <unistd.h>

using namespace dcm;
using namespace dcm_test;

namespace {

bool contains(const std::string &text, const std::string &part)
{
  return text.find(part) != std::string::npos;
}

Mesh cube()
{
  Mesh m;
  for (int i = 0; i < 8; i++) m.nodes.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  m.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

Mesh tetrahedron(const Vec3 &shift)
{
  Mesh m;
  m.nodes = {shift, shift + Vec3::UnitX(), shift + Vec3::UnitY(), shift + Vec3::UnitZ()};
  m.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return m;
}

Mesh joined(const Mesh &a, const Mesh &b)
{
  Mesh m = a;
  const int n = int(a.nodes.size());
  m.nodes.insert(m.nodes.end(), b.nodes.begin(), b.nodes.end());
  for (const auto &f : b.faces) m.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  return m;
}

// a torus of n x n nodes
Mesh torus(int n)
{
  Mesh m;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      const double u = 2.0 * PI * i / n, v = 2.0 * PI * j / n;
      const double r = 2.0 + 0.7 * std::cos(v);
      m.nodes.emplace_back(r * std::cos(u), r * std::sin(u), 0.7 * std::sin(v));
    }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      const int p = i * n + j, q = i * n + (j + 1) % n;
      const int r = (i + 1) % n * n + j, s = (i + 1) % n * n + (j + 1) % n;
      m.faces.push_back({p, r, s});
      m.faces.push_back({p, s, q});
    }
  return m;
}

// folder of this process: concurrent runs of the tests do not meet, and nothing stays behind
struct Scratch {
  std::filesystem::path path;
  Scratch() :
      path(std::filesystem::path(testing::TempDir()) / ("dcm_unit_" + std::to_string(getpid())))
  {
    std::filesystem::create_directories(path);
  }
  ~Scratch()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

std::string written(const std::string &name, const std::string &text)
{
  static const Scratch scratch;
  const std::string path = (scratch.path / name).string();
  std::ofstream(path) << text;
  return path;
}

// message of the error read_mesh() throws; "no error" if it does not
std::string read_error(const std::string &path)
{
  try {
    read_mesh(path);
  } catch (const std::runtime_error &e) {
    return e.what();
  }
  return "no error";
}

std::string off_text(const Mesh &m)
{
  std::string text = "OFF\n# made by a test\n" + std::to_string(m.nodes.size()) + " " +
                     std::to_string(m.faces.size()) + " 0\n";
  char line[128];
  for (const Vec3 &x : m.nodes) {
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", x[0], x[1], x[2]);
    text += line;
  }
  for (const auto &f : m.faces) {
    std::snprintf(line, sizeof line, "3 %d %d %d\n", f[0], f[1], f[2]);
    text += line;
  }
  return text;
}

std::string obj_text(const Mesh &m)
{
  std::string text = "# made by a test\nmtllib none.mtl\no cell\n";
  char line[128];
  for (const Vec3 &x : m.nodes) {
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\nvn 0 0 1\n", x[0], x[1], x[2]);
    text += line;
  }
  text += "s off\n";
  for (const auto &f : m.faces) {
    std::snprintf(line, sizeof line, "f %d//%d %d/7/1 %d\n", f[0] + 1, f[0] + 1, f[1] + 1,
                  f[2] + 1);
    text += line;
  }
  return text;
}

}    // namespace

TEST(Mesh, Icospheres)
{
  const size_t nodes[5] = {42, 162, 642, 2562, 10242};
  for (int level = 1; level <= 5; level++) {
    const Mesh m = icosphere(level);
    EXPECT_EQ(m.nodes.size(), nodes[level - 1]);
    EXPECT_EQ(m.faces.size(), 2 * nodes[level - 1] - 4);
    EXPECT_EQ(check_mesh(m), "");
    for (const Vec3 &x : m.nodes) EXPECT_NEAR(x.norm(), 1.0, 1.0e-15);
    EXPECT_EQ(edges(m).size(), 3 * nodes[level - 1] - 6);
    EXPECT_EQ(hinges(m).size(), edges(m).size());
    // inscribed in the sphere: below its volume and area, by second order in the edge
    const double e = mean_edge(m);
    EXPECT_LT(volume(m), 4.0 * PI / 3.0);
    EXPECT_GT(volume(m), 4.0 * PI / 3.0 * (1.0 - 0.5 * e * e));
    EXPECT_LT(area(m), 4.0 * PI);
    EXPECT_GT(area(m), 4.0 * PI * (1.0 - 0.5 * e * e));
  }
  EXPECT_THROW(icosphere(0), std::invalid_argument);
  EXPECT_THROW(icosphere(6), std::invalid_argument);
}

TEST(Mesh, Cube)
{
  Mesh m = cube();
  EXPECT_EQ(check_mesh(m), "");
  EXPECT_NEAR(volume(m), 1.0, 1.0e-15);
  EXPECT_NEAR(area(m), 6.0, 1.0e-15);
  EXPECT_NEAR(mean_edge(m), (12.0 + 6.0 * std::sqrt(2.0)) / 18.0, 1.0e-15);
  for (Vec3 &x : m.nodes) x += Vec3(1.0e6, -1.0e6, 1.0e6);
  EXPECT_NEAR(volume(m), 1.0, 1.0e-9);
}

TEST(Mesh, SelfCrossing)
{
  const std::array<int, 2> none = {-1, -1};
  for (int level = 1; level <= 4; level++) EXPECT_EQ(self_crossing(icosphere(level)), none);
  EXPECT_EQ(self_crossing(cube()), none);
  // one node of a sphere pulled through the other side: its faces cross those there
  Mesh m = icosphere(2);
  const Vec3 before = m.nodes[7];
  m.nodes[7] = -1.5 * before;
  const auto found = self_crossing(m);
  ASSERT_GE(found[0], 0);
  bool own = false;
  for (const int f : found)
    for (const int i : m.faces[f]) own = own || i == 7;
  EXPECT_TRUE(own);
  m.nodes[7] = 0.2 * before;    // a dent, not through
  EXPECT_EQ(self_crossing(m), none);
}

TEST(Mesh, Pierces)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_TRUE(pierces({0.2, 0.2, -1}, {0.3, 0.2, 1}, a, b, c));
  EXPECT_TRUE(pierces({0.2, 0.2, 1}, {0.3, 0.2, -1}, a, b, c));
  EXPECT_FALSE(pierces({0.2, 0.2, 1}, {0.3, 0.2, 2}, a, b, c));     // ends before it
  EXPECT_FALSE(pierces({0.9, 0.9, -1}, {0.9, 0.9, 1}, a, b, c));    // beside it
  EXPECT_FALSE(pierces({0.2, 0.2, 0}, {0.3, 0.3, 1}, a, b, c));     // from its plane
  EXPECT_FALSE(pierces({-1, 0.2, 0}, {1, 0.2, 0}, a, b, c));        // in its plane
}

TEST(Mesh, Overlap)
{
  // a cube of side 1: the corner of another reaches into it by 0.3, its nearest side is as far away
  const Envelope box(cube());
  auto found = mesh_overlap(box, cube(), {0.7, 0.6, 0.5});
  EXPECT_NEAR(found.depth, 0.3, 1.0e-12);
  EXPECT_EQ(found.node, 0);
  found = mesh_overlap(box, cube(), {-0.6, -0.75, -0.7});
  EXPECT_NEAR(found.depth, 0.25, 1.0e-12);
  EXPECT_EQ(found.node, 7);
  for (const Vec3 &apart : {Vec3(1.0, 0.0, 0.0), Vec3(0.0, -1.2, 0.3), Vec3(0.9, 0.9, 1.1)}) {
    EXPECT_EQ(mesh_overlap(box, cube(), apart).depth, 0.0);
    EXPECT_EQ(mesh_overlap(box, cube(), apart).node, -1);
  }

  // balls at distance d: the deepest point of one is (2 - d) inside the other
  const Mesh ball = icosphere(4);
  const Envelope inside(ball);
  for (const double d : {1.9, 1.5, 1.2})
    EXPECT_NEAR(mesh_overlap(inside, ball, d * ball.nodes[7]).depth, 2.0 - d, 5.0e-3);

  // one in the other, and one that coincides with it, of which no node is inside
  Mesh small = ball;
  for (Vec3 &x : small.nodes) x *= 0.25;
  EXPECT_GT(mesh_overlap(inside, small, Vec3::Zero()).depth, 0.74);
  EXPECT_GT(mesh_overlap(inside, ball, Vec3::Zero()).depth, 0.99);

  // the middle of a face that lies flat inside while all its nodes are outside
  Mesh plate;
  plate.nodes = {{-2, -2, 0.4}, {4, -1.9, 0.4}, {-1.9, 4, 0.4}, {0.5, 0.5, 3}};
  plate.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  found = mesh_overlap(box, plate, Vec3::Zero());
  EXPECT_EQ(found.node, -1);
  EXPECT_NEAR(found.depth, 1.0 / 30.0, 1.0e-12);
}

TEST(Mesh, EdgesAndHinges)
{
  const Mesh m = icosphere(2);
  std::set<std::array<int, 3>> faces;    // each face in its three rotations
  for (const auto &f : m.faces)
    for (int k = 0; k < 3; k++) faces.insert({f[k], f[(k + 1) % 3], f[(k + 2) % 3]});
  const auto list = edges(m);
  EXPECT_EQ(std::set(list.begin(), list.end()).size(), list.size());
  const auto bends = hinges(m);
  for (size_t i = 0; i < bends.size(); i++) {
    const auto &q = bends[i];
    EXPECT_EQ((std::array<int, 2>{q[1], q[2]}), list[i]);
    EXPECT_TRUE(faces.count({q[1], q[2], q[0]}));
    EXPECT_TRUE(faces.count({q[2], q[1], q[3]}));
  }
  // cube: twelve right angles, six flat diagonals
  const Mesh c = cube();
  int right = 0, flat = 0;
  for (const auto &q : hinges(c)) {
    const double theta = hinge_angle(c.nodes[q[0]], c.nodes[q[1]], c.nodes[q[2]], c.nodes[q[3]]);
    right += std::fabs(theta - 0.5 * PI) < 1.0e-14;
    flat += std::fabs(theta) < 1.0e-14;
  }
  EXPECT_EQ(right, 12);
  EXPECT_EQ(flat, 6);
}

TEST(Mesh, HingesOfBadMeshes)
{
  Mesh open = cube();
  open.faces.pop_back();
  EXPECT_EQ(hinges(open).size(), 15u);    // the three sides of the hole have none
  Mesh bad = cube();
  std::swap(bad.faces[3][0], bad.faces[3][1]);
  EXPECT_THROW(hinges(bad), std::invalid_argument);
}

TEST(Mesh, RenumberingAndRotation)
{
  Random random(15, 0, 0);
  const Mesh m = icosphere(2);
  std::vector<int> order(m.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  for (size_t i = order.size() - 1; i > 0; i--)
    std::swap(order[i], order[size_t(random.uniform() * double(i + 1))]);
  const Mat3 rotation = random_rotation(random);
  Mesh r = m;
  for (size_t i = 0; i < order.size(); i++) r.nodes[order[i]] = rotation * m.nodes[i];
  for (auto &f : r.faces) f = {order[f[1]], order[f[2]], order[f[0]]};
  EXPECT_EQ(check_mesh(r), "");
  EXPECT_NEAR(volume(r), volume(m), 1.0e-13);
  EXPECT_NEAR(area(r), area(m), 1.0e-13);
  EXPECT_NEAR(mean_edge(r), mean_edge(m), 1.0e-14);
  double a = 0.0, b = 0.0;
  for (const auto &q : hinges(m))
    a += hinge_angle(m.nodes[q[0]], m.nodes[q[1]], m.nodes[q[2]], m.nodes[q[3]]);
  for (const auto &q : hinges(r))
    b += hinge_angle(r.nodes[q[0]], r.nodes[q[1]], r.nodes[q[2]], r.nodes[q[3]]);
  EXPECT_NEAR(a, b, 1.0e-11);
}

TEST(Mesh, QualityOfFaces)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0.5, std::sqrt(0.75), 0);
  EXPECT_NEAR(face_quality(a, b, c), 1.0, 1.0e-15);
  EXPECT_NEAR(face_quality(7.0 * a, 7.0 * b, 7.0 * c), 1.0, 1.0e-15);
  EXPECT_EQ(face_quality(a, b, 3.0 * b), 0.0);
  // stretched by s in any direction of its plane
  for (double s : {1.5, 3.0, 10.0})
    for (double turn : {0.0, 0.4, 1.1}) {
      const Vec3 along(std::cos(turn), std::sin(turn), 0.0);
      auto stretched = [&](const Vec3 &x) {
        return Vec3(x + (s - 1.0) * x.dot(along) * along);
      };
      EXPECT_NEAR(face_quality(stretched(a), stretched(b), stretched(c)), 2.0 * s / (1.0 + s * s),
                  1.0e-14);
    }
  Mesh mesh = icosphere(1);
  const double before = worst_face(mesh);
  EXPECT_GT(before, 0.9);
  mesh.nodes[0] = 0.99 * mesh.nodes[mesh.faces[0][1]] + 0.01 * mesh.nodes[mesh.faces[0][0]];
  double worst = 1.0;
  for (const auto &f : mesh.faces)
    worst = std::min(worst, face_quality(mesh.nodes[f[0]], mesh.nodes[f[1]], mesh.nodes[f[2]]));
  EXPECT_LT(worst, 0.5);
  EXPECT_EQ(worst_face(mesh), worst);
}

TEST(MeshCheck, NamesEveryFault)
{
  const Mesh good = cube();
  EXPECT_TRUE(contains(check_mesh(Mesh()), "no nodes"));
  Mesh m = good;
  m.faces.clear();
  EXPECT_TRUE(contains(check_mesh(m), "no faces"));

  for (double x : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    m = good;
    m.nodes[3][1] = x;
    EXPECT_TRUE(contains(check_mesh(m), "node 4 has a coordinate that is not finite"));
  }
  for (int i : {-1, 8}) {
    m = good;
    m.faces[5][2] = i;
    EXPECT_TRUE(contains(check_mesh(m), "face 6 refers to node " + std::to_string(i + 1)));
  }
  m = good;
  m.faces[2] = {4, 4, 6};
  EXPECT_TRUE(contains(check_mesh(m), "face 3 is degenerate: it names a node twice"));

  m = good;
  m.nodes.emplace_back(5, 5, 5);
  EXPECT_TRUE(contains(check_mesh(m), "node 9 is isolated"));

  m = joined(good, tetrahedron(Vec3(1, 1, 1)));    // its first node is the cube's last
  EXPECT_TRUE(contains(check_mesh(m), "node 8 and node 9 lie in the same place"));
  m = good;
  for (Vec3 &x : m.nodes) x.setZero();
  EXPECT_TRUE(contains(check_mesh(m), "in one point"));

  m = good;
  m.faces.pop_back();
  EXPECT_TRUE(contains(check_mesh(m), "the surface is open")) << check_mesh(m);

  m = good;
  m.nodes.emplace_back(0.3, -1, -1);
  m.faces.push_back({0, 1, 8});
  m.faces.push_back({1, 0, 8});
  EXPECT_TRUE(contains(check_mesh(m), "the edge between nodes 1 and 2 is shared by 4 faces"))
      << check_mesh(m);

  m = good;
  std::swap(m.faces[3][0], m.faces[3][1]);
  const std::string flipped = check_mesh(m);
  EXPECT_TRUE(contains(flipped, "not oriented alike")) << flipped;
  EXPECT_TRUE(contains(flipped, "4")) << flipped;

  m = good;
  for (auto &f : m.faces) std::swap(f[0], f[1]);
  EXPECT_TRUE(contains(check_mesh(m), "flip all faces"));

  m = joined(good, tetrahedron(Vec3(5, 0, 0)));
  EXPECT_TRUE(contains(check_mesh(m), "more than one component: node 9")) << check_mesh(m);

  EXPECT_TRUE(contains(check_mesh(torus(12)), "Euler characteristic (nodes - edges + faces) is 0"))
      << check_mesh(torus(12));

  // two tetrahedra that share one node
  m = joined(tetrahedron(Vec3(0, 0, 0)), tetrahedron(Vec3(2, 2, 2)));
  m.nodes.erase(m.nodes.begin() + 4);
  for (size_t f = 4; f < 8; f++)
    for (int &i : m.faces[f]) i = i == 4 ? 3 : i - 1;
  EXPECT_TRUE(contains(check_mesh(m), "touches itself at node 4")) << check_mesh(m);
}

TEST(MeshCheck, DegenerateFacesInAnyUnit)
{
  for (double unit : {1.0e-9, 1.0, 1.0e9}) {
    Mesh m = icosphere(1);
    for (Vec3 &x : m.nodes) x *= unit;
    EXPECT_EQ(check_mesh(m), "");
    // pull one corner of face 1 onto the opposite side
    const auto f = m.faces[0];
    m.nodes[f[0]] = 0.4 * m.nodes[f[1]] + 0.6 * m.nodes[f[2]];
    EXPECT_TRUE(contains(check_mesh(m), "face 1 is degenerate")) << check_mesh(m);
  }
}

TEST(MeshFile, RoundTrip)
{
  const Mesh m = icosphere(1);
  for (const std::string &path : {written("a.off", off_text(m)), written("a.OBJ", obj_text(m))}) {
    const Mesh r = read_mesh(path);
    ASSERT_EQ(r.nodes.size(), m.nodes.size());
    ASSERT_EQ(r.faces, m.faces);
    for (size_t i = 0; i < m.nodes.size(); i++) EXPECT_EQ(r.nodes[i], m.nodes[i]);
  }
  // Windows line ends, counts on the first line, comments, colors behind faces, relative indices
  const char *off = "OFF 4 4 6 # counts\r\n0 0 0\r\n1 0 0\r\n\r\n0 1 0\r\n0 0 1\r\n"
                    "3 0 2 1 255 0 0\r\n3 0 1 3\r\n3 0 3 2\r\n3 1 2 3";
  EXPECT_EQ(read_mesh(written("b.off", off)).faces, tetrahedron(Vec3::Zero()).faces);
  const char *obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf -4 -2 -3\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  EXPECT_EQ(read_mesh(written("b.obj", obj)).faces, tetrahedron(Vec3::Zero()).faces);
}

TEST(MeshFile, MissingAndUnknown)
{
  const std::string missing = read_error("/nonexistent/cell.off");
  EXPECT_TRUE(contains(missing, "/nonexistent/cell.off")) << missing;
  EXPECT_TRUE(contains(missing, "cannot open")) << missing;
  EXPECT_TRUE(contains(read_error("cell.stl"), "must end in .off or .obj"));
  EXPECT_TRUE(contains(read_error("cell"), "must end in .off or .obj"));
  // a folder where a file should be
  const std::string folder = written("first.off", "") + ".d.off";
  std::filesystem::create_directories(folder);
  EXPECT_TRUE(contains(read_error(folder), "first.off.d.off")) << read_error(folder);
}

TEST(MeshFile, TruncatedAnywhere)
{
  // cut an OFF file after any number of characters: an error, except where only the line end or
  // digits of the very last number are missing
  const std::string text = off_text(tetrahedron(Vec3::Zero()));
  for (size_t n = 0; n + 2 < text.size(); n++) {
    const std::string path = written("cut.off", text.substr(0, n));
    const std::string error = read_error(path);
    ASSERT_NE(error, "no error") << n;
    EXPECT_TRUE(contains(error, "cut.off, line ")) << error;
  }
  // an OBJ file has no counts: either the reader or the check finds it
  const std::string obj = obj_text(tetrahedron(Vec3::Zero()));
  for (size_t n = 0; n + 2 < obj.size(); n++) {
    const std::string path = written("cut.obj", obj.substr(0, n));
    std::string error;
    try {
      error = check_mesh(read_mesh(path));
    } catch (const std::runtime_error &e) {
      error = e.what();
    }
    ASSERT_NE(error, "") << n;
  }
}

TEST(MeshFile, DamagedLines)
{
  struct Case {
    const char *name, *text, *expect;
  };
  const Case cases[] = {
      {"w.off", "PLY\n", "line 1: an OFF file starts with the word OFF"},
      {"w.off", "OFF BINARY\n", "binary OFF is not supported"},
      {"w.off", "OFF\n4\n", "line 2"},
      {"w.off", "OFF\n0 0 0\n", "must be positive"},
      {"w.off", "OFF\n-4 4 0\n", "must be positive"},
      {"w.off", "OFF\n1 1 0\n0 x 0\n", "line 3: 'x' is not a finite number"},
      {"w.off", "OFF\n1 1 0\n0 nan 0\n", "not a finite number"},
      {"w.off", "OFF\n1 1 0\n0 1e999 0\n", "not a finite number"},
      {"w.off", "OFF\n1 1 0\n0 1\n", "needs three coordinates"},
      {"w.off", "OFF\n1 1 0\n0 0 0\n4 0 0 0 0\n", "only triangles are read"},
      {"w.off", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "line 4: face 1 refers to node index 1"},
      {"w.off", "OFF\n1 1 0\n0 0 0\n3 0 0 -1\n", "refers to node index -1"},
      {"w.off", "OFF\n1 1 0\n0 0 0\n3 0 0 0.5\n", "'0.5' is not an integer"},
      {"w.off", "OFF\n1 1 0\n0 0 0\n3 0 0 0\n3 0 0 0\n", "more faces than the 1 announced"},
      {"w.off", "OFF\n99999999999 1 0\n0 0 0\n", "is not an integer"},
      {"w.off", "OFF\n2000000000 1 0\n0 0 0\n", "truncated"},
      {"w.obj", "", "without any node"},
      {"w.obj", "v 0 0 0\n", "without any face"},
      {"w.obj", "v 0 0\n", "line 1: a node (v) needs three coordinates"},
      {"w.obj", "v 0 0 0\nf 1 1\n", "line 2: a face (f) needs three nodes"},
      {"w.obj", "v 0 0 0\nf 1 1 1 1\n", "only triangles are read"},
      {"w.obj", "v 0 0 0\nf 1 1 2\n", "refers to node 2"},
      {"w.obj", "v 0 0 0\nf 0 1 1\n", "refers to node 0"},
      {"w.obj", "v 0 0 0\nf -2 1 1\n", "refers to node -2"},
      {"w.obj", "v 0 0 0\nf 1 1 a/1\n", "'a' is not an integer"},
  };
  for (const Case &c : cases) {
    const std::string error = read_error(written(c.name, c.text));
    EXPECT_TRUE(contains(error, c.expect)) << error;
    EXPECT_TRUE(contains(error, c.name)) << error;
  }
}
