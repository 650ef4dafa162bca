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
#include "comm.h"
#include "dcm_compat.h"
#include "law/cortex.h"
#include "dcm_parameters.h"
#include "dcm_unknowns.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static const char STYLE[] = "Bond style dcm/cortex";

/* ---------------------------------------------------------------------- */

BondDCMCortex::BondDCMCortex(LAMMPS *lmp) : Bond(lmp), data(nullptr), lastcall(-1), lastncalls(-1)
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

  if (neighbor->lastcall != lastcall || neighbor->ncalls != lastncalls ||
      neighbor->nbondlist != (int) slot.size())
    match_slots();

  double **x = atom->x;
  double **f = atom->f;
  double **l0 = data->l0;
  int **bondlist = neighbor->bondlist;
  const int nbondlist = neighbor->nbondlist;
  const int nlocal = atom->nlocal;

  for (int n = 0; n < nbondlist; n++) {
    const int i = bondlist[n][0];
    const int j = bondlist[n][1];
    const double ks = coefs[bondlist[n][2]].ks;
    const double rest = l0[i][slot[n]];
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
   find the slot of every bond in the list, which NTopo fills in the order of
   atoms and slots, leaving out bonds that are switched off or belong to another
   style of bond_style hybrid; give bonds that are new a rest length
------------------------------------------------------------------------- */

void BondDCMCortex::match_slots()
{
  const tagint *tag = atom->tag;
  double **x = atom->x;
  int **bondlist = neighbor->bondlist;
  const int nbondlist = neighbor->nbondlist;

  slot.resize(nbondlist);
  int n = 0;
  for (int i = 0; i < atom->nlocal && n < nbondlist; i++) {
    for (int m = 0; m < atom->num_bond[i] && n < nbondlist; m++) {
      const int j = bondlist[n][1];
      if (bondlist[n][0] != i || bondlist[n][2] != atom->bond_type[i][m] ||
          tag[j] != atom->bond_atom[i][m])
        continue;
      if (data->l0[i][m] < 0.0) data->l0[i][m] = (dcm::vec(x[j]) - dcm::vec(x[i])).norm();
      slot[n++] = m;
    }
  }
  if (n != nbondlist)
    error->one(FLERR,
               "{}: {} of {} bonds of the neighbor list are not bonds of the atoms; another "
               "style must have changed the list or the bonds at step {}",
               STYLE, nbondlist - n, nbondlist, update->ntimestep);
  lastcall = neighbor->lastcall;
  lastncalls = neighbor->ncalls;
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

/* ---------------------------------------------------------------------- */

void BondDCMCortex::allocate()
{
  allocated = 1;
  const int np1 = atom->nbondtypes + 1;
  memory->create(setflag, np1, "bond:setflag");
  std::fill(setflag, setflag + np1, 0);
  coefs.assign(np1, Coef());
}

void BondDCMCortex::derive(Coef &coef)
{
  coef.ks = dcm::cortex_stiffness(
      coef.E, coef.h, coef.young ? dcm::CortexStiffness::YOUNG : dcm::CortexStiffness::AREA);
}

/* ----------------------------------------------------------------------
   bond_coeff N FILE CELLTYPE [E_cor v] [h_cor v] [gamma v] [stiffness area|young]
              [dashpot isotropic|projected]
------------------------------------------------------------------------- */

void BondDCMCortex::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  if (narg < 1) error->all(FLERR, "{}: bond_coeff needs a bond type", STYLE);

  int ilo, ihi;
  utils::bounds(FLERR, arg[0], 1, atom->nbondtypes, ilo, ihi, error);

  DCMParameters parameters(lmp, STYLE);
  Coef coef;
  int iarg = 1 + parameters.parse(narg - 1, arg + 1, 1);
  coef.name = arg[2];
  while (iarg < narg) {
    const int used = parameters.parse_keyword(narg - iarg, arg + iarg, {"E_cor", "h_cor", "gamma"});
    const bool has_value = iarg + 1 < narg;
    if (used) {
      iarg += used;
    } else if (strcmp(arg[iarg], "stiffness") == 0) {
      if (has_value && strcmp(arg[iarg + 1], "area") == 0)
        coef.young = 0;
      else if (has_value && strcmp(arg[iarg + 1], "young") == 0)
        coef.young = 1;
      else
        error->all(FLERR, "{}: stiffness must be area or young, not {}", STYLE,
                   has_value ? arg[iarg + 1] : "missing");
      iarg += 2;
    } else if (strcmp(arg[iarg], "dashpot") == 0) {
      if (has_value && strcmp(arg[iarg + 1], "isotropic") == 0)
        coef.projected = 0;
      else if (has_value && strcmp(arg[iarg + 1], "projected") == 0)
        coef.projected = 1;
      else
        error->all(FLERR, "{}: dashpot must be isotropic or projected, not {}", STYLE,
                   has_value ? arg[iarg + 1] : "missing");
      iarg += 2;
    } else {
      error->all(FLERR, "{}: unknown keyword {}; known: E_cor h_cor gamma stiffness dashpot", STYLE,
                 arg[iarg]);
    }
  }
  coef.E = parameters.get(1, "E_cor", DCMParameters::POSITIVE);
  coef.h = parameters.get(1, "h_cor", DCMParameters::POSITIVE);
  coef.gamma = parameters.get(1, "gamma", DCMParameters::NONNEGATIVE);
  derive(coef);

  for (int i = ilo; i <= ihi; i++) {
    coefs[i] = coef;
    setflag[i] = 1;
  }
}

/* ----------------------------------------------------------------------
   errors before the first step; longest rest length per bond type
------------------------------------------------------------------------- */

void BondDCMCortex::init_style()
{
  data = AtomVecDCM::require(lmp, STYLE);
  if (!force->newton_bond)
    error->all(FLERR, "{} needs newton on for bonds: rest lengths belong to one atom of each bond",
               STYLE);
  lastcall = lastncalls = -1;    // the lists are rebuilt in setup, possibly at the same step

  std::vector<double> mine(coefs.size(), 0.0), longest(coefs.size(), 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    for (int m = 0; m < atom->num_bond[i]; m++) {
      const int type = std::abs(atom->bond_type[i][m]);
      double l = data->l0[i][m];

      // not set yet: the present length, as far as both ends are known before ghosts are

      if (l < 0.0) {
        const int j = atom->map_style == Atom::MAP_NONE ? -1 : atom->map(atom->bond_atom[i][m]);
        if (j < 0 || j >= atom->nlocal) continue;
        dcm::Vec3 d = dcm::vec(atom->x[j]) - dcm::vec(atom->x[i]);
        dcm_minimum_image(domain, d[0], d[1], d[2]);
        l = d.norm();
      }
      mine[type] = std::max(mine[type], l);
    }
  }
  MPI_Allreduce(mine.data(), longest.data(), (int) mine.size(), MPI_DOUBLE, MPI_MAX, world);
  for (size_t type = 1; type < coefs.size(); type++) coefs[type].longest = longest[type];
}

/* ----------------------------------------------------------------------
   there is no single one: the longest, since Comm derives a ghost cutoff from it
------------------------------------------------------------------------- */

double BondDCMCortex::equilibrium_distance(int type)
{
  return coefs[type].longest;
}

/* ----------------------------------------------------------------------
   restart files hold the coefficients, so that no parameter file is needed
------------------------------------------------------------------------- */

void BondDCMCortex::write_restart(FILE *fp)
{
  for (int i = 1; i <= atom->nbondtypes; i++) {
    const Coef &coef = coefs[i];
    const double values[3] = {coef.E, coef.h, coef.gamma};
    const int flags[3] = {coef.young, coef.projected, (int) coef.name.size()};
    fwrite(values, sizeof(double), 3, fp);
    fwrite(flags, sizeof(int), 3, fp);
    fwrite(coef.name.data(), sizeof(char), coef.name.size(), fp);
  }
}

/* ---------------------------------------------------------------------- */

void BondDCMCortex::read_restart(FILE *fp)
{
  allocate();
  for (int i = 1; i <= atom->nbondtypes; i++) {
    double values[3];
    int flags[3];
    if (comm->me == 0) {
      utils::sfread(FLERR, values, sizeof(double), 3, fp, nullptr, error);
      utils::sfread(FLERR, flags, sizeof(int), 3, fp, nullptr, error);
    }
    MPI_Bcast(values, 3, MPI_DOUBLE, 0, world);
    MPI_Bcast(flags, 3, MPI_INT, 0, world);
    Coef &coef = coefs[i];
    coef.E = values[0];
    coef.h = values[1];
    coef.gamma = values[2];
    coef.young = flags[0];
    coef.projected = flags[1];
    coef.name.resize(flags[2]);
    if (comm->me == 0)
      utils::sfread(FLERR, &coef.name[0], sizeof(char), flags[2], fp, nullptr, error);
    MPI_Bcast(&coef.name[0], flags[2], MPI_CHAR, 0, world);
    derive(coef);
    setflag[i] = 1;
  }
}

/* ----------------------------------------------------------------------
   coefficients as arguments that coeff() reads back, all digits kept
------------------------------------------------------------------------- */

void BondDCMCortex::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->nbondtypes; i++) {
    const Coef &coef = coefs[i];
    utils::print(fp,
                 "{} NULL {} E_cor {:.17g} h_cor {:.17g} gamma {:.17g} stiffness {} "
                 "dashpot {}\n",
                 i, coef.name, coef.E, coef.h, coef.gamma, coef.young ? "young" : "area",
                 coef.projected ? "projected" : "isotropic");
  }
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
      const double rest = data->l0[i][m] < 0.0 ? l : data->l0[i][m];
      if (l > 0.0) fforce = -dcm::cortex_tension(ks, l, rest) / l;
      return dcm::cortex_energy(ks, l, rest);
    }
  }
  return 0.0;
}

/* ---------------------------------------------------------------------- */

double BondDCMCortex::memory_usage()
{
  return Bond::memory_usage() + (double) slot.capacity() * sizeof(int);
}
