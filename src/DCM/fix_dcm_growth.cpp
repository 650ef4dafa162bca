/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_growth.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "dcm_parameters.h"
#include "dcm_record.h"
#include "law/volume.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/growth";

// a cycle is over when nothing but round-off is missing

static constexpr double DONE = 1.0 - 1.0e-9;

static constexpr int RECORD = 1;    // version of the restart record

// names of the numbers of a Cycle, as compute dcm/cell prints them

static const std::vector<std::string> FIELDS = {
    "in_cycle", "cycle_time",      "volume_born",     "volume_newborn",
    "progress", "rounding_factor", "pressure_before", "pressure_rounding"};

/* ----------------------------------------------------------------------
   fix ID group dcm/growth [FILE name1..nameN] seed S [cycle_time v] [cycle_sd v]
       [law linear|exponential] [compression half n] [rounding part factor]
       [until rest|volume] [newborn V] [age zero|random] [proliferating NAME fraction]
------------------------------------------------------------------------- */

FixDCMGrowth::FixDCMGrowth(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), contact(nullptr), rest(lmp), seed(0),
    law(dcm::GrowthLaw::LINEAR), half(0.0), exponent(1.0), rounding(0.05), shortening(0.95),
    until_volume(false), random_age(false), newborn(0.0), births(0), deaths(0)
{
  AtomVecDCM::require(lmp, STYLE);
  if (!modify->get_fix_by_style("^dcm/growth$").empty())
    error->all(FLERR, "There is a fix dcm/growth already (ID {}); a deck has at most one",
               modify->get_fix_by_style("^dcm/growth$")[0]->id);

  DCMArgs args(
      lmp, STYLE, narg - 3, arg + 3,
      {"seed", "law", "compression", "rounding", "until", "newborn", "age", "proliferating"});
  args.may_repeat({"proliferating"});
  parameters = std::make_unique<DCMParameters>(
      lmp, STYLE, std::vector<std::string>{"cycle_time", "cycle_sd", "K_V"});
  parameters->parse(args, atom->ntypes);
  while (args.next())
    if (!parameters->parse_keyword(args)) parse_keyword(args);
  if (seed == 0) error->all(FLERR, "{}: keyword seed is missing; give a positive number", STYLE);

  scalar_flag = vector_flag = array_flag = 1;
  size_vector = 8;
  size_array_rows = atom->ntypes;
  size_array_cols = DCMCellTable::NPHASE;
  extscalar = extvector = extarray = 0;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

// cells that nothing makes grow any more are at rest

FixDCMGrowth::~FixDCMGrowth()
{
  if (!cycles || FixDCMCell::find(lmp) != cell) return;
  auto &table = cell->change_cells();
  for (int row = 0; row < table.size(); row++)
    if ((*cycles)(row) > 0.0 && table[row].phase != DCMCellTable::DYING)
      table.set_phase(row, DCMCellTable::QUIESCENT);
}

void FixDCMGrowth::parse_keyword(DCMArgs &args)
{
  if (args.is("seed")) {
    seed = args.whole();
  } else if (args.is("law")) {
    law = args.choose({"linear", "exponential"}) ? dcm::GrowthLaw::EXPONENTIAL
                                                 : dcm::GrowthLaw::LINEAR;
  } else if (args.is("compression")) {
    args.need(2);
    half = args.number(DCMArgs::POSITIVE);
    exponent = args.number(DCMArgs::POSITIVE);
  } else if (args.is("rounding")) {
    args.need(2);
    rounding = args.number(DCMArgs::NONNEGATIVE);
    shortening = args.number(DCMArgs::POSITIVE);
    if (rounding > 0.5 || shortening > 1.0 || shortening < 0.5)
      error->all(FLERR,
                 "{}: rounding is {} {}; expected a part of the cycle of at most 0.5 and a factor "
                 "on the rest lengths of 0.5 to 1",
                 STYLE, rounding, shortening);
  } else if (args.is("until")) {
    until_volume = args.choose({"rest", "volume"}) == 1;
  } else if (args.is("newborn")) {
    newborn = args.number(DCMArgs::POSITIVE);
  } else if (args.is("age")) {
    random_age = args.choose({"zero", "random"}) == 1;
  } else {
    args.need(2);
    fraction_names.emplace_back(args.text());
    fraction_values.push_back(args.number(DCMArgs::NONNEGATIVE));
    if (fraction_values.back() > 1.0)
      error->all(FLERR, "{}: proliferating fraction of {} is {}, must be 0 to 1", STYLE,
                 fraction_names.back(), fraction_values.back());
  }
}

/* ---------------------------------------------------------------------- */

int FixDCMGrowth::setmask()
{
  return INITIAL_INTEGRATE;
}

void FixDCMGrowth::post_constructor()
{
  FixDCMCell::ensure(lmp, STYLE);
}

/* ---------------------------------------------------------------------- */

void FixDCMGrowth::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
  spheres = cell->request_spheres();
  cycles = cell->change_cells().add(STYLE, "growth", DCMColumn::INHERIT, 0.0, FIELDS, cycles);

  parameters->resolve();
  fraction.assign(atom->ntypes + 1, -1.0);
  for (size_t n = 0; n < fraction_names.size(); n++) {
    bool any = false;
    for (int t = 1; t <= atom->ntypes; t++) {
      if (parameters->name(t) != fraction_names[n]) continue;
      fraction[t] = fraction_values[n];
      any = true;
    }
    if (!any)
      error->all(FLERR, "{}: proliferating: no atom type has the cell type {}", STYLE,
                 fraction_names[n]);
  }
  enroll();

  // spheres have a strain only through their contacts; they may come later, by conversion

  contact = nullptr;
  bulk_modulus.assign(atom->ntypes + 1, 0.0);
  if (half > 0.0) {
    contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
    if (contact) virial = contact->request_virial();
    for (int t = 1; t <= atom->ntypes; t++) {
      if (!parameters->used(t)) continue;
      const int nspheres = count([t](const DCMCellTable::Cell &it, const Cycle &mine) {
        return !it.deformable && it.type == t && mine.duration > 0.0;
      });
      bulk_modulus[t] = nspheres ? parameters->get(t, "K_V", DCMParameters::POSITIVE)
                                 : parameters->get(t, "K_V", DCMParameters::NONNEGATIVE, 0.0);
    }
  }
  next_reneighbor = -1;
}

