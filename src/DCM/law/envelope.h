// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Signed distance to a frozen closed surface, the envelope in which a cell divides.
// The faces sit in a tree of axis-aligned boxes. The sign comes from the angle-weighted normal of
// the face, edge or node on which the nearest point lies: right for any closed surface, also next
// to sharp concave edges, where the normal of one adjacent face alone can give the wrong side.
// Units: um; any length unit works.

#ifndef DCM_ENVELOPE_H
#define DCM_ENVELOPE_H

#include "mesh.h"
#include "vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace dcm {

/// Where a surface is nearest to a query point.
struct EnvelopePoint {
  Vec3 point;         ///< nearest point of the surface, um
  double distance;    ///< signed distance, um: positive outside, negative inside
  int face;           ///< a face that holds the nearest point; hint for the next query nearby
};

/// A closed mesh prepared for queries of the nearest point. Queries change nothing and are safe
/// from several threads.
class Envelope {
 public:
  /// Takes a copy of the mesh. Throws std::invalid_argument if check_mesh() finds a fault: a
  /// surface with a hole or of mixed orientation has no inside.
  explicit Envelope(const Mesh &mesh);

  /// Nearest point and signed distance of x. hint: a face of the mesh expected to be close (the
  /// `face` of an earlier answer), which saves most of the search; -1 or any other number: none.
  EnvelopePoint nearest(const Vec3 &x, int hint = -1) const;

  const Mesh &mesh() const { return shape; }

 private:
  // inside of the face, its sides ab, bc, ca, its corners a, b, c
  enum Feature { FACE, SIDE_AB, SIDE_BC, SIDE_CA, CORNER_A, CORNER_B, CORNER_C };

  // what the search needs of a face, next to each other in the order of the tree's leaves
  struct Triangle {
    Vec3 a, b, c, normal;
    double bb, cc, bc, inverse;    // products of b - a and c - a, 1/(bb cc - bc^2)
    int face;
  };
  struct Box {
    Vec3 lo, hi;
    int first, count;    // leaf: its triangles; inner box (count 0): first is its second child
  };

  static constexpr int LEAF = 4;

  Mesh shape;
  std::vector<Triangle> triangles;
  std::vector<int> place;                          // of each face in the list of triangles
  std::vector<Box> boxes;                          // the first child of a box follows it
  std::vector<std::array<Vec3, 3>> side_normal;    // of sides ab, bc, ca of each face
  std::vector<Vec3> node_normal;

  static Triangle triangle(const Mesh &mesh, int face);
  static Vec3 closest(const Triangle &t, const Vec3 &x, Feature &feature);
  static Vec3 closest_on_side(const Vec3 &p, const Vec3 &q, const Vec3 &x, Feature side,
                              Feature start, Feature end, Feature &feature);
  static double gap2(const Box &box, const Vec3 &x);
  void split(int first, int count);
  void set_normals();
  const Vec3 &pseudo_normal(const Triangle &t, Feature feature) const;
};

inline Envelope::Envelope(const Mesh &mesh) : shape(mesh)
{
  const std::string fault = check_mesh(mesh);
  if (!fault.empty()) throw std::invalid_argument("envelope: " + fault);
  const int nf = int(mesh.faces.size());
  triangles.reserve(nf);
  for (int f = 0; f < nf; f++) triangles.push_back(triangle(mesh, f));
  split(0, nf);
  place.resize(nf);
  for (int i = 0; i < nf; i++) place[triangles[i].face] = i;
  set_normals();
}

inline Envelope::Triangle Envelope::triangle(const Mesh &mesh, int face)
{
  const auto &f = mesh.faces[face];
  Triangle t;
  t.face = face;
  t.a = mesh.nodes[f[0]];
  t.b = mesh.nodes[f[1]];
  t.c = mesh.nodes[f[2]];
  const Vec3 u = t.b - t.a, v = t.c - t.a, m = u.cross(v);
  t.normal = m.normalized();
  t.bb = u.squaredNorm();
  t.cc = v.squaredNorm();
  t.bc = u.dot(v);
  t.inverse = 1.0 / m.squaredNorm();
  return t;
}

// Box around triangles first .. first + count - 1, then its halves: cut across the longest
// direction at the median, so that the depth is bounded by the number of faces alone.
inline void Envelope::split(int first, int count)
{
  Box box;
  box.lo.setConstant(std::numeric_limits<double>::infinity());
  box.hi = -box.lo;
  for (int i = first; i < first + count; i++)
    for (const Vec3 *corner : {&triangles[i].a, &triangles[i].b, &triangles[i].c}) {
      box.lo = box.lo.cwiseMin(*corner);
      box.hi = box.hi.cwiseMax(*corner);
    }
  const size_t self = boxes.size();
  box.first = first;
  box.count = count <= LEAF ? count : 0;
  boxes.push_back(box);
  if (box.count) return;

  int axis;
  (box.hi - box.lo).maxCoeff(&axis);
  const int half = count / 2;
  auto key = [axis](const Triangle &t) {
    return t.a[axis] + t.b[axis] + t.c[axis];
  };
  // the face number decides ties: the tree does not depend on the library's algorithm
  std::nth_element(triangles.begin() + first, triangles.begin() + first + half,
                   triangles.begin() + first + count, [&](const Triangle &s, const Triangle &t) {
                     return key(s) != key(t) ? key(s) < key(t) : s.face < t.face;
                   });
  split(first, half);
  boxes[self].first = int(boxes.size());
  split(first + half, count - half);
}

