// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The isotropic part of a friction system as one sparse matrix of scalars: what acts alike on x, y
// and z. Some ten blocks couple the same two unknowns, and their sum is one entry.
//
// From one step to the next few blocks come and go. So a pair of unknowns gets a number when it is
// first seen, and a block keeps the numbers of its pairs for as long as it stands in the list,
// wherever that is; only new blocks look theirs up. Values are summed per number. Where a number
// stands in the matrix is settled anew when any block has come or gone.
//
// Sums are in the order of the blocks, and the entries of a row in the order in which blocks first
// name them: the matrix is, to the last bit, that of a system which has never seen other blocks.

#ifndef DCM_FRICTION_MATRIX_H
#define DCM_FRICTION_MATRIX_H

#include "friction_blocks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace dcm {

class FrictionMatrix {
 public:
  struct Entry {
    int column;
    double value;
  };
  std::vector<double> diagonal;
  std::vector<int> first;        // per row: its first entry
  std::vector<Entry> entries;    // above the diagonal

  // `start`: what the diagonal holds besides the blocks, one number per slot

  void sum(const std::vector<double> &start, const std::vector<IsoEdge> &iso_edges,
           const std::vector<EdgeBlock> &edges, const std::vector<ContactBlock> &contacts)
  {
    if (pairs.size() > 2 * entries.size() + 1000) forget();
    bool same = recognize(iso_edges, known_iso_edges, old_edges);
    same &= recognize(edges, known_edges, old_edges);
    same &= recognize(contacts, known_contacts, old_contacts);
    if (!same || first.size() != start.size() + 1) arrange(start.size());

    diagonal.assign(start.begin(), start.end());
    value.assign(pairs.size(), NOTHING);
    add(iso_edges, known_iso_edges);
    add(edges, known_edges);
    add(contacts, known_contacts);
    for (std::size_t k = 0; k < entries.size(); k++) entries[k].value = value[number[k]];
    diagonal[0] = 0.0;
  }

  double memory_usage() const
  {
    return (double) sizeof(int) * (first.capacity() + number.capacity() + table.capacity() +
                                   place.capacity() + order.capacity() + fill.capacity()) +
           (double) sizeof(Entry) * entries.capacity() + (double) sizeof(Pair) * pairs.capacity() +
           (double) sizeof(double) * (value.capacity() + diagonal.capacity()) +
           (double) sizeof(Known<2>) *
               (known_iso_edges.capacity() + known_edges.capacity() + old_edges.capacity()) +
           (double) sizeof(Known<6>) * (known_contacts.capacity() + old_contacts.capacity());
  }

 private:
  static constexpr double NOTHING = -0.0;    // the one number that added to any changes nothing
  static constexpr std::size_t AHEAD = 8;    // blocks that may vanish between two that stay

  struct Pair {
    int i, j;    // i < j; pair 0 is none: what two slots do not couple goes there
  };

  // a block with N slots: the unknowns it couples with each other (0: this slot couples nothing)
  // and the numbers of its pairs

  template <int N> struct Known {
    std::array<int, N> unknowns;
    std::array<int, N *(N - 1) / 2> pair;
    bool repeats;    // does an unknown stand in two slots?
  };

  std::vector<Known<2>> known_iso_edges, known_edges, old_edges;
  std::vector<Known<6>> known_contacts, old_contacts;
  std::vector<Pair> pairs = {{0, 0}};
  std::vector<int> table;       // hash table of the pairs: their numbers, 0 where empty
  std::vector<double> value;    // per pair
  std::vector<int> number;      // per entry: its pair
  std::vector<int> place, order, fill;

  static std::array<int, 2> unknowns(const IsoEdge &b) { return {b.i, b.j}; }

  static std::array<int, 2> unknowns(const EdgeBlock &b)
  {
    return (b.iso == 0.0) ? std::array<int, 2>{0, 0} : std::array<int, 2>{b.i, b.j};
  }

  static std::array<int, 6> unknowns(const ContactBlock &b)
  {
    std::array<int, 6> n;
    for (int k = 0; k < 6; k++) n[k] = (b.w[k] == 0.0) ? 0 : b.n[k];
    return n;
  }

  void forget()
  {
    known_iso_edges.clear();
    known_edges.clear();
    known_contacts.clear();
    first.clear();
    pairs.resize(1);
    std::fill(table.begin(), table.end(), 0);
  }

  // bring the list of known blocks up to date; were these blocks there before, in this order?

