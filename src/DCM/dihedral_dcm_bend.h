/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef DIHEDRAL_CLASS
// clang-format off
DihedralStyle(dcm/bend,DCMTimedForce<DihedralDCMBend>);
// clang-format on
#else

#ifndef LMP_DIHEDRAL_DCM_BEND_H
#define LMP_DIHEDRAL_DCM_BEND_H

#include "dcm_coefs.h"
#include "dcm_role.h"
#include "dcm_slots.h"
#include "dcm_timed.h"
#include "dihedral.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Bending of the cortex (S1 eqs 4-5), one hinge per mesh edge. Atoms: 2 and 3 are the edge, 1 and 4
// the opposite corners of its triangles (2,3,1) and (3,2,4), both counter-clockwise from outside.
// With `rest mesh` each hinge has its own rest angle, the state DCMAtoms::theta0 of its slot, which
// others may change at any time; one without takes its angle at the first step that sees it.

class DihedralDCMBend : public Dihedral, public DCMRole {
 public:
  DihedralDCMBend(class LAMMPS *);
  ~DihedralDCMBend() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double memory_usage() override;

  void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) override;
  void add_cell_virial(std::vector<double> &) override;

  double stiffness(int type) const { return coefs[type].kb; }      // energy
  bool rest_angles(int type) const { return coefs[type].mesh; }    // rest mesh: own angles count

 private:
  struct Coef {
    double E = 0.0, h = 0.0, nu = 0.0;
    int mesh = 0;
    double kb = 0.0;    // from E, h and nu

    std::vector<DCMField> fields();
    std::string derive();
  };
  DCMCoefs<Coef> coefs;

  struct DCMAtoms *dcm;
  DCMSlots slots;    // of neighbor->dihedrallist, stored with the second atom

  void allocate();
  void match_slots();
};

}    // namespace LAMMPS_NS

#endif
#endif
