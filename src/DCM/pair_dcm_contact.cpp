/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: a step: contacts of faces, what it hands over to others, communication

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "compute.h"
#include "dcm_allgather.h"
#include "dcm_contact_faces.h"
#include "law/curvature.h"
#include "law/volume.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "neighbor.h"
#include "output.h"
#include "platform.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static constexpr int NREGION = AtomVecDCM::NREGION;

// reach of a concave face in find_candidates(): only the exact test can tell

static constexpr float ALWAYS = 1.0e9f;

// the faces of a pair lie anywhere in memory: fetch those of a later pair while computing this one

static constexpr size_t FAR_AHEAD = 16;

// the contact laws of keyword law: a new one is a header in law/ and a line here, at the end. Those
// with slopes, and laws after the first two, are compiled in pair_dcm_contact_stiffness.cpp: what
// the compiler inlines here, and so the last digit of forces, must not change with them.

extern template void PairDCMContact::compute_cells<dcm::DmtState, false, true>();
extern template void PairDCMContact::compute_cells<dcm::MaugisState, false, true>();
extern template void PairDCMContact::compute_cells<dcm::MaugisState, true, true>();
extern template void PairDCMContact::compute_cells<dcm::FoundationState, false, false>();
extern template void PairDCMContact::compute_cells<dcm::FoundationState, false, true>();

template <class State, bool HISTORY>
constexpr std::array<PairDCMContact::Contacts, 2> PairDCMContact::contacts_of()
{
  return {&PairDCMContact::compute_cells<State, HISTORY, false>,
          &PairDCMContact::compute_cells<State, HISTORY, true>};
}

const PairDCMContact::Law PairDCMContact::LAWS[] = {
    {"dmt", contacts_of<dcm::DmtState, false>(), {nullptr, nullptr}},
    {"maugis", contacts_of<dcm::MaugisState, false>(), contacts_of<dcm::MaugisState, true>()},
    {"foundation", contacts_of<dcm::FoundationState, false>(), {nullptr, nullptr}}};

std::vector<std::string> PairDCMContact::law_names()
{
  std::vector<std::string> names;
  for (const auto &law : LAWS) names.emplace_back(law.name);
  return names;
}

/* ---------------------------------------------------------------------- */

