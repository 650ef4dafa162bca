/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: settings, types and their parameters, lengths

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_deck_check.h"
#include "law/jkr.h"
#include "law/volume.h"
#include "error.h"
#include "fix.h"
#include "fix_dcm_cell.h"
#include "fix_neigh_history.h"
#include "force.h"
#include "math_const.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static const std::string STYLE = "Pair style dcm/contact";
static const std::vector<std::string> PARAMETERS = {
    "E_contact",           "nu_contact", "layer", "W",  "friction_normal",
    "friction_tangential", "a1",         "a2",    "a3", "a4"};
static constexpr int NREGION = AtomVecDCM::NREGION;

// in mean edge lengths: the limit of a resolved h0 (see the doc page)

static constexpr double H0_RESOLVED = 0.2;

// range follows the cell of the longest edges where these are this many times the mean of all

static constexpr double UNLIKE = 1.5;

// thickness of the layer of law foundation, um: that of a thin cell cortex, with which cells keep
// their volumes up to 5 kPa [ours]

static constexpr double LAYER = 0.1;

// more than any deck can need: neighbor skin in radii of the largest cell, growth of radii

static constexpr double MOST_SKIN = 10.0, MOST_GROWTH = 100.0;

// mean edge of a mesh of 162 nodes, in radii of the cell

static constexpr double EDGE = 0.3;

/* ---------------------------------------------------------------------- */

PairDCMContact::PairDCMContact(LAMMPS *lmp) :
    Pair(lmp), parameters(std::make_unique<DCMParameters>(lmp, STYLE, PARAMETERS)), dcm(nullptr),
    fix_cell(nullptr), fix_history(nullptr), nclass(0), have_spheres(false), have_faces(false),
    expect_new(false), expect_spheres(false), expect_faces(false), any_apparent(false),
    use_history(false), want_stress(false), want_partners(false), want_blocks(false),
    mean_edge(0.0), cell_radius(0.0), built(-1), commmode(SUMS)
{
  AtomVecDCM::require(lmp, STYLE);
  single_enable = 0;
  one_coeff = 1;
  manybody_flag = 1;    // forces of a pair act on up to six atoms
  finitecutflag = 1;
  beyond_contact = 1;    // a neck outlives the overlap: history is kept for all listed pairs
  centroidstressflag = CENTROID_NOTAVAIL;
  comm_forward = 1;
  comm_reverse = 3 + 6;    // SUMS: area, stress, virial of spheres and that as a tensor
  nextra = 6;
  pvector = new double[nextra]();

  // placeholder for the contact history, so that it keeps this place in the list of fixes

  modify->add_fix("NEIGH_HISTORY_DCM_DUMMY all DUMMY");
}

PairDCMContact::~PairDCMContact()
{
  if (copymode) return;
  take_back();
  modify->delete_fix(fix_history ? "NEIGH_HISTORY_DCM" : "NEIGH_HISTORY_DCM_DUMMY");
  delete[] pvector;
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

void PairDCMContact::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) setflag[i][j] = 0;
}

/* ----------------------------------------------------------------------
   global settings; lengths already derived from the mesh stay, unless the
   deck changes what they derive from
------------------------------------------------------------------------- */

void PairDCMContact::settings(int narg, char **arg)
{
  Settings now;
  DCMArgs args(lmp, STYLE, narg, arg,
               {"law", "branch", "points", "h0", "rmax", "range", "concave", "maxoverlap", "growth",
                "facing"});
  while (args.next()) {
    if (args.is("law")) {
      now.law = args.choose(law_names());
    } else if (args.is("branch")) {
      now.history = args.choose({"cutoff", "history"});
    } else if (args.is("concave")) {
      now.concave = args.choose({"flat", "negative"});
    } else if (args.is("points")) {
      now.points = (int) args.whole(1, 4);
    } else if (args.is("h0")) {
      now.h0_auto = args.word("auto");
      now.h0 = args.number(DCMArgs::POSITIVE);
    } else if (args.is("rmax")) {
      now.rmax = args.number(DCMArgs::POSITIVE);
      args.check(now.rmax >= 1.0, "at least 1 (a round cell)");
    } else if (args.is("range")) {
      now.range = args.number(DCMArgs::POSITIVE);
    } else if (args.is("maxoverlap")) {
      now.maxoverlap = args.number(DCMArgs::POSITIVE);
    } else if (args.is("facing")) {
      args.need(2);
      const double full = args.number(DCMArgs::NONNEGATIVE);
      const double none = args.number(DCMArgs::POSITIVE);
      args.check(full < none && none <= 90.0, "two angles in degrees, of full weight and of none, "
                                              "0 <= A1 < A2 <= 90");
      now.facing = {std::cos(MathConst::DEG2RAD * none), std::cos(MathConst::DEG2RAD * full)};
    } else {
      now.growth = args.number(DCMArgs::POSITIVE);
      args.check(now.growth >= 1.0, "at least 1 (no growth)");
      args.check(now.growth <= MOST_GROWTH, "at most 100 (radii, not volumes)");
    }
  }
  if (now.history && !LAWS[now.law].with_history[0])
    error->all(FLERR, "{}: branch history is for law maugis; law {} has no neck to remember", STYLE,
               LAWS[now.law].name);
  if (now.h0_auto != set.h0_auto || now.h0 != set.h0) h0_used = 0.0;
  bool anew = now.growth != set.growth;
  if (range_used > 0.0 && (now.range != set.range || h0_used == 0.0)) {
    range_used = 0.0;
    anew = true;
  }
  if (anew) forget_layout();
  set = now;
}

