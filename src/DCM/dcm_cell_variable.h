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

// atom-style variables as values of cells: that of the atom that stands for the cell

// value at the atoms of some cells (molecules: sorted); collective

std::vector<double> dcm_cell_variable(class LAMMPS *, const std::string &name,
                                      const std::vector<tagint> &molecules);

// the argument v_NAME without its prefix; error if it is none, or, with exists, if there is no
// such atom-style variable

std::string dcm_variable_name(class LAMMPS *, const std::string &asking, const std::string &text);
void dcm_check_variable(class LAMMPS *, const std::string &asking, const std::string &name);

}    // namespace LAMMPS_NS

#endif
