/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_anchor.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_record.h"
#include "dcm_unknowns.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "law/friction.h"
#include "law/vector.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/anchor";
static constexpr int RECORD = 1;    // version of the restart record

/* ----------------------------------------------------------------------
   fix ID group dcm/anchor number N friction Z [velocity ux uy uz] [recovery T] [share S]
------------------------------------------------------------------------- */

FixDCMAnchor::FixDCMAnchor(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), number(0.0), friction(0.0), velocity{0.0, 0.0, 0.0}, recovery(0.0),
    share(0.5), dcm(nullptr), cell(nullptr), divisions(0.0), deaths(0.0), lost(0.0)
{
  AtomVecDCM::require(lmp, STYLE);

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3,
               {"number", "friction", "velocity", "recovery", "share"});
  while (args.next()) {
    if (args.is("number")) {
      number = args.number(DCMArgs::POSITIVE);
    } else if (args.is("friction")) {
      friction = args.number(DCMArgs::POSITIVE);
    } else if (args.is("velocity")) {
      args.need(3);
      for (double &component : velocity) component = args.number();
    } else if (args.is("recovery")) {
      recovery = args.number(DCMArgs::POSITIVE);
    } else {
      share = args.number(DCMArgs::NONNEGATIVE);
      args.check(share <= 1.0, "0 to 1");
    }
  }
  if (number == 0.0 || friction == 0.0)
    error->all(FLERR, "{}: keyword {} is missing; give a positive number", STYLE,
               number == 0.0 ? "number" : "friction");

  scalar_flag = vector_flag = 1;
  size_vector = 3;
  extscalar = extvector = 1;
  global_freq = 1;
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

int FixDCMAnchor::setmask()
{
  return INITIAL_INTEGRATE | PRE_REVERSE;
}

/* ----------------------------------------------------------------------
   the table of cells belongs to a fix dcm/cell; a deck without deformable cells may lack one
------------------------------------------------------------------------- */

void FixDCMAnchor::post_constructor()
{
  FixDCMCell::ensure(lmp, STYLE);
}

/* ----------------------------------------------------------------------
   what others own is asked for at the start of every run
------------------------------------------------------------------------- */

void FixDCMAnchor::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  spheres = cell->request_spheres();
  anchors = cell->change_cells().add(STYLE, "anchors", DCMColumn::SPLIT, number, {}, anchors);

  if (update->whichflag == 1 && !(traits_of(lmp) & MOVES))
    error->all(FLERR,
               "{}: nothing solves for velocities, so that friction has no effect; add a "
               "fix dcm/motion",
               STYLE);
}

/* ----------------------------------------------------------------------
   anchors are built anew
------------------------------------------------------------------------- */

void FixDCMAnchor::initial_integrate(int /*vflag*/)
{
  if (recovery == 0.0) return;
  const double part = -std::expm1(-update->dt / recovery);
  for (int row = 0; row < cell->cells().size(); row++)
    if (acts_on(cell->cells()[row])) (*anchors)(row) += part * (number - (*anchors)(row));
}

/* ----------------------------------------------------------------------
   SPLIT gives each daughter half of her mother's; the event says who they are
------------------------------------------------------------------------- */

void FixDCMAnchor::cell_divided(const DCMCellTable::Division &division)
{
  if (!acts_on(cell->cells()[division.mother])) return;
  divisions += 1.0;
  if (share == 0.5) return;    // as SPLIT has it
  const double shared = (*anchors)(division.mother);
  (*anchors)(division.daughter[0]) = share * shared;
  (*anchors)(division.daughter[1]) = (1.0 - share) * shared;
}

void FixDCMAnchor::cell_removed(int row)
{
  if (!acts_on(cell->cells()[row])) return;
  lost += (*anchors)(row);
  deaths += 1.0;
}

/* ----------------------------------------------------------------------
   is the atom that stands for the cell, its center or sphere, in the group?
------------------------------------------------------------------------- */

bool FixDCMAnchor::acts_on(const DCMCellTable::Cell &it) const
{
  return it.mask & groupbit;
}

/* ----------------------------------------------------------------------
   friction of an owned atom with the network: nodes share that of their cell evenly
------------------------------------------------------------------------- */

double FixDCMAnchor::drag(int i) const
{
  const int kind = dcm->kind[i];
  if (kind != AtomVecDCM::NODE && kind != AtomVecDCM::SPHERE) return 0.0;
  const int row = cell->cell_of(i);
  if (row < 0 || !acts_on(cell->cells()[row])) return 0.0;
  const double whole = friction * (*anchors)(row);
  return kind == AtomVecDCM::SPHERE ? whole : whole / cell->cells()[row].nnodes;
}

/* ----------------------------------------------------------------------
   the force is drag (u - v): what multiplies v is friction, a block between the atom and what does
   not move
------------------------------------------------------------------------- */

void FixDCMAnchor::add_friction(dcm::FrictionSystem &system, DCMUnknowns &unknowns)
{
  for (int i = 0; i < atom->nlocal; i++) {
    const double part = drag(i);
    if (part > 0.0)
      system.edges.push_back({unknowns(i), DCMUnknowns::FIXED, part, 0.0, {0.0, 0.0, 0.0}});
  }
}

/* ----------------------------------------------------------------------
   ... and the rest is a force, on nodes and spheres only
------------------------------------------------------------------------- */

void FixDCMAnchor::setup_pre_reverse(int eflag, int vflag)
{
  pre_reverse(eflag, vflag);
}

void FixDCMAnchor::pre_reverse(int /*eflag*/, int /*vflag*/)
{
  double **f = atom->f;
  for (int i = 0; i < atom->nlocal; i++) dcm::vec(f[i]) += drag(i) * dcm::vec(velocity);
}

/* ----------------------------------------------------------------------
   the column is in the record of the table; what is not of a cell is ours
------------------------------------------------------------------------- */

void FixDCMAnchor::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(divisions);
  record.put(deaths);
  record.put(lost);
  record.write(fp);
}

void FixDCMAnchor::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(divisions);
  record.get(deaths);
  record.get(lost);
}

/* ----------------------------------------------------------------------
   anchors of all cells; divisions, deaths, anchors that died
------------------------------------------------------------------------- */

double FixDCMAnchor::compute_scalar()
{
  double sum = 0.0;
  const auto &all = cell->cells().all();
  for (int row = 0; row < (int) all.size(); row++)
    if (acts_on(all[row])) sum += (*anchors)(row);
  return sum;
}

double FixDCMAnchor::compute_vector(int n)
{
  const double values[] = {divisions, deaths, lost};
  return values[n];
}
