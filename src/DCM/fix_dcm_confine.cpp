/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_confine.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_compat.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "dcm_unknowns.h"
#include "law/stiffness.h"
#include "law/vector.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "group.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/confine";
static constexpr int RECORD = 2;    // version of the restart record

// The controller integrates the error of the pressure expected LEAD tau ahead, the slope taken
// from a filter of FILTER tau. Chosen on overdamped chains: no overshoot above 2 % as long as the
// tissue's slowest relaxation time is below 4 tau.

static constexpr double LEAD = 2.0;
static constexpr double FILTER = 0.5;
static constexpr double TAU_STEPS = 500.0;    // default tau in steps
static constexpr double MIN_STEPS = 10.0;     // least tau in steps

/* ----------------------------------------------------------------------
   fix ID group dcm/confine [pressure P over GROUP [axis a] [center c1 c2] [tau t] [limit m]
                             [area A] [hold yes|no]] [plane a k [at v] [group GROUP]]
------------------------------------------------------------------------- */

FixDCMConfine::FixDCMConfine(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), target(0.0), measured_bit(0),
    axis(2), center{0.0, 0.0, 0.0}, tau(0.0), limit(10.0), outer_area(0.0), force(0.0),
    reference(0.0), smooth(0.0), started(false), warned(false), hold(false), plane(-1), spring(0.0),
    at(0.0), plane_bit(groupbit), energy(0.0), farthest(0.0)
{
  dcm = AtomVecDCM::require(lmp, STYLE);

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3,
               {"pressure", "over", "axis", "center", "tau", "limit", "area", "plane", "at",
                "group", "hold"});
  double offset[2] = {0.0, 0.0};
  std::string of_pressure, of_plane;    // keywords that need the other one
  while (args.next()) {
    if (args.is("pressure")) {
      target = args.number(DCMArgs::POSITIVE);
      continue;
    }
    if (args.is("plane")) {
      args.need(2);
      plane = args.axis();
      spring = args.number(DCMArgs::POSITIVE, "plane force constant");
      continue;
    }
    (args.is("at") || args.is("group") ? of_plane : of_pressure) = args.keyword();
    if (args.is("over")) {
      measured = args.text();
    } else if (args.is("axis")) {
      axis = args.axis();
    } else if (args.is("center")) {
      args.need(2);
      for (double &component : offset) component = args.number();
    } else if (args.is("tau")) {
      tau = args.number(DCMArgs::POSITIVE);
    } else if (args.is("limit")) {
      limit = args.number(DCMArgs::POSITIVE);
    } else if (args.is("area")) {
      outer_area = args.number(DCMArgs::POSITIVE);
    } else if (args.is("hold")) {
      hold = args.choose({"no", "yes"}) == 1;
    } else if (args.is("at")) {
      at = args.number();
    } else {
      held = args.text();
    }
  }
  if (target == 0.0 && plane < 0)
    error->all(FLERR, "{}: give 'pressure P over GROUP', 'plane x|y|z K' or both", STYLE);
  if (target == 0.0 && !of_pressure.empty())
    error->all(FLERR, "{}: keyword {} needs keyword pressure", STYLE, of_pressure);
  if (plane < 0 && !of_plane.empty())
    error->all(FLERR, "{}: keyword {} needs keyword plane", STYLE, of_plane);
  if (target > 0.0 && measured.empty())
    error->all(FLERR, "{}: pressure needs 'over GROUP', the cells whose mean pressure is driven",
               STYLE);

  // the two coordinates across the axis, in the order x y z

  for (int k = 0, n = 0; k < 3; k++)
    if (k != axis) center[k] = offset[n++];

  scalar_flag = vector_flag = 1;
  size_vector = 3;
  extscalar = 1;
  extvector = 0;
  global_freq = 1;
  energy_global_flag = 1;
  restart_global = target > 0.0;
}

