/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/anchor,DCMTimedFix<FixDCMAnchor>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_ANCHOR_H
#define LMP_FIX_DCM_ANCHOR_H

#include "dcm_cell_table.h"
#include "dcm_request.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"

namespace LAMMPS_NS {

// Cells hold on to a network of fibers that moves with a velocity u, by n anchors each: the force
// on a cell is n * friction * (u - v). Daughters share the anchors of their mother, and cells build
// new ones. The worked example of doc/howto_extend.rst.

class FixDCMAnchor : public Fix, public DCMRole {
 public:
  FixDCMAnchor(class LAMMPS *, int, char **);
  int setmask() override;
  void post_constructor() override;
  void init() override;
  void initial_integrate(int) override;
  void setup_pre_reverse(int, int) override;
  void pre_reverse(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_scalar() override;
  double compute_vector(int) override;

  void cell_divided(const DCMCellTable::Division &) override;
  void cell_removed(int) override;
  void add_friction(dcm::FrictionSystem &, class DCMUnknowns &) override;

 private:
  double number;         // of anchors of a cell that has built all
  double friction;       // of one anchor (force * time / length)
  double velocity[3];    // of the network
  double recovery;       // time in which anchors are built anew, 0: never
  double share;          // of the first daughter

  struct DCMAtoms *dcm;
  class FixDCMCell *cell;
  DCMCellTable::Handle anchors;      // of each cell
  DCMRequest<> spheres;              // center-based cells stand in the table as well
  double divisions, deaths, lost;    // heard of so far; anchors of removed cells

  bool acts_on(const DCMCellTable::Cell &) const;
  double drag(int) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