void PairDCMContact::forget_layout()
{
  laid_out.clear();
  bin_edge = wide_bin = face_reach = sphere_growth = 0.0;
}

/* ----------------------------------------------------------------------
   pair_coeff * * [FILE name1 ... nameN] [keyword value ...]
------------------------------------------------------------------------- */

void PairDCMContact::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  if (narg < 2 || strcmp(arg[0], "*") != 0 || strcmp(arg[1], "*") != 0)
    error->all(FLERR, "{}: expected 'pair_coeff * * [FILE name1 ... nameN] [keyword value ...]'",
               STYLE);
  parameters = std::make_unique<DCMParameters>(lmp, STYLE, PARAMETERS);
  DCMArgs args(lmp, STYLE + ", pair_coeff", narg - 2, arg + 2, {});
  parameters->parse(args, atom->ntypes);
  while (args.next()) parameters->parse_keyword(args);
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) setflag[i][j] = 1;
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::init_style()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  if (!force->newton_pair) error->all(FLERR, "{} needs newton on; remove 'newton off'", STYLE);
  dcm_check_deck(lmp, STYLE);

  traits_of_deck = traits_of(lmp);
  set_sisters({});
  built = -1;
  warned_filled = warned_overlap = false;

  parameters->resolve();
  scan_types();
  expect_types();
  fix_cell = nullptr;
  if (have_faces || has_fix_cell()) fix_cell = FixDCMCell::require(lmp, STYLE);
  measure_mesh();
  choose_lengths();
  lay_out();
  read_types();
  if (fix_cell) {
    curvature = fix_cell->request_curvature();
    contact_range = fix_cell->request_contact_range(range_used);
  }
  exclude_types();
  dcm_warn_excluded(lmp, STYLE);
  set_cutoff();
  setup_history();
  choose_collections();
}

/* ----------------------------------------------------------------------
   the one kind of atoms each type holds, and the largest sphere
------------------------------------------------------------------------- */

void PairDCMContact::scan_types()
{
  const int ntypes = atom->ntypes;
  std::vector<int> seen(ntypes + 1, 0);
  std::vector<double> radius(ntypes + 1, 0.0);
  int nomolecule = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    seen[atom->type[i]] |= 1 << dcm->kind[i];
    if (dcm->kind[i] == AtomVecDCM::CENTER)
      radius[0] = std::max(radius[0], dcm::ball_radius(dcm->volume0[i]));
    if (dcm->kind[i] != AtomVecDCM::SPHERE) continue;
    radius[atom->type[i]] = std::max(radius[atom->type[i]], atom->radius[i]);
    if (atom->molecule[i] == 0) nomolecule = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, seen.data(), ntypes + 1, MPI_INT, MPI_BOR, world);
  MPI_Allreduce(MPI_IN_PLACE, radius.data(), ntypes + 1, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(MPI_IN_PLACE, &nomolecule, 1, MPI_INT, MPI_MAX, world);
  if (nomolecule)
    error->all(FLERR, "{}: a sphere has molecule ID 0; every cell needs a molecule ID of its own",
               STYLE);

  static const char *const names[] = {"none", "sphere", "center", "node", "face", "tracer"};
  cell_radius = radius[0];
  have_spheres = have_faces = false;
  types.assign(ntypes + 1, TypeInfo());
  for (int t = 1; t <= ntypes; t++) {
    TypeInfo &info = types[t];
    info.used = parameters->used(t);
    for (int kind = AtomVecDCM::SPHERE; kind <= AtomVecDCM::TRACER; kind++) {
      if (!(seen[t] & (1 << kind))) continue;
      if (info.kind)
        error->all(FLERR,
                   "{}: atom type {} holds atoms of kind {} and of kind {}; give each kind atom "
                   "types of its own",
                   STYLE, t, names[info.kind], names[kind]);
      info.kind = kind;
    }
    info.radius = radius[t];
    info.active = info.used && (info.kind == 0 || info.kind == AtomVecDCM::FACE ||
                                info.kind == AtomVecDCM::SPHERE);
    if (info.kind == AtomVecDCM::FACE) have_faces = true;
    if (info.used && info.kind == AtomVecDCM::SPHERE) have_spheres = true;
  }
}

