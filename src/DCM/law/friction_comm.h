// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Messages of the friction solver. LAMMPS' own forward and reverse communication would run over
// every ghost atom in up to six swaps; here each process asks the owners directly for the few
// unknowns that its blocks really touch. All copies of an unknown on one process share one slot,
// so that periodic images of own atoms need no message at all.

#ifndef DCM_FRICTION_COMM_H
#define DCM_FRICTION_COMM_H

#include "cell_sharing.h"
#include "friction.h"

#include <cstddef>
#include <cstdint>
#include <mpi.h>
#include <vector>

namespace dcm {

class FrictionComm {
 public:
  double seconds = 0.0;            // spent in messages so far
  CellSharing *cells = nullptr;    // for blocks of whole cells, if there are any

  explicit FrictionComm(MPI_Comm _world) : world(_world) { MPI_Comm_size(world, &nprocs); }

  // begin anew after a rebuild of the neighbor lists; known: per process, how many of its unknowns
  // are known here as ghosts. Collective

  void connect(const std::vector<int> &known)
  {
    peers.clear();
    peer_of.assign(nprocs, -1);
    if (nprocs == 1) return;
    std::vector<int> asked(nprocs, 0);
    MPI_Alltoall(known.data(), 1, MPI_INT, asked.data(), 1, MPI_INT, world);
    for (int p = 0; p < nprocs; p++) {
      if (known[p] == 0 && asked[p] == 0) continue;
      peer_of[p] = (int) peers.size();
      peers.emplace_back();
      peers.back().rank = p;
      peers.back().from = known[p] > 0;
      peers.back().to = asked[p] > 0;
    }
    requests.resize(2 * peers.size());
  }

  // ask the owner for one more unknown, to be kept in slot; takes effect with update()

  void request(int owner, std::int64_t tag, int slot)
  {
    Peer &peer = peers[peer_of[owner]];
    peer.wanted.push_back(tag);
    peer.mine.push_back(slot);
  }

  // send the new requests to the owners; slot_of(tag) gives the slot of an owned unknown

  template <class SlotOf> void update(SlotOf &&slot_of)
  {
    if (peers.empty()) return;
    const double start = MPI_Wtime();
    int n = 0;
    for (auto &peer : peers)
      if (peer.from)
        MPI_Isend(peer.wanted.data(), (int) peer.wanted.size(), MPI_INT64_T, peer.rank, TAG, world,
                  &requests[n++]);
    for (auto &peer : peers) {
      if (!peer.to) continue;
      MPI_Status status;
      int count = 0;
      MPI_Probe(peer.rank, TAG, world, &status);
      MPI_Get_count(&status, MPI_INT64_T, &count);
      tags.resize(count);
      MPI_Recv(tags.data(), count, MPI_INT64_T, peer.rank, TAG, world, MPI_STATUS_IGNORE);
      for (auto tag : tags) peer.theirs.push_back(slot_of(tag));
    }
    MPI_Waitall(n, requests.data(), MPI_STATUSES_IGNORE);
    for (auto &peer : peers) {
      peer.wanted.clear();
      peer.in.resize(6 * peer.mine.size() + 6 * peer.theirs.size());
      peer.out.resize(peer.in.size());
    }
    seconds += MPI_Wtime() - start;
  }

  // the policy of FrictionSolver

  void forward(double *x)
  {
    if (peers.empty()) return;
    const double start = MPI_Wtime();
    int n = 0;
    for (auto &peer : peers)
      if (!peer.mine.empty())
        MPI_Irecv(peer.in.data(), 3 * (int) peer.mine.size(), MPI_DOUBLE, peer.rank, TAG, world,
                  &requests[n++]);
    for (auto &peer : peers) {
      if (peer.theirs.empty()) continue;
      double *buf = peer.out.data();
      for (const int slot : peer.theirs)
        for (int k = 0; k < 3; k++) *buf++ = x[STRIDE * (std::size_t) slot + k];
      MPI_Isend(peer.out.data(), 3 * (int) peer.theirs.size(), MPI_DOUBLE, peer.rank, TAG, world,
                &requests[n++]);
    }
    MPI_Waitall(n, requests.data(), MPI_STATUSES_IGNORE);
    for (auto &peer : peers) {
      const double *buf = peer.in.data();
      for (const int slot : peer.mine)
        for (int k = 0; k < 3; k++) x[STRIDE * (std::size_t) slot + k] = *buf++;
    }
    seconds += MPI_Wtime() - start;
  }

  // contributions are added in the order of the processes, so that sums do not depend on timing

  void reverse(double *y, int stride, int width)
  {
    if (peers.empty()) return;
    const double start = MPI_Wtime();
    int n = 0;
    for (auto &peer : peers)
      if (!peer.theirs.empty())
        MPI_Irecv(peer.in.data(), width * (int) peer.theirs.size(), MPI_DOUBLE, peer.rank, TAG,
                  world, &requests[n++]);
    for (auto &peer : peers) {
      if (peer.mine.empty()) continue;
      double *buf = peer.out.data();
      for (const int slot : peer.mine)
        for (int k = 0; k < width; k++) *buf++ = y[(std::size_t) stride * slot + k];
      MPI_Isend(peer.out.data(), width * (int) peer.mine.size(), MPI_DOUBLE, peer.rank, TAG, world,
                &requests[n++]);
    }
    MPI_Waitall(n, requests.data(), MPI_STATUSES_IGNORE);
    for (auto &peer : peers) {
      const double *buf = peer.in.data();
      for (const int slot : peer.theirs)
        for (int k = 0; k < width; k++) y[(std::size_t) stride * slot + k] += *buf++;
    }
    seconds += MPI_Wtime() - start;
  }

  void sum(double *values, int n)
  {
    if (nprocs == 1) return;
    const double start = MPI_Wtime();
    MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_SUM, world);
    seconds += MPI_Wtime() - start;
  }

  // `width` numbers per row of the table of cells, over those that own nodes of the cell

  void sum_cells(double *values, int width)
  {
    if (nprocs == 1) return;
    const double start = MPI_Wtime();
    cells->sum(values, width, true);
    seconds += MPI_Wtime() - start;
  }

 private:
  static constexpr int TAG = 7;

  struct Peer {
    int rank = 0;
    bool from = false, to = false;       // may I need unknowns of it, may it need mine?
    std::vector<int> mine, theirs;       // slots of its unknowns kept here, of mine kept there
    std::vector<std::int64_t> wanted;    // requests not sent yet
    std::vector<double> in, out;
  };

  MPI_Comm world;
  int nprocs;
  std::vector<Peer> peers;
  std::vector<int> peer_of;    // per process, -1: none
  std::vector<MPI_Request> requests;
  std::vector<std::int64_t> tags;
};

}    // namespace dcm

#endif
