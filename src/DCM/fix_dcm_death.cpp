/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_death.h"

#include "comm.h"
#include "dcm_gather.h"
#include "dcm_args.h"
#include "law/random.h"
#include "dcm_cell_surgery.h"
#include "error.h"
#include "fix_dcm_growth.h"
#include "modify.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/death";
static const char HEADER[] = "# LAMMPS-DCM death log; units um nN s\n"
                             "# step time cell kind reason volume\n";

// a shrinking cell goes when this part of its rest volume is left, not a step later by round-off

static constexpr double LEAST = 0.05 + 1.0e-9;

/* ----------------------------------------------------------------------
   fix ID group dcm/death [all] [region ID] [age T] [variable v_name] [rate r seed S]
       [shrink T] [every N] [log FILE]
------------------------------------------------------------------------- */

FixDCMDeath::FixDCMDeath(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), growth(nullptr), region(nullptr), age(-1.0), rate(-1.0), shrink(0.0),
    always(false), seed(0), log(lmp, STYLE, HEADER), removed(0)
{
  FixDCMGrowth::require(lmp, STYLE);
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

void FixDCMDeath::init()
{
  growth = FixDCMGrowth::require(lmp, STYLE);
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
  std::vector<tagint> molecules;
  if (region) region->prematch();
  for (const auto &it : dcm_cell_atoms(lmp)) {
    if (!(it.mask & groupbit)) continue;
    const auto *const entry = growth->find(it.molecule);
    if (!entry || entry->phase == FixDCMGrowth::DYING) continue;
    if (age >= 0.0 && growth->time() - entry->birth < age) continue;
    if (region && !region->match(it.x[0], it.x[1], it.x[2])) continue;
    if (rate > 0.0 &&
        dcm::Random(seed, it.molecule, update->ntimestep, dcm::RandomPurpose::DEATH).uniform() >
            rate * update->dt * nevery)
      continue;
    molecules.push_back(it.molecule);
  }
  if (!variable.empty()) {
    const auto values = dcm_cell_variable(lmp, variable, molecules);
    size_t n = 0;
    for (size_t m = 0; m < molecules.size(); m++)
      if (values[m] != 0.0) molecules[n++] = molecules[m];
    molecules.resize(n);
  }
  return molecules;
}

/* ---------------------------------------------------------------------- */

void FixDCMDeath::initial_integrate(int /*vflag*/)
{
  gone.clear();
  for (auto it = shrinking.begin(); it != shrinking.end();) {
    const auto *const entry = growth->find(*it);
    const bool over =
        entry && (entry->fading <= 0.5 * update->dt || entry->volume0 <= LEAST * entry->dying0);
    if (over) gone.push_back(*it);
    it = over || !entry ? shrinking.erase(it) : std::next(it);
  }
  if (update->ntimestep % nevery == 0) {
    for (const tagint molecule : condemned()) {
      if (shrink > 0.0) {
        growth->fade(molecule, shrink);
        shrinking.insert(molecule);
      } else {
        growth->fade(molecule, update->dt);    // no one else is to act on it in this step
        gone.push_back(molecule);
      }
    }
  }
  std::sort(gone.begin(), gone.end());
  if (!gone.empty()) next_reneighbor = update->ntimestep;
}

/* ---------------------------------------------------------------------- */

void FixDCMDeath::pre_exchange()
{
  if (gone.empty() || next_reneighbor != update->ntimestep) return;

  // another fix may have divided or taken away a cell in this very step

  gone.erase(std::remove_if(gone.begin(), gone.end(),
                            [this](tagint molecule) {
                              return !growth->find(molecule);
                            }),
             gone.end());
  DCMCellSurgery surgery(lmp, STYLE);
  surgery.begin();
  surgery.remove(gone);
  surgery.end();
  for (const tagint molecule : gone) {
    const auto &it = *growth->find(molecule);
    log.print("{} {:.10g} {} {} {} {:.8g}\n", update->ntimestep, growth->time(), molecule,
              it.deformable ? "dcm" : "cbm", reason(), it.volume0);
    growth->remove(molecule);
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
  std::vector<bigint> list = {removed};
  list.insert(list.end(), shrinking.begin(), shrinking.end());
  const int size = (int) ((list.size() + 1) * sizeof(bigint));
  const bigint n = (bigint) list.size();
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&n, sizeof(bigint), 1, fp);
  fwrite(list.data(), sizeof(bigint), list.size(), fp);
}

void FixDCMDeath::restart(char *buf)
{
  bigint n;
  memcpy(&n, buf, sizeof(bigint));
  std::vector<bigint> list(n);
  memcpy(list.data(), buf + sizeof(bigint), n * sizeof(bigint));
  removed = list[0];
  shrinking.clear();
  for (bigint k = 1; k < n; k++) shrinking.insert((tagint) list[k]);
  log.go_on();
}

/* ----------------------------------------------------------------------
   cells taken away so far
------------------------------------------------------------------------- */

double FixDCMDeath::compute_scalar()
{
  return (double) removed;
}