/* ----------------------------------------------------------------------
   what may come in this run: where something makes cells or changes their
   kind, types without atoms may get faces (not without a fix dcm/cell) or
   spheres
------------------------------------------------------------------------- */

void PairDCMContact::expect_types()
{
  expect_new = (traits_of_deck & MAKES_CELLS) &&
               std::any_of(types.begin(), types.end(), [](const TypeInfo &info) {
                 return info.active && info.kind == 0;
               });
  expect_faces = have_faces || (expect_new && has_fix_cell());
  expect_spheres = have_spheres || expect_new;
}

bool PairDCMContact::has_fix_cell() const
{
  const auto *const fix = FixDCMCell::find(lmp);
  return fix && fix->expects_deformable();
}

/* ----------------------------------------------------------------------
   h0 and range, chosen once: a mesh that grows must not change them between
   runs. Rounded, so that they do not depend on the number of ranks. For cells
   that come in the run, a guess: kept if they do, made good if the deck makes
   them before the next run.
------------------------------------------------------------------------- */

double PairDCMContact::round_up(double value)
{
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::ceil(value / unit - 1.0e-6) * unit;
}

void PairDCMContact::choose_lengths()
{
  std::string chosen;
  if (!expect_faces) {
    // nothing to derive lengths from yet; spheres use neither
    check_scale();
    if (h0_used == 0.0) overlap_used = 0.0;
    return;
  }
  if (!have_faces) {
    for (const auto &info : types)
      if (info.kind == AtomVecDCM::SPHERE) mean_edge = std::max(mean_edge, EDGE * info.radius);
  } else if (guessed != 0.0) {
    h0_used = range_used = guessed = 0.0;
    forget_layout();
  }
  if (h0_used == 0.0) {
    h0_used = set.h0;
    if (set.h0_auto && dcm::H0_AUTO * mean_edge > set.h0)
      h0_used = round_up(dcm::H0_AUTO * mean_edge);
    if (set.h0_auto) chosen += fmt::format(", h0 {:.6g}", h0_used);
  }
  if (range_used == 0.0) {
    range_used = set.range;
    if (range_used == 0.0) {
      const double edge = largest_edge > UNLIKE * mean_edge ? largest_edge : mean_edge;
      range_used = round_up(std::max(RANGE * edge, 2.0 * h0_used));
      chosen += fmt::format(", range {:.6g}", range_used);
    }
  }
  check_scale();
  overlap_used = set.maxoverlap > 0.0 ? set.maxoverlap : range_used;
  if (range_used < h0_used || overlap_used > range_used)
    error->all(FLERR, "{}: range is {}, must not be below h0 ({}) and maxoverlap ({})", STYLE,
               range_used, h0_used, overlap_used);
  if (!chosen.empty() && comm->me == 0)
    utils::logmesg(lmp, "{}: {} {:.6g}{}{}\n", STYLE,
                   have_faces ? "mean edge" : "no faces yet, mean edge taken as", mean_edge,
                   largest_edge > UNLIKE * mean_edge
                       ? fmt::format(", of the coarsest cell {:.6g}", largest_edge)
                       : "",
                   chosen);
  if (!chosen.empty() && !have_faces) guessed = 1.0;
  if (!warned_h0 && have_faces && h0_used < H0_RESOLVED * mean_edge) {
    warned_h0 = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "{}: the range of adhesion h0 = {:.4g} is not resolved by the mesh, mean edge "
                     "{:.4g}: contact lines may be pinned. Use h0 of at least {:.4g} (h0 auto) or "
                     "edges of at most {:.4g}",
                     STYLE, h0_used, mean_edge, H0_RESOLVED * mean_edge, h0_used / H0_RESOLVED);
  }
}

