/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_division.h"

#include "bond_dcm_cortex.h"
#include "comm.h"
#include "dcm_gather.h"
#include "dcm_parameters.h"
#include "dcm_random.h"
#include "dihedral_dcm_bend.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "fix_dcm_growth.h"
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

// softening begins with this factor on modulus and adhesion

static constexpr double SOFTEST = 1.0e-3;

// Sums differ in their last bits with the number of ranks, and a minimization makes micrometers out
// of them. The mother's shape is therefore rounded, to this part of its size, before it divides.

static constexpr double ROUNDING = 0x1p-32;

static double rounded(double value, double unit)
{
  return unit * std::round(value / unit);
}

static double sphere_volume(double radius)
{
  return 4.0 / 3.0 * dcm::PI * radius * radius * radius;
}

/* ----------------------------------------------------------------------
   fix ID group dcm/division seed S [plane random|long|given x y z|variable v_x v_y v_z]
       [cbm soften T|truncate F] [tolerance t] [maxiter n] [log FILE]
------------------------------------------------------------------------- */

FixDCMDivision::FixDCMDivision(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), growth(nullptr), cell(nullptr), contact(nullptr), seed(0),
    plane_mode(RANDOM), given(Vec3::UnitX()), sphere_mode(SOFTEN), sphere_value(600.0),
    log(nullptr), continued(false), ndcm(0), ncbm(0), iterations(0), seconds(0.0), outside(0.0),
    quality(1.0)
{
  FixDCMGrowth::require(lmp, STYLE);
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

/* ---------------------------------------------------------------------- */

void FixDCMDivision::init()
{
  growth = FixDCMGrowth::require(lmp, STYLE);
  cell = nullptr;
  if (!modify->get_fix_by_style("^dcm/cell$").empty()) cell = FixDCMCell::require(lmp, STYLE);
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));

  if (plane_mode == VARIABLE)
    for (const auto &name : variable_name) dcm_check_variable(lmp, STYLE, name);
  DCMSurgery::check_order(lmp, this, STYLE);

  const bool deformable =
      std::any_of(growth->book.begin(), growth->book.end(), [](const FixDCMGrowth::Entry &it) {
        return it.deformable && it.cycle > 0.0;
      });
  if (deformable) DCMSurgery::require_laws(lmp, STYLE);
  if (!sisters.empty()) hold_back_sisters();
  next_reneighbor = -1;
  seconds = 0.0;
}

/* ----------------------------------------------------------------------
   the log is opened when all input has been checked; a run continued from a restart file
   adds to it
------------------------------------------------------------------------- */

