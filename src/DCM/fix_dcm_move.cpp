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
#include "modify.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/move";

/* ----------------------------------------------------------------------
   fix ID group dcm/move [linear Vx Vy Vz] [rotate Px Py Pz Rx Ry Rz rate]
   components of the velocity and the rate may be v_NAME
------------------------------------------------------------------------- */

FixDCMMove::FixDCMMove(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), turns(false), mine{}, all{}, summed(true)
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
  while (args.next()) {
    if (args.is("linear")) {
      args.need(3);
      for (auto &component : linear) component.parse(args, "velocity");
    } else {
      args.need(7);
      for (int k = 0; k < 3; k++) motion.point[k] = args.number();
      for (int k = 0; k < 3; k++) motion.axis[k] = args.number();
      args.check(motion.axis.norm() > 0.0, "part of an axis that is not 0 0 0");
      motion.axis.normalize();
      rate.parse(args, "rate");
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
  for (auto &component : linear) component.find(lmp, STYLE);
  rate.find(lmp, STYLE);
  check_others();
}

void FixDCMMove::check_others() const
{
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
  final_integrate();
}

void FixDCMMove::final_integrate()
{
  DCMValue::evaluate(lmp, STYLE, {&linear[0], &linear[1], &linear[2], &rate}, igroup);
}

void FixDCMMove::move_body(int i, double dt, double *v)
{
  double x[3];
  domain->unmap(atom->x[i], atom->image[i], x);
  for (int k = 0; k < 3; k++) {
    linear[k].check(lmp, STYLE, i);
    motion.velocity[k] = linear[k](i);
  }
  rate.check(lmp, STYLE, i);
  motion.rate = rate(i);
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
