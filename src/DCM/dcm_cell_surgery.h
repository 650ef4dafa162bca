/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CELL_SURGERY_H
#define LMP_DCM_CELL_SURGERY_H

#include "dcm_cell_builder.h"

#include <vector>

namespace LAMMPS_NS {

// Takes whole cells out of a running simulation and puts others in, in pre_exchange of a step that
// rebuilds the neighbor lists:
//
//   DCMCellSurgery surgery(lmp, STYLE);
//   const auto old = surgery.gather(molecules);    // all ranks see the same cells
//   surgery.begin();
//   surgery.remove(molecules);
//   surgery.insert(...)                            // same calls on all ranks
//   surgery.end();                                 // counts, atom map
//
// Tags of removed cells are used again, the lowest first, so that they do not run away.

class DCMCellSurgery : protected Pointers {
 public:
  // a cell as it stands, the same on all ranks; deformable: radius is 0, else the mesh is empty

  struct Cell {
    tagint molecule = 0;
    DCMCellBuilder::Masks masks;    // groups of the center or sphere, of all nodes, of all faces
    DCMCellBuilder::Types types;
    dcm::Mesh mesh;             // unwrapped, nodes and faces by tag
    std::vector<double> l0;     // per edge of dcm::edges(mesh)
    std::vector<int> region;    // per face
    double volume0 = 0.0;
    double radius = 0.0;
    dcm::Vec3 x = dcm::Vec3::Zero();    // mean node or center, unwrapped
    dcm::Vec3 v = dcm::Vec3::Zero();    // mean velocity

    // of a deformable cell whose atoms stay: as in the mesh

    std::vector<tagint> node_tag, face_tag;
    std::vector<int> node_mask, face_mask;
    std::vector<dcm::Vec3> node_v;
    std::vector<double> theta0;    // per edge, too; UNSET_THETA0: there is no dihedral on it
    std::vector<int> keeper;       // per edge: 0 or 1, the end that stores its bond
  };

  DCMCellSurgery(class LAMMPS *, const std::string &asking);

  // groups of the atoms of a cell that takes another form: its own; those that all atoms of the
  // new type are in; for nodes and faces not those that all atoms of its old type are in
  DCMCellBuilder::Masks masks_after(const DCMCellBuilder::Types &to, const Cell &cell) const;

  // molecules: sorted; the result has the same order. Error if one of them does not exist.
  std::vector<Cell> gather(const std::vector<tagint> &molecules) const;

  void begin();
  void remove(const std::vector<tagint> &molecules);
  void insert(const DCMCellBuilder::Types &, const DCMCellBuilder::Topology &,
              DCMCellBuilder::Deformable);
  void insert(const DCMCellBuilder::Types &, DCMCellBuilder::Sphere);
  void insert(int type, int mask, tagint home, const std::vector<dcm::Vec3> &tracers);
  void remove_tracers(const std::vector<char> &doomed);    // per atom of this rank
  void end();

  DCMCellBuilder builder;

  // error unless the deck has the laws that hold a deformable cell together
  static void require_laws(class LAMMPS *, const std::string &asking);

  // error unless fixes that keep local indices over an exchange have acted before this one
  static void check_order(class LAMMPS *, const class Fix *, const std::string &asking);

 private:
  std::string asking;
  struct DCMAtoms *dcm;
  int nbefore = 0;                   // local atoms that stay
  bigint expected[3] = {0, 0, 0};    // atoms, bonds, dihedrals, summed over ranks

  struct Range {
    tagint first, last;
  };
  std::vector<Range> used;    // tags of all ranks, sorted, once needed
  bool have_used = false;

  void find_used();
  static void join(std::vector<Range> &);
  tagint free_tags(tagint);
  void count(bigint *) const;
};

}    // namespace LAMMPS_NS

#endif
