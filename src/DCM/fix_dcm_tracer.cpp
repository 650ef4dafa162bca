/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "fix_dcm_tracer.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_record.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "group.h"
#include "law/random.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/tracer";
static constexpr int RECORD = 1;    // version of the restart record

static constexpr double MOST_SIGMA = 4.5;    // longest step, in sqrt(2 D dt)
static constexpr double FAR = 20.0;          // um, of keyword far, in a box that follows its atoms
static constexpr int LOOK_FAR = 10;          // steps between two looks for tracers that are far

// more tracers of a cell, and more sub-steps, do not end within a day

static constexpr int MOST_TRACERS = 100000, MOST_SUBSTEPS = 1000;

// longest step, in edges: shrink-wrapped sides follow the tracers, and cells of LAMMPS' bins with them

static constexpr double MOST_EDGES = 100.0;

// in edges of the mesh: distance kept from faces, range of the near faces, edge of a voxel

static constexpr double DELTA = 1.0e-7, NEAR_LEAST = 0.55, NEAR_MOST = 1.2, VOXEL = 0.4;
static constexpr double SLACK = 0.1;    // of the range: faces may move so far under the same voxels

/* ----------------------------------------------------------------------
   fix ID group dcm/tracer type T number n D v seed S [drift u] [substeps k] [slab z lo hi]
       [bounce N] [far d delete|reflect] [slits shut|open] [free theta] [topup yes|no]
       [death delete|release]
------------------------------------------------------------------------- */

FixDCMTracer::FixDCMTracer(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), type(0), number(-1), substeps(1), bounce(32), D(-1.0), drift(0.0),
    far(-1.0), seed(0), slab_axis(-1), slab_lo(0.0), slab_hi(0.0), covered(0.05),
    reflect_far(false), slits_shut(true), topup(false), release(false), dcm(nullptr), cell(nullptr),
    contact(nullptr), polarity_field(0), walk(faces, voxels), touched(nullptr)
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  parse(narg - 3, arg + 3);
  for (const auto *other : modify->get_fix_by_style("^dcm/tracer$"))
    error->all(FLERR, "{}: there is one already (ID {}); a deck has at most one", STYLE, other->id);

  vector_flag = 1;
  size_vector = 9;
  extvector = 1;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
  comm_forward = comm_reverse = 1;
  keep_from_ghosts();
}

FixDCMTracer::~FixDCMTracer()
{
  let_be_ghosts();
}

void FixDCMTracer::parse(int narg, char **arg)
{
  DCMArgs args(lmp, STYLE, narg, arg,
               {"type", "number", "D", "seed", "drift", "substeps", "slab", "bounce", "far",
                "slits", "free", "topup", "death"});
  while (args.next()) {
    if (args.is("type")) {
      type = args.type(atom->ntypes);
    } else if (args.is("number")) {
      number = (int) args.whole(0, MOST_TRACERS);
    } else if (args.is("D")) {
      D = args.number(DCMArgs::NONNEGATIVE);
    } else if (args.is("seed")) {
      seed = args.whole();
    } else if (args.is("drift")) {
      drift = args.number(DCMArgs::NONNEGATIVE);
    } else if (args.is("substeps")) {
      substeps = (int) args.whole(1, MOST_SUBSTEPS);
    } else if (args.is("slab")) {
      args.need(3);
      slab_axis = args.axis();
      slab_lo = args.number();
      slab_hi = args.number();
      args.check(slab_hi > slab_lo, fmt::format("above its low end, {}", slab_lo));
    } else if (args.is("bounce")) {
      bounce = (int) args.whole();
    } else if (args.is("far")) {
      args.need(2);
      far = args.number(DCMArgs::POSITIVE);
      reflect_far = args.choose({"delete", "reflect"}) == 1;
    } else if (args.is("slits")) {
      slits_shut = args.choose({"shut", "open"}) == 0;
    } else if (args.is("free")) {
      covered = args.number(DCMArgs::POSITIVE);
      args.check(covered < 1.0, "below 1");
    } else if (args.is("topup")) {
      topup = args.choose({"no", "yes"}) == 1;
    } else {
      release = args.choose({"delete", "release"}) == 1;
    }
  }
  if (type == 0 || number < 0 || D < 0.0 || seed == 0)
    error->all(FLERR, "{}: keyword {} is missing; it needs type, number, D and seed", STYLE,
               type == 0           ? "type"
                   : number < 0    ? "number"
                   : D < 0.0       ? "D"
                                   : "seed");
}

