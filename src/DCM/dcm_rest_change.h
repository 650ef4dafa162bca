/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_REST_CHANGE_H
#define LMP_DCM_REST_CHANGE_H

#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

// New rest states of whole cells, written to their atoms: the rest volume of a center, the rest
// lengths of a cell's edges, the radius of a sphere (ghosts too, without a message). For styles
// that change cells in initial_integrate, so that the forces of the step are those of the new
// state.
//
//   rest.begin(cell);
//   rest.set(row, volume0, factor);    // any number of cells, the same on all processes
//   if (rest.apply()) next_reneighbor = update->ntimestep;

class DCMRestChange : protected Pointers {
 public:
  explicit DCMRestChange(class LAMMPS *lmp) : Pointers(lmp) {}

  void begin(class FixDCMCell *);

  // factor: on the rest lengths, beyond that for the change of volume
  void set(int row, double volume0, double factor = 1.0);

  // the rest volume of a deformable cell alone: its cortex stays what it is
  void set_volume(int row, double volume0);

  // true: a sphere has left the radius that the neighbor lists were built for
  bool apply();

 private:
  class FixDCMCell *cell = nullptr;
  bool any = false;
  double farthest = 0.0;          // change of a radius since the lists were built
  std::vector<double> lengths;    // per row: factor on its rest lengths, 1: unchanged
  std::vector<char> changed;      // per row

  void mark(int row);
};

}    // namespace LAMMPS_NS

#endif
