/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// the friction system of fix dcm/motion: numbering of its unknowns and their blocks

#include "fix_dcm_motion.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "bond_dcm_cortex.h"
#include "comm.h"
#include "fix_dcm_cell.h"
#include "math_const.h"
#include "neighbor.h"
#include "pair_dcm_contact.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::STRIDE;
using MathConst::MY_4PI;

static constexpr int FIXED = 0;         // slot of everything that does not move
static constexpr int NOT_ASKED = -1;    // a ghost no block has touched so far

/* ----------------------------------------------------------------------
   owned atom or ghost that belongs to the unknowns
------------------------------------------------------------------------- */

bool FixDCMMotion::is_unknown(int i) const
{
  return (dcm->kind[i] == AtomVecDCM::NODE || dcm->kind[i] == AtomVecDCM::SPHERE) &&
         (atom->mask[i] & groupbit);
}

/* ----------------------------------------------------------------------
   slot of an atom; a ghost gets its own, and a request to its owner, when it is first asked for
------------------------------------------------------------------------- */

int FixDCMMotion::ask(int i)
{
  if (slot[i] != NOT_ASKED) return slot[i];
  const int j = atom->map(atom->tag[i]);    // one slot for all copies
  if (slot[j] == NOT_ASKED) {
    slot[j] = ++system.nall;
    messages.request((int) owner[j], atom->tag[j], slot[j]);
  }
  slot[i] = slot[j];
  return slot[i];
}

/* ----------------------------------------------------------------------
   after a rebuild of the neighbor lists: number the owned unknowns and those ghosts that edges
   and faces touch; contacts ask for more from step to step
------------------------------------------------------------------------- */

void FixDCMMotion::make_slots()
{
  const int nlocal = atom->nlocal, nghost = atom->nghost;
  slot.assign(nlocal + nghost, FIXED);
  atom_of.assign(1, -1);
  for (int i = 0; i < nlocal; i++) {
    if (!is_unknown(i)) continue;
    slot[i] = (int) atom_of.size();
    atom_of.push_back(i);
  }
  system.nowned = system.nall = (int) atom_of.size() - 1;

  std::vector<int> known(comm->nprocs, 0);
  if (comm->nprocs > 1) {
    owner.assign(nlocal + nghost, comm->me);
    comm->forward_comm(this, 1);
  }
  for (int i = nlocal; i < nlocal + nghost; i++) {
    if (!is_unknown(i)) continue;
    const int j = atom->map(atom->tag[i]);
    if (j < nlocal)
      slot[i] = slot[j];
    else {
      slot[i] = NOT_ASKED;
      known[(int) owner[i]]++;
    }
  }
  messages.connect(known);

  face_slots.resize(3 * (size_t) cell->nowned);
  for (int f = 0; f < cell->nowned; f++)
    for (int k = 0; k < 3; k++) face_slots[3 * (size_t) f + k] = ask(cell->faces[f].v[k]);

  list_edges();
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
   isotropic dashpots do not change until the next rebuild, projected ones turn with their edge
------------------------------------------------------------------------- */

void FixDCMMotion::list_edges()
{
  system.iso_edges.clear();
  projected_edges.clear();
  if (!cortex) return;
  int **bondlist = neighbor->bondlist;
  for (int n = 0; n < neighbor->nbondlist; n++) {
    const int btype = bondlist[n][2];
    const double gamma = cortex->gamma(btype);
    if (gamma == 0.0) continue;
    const int i = ask(bondlist[n][0]), j = ask(bondlist[n][1]);
    if (i == j) continue;    // both fixed
    if (cortex->projected(btype))
      projected_edges.push_back(n);
    else
      system.iso_edges.push_back({i, j, gamma});
  }
}

/* ----------------------------------------------------------------------
   the blocks of this step
------------------------------------------------------------------------- */

void FixDCMMotion::assemble()
{
  if (stale) make_slots();
  add_edges();
  if (contact) add_contacts();
  messages.update([this](std::int64_t tag) {
    return slot[atom->map((tagint) tag)];
  });
  add_ecm();
  system.merge();

  const size_t n = (size_t) system.nall + 1;
  rhs.assign(STRIDE * n, 0.0);
  velocity.assign(STRIDE * n, 0.0);
  double **f = atom->f, **v = atom->v;
  for (int s = 1; s <= system.nowned; s++) {
    const int i = atom_of[s];
    for (int k = 0; k < 3; k++) {
      rhs[STRIDE * (size_t) s + k] = f[i][k];
      velocity[STRIDE * (size_t) s + k] = v[i][k];
    }
  }
}

void FixDCMMotion::add_edges()
{
  system.edges.clear();
  double **x = atom->x;
  int **bondlist = neighbor->bondlist;
  for (const int n : projected_edges) {
    const int i = bondlist[n][0], j = bondlist[n][1];
    const double dx = x[j][0] - x[i][0], dy = x[j][1] - x[i][1], dz = x[j][2] - x[i][2];
    const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (r == 0.0) continue;
    system.edges.push_back(
        {slot[i], slot[j], 0.0, cortex->gamma(bondlist[n][2]), {dx / r, dy / r, dz / r}});
  }
}

void FixDCMMotion::add_contacts()
{
  for (auto block : contact->sphere_blocks()) {
    block.i = ask(block.i);
    block.j = ask(block.j);
    if (block.i != block.j) system.edges.push_back(block);
  }
  system.contacts.clear();
  for (auto block : contact->contact_blocks()) {
    int any = 0;
    for (int &n : block.n) any |= n = ask(n);
    if (any) system.contacts.push_back(block);
  }
}

/* ----------------------------------------------------------------------
   ECM friction acts on the free surface: one third of each incident face's for a node. A small
   share of the whole area always counts as free, see the doc page
------------------------------------------------------------------------- */

void FixDCMMotion::add_ecm()
{
  system.ecm.assign((size_t) system.nall + 1, 0.0);
  const double *covered = contact ? contact->contact_area() : nullptr;
  const int *type = atom->type;

  auto free_area = [&](int i, double area) {
    return covered ? std::max(area - covered[i], least_free * area) : area;
  };
  for (int f = 0; f < cell->nowned; f++) {
    const auto &face = cell->faces[f];
    const double share = free_area(face.atom, cell->area[f]) / 3.0;
    for (int k = 0; k < 3; k++)
      system.ecm[face_slots[3 * (size_t) f + k]] += friction[type[face.v[k]]] * share;
  }
  for (int s = 1; s <= system.nowned; s++) {
    const int i = atom_of[s];
    if (dcm->kind[i] != AtomVecDCM::SPHERE) continue;
    const double r = atom->radius[i];
    system.ecm[s] += friction[type[i]] * free_area(i, MY_4PI * r * r);
  }
}