std::string PairDCMContact::work()
{
  bigint contacts;
  MPI_Allreduce(&count.contacts, &contacts, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  return fmt::format("{} contacts at the end, neighbor lists: {}", contacts, neighbor->ncalls);
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::compute(int eflag, int vflag)
{
  const double start = platform::walltime();
  ev_init(eflag, vflag);

  count = Counters();
  if (update->setupflag) deepest = Deepest();
  const bool anew = neighbor->ago == 0 || built != neighbor->lastcall;
  if (anew) sort_pairs();
  count.pairs = (bigint) face_pairs.size() + mixed_pairs.size() + sphere_pairs.size();
  if (update->setupflag) check_start();
  // what a run leaves or writes to a restart file need not be looked at again when it goes on
  if (update->ntimestep == update->laststep || update->ntimestep == output->next_restart)
    checked = places();
  count.list_seconds = platform::walltime() - start;

  find_wanted();
  want_overlap = (eflag_global || anew || update->ntimestep == update->laststep) && fix_cell;
  const int nall = atom->nlocal + atom->nghost;
  area.assign(nall, 0.0);
  if (want_stress) stress.assign(nall, 0.0);
  if (want_virial) moment.assign(nall, 0.0);
  if (want_tensor) tensor.assign(6 * (size_t) nall, 0.0);
  clear_blocks();
  if (want_partners) {
    partner_list.clear();
    partners_merged = false;
    partners_at = update->ntimestep;
  }

  if (fix_cell) {
    make_faces();
    const Law &law = LAWS[set.law];
    (this->*(set.history ? law.with_history : law.contacts)[want_stiffness])();
  }
  if (any_apparent) compute_moduli();
  compute_spheres(eflag);
  if (update->setupflag) report_fault();

  commmode = SUMS;
  comm->reverse_comm(this, 1 + want_stress + want_virial + 6 * want_tensor);

  if (vflag_fdotr) virial_fdotr_compute();

  pvector[0] = (double) count.pairs;
  pvector[1] = (double) count.contacts;
  pvector[2] = count.area;
  if (eflag_global || want_overlap) measure_overlap();
  pvector[4] = comm->me == 0 ? overlap : 0.0;    // compute pair sums over processes
  pvector[5] = comm->me == 0 ? filled : 0.0;
  count.seconds = platform::walltime() - start;
  pvector[3] = count.seconds;
}

/* ----------------------------------------------------------------------
   what is recorded in this step
------------------------------------------------------------------------- */

void PairDCMContact::find_wanted()
{
  want_stress = stress_requests.any();
  want_virial = virial_requests.any();
  want_tensor = tensor_requests.any();
  want_stiffness = (traits_of_deck & IMPLICIT) || stiffness_requests.any();
  want_blocks = (traits_of_deck & MOVES) || blocks_requests.any() || want_stiffness;
  want_partners = false;
  partner_requests.each([this](int every) {
    if (update->setupflag || update->ntimestep % every == 0) want_partners = true;
  });
  const bool ends = update->setupflag || update->ntimestep == update->laststep;
  reader_requests.each([this, ends](Compute *reader) {
    if (ends || reader->matchstep(update->ntimestep)) want_partners = true;
  });
}

/* ----------------------------------------------------------------------
   spheres through the faces that have a partner in the list
------------------------------------------------------------------------- */

void PairDCMContact::make_faces()
{
  const auto &faces = fix_cell->faces();
  double *const *const x = atom->x;

  const auto &table = fix_cell->cells();
  rmax_cell.resize(table.size());
  bears.resize(table.size());
  for (const int c : table.deformable()) {
    const double radius = dcm::ball_radius(table[c].volume);
    rmax_cell[c] = set.rmax * radius;
    bears[c] = bearable(fix_cell->mean_edge(c), radius);
  }

  double scale = 0.0;
  for (int f : used_faces) {
    const auto &face = faces[f];
    const int *v = face.v;
    const double k =
        (fix_cell->curvature(v[0]) + fix_cell->curvature(v[1]) + fix_cell->curvature(v[2])) / 3.0;
    const double R = dcm::face_radius(k, 0.0, 0.0, rmax_cell[face.cell], set.concave);
    const dcm::FaceGeometry &g = geometry[f] =
        dcm::make_face(vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]]), R);
    face_class[f] = NREGION * (atom->type[face.atom] - 1) + dcm->region[face.atom];

    const double size = g.center.cwiseAbs().maxCoeff() + std::fabs(g.R);
    if (!std::isfinite(size))
      error->one(FLERR,
                 "Pair style dcm/contact: face {} of cell {} has no finite position at step {}; "
                 "reduce the timestep",
                 atom->tag[face.atom], atom->molecule[face.atom], update->ntimestep);
    scale = std::max(scale, size);
    Outline &o = outline[f];
    for (int m = 0; m < 3; m++) {
      o.mid[m] = (float) g.mid[m];
      o.center[m] = (float) g.center[m];
    }
    o.R = (float) g.R;
    o.reach = g.R > 0.0 ? (float) g.reach : ALWAYS;
  }
  blur = 8.0 * FLT_EPSILON * scale;
}

/* ----------------------------------------------------------------------
   pairs that may be in contact: spheres that come closer than h0, centroids
   that are close across the axis of the spheres. In single precision, on 32
   bytes a face, and without branches, since nine in ten pairs end here; blur
   covers the round-off, so no pair is lost that the exact tests would take.
------------------------------------------------------------------------- */

void PairDCMContact::find_candidates()
{
  const size_t npairs = face_pairs.size();
  candidates.resize(npairs);
  int *const out = candidates.data();
  const FacePair *const pairs = face_pairs.data();
  const Outline *const lines = outline.data();
  const float slack = (float) (range_used + blur), gap = (float) (h0_used + blur);
  const float tiny = (float) blur;
  size_t n = 0;
  for (size_t m = 0; m < npairs; m++) {
    // reading on after the last pair reads the first again
    const FacePair &next = pairs[m + FAR_AHEAD < npairs ? m + FAR_AHEAD : 0];
    __builtin_prefetch(&lines[next.f]);
    __builtin_prefetch(&lines[next.g]);
    const Outline &f = lines[pairs[m].f], &g = lines[pairs[m].g];
    const float dx = g.mid[0] - f.mid[0], dy = g.mid[1] - f.mid[1], dz = g.mid[2] - f.mid[2];
    const float ax = g.center[0] - f.center[0], ay = g.center[1] - f.center[1];
    const float az = g.center[2] - f.center[2];
    const float apart = dx * dx + dy * dy + dz * dz;
    const float axis = ax * ax + ay * ay + az * az;
    const float along = dx * ax + dy * ay + dz * az;
    const float bound = f.reach + g.reach + tiny;
    const float sum = f.R + g.R + gap;
    const bool close = apart < (bound + slack) * (bound + slack);
    const bool beside = apart * axis - along * along < (bound * bound + 1e-5f * apart) * axis;
    const bool touching = axis < sum * sum;
    out[n] = (int) m;
    n += close & ((beside & touching) | (bound > 0.5f * ALWAYS));
  }
  candidates.resize(n);
}