/* ----------------------------------------------------------------------
   cells of the group that do not grow yet, and out with those that are not in it any more
------------------------------------------------------------------------- */

void FixDCMGrowth::enroll()
{
  cell->refresh();
  auto &table = cell->change_cells();
  table.require_ids(STYLE);
  for (int row = 0; row < (int) table.all().size(); row++) enroll(row);
}

void FixDCMGrowth::enroll(int row)
{
  auto &table = cell->change_cells();
  const auto &it = table[row];
  Cycle mine = cycles->load<Cycle>(row);
  const bool wanted = (it.mask & groupbit) && parameters->used(it.type);
  if (wanted == (mine.member > 0.0)) return;
  mine = wanted ? newcomer(row) : Cycle();
  if (!wanted && it.phase != DCMCellTable::DYING) table.set_phase(row, DCMCellTable::QUIESCENT);
  cycles->store(row, mine);
}

/* ----------------------------------------------------------------------
   a cell without mother: newborn, unless its size or the deck says otherwise
------------------------------------------------------------------------- */

FixDCMGrowth::Cycle FixDCMGrowth::newcomer(int row)
{
  const auto &cell_row = cell->cells()[row];
  const double volume0 = cell_row.volume0;
  Cycle it = {};
  it.member = it.length = 1.0;
  draw_cycle(row, it);
  double grown = 0.0;
  if (newborn > 0.0 && it.duration > 0.0) {
    grown = dcm::growth_progress(law, volume0 / newborn);
    if (grown < -1.0e-9 || grown > 1.0 + 1.0e-9)
      error->all(FLERR,
                 "{}: cell {} has rest volume {}, not between newborn {} and twice that; change "
                 "its size or keyword newborn",
                 STYLE, cell_row.molecule, volume0, newborn);
    grown = std::max(0.0, std::min(1.0, grown));
  } else if (random_age) {
    grown = dcm::Random(seed, cell_row.molecule, 1, dcm::RandomPurpose::CYCLE).uniform();
  }
  it.born = volume0 / dcm::growth_factor(law, grown);
  it.progress = grown * (1.0 - rounding);
  return it;
}

