/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/tension,DCMTimedFix<FixDCMTension>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_TENSION_H
#define LMP_FIX_DCM_TENSION_H

#include "atom_vec_dcm.h"
#include "dcm_parameters.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "dcm_value.h"
#include "fix_dcm_cell.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Constant surface tension of deformable cells, by cell type and surface region: energy T A of each
// face, and its gradient (law/tension.h).

class FixDCMTension : public Fix, public DCMRole {
 public:
  FixDCMTension(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_reverse(int, int) override;
  void pre_reverse(int, int) override;
  void min_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  double compute_scalar() override;
  double compute_vector(int) override;
  double memory_usage() override;

  void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) override;
  void add_cell_virial(std::vector<double> &) override;

 private:
  static constexpr int NREGION = AtomVecDCM::NREGION, ALL = NREGION;
  using Tensions = std::array<double, NREGION>;    // of a cell type, by region

  FixDCMCell *cell;
  DCMAtoms *dcm;
  DCMParameters parameters;
  struct Given {    // by the deck, per region and for all of them
    bool yes = false;
    DCMValue value;
  };
  std::array<Given, NREGION + 1> given;
  bool varies;                                      // some value is that of a variable
  bool started;                                     // has been set up once
  std::vector<Tensions> of_type;                    // per atom type
  std::array<const DCMValue *, NREGION> of_face;    // by region: an atom-style variable, nullptr
  std::vector<const Tensions *> of_row;             // per cell, nullptr: not acted on
  bool anyone = true;                               // has any cell of the tissue a tension?
  std::array<double, NREGION> energy;               // of this process, by region
  std::array<double, NREGION> all_energy;           // of all, once somebody has asked
  bool summed;

  void parse(class DCMArgs &);
  const Given *given_for(int region) const;
  void evaluate_variables();
  void refuse(const DCMValue &, double T) const;
  void read_tensions();
  double tension_of(int type, int region) const;
  void find_cells();
  double tension(const FixDCMCell::Face &) const;
  void sum_energies();
};

}    // namespace LAMMPS_NS

#endif
#endif
