/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_retype.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_args.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "group.h"

#include <algorithm>

using namespace LAMMPS_NS;

const std::vector<std::string> DCMRetype::KEYWORDS = {"to", "join", "leave"};
const std::vector<std::string> DCMRetype::REPEATABLE = {"join", "leave"};

// kinds of atoms of a cell, in the order of its types and masks

static constexpr int NKIND = 3;
static constexpr AtomVecDCM::Kind KINDS[NKIND] = {AtomVecDCM::CENTER, AtomVecDCM::NODE,
                                                  AtomVecDCM::FACE};

static int place_of(int kind)
{
  return (int) (std::find(KINDS, KINDS + NKIND, kind) - KINDS);
}

DCMRetype::DCMRetype(LAMMPS *lmp, const std::string &_asking) : Pointers(lmp), asking(_asking) {}

bool DCMRetype::parse(DCMArgs &args)
{
  if (args.is("join")) {
    joins.emplace_back(args.text());
  } else if (args.is("leave")) {
    leaves.emplace_back(args.text());
  } else if (args.is("to")) {
    args.need(3);
    to.center = args.type(atom->ntypes);
    to.node = args.type(atom->ntypes);
    to.face = args.type(atom->ntypes);
    if (!args.keyword_ahead()) {
      to.bond = args.type(atom->nbondtypes);
      to.dihedral = args.type(atom->ndihedraltypes);
    }
  } else {
    return false;
  }
  return true;
}

/* ---------------------------------------------------------------------- */

int DCMRetype::find_static(const std::string &id) const
{
  const int bit = dcm_find_group(lmp, asking, id);
  const int n = group->find(id);
  if (n == 0)
    error->all(FLERR, "{}: every atom is in group all; name another group to join or leave",
               asking);
  if (group->dynamic[n])
    error->all(FLERR,
               "{}: group {} is dynamic, so that cells would not stay in it or out of it; use a "
               "static group",
               asking, id);
  return bit;
}

void DCMRetype::init()
{
  if (to.center == 0)
    error->all(FLERR, "{}: keyword to is missing; give the atom types: to Tcenter Tnode Tface",
               asking);
  join = leave = 0;
  for (const auto &id : joins) join |= find_static(id);
  for (const auto &id : leaves) leave |= find_static(id);
  if (join & leave)
    error->all(FLERR, "{}: cells cannot join and leave the same group; drop one of the two",
               asking);

  static const char *const names[] = {"nothing", "spheres", "centers", "nodes", "faces", "tracers"};
  const int types[NKIND] = {to.center, to.node, to.face};
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, asking);
  int seen[NKIND] = {0, 0, 0};
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < NKIND; k++)
      if (atom->type[i] == types[k]) seen[k] |= 1 << dcm->kind[i];
  MPI_Allreduce(MPI_IN_PLACE, seen, NKIND, MPI_INT, MPI_BOR, world);
  for (int k = 0; k < NKIND; k++) {
    for (int other = 0; other < k; other++)
      if (types[k] == types[other])
        error->all(FLERR,
                   "{}: atom type {} is to be the type of {} and of {}; each kind of atom needs a "
                   "type of its own",
                   asking, types[k], names[KINDS[other]], names[KINDS[k]]);
    for (int kind = AtomVecDCM::SPHERE; kind <= AtomVecDCM::TRACER; kind++)
      if (kind != KINDS[k] && (seen[k] & (1 << kind)))
        error->all(FLERR,
                   "{}: atom type {} is to be the type of {} but holds {}; give a type that holds "
                   "{} or no atoms",
                   asking, types[k], names[KINDS[k]], names[kind], names[KINDS[k]]);
  }
}

void DCMRetype::look()
{
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, asking);
  const int types[NKIND] = {to.center, to.node, to.face};
  std::fill_n(common, NKIND, ~0);
  for (int i = 0; i < atom->nlocal; i++) {
    const int k = place_of(dcm->kind[i]);
    if (k < NKIND && atom->type[i] == types[k]) common[k] &= atom->mask[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, common, NKIND, MPI_INT, MPI_BAND, world);
  for (int &mask : common)
    if (mask == ~0) mask = 0;    // no atoms of the type yet
}

void DCMRetype::apply(DCMCellBuilder::Types &types, DCMCellBuilder::Masks &masks) const
{
  types.center = to.center;
  types.node = to.node;
  types.face = to.face;
  if (to.bond) types.bond = to.bond;
  if (to.dihedral) types.dihedral = to.dihedral;
  masks.center = mask_after(masks.center, 0);
  masks.node = mask_after(masks.node, 1);
  masks.face = mask_after(masks.face, 2);
}

/* ----------------------------------------------------------------------
   the lists, parameters and exclusions of types follow at the start of the next run
------------------------------------------------------------------------- */

void DCMRetype::change(FixDCMCell *cell, const std::vector<tagint> &molecules)
{
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, asking);
  const int types[NKIND] = {to.center, to.node, to.face};
  cell->refresh();
  look();
  for (int i = 0; i < atom->nlocal; i++) {
    const int k = place_of(dcm->kind[i]);
    if (k == NKIND || !std::binary_search(molecules.begin(), molecules.end(), atom->molecule[i]))
      continue;
    atom->type[i] = types[k];
    atom->mask[i] = mask_after(atom->mask[i], k);
    if (to.bond) std::fill_n(atom->bond_type[i], atom->num_bond[i], to.bond);
    if (to.dihedral) std::fill_n(atom->dihedral_type[i], atom->num_dihedral[i], to.dihedral);
  }
  auto &table = cell->change_cells();
  for (const tagint molecule : molecules) {
    const int row = table.find(molecule);
    table.retyped(molecule, to.center, mask_after(table[row].mask, 0));
  }
}

/* ---------------------------------------------------------------------- */

void LAMMPS_NS::dcm_retype_cells(LAMMPS *lmp, FixDCMCell *cell, int narg, char **arg)
{
  static const char STYLE[] = "Fix_modify retype";
  DCMRetype to(lmp, STYLE);
  DCMArgs args(lmp, STYLE, narg, arg, {"molecule", "group"});
  args.add_keywords(DCMRetype::KEYWORDS);
  args.may_repeat({"molecule", "group"});
  args.may_repeat(DCMRetype::REPEATABLE);
  std::vector<tagint> molecules;
  std::vector<std::string> groups;
  while (args.next()) {
    if (args.is("molecule"))
      molecules.push_back((tagint) args.whole());
    else if (args.is("group"))
      groups.emplace_back(args.text());
    else
      to.parse(args);
  }
  if (molecules.empty() && groups.empty())
    lmp->error->all(FLERR, "{}: name the cells: molecule M or group GROUP", STYLE);
  to.init();

  int bits = 0;
  for (const auto &id : groups) bits |= dcm_find_group(lmp, STYLE, id);
  cell->refresh();
  const auto &table = cell->cells();
  table.require_ids(STYLE);
  for (const tagint molecule : molecules) {
    const int row = table.find(molecule);
    if (row < 0 || !table[row].deformable)
      lmp->error->all(FLERR, "{}: there is no deformable cell {}", STYLE, molecule);
  }
  for (const int row : table.all_deformable())
    if (table[row].mask & bits) molecules.push_back(table[row].molecule);
  if (molecules.empty())
    lmp->error->all(FLERR, "{}: no center of a deformable cell is in group {}", STYLE, groups[0]);
  std::sort(molecules.begin(), molecules.end());
  molecules.erase(std::unique(molecules.begin(), molecules.end()), molecules.end());
  to.change(cell, molecules);
}
