/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Do bonds and dihedrals of deformable cells fit their faces? Every edge of a surface is one bond
// of the cortex and one dihedral, which bends it.

#include "fix_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "bond_dcm_cortex.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_slots.h"
#include "dihedral_dcm_bend.h"
#include "error.h"
#include "force.h"

#include <algorithm>
#include <array>
#include <set>
#include <tuple>

using namespace LAMMPS_NS;

namespace {

// an edge, lower ID first, and beside it the third vertex of one of its faces; 0: the edge alone

struct Side {
  tagint a, b, beside;
  Side(tagint p, tagint q, tagint r = 0) : a(std::min(p, q)), b(std::max(p, q)), beside(r) {}
  Side() : a(0), b(0), beside(0) {}
  uint64_t hash() const
  {
    return dcm_mix(dcm_mix(dcm_mix((uint64_t) a) ^ (uint64_t) b) ^ (uint64_t) beside);
  }
  bool operator<(const Side &other) const
  {
    return std::tie(a, b, beside) < std::tie(other.a, other.b, other.beside);
  }
};

}    // namespace

// of a bond or dihedral style, or a part of a hybrid one: the types it has coefficients for

template <class Style> static bool has_type(const Style *style, int type)
{
  return style && type > 0 && style->setflag[type];
}

/* ----------------------------------------------------------------------
   bonds and dihedrals of a node are not those that its rest lengths and angles were stored with:
   what was added at the end of its lists begins anew if it is of another style, as the part of a
   hybrid one; all else was moved to another slot, or is no edge
------------------------------------------------------------------------- */

bool FixDCMCell::adopt_bonds(int i)
{
  const auto *const cortex = dynamic_cast<BondDCMCortex *>(force->bond_match("dcm/cortex"));
  const auto *const bend = dynamic_cast<DihedralDCMBend *>(force->dihedral_match("dcm/bend"));
  const int nbonds = atom->num_bond[i], ndihedrals = atom->num_dihedral[i];
  for (int p = nbonds; p >= 0; p--)
    for (int q = ndihedrals; q >= 0; q--) {
      if (AtomVecDCM::stamp(atom, i, p, q) != dcm->bonded[i]) continue;
      bool own = false;
      for (int m = p; m < nbonds; m++) own = own || has_type(cortex, atom->bond_type[i][m]);
      for (int m = q; m < ndihedrals; m++) own = own || has_type(bend, atom->dihedral_type[i][m]);
      if (own) continue;
      for (int m = p; m < nbonds; m++) dcm->l0[i][m] = AtomVecDCM::UNSET_L0;
      for (int m = q; m < ndihedrals; m++) dcm->theta0[i][m] = AtomVecDCM::UNSET_THETA0;
      dcm->bonded[i] = AtomVecDCM::stamp(atom, i);
      return true;
    }
  return false;
}

/* ----------------------------------------------------------------------
   at the start of every run. Sums of hashes tell whether the two sets are the same, with one
   message for all cells and without a look at ghosts; which entry is wrong is found out for the
   first cell where they are not.
------------------------------------------------------------------------- */

