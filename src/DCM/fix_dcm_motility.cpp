/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_motility.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_deck_check.h"
#include "law/random.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/motility";
static constexpr bigint LARGEST_SEED = 1LL << 53;    // whole numbers of a double
static constexpr double MISSING = -1.0;
static constexpr double WHOLE = 1.0e-6;     // round-off of a number of timesteps or intervals
static constexpr double UNSET = 1.0e300;    // state of a cell that has not been drawn yet

/* ----------------------------------------------------------------------
   fix ID group dcm/motility [FILE name1..nameN] seed S [D v] [friction_ecm v]
                             [interval T] [bias x y z F] [persistence tau] [plane x|y|z]
------------------------------------------------------------------------- */

FixDCMMotility::FixDCMMotility(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), parameters(lmp, STYLE, {"D", "friction_ecm"}), seed(0),
    interval(0.0), persistence(0.0), bias{0.0, 0.0, 0.0}, plane(-1), state(nullptr)
{
  dcm = AtomVecDCM::require(lmp, STYLE);

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"seed", "interval", "bias", "persistence", "plane"});
  parameters.parse(args, atom->ntypes);
  bool has_seed = false;
  while (args.next()) {
    if (parameters.parse_keyword(args)) continue;
    if (args.is("seed")) {
      seed = args.whole(0, LARGEST_SEED);
      has_seed = true;
    } else if (args.is("interval")) {
      interval = args.number(DCMArgs::POSITIVE);
    } else if (args.is("bias")) {
      args.need(4);
      for (double &component : bias) component = args.number();
      const double size = args.number(DCMArgs::NONNEGATIVE, "bias force");
      const double norm = dcm::vec(bias).norm();
      if (norm == 0.0) error->all(FLERR, "{}: the direction of bias is zero", STYLE);
      dcm::vec(bias) *= size / norm;
    } else if (args.is("persistence")) {
      persistence = args.number(DCMArgs::POSITIVE);
    } else {
      plane = args.axis();
    }
  }
  if (!has_seed) error->all(FLERR, "{}: add 'seed S', an integer", STYLE);

  if (persistence > 0.0) {
    restart_peratom = 1;
    create_attribute = 1;
    maxexchange = 3;
    FixDCMMotility::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; i++) FixDCMMotility::set_arrays(i);
  }
}

/* ---------------------------------------------------------------------- */

FixDCMMotility::~FixDCMMotility()
{
  if (persistence > 0.0) {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
  }
  memory->destroy(state);
}

/* ----------------------------------------------------------------------
   forces are added before the reverse communication rather than in post_force:
   in setup() the velocities may be solved for before this fix's turn comes
------------------------------------------------------------------------- */

int FixDCMMotility::setmask()
{
  return INITIAL_INTEGRATE | PRE_REVERSE;
}

/* ---------------------------------------------------------------------- */

void FixDCMMotility::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
  parameters.resolve();
  read_types();
  const double parts = interval / update->dt;
  if (interval > 0.0 && !(traits_of(lmp) & (CHOOSES_STEP | SHORTENS_STEP)) &&
      !(parts > 0.5 && std::fabs(parts - std::round(parts)) < WHOLE * parts))
    error->all(FLERR,
               "{}: interval {} is no multiple of the timestep {}; choose one that is, or let fix "
               "dcm/motion choose steps that end with it (dt auto)",
               STYLE, interval, update->dt);
  bool unnamed = false;
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::SPHERE && moves(i) && atom->molecule[i] <= 0) unnamed = true;
  if (unnamed)
    error->one(FLERR,
               "{}: a sphere has no molecule ID, so its random numbers are not its own; give "
               "each cell a positive molecule ID",
               STYLE);
}

/* ----------------------------------------------------------------------
   only types of cells need values, so that one list of names can serve all styles; cells of the
   others may come later, and then they are missed
------------------------------------------------------------------------- */