void FixDCMGrowth::draw_cycle(int row, Cycle &mine)
{
  auto &table = cell->change_cells();
  const auto &it = table[row];
  const double mean = parameters->get(it.type, "cycle_time", DCMParameters::NONNEGATIVE, 0.0);
  const double sd = parameters->get(it.type, "cycle_sd", DCMParameters::NONNEGATIVE, 0.0);
  mine.duration =
      mean > 0.0
          ? dcm::cycle_time(mean, sd, dcm::Random(seed, it.molecule, 0, dcm::RandomPurpose::CYCLE))
          : 0.0;
  if (it.phase == DCMCellTable::DYING) return;    // whoever makes it die goes on
  table.set_phase(row, mine.duration > 0.0 ? DCMCellTable::GROWING : DCMCellTable::QUIESCENT);
}

/* ----------------------------------------------------------------------
   at the start of a step, so that its forces are those of the new rest state, and
   a restart file written at its end continues with the same
------------------------------------------------------------------------- */

void FixDCMGrowth::initial_integrate(int /*vflag*/)
{
  hold_fractions();
  if (reads_cells()) cell->update_all();
  if (contact) measure_spheres();
  rest.begin(cell);
  const int ncells = (int) cell->cells().all().size();
  for (int row = 0; row < ncells; row++)
    if ((*cycles)(row) > 0.0) advance(row);    // its first number: is it a member?
  if (rest.apply()) next_reneighbor = update->ntimestep;
}

/* ----------------------------------------------------------------------
   does any cell depend on its volume or note its pressure in this step? The same on all ranks
------------------------------------------------------------------------- */

