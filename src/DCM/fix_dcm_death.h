/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/death,DCMTimedFix<FixDCMDeath>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_DEATH_H
#define LMP_FIX_DCM_DEATH_H

#include "dcm_log.h"
#include "dcm_request.h"
#include "dcm_rest_change.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Takes away the cells of its group that meet all given criteria, at once or after they have
// shrunk to nothing.

class FixDCMDeath : public Fix, public DCMRole {
 public:
  FixDCMDeath(class LAMMPS *, int, char **);
  int setmask() override;
  void post_constructor() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_scalar() override;

  void cell_converted(int, double) override;
  bool rest_ahead(double, std::vector<RestAhead> &) override;
  double next_event() override;

 private:
  struct Shrinking {
    double left, from;    // time until the rest volume is gone, rest volume when it began
  };

  class FixDCMCell *cell;
  DCMRequest<> spheres;
  DCMRestChange rest;
  std::string region_id, variable;
  class Region *region;
  double age;       // < 0: not asked
  double rate;      // deaths per cell and time, < 0: not asked
  double shrink;    // time of shrinking, 0: at once
  bool always;      // criterion `all`
  std::uint64_t seed;
  DCMLog log;
  bigint removed;
  double since;                             // time since the last look, < 0: none yet
  DCMCellTable::Handle exposed;             // time for which a cell has met all criteria but `rate`
  std::vector<tagint> gone;                 // to take away in this step
  std::map<tagint, Shrinking> shrinking;    // cells that this fix made shrink

  void shrink_all();
  std::vector<tagint> condemned();
  std::string reason() const;
};

}    // namespace LAMMPS_NS

#endif
#endif
