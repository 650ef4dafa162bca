/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// text files of the package (parameters, cell tables, rest states): rank 0 reads, all get the
// text, so that all ranks parse it and find the same errors. Lines end with a newline, whatever the
// editor that wrote them puts there, and the mark that some put before the first one is gone.

#ifndef LMP_DCM_TEXT_H
#define LMP_DCM_TEXT_H

#include "comm.h"

#include <algorithm>
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
      if (text.compare(0, 3, "\xEF\xBB\xBF") == 0) text.erase(0, 3);
      if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
      size = (bigint) text.size();
    }
  }
  MPI_Bcast(&size, 1, MPI_LMP_BIGINT, 0, world);
  if (size < 0) return false;
  text.resize(size);
  MPI_Bcast(&text[0], (int) size, MPI_CHAR, 0, world);
  return true;
}

// write a file whole or not at all: a full disk leaves the old one. By one rank; the fault that
// kept it from being written, "" if none did

std::string dcm_replace_text(const std::string &path, const std::string &text);

// give all ranks the text of one

void dcm_bcast(MPI_Comm world, std::string &text, int root = 0);

}    // namespace LAMMPS_NS

#endif