bool FixDCMGrowth::reads_cells() const
{
  const auto &table = cell->cells();
  for (const int row : table.all_deformable()) {
    const auto phase = table[row].phase;
    if (!((*cycles)(row) > 0.0)) continue;
    if (phase == DCMCellTable::ROUNDING || phase == DCMCellTable::READY) return true;
    if (phase != DCMCellTable::GROWING) continue;
    if (half > 0.0 || until_volume) return true;
    const Cycle mine = cycles->load<Cycle>(row);
    if (mine.progress + update->dt / mine.duration >= (1.0 - rounding) * DONE) return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   one cell, one step
------------------------------------------------------------------------- */

void FixDCMGrowth::advance(int row)
{
  auto &table = cell->change_cells();
  const auto &it = table[row];
  if (it.phase == DCMCellTable::QUIESCENT || it.phase == DCMCellTable::DYING) return;
  Cycle mine = cycles->load<Cycle>(row);
  const double growth = 1.0 - rounding, length_before = mine.length;
  double volume0 = it.volume0;

  if (it.phase == DCMCellTable::GROWING) {
    mine.progress += rate(row) * update->dt / mine.duration;
    volume0 = volume_at(mine, mine.progress);
    bool done = mine.progress >= growth * DONE;
    if (until_volume) {
      // cells that were there from the start: the volume they had at birth, by their law
      const double volume = it.deformable ? it.volume : volume0;
      if (mine.newborn == 0.0) mine.newborn = volume * mine.born / it.volume0;
      done = volume >= 2.0 * mine.newborn * DONE;
      mine.progress = done ? growth : std::min(mine.progress, growth * most());
    }
    if (done) {
      table.set_phase(row, DCMCellTable::ROUNDING);
      mine.pressure_before = mine.pressure = table.value("pressure", row);
    }
  } else if (it.phase == DCMCellTable::ROUNDING) {
    mine.progress += update->dt / mine.duration;
    mine.length = length_at(mine.progress);
  }
  if (it.phase == DCMCellTable::ROUNDING && mine.progress >= DONE)
    table.set_phase(row, DCMCellTable::READY);
  if (it.phase == DCMCellTable::ROUNDING || it.phase == DCMCellTable::READY)
    mine.pressure = std::max(mine.pressure, table.value("pressure", row));
  cycles->store(row, mine);
  rest.set(row, volume0, mine.length / length_before);
}

/* ----------------------------------------------------------------------
   volumetric strain, positive in compression; deformable cells: volume at the end of the last step
------------------------------------------------------------------------- */

double FixDCMGrowth::strain(int row) const
{
  const auto &it = cell->cells()[row];
  if (it.deformable) return 1.0 - it.volume / it.volume0;
  if (!contact) return 0.0;
  if (bulk_modulus[it.type] == 0.0)
    error->all(
        FLERR,
        "{}: compression needs K_V of cell type {}, of which cell {} is a sphere; add it to the "
        "parameter file or give keyword K_V",
        STYLE, parameters->name(it.type), it.molecule);
  return sphere_pressure[row] / bulk_modulus[it.type];
}

void FixDCMGrowth::measure_spheres()
{
  const auto &table = cell->cells();
  sphere_pressure.assign(table.all().size(), 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    const int row = cell->cell_of(i);
    if (row < 0 || table[row].deformable || !((*cycles)(row) > 0.0)) continue;
    sphere_pressure[row] = contact->sphere_virial()[i] / (3.0 * table[row].volume0);
  }
  MPI_Allreduce(MPI_IN_PLACE, sphere_pressure.data(), (int) sphere_pressure.size(), MPI_DOUBLE,
                MPI_SUM, world);
}

/* ----------------------------------------------------------------------
   send randomly chosen cells to quiescence, or wake them, until the proliferating
   fraction of each cell type is as prescribed
------------------------------------------------------------------------- */

void FixDCMGrowth::hold_fractions()
{
  if (fraction_names.empty()) return;
  auto &table = cell->change_cells();
  std::vector<std::pair<double, int>> candidates;
  for (const auto &name : fraction_names) {
    const auto counts = [&](const DCMCellTable::Cell &it, const Cycle &mine) {
      return mine.duration > 0.0 && it.phase != DCMCellTable::DYING &&
             parameters->name(it.type) == name;
    };
    double wanted = 0.0;
    const int living = count([&](const DCMCellTable::Cell &it, const Cycle &mine) {
      if (!counts(it, mine)) return false;
      wanted = fraction[it.type];
      return true;
    });
    const int cycling = count([&](const DCMCellTable::Cell &it, const Cycle &mine) {
      return counts(it, mine) && it.phase != DCMCellTable::QUIESCENT;
    });
    const int change = (int) std::lround(wanted * living) - cycling;
    if (change == 0) continue;
    const auto from = change > 0 ? DCMCellTable::QUIESCENT : DCMCellTable::GROWING;
    const auto to = change > 0 ? DCMCellTable::GROWING : DCMCellTable::QUIESCENT;
    candidates.clear();
    for (int row = 0; row < (int) table.all().size(); row++) {
      const auto &it = table[row];
      if (it.phase != from || !counts(it, cycles->load<Cycle>(row))) continue;
      candidates.emplace_back(
          dcm::Random(seed, it.molecule, table.last_molecule(), dcm::RandomPurpose::QUIESCENCE)
              .uniform(),
          row);
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.resize(std::min(candidates.size(), (size_t) std::abs(change)));
    for (const auto &it : candidates) table.set_phase(it.second, to);
  }
}

/* ----------------------------------------------------------------------
   cell events
------------------------------------------------------------------------- */

void FixDCMGrowth::cell_divided(const DCMCellTable::Division &division)
{
  for (const int row : division.daughter) {
    Cycle mine = cycles->load<Cycle>(row);    // the mother's
    if (!(mine.member > 0.0)) return;
    mine.born = cell->cells()[row].volume0;
    if (mine.newborn == 0.0) mine.newborn = 0.5 * division.volume;    // else sizes would drift
    mine.progress = 0.0;
    mine.length = 1.0;
    mine.pressure_before = mine.pressure = 0.0;
    if (parameters->used(cell->cells()[row].type))
      draw_cycle(row, mine);
    else
      mine = Cycle();    // the mother has changed to a type that does not grow
    cycles->store(row, mine);
    births++;
  }
}

void FixDCMGrowth::cell_removed(int row)
{
  if ((*cycles)(row) > 0.0) deaths++;
}

void FixDCMGrowth::cell_converted(int row, double volume0_before)
{
  Cycle mine = cycles->load<Cycle>(row);
  mine.born *= cell->cells()[row].volume0 / volume0_before;
  cycles->store(row, mine);
}

/* ----------------------------------------------------------------------
   the new type's cycle time, at the same place in the cycle; a cell that rounds up already divides
   as it would have, and its daughters take theirs
------------------------------------------------------------------------- */

void FixDCMGrowth::cell_retyped(int row, int /*type_before*/)
{
  if (!cycles) return;    // between runs, before the first
  const auto &it = cell->cells()[row];
  Cycle mine = cycles->load<Cycle>(row);
  if (mine.member > 0.0 && (it.phase == DCMCellTable::ROUNDING || it.phase == DCMCellTable::READY))
    return;
  enroll(row);
  if (!(mine.member > 0.0) || !((*cycles)(row) > 0.0)) return;
  draw_cycle(row, mine);
  cycles->store(row, mine);
}

/* ----------------------------------------------------------------------
   number of cells that take part
------------------------------------------------------------------------- */

template <class Predicate> int FixDCMGrowth::count(Predicate &&holds) const
{
  if (!cycles) return 0;
  int n = 0;
  const auto &table = cell->cells();
  for (int row = 0; row < (int) table.all().size(); row++) {
    const Cycle mine = cycles->load<Cycle>(row);
    if (mine.member > 0.0 && holds(table[row], mine)) n++;
  }
  return n;
}

double FixDCMGrowth::compute_scalar()
{
  return count([](const DCMCellTable::Cell &, const Cycle &) {
    return true;
  });
}

/* ----------------------------------------------------------------------
   cells growing, rounding up, ready, quiescent, dying; births, deaths; highest generation
------------------------------------------------------------------------- */

double FixDCMGrowth::compute_vector(int i)
{
  if (i < DCMCellTable::NPHASE)
    return count([i](const DCMCellTable::Cell &it, const Cycle &) {
      return it.phase == i;
    });
  if (i == DCMCellTable::NPHASE) return (double) births;
  if (i == DCMCellTable::NPHASE + 1) return (double) deaths;
  int highest = 0;
  count([&highest](const DCMCellTable::Cell &it, const Cycle &) {
    highest = std::max(highest, it.generation);
    return true;
  });
  return highest;
}

/* ----------------------------------------------------------------------
   cells of an atom type in a phase
------------------------------------------------------------------------- */

double FixDCMGrowth::compute_array(int i, int j)
{
  return count([i, j](const DCMCellTable::Cell &it, const Cycle &) {
    return it.type == i + 1 && it.phase == j;
  });
}

/* ---------------------------------------------------------------------- */

void FixDCMGrowth::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(births);
  record.put(deaths);
  record.write(fp);
}

void FixDCMGrowth::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(births);
  record.get(deaths);
}
