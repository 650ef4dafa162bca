/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/volume,DCMTimedFix<FixDCMVolume>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_VOLUME_H
#define LMP_FIX_DCM_VOLUME_H

#include "dcm_parameters.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix_dcm_cell.h"

#include <vector>

namespace LAMMPS_NS {

// Pressure of deformable cells that resists a change of their volume (S1 eq 6). Adds it to the
// column "pressure" of the table of cells.

class FixDCMVolume : public Fix, public DCMRole {
 public:
  FixDCMVolume(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_reverse(int, int) override;
  void pre_reverse(int, int) override;
  void min_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  double compute_scalar() override;
  double compute_vector(int) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  double memory_usage() override;

  unsigned traits() const override { return GIVES_PRESSURE; }
  void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) override;
  void add_cell_virial(std::vector<double> &) override;
  void add_ahead(const std::vector<RestAhead> &, std::vector<double> &,
                 class DCMUnknowns &) override;

  // bulk modulus of a cell, 0: not acted on
  double bulk_modulus(const DCMCellTable::Cell &it) const
  {
    return acts_on(it) ? K_V[it.type] : 0.0;
  }

 private:
  FixDCMCell *cell;
  DCMParameters parameters;
  DCMCellTable::Handle sum;        // of the pressures of all contributors
  std::vector<double> K_V;         // per atom type, 0: none given, < 0: not acted on
  bool voronoi;                    // the source's form of the force instead of the gradient
  std::vector<double> pressure;    // per cell, 0 for cells not acted on
  double energy = 0.0, total = 0.0, count = 0.0;    // of cells whose center is here; pressures
  double extremes[2] = {0.0, 0.0}, all[3] = {0.0, 0.0, 0.0};
  bool summed = true;
  bool anyone = true;          // does it act on any cell of the tissue?
  bigint checked = -1;         // changes of cells when their parameters were looked at
  std::vector<double> node;    // sums per atom. voronoi: area, curvature vector, normal
  int width = 0;               // numbers per atom

  void read_moduli();
  bool acts_on(const DCMCellTable::Cell &) const;
  void cell_pressures();
  void sum_up();
  void gradient_forces();
  void voronoi_forces();
  void tally(int, const double *, const double *, const double *);
};

}    // namespace LAMMPS_NS

#endif
#endif
