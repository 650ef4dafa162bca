/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: two center-based cells

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "law/jkr.h"
#include "law/symmetric.h"
#include "error.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static constexpr int NREGION = AtomVecDCM::NREGION;

/* ----------------------------------------------------------------------
   sisters: pairs whose contact is held back after a division
------------------------------------------------------------------------- */

static bool before(const PairDCMContact::Sisters &a, const PairDCMContact::Sisters &b)
{
  return a.molecule != b.molecule ? a.molecule < b.molecule : a.other < b.other;
}

void PairDCMContact::set_sisters(const std::vector<Sisters> &sisters)
{
  sister_list = sisters;
  for (auto &pair : sister_list)
    if (pair.molecule > pair.other) std::swap(pair.molecule, pair.other);
  std::sort(sister_list.begin(), sister_list.end(), before);
  sister_force.assign(sister_list.size(), std::numeric_limits<double>::infinity());
}

int PairDCMContact::find_sisters(tagint a, tagint b) const
{
  Sisters pair;
  pair.molecule = std::min(a, b);
  pair.other = std::max(a, b);
  const auto found = std::lower_bound(sister_list.begin(), sister_list.end(), pair, before);
  if (found == sister_list.end() || before(pair, *found)) return -1;
  return (int) (found - sister_list.begin());
}

std::vector<double> PairDCMContact::sister_forces() const
{
  std::vector<double> force = sister_force;
  if (!force.empty())
    MPI_Allreduce(MPI_IN_PLACE, force.data(), (int) force.size(), MPI_DOUBLE, MPI_MAX, world);
  for (double &f : force)
    if (f == -DBL_MAX) f = 0.0;
  return force;
}

/* ----------------------------------------------------------------------
   apparent modulus of each sphere from its mean compression by the spheres
   it touches (S1, after eq 15). That of sisters counts by the part of the
   full force they feel, since their overlap is none that a tissue has made.
------------------------------------------------------------------------- */

void PairDCMContact::compute_moduli()
{
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  double *const *const x = atom->x;
  near_sum.assign(nall, 0.0);
  near_count.assign(nall, 0.0);
  modulus.resize(nall);
  for (size_t n = 0; n < sphere_pairs.size(); n++) {
    const int i = sphere_pairs[n].i, j = sphere_pairs[n].j;
    const double sum = atom->radius[i] + atom->radius[j];
    const double d = (vec(x[j]) - vec(x[i])).norm();
    if (d > sum && !*sphere_touch[n]) continue;
    double compression = 1.0 - d / sum;
    const int s = sister_list.empty() ? -1 : find_sisters(atom->molecule[i], atom->molecule[j]);
    if (s >= 0) {
      const auto &mat =
          table[NREGION * (atom->type[i] - 1) * nclass + NREGION * (atom->type[j] - 1)];
      const double R = dcm::effective_radius(atom->radius[i], atom->radius[j]);
      const dcm::HeldJKR held = {{mat.E, R, mat.W}, sister_list[s].scale, sister_list[s].most};
      compression *= held.part_of_radius(held.full.contact_radius(sum - d));
    }
    for (int k : {i, j}) {
      near_sum[k] += compression;
      near_count[k] += 1.0;
    }
  }
  commmode = NEIGHBORS;
  comm->reverse_comm(this, 2);

  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::SPHERE) continue;
    const TypeInfo &info = types[atom->type[i]];
    modulus[i] = near_count[i] > 0.0
                     ? dcm::apparent_modulus(info.E, info.a, near_sum[i] / near_count[i])
                     : info.E;
    if (!(modulus[i] > 0.0))
      error->one(FLERR,
                 "Pair style dcm/contact: the apparent modulus of cell {} is {} at a mean overlap "
                 "of {} of the radii; the coefficients a1..a4 must keep it positive",
                 atom->molecule[i], modulus[i], near_sum[i] / near_count[i]);
  }
  commmode = MODULUS;
  comm->forward_comm(this, 1);
}

/* ----------------------------------------------------------------------
   JKR contact of center-based cells: made at first touch, kept to pull-off
------------------------------------------------------------------------- */

