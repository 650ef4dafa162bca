/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "bond_dcm_cortex.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_compat.h"
#include "law/cortex.h"
#include "law/stiffness.h"
#include "law/symmetric.h"
#include "dcm_unknowns.h"
#include "domain.h"
#include "fix_dcm_cell.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static const char STYLE[] = "Bond style dcm/cortex";

/* ---------------------------------------------------------------------- */

BondDCMCortex::BondDCMCortex(LAMMPS *lmp) :
    Bond(lmp), coefs(lmp, STYLE), dcm(nullptr), slots(lmp, STYLE, "bonds")
{
}

/* ---------------------------------------------------------------------- */

BondDCMCortex::~BondDCMCortex()
{
  if (allocated && !copymode) memory->destroy(setflag);
}

/* ----------------------------------------------------------------------
   tension k_s (l - l0) along each edge
------------------------------------------------------------------------- */

void BondDCMCortex::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  if (slots.stale(neighbor->nbondlist)) match_slots();

  double **x = atom->x;
  double **f = atom->f;
  double **l0 = dcm->l0;
  int **bondlist = neighbor->bondlist;
  const int nbondlist = neighbor->nbondlist;
  const int nlocal = atom->nlocal;

  for (int n = 0; n < nbondlist; n++) {
    const int i = bondlist[n][0];
    const int j = bondlist[n][1];
    const double ks = coefs[bondlist[n][2]].ks;
    const double rest = l0[i][slots[n]];
    const dcm::Vec3 rij = dcm::vec(x[j]) - dcm::vec(x[i]);
    const dcm::Vec3 fj = dcm::cortex_force(ks, rest, rij);

    // newton_bond is on, so ghosts take their share as well

    dcm::vec(f[i]) -= fj;
    dcm::vec(f[j]) += fj;

    if (evflag) {
      const double ebond = eflag ? dcm::cortex_energy(ks, rij.norm(), rest) : 0.0;
      ev_tally_xyz(i, j, nlocal, 1, ebond, fj[0], fj[1], fj[2], rij[0], rij[1], rij[2]);
    }
  }
}

/* ----------------------------------------------------------------------
   a bond that is new gets its length as rest length
------------------------------------------------------------------------- */

void BondDCMCortex::match_slots()
{
  double **x = atom->x, **l0 = dcm->l0;
  const DCMSlots::Stored stored = {0, 2, atom->num_bond, atom->bond_type, {{1, atom->bond_atom}}};
  slots.match(neighbor->bondlist, neighbor->nbondlist, stored, [=](const int *bond, int m) {
    const int i = bond[0], j = bond[1];
    if (l0[i][m] < 0.0) l0[i][m] = (dcm::vec(x[j]) - dcm::vec(x[i])).norm();
  });
}

/* ----------------------------------------------------------------------
   isotropic dashpots do not change until the next rebuild, projected ones turn with their edge
------------------------------------------------------------------------- */

void BondDCMCortex::list_friction(dcm::FrictionSystem &system, DCMUnknowns &unknowns)
{
  projected_edges.clear();
  int **bondlist = neighbor->bondlist;
  for (int n = 0; n < neighbor->nbondlist; n++) {
    const Coef &coef = coefs[bondlist[n][2]];
    if (coef.gamma == 0.0) continue;
    const int i = unknowns(bondlist[n][0]), j = unknowns(bondlist[n][1]);
    if (i == j) continue;    // both fixed
    if (coef.projected)
      projected_edges.push_back(n);
    else
      system.iso_edges.push_back({i, j, coef.gamma});
  }
}

void BondDCMCortex::add_friction(dcm::FrictionSystem &system, DCMUnknowns &unknowns)
{
  double **x = atom->x;
  int **bondlist = neighbor->bondlist;
  for (const int n : projected_edges) {
    const int i = bondlist[n][0], j = bondlist[n][1];
    const double dx = x[j][0] - x[i][0], dy = x[j][1] - x[i][1], dz = x[j][2] - x[i][2];
    const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (r == 0.0) continue;
    system.edges.push_back(
        {unknowns(i), unknowns(j), 0.0, coefs[bondlist[n][2]].gamma, {dx / r, dy / r, dz / r}});
  }
}

/* ----------------------------------------------------------------------
   springs, as their forces were last computed
------------------------------------------------------------------------- */

void BondDCMCortex::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  double **x = atom->x, **l0 = dcm->l0;
  int **bondlist = neighbor->bondlist;
  for (int n = 0; n < neighbor->nbondlist; n++) {
    const int i = bondlist[n][0], j = bondlist[n][1];
    dcm::EdgeBlock block = dcm::cortex_stiffness_block(coefs[bondlist[n][2]].ks, l0[i][slots[n]],
                                                       dcm::vec(x[j]) - dcm::vec(x[i]));
    block.i = unknowns(i);
    block.j = unknowns(j);
    if (block.i != block.j) system.edges.push_back(block);    // else both are fixed
  }
}

/* ---------------------------------------------------------------------- */

void BondDCMCortex::add_cell_virial(std::vector<double> &virial)
{
  const FixDCMCell *const cell = FixDCMCell::require(lmp, STYLE);
  int **bondlist = neighbor->bondlist;
  for (int n = 0; n < neighbor->nbondlist; n++) {
    const int i = bondlist[n][0], j = bondlist[n][1], row = cell->cell_of(i);
    if (row < 0) continue;
    const dcm::Vec3 rij = dcm::vec(atom->x[j]) - dcm::vec(atom->x[i]);
    const dcm::Vec3 force = dcm::cortex_force(coefs[bondlist[n][2]].ks, dcm->l0[i][slots[n]], rij);
    dcm::add_outer(&virial[6 * (size_t) row], force, rij);
  }
}