void FixDCMMotility::read_types()
{
  const auto holding =
      AtomVecDCM::types_holding(lmp, {AtomVecDCM::SPHERE, AtomVecDCM::CENTER}, groupbit);
  const auto NONNEGATIVE = DCMParameters::NONNEGATIVE, POSITIVE = DCMParameters::POSITIVE;
  types.assign(atom->ntypes + 1, Type());
  for (int i = 1; i <= atom->ntypes; i++) {
    Type &type = types[i];
    type.used = parameters.used(i);
    if (!type.used) continue;
    type.D = holding[i] ? parameters.get(i, "D", NONNEGATIVE)
                        : parameters.get(i, "D", NONNEGATIVE, MISSING);
    type.friction = holding[i] ? parameters.get(i, "friction_ecm", POSITIVE)
                               : parameters.get(i, "friction_ecm", POSITIVE, MISSING);
    // cells that neither diffuse nor are driven are left alone
    if (type.D == 0.0 && dcm::vec(bias).isZero(0.0)) type.used = false;
  }
}

void FixDCMMotility::check(int itype) const
{
  const Type &type = types[itype];
  if (type.D != MISSING && type.friction != MISSING) return;
  error->one(
      FLERR,
      "{}: no value of {} for cell type {}, of which there are cells since step {}; add it to the "
      "parameter file or give the keyword",
      STYLE, type.D == MISSING ? "D" : "friction_ecm", parameters.name(itype), update->ntimestep);
}

void FixDCMMotility::setup_pre_reverse(int eflag, int vflag)
{
  pre_reverse(eflag, vflag);
}

/* ----------------------------------------------------------------------
   is this atom a sphere or center this fix acts on
------------------------------------------------------------------------- */

bool FixDCMMotility::moves(int i) const
{
  return (dcm->kind[i] == AtomVecDCM::SPHERE || dcm->kind[i] == AtomVecDCM::CENTER) &&
         types[atom->type[i]].used && (atom->mask[i] & groupbit);
}

/* ----------------------------------------------------------------------
   what a force is held for: an interval of time, or a step
------------------------------------------------------------------------- */

bigint FixDCMMotility::number_of_interval(double time) const
{
  return (bigint) std::floor(time / interval + WHOLE);
}

double FixDCMMotility::next_event()
{
  if (interval == 0.0) return DCMRole::next_event();
  const double now = cell->cells().time();
  return (double) (number_of_interval(now) + 1) * interval - now;
}

/* ----------------------------------------------------------------------
   three standard normal numbers of a cell, now
------------------------------------------------------------------------- */

void FixDCMMotility::draw(tagint molecule, double *xi) const
{
  const bigint number = interval > 0.0 ? number_of_interval(cell->cells().time())
                                       : update->ntimestep;
  dcm::Random random(seed, molecule, number, dcm::RandomPurpose::MOTILITY);
  dcm::vec(xi) = random.gaussian_vector();
}

/* ----------------------------------------------------------------------
   standard deviation of the force that gives the diffusion constant D when held
   for a time T; with persistence, when correlated from one T to the next by
   a = exp(-T/tau): the sum over all correlations is (1+a)/(1-a) = coth(T/(2 tau))
------------------------------------------------------------------------- */

double FixDCMMotility::amplitude(const Type &type, double area) const
{
  const double held = held_for();
  double variance = 2.0 * type.D / held;
  if (persistence > 0.0) variance *= std::tanh(0.5 * held / persistence);
  return type.friction * area * std::sqrt(variance);
}

/* ----------------------------------------------------------------------
   Ornstein-Uhlenbeck process, exact for any time step; here and not with the
   forces, so that setup() does not advance it
------------------------------------------------------------------------- */

