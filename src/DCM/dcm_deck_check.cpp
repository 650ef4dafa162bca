/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_deck_check.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>

using namespace LAMMPS_NS;

static const char *const KINDS[] = {"none", "sphere", "center", "node", "face", "tracer"};
static constexpr int NKIND = AtomVecDCM::TRACER + 1;

static void check_neighbor(LAMMPS *lmp, const std::string &asking)
{
  const Neighbor *const neighbor = lmp->neighbor;
  if (neighbor->build_once)
    lmp->error->all(FLERR,
                    "{}: cells would move out of a neighbor list that is built once; remove "
                    "'neigh_modify once yes'",
                    asking);
  if (neighbor->delay > 1 || neighbor->every > 1)
    lmp->error->all(
        FLERR,
        "{}: with neigh_modify delay {} every {} the neighbor list may be older than the "
        "cells have moved, and contacts be missed without a word; use 'neigh_modify delay 0 "
        "every 1 check yes', which rebuilds it when it has to be",
        asking, neighbor->delay, neighbor->every);
  if (neighbor->includegroup)
    lmp->error->all(FLERR,
                    "{}: neigh_modify include {} would leave contacts of other cells out; remove "
                    "'include' from neigh_modify",
                    asking, lmp->group->names[neighbor->includegroup]);
  for (int n = 0; n < neighbor->nex_mol; n++)
    if (neighbor->ex_mol_group[n] == 0 && !neighbor->ex_mol_intra[n])
      lmp->error->all(
          FLERR,
          "{}: neigh_modify exclude molecule/inter all would leave out every contact of "
          "two cells; remove it ('neigh_modify exclude none')",
          asking);
}

void LAMMPS_NS::dcm_warn_excluded(LAMMPS *lmp, const std::string &asking)
{
  const Neighbor *const neighbor = lmp->neighbor;
  if (lmp->comm->me) return;
  std::vector<std::string> settings;
  for (int n = 0; n < neighbor->nex_group; n++)
    settings.push_back(fmt::format("group {} {}", lmp->group->names[neighbor->ex1_group[n]],
                                   lmp->group->names[neighbor->ex2_group[n]]));
  for (int n = 0; n < neighbor->nex_mol; n++)
    if (neighbor->ex_mol_group[n] != 0 && !neighbor->ex_mol_intra[n])
      settings.push_back(
          fmt::format("molecule/inter {}", lmp->group->names[neighbor->ex_mol_group[n]]));
  for (const auto &setting : settings)
    lmp->error->warning(
        FLERR,
        "{}: with neigh_modify exclude {} these cells do not touch each other: they have no "
        "contact, adhesion or friction and pass through each other. Right for bodies that stay "
        "apart; otherwise 'neigh_modify exclude none'",
        asking, setting);
}

static void check_kinds(LAMMPS *lmp, const std::string &asking)
{
  const Atom *const atom = lmp->atom;
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, asking);
  tagint none = MAXTAGINT;    // the lowest, so that all ranks say the same
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] < AtomVecDCM::SPHERE || dcm->kind[i] > AtomVecDCM::TRACER)
      none = std::min(none, atom->tag[i]);
  MPI_Allreduce(MPI_IN_PLACE, &none, 1, MPI_LMP_TAGINT, MPI_MIN, lmp->world);
  if (none < MAXTAGINT)
    lmp->error->all(FLERR,
                    "{}: atom {} has kind 0: it was made by create_atoms or another command that "
                    "does not know cells, and would neither move nor touch anything; make cells "
                    "with create_cells",
                    asking, none);
}

void LAMMPS_NS::dcm_check_deck(LAMMPS *lmp, const std::string &asking)
{
  if (lmp->domain->dimension != 3)
    lmp->error->all(FLERR, "{}: cells are bodies in space; dimension is {}, must be 3", asking,
                    lmp->domain->dimension);
  check_neighbor(lmp, asking);
  check_kinds(lmp, asking);
}

void LAMMPS_NS::dcm_check_group(LAMMPS *lmp, const std::string &asking, int igroup,
                                const std::vector<AtomVecDCM::Kind> &kinds)
{
  const Atom *const atom = lmp->atom;
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, asking);
  const int bit = lmp->group->bitmask[igroup];
  bigint held[NKIND] = {0};
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & bit) && dcm->kind[i] > 0 && dcm->kind[i] < NKIND) held[dcm->kind[i]]++;
  MPI_Allreduce(MPI_IN_PLACE, held, NKIND, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
  std::vector<std::string> wanted;
  for (const auto kind : kinds) {
    if (held[kind]) return;
    wanted.push_back(KINDS[kind]);
  }
  const bigint others = held[AtomVecDCM::CENTER] + held[AtomVecDCM::NODE] + held[AtomVecDCM::FACE];
  if (others == 0) return;    // its cells may come later
  lmp->error->all(FLERR,
                  "{}: group {} holds {} atoms of deformable cells, but no {}, which it acts on: "
                  "nothing would happen. Add their atom types to the group, or name whole cells "
                  "('group {} molecule ...')",
                  asking, lmp->group->names[igroup], others, utils::join_words(wanted, " or "),
                  lmp->group->names[igroup]);
}
