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
#include "dcm_slots.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
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

static constexpr double VOXEL = 0.4;    // edge of a voxel, in edges of the mesh

// more tracers of a cell, and more sub-steps, do not end within a day

static constexpr int MOST_TRACERS = 100000, MOST_SUBSTEPS = 1000;

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
               type == 0    ? "type"
               : number < 0 ? "number"
               : D < 0.0    ? "D"
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
  // with cutoffs per type a rank may know fewer faces than the ghost cutoff says
  if (comm->style != Comm::BRICK)
    error->all(FLERR, "{} needs 'comm_style brick'; comm_style tiled is not supported", STYLE);
  if (comm->mode != Comm::SINGLE) error->all(FLERR, "{} needs 'comm_modify mode single'", STYLE);

  // a daughter of a secreting cell shares her mother's tracers, or gets her own as well

  secretes = cell->change_cells().add(
      STYLE, "secretes", topup ? DCMColumn::RESET : DCMColumn::INHERIT, 0.0, {}, secretes);
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
      error->all(FLERR,
                 "{}: slab {} {} {} lies outside the box, which reaches from {:.4g} to {:.4g}",
                 STYLE, "xyz"[slab_axis], slab_lo, slab_hi, lo, hi);
    if (domain->periodicity[slab_axis] && (slab_lo < lo || slab_hi > hi))
      error->all(
          FLERR,
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
    error->all(
        FLERR,
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
   faces and tracers have new numbers
------------------------------------------------------------------------- */

void FixDCMTracer::post_neighbor()
{
  mine.clear();
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::TRACER) mine.push_back(i);
  double most[2] = {0.0, (double) mine.size()};
  for (const auto &face : cell->faces()) most[0] = std::max(most[0], atom->radius[face.atom]);
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, world);
  largest = most[0];
  anywhere = most[1] > 0.0;
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
  int rebuild = any_needy();
  if (anywhere) {
    const double moved = moved_since_settled();
    refresh_faces();
    settle_all(moved);
    walk_all();
    look_far();
    ask_for_rebuild(rebuild);
  }
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
  int j = dcm_index_of(atom, host);
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
  error->one(
      FLERR,
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
  const double most = MOST_SIGMA * sigma,
               most_whole = MOST_SIGMA * std::sqrt(2.0 * D * update->dt) + drift * update->dt;
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
   faces near tracers that are outside, also those of other ranks
------------------------------------------------------------------------- */

void FixDCMTracer::touch_faces(double range, std::vector<int> &result)
{
  if (range > asked) {    // tracers ask for a rebuild earlier; an error if ranks know too little
    asked = range;
    set_limits();
  }
  result.assign(atom->nlocal, 0);
  if (!anywhere) return;
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