void FixDCMCell::check_topology()
{
  const auto *const cortex = dynamic_cast<BondDCMCortex *>(force->bond_match("dcm/cortex"));
  const auto *const bend = dynamic_cast<DihedralDCMBend *>(force->dihedral_match("dcm/bend"));
  if (!cortex && !bend) return;

  auto each_face = [this](auto &&use) {
    for (int f = 0; f < nowned_faces; f++) {
      const Face &face = face_list[f];
      for (int k = 0; k < 3; k++)
        use(face.cell, atom->tag[face.v[k]], atom->tag[face.v[(k + 1) % 3]],
            atom->tag[face.v[(k + 2) % 3]]);
    }
  };
  auto each_bond = [this, cortex](auto &&use) {
    for (int i = 0; i < atom->nlocal; i++)
      for (int m = 0; m < atom->num_bond[i]; m++)
        if (has_type(cortex, atom->bond_type[i][m])) use(i, atom->tag[i], atom->bond_atom[i][m]);
  };
  auto each_hinge = [this, bend](auto &&use) {
    for (int i = 0; i < atom->nlocal; i++)
      for (int m = 0; m < atom->num_dihedral[i]; m++)
        if (has_type(bend, atom->dihedral_type[i][m]))
          use(i, atom->dihedral_atom1[i][m], atom->dihedral_atom2[i][m], atom->dihedral_atom3[i][m],
              atom->dihedral_atom4[i][m]);
  };

  tagint stray = 0;
  auto of_node = [this, &stray](int i) {
    if (dcm->kind[i] != AtomVecDCM::NODE) stray = std::max(stray, atom->tag[i]);
    return dcm->kind[i] == AtomVecDCM::NODE;
  };

  // both faces of an edge count it, so does its bond twice; the sums wrap around

  std::vector<uint64_t> open(2 * table.size(), 0);
  if (cortex) {
    each_face([&open](int c, tagint a, tagint b, tagint) {
      open[2 * c] += Side(a, b).hash();
    });
    each_bond([&](int i, tagint a, tagint b) {
      if (of_node(i)) open[2 * cell_of_atom[i]] -= 2 * Side(a, b).hash();
    });
  }
  if (bend) {
    each_face([&open](int c, tagint a, tagint b, tagint r) {
      open[2 * c + 1] += Side(a, b, r).hash();
    });
    each_hinge([&](int i, tagint a, tagint b, tagint c, tagint d) {
      if (of_node(i)) open[2 * cell_of_atom[i] + 1] -= Side(b, c, a).hash() + Side(b, c, d).hash();
    });
  }
  MPI_Allreduce(MPI_IN_PLACE, &stray, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (stray)
    error->all(FLERR,
               "Fix dcm/cell: atom {} has a bond or dihedral but is no node; only nodes of a cell "
               "are joined, along the edges of its faces",
               stray);
  if (!open.empty())
    MPI_Allreduce(MPI_IN_PLACE, open.data(), (int) open.size(), MPI_UINT64_T, MPI_SUM, world);
  const auto wrong = std::find_if(open.begin(), open.end(), [](uint64_t rest) {
    return rest != 0;
  });
  if (wrong == open.end()) return;
  const int cell = (int) (wrong - open.begin()) / 2;
  const bool bonds = (wrong - open.begin()) % 2 == 0;

  // the sides that faces have and those that bonds or dihedrals have, each in order

  std::vector<Side> have, mine;
  std::vector<tagint> nodes;
  each_face([&](int c, tagint a, tagint b, tagint r) {
    if (c != cell) return;
    nodes.push_back(a);
    if (!bonds)
      have.emplace_back(a, b, r);
    else if (a < b)
      have.emplace_back(a, b);
  });
  each_bond([&](int i, tagint a, tagint b) {
    if (bonds && cell_of_atom[i] == cell) mine.emplace_back(a, b);
  });
  each_hinge([&](int i, tagint a, tagint b, tagint c, tagint d) {
    if (bonds || cell_of_atom[i] != cell) return;
    mine.emplace_back(b, c, a);
    mine.emplace_back(b, c, d);
  });
  have = dcm_allgather(have, world);
  mine = dcm_allgather(mine, world);
  nodes = dcm_allgather(nodes, world);
  std::sort(have.begin(), have.end());
  std::sort(mine.begin(), mine.end());
  std::vector<Side> missing, extra;
  std::set_difference(have.begin(), have.end(), mine.begin(), mine.end(),
                      std::back_inserter(missing));
  std::set_difference(mine.begin(), mine.end(), have.begin(), have.end(),
                      std::back_inserter(extra));

  const std::string what = bonds ? "bond" : "dihedral", plural = what + "s";
  const tagint molecule = table[cell].molecule;
  const size_t nedges = have.size() / (bonds ? 1 : 2), nthere = mine.size() / (bonds ? 1 : 2);
  std::string fault;
  if (!extra.empty()) {
    const Side &it = extra.front();
    const bool doubled = std::binary_search(have.begin(), have.end(), it);
    const bool edge = std::any_of(have.begin(), have.end(), [&it](const Side &side) {
      return side.a == it.a && side.b == it.b;
    });
    auto foreign = [&nodes](tagint tag) {
      return tag && std::find(nodes.begin(), nodes.end(), tag) == nodes.end();
    };
    tagint other = 0;
    for (const tagint tag : {it.a, it.b, it.beside})
      if (foreign(tag)) other = tag;
    if (doubled)
      fault = fmt::format("edge {}-{} has more than one {}", it.a, it.b, what);
    else if (other)
      fault = fmt::format("a {} at {}-{} joins it to atom {}, which is no node of this cell", what,
                          it.a, it.b, other);
    else if (!edge)
      fault = fmt::format("a {} joins nodes {} and {}, between which there is no edge", what, it.a,
                          it.b);
    else
      fault =
          fmt::format("the dihedral at edge {}-{} reaches to node {}, which is no vertex of its "
                      "two faces",
                      it.a, it.b, it.beside);
  } else {
    fault = fmt::format("edge {}-{} has no {}", missing.front().a, missing.front().b, what);
  }
  error->all(FLERR,
             "Fix dcm/cell: the {} of cell {} do not fit its faces: {} ({} edges, {} {}). Every "
             "edge of a face is one bond of style dcm/cortex and one dihedral of style dcm/bend; "
             "correct the data file. Bonds of cells cannot be edited, as by delete_bonds and "
             "create_bonds; others need a bond style of their own (bond_style hybrid)",
             plural, molecule, fault, nedges, nthere, plural);
}