void FixDCMDivision::setup(int /*vflag*/)
{
  DCMSurgery surgery(lmp, STYLE);
  for (const auto &it : growth->book) {
    const int c = it.deformable && it.cycle > 0.0 ? cell->find_cell(it.molecule) : -1;
    if (c >= 0) surgery.builder.reserve_slots(round_mesh(surgery, cell->cells[c].nnodes).slots);
  }
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
  for (const auto &it : growth->book)
    if (it.phase == FixDCMGrowth::READY) ready.push_back(it.molecule);
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

  ready.erase(std::remove_if(ready.begin(), ready.end(),
                             [this](tagint molecule) {
                               const auto *const it = growth->find(molecule);
                               return !it || it->phase != FixDCMGrowth::READY;
                             }),
              ready.end());
  DCMSurgery surgery(lmp, STYLE);
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

Vec3 FixDCMDivision::axis_of(const DCMSurgery::Cell &mother)
{
  if (plane_mode == GIVEN) return given;
  if (plane_mode == VARIABLE) return variable_axis[mother.molecule];
  if (plane_mode == LONG && !mother.mesh.nodes.empty()) return dcm::long_axis(mother.mesh);
  return dcm::Random(seed, mother.molecule, update->ntimestep, dcm::RandomPurpose::DIVISION)
      .unit_vector();
}

/* ----------------------------------------------------------------------
   the icosphere with the mother's number of nodes, or the next one
------------------------------------------------------------------------- */

const DCMBuilder::Topology &FixDCMDivision::round_mesh(DCMSurgery &surgery, size_t nnodes)
{
  int level = 1;
  size_t size = 42;
  while (level < 5 && size < nnodes) {
    size = 4 * size - 6;
    level++;
  }
  auto found = topology.find(level);
  if (found == topology.end())
    found = topology.emplace(level, surgery.builder.prepare(dcm::icosphere(level), true)).first;
  return found->second;
}

/* ----------------------------------------------------------------------
   what the sub-simulation needs: plane, the laws' constants, the prestress of the cortex
------------------------------------------------------------------------- */

FixDCMDivision::Job FixDCMDivision::prepare(DCMSurgery &surgery, const DCMSurgery::Cell &mother)
{
  Job job = {};
  job.mother = mother;
  const double unit = ROUNDING * std::exp2(std::round(std::log2(mother.volume0) / 3.0));
  for (Vec3 &x : job.mother.mesh.nodes)
    for (double &xk : x) xk = rounded(xk, unit);
  job.round = &round_mesh(surgery, mother.mesh.nodes.size());
  job.volume = dcm::volume(job.mother.mesh);
  job.plane = dcm::halving_plane(job.mother.mesh, axis_of(job.mother));

  auto *const cortex = dynamic_cast<BondDCMCortex *>(force->bond_match("dcm/cortex"));
  auto *const bend = dynamic_cast<DihedralDCMBend *>(force->dihedral_match("dcm/bend"));
  job.material.ks = cortex->stiffness(mother.types.bond);
  job.material.kb = bend->stiffness(mother.types.dihedral);
  job.material.flat = !bend->rest_angles(mother.types.dihedral);
  const FixDCMCell::Cell &it = cell->cells[cell->find_cell(mother.molecule)];
  for (auto *fix : modify->get_fix_by_style("^dcm/volume$"))
    job.material.K_V =
        std::max(job.material.K_V, dynamic_cast<FixDCMVolume *>(fix)->bulk_modulus(it));
  if (job.material.K_V <= 0.0)
    error->all(FLERR, "{}: cell {} is to divide at step {} but no fix dcm/volume acts on it", STYLE,
               mother.molecule, update->ntimestep);

  // mean rest length, before rounding up, over the edges of a round cell of this rest volume;
  // per face, since a mesh from a file has another number of them than the icosphere

  double sum = 0.0;
  for (double l : mother.l0) sum += l;
  const double length = sum / mother.l0.size() / growth->find(mother.molecule)->length;
  const dcm::Mesh &round = job.round->mesh;
  const double edge = dcm::mean_edge(round) * std::cbrt(mother.volume0 / dcm::volume(round));
  job.rest = rounded(
      length / edge * std::sqrt((double) mother.mesh.faces.size() / round.faces.size()), ROUNDING);
  return job;
}

/* ----------------------------------------------------------------------
   the daughters are shared out among the ranks; all get all results
------------------------------------------------------------------------- */

void FixDCMDivision::grow(std::vector<Job> &jobs)
{
  for (size_t n = 0; n < 2 * jobs.size(); n++) {
    if ((int) (n % comm->nprocs) != comm->me) continue;
    Job &job = jobs[n / 2];
    dcm::Daughter &daughter = job.daughter[n % 2];
    dcm::DivisionSettings mine = settings;
    mine.volume = 0.5 * job.volume;
    // rest lengths are those of the rest volume, the settings those of the volume
    mine.rest = job.rest * std::cbrt(job.mother.volume0 / job.volume);
    try {
      daughter = dcm::grow_daughter(job.mother.mesh, job.plane, n % 2, job.round->mesh,
                                    job.material, mine);
    } catch (std::exception &e) {
      daughter.problem = e.what();
    }
  }

  for (size_t n = 0; n < 2 * jobs.size(); n++) {
    dcm::Daughter &d = jobs[n / 2].daughter[n % 2];
    const int root = (int) (n % comm->nprocs);
    double numbers[6] = {(double) d.iterations, d.residual, d.volume, d.outside, d.quality,
                         (double) d.converged};
    MPI_Bcast(numbers, 6, MPI_DOUBLE, root, world);
    d.iterations = (int) numbers[0];
    d.residual = numbers[1];
    d.volume = numbers[2];
    d.outside = numbers[3];
    d.quality = numbers[4];
    d.converged = numbers[5] != 0.0;
    int sizes[2] = {(int) d.mesh.nodes.size(), (int) d.problem.size()};
    MPI_Bcast(sizes, 2, MPI_INT, root, world);
    d.mesh.nodes.resize(sizes[0]);
    d.problem.resize(sizes[1]);
    if (sizes[0]) MPI_Bcast(d.mesh.nodes[0].data(), 3 * sizes[0], MPI_DOUBLE, root, world);
    if (sizes[1]) MPI_Bcast(&d.problem[0], sizes[1], MPI_CHAR, root, world);
  }
}

void FixDCMDivision::check(const Job &job) const
{
  for (const auto &d : job.daughter) {
    if (!d.problem.empty() && (d.converged || d.iterations < settings.maxiter))
      error->all(
          FLERR,
          "{}: cell {} (volume {:.6}) cannot divide at step {}: {}; reduce the time step, or "
          "let the cell round up longer (fix dcm/growth rounding)",
          STYLE, job.mother.molecule, job.volume, update->ntimestep, d.problem);
    if (!d.converged)
      error->all(FLERR,
                 "{}: the sub-simulation of cell {} at step {} is not in balance after {} "
                 "iterations: largest force {:.3} of its scale, tolerance {:.3}; raise maxiter "
                 "({}) or tolerance",
                 STYLE, job.mother.molecule, update->ntimestep, d.iterations, d.residual,
                 settings.tolerance, settings.maxiter);
  }
}

/* ----------------------------------------------------------------------
   two deformable daughters at rest as round cells of half the mother's rest volume
------------------------------------------------------------------------- */

void FixDCMDivision::insert(DCMSurgery &surgery, Job &job)
{
  const auto &top = *job.round;
  DCMBuilder::Deformable daughter;
  daughter.mask = job.mother.masks;
  daughter.volume0 = 0.5 * job.mother.volume0;
  for (int k = 0; k < 3; k++) daughter.v[k] = job.mother.v[k];

  DCMBuilder::set_round_rest(top, job.rest, daughter);

  tagint molecule[2];
  for (int side = 0; side < 2; side++) {
    const dcm::Daughter &d = job.daughter[side];
    daughter.molecule = molecule[side] = growth->new_molecule();
    daughter.x = d.mesh.nodes;
    surgery.insert(job.mother.types, top, daughter);
    iterations += d.iterations;
    outside = std::max(outside, d.outside / std::cbrt(0.75 * d.volume / dcm::PI));
    quality = std::min(quality, d.quality);
  }
  ndcm++;
  write_log(job.mother, job.plane.normal, molecule, job.volume, job.daughter[0].volume,
            job.daughter[1].volume, job.daughter[0].iterations + job.daughter[1].iterations);
  growth->divide(*growth->find(job.mother.molecule), molecule[0], molecule[1], 0.5 * job.volume);
}

/* ----------------------------------------------------------------------
   two spheres of half the volume that reach no farther than the mother did
------------------------------------------------------------------------- */

void FixDCMDivision::insert_spheres(DCMSurgery &surgery, const DCMSurgery::Cell &mother)
{
  const Vec3 axis = axis_of(mother);
  DCMBuilder::Sphere daughter;
  daughter.mask = mother.masks.center;
  daughter.radius = mother.radius / std::cbrt(2.0);
  for (int k = 0; k < 3; k++) daughter.v[k] = mother.v[k];

  tagint molecule[2];
  for (int side = 0; side < 2; side++) {
    daughter.molecule = molecule[side] = growth->new_molecule();
    daughter.x = mother.x + (side == 0 ? 1.0 : -1.0) * (mother.radius - daughter.radius) * axis;
    surgery.insert(mother.types, daughter);
  }
  ncbm++;
  sisters.push_back({molecule[0], molecule[1], growth->time()});
  const double volume = sphere_volume(mother.radius);
  write_log(mother, axis, molecule, volume, 0.5 * volume, 0.5 * volume, 0);
  growth->divide(*growth->find(mother.molecule), molecule[0], molecule[1], 0.5 * volume);
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
  const double now = growth->time();
  auto relaxed = [&](const Pair &it) {
    if (!growth->find(it.molecule) || !growth->find(it.other)) return true;
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

void FixDCMDivision::write_log(const DCMSurgery::Cell &mother, const Vec3 &axis,
                               const tagint *daughters, double volume, double volume1,
                               double volume2, int niter)
{
  if (!log) return;
  const auto &it = *growth->find(mother.molecule);
  utils::print(log,
               "{} {:.10g} {} {} {} {} {} {:.8f} {:.8f} {:.8f} {:.8g} {:.8g} {:.8g} {} {:.6g} "
               "{:.6g}\n",
               update->ntimestep, growth->time(), mother.molecule, daughters[0], daughters[1],
               it.generation + 1, it.deformable ? "dcm" : "cbm", axis[0], axis[1], axis[2], volume,
               volume1, volume2, niter, it.pressure_before, it.pressure);
  fflush(log);
}

/* ---------------------------------------------------------------------- */

void FixDCMDivision::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  const bigint numbers[4] = {ndcm, ncbm, iterations, (bigint) sisters.size()};
  const double reals[2] = {outside, quality};
  const int size = (int) (sizeof(numbers) + sizeof(reals) + sisters.size() * sizeof(Pair));
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(numbers, sizeof(bigint), 4, fp);
  fwrite(reals, sizeof(double), 2, fp);
  fwrite(sisters.data(), sizeof(Pair), sisters.size(), fp);
}

void FixDCMDivision::restart(char *buf)
{
  bigint numbers[4];
  double reals[2];
  memcpy(numbers, buf, sizeof(numbers));
  memcpy(reals, buf + sizeof(numbers), sizeof(reals));
  ndcm = numbers[0];
  ncbm = numbers[1];
  iterations = numbers[2];
  outside = reals[0];
  quality = reals[1];
  sisters.resize(numbers[3]);
  memcpy((void *) sisters.data(), buf + sizeof(numbers) + sizeof(reals),
         sisters.size() * sizeof(Pair));
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
