/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// fix dcm/tracer: how far a tracer gets and sees in a step, what a rank knows of the faces there,
// and where the space of tracers ends

#include "fix_dcm_tracer.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "neighbor.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/tracer";

static constexpr double FAR = 20.0;    // um, of keyword far, in a box that follows its atoms
static constexpr int LOOK_FAR = 10;    // steps between two looks for tracers that are far

// in edges of the mesh: distance kept from faces, range of the near faces

static constexpr double DELTA = 1.0e-7, NEAR_LEAST = 0.55, NEAR_MOST = 1.2;

// longest step, in edges: shrink-wrapped sides follow the tracers, and cells of LAMMPS' bins with
// them

static constexpr double MOST_EDGES = 100.0;
static constexpr double SLACK = 0.1;    // of the range: faces may move so far under the same voxels

/* ----------------------------------------------------------------------
   lengths of the rules from the edge of the mesh as it was first seen: they must be the same on any
   number of ranks and after a restart
------------------------------------------------------------------------- */

void FixDCMTracer::choose_lengths()
{
  if (kept.scale == 0.0 && cell->mean_edge() > 0.0) {
    const double unit = std::pow(10.0, std::floor(std::log10(cell->mean_edge())) - 1.0);
    kept.scale = unit * std::ceil(cell->mean_edge() / unit - 1.0e-6);
  }
  const double scale = kept.scale > 0.0 ? kept.scale : 1.0;
  const double dt = update->dt, rms = std::sqrt(6.0 * D * dt / substeps) + drift * dt / substeps;
  walk.delta = DELTA * scale;
  walk.most_bounces = bounce;
  walk.shut_range = slits_shut && contact ? contact->h0() : 0.0;
  walk.near =
      std::max(std::clamp(1.3 * rms, NEAR_LEAST * scale, NEAR_MOST * scale), 1.2 * walk.shut_range);
  slack = SLACK * walk.near;
  longest = MOST_SIGMA * std::sqrt(2.0 * D * dt) + drift * dt + 1.0e3 * walk.delta;
}

void FixDCMTracer::reset_dt()
{
  choose_lengths();
  set_limits();
}

/* ----------------------------------------------------------------------
   how far from its part of the box a rank knows all faces, and how far out a tracer may be for its
   next step to stay within; on outer sides of a box that is not periodic there is no limit
------------------------------------------------------------------------- */

void FixDCMTracer::set_limits()
{
  if (kept.scale > 0.0 && !(longest <= MOST_EDGES * kept.scale))
    error->all(
        FLERR,
        "{}: with D {}, drift {} and a timestep of {} tracers move up to {:.4g} in a step, more "
        "than {:.0f} edges of the mesh; reduce D, drift or the timestep",
        STYLE, D, drift, update->dt, longest, MOST_EDGES);
  const double infinite = std::numeric_limits<double>::infinity();
  limited = false;
  const double sight = std::max(walk.near, asked);
  double least = infinite;
  for (int k = 0; k < 3; k++) {
    const bool open_lo = !domain->periodicity[k] && domain->sublo[k] <= domain->boxlo[k];
    const bool open_hi = !domain->periodicity[k] && domain->subhi[k] >= domain->boxhi[k];
    // a face with a point within s of here had its corners within s + 2 reach + skin at the rebuild
    const double known = comm->cutghost[k] - 2.0 * largest - neighbor->skin;
    const double room = known - longest - sight;
    limit_lo[k] = open_lo ? -infinite : domain->sublo[k] - room;
    limit_hi[k] = open_hi ? infinite : domain->subhi[k] + room;
    if (open_lo && open_hi) continue;
    limited = true;
    least = std::min(least, room);
  }
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, world);
  if (least < 0.0)
    error->all(
        FLERR,
        "{}: with D {} and a timestep of {} tracers move up to {:.4g} in a step (substeps {} "
        "do not change that), and with the {:.4g} around them that they look at this is "
        "{:.4g} beyond the faces that a rank knows; reduce D or the timestep, or set "
        "'comm_modify cutoff {:.4g}'",
        STYLE, D, update->dt, longest, substeps, sight, -least,
        std::ceil(10.0 * (comm->get_comm_cutoff() - least) + 1.0) / 10.0);
}

