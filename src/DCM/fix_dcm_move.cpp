/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_move.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "domain.h"
#include "error.h"
#include "input.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/move";

/* ----------------------------------------------------------------------
   fix ID group dcm/move [linear Vx Vy Vz] [rotate Px Py Pz Rx Ry Rz rate]
   velocities and rate may be v_NAME
------------------------------------------------------------------------- */

FixDCMMove::FixDCMMove(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), varies(false), turns(false), mine{}, all{}, summed(true)
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"linear", "rotate"});
  parse(args);
  dynamic_group_allow = 0;
  vector_flag = 1;
  size_vector = 6;
  extvector = 0;
  global_freq = 1;
}

void FixDCMMove::parse(DCMArgs &args)
{
  if (args.left() == 0)
    error->all(FLERR,
               "{}: give 'linear Vx Vy Vz', 'rotate Px Py Pz Rx Ry Rz rate' or both; a body that "
               "stays where it is needs no fix",
               STYLE);
  const auto take = [&](Given &one) {
    one = Given();
    const char *const next = args.ahead();
    if (next && utils::strmatch(next, "^v_.")) {
      one.variable = args.text() + 2;
      varies = true;
    } else {
      one.value = args.number();
    }
  };
  while (args.next()) {
    if (args.is("linear")) {
      args.need(3);
      for (int k = 0; k < 3; k++) take(given[k]);
    } else {
      args.need(7);
      for (int k = 0; k < 3; k++) motion.point[k] = args.number();
      for (int k = 0; k < 3; k++) motion.axis[k] = args.number();
      args.check(motion.axis.norm() > 0.0, "part of an axis that is not 0 0 0");
      motion.axis.normalize();
      take(given[RATE]);
      turns = true;
    }
  }
}

int FixDCMMove::setmask()
{
  return FINAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixDCMMove::init()
{
  if (!(traits_of(lmp) & MOVES))
    error->all(FLERR, "{} {}: there is no fix dcm/motion, which would move anything", STYLE, id);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::NODE, AtomVecDCM::SPHERE});
  check_before_motion(lmp, this, STYLE);
  for (const auto &one : given) {
    if (one.variable.empty()) continue;
    const int ivar = input->variable->find(one.variable.c_str());
    if (ivar < 0 || !input->variable->equalstyle(ivar))
      error->all(FLERR, "{}: there is no equal-style variable {}", STYLE, one.variable);
  }
  int others = 0;
  for (auto *const fix : modify->get_fix_list()) {
    const auto *const role = dynamic_cast<DCMRole *>(fix);
    if (role && fix != this) others |= role->moved_bits();
  }
  int twice = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    const int kind = dcm->kind[i];
    if ((kind == AtomVecDCM::NODE || kind == AtomVecDCM::SPHERE) && (atom->mask[i] & groupbit) &&
        (atom->mask[i] & others))
      twice = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, &twice, 1, MPI_INT, MPI_MAX, world);
  if (twice)
    error->all(FLERR,
               "{} {}: some of its nodes or spheres are in the group of another fix dcm/move; "
               "'linear' and 'rotate' of one fix add up",
               STYLE, id);
}

/* ----------------------------------------------------------------------
   the velocity of the coming step, before fix dcm/motion solves for that of the others
------------------------------------------------------------------------- */

void FixDCMMove::setup(int /*vflag*/)
{
  take_velocity();
}

void FixDCMMove::final_integrate()
{
  if (varies) take_velocity();
}

void FixDCMMove::take_velocity()
{
  if (varies) modify->clearstep_compute();
  for (auto &one : given) {
    if (one.variable.empty()) continue;
    const int ivar = input->variable->find(one.variable.c_str());
    one.value = input->variable->compute_equal(ivar);
    if (!std::isfinite(one.value))
      error->all(FLERR, "{}: variable {} gives the velocity {} at step {}; it must be a number",
                 STYLE, one.variable, one.value, update->ntimestep);
  }
  if (varies) modify->addstep_compute(update->ntimestep + 1);
  for (int k = 0; k < 3; k++) motion.velocity[k] = given[k].value;
  motion.rate = given[RATE].value;
}

void FixDCMMove::move_body(int i, double dt, double *v)
{
  double x[3];
  domain->unmap(atom->x[i], atom->image[i], x);
  vec(v) = motion.mean_velocity(vec(static_cast<const double *>(x)), dt);
}

/* ---------------------------------------------------------------------- */

void FixDCMMove::begin_load()
{
  std::fill(mine, mine + NSUM, 0.0);
  summed = false;
}

void FixDCMMove::add_load(int i, const double *force)
{
  double x[3];
  domain->unmap(atom->x[i], atom->image[i], x);
  const Vec3 place(x[0], x[1], x[2]);
  vec(&mine[0]) += vec(force);
  vec(&mine[3]) += place.cross(vec(force));
  vec(&mine[6]) += place;
  mine[9] += 1.0;
}

/* ----------------------------------------------------------------------
   force on the bodies, torque about the point of rotate, or about their middle
------------------------------------------------------------------------- */

double FixDCMMove::compute_vector(int n)
{
  if (!summed) MPI_Allreduce(mine, all, NSUM, MPI_DOUBLE, MPI_SUM, world);
  summed = true;
  if (n < 3) return all[n];
  const Vec3 middle = turns ? motion.point : Vec3(vec(&all[6]) / std::max(1.0, all[9]));
  const Vec3 torque = vec(&all[3]) - middle.cross(vec(&all[0]));
  return torque[n - 3];
}
