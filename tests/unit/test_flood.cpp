// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Links and sets of faces: lumens of known shape among several cells.

#include "law/flood.h"
#include "bodies.h"
#include "helpers.h"
#include "law/mesh.h"

#include <map>
#include <set>

using namespace dcm;
using namespace dcm_test;

namespace {

using Faces = std::vector<FloodFace>;

void add(Faces &faces, const Vec3 &a, const Vec3 &b, const Vec3 &c, int cell,
         const std::array<int, 3> &vertex)
{
  FloodFace face;
  face.corner = {a, b, c};
  face.measure();
  face.tag = (std::int64_t) faces.size() + 1;
  face.cell = cell;
  for (int k = 0; k < 3; k++) face.vertex[k] = 1000000 * cell + vertex[k];
  face.node = face.own = true;
  faces.push_back(face);
}

// a cavity among eight cells, each of which has one octant of its wall and nodes of its own
void add_cavity(Faces &faces, const Vec3 &center, double radius, int first)
{
  const Mesh ball = icosphere(2);
  for (const auto &f : ball.faces) {
    const Vec3 mid = ball.nodes[f[0]] + ball.nodes[f[1]] + ball.nodes[f[2]];
    const int octant = (mid[0] > 0.0) + 2 * (mid[1] > 0.0) + 4 * (mid[2] > 0.0);
    add(faces, center + radius * ball.nodes[f[0]], center + radius * ball.nodes[f[2]],
        center + radius * ball.nodes[f[1]], first + octant, {f[0], f[2], f[1]});
  }
}

// two cells above each other with a gap of 0.6 between them, but `gap` along a strip 4 < x < 4.3
Faces plates(double gap)
{
  const std::vector<double> at = {0, 1, 2, 3, 4, 4.3, 5.3, 6.3, 7.3, 8.3};
  const int nx = (int) at.size(), ny = 6;
  Faces faces;
  for (int cell = 1; cell <= 2; cell++) {
    auto node = [&](int i, int j) {
      return Vec3(at[i], j, cell == 1 ? 0.0 : i == 4 || i == 5 ? gap : 0.6);
    };
    for (int i = 0; i + 1 < nx; i++)
      for (int j = 0; j + 1 < ny; j++)
        for (int half = 0; half < 2; half++) {
          int u[3] = {i, i + 1, half ? i : i + 1}, v[3] = {j, half ? j + 1 : j, j + 1};
          if (cell == 2) {
            std::swap(u[1], u[2]);
            std::swap(v[1], v[2]);
          }
          std::array<int, 3> vertex;
          for (int k = 0; k < 3; k++) vertex[k] = u[k] * 100 + v[k];
          add(faces, node(u[0], v[0]), node(u[1], v[1]), node(u[2], v[2]), cell, vertex);
          if (i == 4) {
            faces.back().node = false;
            faces.back().shut = true;
          }
        }
  }
  return faces;
}

// number of sets, the set of each node by tag
int sets_of(const Faces &faces, const FloodSettings &settings, std::map<int, int> *of = nullptr)
{
  FloodSpace space;
  space.faces = faces;
  space.sort(settings);
  std::vector<FloodSpace::Link> links;
  space.find_links(links);
  std::vector<int> tags;
  for (const auto &face : faces)
    if (face.node) tags.push_back((int) face.tag);
  std::sort(tags.begin(), tags.end());
  auto place = [&tags](std::int64_t tag) {
    return (int) (std::lower_bound(tags.begin(), tags.end(), tag) - tags.begin());
  };
  Components components((int) tags.size());
  for (const auto &link : links) {
    EXPECT_LT(link[0], link[1]);
    components.link(place(link[0]), place(link[1]));
  }
  std::vector<int> set;
  const int n = components.number(set);
  if (of)
    for (size_t i = 0; i < tags.size(); i++) (*of)[tags[i]] = set[i];
  return n;
}

constexpr FloodSettings LIKE_STYLE = {1.2, 0.05, 0.0};

}    // namespace

TEST(Flood, Components)
{
  Components components(6);
  components.link(5, 3);
  components.link(1, 5);
  components.link(0, 4);
  std::vector<int> set;
  EXPECT_EQ(components.number(set), 3);
  EXPECT_EQ(set, (std::vector<int>{0, 1, 2, 1, 0, 1}));
}

TEST(Flood, ACavityAmongEightCellsIsOne)
{
  Faces faces;
  add_cavity(faces, Vec3::Zero(), 3.0, 0);
  EXPECT_EQ(sets_of(faces, LIKE_STYLE), 1);
  // the cells' own edges alone do not join them
  EXPECT_EQ(sets_of(faces, {0.0, 0.05, 0.0}), 8);
  add_cavity(faces, Vec3(6.8, 0, 0), 3.0, 8);
  std::map<int, int> set;
  EXPECT_EQ(sets_of(faces, LIKE_STYLE, &set), 2);    // 0.8 apart, but the faces look away
  for (int n = 1; n <= 640; n++) EXPECT_EQ(set[n], n <= 320 ? 0 : 1);
}

