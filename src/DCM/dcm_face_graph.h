/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_FACE_GRAPH_H
#define LMP_DCM_FACE_GRAPH_H

#include "law/flood.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Which faces are linked by the space in front of them (law/flood.h), over all processes: each
// finds the links of its own faces, all of them get all faces and links, and find the same sets of
// faces by atom IDs, so that nothing depends on the number of processes.
//
//   DCMFaceGraph graph(lmp, STYLE);
//   graph.collect(range);                       // in every look, before opposite() and build()
//   state[face atom] = NODE | ...               // owned faces; ghosts by forward communication
//   graph.build(state);                         // collective
//   for (const auto &face : graph.faces()) ...  // the same on all processes

class DCMFaceGraph : protected Pointers {
 public:
  enum State : int {
    NODE = 1,      // stands in the graph
    SHUT = 2,      // in contact: nothing gets through the slit in front of it
    SOURCE = 4,    // the rest only goes along
    BEFORE = 8
  };

  struct Face {
    tagint tag, molecule;
    double area;
    double mid[3];
    int state;
    int set;    // of linked faces: 0, 1, ... in the order of their lowest tags
  };

  DCMFaceGraph(class LAMMPS *, const std::string &asking);

  // from init(), in every run
  void init();

  // error unless the ghosts reach as far as links and what may cut them do
  void check_cutoff(double range) const;

  // faces of this process with all vertices; range: 0: RANGE mean edges
  void collect(double range);
  static constexpr double RANGE = 1.2;

  // face atom in front of a face atom and opposite, of another cell, -1: none
  int opposite(int i) const;

  // state: per atom, owned and ghost; links: are sets wanted? else each face is one
  void build(const std::vector<int> &state, bool links = true);

  // no faces; where there are none this is instead of collect() and build()
  void clear()
  {
    all.clear();
    number = 0;
  }

  const std::vector<Face> &faces() const { return all; }    // sorted by tag
  int nsets() const { return number; }
  const Face *find(tagint tag) const;

  double memory_usage() const;

 private:
  std::string asking;
  class FixDCMCell *cell;
  class PairDCMContact *contact;
  dcm::FloodSpace space;
  std::vector<int> index, atom_of;    // of face atoms among the faces of space, and back
  std::vector<dcm::FloodSpace::Link> links;
  std::vector<Face> all;
  int number = 0;

  int place_of(tagint) const;
};

}    // namespace LAMMPS_NS

#endif
