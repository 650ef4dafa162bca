/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dihedral_dcm_bend.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "law/cortex.h"
#include "law/hinge.h"
#include "dcm_parameters.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

static const char STYLE[] = "Dihedral style dcm/bend";

/* ---------------------------------------------------------------------- */

DihedralDCMBend::DihedralDCMBend(LAMMPS *lmp) :
    Dihedral(lmp), data(nullptr), lastcall(-1), lastncalls(-1)
{
  writedata = 1;
}

/* ---------------------------------------------------------------------- */

DihedralDCMBend::~DihedralDCMBend()
{
  if (allocated && !copymode) memory->destroy(setflag);
}

/* ----------------------------------------------------------------------
   moment k_b sin(theta - theta0) of each hinge
------------------------------------------------------------------------- */

void DihedralDCMBend::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  if (neighbor->lastcall != lastcall || neighbor->ncalls != lastncalls ||
      neighbor->ndihedrallist != (int) slot.size())
    match_slots();

  double **x = atom->x;
  double **f = atom->f;
  double **theta0 = data->theta0;
  int **dihedrallist = neighbor->dihedrallist;
  const int ndihedrallist = neighbor->ndihedrallist;
  const int nlocal = atom->nlocal;

  for (int n = 0; n < ndihedrallist; n++) {
    const int *const i = dihedrallist[n];
    const Coef &coef = coefs[i[4]];
    const double rest = coef.mesh ? theta0[i[1]][slot[n]] : 0.0;
    dcm::Hinge h = dcm::hinge(coef.kb, rest, dcm::vec(x[i[0]]), dcm::vec(x[i[1]]),
                              dcm::vec(x[i[2]]), dcm::vec(x[i[3]]));

    // newton_bond is on, so ghosts take their share as well

    dcm::vec(f[i[0]]) += h.f1;
    dcm::vec(f[i[1]]) += h.f2;
    dcm::vec(f[i[2]]) += h.f3;
    dcm::vec(f[i[3]]) += h.f4;

    if (evflag) {
      const dcm::Vec3 vb1 = dcm::vec(x[i[0]]) - dcm::vec(x[i[1]]);
      const dcm::Vec3 vb2 = dcm::vec(x[i[2]]) - dcm::vec(x[i[1]]);
      const dcm::Vec3 vb3 = dcm::vec(x[i[3]]) - dcm::vec(x[i[2]]);
      ev_tally(i[0], i[1], i[2], i[3], nlocal, 1, h.energy, h.f1.data(), h.f3.data(), h.f4.data(),
               vb1[0], vb1[1], vb1[2], vb2[0], vb2[1], vb2[2], vb3[0], vb3[1], vb3[2]);
    }
  }
}

/* ----------------------------------------------------------------------
   find the slot of every hinge in the list, which NTopo fills in the order of
   atoms and slots, leaving out hinges that are switched off or belong to another
   style of dihedral_style hybrid; give hinges that are new a rest angle
------------------------------------------------------------------------- */

void DihedralDCMBend::match_slots()
{
  const tagint *tag = atom->tag;
  double **x = atom->x;
  int **dihedrallist = neighbor->dihedrallist;
  const int ndihedrallist = neighbor->ndihedrallist;

  slot.resize(ndihedrallist);
  int n = 0;
  for (int i = 0; i < atom->nlocal && n < ndihedrallist; i++) {
    for (int m = 0; m < atom->num_dihedral[i] && n < ndihedrallist; m++) {
      const int *const l = dihedrallist[n];
      if (l[1] != i || l[4] != atom->dihedral_type[i][m] ||
          tag[l[0]] != atom->dihedral_atom1[i][m] || tag[l[2]] != atom->dihedral_atom3[i][m] ||
          tag[l[3]] != atom->dihedral_atom4[i][m])
        continue;
      double &rest = data->theta0[i][m];
      if (rest > 4.0 && coefs[l[4]].mesh)
        rest = dcm::hinge_angle(dcm::vec(x[l[0]]), dcm::vec(x[l[1]]), dcm::vec(x[l[2]]),
                                dcm::vec(x[l[3]]));
      slot[n++] = m;
    }
  }
  if (n != ndihedrallist)
    error->one(FLERR,
               "{}: {} of {} dihedrals of the neighbor list are not stored with their second "
               "atom; another style must have changed the list or the dihedrals at step {}",
               STYLE, ndihedrallist - n, ndihedrallist, update->ntimestep);
  lastcall = neighbor->lastcall;
  lastncalls = neighbor->ncalls;
}

/* ---------------------------------------------------------------------- */

void DihedralDCMBend::allocate()
{
  allocated = 1;
  const int np1 = atom->ndihedraltypes + 1;
  memory->create(setflag, np1, "dihedral:setflag");
  std::fill(setflag, setflag + np1, 0);
  coefs.assign(np1, Coef());
}

void DihedralDCMBend::derive(Coef &coef)
{
  coef.kb = dcm::bending_stiffness(coef.E, coef.h, coef.nu);
}