/* ---------------------------------------------------------------------- */

// the axis of a contact points from a to b

void PairDCMContact::add_partner(tagint a, tagint b, double patch, double force, const Vec3 &axis)
{
  double push = -force;
  if (a > b) {
    std::swap(a, b);
    push = force;
  }
  if (partner_list.empty() || partner_list.back().molecule != a || partner_list.back().other != b)
    partner_list.push_back({a, b, 0.0, 0.0, {0.0, 0.0, 0.0}});
  Partner &it = partner_list.back();
  it.area += patch;
  it.normal += force;
  for (int k = 0; k < 3; k++) it.force[k] += push * axis[k];
}

/* ----------------------------------------------------------------------
   each pair of cells once; the order of a stable sort, so that sums repeat
------------------------------------------------------------------------- */

static void merge(std::vector<PairDCMContact::Partner> &list)
{
  using Partner = PairDCMContact::Partner;
  std::stable_sort(list.begin(), list.end(), [](const Partner &p, const Partner &q) {
    return p.molecule != q.molecule ? p.molecule < q.molecule : p.other < q.other;
  });
  size_t n = 0;
  for (size_t m = 0; m < list.size(); m++) {
    const Partner &from = list[m];
    if (n && list[n - 1].molecule == from.molecule && list[n - 1].other == from.other) {
      Partner &to = list[n - 1];
      to.area += from.area;
      to.normal += from.normal;
      for (int k = 0; k < 3; k++) to.force[k] += from.force[k];
    } else {
      list[n++] = from;
    }
  }
  list.resize(n);
}

const std::vector<PairDCMContact::Partner> &PairDCMContact::partners()
{
  if (partners_merged) return partner_list;
  merge(partner_list);
  partner_list = dcm_allgather(partner_list, world);
  merge(partner_list);
  partners_merged = true;
  return partner_list;
}

/* ----------------------------------------------------------------------
   only faces and spheres have anything to communicate
------------------------------------------------------------------------- */

int PairDCMContact::pack_reverse_comm(int n, int first, double *buf)
{
  int m = 0;
  for (int i = first; i < first + n; i++) {
    const int kind = dcm->kind[i];
    if (commmode == NEIGHBORS) {
      if (kind != AtomVecDCM::SPHERE) continue;
      buf[m++] = near_sum[i];
      buf[m++] = near_count[i];
    } else if (kind == AtomVecDCM::SPHERE || kind == AtomVecDCM::FACE) {
      buf[m++] = area[i];
      if (want_stress) buf[m++] = stress[i];
      if (want_virial && kind == AtomVecDCM::SPHERE) buf[m++] = moment[i];
      if (want_tensor && kind == AtomVecDCM::SPHERE)
        for (int k = 0; k < 6; k++) buf[m++] = tensor[6 * (size_t) i + k];
    }
  }
  return m;
}

void PairDCMContact::unpack_reverse_comm(int n, int *list, double *buf)
{
  int m = 0;
  for (int ii = 0; ii < n; ii++) {
    const int i = list[ii], kind = dcm->kind[i];
    if (commmode == NEIGHBORS) {
      if (kind != AtomVecDCM::SPHERE) continue;
      near_sum[i] += buf[m++];
      near_count[i] += buf[m++];
    } else if (kind == AtomVecDCM::SPHERE || kind == AtomVecDCM::FACE) {
      area[i] += buf[m++];
      if (want_stress) stress[i] += buf[m++];
      if (want_virial && kind == AtomVecDCM::SPHERE) moment[i] += buf[m++];
      if (want_tensor && kind == AtomVecDCM::SPHERE)
        for (int k = 0; k < 6; k++) tensor[6 * (size_t) i + k] += buf[m++];
    }
  }
}

int PairDCMContact::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  int m = 0;
  for (int ii = 0; ii < n; ii++)
    if (dcm->kind[list[ii]] == AtomVecDCM::SPHERE) buf[m++] = modulus[list[ii]];
  return m;
}

void PairDCMContact::unpack_forward_comm(int n, int first, double *buf)
{
  int m = 0;
  for (int i = first; i < first + n; i++)
    if (dcm->kind[i] == AtomVecDCM::SPHERE) modulus[i] = buf[m++];
}
