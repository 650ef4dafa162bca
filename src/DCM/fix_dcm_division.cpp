/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_division.h"

#include "atom_vec_dcm.h"
#include "bond_dcm_cortex.h"
#include "comm.h"
#include "dcm_cell_variable.h"
#include "dcm_parameters.h"
#include "dcm_record.h"
#include "law/random.h"
#include "dihedral_dcm_bend.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "fix_dcm_volume.h"
#include "force.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "platform.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/division";
static constexpr int RECORD = 1;    // version of the restart record

// softening begins with this factor on modulus and adhesion

static constexpr double SOFTEST = 1.0e-3;

/* ----------------------------------------------------------------------
   fix ID group dcm/division seed S [plane random|long|given x y z|variable v_x v_y v_z]
       [cbm soften T|truncate F] [tolerance t] [maxiter n] [log FILE]
------------------------------------------------------------------------- */

FixDCMDivision::FixDCMDivision(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), contact(nullptr), seed(0), plane_mode(RANDOM),
    given(Vec3::UnitX()), sphere_mode(SOFTEN), sphere_value(600.0), log(nullptr), continued(false),
    ndcm(0), ncbm(0), iterations(0), seconds(0.0), outside(0.0), quality(1.0)
{
  AtomVecDCM::require(lmp, STYLE);
  if (!modify->get_fix_by_style("^dcm/division$").empty())
    error->all(FLERR, "There is a fix dcm/division already (ID {}); a deck has at most one",
               modify->get_fix_by_style("^dcm/division$")[0]->id);
  parse(narg - 3, arg + 3);

  vector_flag = 1;
  size_vector = 7;
  extvector = 0;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

FixDCMDivision::~FixDCMDivision()
{
  if (log) fclose(log);
}

/* ---------------------------------------------------------------------- */

void FixDCMDivision::parse(int narg, char **arg)
{
  const DCMParameters parameters(lmp, STYLE);
  int iarg = 0;
  auto next = [&](const std::string &keyword) {
    if (++iarg >= narg) error->all(FLERR, "{}: keyword {} needs more values", STYLE, keyword);
    return arg[iarg];
  };
  for (; iarg < narg; iarg++) {
    const std::string key = arg[iarg];
    if (key == "seed" || key == "maxiter") {
      const double value = parameters.number(key.c_str(), next(key), DCMParameters::POSITIVE);
      if (value != std::floor(value) || value > MAXSMALLINT)
        error->all(FLERR, "{}: {} is {}, must be a positive whole number", STYLE, key, arg[iarg]);
      if (key == "seed")
        seed = (std::uint64_t) value;
      else
        settings.maxiter = (int) value;
    } else if (key == "tolerance") {
      settings.tolerance = parameters.number("tolerance", next(key), DCMParameters::POSITIVE);
      if (settings.tolerance > 0.1)
        error->all(FLERR, "{}: tolerance is {}, must be at most 0.1", STYLE, arg[iarg]);
    } else if (key == "plane") {
      const std::string mode = next(key);
      if (mode == "random") {
        plane_mode = RANDOM;
      } else if (mode == "long") {
        plane_mode = LONG;
      } else if (mode == "given") {
        plane_mode = GIVEN;
        for (int k = 0; k < 3; k++)
          given[k] = parameters.number("plane", next(key), DCMParameters::ANY);
        if (!(given.norm() > 0.0))
          error->all(FLERR, "{}: plane given 0 0 0 has no direction; give the normal", STYLE);
        given.normalize();
      } else if (mode == "variable") {
        plane_mode = VARIABLE;
        for (auto &name : variable_name) name = dcm_variable_name(lmp, STYLE, next(key));
      } else {
        error->all(FLERR,
                   "{}: unknown plane {}; use random, long, given x y z or variable v_x "
                   "v_y v_z",
                   STYLE, mode);
      }
    } else if (key == "cbm") {
      const std::string mode = next(key);
      if (mode != "soften" && mode != "truncate")
        error->all(FLERR, "{}: cbm must be soften T or truncate F, not {}", STYLE, mode);
      sphere_mode = mode == "soften" ? SOFTEN : TRUNCATE;
      sphere_value = parameters.number(mode.c_str(), next(key), DCMParameters::POSITIVE);
    } else if (key == "log") {
      log_name = next(key);
    } else {
      error->all(FLERR, "{}: unknown keyword {}; known: seed plane cbm tolerance maxiter log",
                 STYLE, key);
    }
  }
  if (seed == 0) error->all(FLERR, "{}: keyword seed is missing; give a positive number", STYLE);
}

/* ---------------------------------------------------------------------- */

int FixDCMDivision::setmask()
{
  return INITIAL_INTEGRATE | PRE_EXCHANGE;
}

void FixDCMDivision::post_constructor()
{
  FixDCMCell::ensure(lmp, STYLE);
}

/* ---------------------------------------------------------------------- */

void FixDCMDivision::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  spheres = cell->request_spheres();
  cell->refresh();
  cell->cells().require_ids(STYLE);
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (!(traits_of(lmp) & MAKES_READY))
    error->all(FLERR,
               "{}: nothing in the deck makes cells ready to divide; it needs a fix dcm/growth, or "
               "another style that does",
               STYLE);

  if (plane_mode == VARIABLE)
    for (const auto &name : variable_name) dcm_check_variable(lmp, STYLE, name);
  DCMCellSurgery::check_order(lmp, this, STYLE);

  const auto &table = cell->cells();
  const bool deformable =
      std::any_of(table.all_deformable().begin(), table.all_deformable().end(), [&table](int row) {
        return table.value("cycle_time", row, 1.0) > 0.0;
      });
  if (deformable) DCMCellSurgery::require_laws(lmp, STYLE);
  if (!sisters.empty()) hold_back_sisters();
  next_reneighbor = -1;
}

