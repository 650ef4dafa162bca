/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_constriction.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::ConstrictedEdge;

static const char STYLE[] = "Fix dcm/constriction";

/* ----------------------------------------------------------------------
   fix ID group dcm/constriction [cap d1] [ribbon d2] [ramp T] [when lumen|born|time t]
       [release yes|no] [every N]
------------------------------------------------------------------------- */

FixDCMConstriction::FixDCMConstriction(LAMMPS *lmp, int narg, char **arg) :
    DCMSlotLengths(lmp, narg, arg), cap(0.7), ribbon(0.5), ramp(300.0), when(LUMEN), when_time(0.0),
    release(true), cell(nullptr)
{
  AtomVecDCM::require(lmp, STYLE);
  nevery = 1;
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3,
               {"cap", "ribbon", "ramp", "when", "release", "every"});
  while (args.next()) {
    if (args.is("cap") || args.is("ribbon")) {
      double &factor = args.is("cap") ? cap : ribbon;
      factor = args.number(DCMArgs::POSITIVE);
      args.check(factor <= 1.0, "above 0 and at most 1");
    } else if (args.is("ramp")) {
      ramp = args.number(DCMArgs::NONNEGATIVE);
    } else if (args.is("when")) {
      when = (When) args.choose({"lumen", "born", "time"}, "lumen, born or time t");
      if (when == TIME) when_time = args.number(DCMArgs::ANY, "when time");
    } else if (args.is("release")) {
      release = args.choose({"no", "yes"}) == 1;
    } else {
      nevery = (int) args.whole();
    }
  }

  vector_flag = 1;
  size_vector = 4;
  extvector = 0;
  global_freq = 1;
  keep_lengths();
}

/* ----------------------------------------------------------------------
   cells that nothing constricts any more are as they were without it
------------------------------------------------------------------------- */

FixDCMConstriction::~FixDCMConstriction()
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int m = 0; m < nslots(i); m++) {
      auto &length = slot(i, m).length;
      if (length.factor > 0.0) dcm->l0[i][m] = length.at(0.0, dcm->l0[i][m]);
    }
}

/* ---------------------------------------------------------------------- */

int FixDCMConstriction::setmask()
{
  return INITIAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixDCMConstriction::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  adjacency = cell->request_adjacency();
  auto &table = cell->change_cells();
  since = table.add(STYLE, "constricted", DCMColumn::RESET, -1.0, {}, since);
  share = table.add(STYLE, "constriction", DCMColumn::RESET, 0.0, {}, share);
  init_lengths();

  check_before_motion(lmp, this, STYLE);
  check_after(lmp, this, STYLE, "dcm/growth");
  check_after(lmp, this, STYLE, "dcm/polarity");
  if (ramp < update->dt && !warned) {
    warned = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "{}: ramp is {:.6g}, shorter than the timestep {:.6g}: rest lengths jump to "
                     "{:.6g} (ribbon) and {:.6g} (cap) of what they were in one step; use a ramp "
                     "of many steps",
                     STYLE, ramp, update->dt, ribbon, cap);
  }
}

/* ----------------------------------------------------------------------
   other styles add their columns in init(), also after this one
------------------------------------------------------------------------- */

void FixDCMConstriction::setup(int /*vflag*/)
{
  check_edges();
  if (when != LUMEN) return;
  int field;
  if (!cell->cells().column("marked_area", field))
    error->all(FLERR,
               "{}: nothing marks the faces at a lumen, so that no cell would ever constrict; add "
               "a fix dcm/osmosis, or use 'when born' or 'when time t'",
               STYLE);
}

/* ----------------------------------------------------------------------
   a restart file gives cells their columns by name, but edges to the fix with the ID of the one
   that wrote them; without these they would stay constricted for good
------------------------------------------------------------------------- */

void FixDCMConstriction::check_edges()
{
  if (sure) return;
  sure = true;
  const auto &table = cell->cells();
  found.assign(table.size(), 0.0);
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::NODE && nslots(i) > 0) found[cell->cell_of(i)] = 1.0;
  cell->sum(found, 1);
  for (const int row : table.all_deformable())
    if ((*since)(row) >= 0.0 && found[row] == 0.0)
      error->all(FLERR,
                 "{}: cell {} of the restart file is constricted, but its edges are not known "
                 "under the ID {}; give this fix the ID that it had in the run that wrote the file",
                 STYLE, table[row].molecule, id);
}

/* ----------------------------------------------------------------------
   after fix dcm/growth, whose phases of this step count: a cell that divides in it has its own rest
   lengths again
------------------------------------------------------------------------- */

void FixDCMConstriction::initial_integrate(int /*vflag*/)
{
  if (update->ntimestep % nevery == 0) begin_cells();
  if (advance()) write_lengths();
}

/* ----------------------------------------------------------------------
   cells that have not constricted yet, and do now if they have edges that can
------------------------------------------------------------------------- */

bool FixDCMConstriction::turn_of(const DCMCellTable::Cell &it, double marked_area) const
{
  if (!(it.mask & groupbit) || it.phase == DCMCellTable::DYING) return false;
  if (release && (it.phase == DCMCellTable::ROUNDING || it.phase == DCMCellTable::READY))
    return false;
  if (when == LUMEN) return marked_area > 0.0;
  return when == BORN || cell->cells().time() >= when_time;
}