int FixDCMTracer::setmask()
{
  return INITIAL_INTEGRATE | PRE_EXCHANGE | PRE_NEIGHBOR | POST_NEIGHBOR | MIN_PRE_FORCE;
}

/* ---------------------------------------------------------------------- */

void FixDCMTracer::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  faces.attach(atom, dcm, cell, &shut);
  if (update->whichflag == 1) check_before_motion(lmp, this, STYLE);
  for (const char *style : {"dcm/division", "dcm/death", "dcm/convert", "dcm/polarity"})
    check_after(lmp, this, STYLE, style);
  if (domain->triclinic) error->all(FLERR, "{} needs an orthogonal box", STYLE);

  // a daughter of a secreting cell shares her mother's tracers, or gets her own as well

  secretes = cell->change_cells().add(STYLE, "secretes",
                                      topup ? DCMColumn::RESET : DCMColumn::INHERIT, 0.0, {},
                                      secretes);
  cell->refresh();
  polarity = drift > 0.0 ? cell->cells().column("ax", polarity_field) : nullptr;
  if (drift > 0.0 && !polarity)
    error->all(FLERR,
               "{}: drift is along the polarity of a cell, which no style gives; add a fix "
               "dcm/polarity before this fix, or remove drift",
               STYLE);
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  check_types();
  if (slab_axis >= 0) {
    const double lo = domain->boxlo[slab_axis], hi = domain->boxhi[slab_axis];
    if (slab_lo >= hi || slab_hi <= lo)
      error->all(FLERR, "{}: slab {} {} {} lies outside the box, which reaches from {:.4g} to {:.4g}",
                 STYLE, "xyz"[slab_axis], slab_lo, slab_hi, lo, hi);
    if (domain->periodicity[slab_axis] && (slab_lo < lo || slab_hi > hi))
      error->all(FLERR,
                 "{}: slab {} {} {} reaches across the border of the periodic box, which reaches from "
                 "{:.4g} to {:.4g}; move the cells, or make the slab narrower",
                 STYLE, "xyz"[slab_axis], slab_lo, slab_hi, lo, hi);
  }
  DCMCellSurgery::check_order(lmp, this, STYLE);
  mark_ghosts();
  next_reneighbor = -1;
  stale = true;
}

/* ----------------------------------------------------------------------
   tracers are of this type and nothing else is; they meet nobody in the neighbor list
------------------------------------------------------------------------- */