void FixDCMMotility::initial_integrate(int /*vflag*/)
{
  if (persistence == 0.0) return;
  if (interval > 0.0) {    // does another begin with the end of this step?
    const double end = cell->cells().time();
    if (number_of_interval(end) == number_of_interval(end - update->dt)) return;
  }
  const double a = std::exp(-held_for() / persistence);
  const double b = std::sqrt(-std::expm1(-2.0 * held_for() / persistence));
  for (int i = 0; i < atom->nlocal; i++) {
    if (!moves(i) || state[i][0] == UNSET) continue;
    double xi[3];
    draw(atom->molecule[i], xi);
    for (int k = 0; k < 3; k++) state[i][k] = a * state[i][k] + b * xi[k];
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMMotility::pre_reverse(int /*eflag*/, int /*vflag*/)
{
  if (std::none_of(types.begin(), types.end(), [](const Type &it) {
        return it.used;
      }))
    return;
  const int nlocal = atom->nlocal;
  const auto &table = cell->cells();
  const auto &rows = table.all_deformable();
  const bool cells = std::any_of(rows.begin(), rows.end(), [&](int c) {
    return types[table[c].type].used && (table[c].mask & groupbit);
  });
  const auto in_group = [this](int mask) {
    return (mask & groupbit) != 0;
  };
  if (!cells && std::none_of(atom->mask, atom->mask + nlocal, in_group)) return;

  // random part in units of its standard deviation: each rank draws those of all cells itself, but
  // with persistence only the owner of the center has it

  cell->begin_sum(cell_force, 3);
  if (persistence > 0.0) {
    for (int i = 0; i < nlocal; i++) {
      if (!moves(i)) continue;
      if (state[i][0] == UNSET) draw(atom->molecule[i], state[i]);
      if (dcm->kind[i] == AtomVecDCM::CENTER)
        dcm::vec(&cell_force[3 * cell->cell_of(i)]) = dcm::vec(state[i]);
    }
    cell->sum_owned(cell_force, 3);
  }

  for (const int c : table.deformable()) {
    const auto &it = table[c];
    double *const fc = &cell_force[3 * c];
    if (!types[it.type].used || !(it.mask & groupbit) || it.nnodes == 0) continue;
    check(it.type);
    if (persistence == 0.0) draw(it.molecule, fc);
    if (plane >= 0) fc[plane] = 0.0;
    dcm::vec(fc) *= amplitude(types[it.type], it.area);
    dcm::vec(fc) += dcm::vec(bias);
    dcm::vec(fc) /= it.nnodes;
  }

  double **f = atom->f;
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] == AtomVecDCM::NODE) {
      dcm::vec(f[i]) += dcm::vec(&cell_force[3 * cell->cell_of(i)]);
    } else if (dcm->kind[i] == AtomVecDCM::SPHERE && moves(i)) {
      check(atom->type[i]);
      double fi[3];
      if (persistence > 0.0)
        dcm::vec(fi) = dcm::vec(state[i]);
      else
        draw(atom->molecule[i], fi);
      if (plane >= 0) fi[plane] = 0.0;
      const double radius = atom->radius[i];
      dcm::vec(fi) *= amplitude(types[atom->type[i]], 4.0 * dcm::PI * radius * radius);
      dcm::vec(f[i]) += dcm::vec(fi) + dcm::vec(bias);
    }
  }
}

/* ----------------------------------------------------------------------
   per-atom state, only with persistence
------------------------------------------------------------------------- */

void FixDCMMotility::grow_arrays(int nmax)
{
  memory->grow(state, nmax, 3, "dcm/motility:state");
}

void FixDCMMotility::copy_arrays(int i, int j, int /*delflag*/)
{
  for (int k = 0; k < 3; k++) state[j][k] = state[i][k];
}

void FixDCMMotility::set_arrays(int i)
{
  state[i][0] = UNSET;
  state[i][1] = state[i][2] = 0.0;
}

int FixDCMMotility::pack_exchange(int i, double *buf)
{
  for (int k = 0; k < 3; k++) buf[k] = state[i][k];
  return 3;
}

int FixDCMMotility::unpack_exchange(int nlocal, double *buf)
{
  for (int k = 0; k < 3; k++) state[nlocal][k] = buf[k];
  return 3;
}

int FixDCMMotility::pack_restart(int i, double *buf)
{
  buf[0] = 4;    // number of values, this one included
  for (int k = 0; k < 3; k++) buf[1 + k] = state[i][k];
  return 4;
}

void FixDCMMotility::unpack_restart(int nlocal, int nth)
{
  double **extra = atom->extra;
  int m = 0;
  for (int i = 0; i < nth; i++) m += static_cast<int>(extra[nlocal][m]);
  m++;
  for (int k = 0; k < 3; k++) state[nlocal][k] = extra[nlocal][m++];
}

int FixDCMMotility::size_restart(int /*nlocal*/)
{
  return 4;
}

int FixDCMMotility::maxsize_restart()
{
  return 4;
}

/* ---------------------------------------------------------------------- */

double FixDCMMotility::memory_usage()
{
  double bytes = (double) cell_force.capacity() * sizeof(double);
  if (persistence > 0.0) bytes += (double) atom->nmax * 3 * sizeof(double);
  return bytes;
}
