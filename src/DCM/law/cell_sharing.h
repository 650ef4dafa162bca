// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Sums over cells among the processes that share them. A sum over all processes would grow with
// the whole tissue; here each process hears of the cells that have atoms on it, and only from the
// processes that own atoms of these, which are its neighbors.
//
// A process owns a part of a cell if it owns atoms of it: these have something to add. It touches a
// cell if it has any atom of it, ghosts included: these want to know. Parts are added in the order
// of the processes, so that all that share a cell get the same sum, to the last bit.

#ifndef DCM_CELL_SHARING_H
#define DCM_CELL_SHARING_H

#include <algorithm>
#include <cstddef>
#include <mpi.h>
#include <vector>

namespace dcm {

class CellSharing {
 public:
  enum Part : char { NONE, TOUCHES, OWNS };    // what a process has of a cell

  explicit CellSharing(MPI_Comm _world) : world(_world)
  {
    MPI_Comm_rank(world, &me);
    MPI_Comm_size(world, &nprocs);
  }

  /// Who shares which cells, from what each process has of every cell, in the same order
  /// everywhere. Collective. The answer comes by way of a process that is asked about this cell
  /// by all, so that nobody needs to know where a cell is; cost: one number per process, and a
  /// few per cell of this process.
  void connect(const std::vector<char> &parts)
  {
    peers.clear();
    mine.clear();
    ours.clear();
    if (nprocs == 1) return;
    const int nrows = (int) parts.size();

    // ask

    std::vector<int> rows;
    std::vector<std::vector<int>> asked(nprocs);    // 2 row + does it own?
    for (int row = 0; row < nrows; row++) {
      if (parts[row] == NONE) continue;
      rows.push_back(row);
      asked[office(row, nrows)].push_back(2 * row + (parts[row] == OWNS));
    }
    const auto questions = exchange(asked);

    // answer: for each cell asked about the number of others, and for each 2 process + owns

    struct Entry {
      int row, who;
    };
    std::vector<Entry> entries;
    for (int p = 0; p < nprocs; p++)
      for (const int it : questions[p]) entries.push_back({it / 2, 2 * p + it % 2});
    std::stable_sort(entries.begin(), entries.end(), [](const Entry &a, const Entry &b) {
      return a.row < b.row;
    });
    std::vector<std::vector<int>> answers(nprocs);
    for (std::size_t begin = 0, end; begin < entries.size(); begin = end) {
      end = begin;
      while (end < entries.size() && entries[end].row == entries[begin].row) end++;
      for (std::size_t m = begin; m < end; m++) {
        auto &to = answers[entries[m].who / 2];
        to.push_back((int) (end - begin) - 1);
        for (std::size_t n = begin; n < end; n++)
          if (n != m) to.push_back(entries[n].who);
      }
    }
    const auto told = exchange(answers);

    // what goes to whom: what two owners share comes first, see sum()

    std::vector<Peer> all(nprocs);
    std::vector<std::size_t> next(nprocs, 0);
    std::vector<std::vector<int>> send_more(nprocs), receive_more(nprocs);
    for (const int row : rows) {
      const int p = office(row, nrows);
      const bool i_own = parts[row] == OWNS;
      bool another = false;
      for (int n = told[p][next[p]++]; n > 0; n--) {
        const int who = told[p][next[p]++] / 2;
        const bool owns = told[p][next[p] - 1] % 2;
        if (i_own && owns) {
          all[who].send.push_back(row);
          all[who].receive.push_back(row);
        } else if (i_own) {
          send_more[who].push_back(row);
        } else if (owns) {
          receive_more[who].push_back(row);
        }
        another |= owns;
      }
      if (!another) continue;
      if (i_own) all[me].receive.push_back(row);
      (i_own ? ours : mine).push_back(row);
    }
    for (int p = 0; p < nprocs; p++) {
      Peer &it = all[p];
      it.rank = p;
      it.nboth = it.receive.size();
      it.send.insert(it.send.end(), send_more[p].begin(), send_more[p].end());
      it.receive.insert(it.receive.end(), receive_more[p].begin(), receive_more[p].end());
      if (!it.send.empty() || !it.receive.empty()) peers.push_back(std::move(it));
    }
    requests.resize(2 * peers.size());
  }