void FixDCMTracer::check_types()
{
  int wrong[2] = {0, 0};
  for (int i = 0; i < atom->nlocal; i++) {
    const bool tracer = dcm->kind[i] == AtomVecDCM::TRACER;
    if (atom->type[i] == type && !tracer) wrong[0] = 1;
    if (atom->type[i] != type && tracer) wrong[1] = atom->type[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, wrong, 2, MPI_INT, MPI_MAX, world);
  if (wrong[0])
    error->all(FLERR,
               "{}: atom type {} holds atoms that are no tracers; give tracers an atom type of their "
               "own",
               STYLE, type);
  if (wrong[1])
    error->all(FLERR, "{}: there are tracers of atom type {}; they must be of type {}", STYLE,
               wrong[1], type);
  if (contact && contact->touches(type))
    error->all(FLERR,
               "{}: atom type {} of tracers has a cell type in pair_coeff; give it NULL there, so "
               "that tracers stay out of the neighbor list",
               STYLE, type);
}

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
  walk.near = std::max(std::clamp(1.3 * rms, NEAR_LEAST * scale, NEAR_MOST * scale),
                       1.2 * walk.shut_range);
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
    error->all(FLERR,
               "{}: with D {}, drift {} and a timestep of {} tracers move up to {:.4g} in a step, more "
               "than {:.0f} edges of the mesh; reduce D, drift or the timestep",
               STYLE, D, drift, update->dt, longest, MOST_EDGES);
  const double infinite = std::numeric_limits<double>::infinity();
  limited = false;
  double least = infinite;
  for (int k = 0; k < 3; k++) {
    const bool open_lo = !domain->periodicity[k] && domain->sublo[k] <= domain->boxlo[k];
    const bool open_hi = !domain->periodicity[k] && domain->subhi[k] >= domain->boxhi[k];
    // a face with a point within s of here had its corners within s + 2 reach + skin at the rebuild
    const double known = comm->cutghost[k] - 2.0 * largest - neighbor->skin;
    const double room = known - longest - walk.near;
    limit_lo[k] = open_lo ? -infinite : domain->sublo[k] - room;
    limit_hi[k] = open_hi ? infinite : domain->subhi[k] + room;
    if (open_lo && open_hi) continue;
    limited = true;
    least = std::min(least, room);
  }
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, world);
  if (least < 0.0)
    error->all(FLERR,
               "{}: with D {} and a timestep of {} tracers move up to {:.4g} in a step (substeps {} "
               "do not change that), and with the {:.4g} around them that they look at this is "
               "{:.4g} beyond the faces that a rank knows; reduce D or the timestep, or set "
               "'comm_modify cutoff {:.4g}'",
               STYLE, D, update->dt, longest, substeps, walk.near, -least,
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
   faces and tracers have new numbers
------------------------------------------------------------------------- */

void FixDCMTracer::post_neighbor()
{
  mine.clear();
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::TRACER) mine.push_back(i);
  largest = 0.0;
  for (const auto &face : cell->faces()) largest = std::max(largest, atom->radius[face.atom]);
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, world);
  choose_lengths();
  set_limits();
  stale = true;
}

void FixDCMTracer::min_pre_force(int /*vflag*/)
{
  unsure = true;
}

/* ---------------------------------------------------------------------- */

void FixDCMTracer::initial_integrate(int /*vflag*/)
{
  const double moved = moved_since_settled();
  refresh_faces();
  settle_all(moved);
  int rebuild = any_needy();
  walk_all();
  if (update->ntimestep % LOOK_FAR == 0 || !kept.have_box) look_far();
  ask_for_rebuild(rebuild);
  if (rebuild) next_reneighbor = update->ntimestep;
}

/* ----------------------------------------------------------------------
   how far a corner has moved since tracers were settled; unlimited after a rebuild
------------------------------------------------------------------------- */

double FixDCMTracer::moved_since_settled()
{
  double **x = atom->x;
  const int nall = atom->nlocal + atom->nghost;
  double most = 0.0;
  if (stale) {
    most = std::numeric_limits<double>::infinity();
    last_place.resize((size_t) 3 * nall);
  }
  for (int i = 0; i < nall; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    double *last = &last_place[3 * (size_t) i];
    if (!stale) most = std::max(most, (vec(x[i]) - vec(last)).squaredNorm());
    vec(last) = vec(x[i]);
  }
  return stale ? most : std::sqrt(most);
}

void FixDCMTracer::refresh_faces()
{
  if (walk.shut_range > 0.0) send_shut();
  faces.forget();
}

/* ----------------------------------------------------------------------
   faces in contact, owned and ghost; the contact areas are those of the last forces
------------------------------------------------------------------------- */

void FixDCMTracer::send_shut()
{
  const double *const area = contact->contact_area();
  shut.assign(atom->nlocal + atom->nghost, 0);
  for (int f = 0; f < cell->nowned(); f++) {
    const int i = cell->faces()[f].atom;
    shut[i] = area[i] > covered * cell->area(f);
  }
  comm->forward_comm(this, 1);
}

/* ---------------------------------------------------------------------- */

