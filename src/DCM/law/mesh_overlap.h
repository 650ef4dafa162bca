// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// How deep is one closed surface inside another? Surfaces of neighbors that were made from one
// image share a little space; those that share more start on the wrong sides of each other. Set-up
// code: it allocates and is not meant for the time step. Lengths in um.

#ifndef DCM_MESH_OVERLAP_H
#define DCM_MESH_OVERLAP_H

#include "envelope.h"

namespace dcm {

/// The point of a mesh that is deepest inside an envelope: depth, um (0: none is), and its node,
/// from 0; -1: the middle of a face, or of the mesh.
struct MeshOverlap {
  double depth = 0.0;
  int node = -1;
};

/// Looks at the nodes of a mesh and the middles of its faces, where contacts are felt, and at its
/// mean node, which tells of a mesh that coincides with the envelope. shift is added to all.
inline MeshOverlap mesh_overlap(const Envelope &envelope, const Mesh &mesh, const Vec3 &shift)
{
  const auto &other = envelope.mesh().nodes;
  Vec3 lo = other[0], hi = other[0], mid = Vec3::Zero();
  for (const Vec3 &x : other) {
    lo = lo.cwiseMin(x);
    hi = hi.cwiseMax(x);
  }
  MeshOverlap worst;
  int hint = -1;
  auto look = [&](const Vec3 &x, int node) {
    if ((x.array() < lo.array()).any() || (x.array() > hi.array()).any()) return;
    const EnvelopePoint found = envelope.nearest(x, hint);
    hint = found.face;
    if (-found.distance > worst.depth) worst = {-found.distance, node};
  };
  for (size_t i = 0; i < mesh.nodes.size(); i++) {
    look(mesh.nodes[i] + shift, int(i));
    mid += mesh.nodes[i] / double(mesh.nodes.size());
  }
  for (const auto &f : mesh.faces)
    look((mesh.nodes[f[0]] + mesh.nodes[f[1]] + mesh.nodes[f[2]]) / 3.0 + shift, -1);
  look(mid + shift, -1);
  return worst;
}

}    // namespace dcm

#endif
