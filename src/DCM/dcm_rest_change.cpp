/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "dcm_rest_change.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "fix_dcm_cell.h"
#include "law/volume.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

// growth of a sphere's radius after which the neighbor list is rebuilt, in skins

static constexpr double REBUILD = 0.02;

void DCMRestChange::begin(FixDCMCell *_cell)
{
  cell = _cell;
  any = false;
  farthest = 0.0;
}

void DCMRestChange::mark(int row)
{
  if (!any) {
    lengths.assign(cell->cells().size(), 1.0);
    changed.assign(cell->cells().size(), 0);
  }
  any = true;
  changed[row] = 1;
}

void DCMRestChange::set_volume(int row, double volume0)
{
  mark(row);
  cell->change_cells().set_volume0(row, volume0);
}

void DCMRestChange::set(int row, double volume0, double factor)
{
  auto &table = cell->change_cells();
  const double before = table[row].volume0;
  if (volume0 == before && factor == 1.0) return;
  mark(row);
  lengths[row] *= factor * std::cbrt(volume0 / before);
  table.set_volume0(row, volume0);
  if (!table[row].deformable)
    farthest = std::max(farthest,
                        std::fabs(dcm::ball_radius(volume0) - dcm::ball_radius(table[row].built0)));
}

bool DCMRestChange::apply()
{
  if (!any) return false;
  DCMAtoms *const dcm = AtomVecDCM::require(lmp, "Fix dcm/cell");
  const auto &table = cell->cells();
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  for (int i = 0; i < nall; i++) {
    const int kind = dcm->kind[i], row = cell->cell_of(i);
    if (row < 0 || !changed[row]) continue;
    if (kind == AtomVecDCM::SPHERE) {
      atom->radius[i] = dcm::ball_radius(table[row].volume0);
    } else if (i < nlocal && kind == AtomVecDCM::CENTER) {
      dcm->volume0[i] = table[row].volume0;
    } else if (i < nlocal && kind == AtomVecDCM::NODE && lengths[row] != 1.0) {
      for (int m = 0; m < atom->num_bond[i]; m++)
        if (dcm->l0[i][m] > 0.0) dcm->l0[i][m] *= lengths[row];
    }
  }
  return farthest > REBUILD * neighbor->skin;
}
