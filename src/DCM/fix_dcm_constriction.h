/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/constriction,DCMTimedFix<FixDCMConstriction>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_CONSTRICTION_H
#define LMP_FIX_DCM_CONSTRICTION_H

#include "dcm_cell_table.h"
#include "dcm_request.h"
#include "dcm_role.h"
#include "dcm_slot_lengths.h"
#include "dcm_timed.h"
#include "law/constriction.h"

#include <vector>

namespace LAMMPS_NS {

// Apical constriction: once in its life, a cell shortens the rest lengths of the edges of its
// junction ribbon and of its apical cap, and lets go when it rounds up to divide (S1 eqs 11-13).
// Which edges, and their rest lengths without it, is kept per bond slot.

class FixDCMConstriction : public DCMSlotLengths, public DCMRole {
 public:
  FixDCMConstriction(class LAMMPS *, int, char **);
  ~FixDCMConstriction() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  double compute_vector(int) override;
  double memory_usage() override;

  unsigned traits() const override { return KEEPS_PLACES; }
  double longest_step() override;
  void cell_converted(int, double) override;

 private:
  enum When { LUMEN, BORN, TIME };
  double cap, ribbon, ramp;
  When when;
  double when_time;
  bool release;

  class FixDCMCell *cell;
  DCMRequest<> adjacency;
  DCMCellTable::Handle since;    // per cell: time when it began, < 0: it has not
  bool sure = false;             // the edges of constricted cells are this fix's
  DCMCellTable::Handle share;    // of the ramp, 0 to 1
  bool warned = false;

  std::vector<double> found;    // per row: edges of cells whose turn it may be
  std::vector<char> changed;    // per row: its share of the ramp is another one

  bool turn_of(const DCMCellTable::Cell &, double marked_area) const;
  void begin_cells();
  int choose_edges(int i, const DCMCellTable::Cell &);
  bool advance();
  void write_lengths();
  void check_edges();
};

}    // namespace LAMMPS_NS

#endif
#endif