inline void Envelope::set_normals()
{
  const auto &faces = shape.faces;
  side_normal.resize(faces.size());
  node_normal.assign(shape.nodes.size(), Vec3::Zero());
  const auto half = mesh_detail::half_edges(shape);
  for (size_t i = 0; i + 1 < half.size(); i += 2) {    // closed: the two sides of every edge
    const Vec3 sum =
        triangles[place[half[i].face]].normal + triangles[place[half[i + 1].face]].normal;
    for (size_t j = i; j < i + 2; j++)
      for (int k = 0; k < 3; k++)
        if (faces[half[j].face][(k + 2) % 3] == half[j].opposite)
          side_normal[half[j].face][k] = sum;
  }
  for (size_t f = 0; f < faces.size(); f++)
    for (int k = 0; k < 3; k++) {
      const Vec3 &x = shape.nodes[faces[f][k]];
      const Vec3 u = shape.nodes[faces[f][(k + 1) % 3]] - x;
      const Vec3 v = shape.nodes[faces[f][(k + 2) % 3]] - x;
      const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
      node_normal[faces[f][k]] += angle * triangles[place[f]].normal;
    }
}

// Nearest point of segment p-q; tells whether it is one of the ends.
inline Vec3 Envelope::closest_on_side(const Vec3 &p, const Vec3 &q, const Vec3 &x, Feature side,
                                      Feature start, Feature end, Feature &feature)
{
  const Vec3 e = q - p;
  const double s = (x - p).dot(e), ee = e.squaredNorm();
  feature = s <= 0.0 ? start : s >= ee ? end : side;
  if (s <= 0.0) return p;
  if (s >= ee) return q;
  return p + (s / ee) * e;
}

// Nearest point of a triangle: the foot of the normal if it falls inside; otherwise the nearest
// point lies on a side that has the foot on its outer side, one or two of the three.
inline Vec3 Envelope::closest(const Triangle &t, const Vec3 &x, Feature &feature)
{
  const Vec3 u = t.b - t.a, v = t.c - t.a, p = x - t.a;
  const double pu = p.dot(u), pv = p.dot(v);
  const double beta = (t.cc * pu - t.bc * pv) * t.inverse;
  const double gamma = (t.bb * pv - t.bc * pu) * t.inverse;
  feature = FACE;
  if (beta >= 0.0 && gamma >= 0.0 && beta + gamma <= 1.0) return t.a + beta * u + gamma * v;

  Vec3 best = t.a;
  double best2 = std::numeric_limits<double>::infinity();
  auto offer = [&](const Vec3 &from, const Vec3 &to, Feature side, Feature start, Feature end) {
    Feature where;
    const Vec3 y = closest_on_side(from, to, x, side, start, end, where);
    const double d2 = (x - y).squaredNorm();
    if (d2 >= best2) return;
    best2 = d2;
    best = y;
    feature = where;
  };
  if (gamma < 0.0) offer(t.a, t.b, SIDE_AB, CORNER_A, CORNER_B);
  if (beta + gamma > 1.0) offer(t.b, t.c, SIDE_BC, CORNER_B, CORNER_C);
  if (beta < 0.0) offer(t.c, t.a, SIDE_CA, CORNER_C, CORNER_A);
  return best;
}

// squared distance of x from a box, zero inside
inline double Envelope::gap2(const Box &box, const Vec3 &x)
{
  const Vec3 d = (box.lo - x).cwiseMax(x - box.hi).cwiseMax(0.0);
  return d.squaredNorm();
}

inline const Vec3 &Envelope::pseudo_normal(const Triangle &t, Feature feature) const
{
  switch (feature) {
    case FACE:
      return t.normal;
    case SIDE_AB:
    case SIDE_BC:
    case SIDE_CA:
      return side_normal[t.face][feature - SIDE_AB];
    default:
      return node_normal[shape.faces[t.face][feature - CORNER_A]];
  }
}

inline EnvelopePoint Envelope::nearest(const Vec3 &x, int hint) const
{
  int best = hint >= 0 && hint < int(place.size()) ? place[hint] : 0;
  Feature feature;
  Vec3 point = closest(triangles[best], x, feature);
  double best2 = (x - point).squaredNorm();

  // boxes still to visit with their distance; halving at the median keeps the depth below 64
  struct Visit {
    int box;
    double gap2;
  };
  Visit stack[64];
  int n = 0;
  stack[n++] = {0, gap2(boxes[0], x)};
  while (n > 0) {
    const Visit visit = stack[--n];
    if (visit.gap2 >= best2) continue;
    const Box &box = boxes[visit.box];
    if (box.count == 0) {
      Visit near = {visit.box + 1, gap2(boxes[visit.box + 1], x)};
      Visit far = {box.first, gap2(boxes[box.first], x)};
      if (far.gap2 < near.gap2) std::swap(near, far);
      if (far.gap2 < best2) stack[n++] = far;
      if (near.gap2 < best2) stack[n++] = near;
      continue;
    }
    for (int i = box.first; i < box.first + box.count; i++) {
      const double height = (x - triangles[i].a).dot(triangles[i].normal);
      if (height * height >= best2) continue;    // its plane is already too far away
      Feature where;
      const Vec3 y = closest(triangles[i], x, where);
      const double d2 = (x - y).squaredNorm();
      if (d2 >= best2) continue;
      best2 = d2;
      best = i;
      point = y;
      feature = where;
    }
  }

  const double side = (x - point).dot(pseudo_normal(triangles[best], feature));
  return {point, side >= 0.0 ? std::sqrt(best2) : -std::sqrt(best2), triangles[best].face};
}

}    // namespace dcm

#endif