/* ----------------------------------------------------------------------
   forces are added before the reverse communication rather than in post_force:
   in setup() the velocities may be solved for before this fix's turn comes
------------------------------------------------------------------------- */

int FixDCMConfine::setmask()
{
  return INITIAL_INTEGRATE | PRE_REVERSE | MIN_PRE_REVERSE;
}

/* ---------------------------------------------------------------------- */

void FixDCMConfine::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  if (!held.empty()) plane_bit = dcm_find_group(lmp, std::string(STYLE) + ": group", held);
  const auto cells = {AtomVecDCM::CENTER, AtomVecDCM::SPHERE};
  if (target != 0.0) dcm_check_group(lmp, STYLE, igroup, cells);
  if (plane >= 0) dcm_check_group(lmp, STYLE, held.empty() ? igroup : group->find(held), cells);
  if (target == 0.0) return;
  measured_bit = dcm_find_group(lmp, std::string(STYLE) + ": over", measured);
  if (!(traits_of(lmp) & GIVES_PRESSURE))
    error->all(FLERR, "{}: pressure needs a fix dcm/volume, without it cells have no pressure",
               STYLE);
  if (!hold && tau > 0.0 && tau < MIN_STEPS * update->dt && !(traits_of(lmp) & CHOOSES_STEP))
    error->all(FLERR, "{}: tau is {}, must be at least {} time steps of {}", STYLE, tau, MIN_STEPS,
               update->dt);
}

/* ----------------------------------------------------------------------
   errors before the first step
------------------------------------------------------------------------- */

void FixDCMConfine::setup(int /*vflag*/)
{
  if (target == 0.0) return;
  bool any = false;
  for (const int c : cell->cells().all_deformable())
    any = any || (cell->cells()[c].mask & measured_bit);
  if (!any) error->all(FLERR, "{}: no deformable cell has its center in group {}", STYLE, measured);
  if (!started) estimate_reference();
}

void FixDCMConfine::setup_pre_reverse(int eflag, int vflag)
{
  pre_reverse(eflag, vflag);
}

/* ----------------------------------------------------------------------
   vector from the axis to a cell
------------------------------------------------------------------------- */

void FixDCMConfine::radial(const double *x, double *d) const
{
  for (int k = 0; k < 3; k++) d[k] = k == axis ? 0.0 : x[k] - center[k];
  dcm_minimum_image(domain, d[0], d[1], d[2]);
}

/* ----------------------------------------------------------------------
   force per cell that balances the target pressure on the tissue's outer surface:
   a cylinder as high as the mean cell, through the outside of the cells pushed on
------------------------------------------------------------------------- */

void FixDCMConfine::estimate_reference()
{
  double sums[3] = {0.0, 0.0, 0.0};    // number, distance from the axis, diameter
  double d[3];
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::SPHERE || !(atom->mask[i] & groupbit)) continue;
    radial(atom->x[i], d);
    sums[0] += 1.0;
    sums[1] += dcm::vec(d).norm();
    sums[2] += 2.0 * atom->radius[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, world);
  cell->update_all();
  for (const int c : cell->cells().all_deformable()) {
    const auto &it = cell->cells()[c];
    if (!(it.mask & groupbit)) continue;
    radial(it.x, d);
    sums[0] += 1.0;
    sums[1] += dcm::vec(d).norm();
    sums[2] += std::cbrt(6.0 * it.volume / dcm::PI);
  }
  if (sums[0] == 0.0)
    error->all(FLERR, "{}: no cell (sphere or center atom) is in group {}", STYLE,
               group->names[igroup]);
  const double radius = sums[1] / sums[0], height = sums[2] / sums[0];
  reference =
      target *
      (outer_area > 0.0 ? outer_area : 2.0 * dcm::PI * (radius + 0.5 * height) * height / sums[0]);
}

/* ---------------------------------------------------------------------- */

