/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/polarity,DCMTimedFix<FixDCMPolarity>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_POLARITY_H
#define LMP_FIX_DCM_POLARITY_H

#include "dcm_cell_table.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"
#include "law/polarity.h"

#include <cstdint>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Apical vector A and polar vector P of deformable cells, and the regions of their faces that
// follow from both (S1 eqs 7-11, law/polarity.h). A cell is polar if its center is in the group.
//
// It looks in initial_integrate, at the surfaces and contacts of the last force evaluation, and
// before atoms move: a region that changed after the forces were computed would be in a restart
// file with forces that are not its own, and the run would not continue exactly.

class FixDCMPolarity : public Fix, public DCMRole {
 public:
  FixDCMPolarity(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_force(int) override;
  void initial_integrate(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;
  double memory_usage() override;

  void cell_divided(const DCMCellTable::Division &) override;
  void cell_converted(int, double) override;

 private:
  enum Start { RANDOM, FREE, TOWARD, VARIABLE };
  // settings

  bigint seed;
  int every;    // looks, as given, 0: not
  dcm::SurfaceCones cones;
  bool ribbon_auto, by_area;    // by_area: faces count with their free area
  enum { ALL, LUMEN, OUTSIDE };
  int sees;                // what turns A: free faces or those at a lumen; away from free ones
  bool blind;              // warned that nothing marks the faces at a lumen
  const DCMRole *marks;    // marks the faces at a lumen
  double theta;            // a face with less than this part in contact is free
  int axis;                // of a planar scene, -1: none
  Start start_mode;
  dcm::Vec3 point;
  std::string variable_name[3];
  double freeze;    // time after birth in which A stays

  struct DCMAtoms *dcm;
  class FixDCMCell *cell;
  class PairDCMContact *contact;
  DCMCellTable::Handle vectors, frozen, apical_area, junction_area;
  bool begun, warned;
  int nturned, nclosed;    // of the last look: A turned far, cells without a free face

  // of a look: per row of the table, whether it is due, and sums over its faces

  struct Sums {
    dcm::VectorSum normals;                              // of free faces
    std::int64_t nfree = 0, apical = 0, junction = 0;    // number; areas in units of area_unit()
  };
  std::vector<char> due;
  std::vector<Sums> sums;
  std::vector<std::int64_t> packed;
  std::vector<dcm::Vec3> outward;    // N of each owned face of a cell that is due

  void parse(int, char **);
  void parse_junction(class DCMArgs &);
  void check_groups() const;
  bool polar(const DCMCellTable::Cell &) const;
  bool has_vectors(int row) const;
  bool stays(int row) const;
  dcm::Vec3 A(int row) const;
  dcm::Vec3 P(int row) const;
  void set(int row, const dcm::Vec3 &A, const dcm::Vec3 &P);
  void forget(int row);

  bool find_due(bool all);
  void forget_leavers();
  void start(const std::vector<int> &rows);
  dcm::Vec3 given_vector(int row, const dcm::Vec3 &) const;
  dcm::Vec3 turned(int row, const dcm::Vec3 &P, const dcm::Vec3 &A) const;
  void look(bool turning);
  void find_outward();
  void sum_free_faces();
  void turn_cells();
  void set_regions();
  std::int64_t add_up(int nchanged);
  dcm::SurfaceCones cones_of(int row);
  double area_unit(int row) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
