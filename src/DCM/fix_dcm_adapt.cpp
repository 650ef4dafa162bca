/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_adapt.h"

#include "atom.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "dcm_parameters.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/adapt";
static constexpr int USUAL = 10;    // steps between two looks, as of fix dcm/polarity

/* ----------------------------------------------------------------------
   fix ID group dcm/adapt [volume0 F] [rest F] [faces REGION ...] [every N]
------------------------------------------------------------------------- */

FixDCMAdapt::FixDCMAdapt(LAMMPS *lmp, int narg, char **arg) :
    DCMSlotLengths(lmp, narg, arg), cell(nullptr), by_region(false), every(0), look(1), rest(lmp)
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  chosen.fill(false);

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"volume0", "rest", "faces", "every"});
  while (args.next()) {
    if (args.is("volume0") || args.is("rest")) {
      Factor &factor = args.is("rest") ? length : volume;
      factor.given = true;
      factor.value.parse(args);
      args.check(factor.value.varies() || factor.value() > 0.0, "a positive number, or v_NAME");
    } else if (args.is("faces")) {
      by_region = true;
      for (const int r : DCMParameters::parse_regions(args)) chosen[r] = true;
    } else {
      every = (int) args.whole();
    }
  }
  if (!volume.given && !length.given)
    error->all(FLERR, "{}: give 'volume0 F', 'rest F' or both", STYLE);
  if (by_region && !length.given)
    error->all(FLERR, "{}: keyword faces needs keyword rest, whose edges it chooses", STYLE);
  if (every > 0 && !by_region)
    error->all(FLERR, "{}: keyword every needs keyword faces, whose edges it looks for", STYLE);

  vector_flag = 1;
  size_vector = 3;
  extvector = 0;
  global_freq = 1;
  if (by_region) keep_lengths();
}

/* ---------------------------------------------------------------------- */

int FixDCMAdapt::setmask()
{
  return INITIAL_INTEGRATE | PRE_FORCE;
}

void FixDCMAdapt::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  check_before_motion(lmp, this, STYLE);
  check_after(lmp, this, STYLE, "dcm/growth");
  auto &table = cell->change_cells();
  if (volume.given) {
    volume.value.find(lmp, STYLE);
    volume.applied = table.share(STYLE, "volume0_factor", DCMColumn::INHERIT, 1.0);
  }
  if (length.given) length.value.find(lmp, STYLE);
  if (length.given && !by_region)
    length.applied = table.share(STYLE, "rest_factor", DCMColumn::INHERIT, 1.0);
  if (by_region) {
    check_after(lmp, this, STYLE, "dcm/polarity");
    look = look_every(lmp, every, USUAL);
    adjacency = cell->request_adjacency();
    init_lengths();
  }
}

/* ----------------------------------------------------------------------
   two factors on one cell would each undo the other
------------------------------------------------------------------------- */

void FixDCMAdapt::check_alone()
{
  for (const auto &fix : modify->get_fix_by_style("^dcm/adapt$")) {
    const auto *const other = dynamic_cast<FixDCMAdapt *>(fix);
    if (!other || other == this) continue;
    const bool volumes = volume.applied && other->volume.given;
    if (!volumes && !(length.applied && other->length.given && !other->by_region)) continue;
    for (const int row : cell->cells().all_deformable())
      if (acts_on(row) && other->acts_on(row))
        error->all(FLERR,
                   "{}: fixes {} and {} both set the {} of cell {}; give them different groups, or "
                   "one variable that has both factors",
                   STYLE, id, other->id, volumes ? "rest volume" : "rest lengths",
                   cell->cells()[row].molecule);
  }
}

bool FixDCMAdapt::acts_on(int row) const
{
  return (cell->cells()[row].mask & groupbit) != 0;
}

bool FixDCMAdapt::anyone() const
{
  const auto &rows = cell->cells().all_deformable();
  return std::any_of(rows.begin(), rows.end(), [this](int row) {
    return acts_on(row);
  });
}

/* ----------------------------------------------------------------------
   what a run begins with, before its first forces: no step of time, and the same again if a restart
   file or the run before it has it already
------------------------------------------------------------------------- */

void FixDCMAdapt::setup_pre_force(int /*vflag*/)
{
  check_alone();
  if (!anyone()) return;
  evaluate();
  apply();
  if (by_region) write_lengths();
}

void FixDCMAdapt::initial_integrate(int /*vflag*/)
{
  if (!anyone()) return;
  evaluate();
  apply();
  if (!by_region) return;
  if (update->ntimestep % look == 0) choose_edges();
  write_lengths();
}

/* ----------------------------------------------------------------------
   factors of all cells on all processes
------------------------------------------------------------------------- */

void FixDCMAdapt::evaluate()
{
  std::vector<DCMValue *> values;
  for (Factor *const factor : {&volume, &length})
    if (factor->given) values.push_back(&factor->value);
  DCMValue::evaluate(lmp, STYLE, values, igroup);
  for (Factor *const factor : {&volume, &length})
    if (factor->given) evaluate(*factor);
}