double FixDCMConfine::mean_pressure() const
{
  double sums[2] = {0.0, 0.0};    // of pressures, number
  const auto &table = cell->cells();
  int field = 0;
  const auto pressure = table.column("pressure", field);
  if (!pressure) return 0.0;
  for (const int c : cell->owned_cells()) {
    if (!(table[c].mask & measured_bit)) continue;
    sums[0] += (*pressure)(c);
    sums[1] += 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, world);
  return sums[1] > 0.0 ? sums[0] / sums[1] : 0.0;
}

/* ----------------------------------------------------------------------
   integral controller:  df/dt = (f_ref/tau) (1 - (p + LEAD tau dp/dt)/P)
   bounded rate (|df/dt| <= f_ref/tau) and range (0 to limit f_ref); it starts with
   the estimate for the part of the pressure that is missing
------------------------------------------------------------------------- */

void FixDCMConfine::initial_integrate(int /*vflag*/)
{
  if (target == 0.0) return;
  const double p = mean_pressure();
  const double most = limit * reference;

  if (!started) {
    started = true;
    smooth = p;
    if (!hold) force = std::min(reference * std::max(0.0, 1.0 - p / target), most);
    return;
  }
  if (hold) {
    smooth = p;    // to go on from here when it is let go
    return;
  }

  const double dt = update->dt;
  const double t = tau > 0.0 ? tau : TAU_STEPS * dt;
  const double slope = (p - smooth) / (FILTER * t);
  smooth += dt * slope;
  const double deviation = 1.0 - (p + LEAD * t * slope) / target;
  force += dt / t * reference * std::max(-1.0, std::min(1.0, deviation));
  force = std::max(0.0, std::min(force, most));

  if (force == most && !warned) {
    warned = true;
    if (comm->me == 0)
      error->warning(
          FLERR,
          "{}: the inward force has reached its limit, {} per cell, while the mean "
          "pressure is {} of {}: the group may not enclose the tissue; see keyword limit",
          STYLE, force, p, target);
  }
}

/* ----------------------------------------------------------------------
   the controller is explicit: it needs steps well below its time constant
------------------------------------------------------------------------- */

double FixDCMConfine::longest_step()
{
  return target > 0.0 && !hold && tau > 0.0 ? tau / MIN_STEPS : DCMRole::longest_step();
}

/* ----------------------------------------------------------------------
   force on a cell at x
------------------------------------------------------------------------- */

void FixDCMConfine::add_force(const double *x, int mask, double *f)
{
  f[0] = f[1] = f[2] = 0.0;
  if (force > 0.0 && (mask & groupbit)) {
    double d[3];
    radial(x, d);
    const double r = dcm::vec(d).norm();
    if (r > 0.0) dcm::vec(f) = (-force / r) * dcm::vec(d);
  }
  if (plane >= 0 && (mask & plane_bit)) {
    double d[3] = {0.0, 0.0, 0.0};
    d[plane] = x[plane] - at;
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    f[plane] -= spring * d[plane];
    energy += 0.5 * spring * d[plane] * d[plane];
    farthest = std::max(farthest, std::fabs(d[plane]));
  }
}

/* ---------------------------------------------------------------------- */

/* ----------------------------------------------------------------------
   cells of the groups on this process, while there is a force on them
------------------------------------------------------------------------- */

bool FixDCMConfine::any_held() const
{
  const int bits = (force > 0.0 ? groupbit : 0) | (plane >= 0 ? plane_bit : 0);
  if (bits == 0) return false;
  const auto &table = cell->cells();
  const auto &rows = table.deformable();
  const auto held = [bits](int mask) {
    return (mask & bits) != 0;
  };
  return std::any_of(rows.begin(), rows.end(),
                     [&](int c) {
                       return held(table[c].mask);
                     }) ||
         std::any_of(atom->mask, atom->mask + atom->nlocal, held);
}

