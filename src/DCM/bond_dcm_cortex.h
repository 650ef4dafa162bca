/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef BOND_CLASS
// clang-format off
BondStyle(dcm/cortex,DCMTimedForce<BondDCMCortex>);
// clang-format on
#else

#ifndef LMP_BOND_DCM_CORTEX_H
#define LMP_BOND_DCM_CORTEX_H

#include "bond.h"
#include "dcm_coefs.h"
#include "dcm_role.h"
#include "dcm_slots.h"
#include "dcm_timed.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Elastic part of the cortex edges (S1 eqs 1-3). Every bond has its own rest length, the state
// DCMAtoms::l0 of its slot, which others may change at any time; a bond without one takes its
// length at the first step that sees it. The dashpot is a contribution to the friction system of
// fix dcm/motion.

class BondDCMCortex : public Bond, public DCMRole {
 public:
  BondDCMCortex(class LAMMPS *);
  ~BondDCMCortex() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  double equilibrium_distance(int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double single(int, double, int, int, double &) override;
  double memory_usage() override;

  double stiffness(int type) const { return coefs[type].ks; }    // force/length

  void list_friction(dcm::FrictionSystem &, class DCMUnknowns &) override;
  void add_friction(dcm::FrictionSystem &, class DCMUnknowns &) override;
  void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) override;
  void add_cell_virial(std::vector<double> &) override;
  void add_ahead(const std::vector<RestAhead> &, std::vector<double> &,
                 class DCMUnknowns &) override;

 private:
  struct Coef {
    double E = 0.0, h = 0.0, gamma = 0.0;
    int young = 0, projected = 0;
    double ks = 0.0;         // from E, h and young
    double longest = 0.0;    // longest rest length, for the ghost cutoff

    std::vector<DCMField> fields();
    std::string derive();
  };
  DCMCoefs<Coef> coefs;

  struct DCMAtoms *dcm;
  DCMSlots slots;                      // of neighbor->bondlist, stored with the first atom
  std::vector<int> projected_edges;    // indices into neighbor->bondlist

  void allocate();
  void match_slots();
};

}    // namespace LAMMPS_NS

#endif
#endif
