/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef ATOM_CLASS
// clang-format off
AtomStyle(dcm,AtomVecDCM);
// clang-format on
#else

#ifndef LMP_ATOM_VEC_DCM_H
#define LMP_ATOM_VEC_DCM_H

#include "atom_vec.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// per-atom state of the package, indexed by local atom; the arrays belong to the atom style

struct DCMAtoms {
  int *kind = nullptr;          // one of AtomVecDCM::Kind
  int *region = nullptr;        // faces: one of AtomVecDCM::Region
  tagint **vertex = nullptr;    // faces: vertex tag minus own tag, counter-clockwise from outside;
                                // tracers: HOME, HOST, WEIGHTS
  double *volume0 = nullptr;    // centers: rest volume of the cell
  double **l0 = nullptr;        // per bond slot: rest length of the edge, < 0: not set yet
  double **theta0 = nullptr;    // per dihedral slot: rest angle of the hinge, > 4: not set yet
  bigint *bonded = nullptr;     // stamp() of the bonds and dihedrals that l0 and theta0 are of
};

class AtomVecDCM : public AtomVec {
 public:
  enum Kind { SPHERE = 1, CENTER, NODE, FACE, TRACER };
  enum Region { LATERAL, POLAR, APICAL, JUNCTION, BASAL, NREGION };    // as in restart files

  // numbers of a tracer in its row of `vertex`: molecule ID of the cell it is in (0: outside),
  // atom ID of the face it is caught on (0: none), and where on it (fix dcm/tracer)
  enum Tracer { HOME, HOST, WEIGHTS };

  static constexpr double UNSET_L0 = -1.0, UNSET_THETA0 = 10.0;

  AtomVecDCM(class LAMMPS *);
  void grow_pointers() override;
  void create_atom_post(int) override;
  void data_atom_post(int) override;
  void data_bonds_post(int, int, tagint, tagint, tagint) override;
  void pack_data_pre(int) override;
  void pack_data_post(int) override;
  int property_atom(const std::string &) override;
  void pack_property_atom(int, double *, int, int) override;
  void unpack_restart_init(int) override;
  int size_restart() override;
  int pack_restart(int, double *) override;
  int unpack_restart(double *) override;

  // the state of the running atom style; an error naming the asking style if there is none

  static DCMAtoms *require(class LAMMPS *, const std::string &asking);

  // what bonds and dihedrals an atom stores and in which order, never 0. Rest lengths and angles
  // stand in these slots: a stamp that is not `bonded` tells that a command which does not know
  // them has edited the lists. The same after a shift of all IDs of a cell. The second form is of
  // the first so many bonds and dihedrals only.

  static bigint stamp(const class Atom *, int i);
  static bigint stamp(const class Atom *, int i, int nbonds, int ndihedrals);

  // per atom type, on all ranks: does it hold atoms of the group of one of these kinds now

  static std::vector<int> types_holding(class LAMMPS *, const std::vector<Kind> &kinds,
                                        int groupbit);

 private:
  DCMAtoms *data;

  void init_slots(int);
};

}    // namespace LAMMPS_NS

#endif
#endif
