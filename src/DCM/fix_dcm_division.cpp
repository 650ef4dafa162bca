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
#include "dcm_deck_check.h"
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
static const char HEADER[] =
    "# LAMMPS-DCM division log; units um nN s\n"
    "# step time mother daughter1 daughter2 generation kind axis_x axis_y axis_z "
    "volume volume1 volume2 iterations pressure_before pressure\n";

// softening begins with this factor on modulus and adhesion

static constexpr double SOFTEST = 1.0e-3;

/* ----------------------------------------------------------------------
   fix ID group dcm/division seed S
       [plane random|long|polarity|given x y z|variable v_x v_y v_z] [cbm soften T|truncate F]
[tolerance t] [maxiter n] [every N] [log FILE]
------------------------------------------------------------------------- */

FixDCMDivision::FixDCMDivision(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), contact(nullptr), seed(0), plane_mode(RANDOM),
    given(Vec3::UnitX()), sphere_mode(SOFTEN), sphere_value(600.0), log(lmp, STYLE, HEADER),
    ndcm(0), ncbm(0), iterations(0), seconds(0.0), outside(0.0), quality(1.0)
{
  AtomVecDCM::require(lmp, STYLE);
  if (!modify->get_fix_by_style("^dcm/division$").empty())
    error->all(FLERR, "There is a fix dcm/division already (ID {}); a deck has at most one",
               modify->get_fix_by_style("^dcm/division$")[0]->id);
  nevery = 1;
  parse(narg - 3, arg + 3);

  vector_flag = 1;
  size_vector = 7;
  extvector = 0;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

/* ---------------------------------------------------------------------- */

void FixDCMDivision::parse(int narg, char **arg)
{
  DCMArgs args(lmp, STYLE, narg, arg,
               {"seed", "plane", "cbm", "tolerance", "maxiter", "every", "log"});
  while (args.next()) {
    if (args.is("seed")) {
      seed = args.whole();
    } else if (args.is("maxiter")) {
      settings.maxiter = (int) args.whole();
    } else if (args.is("tolerance")) {
      settings.tolerance = args.number(DCMArgs::POSITIVE);
      args.check(settings.tolerance <= 0.1, "at most 0.1");
    } else if (args.is("every")) {
      nevery = (int) args.whole();
    } else if (args.is("plane")) {
      parse_plane(args);
    } else if (args.is("cbm")) {
      sphere_mode = args.choose({"soften", "truncate"}, "soften T or truncate F") ? TRUNCATE
                                                                                  : SOFTEN;
      sphere_value = args.number(DCMArgs::POSITIVE, sphere_mode == SOFTEN ? "soften" : "truncate");
    } else {
      log.name(args.text());
    }
  }
  if (seed == 0) error->all(FLERR, "{}: keyword seed is missing; give a positive number", STYLE);
}

void FixDCMDivision::parse_plane(DCMArgs &args)
{
  plane_mode = (Plane) args.choose({"random", "long", "given", "variable", "polarity"},
                                   "random, long, polarity, given x y z or variable v_x v_y v_z");
  if (plane_mode == GIVEN) {
    for (double &component : given) component = args.number();
    if (!(given.norm() > 0.0))
      error->all(FLERR, "{}: plane given 0 0 0 has no direction; give the normal", STYLE);
    given.normalize();
  } else if (plane_mode == VARIABLE) {
    for (auto &name : variable_name) name = args.variable();
  }
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
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
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
    for (const auto &name : variable_name) dcm_find_variable(lmp, STYLE, name);
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
   room for the daughters' edges; the log, now that all input has been checked
------------------------------------------------------------------------- */

void FixDCMDivision::setup(int /*vflag*/)
{
  DCMCellSurgery surgery(lmp, STYLE);
  const auto &table = cell->cells();
  int field;
  if (plane_mode == POLARITY && !table.column("px", field))
    error->all(FLERR,
               "{}: plane polarity needs a fix dcm/polarity, whose polar vector is normal to the "
               "plane; add one to the deck or choose another plane",
               STYLE);
  for (const int row : table.all_deformable())
    if (table.value("cycle_time", row, 1.0) > 0.0)
      surgery.builder.reserve_slots(round_mesh(surgery, table[row].nnodes).slots);
  log.open();
}

/* ----------------------------------------------------------------------
   who divides in this step: then the neighbor lists are rebuilt in it, and
   pre_exchange() does it
------------------------------------------------------------------------- */

void FixDCMDivision::initial_integrate(int /*vflag*/)
{
  log.begin();
  if (!sisters.empty()) hold_back_sisters();
  ready.clear();
  if (update->ntimestep % nevery) return;
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
  if (plane_mode == POLARITY) {
    const auto &table = cell->cells();
    const int row = table.find(mother.molecule);
    const Vec3 P(table.value("px", row), table.value("py", row), table.value("pz", row));
    if (P.norm() > 0.5) return P.normalized();    // else it has none yet
  }
  const int generation = cell->cells()[cell->cells().find(mother.molecule)].generation;
  return dcm::Random(seed, mother.molecule, generation, dcm::RandomPurpose::DIVISION).unit_vector();
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
  const auto &table = cell->cells();
  const int row = table.find(mother.molecule);
  log.print("{} {:.10g} {} {} {} {} {} {:.8f} {:.8f} {:.8f} {:.8g} {:.8g} {:.8g} {} {:.6g} "
            "{:.6g}\n",
            update->ntimestep, table.time(), mother.molecule, daughters[0], daughters[1],
            table[row].generation + 1, table[row].deformable ? "dcm" : "cbm", axis[0], axis[1],
            axis[2], volume, volume1, volume2, niter, table.value("pressure_before", row),
            table.value("pressure_rounding", row));
  log.flush();
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
  log.go_on();
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

std::string FixDCMDivision::work()
{
  return fmt::format("{} deformable and {} center-based cells divided so far", ndcm, ncbm);
}

/* ---------------------------------------------------------------------- */

double FixDCMDivision::memory_usage()
{
  double bytes = (double) sisters.capacity() * sizeof(Pair);
  for (const auto &it : topology)
    bytes += (double) it.second.size() * sizeof(Vec3) + (double) it.second.hinges.size() * 20.0;
  return bytes;
}
