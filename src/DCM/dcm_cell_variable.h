/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CELL_VARIABLE_H
#define LMP_DCM_CELL_VARIABLE_H

#include "lmptype.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// value of an atom-style variable at the atoms that stand for some cells (molecules: sorted);
// collective

std::vector<double> dcm_cell_variable(class LAMMPS *, const std::string &name,
                                      const std::vector<tagint> &molecules);

}    // namespace LAMMPS_NS

#endif
