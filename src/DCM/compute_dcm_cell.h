/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(dcm/cell,DCMTimedCompute<ComputeDCMCell>);
// clang-format on
#else

#ifndef LMP_COMPUTE_DCM_CELL_H
#define LMP_COMPUTE_DCM_CELL_H

#include "compute.h"
#include "dcm_cell_table.h"
#include "dcm_request.h"
#include "dcm_timed.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// Values of whole cells, stored with the atom that stands for the cell: the center of a deformable
// cell, the sphere of a center-based cell. Other atoms have 0. Besides its own values any column of
// the table of cells, by the name its style has given it. Doc page compute_dcm_cell.

class ComputeDCMCell : public Compute {
 public:
  ComputeDCMCell(class LAMMPS *, int, char **);
  ~ComputeDCMCell() override;
  void init() override;
  void setup() override;
  void compute_peratom() override;
  void compute_vector() override;
  double memory_usage() override;

 private:
  enum Need { NOTHING = 0, VELOCITY = 1, AREA = 2, NEIGHBORS = 4, SHAPE = 8, STRESS = 16 };
  static constexpr int NSUM = 5;       // per deformable cell: contact area, free area, velocity
  static constexpr int NSHAPE = 15;    // half-axes, long axis, three measures, strain

  struct Value {    // what this compute knows of a cell besides the columns of the table
    const char *name;
    double (ComputeDCMCell::*deformable)(int i, int row) const;
    double (ComputeDCMCell::*sphere)(int i, int row) const;
    unsigned needs;
  };
  static const std::vector<Value> VALUES;

  struct Column {    // of the output: one of VALUES or a number of a column of the table
    std::string name;
    const Value *value = nullptr;
    std::weak_ptr<const DCMColumn> table;    // it goes with its style
    int field = 0;
  };
  std::vector<Column> columns;
  unsigned needs;    // of all columns
  int nmax;

  struct DCMAtoms *dcm;
  class FixDCMCell *cell;           // nullptr: no deformable cells, and no value of the table
  class PairDCMContact *contact;    // nullptr: no such pair style
  DCMRequest<> spheres, virial, tensor;
  DCMRequest<int> partners;

  std::vector<double> cell_sums;                        // per row of the table, see sum_cells()
  std::vector<double> shapes, stresses;                 // NSHAPE, 6; of cells whose center is here
  std::vector<std::pair<tagint, tagint>> in_contact;    // sorted; both orders of each pair

  std::string known() const;
  [[noreturn]] void unknown(const std::string &) const;
  void check_current() const;
  void sum_cells();
  void measure_shapes();
  void measure_stresses();
  void gather_contacts();
  double neighbors_of(tagint) const;
  double sphere_volume(int) const;
  double sphere_pressure(int) const;

  template <int FIELD> double summed(int, int) const;
  template <int K> double center(int, int) const;
  template <int K> double atom_x(int, int) const;
  template <int K> double atom_v(int, int) const;
  double volume(int, int) const;
  double volume0(int, int) const;
  double area(int, int) const;
  double pressure(int, int) const;
  double kind(int, int) const;
  double molecule(int, int) const;
  double neighbors(int, int) const;
  double volume_of_sphere(int, int) const;
  double area_of_sphere(int, int) const;
  double pressure_of_sphere(int, int) const;
  double contact_area_of_sphere(int, int) const;
  double free_area_of_sphere(int, int) const;
  template <int K> double shape(int, int) const;
  template <int K> double shape_of_sphere(int, int) const;
  template <int K> double stress(int, int) const;
  template <int K> double stress_of_sphere(int, int) const;
  double sphericity(int, int) const;
  double shape_index(int, int) const;
  double sphericity_of_sphere(int, int) const;
  double shape_index_of_sphere(int, int) const;
  double mother(int, int) const;
  double generation(int, int) const;
  double birth(int, int) const;
  double phase(int, int) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
