/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// the friction system of fix dcm/motion: who contributes to it, its own part, and what bodies that
// others move do in it

#include "fix_dcm_motion.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "math_const.h"
#include "update.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using dcm::STRIDE;
using MathConst::MY_4PI;

static const char STYLE[] = "Fix dcm/motion";
static constexpr double BIG = std::numeric_limits<double>::max();

/* ----------------------------------------------------------------------
   after a rebuild of the neighbor lists: number the unknowns; contributors list what stays until
the next rebuild and ask for the ghosts that it touches
------------------------------------------------------------------------- */

void FixDCMMotion::make_slots()
{
  owner.clear();
  if (comm->nprocs > 1) {
    owner.assign(atom->nlocal + atom->nghost, comm->me);
    comm->forward_comm(this, 1);
  }
  unknowns.number(moving, owner);
  solver.given.clear();
  if (!movers.empty())
    for (int s = 1; s <= system.nowned; s++)
      if (mover_of(unknowns.atom_of(s))) solver.given.push_back(s);
  messages.cells = &cell->shared_cells();

  face_slots.resize(3 * (size_t) cell->nowned());
  for (int f = 0; f < cell->nowned(); f++)
    for (int k = 0; k < 3; k++) face_slots[3 * (size_t) f + k] = unknowns(cell->faces()[f].v[k]);

  system.iso_edges.clear();
  for (auto *const role : roles) role->list_friction(system, unknowns);
  stale = false;
}

int FixDCMMotion::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  for (int i = 0; i < n; i++) buf[i] = owner[list[i]];
  return n;
}

void FixDCMMotion::unpack_forward_comm(int n, int first, double *buf)
{
  for (int i = 0; i < n; i++) owner[first + i] = buf[i];
}

/* ----------------------------------------------------------------------
   the blocks of this step
------------------------------------------------------------------------- */

void FixDCMMotion::assemble()
{
  if (stale) make_slots();
  system.edges.clear();
  system.contacts.clear();
  for (auto *const role : roles) role->add_friction(system, unknowns);
  if (implicit) {
    stiffness.clear();
    for (auto *const role : roles) role->add_stiffness(stiffness, unknowns);
  }
  unknowns.send_requests();
  add_ecm();
  system.merge();
  if (implicit) stiffness.merge();

  ahead_forces.clear();    // come in look_ahead()
  const size_t n = (size_t) system.nall + 1;
  rhs.assign(STRIDE * n, 0.0);
  velocity.assign(STRIDE * n, 0.0);
  double **f = atom->f, **v = atom->v;
  for (int s = 1; s <= system.nowned; s++) {
    const int i = unknowns.atom_of(s);
    for (int k = 0; k < 3; k++) {
      rhs[STRIDE * (size_t) s + k] = f[i][k];
      velocity[STRIDE * (size_t) s + k] = v[i][k];
    }
  }
}

/* ----------------------------------------------------------------------
   ECM friction acts on the free surface: one third of each incident face's for a node. A small
   share of the whole area always counts as free, see the doc page
------------------------------------------------------------------------- */

void FixDCMMotion::add_ecm()
{
  system.ecm.assign((size_t) system.nall + 1, 0.0);
  const double *covered = nullptr;
  for (const auto *const role : roles)
    if (!covered) covered = role->covered_area();
  const int *type = atom->type;

  auto free_area = [&](int i, double area) {
    return covered ? std::max(area - covered[i], least_free * area) : area;
  };
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    const double share = free_area(face.atom, cell->area(f)) / 3.0;
    for (int k = 0; k < 3; k++)
      system.ecm[face_slots[3 * (size_t) f + k]] += friction[type[face.v[k]]] * share;
  }
  for (int s = 1; s <= system.nowned; s++) {
    const int i = unknowns.atom_of(s);
    if (dcm->kind[i] != AtomVecDCM::SPHERE) continue;
    const double r = atom->radius[i];
    system.ecm[s] += friction[type[i]] * free_area(i, MY_4PI * r * r);
  }
  for (const int s : solver.given) system.ecm[s] = 0.0;    // it is no load of the body
}

/* ----------------------------------------------------------------------
   those who move bodies
------------------------------------------------------------------------- */

