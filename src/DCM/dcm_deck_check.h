/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// settings of LAMMPS, atoms and groups with which styles of this package would go on with wrong
// numbers; looked at in init(), each an error that names what to change

#ifndef LMP_DCM_DECK_CHECK_H
#define LMP_DCM_DECK_CHECK_H

#include "atom_vec_dcm.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// dimension, neighbor settings under which lists may be older than atoms have moved, atoms that
// belong to no kind; collective

void dcm_check_deck(class LAMMPS *, const std::string &asking);

// one warning for each setting of neigh_modify that takes contacts away between some cells only

void dcm_warn_excluded(class LAMMPS *, const std::string &asking);

// a group that a style acts on through atoms of some kinds, those that stand for cells or move: an
// error if it holds atoms of cells but none of these kinds, so that nothing would ever happen

void dcm_check_group(class LAMMPS *, const std::string &asking, int igroup,
                     const std::vector<AtomVecDCM::Kind> &kinds);

}    // namespace LAMMPS_NS

#endif
