/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: the friction and stiffness blocks of a step, handed over between unknowns
// instead of local atoms; the laws with slopes, and laws after the first two

#include "pair_dcm_contact.h"

#include "dcm_contact_faces.h"
#include "dcm_unknowns.h"
#include "law/friction.h"
#include "law/stiffness.h"

#include <algorithm>

using namespace LAMMPS_NS;

template void PairDCMContact::compute_cells<dcm::DmtState, false, true>();
template void PairDCMContact::compute_cells<dcm::MaugisState, false, true>();
template void PairDCMContact::compute_cells<dcm::MaugisState, true, true>();
template void PairDCMContact::compute_cells<dcm::FoundationState, false, false>();
template void PairDCMContact::compute_cells<dcm::FoundationState, false, true>();

/* ---------------------------------------------------------------------- */

void PairDCMContact::clear_blocks()
{
  contacts.clear();
  spheres.clear();
  contact_slope.clear();
  sphere_stiffness.clear();
}

/* ---------------------------------------------------------------------- */

static void add_edges(const std::vector<dcm::EdgeBlock> &blocks, std::vector<dcm::EdgeBlock> &edges,
                      DCMUnknowns &unknowns)
{
  for (const auto &block : blocks) {
    const int i = unknowns(block.i), j = unknowns(block.j);
    if (i == j) continue;    // both fixed
    edges.push_back(block);
    edges.back().i = i;
    edges.back().j = j;
  }
}

// false if all are fixed

static bool find_slots(const dcm::ContactBlock &block, DCMUnknowns &unknowns, int *n)
{
  int any = 0;
  for (int k = 0; k < 6; k++) any |= n[k] = unknowns(block.n[k]);
  return any;
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::add_friction(dcm::FrictionSystem &system, DCMUnknowns &unknowns)
{
  add_edges(spheres, system.edges, unknowns);
  for (const auto &block : contacts) {
    int n[6];
    if (!find_slots(block, unknowns, n)) continue;
    system.contacts.push_back(block);
    std::copy(n, n + 6, system.contacts.back().n);
  }
}

/* ----------------------------------------------------------------------
   Stiffness of a contact with a face: the slope of its force along u, between the same two mean
   positions as its friction. A law's stiffness is int (dp/d delta) w w^T dA with w the barycentric
   weights at a point of the contact, all positive where the slope is. What is taken is the part in
   which the contact moves as a whole, the product of means; the tilt of the faces against each
other, a second moment over less than a face, is left out. The weights of the force will not do:
where pressure and adhesion of a contact nearly balance, the point at which their sum acts lies far
   outside the faces.

   The list is that of the friction; those without slope (in the ring: softening) are left out.
------------------------------------------------------------------------- */

void PairDCMContact::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  add_edges(sphere_stiffness, system.edges, unknowns);
  for (size_t m = 0; m < contact_slope.size(); m++) {
    int n[6];
    if (!(contact_slope[m] > 0.0) || !find_slots(contacts[m], unknowns, n)) continue;
    system.contacts.push_back(contacts[m]);
    auto &block = system.contacts.back();
    std::copy(n, n + 6, block.n);
    block.normal = contact_slope[m];
    block.tangential = 0.0;
  }
}
