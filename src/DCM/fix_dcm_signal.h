/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/signal,DCMTimedFix<FixDCMSignal>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_SIGNAL_H
#define LMP_FIX_DCM_SIGNAL_H

#include "dcm_cell_table.h"
#include "dcm_request.h"
#include "dcm_retype.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Cell-to-cell signaling: a deformable cell that has touched cells of another group, at a lumen,
// for long enough is fated to change its type; both its daughters have the new one (S1
// "Cell-to-cell signalling").

class FixDCMSignal : public Fix, public DCMRole {
 public:
  FixDCMSignal(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;

  unsigned traits() const override { return MAKES_CELLS; }    // the new types may be empty yet
  void daughters_take(int, DCMCellBuilder::Types &, DCMCellBuilder::Masks &) override;

 private:
  std::string from_id;
  int from;    // bit of the group that signals
  DCMRetype to;
  double least_area;     // of contact, over the area of the cell
  double signal_time;    // until the fate is decided, infinite: never
  bool lumen, hold;

  class FixDCMCell *cell;
  class PairDCMContact *contact;
  DCMRequest<> spheres;
  DCMRequest<int> partners;
  DCMCellTable::Handle signal, fate;    // per cell: time counted so far; 1: decided
  bool warned = false;
  double since;                        // time since the last look, < 0: none yet
  bigint switched;                     // cells that divided with their fate decided
  std::vector<double> contact_area;    // per row: with the group that signals

  bool listens(const DCMCellTable::Cell &) const;
  bool anyone_signals() const;
  void measure_contacts(bool heard);
  void count_time(bool heard);
};

}    // namespace LAMMPS_NS

#endif
#endif
