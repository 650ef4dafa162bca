/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_mark.h"

#include "atom.h"
#include "dcm_args.h"
#include "fix_dcm_cell.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/mark";

// fix ID group dcm/mark [area A] [steps first last] [band region low high]

FixDCMMark::FixDCMMark(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), area(1.0), first(0), last(MAXSMALLINT), cell(nullptr)
{
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"area", "steps", "band"});
  args.may_repeat({"band"});
  while (args.next()) {
    if (args.is("area")) {
      area = args.number();
    } else if (args.is("steps")) {
      first = args.whole(0);
      last = args.whole(0);
    } else {
      Band band = {};
      band.region = (int) args.whole(0);
      band.low = args.number();
      band.high = args.number();
      bands.push_back(band);
    }
  }
}

int FixDCMMark::setmask()
{
  return INITIAL_INTEGRATE;
}

void FixDCMMark::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  marked = cell->change_cells().add(STYLE, "marked_area", DCMColumn::RESET, 0.0, {}, marked);
}

void FixDCMMark::setup(int)
{
  const auto &faces = cell->faces();
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &it = cell->cells()[faces[f].cell];
    const double *const x = atom->x[faces[f].atom];
    const double dx = x[0] - it.x[0], dy = x[1] - it.x[1], dz = x[2] - it.x[2];
    const double height = dz / std::sqrt(dx * dx + dy * dy + dz * dz);
    for (const auto &band : bands)
      if (height > band.low && height <= band.high) cell->set_region(f, band.region);
  }
  if (!bands.empty()) cell->update_regions();
}

void FixDCMMark::initial_integrate(int)
{
  const auto &table = cell->cells();
  const bool now = update->ntimestep >= first && update->ntimestep <= last;
  for (const int row : table.all_deformable())
    (*marked)(row) = now && (table[row].mask & groupbit) ? area : 0.0;
}