  template <class Block, int N>
  bool recognize(const std::vector<Block> &blocks, std::vector<Known<N>> &known,
                 std::vector<Known<N>> &old)
  {
    std::size_t m = 0;
    while (m < blocks.size() && m < known.size() && unknowns(blocks[m]) == known[m].unknowns) m++;
    if (m == blocks.size() && m == known.size()) return true;

    old.assign(known.begin() + m, known.end());
    known.resize(blocks.size());
    for (std::size_t next = 0; m < blocks.size(); m++) {
      const auto now = unknowns(blocks[m]);
      const std::size_t end = std::min(old.size(), next + AHEAD);
      std::size_t k = next;
      while (k < end && old[k].unknowns != now) k++;
      if (k < end) {
        known[m] = old[k];
        next = k + 1;
      } else {
        known[m].unknowns = now;
        look_up(known[m]);
      }
    }
    return false;
  }

  template <int N> void look_up(Known<N> &block)
  {
    int m = 0;
    block.repeats = false;
    for (int k = 1; k < N; k++)
      for (int l = 0; l < k; l++) {
        const int i = std::min(block.unknowns[k], block.unknowns[l]);
        const int j = std::max(block.unknowns[k], block.unknowns[l]);
        block.pair[m++] = (i == 0 || i == j) ? 0 : look_up(i, j);
        block.repeats |= (i > 0 && i == j);
      }
  }

  int look_up(int i, int j)
  {
    if (2 * pairs.size() >= table.size()) grow();
    int &found = table[seat(i, j)];
    if (found == 0) {
      found = (int) pairs.size();
      pairs.push_back({i, j});
    }
    return found;
  }

  // where a pair is in the hash table, or would be

  std::size_t seat(int i, int j) const
  {
    const std::uint64_t key = ((std::uint64_t) i << 32) | (std::uint64_t) j;
    std::size_t n = (std::size_t)((key * 0x9E3779B97F4A7C15u) >> 32) & (table.size() - 1);
    while (table[n] && (pairs[table[n]].i != i || pairs[table[n]].j != j))
      n = (n + 1) & (table.size() - 1);
    return n;
  }

  void grow()
  {
    table.assign(std::max<std::size_t>(1024, 2 * table.size()), 0);
    for (std::size_t m = 1; m < pairs.size(); m++) table[seat(pairs[m].i, pairs[m].j)] = (int) m;
  }

  // rows, and in them the pairs in the order in which they first appear

  void arrange(std::size_t n)
  {
    first.assign(n + 1, 0);
    order.clear();
    place.assign(pairs.size(), -1);
    place[0] = 0;
    list(known_iso_edges);
    list(known_edges);
    list(known_contacts);
    for (std::size_t i = 0; i < n; i++) first[i + 1] += first[i];
    fill.assign(first.begin(), first.end() - 1);
    entries.resize(order.size());
    number.resize(order.size());
    for (int m : order) {
      const int k = fill[pairs[m].i]++;
      entries[k].column = pairs[m].j;
      number[k] = m;
    }
  }

  template <int N> void list(const std::vector<Known<N>> &known)
  {
    for (const auto &block : known)
      for (int m : block.pair) {
        if (place[m] >= 0) continue;
        place[m] = 0;
        order.push_back(m);
        first[pairs[m].i + 1]++;
      }
  }

  // edges of either kind

  template <class Edge>
  void add(const std::vector<Edge> &blocks, const std::vector<Known<2>> &known)
  {
    for (std::size_t m = 0; m < blocks.size(); m++) {
      const auto &b = blocks[m];
      diagonal[b.i] += b.iso;
      diagonal[b.j] += b.iso;
      value[known[m].pair[0]] -= b.iso;
    }
  }

  void add(const std::vector<ContactBlock> &blocks, const std::vector<Known<6>> &known)
  {
    for (std::size_t m = 0; m < blocks.size(); m++) {
      const auto &b = blocks[m];
      const int *pair = known[m].pair.data();
      for (int k = 0; k < 6; k++) {
        const double weight = b.tangential * b.w[k];
        diagonal[b.n[k]] += weight * (known[m].repeats ? weight_of(b.n[k], b) : b.w[k]);
        for (int l = 0; l < k; l++) value[*pair++] += weight * b.w[l];
      }
    }
  }

  // a node may stand in two slots of a contact: a cell may touch itself

  static double weight_of(int n, const ContactBlock &b)
  {
    double weight = 0.0;
    for (int l = 0; l < 6; l++)
      if (b.n[l] == n) weight += b.w[l];
    return weight;
  }
};

}    // namespace dcm

#endif
