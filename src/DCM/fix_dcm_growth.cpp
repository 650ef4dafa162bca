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
#include "dcm_gather.h"
#include "dcm_parameters.h"
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

// `until volume`: the rest volume goes no further than this times that at birth

static constexpr double MOST_GROWTH = 2.5;

// growth of a sphere's radius after which the neighbor list is rebuilt, in skins

static constexpr double REBUILD = 0.02;

/* ----------------------------------------------------------------------
   fix ID group dcm/growth [FILE name1..nameN] seed S [cycle_time v] [cycle_sd v]
       [law linear|exponential] [compression half n] [rounding part factor]
       [until rest|volume] [newborn V] [age zero|random] [proliferating NAME fraction]
------------------------------------------------------------------------- */

FixDCMGrowth::FixDCMGrowth(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), contact(nullptr), seed(0), law(dcm::GrowthLaw::LINEAR),
    half(0.0), exponent(1.0), rounding(0.05), shortening(0.95), until_volume(false),
    random_age(false), newborn(0.0), next_molecule(0), births(0), deaths(0)
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  if (!modify->get_fix_by_style("^dcm/growth$").empty())
    error->all(FLERR, "There is a fix dcm/growth already (ID {}); a deck has at most one",
               modify->get_fix_by_style("^dcm/growth$")[0]->id);

  DCMArgs args(
      lmp, STYLE, narg - 3, arg + 3,
      {"seed", "law", "compression", "rounding", "until", "newborn", "age", "proliferating"});
  parameters = std::make_unique<DCMParameters>(
      lmp, STYLE, std::vector<std::string>{"cycle_time", "cycle_sd", "K_V"});
  parameters->parse(args, atom->ntypes);
  while (args.next())
    if (!parameters->parse_keyword(args)) parse_keyword(args);
  if (seed == 0) error->all(FLERR, "{}: keyword seed is missing; give a positive number", STYLE);

  scalar_flag = vector_flag = array_flag = 1;
  size_vector = 8;
  size_array_rows = atom->ntypes;
  size_array_cols = NPHASE;
  extscalar = extvector = extarray = 0;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

FixDCMGrowth::~FixDCMGrowth() = default;

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
  return INITIAL_INTEGRATE | POST_NEIGHBOR;
}

FixDCMGrowth *FixDCMGrowth::require(LAMMPS *lmp, const std::string &asking)
{
  AtomVecDCM::require(lmp, asking);
  const auto found = lmp->modify->get_fix_by_style("^dcm/growth$");
  if (found.empty())
    lmp->error->all(FLERR,
                    "{} needs a fix dcm/growth, which keeps the book of cells; define it before",
                    asking);
  return dynamic_cast<FixDCMGrowth *>(found[0]);
}

double FixDCMGrowth::time() const
{
  return update->atime + (double) (update->ntimestep - update->atimestep) * update->dt;
}

/* ---------------------------------------------------------------------- */

void FixDCMGrowth::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = nullptr;
  if (!modify->get_fix_by_style("^dcm/cell$").empty()) cell = FixDCMCell::require(lmp, STYLE);

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
    if (contact) contact->request_virial();
    for (int t = 1; t <= atom->ntypes; t++) {
      if (!parameters->used(t)) continue;
      const bool spheres = std::any_of(book.begin(), book.end(), [t](const Entry &it) {
        return !it.deformable && it.type == t && it.cycle > 0.0;
      });
      bulk_modulus[t] = spheres ? parameters->get(t, "K_V", DCMParameters::POSITIVE)
                                : parameters->get(t, "K_V", DCMParameters::NONNEGATIVE, 0.0);
    }
  }
  next_reneighbor = -1;
}

/* ---------------------------------------------------------------------- */

void FixDCMGrowth::setup_post_neighbor()
{
  post_neighbor();
}

void FixDCMGrowth::post_neighbor()
{
  const int nall = atom->nlocal + atom->nghost;
  entry_of.assign(nall, -1);
  for (int i = 0; i < nall; i++) {
    if (dcm->kind[i] != AtomVecDCM::SPHERE) continue;
    const Entry *it = find(atom->molecule[i]);
    if (it) entry_of[i] = (int) (it - book.data());
  }
  built_radius.resize(book.size());
  for (size_t n = 0; n < book.size(); n++) built_radius[n] = dcm::ball_radius(book[n].volume0);
}