dcm::Tracer FixDCMTracer::load(int i)
{
  dcm::Tracer t;
  t.x = vec(atom->x[i]);
  t.home = dcm->vertex[i][AtomVecDCM::HOME];
  const tagint host = dcm->vertex[i][AtomVecDCM::HOST];
  if (host == 0) return t;
  int j = host > atom->map_tag_max ? -1 : atom->map(host);
  if (j >= 0) j = domain->closest_image(i, j);
  if (j >= 0) t.host = cell->face_of(j);
  if (t.host >= 0 && !faces[t.host].known) t.host = -1;
  const int code = (int) dcm->vertex[i][AtomVecDCM::WEIGHTS];
  t.weight[0] = code / (dcm::Tracer::WEIGHTS + 1);
  t.weight[1] = code % (dcm::Tracer::WEIGHTS + 1);
  return t;
}

void FixDCMTracer::store(int i, const dcm::Tracer &t)
{
  vec(atom->x[i]) = t.x;
  dcm->vertex[i][AtomVecDCM::HOME] = (tagint) t.home;
  dcm->vertex[i][AtomVecDCM::HOST] = t.host < 0 ? 0 : (tagint) faces[t.host].tag;
  dcm->vertex[i][AtomVecDCM::WEIGHTS] =
      t.host < 0 ? 0 : t.weight[0] * (dcm::Tracer::WEIGHTS + 1) + t.weight[1];
}

void FixDCMTracer::settle_all(double moved)
{
  if (stale || since_build + moved > slack) {
    if (!mine.empty()) voxels.build(faces, VOXEL * std::max(kept.scale, 1.0e-3), walk.near + slack);
    since_build = 0.0;
  } else {
    since_build += moved;
  }
  stale = false;
  for (const int i : mine) {
    dcm::Tracer t = load(i);
    if (!walk.settle(t, moved)) no_place(i);
    store(i, t);
  }
}

void FixDCMTracer::no_place(int i)
{
  error->one(FLERR,
             "{}: tracer {} has no place inside its cell {} at step {}: the cell's surface is folded "
             "there; reduce the timestep or what deforms the cell",
             STYLE, atom->tag[i], dcm->vertex[i][AtomVecDCM::HOME], update->ntimestep);
}

/* ----------------------------------------------------------------------
   one stream of random numbers per tracer and step; the step as a whole stays below `longest`, so
   that no path leaves what the rank knows
------------------------------------------------------------------------- */

void FixDCMTracer::walk_all()
{
  double **x = atom->x, **hold = neighbor->get_xhold();
  const double dt = update->dt / substeps, sigma = std::sqrt(2.0 * D * dt);
  const double most = MOST_SIGMA * sigma, most_whole = MOST_SIGMA * std::sqrt(2.0 * D * update->dt) +
      drift * update->dt;
  for (const int i : mine) {
    dcm::Tracer t = load(i);
    const Vec3 start = t.x;
    dcm::Random random(seed, atom->tag[i], update->ntimestep, dcm::RandomPurpose::TRACER);
    for (int n = 0; n < substeps; n++) {
      Vec3 d = sigma * random.gaussian_vector();
      const double length = d.norm();
      if (length > most) d *= most / length;
      if (drift > 0.0 && t.home != dcm::Tracer::OUTSIDE) {
        const int row = cell->cells().find((tagint) t.home);
        for (int k = 0; k < 3; k++) d[k] += drift * dt * (*polarity)(row, polarity_field + k);
      }
      const dcm::Tracer last = t;
      walk.walk(t, d);
      if (substeps > 1 && (t.x - start).norm() > most_whole) {
        if (t.home != last.home) walk.count.exits--;
        t = last;
      }
    }
    store(i, t);
    // a step of a tracer is no reason to rebuild neighbor lists, in which it is not
    if (hold) vec(hold[i]) = vec(x[i]);
  }
}

/* ----------------------------------------------------------------------
   the box around all nodes, at set times; tracers outside that are far from it
------------------------------------------------------------------------- */

