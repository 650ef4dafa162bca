/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/remesh,DCMTimedFix<FixDCMRemesh>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_REMESH_H
#define LMP_FIX_DCM_REMESH_H

#include "dcm_cell_surgery.h"
#include "dcm_log.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"
#include "law/remesh.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Better faces for deformable cells that have flowed, in a run. A cell keeps its atoms, its row of
// the table and all its columns; it is the same cell with other edges.

class FixDCMRemesh : public Fix, public DCMRole {
 public:
  FixDCMRemesh(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;

  std::string work() override;
  void cell_converted(int row, double) override { (*tried)(row) = UNTRIED; }

 private:
  static constexpr double UNTRIED = 2.0;

  struct Needy {
    tagint molecule;
    double need;    // below 1, see dcm::remesh_need
  };

  class FixDCMCell *cell;
  DCMCellTable::Handle tried;    // need of a cell that could be made no better
  int every;                     // steps between two looks, as given, 0: not
  dcm::RemeshSettings settings;
  bool springs;    // has the deck a cortex, whose energy counts?
  DCMLog log;
  std::vector<Needy> needy;    // in this step

  bigint ncells, nflips, nslides, nmoves;    // so far
  bigint nleft;                              // tries that changed nothing
  double distance, volume;                   // largest so far

  void parse(int, char **);
  void check_others() const;
  double quality_now() const;
  dcm::RemeshCell prepare(const DCMCellSurgery::Cell &, const std::vector<tagint> &marked) const;
  std::vector<tagint> marks() const;
  dcm::Remeshed find(const DCMCellSurgery::Cell &, const std::vector<tagint> &marked, int root);
  void count(const DCMCellSurgery::Cell &, const dcm::Remeshed &);
};

}    // namespace LAMMPS_NS

#endif
#endif