/* ----------------------------------------------------------------------
   lengths that would reach over whole cells: of another unit than the deck's, most often. Ghosts of
   many periodic images would take all memory, and without them the numbers would be wrong.
------------------------------------------------------------------------- */

void PairDCMContact::check_scale()
{
  double size = cell_radius;
  for (const auto &info : types)
    if (info.kind == AtomVecDCM::SPHERE) size = std::max(size, info.radius);
  if (size == 0.0) return;
  if (expect_faces && h0_used >= size)
    error->all(FLERR,
               "{}: h0 is {:.4g}{}, must be below a cell radius, which is {:.4g} at most: are the "
               "lengths of deck and parameters in one unit? Give h0 in that of the deck",
               STYLE, h0_used, set.h0_auto ? " (h0 auto, at least that)" : "", size);
  if (expect_faces && range_used >= 2.0 * size)
    error->all(FLERR,
               "{}: range is {:.4g}, must be below a cell's diameter, which is {:.4g} at most: are "
               "the lengths of deck and parameters in one unit?",
               STYLE, range_used, 2.0 * size);
  for (int t = 1; set.law == FOUNDATION && t <= atom->ntypes; t++) {
    if (!types[t].active) continue;
    const double layer = parameters->get(t, "layer", DCMParameters::POSITIVE, LAYER);
    if (layer >= size)
      error->all(
          FLERR,
          "{}: layer of cell type {} is {:.4g}{}, must be below a cell radius, which is "
          "{:.4g} at most: are the lengths of deck and parameters in one unit? Give layer in "
          "that of the deck",
          STYLE, parameters->name(t), layer, parameters->has(t, "layer") ? "" : " (the default)",
          size);
  }
  if (neighbor->skin > MOST_SKIN * size)
    error->all(
        FLERR,
        "{}: the neighbor skin is {:.4g}, {:.3g} times the largest cell radius ({:.4g}): are "
        "the lengths of deck and parameters in one unit? Set 'neighbor {:.3g} multi'",
        STYLE, neighbor->skin, neighbor->skin / size, size, 0.1 * size);
}

/* ----------------------------------------------------------------------
   parameters per type, and the contact of each two classes of surface
   (class = atom type and region) in one table
------------------------------------------------------------------------- */

void PairDCMContact::read_types()
{
  const int ntypes = atom->ntypes;
  any_apparent = false;
  for (int t = 1; t <= ntypes; t++) {
    TypeInfo &info = types[t];
    if (!info.active) continue;
    info.E = parameters->get(t, "E_contact", DCMParameters::POSITIVE);
    info.nu = parameters->get(t, "nu_contact", DCMParameters::ANY);
    if (!(info.nu > -1.0 && info.nu <= 0.5))
      error->all(FLERR, "{}: nu_contact of cell type {} is {}, must be above -1 and at most 0.5",
                 STYLE, parameters->name(t), info.nu);
    info.layer = parameters->get(t, "layer", DCMParameters::POSITIVE, LAYER);
    info.gn = parameters->get(t, "friction_normal", DCMParameters::NONNEGATIVE, 0.0);
    info.gt = parameters->get(t, "friction_tangential", DCMParameters::NONNEGATIVE, 0.0);
    for (int k = 0; k < 4; k++) {
      info.a[k] = parameters->get(t, fmt::format("a{}", k + 1), DCMParameters::ANY, 0.0);
      const bool sphere = info.kind == AtomVecDCM::SPHERE || (info.kind == 0 && expect_spheres);
      if (sphere && info.a[k] != 0.0) any_apparent = true;
    }
  }

  report_layers();

  nclass = NREGION * ntypes;
  table.assign((size_t) nclass * nclass, dcm::ContactMaterial());
  double neck = 0.0;
  auto sphere = [this](const TypeInfo &info) {
    return info.promise - (info.kind ? 0.0 : 0.5 * range_used);    // as lay_out() has it
  };
  for (int s = 1; s <= ntypes; s++)
    for (int t = 1; t <= ntypes; t++) {
      const TypeInfo &a = types[s], &b = types[t];
      if (!a.active || !b.active) continue;
      for (int p = 0; p < NREGION; p++)
        for (int q = 0; q < NREGION; q++) {
          auto &m = table[(size_t) (NREGION * (s - 1) + p) * nclass + NREGION * (t - 1) + q];
          m.E = dcm::effective_modulus(a.E, a.nu, b.E, b.nu);
          m.W = parameters->adhesion(s, p, t, q);
          m.h0 = h0_used > 0.0 ? h0_used : set.h0;
          m.gn = 0.5 * (a.gn + b.gn);
          m.k = dcm::foundation_stiffness(a.layer, a.E, a.nu, b.layer, b.E, b.nu);
          const bool faces = may_be(a, AtomVecDCM::FACE) || may_be(b, AtomVecDCM::FACE);
          const bool met = may_be(a, a.kind ? a.kind : AtomVecDCM::FACE) &&
                           may_be(b, b.kind ? b.kind : AtomVecDCM::FACE);
          if (set.law == FOUNDATION && faces && met) {    // neither spheres nor empty types
            const double stretch = dcm::foundation_range(m.k, m.W);
            if (range_used > 0.0 && stretch > range_used)
              error->all(FLERR,
                         "{}: atom types {} and {}: W = {:.4g} stretches layers of stiffness "
                         "{:.4g} by {:.4g} before they part, which is more than range ({:.4g}); "
                         "make layers thinner or E_contact larger, or raise keyword range",
                         STYLE, s, t, m.W, m.k, stretch, range_used);
            m.h0 = std::max(m.h0, stretch);
          }
          m.gt = 0.5 * (a.gt + b.gt);
          if (p || q || !may_be(a, AtomVecDCM::SPHERE) || !may_be(b, AtomVecDCM::SPHERE)) continue;
          const double R = dcm::effective_radius(sphere(a), sphere(b));
          const dcm::JKR jkr = {m.E, R, m.W};
          neck = std::max(neck, -jkr.pull_off_displacement());
        }
    }
  if (neck > neighbor->skin)
    error->all(FLERR,
               "{}: the adhesive neck between two spheres reaches {:.4} beyond touch, but the "
               "neighbor list only {:.4}; set 'neighbor {:.4} bin' (or multi) or more",
               STYLE, neck, neighbor->skin, round_up(neck));
}

