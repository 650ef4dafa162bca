/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: a step: contacts of faces, what it hands over to others, communication

// Have cells run into each other?

#include "pair_dcm_contact.h"

#include "atom.h"
#include "dcm_triangle.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

/* ----------------------------------------------------------------------
   does x lie inside a cell, farther from its surface than an overlap may be? Asked of
   the few faces that seem to: those of sharp corners, as newborn cells have them, can lie
   far behind each other along the axis of a contact and yet next to the surface.
------------------------------------------------------------------------- */

bool PairDCMContact::deep_inside(const Vec3 &x, int cell) const
{
  double *const *const at = atom->x;
  dcm::SurfaceDistance nearest;
  for (const auto &face : fix_cell->faces) {
    if (face.cell != cell || face.v[0] < 0 || face.v[1] < 0 || face.v[2] < 0) continue;
    nearest.add(x, vec(at[face.v[0]]), vec(at[face.v[1]]), vec(at[face.v[2]]));
  }
  return nearest.inside() && nearest.distance() > overlap_used;
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::fail_pair(int i, int j, double overlap, double limit, double force)
{
  if (!std::isfinite(force) || !std::isfinite(overlap))
    error->one(FLERR,
               "Pair style dcm/contact: the contact of cells {} and {} (atoms {} and {}) has force "
               "{} at step {}; coincident cells, or a timestep too large",
               atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], force,
               update->ntimestep);
  error->one(FLERR,
             "Pair style dcm/contact: cells {} and {} run into each other: atoms {} and {} overlap "
             "by {:.4} at step {}, more than {:.4}; reduce the timestep or fix dcm/motion maxmove, "
             "give the cells a stiffer or tenser cortex, or raise keyword range",
             atom->molecule[i], atom->molecule[j], atom->tag[i], atom->tag[j], overlap,
             update->ntimestep, limit);
}