/* ----------------------------------------------------------------------
   the log is opened when all input has been checked; a run continued from a restart file
   adds to it
------------------------------------------------------------------------- */

void FixDCMDivision::setup(int /*vflag*/)
{
  DCMCellSurgery surgery(lmp, STYLE);
  const auto &table = cell->cells();
  for (const int row : table.all_deformable())
    if (table.value("cycle_time", row, 1.0) > 0.0)
      surgery.builder.reserve_slots(round_mesh(surgery, table[row].nnodes).slots);
  if (log_name.empty() || log || comm->me != 0) return;
  log = fopen(log_name.c_str(), continued ? "a" : "w");
  if (!log) error->one(FLERR, "{}: cannot open log {}: {}", STYLE, log_name, utils::getsyserror());
  if (fseek(log, 0, SEEK_END) == 0 && ftell(log) == 0)
    utils::print(log, "# LAMMPS-DCM division log; units um nN s\n"
                      "# step time mother daughter1 daughter2 generation kind axis_x axis_y axis_z "
                      "volume volume1 volume2 iterations pressure_before pressure\n");
  fflush(log);
}

/* ----------------------------------------------------------------------
   who divides in this step: then the neighbor lists are rebuilt in it, and
   pre_exchange() does it
------------------------------------------------------------------------- */

void FixDCMDivision::initial_integrate(int /*vflag*/)
{
  if (!sisters.empty()) hold_back_sisters();
  ready.clear();
  for (const auto &it : cell->cells().all())
    if (it.phase == DCMCellTable::READY) ready.push_back(it.molecule);
  if (ready.empty()) return;
  next_reneighbor = update->ntimestep;
  if (plane_mode == VARIABLE) evaluate_variables();
}

/* ----------------------------------------------------------------------
   axis of every ready cell: the variables at its center or sphere
------------------------------------------------------------------------- */