TEST(Flood, SetsDoNotDependOnPlaceAndNumbers)
{
  Random random(5, 0, 0);
  Faces faces = plates(0.4);
  for (int trial = 0; trial < 6; trial++) {
    const Mat3 R = random_rotation(random);
    const Vec3 shift = 30.0 * random.gaussian_vector();
    Faces other = faces;
    for (size_t i = other.size() - 1; i > 0; i--)
      std::swap(other[i], other[(size_t) (random.uniform() * (double) (i + 1))]);
    for (size_t i = 0; i < other.size(); i++) {
      for (auto &x : other[i].corner) x = R * x + shift;
      other[i].measure();
      other[i].tag = 7 * (std::int64_t) i + 3;
    }
    EXPECT_EQ(sets_of(other, {1.2, 0.05, 0.45}), 2);
    EXPECT_EQ(sets_of(other, {1.2, 0.05, 0.0}), 1);
  }
}

TEST(Flood, AStripOfContactNarrowerThanAFacePartsTwoLumens)
{
  for (const double gap : {0.4, 0.02, -0.05}) {
    std::map<int, int> set;
    const Faces faces = plates(gap);
    EXPECT_EQ(sets_of(faces, {1.2, 0.05, 0.45}, &set), 2) << gap;
    for (const auto &face : faces) {
      if (!face.node) continue;
      EXPECT_EQ(set[(int) face.tag], face.mid[0] < 4.0 ? 0 : 1);
    }
  }
  // adhering cells leave a slit: distance and sight alone would lead through it
  EXPECT_EQ(sets_of(plates(0.4), {1.2, 0.05, 0.0}), 1);
  // a strip without contact does not part them
  Faces open = plates(0.4);
  for (auto &face : open) face.shut = false;
  EXPECT_EQ(sets_of(open, {1.2, 0.05, 0.45}), 1);
}

TEST(Flood, LinksAreSharedOutAmongProcesses)
{
  const Faces faces = plates(0.4);
  std::set<FloodSpace::Link> all;
  std::vector<int> tags;
  for (int part = 0; part < 3; part++) {
    FloodSpace space;
    space.faces = faces;
    for (auto &face : space.faces) face.own = (int) (face.mid[0] / 3.0) == part;
    space.sort({1.2, 0.05, 0.45});
    std::vector<FloodSpace::Link> links;
    space.find_links(links);
    for (const auto &link : links) {
      const auto &low = space.faces[link[0] - 1];
      EXPECT_TRUE(low.own);
      EXPECT_TRUE(all.insert(link).second) << "decided twice";
    }
  }
  Components components((int) faces.size());
  for (const auto &link : all) components.link((int) link[0] - 1, (int) link[1] - 1);
  std::vector<int> set;
  int shut = 0;
  for (const auto &face : faces) shut += !face.node;
  EXPECT_EQ(components.number(set), 2 + shut);
}

TEST(Flood, Opposite)
{
  FloodSpace space;
  space.faces = plates(0.4);
  space.sort({1.2, 0.05, 0.0});
  for (int f = 0; f < (int) space.faces.size(); f++) {
    const int g = space.opposite(f);
    ASSERT_GE(g, 0);
    EXPECT_NE(space.faces[g].cell, space.faces[f].cell);
    EXPECT_LT((space.faces[g].mid - space.faces[f].mid).head<2>().norm(), 0.5);
  }
  space.sort({0.5, 0.05, 0.0});    // the gap is wider than that in most places
  EXPECT_EQ(space.opposite(0), -1);
}

TEST(Flood, Cuts)
{
  FloodFace face;
  face.corner = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  face.measure();
  EXPECT_TRUE(face_cuts(face, Vec3(0.2, 0.2, 1), Vec3(0.2, 0.2, -1)));
  EXPECT_TRUE(face_cuts(face, Vec3(0.2, 0.2, -1), Vec3(0.2, 0.2, 1)));
  EXPECT_FALSE(face_cuts(face, Vec3(0.2, 0.2, 1), Vec3(0.2, 0.2, 0.1)));
  EXPECT_FALSE(face_cuts(face, Vec3(0.8, 0.8, 1), Vec3(0.8, 0.8, -1)));
  EXPECT_TRUE(face_cuts(face, Vec3(0.5, 0.5, 1), Vec3(0.5, 0.5, -1)));    // through an edge
  EXPECT_TRUE(face_cuts(face, Vec3(0, 0, 1), Vec3(0, 0, -1)));            // and a corner
  double height;
  EXPECT_TRUE(height_over(face, Vec3(0.2, 0.2, -0.3), height));
  EXPECT_NEAR(height, -0.3, 1.0e-15);
  EXPECT_FALSE(height_over(face, Vec3(0.8, 0.8, 0.3), height));
}

TEST(Flood, MarksFallLaterThanTheyAreSet)
{
  EXPECT_TRUE(may_be_marked(0.04, 0.05, false));
  EXPECT_FALSE(may_be_marked(0.06, 0.05, false));
  EXPECT_TRUE(may_be_marked(0.5, 0.05, true));
  EXPECT_FALSE(may_be_marked(0.51, 0.05, true));
}