void FixDCMMotion::find_movers()
{
  movers.clear();
  moving = groupbit;
  for (auto *const role : roles) {
    const int bits = role->moved_bits();
    if (bits == 0) continue;
    int any = 0;
    for (int i = 0; i < atom->nlocal; i++)
      if (unknowns.moves(i, bits)) any = 1;
    MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
    if (!any) continue;
    movers.push_back(role);
    moving |= bits;
  }

  // what does not move and has one velocity has it from command velocity, and loses it in silence:
  // that of what moved in an earlier run differs from place to place

  double extent[7] = {-BIG, -BIG, -BIG, -BIG, -BIG, -BIG, 0.0};    // largest of v, of -v; number
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE && dcm->kind[i] != AtomVecDCM::SPHERE) continue;
    if (atom->mask[i] & moving) continue;
    extent[6] = 1.0;
    for (int k = 0; k < 3; k++) {
      extent[k] = std::max(extent[k], atom->v[i][k]);
      extent[3 + k] = std::max(extent[3 + k], -atom->v[i][k]);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, extent, 7, MPI_DOUBLE, MPI_MAX, world);
  if (extent[6] == 0.0 || comm->me != 0) return;
  bool same = true, rest = true;
  for (int k = 0; k < 3; k++) {
    same = same && extent[k] == -extent[3 + k];
    rest = rest && extent[k] == 0.0;
  }
  if (same && !rest)
    error->warning(FLERR,
                   "{}: nodes and spheres outside its group have the velocity {:.4g} {:.4g} {:.4g} "
                   "and will stay where they are all the same; fix dcm/move moves them",
                   STYLE, extent[0], extent[1], extent[2]);
}

DCMRole *FixDCMMotion::mover_of(int i) const
{
  for (auto *const mover : movers)
    if (atom->mask[i] & mover->moved_bits()) return mover;
  return nullptr;
}

/* ----------------------------------------------------------------------
   y = (Gamma + dt K) p, p of owned unknowns
------------------------------------------------------------------------- */

void FixDCMMotion::apply(double dt, double *p, double *y)
{
  messages.forward(p);
  if (implicit)
    dcm::StepSystem(system, stiffness, dt).apply(p, y, messages);
  else
    system.apply(p, y, messages);
  messages.reverse(y, STRIDE, 3);
}

/* ----------------------------------------------------------------------
   forces on what is solved for, less what the velocities of moved bodies come to in a step of
   length dt: those are no unknowns
------------------------------------------------------------------------- */

const double *FixDCMMotion::without_bodies(double dt)
{
  const size_t n = STRIDE * ((size_t) system.nall + 1);
  given_velocity.assign(n, 0.0);
  load.resize(n);
  for (const int s : solver.given) {
    const int i = unknowns.atom_of(s);
    mover_of(i)->move_body(i, dt, &given_velocity[STRIDE * (size_t) s]);
  }
  apply(dt, given_velocity.data(), load.data());
  for (size_t m = 0; m < STRIDE * ((size_t) system.nowned + 1); m++) load[m] = rhs[m] - load[m];
  for (const int s : solver.given)
    for (int k = 0; k < STRIDE; k++) load[STRIDE * s + k] = velocity[STRIDE * s + k] = 0.0;
  return load.data();
}

void FixDCMMotion::add_bodies()
{
  for (const int s : solver.given)
    for (int k = 0; k < 3; k++) velocity[STRIDE * s + k] = given_velocity[STRIDE * s + k];
  messages.forward(velocity.data());
}

/* ----------------------------------------------------------------------
   what the others do to moved bodies in the step that was solved
------------------------------------------------------------------------- */

void FixDCMMotion::find_loads()
{
  const double dt = update->dt;
  if (implicit) look_ahead(dt);    // it may have been that of another length
  apply(dt, velocity.data(), load.data());
  for (auto *const mover : movers) mover->begin_load();
  for (const int s : solver.given) {
    const int i = unknowns.atom_of(s);
    double force[3];
    for (int k = 0; k < 3; k++) force[k] = rhs[STRIDE * s + k] - load[STRIDE * s + k];
    mover_of(i)->add_load(i, force);
  }
}