/* ----------------------------------------------------------------------
   at the start of a step, so that its forces are those of the new rest state, and
   a restart file written at its end continues with the same
------------------------------------------------------------------------- */

void FixDCMGrowth::initial_integrate(int /*vflag*/)
{
  hold_fractions();
  if (contact) measure_spheres();
  if (cell) lengths.assign(cell->cells.size(), 1.0);

  bool changed = false;
  double grown = 0.0;
  for (size_t n = 0; n < book.size(); n++) {
    Entry &it = book[n];
    const double rate =
        half > 0.0 && it.phase == GROWING ? dcm::hill_rate(strain(it, n), half, exponent) : 1.0;
    const double before = it.volume0;
    const double factor = advance(it, rate);
    if (it.deformable) {
      const int c = cell ? cell->find_cell(it.molecule) : -1;
      if (c < 0) continue;
      FixDCMCell::Cell &mine = cell->cells[c];
      if (it.phase == ROUNDING || it.phase == READY)
        it.pressure = std::max(it.pressure, mine.pressure);
      if (it.volume0 == before && factor == 1.0) continue;
      mine.volume0 = it.volume0;
      lengths[c] = factor * std::cbrt(it.volume0 / before);
    } else {
      if (it.volume0 == before) continue;
      grown = std::max(grown, std::fabs(dcm::ball_radius(it.volume0) - built_radius[n]));
    }
    changed = true;
  }
  if (changed) apply();
  if (grown > REBUILD * neighbor->skin) next_reneighbor = update->ntimestep;
}

/* ----------------------------------------------------------------------
   one cell, one step; returns the factor on rest lengths by rounding up
------------------------------------------------------------------------- */

double FixDCMGrowth::advance(Entry &it, double rate)
{
  const double growth = 1.0 - rounding, dt = update->dt;
  const double before = it.length, rest_before = it.volume0;

  if (it.phase == GROWING) {
    const double most = growth * (until_volume ? dcm::growth_progress(law, MOST_GROWTH) : 1.0);
    it.progress += rate * dt / it.cycle;
    it.volume0 = it.born * dcm::growth_factor(law, std::min(it.progress, most) / growth);
    bool done = it.progress >= growth * DONE;
    if (until_volume) {
      // cells that were there from the start: the volume they had at birth, by their law
      if (it.newborn == 0.0) it.newborn = volume_of(it) * it.born / rest_before;
      done = volume_of(it) >= 2.0 * it.newborn * DONE;
      it.progress = done ? growth : std::min(it.progress, most);
    }
    if (done) {
      it.phase = ROUNDING;
      const int c = it.deformable && cell ? cell->find_cell(it.molecule) : -1;
      it.pressure_before = it.pressure = c >= 0 ? cell->cells[c].pressure : 0.0;
    }
  } else if (it.phase == ROUNDING) {
    it.progress += dt / it.cycle;
    const double part = rounding > 0.0 ? (it.progress - growth) / rounding : 1.0;
    it.length = 1.0 - (1.0 - shortening) * std::max(0.0, std::min(1.0, part));
  } else if (it.phase == DYING) {
    it.fading -= dt;
    // fix dcm/death takes the cell away before nothing is left
    const double left = it.fading + dt > 0.0 ? it.fading / (it.fading + dt) : 1.0;
    if (left > 0.0) it.volume0 *= left;
  }
  if (it.phase == ROUNDING && it.progress >= DONE) it.phase = READY;
  return it.length / before;
}

/* ----------------------------------------------------------------------
   new rest state of atoms: centers, edges, radii (of ghosts too, without a message)
------------------------------------------------------------------------- */

void FixDCMGrowth::apply()
{
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  for (int i = 0; i < nall; i++) {
    const int kind = dcm->kind[i];
    if (kind == AtomVecDCM::SPHERE) {
      if (entry_of[i] >= 0) atom->radius[i] = dcm::ball_radius(book[entry_of[i]].volume0);
    } else if (i < nlocal && kind == AtomVecDCM::CENTER) {
      dcm->volume0[i] = cell->cells[cell->cell_of[i]].volume0;
    } else if (i < nlocal && kind == AtomVecDCM::NODE) {
      const double factor = lengths[cell->cell_of[i]];
      if (factor == 1.0) continue;
      for (int m = 0; m < atom->num_bond[i]; m++)
        if (dcm->l0[i][m] > 0.0) dcm->l0[i][m] *= factor;
    }
  }
}

