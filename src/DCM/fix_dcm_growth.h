/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/growth,DCMTimedFix<FixDCMGrowth>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_GROWTH_H
#define LMP_FIX_DCM_GROWTH_H

#include "dcm_request.h"
#include "dcm_rest_change.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"
#include "law/growth.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// The cell cycle (S1 "Cell cycle and cell division"): rest volumes and rest lengths of the cells of
// its group grow, cells round up and become READY to divide, or rest. What it knows of a cell is a
// column of the table of cells (fix dcm/cell), deformable and center-based cells alike.

class FixDCMGrowth : public Fix, public DCMRole {
 public:
  FixDCMGrowth(class LAMMPS *, int, char **);
  ~FixDCMGrowth() override;
  int setmask() override;
  void post_constructor() override;
  void init() override;
  void initial_integrate(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;

  unsigned traits() const override { return GROWS_SPHERES | MAKES_READY; }
  void cell_divided(const DCMCellTable::Division &) override;
  void cell_removed(int) override;
  void cell_converted(int, double) override;
  void cell_retyped(int, int) override;
  bool rest_ahead(double, std::vector<RestAhead> &) override;
  double next_event() override;

 private:
  struct Cycle {        // of one cell, all doubles: the column's numbers, in this order
    double member;      // 1: this fix makes it grow; 0: not of its group
    double duration;    // cycle time of this cell, 0: its type does not divide
    double born;        // rest volume at birth
    double newborn;     // volume at birth, 0: not measured yet
    double progress;    // of the cycle, 0 to 1
    double length;      // factor on the rest lengths: 1, below while rounding up
    double pressure_before, pressure;    // when rounding up began, largest since
  };

  std::unique_ptr<class DCMParameters> parameters;
  class FixDCMCell *cell;
  class PairDCMContact *contact;    // nullptr: no compression, or no center-based cells
  DCMCellTable::Handle cycles;      // a Cycle per cell
  DCMRequest<> spheres, virial;
  DCMRestChange rest;
  std::uint64_t seed;
  dcm::GrowthLaw law;
  double half, exponent;          // slowing by compression; half = 0: none
  double rounding, shortening;    // part of the cycle; factor on rest lengths at its end
  bool until_volume, random_age;
  double newborn;                      // rest volume of a newborn, 0: that of each first cell
  std::vector<double> bulk_modulus;    // per atom type, 0: unknown; for compression
  std::vector<double> fraction;        // per atom type: proliferating fraction, < 0: not held
  std::vector<std::string> fraction_names;
  std::vector<double> fraction_values;

  bigint births, deaths;
  std::vector<double> sphere_pressure;    // per row of the table

  void parse_keyword(class DCMArgs &);
  void enroll();
  void enroll(int row);
  Cycle newcomer(int row);
  void draw_cycle(int row, Cycle &);
  void hold_fractions();
  void measure_spheres();
  // over a cycle: growth factor at most, rate of growth now, rest volume and factor on rest lengths
  double most() const;
  double rate(int row) const;
  double volume_at(const Cycle &, double progress) const;
  double length_at(double progress) const;
  double strain(int row) const;
  bool reads_cells() const;
  void advance(int row);
  template <class Predicate> int count(Predicate &&) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