  /// Add up the rows of values, width numbers each, over the processes that own parts of the cell;
  /// collective among these. owners_only: those that own nothing of a cell need not know its sum,
  /// and have no defined value then. Rows of cells that this process does not touch stay.
  void sum(double *values, int width, bool owners_only = false)
  {
    if (peers.empty()) return;
    int n = 0;
    for (auto &it : peers) {
      it.in.resize(width * count(it.receive, it, owners_only));
      it.out.resize(it.rank == me ? 0 : width * count(it.send, it, owners_only));
      if (it.rank == me)
        pack(it.in, it.receive, values, width);
      else if (!it.in.empty())
        MPI_Irecv(it.in.data(), (int) it.in.size(), MPI_DOUBLE, it.rank, TAG, world,
                  &requests[n++]);
    }
    for (auto &it : peers) {
      if (it.out.empty()) continue;
      pack(it.out, it.send, values, width);
      MPI_Isend(it.out.data(), (int) it.out.size(), MPI_DOUBLE, it.rank, TAG, world,
                &requests[n++]);
    }
    MPI_Waitall(n, requests.data(), MPI_STATUSES_IGNORE);
    zero(ours, values, width);
    if (!owners_only) zero(mine, values, width);
    for (const auto &it : peers)
      for (std::size_t m = 0; m < it.in.size(); m++)
        values[(std::size_t) width * it.receive[m / width] + m % width] += it.in[m];
  }

  double memory_usage() const
  {
    double bytes = (double) sizeof(int) * (mine.capacity() + ours.capacity());
    for (const auto &it : peers)
      bytes += (double) sizeof(int) * (it.send.capacity() + it.receive.capacity()) +
               (double) sizeof(double) * (it.in.capacity() + it.out.capacity());
    return bytes;
  }

 private:
  static constexpr int TAG = 8;

  struct Peer {    // in the order of processes; this one is among them, with what it adds itself
    int rank = 0;
    std::size_t nboth = 0;             // so many rows at the front have atoms owned by both
    std::vector<int> send, receive;    // rows
    std::vector<double> in, out;
  };

  MPI_Comm world;
  int me, nprocs;
  std::vector<Peer> peers;
  std::vector<int> ours, mine;    // rows with parts of others: with atoms owned here, without
  std::vector<MPI_Request> requests;

  int office(int row, int nrows) const { return (int) ((long long) row * nprocs / nrows); }

  static std::size_t count(const std::vector<int> &rows, const Peer &it, bool owners_only)
  {
    return owners_only ? it.nboth : rows.size();
  }

  static void pack(std::vector<double> &to, const std::vector<int> &rows, const double *values,
                   int width)
  {
    for (std::size_t m = 0; m < to.size() / width; m++)
      std::copy_n(values + (std::size_t) width * rows[m], width, to.data() + width * m);
  }

  static void zero(const std::vector<int> &rows, double *values, int width)
  {
    for (const int row : rows) std::fill_n(values + (std::size_t) width * row, width, 0.0);
  }

  // lists of numbers from every process to every other

  std::vector<std::vector<int>> exchange(const std::vector<std::vector<int>> &out)
  {
    std::vector<int> size(nprocs), incoming(nprocs);
    for (int p = 0; p < nprocs; p++) size[p] = (int) out[p].size();
    MPI_Alltoall(size.data(), 1, MPI_INT, incoming.data(), 1, MPI_INT, world);
    std::vector<std::vector<int>> in(nprocs);
    std::vector<MPI_Request> pending;
    for (int p = 0; p < nprocs; p++) {
      in[p].resize(incoming[p]);
      if (p == me || in[p].empty()) continue;
      pending.emplace_back();
      MPI_Irecv(in[p].data(), incoming[p], MPI_INT, p, TAG, world, &pending.back());
    }
    in[me] = out[me];
    for (int p = 0; p < nprocs; p++) {
      if (p == me || out[p].empty()) continue;
      pending.emplace_back();
      MPI_Isend(out[p].data(), size[p], MPI_INT, p, TAG, world, &pending.back());
    }
    MPI_Waitall((int) pending.size(), pending.data(), MPI_STATUSES_IGNORE);
    return in;
  }
};

}    // namespace dcm

#endif