/* ---------------------------------------------------------------------- */

void FixDCMTracer::setup(int /*vflag*/)
{
  walk.wall_lo.setConstant(-1.0e300);
  walk.wall_hi.setConstant(1.0e300);
  for (int k = 0; k < 3; k++) {    // a fixed box loses what leaves it
    if (domain->boundary[k][0] == 1) walk.wall_lo[k] = domain->boxlo[k] + walk.delta;
    if (domain->boundary[k][1] == 1) walk.wall_hi[k] = domain->boxhi[k] - walk.delta;
  }
  if (slab_axis >= 0) {
    walk.wall_lo[slab_axis] = std::max(walk.wall_lo[slab_axis], slab_lo);
    walk.wall_hi[slab_axis] = std::min(walk.wall_hi[slab_axis], slab_hi);
  }
  if (kept.have_box) look_far();
}

/* ----------------------------------------------------------------------
   the box around all nodes, at set times; tracers outside that are far from it
------------------------------------------------------------------------- */

void FixDCMTracer::look_far()
{
  if (kept.have_box && !update->setupflag && update->ntimestep % LOOK_FAR != 0) return;
  bool follows = false;
  for (int k = 0; k < 3; k++) follows |= domain->boundary[k][0] >= 2 || domain->boundary[k][1] >= 2;
  const double distance = far > 0.0 ? far : follows ? FAR : -1.0;
  if (distance < 0.0) {
    kept.have_box = 1;
    return;
  }
  if (!update->setupflag) {
    double most[6];    // -low, high
    std::fill_n(most, 6, -1.0e300);
    for (int i = 0; i < atom->nlocal; i++) {
      if (dcm->kind[i] != AtomVecDCM::NODE) continue;
      for (int k = 0; k < 3; k++) {
        most[2 * k] = std::max(most[2 * k], -atom->x[i][k]);
        most[2 * k + 1] = std::max(most[2 * k + 1], atom->x[i][k]);
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, most, 6, MPI_DOUBLE, MPI_MAX, world);
    for (int k = 0; k < 3; k++) {
      kept.box[2 * k] = -most[2 * k];
      kept.box[2 * k + 1] = most[2 * k + 1];
    }
    kept.have_box = 1;
  }
  Vec3 lo = Vec3::Constant(-1.0e300), hi = Vec3::Constant(1.0e300);
  for (int k = 0; k < 3; k++) {
    if (domain->periodicity[k] || kept.box[2 * k] > kept.box[2 * k + 1]) continue;
    lo[k] = kept.box[2 * k] - distance;
    hi[k] = kept.box[2 * k + 1] + distance;
  }
  if (reflect_far) {
    walk.outer_lo = lo;
    walk.outer_hi = hi;
  } else if (!update->setupflag) {
    for (const int i : mine) {
      tagint *const state = dcm->vertex[i];
      const Vec3 x = vec(atom->x[i]);
      if (state[AtomVecDCM::HOME] == 0 && ((x - lo).minCoeff() < 0.0 || (hi - x).minCoeff() < 0.0))
        state[AtomVecDCM::WEIGHTS] = DOOMED;
    }
  }
}

/* ----------------------------------------------------------------------
   lists are rebuilt in this step if a tracer is so far out that its next step might meet faces that
   are not known here, or is to be deleted
------------------------------------------------------------------------- */

void FixDCMTracer::ask_for_rebuild(int &rebuild)
{
  for (const int i : mine) {
    const double *const x = atom->x[i];
    bool out = dcm->vertex[i][AtomVecDCM::WEIGHTS] == DOOMED;
    for (int k = 0; k < 3; k++) out |= x[k] < limit_lo[k] || x[k] > limit_hi[k];
    if (out) rebuild = 1;
  }
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &rebuild, 1, MPI_INT, MPI_MAX, world);
}
