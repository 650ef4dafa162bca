/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// text files of the package (parameters, cell tables, rest states): rank 0 reads, all get the
// text, so that all ranks parse it and find the same errors

#ifndef LMP_DCM_TEXT_H
#define LMP_DCM_TEXT_H

#include "comm.h"

#include <fstream>
#include <iterator>
#include <string>

namespace LAMMPS_NS {

// false on all ranks if rank 0 cannot open the file; only rank 0 looks at path

inline bool dcm_read_text(Comm *comm, MPI_Comm world, const std::string &path, std::string &text)
{
  bigint size = -1;
  if (comm->me == 0) {
    std::ifstream in(path);
    if (in) {
      text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
      size = (bigint) text.size();
    }
  }
  MPI_Bcast(&size, 1, MPI_LMP_BIGINT, 0, world);
  if (size < 0) return false;
  text.resize(size);
  MPI_Bcast(&text[0], (int) size, MPI_CHAR, 0, world);
  return true;
}
}    // namespace LAMMPS_NS

#endif