/* ----------------------------------------------------------------------
   volume at the end of the last step
------------------------------------------------------------------------- */

double FixDCMGrowth::volume_of(const Entry &it) const
{
  const int c = it.deformable && cell ? cell->find_cell(it.molecule) : -1;
  return c >= 0 ? cell->cells[c].volume : it.volume0;
}

/* ----------------------------------------------------------------------
   volumetric strain, positive in compression
------------------------------------------------------------------------- */

double FixDCMGrowth::strain(const Entry &it, size_t n) const
{
  if (it.deformable) return 1.0 - volume_of(it) / it.volume0;
  if (!contact) return 0.0;
  if (bulk_modulus[it.type] == 0.0)
    error->all(
        FLERR,
        "{}: compression needs K_V of cell type {}, of which cell {} is a sphere; add it to the "
        "parameter file or give keyword K_V",
        STYLE, parameters->name(it.type), it.molecule);
  return sphere_pressure[n] / bulk_modulus[it.type];
}

void FixDCMGrowth::measure_spheres()
{
  sphere_pressure.assign(book.size(), 0.0);
  for (int i = 0; i < atom->nlocal; i++)
    if (entry_of[i] >= 0)
      sphere_pressure[entry_of[i]] =
          contact->sphere_virial()[i] / (3.0 * book[entry_of[i]].volume0);
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
  std::vector<std::pair<double, size_t>> candidates;
  for (const auto &name : fraction_names) {
    int living = 0, cycling = 0;
    double wanted = 0.0;
    for (const auto &it : book) {
      if (it.cycle == 0.0 || it.phase == DYING || parameters->name(it.type) != name) continue;
      wanted = fraction[it.type];
      living++;
      if (it.phase != QUIESCENT) cycling++;
    }
    const int change = (int) std::lround(wanted * living) - cycling;
    if (change == 0) continue;
    const int from = change > 0 ? QUIESCENT : GROWING, to = change > 0 ? GROWING : QUIESCENT;
    candidates.clear();
    for (size_t n = 0; n < book.size(); n++) {
      const Entry &it = book[n];
      if (it.cycle == 0.0 || it.phase != from || parameters->name(it.type) != name) continue;
      candidates.emplace_back(
          dcm::Random(seed, it.molecule, update->ntimestep, dcm::RandomPurpose::QUIESCENCE)
              .uniform(),
          n);
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.resize(std::min(candidates.size(), (size_t) std::abs(change)));
    for (const auto &it : candidates) book[it.second].phase = to;
  }
}

/* ----------------------------------------------------------------------
   number of cells
------------------------------------------------------------------------- */

double FixDCMGrowth::compute_scalar()
{
  return (double) book.size();
}

/* ----------------------------------------------------------------------
   cells growing, rounding up, ready, quiescent, dying; births, deaths; highest generation
------------------------------------------------------------------------- */

double FixDCMGrowth::compute_vector(int i)
{
  if (i < NPHASE)
    return (double) std::count_if(book.begin(), book.end(), [i](const Entry &it) {
      return it.phase == i;
    });
  if (i == NPHASE) return (double) births;
  if (i == NPHASE + 1) return (double) deaths;
  int highest = 0;
  for (const auto &it : book) highest = std::max(highest, it.generation);
  return highest;
}

/* ----------------------------------------------------------------------
   cells of an atom type in a phase
------------------------------------------------------------------------- */

double FixDCMGrowth::compute_array(int i, int j)
{
  return (double) std::count_if(book.begin(), book.end(), [i, j](const Entry &it) {
    return it.type == i + 1 && it.phase == j;
  });
}

/* ---------------------------------------------------------------------- */

double FixDCMGrowth::memory_usage()
{
  return (double) book.capacity() * sizeof(Entry) + (double) entry_of.capacity() * sizeof(int);
}
