/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_GATHER_H
#define LMP_DCM_GATHER_H

#include "lmptype.h"

#include <mpi.h>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// all ranks' items, rank after rank, on every rank; Item: plain data

template <class Item> std::vector<Item> dcm_allgather(const std::vector<Item> &mine, MPI_Comm world)
{
  int nprocs;
  MPI_Comm_size(world, &nprocs);
  const int nbytes = (int) (mine.size() * sizeof(Item));
  std::vector<int> counts(nprocs), offsets(nprocs, 0);
  MPI_Allgather(&nbytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < nprocs; p++) offsets[p] = offsets[p - 1] + counts[p - 1];
  std::vector<Item> all((offsets.back() + counts.back()) / sizeof(Item));
  MPI_Allgatherv(mine.data(), nbytes, MPI_BYTE, all.data(), counts.data(), offsets.data(), MPI_BYTE,
                 world);
  return all;
}

// the atom that stands for a cell: the center of a deformable, the sphere of a center-based one

struct DCMCellAtom {
  tagint molecule;
  int type, mask, deformable;
  double volume0;    // rest volume
  double x[3];       // as stored: wrapped
};

// those of all cells, sorted by molecule, the same on all ranks

std::vector<DCMCellAtom> dcm_cell_atoms(class LAMMPS *);

// value of an atom-style variable at the atoms of some cells (molecules: sorted)

std::vector<double> dcm_cell_variable(class LAMMPS *, const std::string &name,
                                      const std::vector<tagint> &molecules);

}    // namespace LAMMPS_NS

#endif
