/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_UNKNOWNS_H
#define LMP_DCM_UNKNOWNS_H

#include "law/friction_comm.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

// The numbering of the unknowns of fix dcm/motion, which those who add friction or stiffness use:
// a slot for every node and sphere that moves, slot 0 for all that does not. Owned unknowns come
// first; a ghost gets a slot, and its owner a request, when it is first asked for.

class DCMUnknowns : protected Pointers {
 public:
  static constexpr int FIXED = 0;    // slot of everything that does not move

  DCMUnknowns(class LAMMPS *, dcm::FrictionSystem &, dcm::FrictionComm &);

  // slot of an atom, owned or ghost

  int operator()(int i) { return slots[i] == NOT_ASKED ? ask(i) : slots[i]; }

  int atom_of(int slot) const { return atoms[slot]; }    // local index; owned slots only
  int nowned() const { return (int) atoms.size() - 1; }

  // owned slots of the nodes of a cell, ascending; row: of the table of cells

  struct Nodes {
    const int *first, *last;
    const int *begin() const { return first; }
    const int *end() const { return last; }
  };
  Nodes nodes_of(int row)
  {
    if (first_node.empty()) sort_nodes();
    return {nodes.data() + first_node[row], nodes.data() + first_node[row + 1]};
  }

  // ---- for fix dcm/motion alone

  bool moves(int i, int groupbit) const;

  // begin anew after a rebuild; owner: process of every owned and ghost atom, empty if there is one
  // process only. Collective
  void number(int groupbit, const std::vector<double> &owner);
  void send_requests();    // collective, when all have asked
  double memory_usage() const;

 private:
  static constexpr int NOT_ASKED = -1;    // a ghost no block has touched so far

  dcm::FrictionSystem &system;
  dcm::FrictionComm &messages;
  struct DCMAtoms *dcm;
  std::vector<int> slots;          // per owned + ghost atom
  std::vector<int> atoms;          // per owned slot
  std::vector<double> owner_of;    // per owned + ghost atom
  std::vector<int> first_node;     // per row of the table, and the end; empty: nobody has asked
  std::vector<int> nodes;          // slots, those of one cell next to each other

  int ask(int i);
  void sort_nodes();
};

}    // namespace LAMMPS_NS

#endif
