// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Stiffness of a linearly implicit step,
//
//   (Gamma + dt K) v = F,   K = the positive semidefinite part of -dF/dx,
//
// as a sum of blocks, in the slots and vectors of friction.h. Each law gives its own part of K:
//
//   cortex edge    EdgeBlock       cortex_stiffness_block()
//   hinge          RankOne<4>      hinge_stiffness()
//   contact        ContactSpring   weights and axis of its friction block, and its tilt
//   (contact_tilt.h) volume         CellBlock       pressure_stiffness() and the gradient of the
//   volume lumen          CellBlock       the same for the fluid in it, without a row plane
//   MeanBlock       of a cell that is held as a whole; spheres: EdgeBlock to slot 0
//
// Every block is symmetric and positive semidefinite by its form. What would make -dF/dx
// indefinite (tension below zero, the second derivatives of angle and volume, softening of a
// contact) is left out: that costs accuracy of the step, not its stability.
// A volume block couples all nodes of a cell: its product needs one number per cell, summed over
// the processes that share the cell. That message goes through the Communicator of
// friction_solver.h, of which only these are used:
//   void sum_cells(double *values, int width);    // so many per row of the table of cells
//   void sum(double *values, int n);      // for blocks over more than a cell
// Units: blocks in force/length (nN/um); dt in s turns them into friction.

#ifndef DCM_STIFFNESS_H
#define DCM_STIFFNESS_H

#include "friction.h"
#include "stiffness_packed.h"

#include <cstddef>
#include <vector>

namespace dcm {

/// c (g_1, ..., g_N) (g_1, ..., g_N)^T over N slots, each with a direction of its own: energy of a
/// scalar with gradient g and second derivative c >= 0 that a translation does not change: the
/// directions sum to zero. Slots differ, but for the fixed slot 0.
template <int N> struct RankOne {
  int n[N];
  double c;
  double g[N][3];
};

/// Slope times the square of how far two surfaces approach each other along the axis of their
/// contact, over the contact: once for the means of `mean` (normal: the slope, tangential: 0), once
/// for each of two tilts, weights that sum to zero over either surface.
struct ContactSpring {
  ContactBlock mean;
  double tilt[2][6];
};

/// One node of a cell: gradient of the cell's scalar (its volume) by the node's position.
struct CellNode {
  int n;
  double g[3];
};

/// c G G^T over all nodes of a cell, c >= 0; here are those of this process, numbers begin to
/// end - 1 of StiffnessSystem::nodes. A node belongs to the process that owns it, and to it alone,
/// with its full gradient. row: number of the cell, the same everywhere; field: of the style that
/// adds the block, StiffnessSystem::add_field(). A cell has at most one block in a field, on all
/// processes that own atoms of it, even if these are none of its nodes. Without a row: a block over
/// more than a cell, which all processes have, in the same order.
struct CellBlock {
  std::size_t begin, end;
  double c;
  int row = -1, field = 0;
};

/// c e e^T on the mean of all nodes of a cell, e a coordinate axis: numbers begin to end - 1 of
/// StiffnessSystem::members are here, share: one over the number of all. row, field: as above.
struct MeanBlock {
  std::size_t begin, end;
  double c, share;
  int axis, row, field;
};

/* ----------------------------------------------------------------------
   add the diagonal 3x3 blocks of dt (block) to d, 6 numbers per slot as in friction.h
------------------------------------------------------------------------- */

inline void add_isotropic(double *m, double c)
{
  for (int k = 0; k < 3; k++) m[k] += c;
}

inline void add_full_diagonal(const EdgeBlock &b, double dt, double *d)
{
  for (int n : {b.i, b.j}) {
    add_isotropic(d + 6 * (std::size_t) n, dt * b.iso);
    add_symmetric(d + 6 * (std::size_t) n, dt * b.along, b.e);
  }
}

inline void add_full_diagonal(const ContactSpring &b, double dt, double *d)
{
  const int *const n = b.mean.n;
  for (const double *w : {b.mean.w, b.tilt[0], b.tilt[1]})
    for (int k = 0; k < 6; k++) {    // a node may stand in two slots, see friction_blocks.h
      double weight = 0.0;
      for (int l = 0; l < 6; l++)
        if (n[l] == n[k]) weight += w[l];
      add_symmetric(d + 6 * (std::size_t) n[k], dt * w[k] * weight * b.mean.normal, b.mean.u);
    }
}

template <int N> void add_full_diagonal(const RankOne<N> &b, double dt, double *d)
{
  for (int l = 0; l < N; l++) add_symmetric(d + 6 * (std::size_t) b.n[l], dt * b.c, b.g[l]);
}

/* ----------------------------------------------------------------------
   the blocks of one process and the products with them
------------------------------------------------------------------------- */

class StiffnessSystem {
 public:
  std::vector<EdgeBlock> edges;
  std::vector<ContactSpring> contacts;
  std::vector<RankOne<4>> hinges;
  std::vector<CellBlock> cells;
  std::vector<CellNode> nodes;    ///< of all cells, those of one cell next to each other
  std::vector<MeanBlock> means;
  std::vector<int> members;    ///< of all means, likewise

  /// For a style that adds blocks of cells, whose rows are below `rows`; the same everywhere, in
  /// the same order.
  int add_field(int rows)
  {
    nrows = rows;
    return nfields++;
  }

  void clear()
  {
    edges.clear();
    contacts.clear();
    hinges.clear();
    cells.clear();
    nodes.clear();
    means.clear();
    members.clear();
    nrows = nfields = 0;
  }