/* ----------------------------------------------------------------------
   the tension that a change of rest lengths takes away
------------------------------------------------------------------------- */

void BondDCMCortex::add_ahead(const std::vector<RestAhead> &ahead, std::vector<double> &forces,
                              DCMUnknowns &unknowns)
{
  const FixDCMCell *const cell = FixDCMCell::require(lmp, STYLE);
  double **x = atom->x, **l0 = dcm->l0;
  int **bondlist = neighbor->bondlist;
  for (int n = 0; n < neighbor->nbondlist; n++) {
    const int i = bondlist[n][0], j = bondlist[n][1];
    const int row = cell->cell_of(i);
    if (row < 0) continue;
    const double more = ahead[row].lengths() - 1.0;
    if (more == 0.0) continue;
    const dcm::Vec3 rij = dcm::vec(x[j]) - dcm::vec(x[i]);
    const double l = rij.norm();
    if (l == 0.0) continue;
    const dcm::Vec3 fj = (coefs[bondlist[n][2]].ks * l0[i][slots[n]] * more / l) * rij;
    dcm::vec(&forces[dcm::STRIDE * (size_t) unknowns(i)]) -= fj;
    dcm::vec(&forces[dcm::STRIDE * (size_t) unknowns(j)]) += fj;
  }
}

/* ---------------------------------------------------------------------- */

void BondDCMCortex::allocate()
{
  allocated = 1;
  const int np1 = atom->nbondtypes + 1;
  memory->create(setflag, np1, "bond:setflag");
  std::fill(setflag, setflag + np1, 0);
  coefs.allocate(atom->nbondtypes);
}

/* ----------------------------------------------------------------------
   bond_coeff N [FILE] CELLTYPE [E_cor v] [h_cor v] [gamma v] [stiffness area|young]
              [dashpot isotropic|projected]
------------------------------------------------------------------------- */

std::vector<DCMField> BondDCMCortex::Coef::fields()
{
  return {{"E_cor", E, DCMParameters::POSITIVE},
          {"h_cor", h, DCMParameters::POSITIVE},
          {"gamma", gamma, DCMParameters::NONNEGATIVE},
          {"stiffness", young, {"area", "young"}},
          {"dashpot", projected, {"isotropic", "projected"}}};
}

std::string BondDCMCortex::Coef::derive()
{
  ks =
      dcm::cortex_stiffness(E, h, young ? dcm::CortexStiffness::YOUNG : dcm::CortexStiffness::AREA);
  return "";
}

void BondDCMCortex::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  coefs.parse(narg, arg, setflag);
}

/* ----------------------------------------------------------------------
   errors before the first step; longest rest length per bond type
------------------------------------------------------------------------- */

void BondDCMCortex::init_style()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  if (!force->newton_bond)
    error->all(FLERR, "{} needs newton on for bonds: rest lengths belong to one atom of each bond",
               STYLE);
  coefs.resolve();
  slots.forget();

  std::vector<double> mine(coefs.count() + 1, 0.0), longest(coefs.count() + 1, 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    for (int m = 0; m < atom->num_bond[i]; m++) {
      const int type = std::abs(atom->bond_type[i][m]);
      double l = dcm->l0[i][m];

      // not set yet: the present length, as far as both ends are known before ghosts are

      if (l < 0.0) {
        const int j = atom->map_style == Atom::MAP_NONE ? -1
                                                        : dcm_index_of(atom, atom->bond_atom[i][m]);
        if (j < 0 || j >= atom->nlocal) continue;
        dcm::Vec3 d = dcm::vec(atom->x[j]) - dcm::vec(atom->x[i]);
        dcm_minimum_image(domain, d[0], d[1], d[2]);
        l = d.norm();
      }
      mine[type] = std::max(mine[type], l);
    }
  }
  MPI_Allreduce(mine.data(), longest.data(), (int) mine.size(), MPI_DOUBLE, MPI_MAX, world);
  for (int type = 1; type <= coefs.count(); type++) coefs[type].longest = longest[type];
}

/* ----------------------------------------------------------------------
   there is no single one: the longest, since Comm derives a ghost cutoff from it
------------------------------------------------------------------------- */

double BondDCMCortex::equilibrium_distance(int type)
{
  return coefs[type].longest;
}

/* ---------------------------------------------------------------------- */

void BondDCMCortex::write_restart(FILE *fp)
{
  coefs.write_restart(fp);
}

void BondDCMCortex::read_restart(FILE *fp)
{
  allocate();
  coefs.read_restart(fp);
  std::fill(setflag + 1, setflag + 1 + coefs.count(), 1);
}

void BondDCMCortex::write_data(FILE *fp)
{
  coefs.write_data(fp);
}

/* ----------------------------------------------------------------------
   one bond; zero if neither atom stores it on this rank
------------------------------------------------------------------------- */

double BondDCMCortex::single(int type, double rsq, int i, int j, double &fforce)
{
  fforce = 0.0;
  for (int side = 0; side < 2; side++, std::swap(i, j)) {
    if (i >= atom->nlocal) continue;
    for (int m = 0; m < atom->num_bond[i]; m++) {
      if (atom->bond_atom[i][m] != atom->tag[j]) continue;
      const double l = sqrt(rsq), ks = coefs[type].ks;
      const double rest = dcm->l0[i][m] < 0.0 ? l : dcm->l0[i][m];
      if (l > 0.0) fforce = -dcm::cortex_tension(ks, l, rest) / l;
      return dcm::cortex_energy(ks, l, rest);
    }
  }
  return 0.0;
}

/* ---------------------------------------------------------------------- */

double BondDCMCortex::memory_usage()
{
  return Bond::memory_usage() + slots.memory_usage();
}
