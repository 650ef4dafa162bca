/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CELL_CHANGE_H
#define LMP_DCM_CELL_CHANGE_H

#include "dcm_cell_surgery.h"
#include "law/remesh.h"

#include <vector>

namespace LAMMPS_NS {

// Other places and other neighbors for the nodes of cells that stay, in pre_exchange of a step that
// rebuilds the neighbor lists. Atoms keep their IDs, groups and all that other styles store with
// them; positions, velocities, vertices and regions, bonds and dihedrals are written anew. All
// ranks make the same calls.

class DCMCellChange : protected Pointers {
 public:
  DCMCellChange(class LAMMPS *, const std::string &asking);

  // before: as gathered; after: of the same numbers of nodes and faces
  void add(const DCMCellSurgery::Cell &before, const dcm::Remeshed &after);

  // write, and send atoms to the ranks they now belong to
  void apply();

 private:
  std::string asking;
  struct DCMAtoms *dcm;

  struct Change {
    DCMCellSurgery::Cell before;
    dcm::Remeshed after;
    std::vector<std::array<int, 4>> hinges;
    std::vector<std::vector<int>> stored;    // per node: the edges it stores
  };
  std::vector<Change> changes;

  void share_edges(Change &) const;
  void write_node(int i, const Change &, int node);
  void write_face(int i, const Change &, int face);
  void place(int i, const dcm::Vec3 &);
};

}    // namespace LAMMPS_NS

#endif
