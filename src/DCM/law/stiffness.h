// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Stiffness of a linearly implicit step,
//
//   (Gamma + dt K) v = F,   K = the positive semidefinite part of -dF/dx,
//
// as a sum of blocks, in the slots and vectors of friction.h. Each law gives its own part of K:
//
//   cortex edge    EdgeBlock       cortex_stiffness_block()
//   hinge          RankOne<4>      hinge_stiffness()
//   contact        ContactBlock    weights and axis of its friction block
//   volume         CellBlock       pressure_stiffness() and the gradient of the volume
//
// Every block is symmetric and positive semidefinite by its form. What would make -dF/dx
// indefinite (tension below zero, the second derivatives of angle and volume, softening of a
// contact) is left out: that costs accuracy of the step, not its stability.
// A volume block couples all nodes of a cell: its product needs one number per cell, summed over
// the processes that share the cell. That message goes through the Communicator of
// friction_solver.h, of which only these are used:
//   void sum_cells(double *values);       // one per row of the table of cells
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

/// One node of a cell: gradient of the cell's scalar (its volume) by the node's position.
struct CellNode {
  int n;
  double g[3];
};

/// c G G^T over all nodes of a cell, c >= 0; here are those of this process, numbers begin to
/// end - 1 of StiffnessSystem::nodes. A node belongs to the process that owns it, and to it alone,
/// with its full gradient. row: number of the cell, the same everywhere. A cell has at most one
/// such block, on all processes that own atoms of it, even if these are none of its nodes. Without
/// a row: a block over more than a cell, which all processes have, in the same order.
struct CellBlock {
  std::size_t begin, end;
  double c;
  int row = -1;
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

inline void add_full_diagonal(const ContactBlock &b, double dt, double *d)
{
  for (int k = 0; k < 6; k++) {    // a node may stand in two slots, see friction.h
    double weight = 0.0;
    for (int l = 0; l < 6; l++)
      if (b.n[l] == b.n[k]) weight += b.w[l];
    weight *= dt * b.w[k];
    add_isotropic(d + 6 * (std::size_t) b.n[k], weight * b.tangential);
    add_symmetric(d + 6 * (std::size_t) b.n[k], weight * (b.normal - b.tangential), b.u);
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
  std::vector<ContactBlock> contacts;    ///< slope along u in `normal`; tangential is 0
  std::vector<RankOne<4>> hinges;
  std::vector<CellBlock> cells;
  int nrows = 0;    ///< numbers of cells are below it; the same everywhere, 0: nowhere any block
  std::vector<CellNode> nodes;    ///< of all cells, those of one cell next to each other

  void clear()
  {
    edges.clear();
    contacts.clear();
    hinges.clear();
    cells.clear();
    nrows = 0;
    nodes.clear();
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
           (double) sizeof(ContactBlock) * contacts.capacity() +
           (double) sizeof(RankOne<4>) * hinges.capacity() +
           (double) sizeof(CellBlock) * cells.capacity() +
           (double) sizeof(CellNode) * nodes.capacity() +
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
    if (nrows > 0 || !cells.empty()) power += apply_cells(dt, p, y, comm);
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
    for (int k = 0; k < 6; k++) d[k] = 0.0;
  }

 private:
  std::vector<PackedEdge> packed_edges;
  std::vector<PackedContact> packed_contacts;
  std::vector<PackedHinge> packed_hinges;
  std::vector<double> mine, whole, wide;    // G . p: of this process, per block; of all, per row
                                            // and per block without one

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
    mine.assign(cells.size(), 0.0);
    whole.resize(nrows);
    wide.clear();
    for (std::size_t c = 0; c < cells.size(); c++) {
      for (std::size_t i = cells[c].begin; i < cells[c].end; i++)
        for (int k = 0; k < 3; k++)
          mine[c] += nodes[i].g[k] * p[STRIDE * (std::size_t) nodes[i].n + k];
      if (cells[c].row < 0)
        wide.push_back(mine[c]);
      else
        whole[cells[c].row] = mine[c];
    }
    if (nrows > 0) comm.sum_cells(whole.data());
    if (!wide.empty()) comm.sum(wide.data(), (int) wide.size());

    double power = 0.0;
    std::size_t next = 0;
    for (std::size_t c = 0; c < cells.size(); c++) {
      const double f = dt * cells[c].c * (cells[c].row < 0 ? wide[next++] : whole[cells[c].row]);
      for (std::size_t i = cells[c].begin; i < cells[c].end; i++)
        for (int k = 0; k < 3; k++) y[STRIDE * (std::size_t) nodes[i].n + k] += f * nodes[i].g[k];
      power += f * mine[c];
    }
    return power;
  }
};

}    // namespace dcm

#endif
