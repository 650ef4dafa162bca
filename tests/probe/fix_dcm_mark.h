/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/mark,FixDCMMark);
// clang-format on
#else

#ifndef LMP_FIX_DCM_MARK_H
#define LMP_FIX_DCM_MARK_H

#include "dcm_cell_table.h"
#include "fix.h"

#include <vector>

namespace LAMMPS_NS {

// For tests only, in place of fix dcm/osmosis and fix dcm/polarity: column marked_area of the cells
// of the group, and regions of faces by their height above the center of their cell, once.

class FixDCMMark : public Fix {
 public:
  FixDCMMark(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;

 private:
  struct Band {
    int region;
    double low, high;    // of the height over the radius
  };
  std::vector<Band> bands;
  double area;
  bigint first, last;    // steps in which cells are marked
  class FixDCMCell *cell;
  DCMCellTable::Handle marked;
};

}    // namespace LAMMPS_NS

#endif
#endif