template <bool SISTERS, bool SLOPE> void PairDCMContact::sphere_contacts(int eflag)
{
  if (SISTERS) sister_force.assign(sister_list.size(), -DBL_MAX);
  double *const *const x = atom->x;
  double *const *const force_of = atom->f;
  const double *const radius = atom->radius;
  const int *const type = atom->type;
  const int nlocal = atom->nlocal;

  for (size_t n = 0; n < sphere_pairs.size(); n++) {
    const int i = sphere_pairs[n].i, j = sphere_pairs[n].j;
    int &touch = *sphere_touch[n];
    const Vec3 del = vec(x[j]) - vec(x[i]);
    const double d = del.norm();
    const double delta = radius[i] + radius[j] - d;
    if (delta < 0.0 && !touch) continue;

    const TypeInfo &it = types[type[i]], &jt = types[type[j]];
    const dcm::ContactMaterial &mat =
        table[NREGION * (type[i] - 1) * nclass + NREGION * (type[j] - 1)];
    const double E = any_apparent ? dcm::effective_modulus(modulus[i], it.nu, modulus[j], jt.nu)
                                  : mat.E;
    const dcm::JKR jkr = {E, dcm::effective_radius(radius[i], radius[j]), mat.W};
    if (delta < jkr.pull_off_displacement()) {
      touch = 0;
      continue;
    }
    touch = 1;

    const double a = jkr.contact_radius(delta);
    double force = jkr.force_of_radius(a), energy = eflag ? jkr.energy(delta) : 0.0;
    double slope = SLOPE ? jkr.slope_of_radius(a) : 0.0;
    if (!(d > 0.0) || !std::isfinite(force)) fail_pair(i, j, delta, delta, force);
    const int s = SISTERS ? find_sisters(atom->molecule[i], atom->molecule[j]) : -1;
    const double whole = 2.0 * std::min(radius[i], radius[j]);    // the smaller one
    if (delta >= whole && s < 0) fail_pair(i, j, delta, whole, force);
    if (SISTERS && s >= 0) {
      const dcm::HeldJKR held = {jkr, sister_list[s].scale, sister_list[s].most};
      sister_force[s] = std::max(sister_force[s], force);
      force = held.force_of_radius(a);
      if (SLOPE) slope = held.slope_of_radius(a);
      if (eflag) energy = held.energy(delta);
    }
    const Vec3 u = del / d;
    const double patch = dcm::PI * a * a;
    count.contacts++;
    count.area += patch;
    vec(force_of[i]) -= force * u;
    vec(force_of[j]) += force * u;
    area[i] += patch;
    area[j] += patch;
    if (want_stress) {
      stress[i] += force;
      stress[j] += force;
    }
    if (want_virial) {
      moment[i] += 0.5 * d * force;
      moment[j] += 0.5 * d * force;
    }
    if (want_tensor)
      for (const int k : {i, j}) dcm::add_outer(&tensor[6 * (size_t) k], 0.5 * d * force * u, u);
    if (want_partners) add_partner(atom->molecule[i], atom->molecule[j], patch, force, u);
    if (want_blocks)
      spheres.push_back({i, j, patch * mat.gt, patch * (mat.gn - mat.gt), {u[0], u[1], u[2]}});
    if (SLOPE) {
      sphere_stiffness.push_back(dcm::central_stiffness_block(force, slope, del));
      sphere_stiffness.back().i = i;
      sphere_stiffness.back().j = j;
    }
    if (evflag) ev_tally(i, j, nlocal, 1, energy, 0.0, force / d, -del[0], -del[1], -del[2]);
  }
}

void PairDCMContact::compute_spheres(int eflag)
{
  if (sphere_pairs.empty() && sister_list.empty()) return;
  if (sister_list.empty())
    want_stiffness ? sphere_contacts<false, true>(eflag) : sphere_contacts<false, false>(eflag);
  else
    want_stiffness ? sphere_contacts<true, true>(eflag) : sphere_contacts<true, false>(eflag);
}