/* ----------------------------------------------------------------------
   dihedral_coeff N FILE CELLTYPE [E_cor v] [h_cor v] [nu_cor v] [rest flat|mesh]
------------------------------------------------------------------------- */

void DihedralDCMBend::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  if (narg < 1) error->all(FLERR, "{}: dihedral_coeff needs a dihedral type", STYLE);

  int ilo, ihi;
  utils::bounds(FLERR, arg[0], 1, atom->ndihedraltypes, ilo, ihi, error);

  DCMParameters parameters(lmp, STYLE);
  Coef coef;
  int iarg = 1 + parameters.parse(narg - 1, arg + 1, 1);
  coef.name = arg[2];
  while (iarg < narg) {
    const int used =
        parameters.parse_keyword(narg - iarg, arg + iarg, {"E_cor", "h_cor", "nu_cor"});
    const bool has_value = iarg + 1 < narg;
    if (used) {
      iarg += used;
    } else if (strcmp(arg[iarg], "rest") == 0) {
      if (has_value && strcmp(arg[iarg + 1], "flat") == 0)
        coef.mesh = 0;
      else if (has_value && strcmp(arg[iarg + 1], "mesh") == 0)
        coef.mesh = 1;
      else
        error->all(FLERR, "{}: rest must be flat or mesh, not {}", STYLE,
                   has_value ? arg[iarg + 1] : "missing");
      iarg += 2;
    } else {
      error->all(FLERR, "{}: unknown keyword {}; known: E_cor h_cor nu_cor rest", STYLE, arg[iarg]);
    }
  }
  coef.E = parameters.get(1, "E_cor", DCMParameters::POSITIVE);
  coef.h = parameters.get(1, "h_cor", DCMParameters::POSITIVE);
  coef.nu = parameters.get(1, "nu_cor", DCMParameters::ANY, 0.5);
  if (!(coef.nu > -1.0 && coef.nu < 1.0))
    error->all(FLERR, "{}: nu_cor of cell type {} is {}, must be between -1 and 1", STYLE,
               coef.name, coef.nu);
  derive(coef);

  for (int i = ilo; i <= ihi; i++) {
    coefs[i] = coef;
    setflag[i] = 1;
  }
}

/* ----------------------------------------------------------------------
   errors before the first step
------------------------------------------------------------------------- */

void DihedralDCMBend::init_style()
{
  data = AtomVecDCM::require(lmp, STYLE);
  if (!force->newton_bond)
    error->all(FLERR,
               "{} needs newton on for bonds: rest angles belong to one atom of each dihedral",
               STYLE);
  lastcall = lastncalls = -1;    // the lists are rebuilt in setup, possibly at the same step
}

/* ----------------------------------------------------------------------
   restart files hold the coefficients, so that no parameter file is needed
------------------------------------------------------------------------- */

void DihedralDCMBend::write_restart(FILE *fp)
{
  for (int i = 1; i <= atom->ndihedraltypes; i++) {
    const Coef &coef = coefs[i];
    const double values[3] = {coef.E, coef.h, coef.nu};
    const int flags[2] = {coef.mesh, (int) coef.name.size()};
    fwrite(values, sizeof(double), 3, fp);
    fwrite(flags, sizeof(int), 2, fp);
    fwrite(coef.name.data(), sizeof(char), coef.name.size(), fp);
  }
}

/* ---------------------------------------------------------------------- */

void DihedralDCMBend::read_restart(FILE *fp)
{
  allocate();
  for (int i = 1; i <= atom->ndihedraltypes; i++) {
    double values[3];
    int flags[2];
    if (comm->me == 0) {
      utils::sfread(FLERR, values, sizeof(double), 3, fp, nullptr, error);
      utils::sfread(FLERR, flags, sizeof(int), 2, fp, nullptr, error);
    }
    MPI_Bcast(values, 3, MPI_DOUBLE, 0, world);
    MPI_Bcast(flags, 2, MPI_INT, 0, world);
    Coef &coef = coefs[i];
    coef.E = values[0];
    coef.h = values[1];
    coef.nu = values[2];
    coef.mesh = flags[0];
    coef.name.resize(flags[1]);
    if (comm->me == 0)
      utils::sfread(FLERR, &coef.name[0], sizeof(char), flags[1], fp, nullptr, error);
    MPI_Bcast(&coef.name[0], flags[1], MPI_CHAR, 0, world);
    derive(coef);
    setflag[i] = 1;
  }
}

/* ----------------------------------------------------------------------
   coefficients as arguments that coeff() reads back, all digits kept
------------------------------------------------------------------------- */

void DihedralDCMBend::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ndihedraltypes; i++) {
    const Coef &coef = coefs[i];
    utils::print(fp, "{} NULL {} E_cor {:.17g} h_cor {:.17g} nu_cor {:.17g} rest {}\n", i,
                 coef.name, coef.E, coef.h, coef.nu, coef.mesh ? "mesh" : "flat");
  }
}

/* ---------------------------------------------------------------------- */

double DihedralDCMBend::memory_usage()
{
  return Dihedral::memory_usage() + (double) slot.capacity() * sizeof(int);
}
