/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_RETYPE_H
#define LMP_DCM_RETYPE_H

#include "dcm_cell_builder.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Other types and groups for whole deformable cells, whose center, nodes and faces have types of
// their own: what a deck or style asks for, its checks, and the change itself.
//
//   in the constructor:  to.parse(args) at keywords to, join, leave
//   in init():           to.init()
//   then either          to.look(), and to.daughters(types, masks) for cells yet to be made
//   or, between runs:    to.change(cell, molecules)

class DCMRetype : protected Pointers {
 public:
  DCMRetype(class LAMMPS *, const std::string &asking);

  // keywords that parse() knows: to Tcenter Tnode Tface [Tbond Tdihedral], join GROUP, leave GROUP
  static const std::vector<std::string> KEYWORDS, REPEATABLE;
  bool parse(class DCMArgs &);    // false: the keyword is another one
  void join_group(const std::string &id) { joins.push_back(id); }

  // looks up the groups; error unless the types hold, or will hold, atoms of their kind alone
  void init();

  const DCMCellBuilder::Types &types() const { return to; }

  // find the groups that all atoms of the new types are in; collective
  void look();

  // types and groups of a cell afterwards, from those before; groups: its own, those of look(),
  // those it joins, without those it leaves
  void apply(DCMCellBuilder::Types &, DCMCellBuilder::Masks &) const;

  // change cells and tell everybody; all processes, between runs. molecules: sorted
  void change(class FixDCMCell *, const std::vector<tagint> &molecules);

 private:
  std::string asking;
  DCMCellBuilder::Types to;
  std::vector<std::string> joins, leaves;
  int join = 0, leave = 0;      // group bits
  int common[3] = {0, 0, 0};    // of all centers, nodes, faces of the new types

  int mask_after(int mask, int kind) const { return ((mask | common[kind] | join) & ~leave) | 1; }
  int find_static(const std::string &id) const;
};

// fix_modify ID retype to Tcenter Tnode Tface [Tbond Tdihedral] molecule M | group GROUP
//            [join GROUP] [leave GROUP]

void dcm_retype_cells(class LAMMPS *, class FixDCMCell *, int narg, char **arg);

}    // namespace LAMMPS_NS

#endif
