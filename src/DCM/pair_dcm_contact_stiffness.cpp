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
#include "law/contact_tilt.h"
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
   Slope of a contact of f with g, or with a sphere, which does not tilt. Those in the ring have
none that is positive: softening
------------------------------------------------------------------------- */

PairDCMContact::Slope PairDCMContact::slope_of(const dcm::ContactResult &r,
                                               const dcm::FaceGeometry &f, double weight,
                                               const dcm::FaceGeometry *g)
{
  Slope s = {};
  s.slope = weight * r.slope;
  if (!(s.slope > 0.0)) return Slope();
  double w[2][3];
  dcm::contact_tilt(f, r.u, r.moment, w);
  for (int m = 0; m < 2; m++)
    for (int k = 0; k < 3; k++) s.tilt[m][k] = w[m][k];
  if (g == nullptr) return s;
  dcm::contact_tilt(*g, r.u, r.moment, w);
  for (int m = 0; m < 2; m++)
    for (int k = 0; k < 3; k++) s.tilt[m][k + 3] = -w[m][k];
  return s;
}

/* ----------------------------------------------------------------------
   Stiffness of a contact with a face: the slope of its force along u, between the same two mean
   positions as its friction, and for its tilts. The weights of the force will not do: where
pressure and adhesion of a contact nearly balance, the point at which their sum acts lies far
outside the faces.

   The list is that of the friction; those without slope are left out.
------------------------------------------------------------------------- */

void PairDCMContact::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  add_edges(sphere_stiffness, system.edges, unknowns);
  for (size_t m = 0; m < contact_slope.size(); m++) {
    const Slope &s = contact_slope[m];
    int n[6];
    if (!(s.slope > 0.0) || !find_slots(contacts[m], unknowns, n)) continue;
    system.contacts.push_back({contacts[m], {}});
    auto &spring = system.contacts.back();
    std::copy(n, n + 6, spring.mean.n);
    spring.mean.normal = s.slope;
    spring.mean.tangential = 0.0;
    std::copy(s.tilt[0], s.tilt[0] + 12, spring.tilt[0]);
  }
}
