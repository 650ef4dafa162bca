/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_death.h"

#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_cell_variable.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "law/random.h"
#include "dcm_cell_surgery.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "group.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/death";
static constexpr int RECORD = 2;    // version of the restart record
static const char HEADER[] = "# LAMMPS-DCM death log; units um nN s\n"
                             "# step time cell kind reason volume\n";

// a shrinking cell goes when this part of its rest volume is left, not a step later by round-off

static constexpr double LEAST = 0.05 + 1.0e-9;

/* ----------------------------------------------------------------------
   fix ID group dcm/death [all] [region ID] [age T] [variable v_name] [rate r seed S]
       [shrink T] [every N] [log FILE]
------------------------------------------------------------------------- */

FixDCMDeath::FixDCMDeath(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), rest(lmp), region(nullptr), age(-1.0), rate(-1.0),
    shrink(0.0), always(false), seed(0), log(lmp, STYLE, HEADER), removed(0), since(-1.0)
{
  AtomVecDCM::require(lmp, STYLE);
  nevery = 1;
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3,
               {"all", "region", "age", "variable", "rate", "seed", "shrink", "every", "log"});
  while (args.next()) {
    if (args.is("all"))
      always = true;
    else if (args.is("region"))
      region_id = args.text();
    else if (args.is("age"))
      age = args.number(DCMArgs::NONNEGATIVE);
    else if (args.is("variable"))
      variable = args.variable();
    else if (args.is("rate"))
      rate = args.number(DCMArgs::POSITIVE);
    else if (args.is("seed"))
      seed = args.whole();
    else if (args.is("shrink"))
      shrink = args.number(DCMArgs::POSITIVE);
    else if (args.is("every"))
      nevery = (int) args.whole();
    else
      log.name(args.text());
  }
  if (!always && region_id.empty() && variable.empty() && age < 0.0 && rate < 0.0)
    error->all(FLERR, "{}: who dies? give all, region, age, variable or rate", STYLE);
  if (always && (!region_id.empty() || !variable.empty() || age >= 0.0 || rate > 0.0))
    error->all(FLERR, "{}: all leaves nothing to choose; remove it or the other criteria", STYLE);
  if (rate > 0.0 && seed == 0) error->all(FLERR, "{}: rate needs keyword seed", STYLE);

  scalar_flag = 1;
  extscalar = 0;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

int FixDCMDeath::setmask()
{
  return INITIAL_INTEGRATE | PRE_EXCHANGE;
}

/* ---------------------------------------------------------------------- */

void FixDCMDeath::post_constructor()
{
  FixDCMCell::ensure(lmp, STYLE);
}

void FixDCMDeath::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
  spheres = cell->request_spheres();
  cell->refresh();
  cell->cells().require_ids(STYLE);
  if (rate > 0.0)
    exposed = cell->change_cells().add(STYLE, std::string("exposed_") + id, DCMColumn::RESET, 0.0,
                                       {}, exposed);
  if (!region_id.empty()) region = dcm_find_region(lmp, STYLE, region_id);
  if (!variable.empty()) dcm_find_variable(lmp, STYLE, variable);
  if (rate > 0.0 && rate * update->dt * nevery > 0.1)
    error->all(FLERR,
               "{}: rate {} means {} deaths per cell between two looks; it must be at most 0.1, "
               "reduce rate or every",
               STYLE, rate, rate * update->dt * nevery);
  DCMCellSurgery::check_order(lmp, this, STYLE);
  next_reneighbor = -1;
}

/* ----------------------------------------------------------------------
   the log is opened when all input has been checked
------------------------------------------------------------------------- */

void FixDCMDeath::setup(int /*vflag*/)
{
  log.open();
}

/* ----------------------------------------------------------------------
   cells of the group that meet every criterion, sorted
------------------------------------------------------------------------- */

std::vector<tagint> FixDCMDeath::condemned()
{
  const auto &table = cell->cells();
  std::vector<tagint> molecules;
  auto consider = [&](int row, int mask) {
    const auto &it = table[row];
    if (!(mask & groupbit) || it.phase == DCMCellTable::DYING) return;
    if (age >= 0.0 && table.time() - it.birth < age) return;
    molecules.push_back(it.molecule);
  };

  // the atoms have to be asked only where they are now, or in a group that changes

  if (region || group->dynamic[igroup]) {
    if (region) region->prematch();
    for (const auto &it : DCMCellTable::gather(lmp, true)) {
      const int row = table.find(it.molecule);
      if (row >= 0 && (!region || region->match(it.x[0], it.x[1], it.x[2]))) consider(row, it.mask);
    }
  } else {
    for (int row = 0; row < (int) table.all().size(); row++) consider(row, table[row].mask);
  }
  if (!variable.empty()) {
    const auto values = dcm_cell_variable(lmp, variable, molecules);
    size_t n = 0;
    for (size_t m = 0; m < molecules.size(); m++)
      if (values[m] != 0.0) molecules[n++] = molecules[m];
    molecules.resize(n);
  }

  // the random number of a cell is the share of cells that live longer than it does: how often one
  // looks changes nothing but by how much a death is late

  if (rate > 0.0) {
    const auto survives = [&](tagint molecule) {
      double &time = (*exposed)(table.find(molecule));
      time += since;
      return std::exp(-rate * time) >
             dcm::Random(seed, molecule, 0, dcm::RandomPurpose::DEATH).uniform();
    };
    molecules.erase(std::remove_if(molecules.begin(), molecules.end(), survives), molecules.end());
  }
  return molecules;
}

