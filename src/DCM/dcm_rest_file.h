/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_REST_FILE_H
#define LMP_DCM_REST_FILE_H

#include <string>

namespace LAMMPS_NS {

// Rest-state files: what a LAMMPS data file cannot hold, the rest length of every edge and the rest
// angle of every hinge, one line each and sorted by tags. Collective; errors name file and line.
// partial: the file may leave some out, which keep theirs

void dcm_write_rest_file(class LAMMPS *, const std::string &file);
void dcm_read_rest_file(class LAMMPS *, const std::string &file, bool partial);

}    // namespace LAMMPS_NS

#endif