void FixDCMTracer::look_far()
{
  bool follows = false;
  for (int k = 0; k < 3; k++)
    follows |= domain->boundary[k][0] >= 2 || domain->boundary[k][1] >= 2;
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

/* ----------------------------------------------------------------------
   faces near tracers that are outside, also those of other ranks
------------------------------------------------------------------------- */

void FixDCMTracer::touch_faces(double range, std::vector<int> &result)
{
  std::vector<int> all(atom->nlocal + atom->nghost, 0);
  dcm::Voxels wide;
  const bool far_reaching = range > walk.near;
  if (far_reaching && !mine.empty())
    wide.build(faces, std::max(VOXEL * kept.scale, 0.4 * range), range);
  Walk look(faces, far_reaching ? wide : voxels);
  for (const int i : mine) {
    const tagint *const state = dcm->vertex[i];
    if (state[AtomVecDCM::HOME] != 0 || state[AtomVecDCM::HOST] != 0) continue;
    look.touch(vec(atom->x[i]), range, [&](int f) {
      all[cell->faces()[f].atom] = 1;
    });
  }
  touched = &all;
  comm->reverse_comm(this, 1);
  touched = nullptr;
  result.assign(all.begin(), all.begin() + atom->nlocal);
}

/* ---------------------------------------------------------------------- */

int FixDCMTracer::pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/, int * /*pbc*/)
{
  for (int m = 0; m < n; m++) buf[m] = shut[list[m]];
  return n;
}

void FixDCMTracer::unpack_forward_comm(int n, int first, double *buf)
{
  for (int m = 0; m < n; m++) shut[first + m] = (int) buf[m];
}

int FixDCMTracer::pack_reverse_comm(int n, int first, double *buf)
{
  for (int m = 0; m < n; m++) buf[m] = (*touched)[first + m];
  return n;
}

void FixDCMTracer::unpack_reverse_comm(int n, int *list, double *buf)
{
  for (int m = 0; m < n; m++)
    if (buf[m] != 0.0) (*touched)[list[m]] = 1;
}

/* ----------------------------------------------------------------------
   what has happened, on all ranks and in earlier runs
------------------------------------------------------------------------- */

dcm::TracerCounts FixDCMTracer::summed() const
{
  dcm::TracerCounts all = before;
  dcm::TracerCounts sum = walk.count;
  static_assert(sizeof(sum) % sizeof(std::int64_t) == 0, "counts only");
  MPI_Allreduce(MPI_IN_PLACE, &sum, sizeof(sum) / sizeof(std::int64_t), MPI_INT64_T, MPI_SUM, world);
  all.add(sum);
  return all;
}

std::int64_t FixDCMTracer::summed_deleted() const
{
  std::int64_t sum = deleted;
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_INT64_T, MPI_SUM, world);
  return sum + deleted_before;
}

/* ----------------------------------------------------------------------
   inside, outside, exits, swept, caught now, rejected, capped, deleted, blocked
------------------------------------------------------------------------- */

double FixDCMTracer::compute_vector(int n)
{
  enum { INSIDE, OUTSIDE, EXITS, SWEPT, CAUGHT, REJECTED, CAPPED, DELETED, BLOCKED };
  if (n == INSIDE || n == OUTSIDE || n == CAUGHT) {
    bigint sum = 0;
    for (int i = 0; i < atom->nlocal; i++) {
      if (dcm->kind[i] != AtomVecDCM::TRACER) continue;
      const tagint *const state = dcm->vertex[i];
      if (n == CAUGHT)
        sum += state[AtomVecDCM::HOST] != 0;
      else
        sum += (state[AtomVecDCM::HOME] != 0) == (n == INSIDE);
    }
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_LMP_BIGINT, MPI_SUM, world);
    return (double) sum;
  }
  if (n == DELETED) return (double) summed_deleted();
  const auto all = summed();
  switch (n) {
    case EXITS:
      return (double) all.exits;
    case SWEPT:
      return (double) all.swept;
    case REJECTED:
      return (double) all.rejected;
    case CAPPED:
      return (double) all.capped;
    default:
      return (double) all.blocked;
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMTracer::write_restart(FILE *fp)
{
  const auto all = summed();
  const auto all_deleted = summed_deleted();
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(kept);
  record.put(all);
  record.put(all_deleted);
  record.write(fp);
}

void FixDCMTracer::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(kept);
  record.get(before);
  record.get(deleted_before);
  restored = true;
}

double FixDCMTracer::memory_usage()
{
  return voxels.memory_usage() + faces.memory_usage() +
         (double) sizeof(int) * (mine.capacity() + shut.capacity()) +
         (double) sizeof(double) * last_place.capacity();
}