void FixDCMConfine::pre_reverse(int /*eflag*/, int /*vflag*/)
{
  energy = farthest = 0.0;
  if (!any_held()) return;

  // the energy of a cell counts where its center is

  const auto &table = cell->cells();
  if (cell_force.size() < 3 * (size_t) table.size()) cell_force.resize(3 * table.size());
  for (const int c : cell->owned_cells()) add_force(table[c].x, table[c].mask, &cell_force[3 * c]);
  const double counted = energy;
  for (const int c : table.deformable()) {
    const auto &it = table[c];
    add_force(it.x, it.mask, &cell_force[3 * c]);
    if (it.nnodes > 0) dcm::vec(&cell_force[3 * c]) /= it.nnodes;
  }
  energy = counted;

  double **f = atom->f;
  const int *const kind = dcm->kind;
  for (int i = 0; i < atom->nlocal; i++) {
    if (kind[i] == AtomVecDCM::NODE) {
      dcm::vec(f[i]) += dcm::vec(&cell_force[3 * cell->cell_of(i)]);
    } else if (kind[i] == AtomVecDCM::SPHERE) {
      double fi[3];
      add_force(atom->x[i], atom->mask[i], fi);
      dcm::vec(f[i]) += dcm::vec(fi);
    }
  }
}

/* ----------------------------------------------------------------------
   of the plane: a cell is held by the mean of its nodes, a sphere by its center
------------------------------------------------------------------------- */

void FixDCMConfine::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  if (plane < 0) return;
  for (int s = 1; s <= unknowns.nowned(); s++) {
    const int i = unknowns.atom_of(s);
    if (dcm->kind[i] != AtomVecDCM::SPHERE || !(atom->mask[i] & plane_bit)) continue;
    dcm::EdgeBlock block = {s, 0, 0.0, spring, {0.0, 0.0, 0.0}};
    block.e[plane] = 1.0;
    system.edges.push_back(block);
  }
  const auto &table = cell->cells();
  const int field = system.add_field(table.size());
  for (const int c : table.deformable()) {
    if (!(table[c].mask & plane_bit)) continue;
    const size_t begin = system.members.size();
    for (const int s : unknowns.nodes_of(c)) system.members.push_back(s);
    system.means.push_back({begin, system.members.size(), spring,
                            1.0 / std::max(1, table[c].nnodes), plane, c, field});
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMConfine::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(started);
  record.put(force);
  record.put(reference);
  record.put(smooth);
  record.put(hold);
  record.write(fp);
}

void FixDCMConfine::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(started);
  record.get(force);
  record.get(reference);
  record.get(smooth);
  record.get(hold);
}

/* ----------------------------------------------------------------------
   fix_modify ID hold yes|no
------------------------------------------------------------------------- */

int FixDCMConfine::modify_param(int narg, char **arg)
{
  if (strcmp(arg[0], "hold") != 0) return 0;
  if (narg < 2) utils::missing_cmd_args(FLERR, "fix_modify hold", error);
  if (target == 0.0)
    error->all(FLERR, "{}: fix_modify {} hold needs keyword pressure in the fix", STYLE, id);
  if (strcmp(arg[1], "yes") != 0 && strcmp(arg[1], "no") != 0)
    error->all(FLERR, "{}: fix_modify {} hold must be yes or no, not {}", STYLE, id, arg[1]);
  hold = strcmp(arg[1], "yes") == 0;
  return 2;
}

/* ----------------------------------------------------------------------
   energy of the plane penalty
------------------------------------------------------------------------- */

double FixDCMConfine::compute_scalar()
{
  double all;
  MPI_Allreduce(&energy, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   inward force per cell, mean pressure, largest distance from the plane
------------------------------------------------------------------------- */

double FixDCMConfine::compute_vector(int i)
{
  if (i == 0) return force;
  if (i == 1) return target > 0.0 ? mean_pressure() : 0.0;
  double all;
  MPI_Allreduce(&farthest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

/* ---------------------------------------------------------------------- */

double FixDCMConfine::memory_usage()
{
  return (double) cell_force.capacity() * sizeof(double);
}