void FixDCMAdapt::evaluate(Factor &factor)
{
  const auto &table = cell->cells();
  if (!factor.value.per_atom()) {
    factor.now.assign(table.size(), factor.value());
  } else {
    factor.now.assign(table.size(), 0.0);
    for (int i = 0; i < atom->nlocal; i++)
      if (dcm->kind[i] == AtomVecDCM::CENTER && (atom->mask[i] & groupbit))
        factor.now[cell->cell_of(i)] = factor.value(i);
    cell->sum(factor.now, 1);
  }
  for (const int row : table.all_deformable()) {
    if (!acts_on(row) || (factor.now[row] > 0.0 && std::isfinite(factor.now[row]))) continue;
    error->all(FLERR,
               "{}: variable {} gives cell {} the {} factor {} at step {}; it must be a positive "
               "number",
               STYLE, factor.value.variable(), table[row].molecule,
               &factor == &volume ? "rest volume" : "rest length", factor.now[row],
               update->ntimestep);
  }
}

/* ----------------------------------------------------------------------
   of whole cells: what is in the rest state is taken out of it; others may have multiplied it since
------------------------------------------------------------------------- */

void FixDCMAdapt::apply()
{
  const auto &table = cell->cells();
  rest.begin(cell);
  for (const int row : table.all_deformable()) {
    if (!acts_on(row)) continue;
    if (volume.applied && volume.now[row] != (*volume.applied)(row)) {
      if (table[row].phase == DCMCellTable::GROWING)
        error->all(FLERR,
                   "{}: a fix dcm/growth sets the rest volume of cell {}, which grows, so that "
                   "nothing else can; take the cell out of one of the groups",
                   STYLE, table[row].molecule);
      rest.set_volume(row, table[row].volume0 / (*volume.applied)(row) *volume.now[row]);
      (*volume.applied)(row) = volume.now[row];
    }
    if (length.applied && length.now[row] != (*length.applied)(row)) {
      rest.set(row, table[row].volume0, length.now[row] / (*length.applied)(row));
      (*length.applied)(row) = length.now[row];
    }
  }
  rest.apply();
}

/* ----------------------------------------------------------------------
   both faces at the edge of node i are in regions that the deck names
------------------------------------------------------------------------- */

bool FixDCMAdapt::inside(int i, int j) const
{
  const auto two = j < 0 ? std::array<int, 2>{-1, -1} : cell->faces_of_edge(i, j);
  if (two[0] < 0 || two[1] < 0)
    error->one(FLERR,
               "{}: a face at an edge of atom {} is not known to its process at step {}; raise "
               "'comm_modify cutoff' to more than two edges",
               STYLE, atom->tag[i], update->ntimestep);
  return chosen[dcm->region[cell->faces()[two[0]].atom]] &&
         chosen[dcm->region[cell->faces()[two[1]].atom]];
}

/* ----------------------------------------------------------------------
   edges that have come into the regions, and those that have left them and get their lengths back
------------------------------------------------------------------------- */

void FixDCMAdapt::choose_edges()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE || !acts_on(cell->cell_of(i))) continue;
    for (int m = 0; m < atom->num_bond[i]; m++) {
      auto &mine = slot(i, m).length;
      double &l0 = dcm->l0[i][m];
      if (l0 <= 0.0) continue;
      const bool is = inside(i, atom->map(atom->bond_atom[i][m]));
      if (is && mine.factor == 0.0) {
        mine = {1.0, l0, l0};
      } else if (!is && mine.factor > 0.0) {
        l0 = mine.scaled(1.0, l0);
        mine = {0.0, 0.0, 0.0};
      }
    }
  }
}

void FixDCMAdapt::write_lengths()
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const int row = cell->cell_of(i);
    if (!acts_on(row)) continue;
    for (int m = 0; m < atom->num_bond[i]; m++) {
      auto &mine = slot(i, m).length;
      if (mine.factor > 0.0) dcm->l0[i][m] = mine.scaled(length.now[row], dcm->l0[i][m]);
    }
  }
}

/* ----------------------------------------------------------------------
   mean factors of the cells acted on, 1: none; edges in the regions
------------------------------------------------------------------------- */

double FixDCMAdapt::compute_vector(int n)
{
  if (!cell) return n == 2 ? 0.0 : 1.0;
  FixDCMCell::check_current(lmp, STYLE, cell);
  const auto &table = cell->cells();
  if (n < 2) {
    const Factor &factor = n == 0 ? volume : length;
    double sum = 0.0, count = 0.0;
    for (const int row : table.all_deformable()) {
      if (!acts_on(row) || row >= (int) factor.now.size()) continue;
      sum += factor.applied ? (*factor.applied)(row) : factor.now[row];
      count += 1.0;
    }
    return count > 0.0 ? sum / count : 1.0;
  }
  double edges = 0.0, all = 0.0;
  for (int i = 0; by_region && i < atom->nlocal; i++)
    for (int m = 0; m < nslots(i); m++)
      if (slot(i, m).length.factor > 0.0) edges += 1.0;
  MPI_Allreduce(&edges, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ---------------------------------------------------------------------- */

double FixDCMAdapt::memory_usage()
{
  double total = bytes();
  for (const Factor *const factor : {&volume, &length})
    total += factor->value.memory_usage() + (double) factor->now.capacity() * sizeof(double);
  return total;
}
