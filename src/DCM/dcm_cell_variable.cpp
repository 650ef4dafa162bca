/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_cell_variable.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "error.h"
#include "input.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

std::vector<double> LAMMPS_NS::dcm_cell_variable(LAMMPS *lmp, const std::string &name,
                                                 const std::vector<tagint> &molecules)
{
  const Atom *const atom = lmp->atom;
  const int *const kind = AtomVecDCM::require(lmp, "The table of cells")->kind;
  std::vector<double> values(molecules.size(), 0.0), per_atom(std::max(1, atom->nlocal));

  lmp->modify->clearstep_compute();
  lmp->input->variable->compute_atom(lmp->input->variable->find(name.c_str()), 0, per_atom.data(),
                                     1, 0);
  lmp->modify->addstep_compute(lmp->update->ntimestep + 1);
  for (int i = 0; i < atom->nlocal; i++) {
    if (kind[i] != AtomVecDCM::CENTER && kind[i] != AtomVecDCM::SPHERE) continue;
    const auto found = std::lower_bound(molecules.begin(), molecules.end(), atom->molecule[i]);
    if (found != molecules.end() && *found == atom->molecule[i])
      values[found - molecules.begin()] = per_atom[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, values.data(), (int) values.size(), MPI_DOUBLE, MPI_SUM, lmp->world);
  return values;
}
