/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(dcm/cell,ComputeDCMCell);
// clang-format on
#else

#ifndef LMP_COMPUTE_DCM_CELL_H
#define LMP_COMPUTE_DCM_CELL_H

#include "compute.h"

#include <utility>
#include <vector>

namespace LAMMPS_NS {

// Values of whole cells, stored with the atom that stands for the cell: the center of a deformable
// cell, the sphere of a center-based cell. Other atoms have 0. Doc page compute_dcm_cell.

class ComputeDCMCell : public Compute {
 public:
  ComputeDCMCell(class LAMMPS *, int, char **);
  ~ComputeDCMCell() override;
  void init() override;
  void compute_peratom() override;
  void compute_vector() override;
  double memory_usage() override;

 private:
  // in the order of their names
  enum Value {
    VOLUME,
    VOLUME0,
    AREA,
    PRESSURE,
    X,
    Y,
    Z,
    VX,
    VY,
    VZ,
    CONTACT_AREA,
    FREE_AREA,
    NEIGHBORS,
    KIND,
    MOLECULE,
    MOTHER,
    GENERATION,
    BIRTH,
    PHASE,
    PROGRESS
  };

  std::vector<int> columns;    // a Value each
  bool want_velocity, want_area, want_neighbors;
  int nmax;

  struct DCMAtoms *dcm;
  class FixDCMCell *cell;           // nullptr: no deformable cells
  class PairDCMContact *contact;    // nullptr: no such pair style
  class FixDCMGrowth *growth;       // nullptr: no value of the cell cycle asked for
  bool has_volume;                  // a fix dcm/volume sets pressures

  std::vector<double> cell_sums;                        // per deformable cell, see sum_cells()
  std::vector<std::pair<tagint, tagint>> in_contact;    // sorted; both orders of each pair

  void check_current() const;
  void sum_cells();
  void gather_contacts();
  double neighbors_of(tagint) const;
  double sphere_volume(int) const;
  double sphere_pressure(int) const;
  double cycle_value(tagint, int) const;
  double cell_value(int, int) const;
  double sphere_value(int, int) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