/* ----------------------------------------------------------------------
   law foundation: the range of its stiffness, when it is new
------------------------------------------------------------------------- */

void PairDCMContact::report_layers()
{
  if (set.law != FOUNDATION) {
    stiffest = 0.0;
    if (parameters->by_keyword("layer"))
      error->all(FLERR,
                 "{}: keyword layer is for law foundation; law {} has no layer, remove it or say "
                 "'pair_style dcm/contact law foundation'",
                 STYLE, LAWS[set.law].name);
    return;
  }
  double least = 0.0, most = 0.0;
  for (const auto &a : types)
    for (const auto &b : types) {
      if (!a.active || !b.active) continue;
      const double k = dcm::foundation_stiffness(a.layer, a.E, a.nu, b.layer, b.E, b.nu);
      least = least > 0.0 ? std::min(least, k) : k;
      most = std::max(most, k);
    }
  if (most != stiffest && comm->me == 0)
    utils::logmesg(lmp, "{}: law foundation, stiffness per area {:.6g} to {:.6g}\n", STYLE, least,
                   most);
  stiffest = most;
}

/* ---------------------------------------------------------------------- */

void *PairDCMContact::extract(const char *name, int &dim)
{
  dim = 0;
  if (strcmp(name, "h0") == 0) return &h0_used;
  if (strcmp(name, "range") == 0) return &range_used;
  if (strcmp(name, "stiffness") == 0) return &stiffest;    // per area, 0: not law foundation
  if (strcmp(name, "overlap") == 0) return &overlap;
  if (strcmp(name, "filled") == 0) return &filled;
  return nullptr;
}

double PairDCMContact::memory_usage()
{
  double bytes = Pair::memory_usage();
  bytes += (double) (face_pairs.capacity() + mixed_pairs.capacity() + sphere_pairs.capacity()) *
           sizeof(FacePair);
  bytes += (double) (face_touch.capacity() + mixed_touch.capacity() + sphere_touch.capacity()) *
           sizeof(int *);
  bytes += (double) geometry.capacity() * sizeof(dcm::FaceGeometry);
  bytes += (double) (area.capacity() + stress.capacity() + moment.capacity() + tensor.capacity() +
                     modulus.capacity()) *
           sizeof(double);
  bytes += (double) contacts.capacity() * sizeof(dcm::ContactBlock);
  bytes += (double) (spheres.capacity() + sphere_stiffness.capacity()) * sizeof(dcm::EdgeBlock);
  bytes += (double) contact_slope.capacity() * sizeof(Slope);
  bytes += (double) table.capacity() * sizeof(dcm::ContactMaterial);
  return bytes;
}
