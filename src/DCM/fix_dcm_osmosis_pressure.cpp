/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// fix dcm/osmosis: the lumen as its marked faces make it, the pressure in it and its forces

#include "fix_dcm_osmosis.h"

#include "atom.h"
#include "comm.h"
#include "dcm_compat.h"
#include "dcm_unknowns.h"
#include "law/lumen.h"
#include "law/stiffness.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "input.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/osmosis";

/* ----------------------------------------------------------------------
   the marked faces as they are now: volume, closure, net force; collective
------------------------------------------------------------------------- */

void FixDCMOsmosis::measure()
{
  if (measured) return;
  measured = true;
  double **x = atom->x;
  dcm::LumenSums mine;
  Vec3 push = Vec3::Zero();
  double area = 0.0;
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    if (!mark[face.atom]) continue;
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = x[face.v[0]][k] - now.center[k];
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    const Vec3 a = vec(d), b = a + (vec(x[face.v[1]]) - vec(x[face.v[0]])),
               c = a + (vec(x[face.v[2]]) - vec(x[face.v[0]]));
    if (axis < 0) {
      dcm::add_face(mine, a, b, c);
    } else {
      dcm::add_face_in_slab(mine, a, b, c, axis, lo - now.center[axis], hi - now.center[axis]);
    }
    area += cell->area(f);
    push += free_part(f) * vec(&cell->normals()[3 * (size_t) f]);
  }
  double values[9] = {mine.volume, mine.area, area};
  vec(&values[3]) = mine.area_vector;
  vec(&values[6]) = push;
  MPI_Allreduce(MPI_IN_PLACE, values, 9, MPI_DOUBLE, MPI_SUM, world);
  sums = dcm::LumenSums();
  sums.volume = values[0];
  sums.area = values[1];
  sums.area_vector = vec(&values[3]);
  wall = values[2];
  net = vec(&values[6]).norm();
}

/* ----------------------------------------------------------------------
   area of a face that the pressure acts on: a contact that grows takes it off little by little
------------------------------------------------------------------------- */

double FixDCMOsmosis::free_part(int f) const
{
  const int i = cell->faces()[f].atom;
  if (!mark[i]) return 0.0;
  const double area = cell->area(f);
  return weigh_free && !whole[i] ? std::max(0.0, area - contact->contact_area()[i]) : area;
}

/* ----------------------------------------------------------------------
   faces move with the mean of their vertices
------------------------------------------------------------------------- */

double FixDCMOsmosis::power() const
{
  double sum = 0.0;
  if (acting == 0.0) return sum;
  const double *normals = nullptr;    // no face is marked in most steps of most runs
  for (int f = 0; f < cell->nowned(); f++) {
    const double part = free_part(f);
    if (part == 0.0) continue;
    if (!normals) normals = cell->normals();
    const Vec3 third = dcm::lumen_force(acting, part, vec(&normals[3 * (size_t) f]));
    sum += 3.0 * third.dot(vec(atom->v[cell->faces()[f].atom]));
  }
  return sum;
}

/* ----------------------------------------------------------------------
   on nodes, ghosts included, before forces are summed; the virial is taken about the center of the
   cell, as that of fix dcm/volume
------------------------------------------------------------------------- */

void FixDCMOsmosis::pre_reverse(int /*eflag*/, int vflag)
{
  v_init(vflag);
  if (!newborn.empty()) inherit();
  measured = false;
  evaluate_pressure();
  if (acting == 0.0) return;
  double **x = atom->x, **force = atom->f;
  const double *normals = nullptr;
  for (int f = 0; f < cell->nowned(); f++) {
    const double part = free_part(f);
    if (part == 0.0) continue;
    if (!normals) normals = cell->normals();
    const auto &face = cell->faces()[f];
    const Vec3 third = dcm::lumen_force(acting, part, vec(&normals[3 * (size_t) f]));
    for (const int v : face.v) vec(force[v]) += third;
    if (evflag)
      for (const int v : face.v) tally(face.atom, x[v], cell->cells()[face.cell].x, third.data());
  }
  worked += 0.5 * update->dt * power();
}

void FixDCMOsmosis::tally(int i, const double *xi, const double *center, const double *fi)
{
  double d[3] = {xi[0] - center[0], xi[1] - center[1], xi[2] - center[2]};
  dcm_minimum_image(domain, d[0], d[1], d[2]);
  double v[6] = {d[0] * fi[0], d[1] * fi[1], d[2] * fi[2],
                 d[0] * fi[1], d[0] * fi[2], d[1] * fi[2]};
  v_tally(i, v);
}

/* ---------------------------------------------------------------------- */

void FixDCMOsmosis::evaluate_pressure()
{
  if (dilute > 0.0 || solute) measure();
  double P = pressure;
  if (!variable.empty()) {
    modify->clearstep_compute();
    P = input->variable->compute_equal(input->variable->find(variable.c_str()));
    modify->addstep_compute(update->ntimestep + 1);
    if (!std::isfinite(P))
      error->all(FLERR, "{}: variable {} gives the pressure {} at step {}; it must be a number",
                 STYLE, variable, P, update->ntimestep);
  }
  if (ramp > 0.0) {
    const double since = now.begun < 0.0 ? 0.0 : now.clock - now.begun;
    P *= std::min(1.0, since / ramp);
  }
  falls = 0.0;
  if (dilute > 0.0 && sums.volume > dilute) {
    P *= dilute / sums.volume;
    falls += P / sums.volume;
  }
  if (solute && now.nfaces > 0) {
    const double osmotic = dcm::osmotic_pressure(now.amount, kT, sums.volume, least);
    P += osmotic;
    if (sums.volume > least) falls += osmotic / sums.volume;
  }
  falls = std::max(0.0, falls);
  acting = P;
}

/* ----------------------------------------------------------------------
   of the pressure that falls as the lumen swells: -dP/dV g g^T, g the force of a unit of pressure
------------------------------------------------------------------------- */

void FixDCMOsmosis::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  if (falls == 0.0) return;
  pushed.assign(3 * (size_t) (atom->nlocal + atom->nghost), 0.0);
  const double *normals = nullptr;
  for (int f = 0; f < cell->nowned(); f++) {
    const double part = free_part(f);
    if (part == 0.0) continue;
    if (!normals) normals = cell->normals();
    const Vec3 third = dcm::lumen_force(1.0, part, vec(&normals[3 * (size_t) f]));
    for (const int v : cell->faces()[f].v) vec(&pushed[3 * (size_t) v]) += third;
  }
  comm->reverse_comm(this, 3);
  const size_t begin = system.nodes.size();
  for (int s = 1; s <= unknowns.nowned(); s++) {
    const Vec3 force = vec(&pushed[3 * (size_t) unknowns.atom_of(s)]);
    if (force.squaredNorm() == 0.0) continue;
    system.nodes.push_back({s, {force[0], force[1], force[2]}});
  }
  system.cells.push_back({begin, system.nodes.size(), falls});
}

int FixDCMOsmosis::pack_reverse_comm(int n, int first, double *buf)
{
  std::copy_n(&pushed[3 * (size_t) first], 3 * (size_t) n, buf);
  return 3 * n;
}

void FixDCMOsmosis::unpack_reverse_comm(int n, int *list, double *buf)
{
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) pushed[3 * (size_t) list[i] + k] += *buf++;
}
