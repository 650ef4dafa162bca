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

#include <cstddef>
#include <cstdint>
#include <string>

namespace LAMMPS_NS {

// false on all ranks if rank 0 cannot open and read the file, a folder for instance; only rank 0
// looks at path

bool dcm_read_text(Comm *comm, MPI_Comm world, const std::string &path, std::string &text);

// write a file whole or not at all: a full disk leaves the old one. By one rank; the fault that
// kept it from being written, "" if none did

std::string dcm_replace_text(const std::string &path, const std::string &text);

// a sum that tells whether data has changed (FNV-1a)

std::uint64_t dcm_checksum(const void *data, std::size_t size);

// give all ranks the text of one

void dcm_bcast(MPI_Comm world, std::string &text, int root = 0);

}    // namespace LAMMPS_NS

#endif
