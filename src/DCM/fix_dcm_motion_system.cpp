/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// the friction system of fix dcm/motion: who contributes to it, and its own part

#include "fix_dcm_motion.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "fix_dcm_cell.h"
#include "math_const.h"

#include <algorithm>

using namespace LAMMPS_NS;
using dcm::STRIDE;
using MathConst::MY_4PI;

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
  unknowns.number(groupbit, owner);
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
}