void FixDCMDivision::evaluate_variables()
{
  std::vector<double> value[3];
  for (int k = 0; k < 3; k++) value[k] = dcm_cell_variable(lmp, variable_name[k], ready);
  variable_axis.clear();
  for (size_t n = 0; n < ready.size(); n++) {
    const Vec3 axis(value[0][n], value[1][n], value[2][n]);
    if (!(axis.norm() > 0.0) || !axis.allFinite())
      error->all(FLERR,
                 "{}: plane variable gives cell {} the axis {} {} {} at step {}; it needs "
                 "a direction",
                 STYLE, ready[n], axis[0], axis[1], axis[2], update->ntimestep);
    variable_axis[ready[n]] = axis.normalized();
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMDivision::pre_exchange()
{
  if (ready.empty() || next_reneighbor != update->ntimestep) return;
  const double start = platform::walltime();

  // another fix may have condemned a cell in this very step

  const auto &table = cell->cells();
  ready.erase(std::remove_if(ready.begin(), ready.end(),
                             [&table](tagint molecule) {
                               const int row = table.find(molecule);
                               return row < 0 || table[row].phase != DCMCellTable::READY;
                             }),
              ready.end());
  DCMCellSurgery surgery(lmp, STYLE);
  const auto mothers = surgery.gather(ready);

  std::vector<Job> jobs;
  for (const auto &mother : mothers)
    if (!mother.mesh.nodes.empty()) jobs.push_back(prepare(surgery, mother));
  grow(jobs);
  for (const auto &job : jobs) check(job);

  surgery.begin();
  surgery.remove(ready);
  size_t n = 0;
  for (const auto &mother : mothers) {
    if (mother.mesh.nodes.empty())
      insert_spheres(surgery, mother);
    else
      insert(surgery, jobs[n++]);
  }
  surgery.end();
  ready.clear();
  if (!sisters.empty()) hold_back_sisters();
  seconds += platform::walltime() - start;
}

/* ----------------------------------------------------------------------
   normal of the division plane
------------------------------------------------------------------------- */

Vec3 FixDCMDivision::axis_of(const DCMCellSurgery::Cell &mother)
{
  if (plane_mode == GIVEN) return given;
  if (plane_mode == VARIABLE) return variable_axis[mother.molecule];
  if (plane_mode == LONG && !mother.mesh.nodes.empty()) return dcm::long_axis(mother.mesh);
  return dcm::Random(seed, mother.molecule, update->ntimestep, dcm::RandomPurpose::DIVISION)
      .unit_vector();
}

/* ----------------------------------------------------------------------
   sisters leave the list when softening is over, or the law's own force is below the
   truncated one
------------------------------------------------------------------------- */

void FixDCMDivision::hold_back_sisters()
{
  if (!contact) {
    sisters.clear();
    return;
  }
  const auto forces = contact->sister_forces();
  const auto &listed = contact->sisters();
  const auto &table = cell->cells();
  const double now = table.time();
  auto relaxed = [&](const Pair &it) {
    if (table.find(it.molecule) < 0 || table.find(it.other) < 0) return true;
    if (sphere_mode == SOFTEN) return now - it.since >= sphere_value;
    for (size_t n = 0; n < listed.size(); n++)
      if (listed[n].molecule == it.molecule && listed[n].other == it.other)
        return forces[n] < sphere_value;
    return false;
  };
  sisters.erase(std::remove_if(sisters.begin(), sisters.end(), relaxed), sisters.end());

  std::vector<PairDCMContact::Sisters> list;
  for (const auto &it : sisters) {
    PairDCMContact::Sisters pair = {};
    pair.molecule = it.molecule;
    pair.other = it.other;
    pair.most = sphere_mode == TRUNCATE ? sphere_value : 0.0;
    pair.scale = sphere_mode == SOFTEN ? std::max(SOFTEST, (now - it.since) / sphere_value) : 1.0;
    list.push_back(pair);
  }
  contact->set_sisters(list);
}

/* ---------------------------------------------------------------------- */

void FixDCMDivision::write_log(const DCMCellSurgery::Cell &mother, const Vec3 &axis,
                               const tagint *daughters, double volume, double volume1,
                               double volume2, int niter)
{
  if (!log) return;
  const auto &table = cell->cells();
  const int row = table.find(mother.molecule);
  utils::print(log,
               "{} {:.10g} {} {} {} {} {} {:.8f} {:.8f} {:.8f} {:.8g} {:.8g} {:.8g} {} {:.6g} "
               "{:.6g}\n",
               update->ntimestep, table.time(), mother.molecule, daughters[0], daughters[1],
               table[row].generation + 1, table[row].deformable ? "dcm" : "cbm", axis[0], axis[1],
               axis[2], volume, volume1, volume2, niter, table.value("pressure_before", row),
               table.value("pressure_rounding", row));
  fflush(log);
}

/* ---------------------------------------------------------------------- */

void FixDCMDivision::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(ndcm);
  record.put(ncbm);
  record.put(iterations);
  record.put(outside);
  record.put(quality);
  record.put(sisters);
  record.write(fp);
}

void FixDCMDivision::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(ndcm);
  record.get(ncbm);
  record.get(iterations);
  record.get(outside);
  record.get(quality);
  record.get(sisters);
  continued = true;
}

/* ----------------------------------------------------------------------
   divisions of deformable and of center-based cells, iterations, wall time, largest
   depth outside the envelope over the radius, worst face of a newborn, sisters held back
------------------------------------------------------------------------- */

double FixDCMDivision::compute_vector(int i)
{
  const double values[] = {(double) ndcm, (double) ncbm, (double) iterations,    seconds,
                           outside,       quality,       (double) sisters.size()};
  return values[i];
}

/* ---------------------------------------------------------------------- */

double FixDCMDivision::memory_usage()
{
  double bytes = (double) sisters.capacity() * sizeof(Pair);
  for (const auto &it : topology)
    bytes += (double) it.second.size() * sizeof(Vec3) + (double) it.second.hinges.size() * 20.0;
  return bytes;
}
