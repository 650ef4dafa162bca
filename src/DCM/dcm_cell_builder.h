/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CELL_BUILDER_H
#define LMP_DCM_CELL_BUILDER_H

#include "law/mesh.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Makes the atoms, bonds and dihedrals of whole cells, before a run (create_cells) and in one
// (dcm_cell_surgery.h). Every rank makes the same calls and keeps the atoms that are its own, so
// that the result does not depend on the number of ranks.

class DCMCellBuilder : protected Pointers {
 public:
  // atom, bond and dihedral types of a deformable cell; a center-based one uses center only

  struct Types {
    int center = 0, node = 0, face = 0, bond = 0, dihedral = 0;
  };

  // groups of the atoms of a cell; a center-based one uses center only

  struct Masks {
    int center = 1, node = 1, face = 1;
  };

  // a closed mesh and how its edges are shared out among the nodes that store them

  struct Topology {
    dcm::Mesh mesh;                            // round shape, mean position 0, volume or
                                               // mean radius that of the unit sphere
    std::vector<std::array<int, 4>> hinges;    // one per edge
    std::vector<int> owner;                    // per hinge: 1 or 2, the end that stores it
    int slots = 0;                             // most edges stored at one node
    bool equal_volume = true;
    dcm::Vec3 mid = dcm::Vec3::Zero();    // mean position and size of the mesh as it was given
    double scale = 1.0;

    // tags a cell takes: center, nodes, faces in mesh order
    tagint size() const { return 1 + (tagint) (mesh.nodes.size() + mesh.faces.size()); }
  };

  // what is special to one deformable cell

  struct Deformable {
    tagint molecule = 0, tag = 0;    // tag: of the center; nodes and faces follow
    Masks mask;
    double volume0 = 0.0;    // rest volume
    double v[3] = {0.0, 0.0, 0.0};
    std::vector<dcm::Vec3> x;          // node positions, unwrapped
    std::vector<double> l0, theta0;    // rest length and angle per hinge
    std::vector<int> region;           // per face; empty: lateral
  };

  struct Sphere {
    tagint molecule = 0, tag = 0;
    int mask = 1;
    double radius = 0.0;
    double v[3] = {0.0, 0.0, 0.0};
    dcm::Vec3 x;
  };

  struct Tracer {                // belongs to no molecule, so that it is no atom of a cell
    tagint tag = 0, home = 0;    // home: molecule of the cell it is in, 0: outside
    int mask = 1;
    dcm::Vec3 x;
  };

  // asking: the command or style, for messages; strict: atoms outside the box do not count (they
  // are an error of the caller's); else they belong to the nearest rank until the box follows
  DCMCellBuilder(class LAMMPS *, const std::string &asking, bool strict);

  // center and scale the mesh, find its hinges; error on a mesh that cannot be a cell's surface
  Topology prepare(dcm::Mesh mesh, bool equal_volume) const;

  // rest lengths and angles of a round cell of rest volume cell.volume0; rest: factor on lengths
  static void set_round_rest(const Topology &, double rest, Deformable &cell);

  // bond and dihedral slots for `slots` edges per node; made here as long as no atoms exist
  void reserve_slots(int slots);

  void create(const Types &, const Topology &, const Deformable &);
  void create(const Types &, const Sphere &);
  void create(int type, const Tracer &);

 private:
  std::string asking;
  bool strict;
  struct DCMAtoms *dcm;

  int create_atom(const double *x, int type, int kind, tagint tag, tagint molecule, int mask,
                  const double *v);
  void clear_extra(int i);
};

}    // namespace LAMMPS_NS

#endif