/* ----------------------------------------------------------------------
   linearly to nothing; a cell is taken away before that
------------------------------------------------------------------------- */

void FixDCMDeath::shrink_all()
{
  rest.begin(cell);
  const auto &table = cell->cells();
  for (auto &it : shrinking) {
    const int row = table.find(it.first);
    if (row < 0) continue;
    double &left = it.second.left;
    left -= update->dt;
    const double part = left + update->dt > 0.0 ? left / (left + update->dt) : 1.0;
    if (part > 0.0) rest.set(row, table[row].volume0 * part);
  }
  if (rest.apply()) next_reneighbor = update->ntimestep;
}

/* ---------------------------------------------------------------------- */

void FixDCMDeath::initial_integrate(int /*vflag*/)
{
  log.begin();
  auto &table = cell->change_cells();
  gone.clear();
  if (since >= 0.0) since += update->dt;
  if (!shrinking.empty()) shrink_all();
  for (auto it = shrinking.begin(); it != shrinking.end();) {
    const int row = table.find(it->first);
    const bool over = row >= 0 && (it->second.left <= 0.5 * update->dt ||
                                   table[row].volume0 <= LEAST * it->second.from);
    if (over) gone.push_back(it->first);
    it = over || row < 0 ? shrinking.erase(it) : std::next(it);
  }
  if (update->ntimestep % nevery == 0) {
    if (since < 0.0) since = nevery * update->dt;
    for (const tagint molecule : condemned()) {
      const int row = table.find(molecule);
      table.set_phase(row, DCMCellTable::DYING);    // no one else is to act on it
      if (shrink > 0.0)
        shrinking[molecule] = {shrink, table[row].volume0};
      else
        gone.push_back(molecule);
    }
    since = 0.0;
  }
  std::sort(gone.begin(), gone.end());
  if (!gone.empty()) next_reneighbor = update->ntimestep;
}

/* ---------------------------------------------------------------------- */

void FixDCMDeath::pre_exchange()
{
  if (gone.empty() || next_reneighbor != update->ntimestep) return;

  // another fix may have divided or taken away a cell in this very step

  auto &table = cell->change_cells();
  gone.erase(std::remove_if(gone.begin(), gone.end(),
                            [&table](tagint molecule) {
                              return table.find(molecule) < 0;
                            }),
             gone.end());
  DCMCellSurgery surgery(lmp, STYLE);
  surgery.begin();
  surgery.remove(gone);
  surgery.end();
  for (const tagint molecule : gone) {
    const auto it = table[table.find(molecule)];
    log.print("{} {:.10g} {} {} {} {:.8g}\n", update->ntimestep, table.time(), molecule,
              it.deformable ? "dcm" : "cbm", reason(), it.volume0);
    table.removed(molecule);
    removed++;
  }
  log.flush();
  gone.clear();
}

std::string FixDCMDeath::reason() const
{
  std::vector<std::string> words;
  if (always) words.emplace_back("all");
  if (!region_id.empty()) words.emplace_back("region");
  if (age >= 0.0) words.emplace_back("age");
  if (!variable.empty()) words.emplace_back("variable");
  if (rate > 0.0) words.emplace_back("rate");
  return utils::join_words(words, "+");
}

/* ---------------------------------------------------------------------- */

void FixDCMDeath::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  std::vector<tagint> molecules;
  std::vector<Shrinking> states;
  for (const auto &it : shrinking) {
    molecules.push_back(it.first);
    states.push_back(it.second);
  }
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(removed);
  record.put(molecules);
  record.put(states);
  record.put(since);
  record.write(fp);
}

void FixDCMDeath::restart(char *buf)
{
  std::vector<tagint> molecules;
  std::vector<Shrinking> states;
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(removed);
  record.get(molecules);
  record.get(states);
  record.get(since);
  shrinking.clear();
  for (size_t n = 0; n < molecules.size(); n++) shrinking[molecules[n]] = states[n];
  log.go_on();
}

/* ----------------------------------------------------------------------
   the rest volume that is left at the end of a step; a cell is gone with the step that ends then
------------------------------------------------------------------------- */

bool FixDCMDeath::rest_ahead(double dt, std::vector<RestAhead> &ahead)
{
  for (const auto &it : shrinking) {
    const int row = cell->cells().find(it.first);
    if (row < 0) continue;
    const double left = it.second.left;
    ahead[row].volume0 *= std::max(LEAST, left > dt ? (left - dt) / left : 0.0);
  }
  return !shrinking.empty();
}

double FixDCMDeath::next_event()
{
  double first = DCMRole::next_event();
  for (const auto &it : shrinking)
    if (it.second.left > 0.0) first = std::min(first, it.second.left);
  return first;
}

/* ----------------------------------------------------------------------
   a dying cell that takes another form goes on shrinking
------------------------------------------------------------------------- */

void FixDCMDeath::cell_converted(int row, double volume0_before)
{
  const auto &it = cell->cells()[row];
  const auto found = shrinking.find(it.molecule);
  if (found != shrinking.end()) found->second.from *= it.volume0 / volume0_before;
}

/* ----------------------------------------------------------------------
   cells taken away so far
------------------------------------------------------------------------- */

double FixDCMDeath::compute_scalar()
{
  return (double) removed;
}
