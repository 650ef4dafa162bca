/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_ALLGATHER_H
#define LMP_DCM_ALLGATHER_H

#include <mpi.h>
#include <vector>

namespace LAMMPS_NS {

// all ranks' items, rank after rank, on every rank; Item: plain data. offsets, if given, receives
// where the items of each rank begin

template <class Item>
std::vector<Item> dcm_allgather(const std::vector<Item> &mine, MPI_Comm world,
                                std::vector<int> *offsets = nullptr)
{
  int nprocs;
  MPI_Comm_size(world, &nprocs);
  const int nbytes = (int) (mine.size() * sizeof(Item));
  std::vector<int> counts(nprocs), first(nprocs, 0);
  MPI_Allgather(&nbytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < nprocs; p++) first[p] = first[p - 1] + counts[p - 1];
  std::vector<Item> all((first.back() + counts.back()) / sizeof(Item));
  MPI_Allgatherv(mine.data(), nbytes, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE,
                 world);
  if (offsets) {
    offsets->clear();
    for (const int byte : first) offsets->push_back(byte / (int) sizeof(Item));
  }
  return all;
}

// the same on rank 0 only

template <class Item> std::vector<Item> dcm_gather(const std::vector<Item> &mine, MPI_Comm world)
{
  int me, nprocs;
  MPI_Comm_rank(world, &me);
  MPI_Comm_size(world, &nprocs);
  const int nbytes = (int) (mine.size() * sizeof(Item));
  std::vector<int> counts(nprocs, 0), first(nprocs, 0);
  MPI_Gather(&nbytes, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, world);
  for (int p = 1; p < nprocs; p++) first[p] = first[p - 1] + counts[p - 1];
  std::vector<Item> all;
  if (me == 0) all.resize((first.back() + counts.back()) / sizeof(Item));
  MPI_Gatherv(mine.data(), nbytes, MPI_BYTE, all.data(), counts.data(), first.data(), MPI_BYTE, 0,
              world);
  return all;
}

}    // namespace LAMMPS_NS

#endif