  /// To be called when all blocks are there, and again after any has changed.
  void merge()
  {
    pack(edges, packed_edges);
    pack(contacts, packed_contacts);
    pack(hinges, packed_hinges);
  }

  double memory_usage() const
  {
    return (double) sizeof(EdgeBlock) * edges.capacity() +
           (double) sizeof(ContactSpring) * contacts.capacity() +
           (double) sizeof(RankOne<4>) * hinges.capacity() +
           (double) sizeof(CellBlock) * cells.capacity() +
           (double) sizeof(CellNode) * nodes.capacity() +
           (double) sizeof(MeanBlock) * means.capacity() +
           (double) sizeof(int) * members.capacity() +
           (double) sizeof(double) * (mine.capacity() + whole.capacity() + wide.capacity()) +
           (double) sizeof(PackedEdge) * packed_edges.capacity() +
           (double) sizeof(PackedContact) * packed_contacts.capacity() +
           (double) sizeof(PackedHinge) * packed_hinges.capacity();
  }

  /// y += dt K p of this process' blocks: to be called after FrictionSystem::apply(), with p known
  /// in all of `n` slots; slots of other processes are then to be added to their owners. Returns
  /// this process' share of p . dt K p. Collective: one sum for each cell, if there are any.
  template <class Communicator>
  double apply(double dt, std::size_t n, const double *p, double *y, Communicator &comm)
  {
    double power = 0.0;
    for (const auto &b : packed_edges) power += b.product(dt, p, y);
    for (const auto &b : packed_contacts) power += b.product(dt, p, y);
    for (const auto &b : packed_hinges) power += b.product(dt, p, y);
    if (nfields > 0 || !cells.empty()) power += apply_cells(dt, p, y, comm);
    for (int k = 0; k < STRIDE; k++) y[k] = 0.0;    // slot 0 is fixed
    for (std::size_t i = 1; i < n; i++) y[STRIDE * i + 3] = 0.0;
    return power;
  }

  /// d += diagonal 3x3 blocks of dt K, 6 numbers per slot: after FrictionSystem::diagonal_blocks().
  void add_diagonal(double dt, double *d) const
  {
    for (const auto &b : edges) add_full_diagonal(b, dt, d);
    for (const auto &b : contacts) add_full_diagonal(b, dt, d);
    for (const auto &b : hinges) add_full_diagonal(b, dt, d);
    for (const auto &b : cells)
      for (std::size_t i = b.begin; i < b.end; i++)
        add_symmetric(d + 6 * (std::size_t) nodes[i].n, dt * b.c, nodes[i].g);
    for (const auto &b : means)
      for (std::size_t i = b.begin; i < b.end; i++)
        d[6 * (std::size_t) members[i] + b.axis] += dt * b.c * b.share * b.share;
    for (int k = 0; k < 6; k++) d[k] = 0.0;
  }

 private:
  std::vector<PackedEdge> packed_edges;
  std::vector<PackedContact> packed_contacts;
  std::vector<PackedHinge> packed_hinges;
  int nrows = 0, nfields = 0;
  std::vector<double> mine, whole, wide;    // what a block makes of p: of this process, per block
                                            // (cells, then means); of all, per row and field, and
                                            // per block without a row

  template <class Block, class Packed>
  static void pack(const std::vector<Block> &blocks, std::vector<Packed> &packed)
  {
    packed.clear();
    packed.reserve(blocks.size());
    for (const auto &b : blocks) packed.emplace_back(b);
  }

  template <class Communicator>
  double apply_cells(double dt, const double *p, double *y, Communicator &comm)
  {
    mine.resize(cells.size() + means.size());
    whole.resize((std::size_t) nrows * nfields);
    wide.clear();
    double *m = mine.data();
    for (const auto &b : cells) {
      double sum = 0.0;
      for (std::size_t i = b.begin; i < b.end; i++)
        for (int k = 0; k < 3; k++) sum += nodes[i].g[k] * p[STRIDE * (std::size_t) nodes[i].n + k];
      if (b.row < 0)
        wide.push_back(sum);
      else
        whole[place(b)] = sum;
      *m++ = sum;
    }
    for (const auto &b : means) {
      double sum = 0.0;
      for (std::size_t i = b.begin; i < b.end; i++)
        sum += p[STRIDE * (std::size_t) members[i] + b.axis];
      *m++ = whole[place(b)] = b.share * sum;
    }
    if (nfields > 0) comm.sum_cells(whole.data(), nfields);
    if (!wide.empty()) comm.sum(wide.data(), (int) wide.size());

    double power = 0.0;
    std::size_t next = 0;
    m = mine.data();
    for (const auto &b : cells) {
      const double f = dt * b.c * (b.row < 0 ? wide[next++] : whole[place(b)]);
      for (std::size_t i = b.begin; i < b.end; i++)
        for (int k = 0; k < 3; k++) y[STRIDE * (std::size_t) nodes[i].n + k] += f * nodes[i].g[k];
      power += f * *m++;
    }
    for (const auto &b : means) {
      const double f = dt * b.c * whole[place(b)];
      for (std::size_t i = b.begin; i < b.end; i++)
        y[STRIDE * (std::size_t) members[i] + b.axis] += f * b.share;
      power += f * *m++;
    }
    return power;
  }

  template <class Block> std::size_t place(const Block &b) const
  {
    return (std::size_t) b.row * nfields + b.field;
  }
};

}    // namespace dcm

#endif
