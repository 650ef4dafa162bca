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
#include "dcm_unknowns.h"
#include "fix_dcm_cell.h"
#include "law/hinge.h"
#include "law/symmetric.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static const char STYLE[] = "Dihedral style dcm/bend";

/* ---------------------------------------------------------------------- */

DihedralDCMBend::DihedralDCMBend(LAMMPS *lmp) :
    Dihedral(lmp), coefs(lmp, STYLE), dcm(nullptr), slots(lmp, STYLE, "dihedrals")
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

  if (slots.stale(neighbor->ndihedrallist)) match_slots();

  double **x = atom->x;
  double **f = atom->f;
  double **theta0 = dcm->theta0;
  int **dihedrallist = neighbor->dihedrallist;
  const int ndihedrallist = neighbor->ndihedrallist;
  const int nlocal = atom->nlocal;

  for (int n = 0; n < ndihedrallist; n++) {
    const int *const i = dihedrallist[n];
    const Coef &coef = coefs[i[4]];
    const double rest = coef.mesh ? theta0[i[1]][slots[n]] : 0.0;
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
   a hinge that is new gets its angle as rest angle
------------------------------------------------------------------------- */

void DihedralDCMBend::match_slots()
{
  double **x = atom->x, **theta0 = dcm->theta0;
  const DCMSlots::Stored stored = {
      1,
      4,
      atom->num_dihedral,
      atom->dihedral_type,
      {{0, atom->dihedral_atom1}, {2, atom->dihedral_atom3}, {3, atom->dihedral_atom4}}};
  slots.match(neighbor->dihedrallist, neighbor->ndihedrallist, stored, [=](const int *i, int m) {
    double &rest = theta0[i[1]][m];
    if (rest > 4.0 && coefs[i[4]].mesh)
      rest = dcm::hinge_angle(dcm::vec(x[i[0]]), dcm::vec(x[i[1]]), dcm::vec(x[i[2]]),
                              dcm::vec(x[i[3]]));
  });
}

/* ----------------------------------------------------------------------
   hinges, as their forces were last computed
------------------------------------------------------------------------- */

void DihedralDCMBend::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  double **x = atom->x, **theta0 = dcm->theta0;
  int **dihedrallist = neighbor->dihedrallist;
  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *const i = dihedrallist[n];
    const Coef &coef = coefs[i[4]];
    const double rest = coef.mesh ? theta0[i[1]][slots[n]] : 0.0;
    const double cosine = rest == 0.0 ? 1.0 : std::cos(rest);
    const double sine = rest == 0.0 ? 0.0 : std::sin(rest);
    auto block = dcm::hinge_stiffness(coef.kb, cosine, sine, dcm::vec(x[i[0]]), dcm::vec(x[i[1]]),
                                      dcm::vec(x[i[2]]), dcm::vec(x[i[3]]));
    if (block.c == 0.0) continue;
    int moving = 0;
    for (int k = 0; k < 4; k++) moving += block.n[k] = unknowns(i[k]);
    if (moving > 0) system.hinges.push_back(block);
  }
}

/* ----------------------------------------------------------------------
   no trace, since angles do not change when a cell swells
------------------------------------------------------------------------- */

void DihedralDCMBend::add_cell_virial(std::vector<double> &virial)
{
  const FixDCMCell *const cell = FixDCMCell::require(lmp, STYLE);
  double **x = atom->x, **theta0 = dcm->theta0;
  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *const i = neighbor->dihedrallist[n], row = cell->cell_of(i[1]);
    if (row < 0) continue;
    const Coef &coef = coefs[i[4]];
    const double rest = coef.mesh ? theta0[i[1]][slots[n]] : 0.0;
    const dcm::Vec3 x1 = dcm::vec(x[i[0]]), x2 = dcm::vec(x[i[1]]), x3 = dcm::vec(x[i[2]]),
                    x4 = dcm::vec(x[i[3]]);
    const dcm::Hinge h = dcm::hinge(coef.kb, rest, x1, x2, x3, x4);
    double *const six = &virial[6 * (size_t) row];
    dcm::add_outer(six, h.f1, x1 - x2);
    dcm::add_outer(six, h.f3, x3 - x2);
    dcm::add_outer(six, h.f4, x4 - x2);
  }
}

/* ---------------------------------------------------------------------- */

void DihedralDCMBend::allocate()
{
  allocated = 1;
  const int np1 = atom->ndihedraltypes + 1;
  memory->create(setflag, np1, "dihedral:setflag");
  std::fill(setflag, setflag + np1, 0);
  coefs.allocate(atom->ndihedraltypes);
}

/* ----------------------------------------------------------------------
   dihedral_coeff N [FILE] CELLTYPE [E_cor v] [h_cor v] [nu_cor v] [rest flat|mesh]
------------------------------------------------------------------------- */

std::vector<DCMField> DihedralDCMBend::Coef::fields()
{
  return {{"E_cor", E, DCMParameters::POSITIVE},
          {"h_cor", h, DCMParameters::POSITIVE},
          {"nu_cor", nu, DCMParameters::ANY, 0.5},
          {"rest", mesh, {"flat", "mesh"}}};
}

std::string DihedralDCMBend::Coef::derive()
{
  if (!(nu > -1.0 && nu < 1.0)) return fmt::format("nu_cor is {}, must be between -1 and 1", nu);
  kb = dcm::bending_stiffness(E, h, nu);
  return "";
}

void DihedralDCMBend::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  coefs.parse(narg, arg, setflag);
}

/* ----------------------------------------------------------------------
   errors before the first step
------------------------------------------------------------------------- */

void DihedralDCMBend::init_style()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  if (!force->newton_bond)
    error->all(FLERR,
               "{} needs newton on for bonds: rest angles belong to one atom of each dihedral",
               STYLE);
  coefs.resolve();
  slots.forget();
}

/* ---------------------------------------------------------------------- */

void DihedralDCMBend::write_restart(FILE *fp)
{
  coefs.write_restart(fp);
}

void DihedralDCMBend::read_restart(FILE *fp)
{
  allocate();
  coefs.read_restart(fp);
  std::fill(setflag + 1, setflag + 1 + coefs.count(), 1);
}

void DihedralDCMBend::write_data(FILE *fp)
{
  coefs.write_data(fp);
}

/* ---------------------------------------------------------------------- */

double DihedralDCMBend::memory_usage()
{
  return Dihedral::memory_usage() + slots.memory_usage();
}