void FixDCMConstriction::begin_cells()
{
  const auto &table = cell->cells();
  int field = 0;
  const auto marked = table.column("marked_area", field);    // not kept: it is another's
  bool any = false;
  found.assign(table.size(), -1.0);    // -1: no candidate
  for (const int row : table.all_deformable()) {
    if ((*since)(row) >= 0.0) continue;
    if (!turn_of(table[row], marked ? (*marked)(row, field) : 0.0)) continue;
    found[row] = 0.0;
    any = true;
  }
  if (!any) return;
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const int row = cell->cell_of(i);
    if (found[row] >= 0.0) found[row] += choose_edges(i, table[row]);
  }
  for (double &edges : found) edges = std::max(edges, 0.0);
  cell->sum(found, 1);
  for (const int row : table.all_deformable()) {
    if (!(found[row] > 0.0)) continue;
    (*since)(row) = table.time();
    (*share)(row) = 0.0;
  }
}

/* ----------------------------------------------------------------------
   edges that node i stores
------------------------------------------------------------------------- */

int FixDCMConstriction::choose_edges(int i, const DCMCellTable::Cell &it)
{
  int n = 0;
  for (int m = 0; m < atom->num_bond[i]; m++) {
    const int j = atom->map(atom->bond_atom[i][m]);
    const auto two = j < 0 ? std::array<int, 2>{-1, -1} : cell->faces_of_edge(i, j);
    if (two[0] < 0 || two[1] < 0)
      error->one(FLERR,
                 "{}: a face at the edge of atoms {} and {} (cell {}) is not known to the process "
                 "of atom {} at step {}; raise 'comm_modify cutoff' to more than two edges",
                 STYLE, atom->tag[i], atom->bond_atom[i][m], it.molecule, atom->tag[i],
                 update->ntimestep);
    const auto edge = dcm::constricted_edge<int>(dcm->region[cell->faces()[two[0]].atom],
                                                 dcm->region[cell->faces()[two[1]].atom],
                                                 AtomVecDCM::JUNCTION, AtomVecDCM::APICAL);
    Slot &mine = slot(i, m);
    mine = Slot();
    if (edge == ConstrictedEdge::NONE) continue;
    mine.edge = (double) edge;
    mine.length.factor = edge == ConstrictedEdge::RIBBON ? ribbon : cap;
    mine.length.base = mine.length.written = dcm->l0[i][m];
    n++;
  }
  return n;
}

/* ----------------------------------------------------------------------
   constricted cells: the ramp, back while the cell rounds up, and at its end when it divides.
   The step in which a cell chooses its edges is the first of its ramp.
------------------------------------------------------------------------- */

bool FixDCMConstriction::advance()
{
  const auto &table = cell->cells();
  const double step = ramp > 0.0 ? update->dt / ramp : 1.0;
  bool any = false;
  changed.assign(table.size(), 0);
  for (const int row : table.all_deformable()) {
    if ((*since)(row) < 0.0) continue;
    double &mine = (*share)(row);
    const int phase = table[row].phase;
    double next = 0.0;
    if (!release || phase != DCMCellTable::READY)
      next = dcm::constriction_share(mine, step, !release || phase != DCMCellTable::ROUNDING);
    if (next == mine) continue;
    mine = next;
    changed[row] = 1;
    any = true;
  }
  return any;
}

/* ----------------------------------------------------------------------
   a tenth of the ramp while any cell is on it
------------------------------------------------------------------------- */

double FixDCMConstriction::longest_step()
{
  if (ramp > 0.0)
    for (const int row : cell->cells().all_deformable())
      if ((*since)(row) >= 0.0 && (*share)(row) > 0.0 && (*share)(row) < 1.0) return 0.1 * ramp;
  return DCMRole::longest_step();
}

void FixDCMConstriction::write_lengths()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const int row = cell->cell_of(i);
    if (!changed[row]) continue;
    for (int m = 0; m < atom->num_bond[i]; m++) {
      auto &length = slot(i, m).length;
      if (length.factor > 0.0) dcm->l0[i][m] = length.at((*share)(row), dcm->l0[i][m]);
    }
  }
}

/* ----------------------------------------------------------------------
   edges go with the form; those of a cell that becomes deformable again are new
------------------------------------------------------------------------- */

void FixDCMConstriction::cell_converted(int row, double /*volume0_before*/)
{
  if (!since) return;
  (*since)(row) = -1.0;
  (*share)(row) = 0.0;
}

/* ----------------------------------------------------------------------
   constricted cells; edges of theirs in the ribbon, in the cap; mean factor of these
------------------------------------------------------------------------- */

double FixDCMConstriction::compute_vector(int n)
{
  if (!since) return n == 3 ? 1.0 : 0.0;
  FixDCMCell::check_current(lmp, STYLE, cell);
  if (n > 0) cell->check_atoms(STYLE);
  const auto &table = cell->cells();
  if (n == 0) {
    double cells = 0.0;
    for (const int row : table.all_deformable())
      if ((*since)(row) >= 0.0) cells += 1.0;
    return cells;
  }
  double sums[3] = {0.0, 0.0, 0.0};    // edges in the ribbon, in the cap; factors
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    for (int m = 0; m < atom->num_bond[i]; m++) {
      const Slot &mine = slot(i, m);
      if (!(mine.length.factor > 0.0)) continue;
      sums[mine.edge == (double) ConstrictedEdge::RIBBON ? 0 : 1] += 1.0;
      sums[2] += dcm::constriction_factor(mine.length.factor, (*share)(cell->cell_of(i)));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, world);
  if (n < 3) return sums[n - 1];
  const double edges = sums[0] + sums[1];
  return edges > 0.0 ? sums[2] / edges : 1.0;
}

double FixDCMConstriction::memory_usage()
{
  return bytes();
}
