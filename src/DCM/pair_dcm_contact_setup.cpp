/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: settings, types and their parameters, lengths, restart files

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_jkr.h"
#include "error.h"
#include "fix.h"
#include "fix_dcm_cell.h"
#include "fix_neigh_history.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static const std::string STYLE = "Pair style dcm/contact";
static constexpr int NREGION = AtomVecDCM::NREGION;

// in mean edge lengths: `h0 auto`, the limit of a resolved h0, default range (see the doc page)

static constexpr double H0_AUTO = 0.22, H0_RESOLVED = 0.2, RANGE = 0.75;

/* ---------------------------------------------------------------------- */

PairDCMContact::PairDCMContact(LAMMPS *lmp) :
    Pair(lmp), parameters(std::make_unique<DCMParameters>(lmp, STYLE)), dcm(nullptr),
    fix_cell(nullptr), fix_history(nullptr), nclass(0), have_spheres(false), have_faces(false),
    any_apparent(false), use_history(false), want_stress(false), want_partners(false),
    want_blocks(false), mean_edge(0.0), face_radius_max(0.0), own_cutoff(0.0), built(-1),
    checked_step(-1), checked_atoms(-1), commmode(SUMS)
{
  AtomVecDCM::require(lmp, STYLE);
  single_enable = 0;
  one_coeff = 1;
  manybody_flag = 1;    // forces of a pair act on up to six atoms
  finitecutflag = 1;
  beyond_contact = 1;    // a neck outlives the overlap: history is kept for all listed pairs
  centroidstressflag = CENTROID_NOTAVAIL;
  comm_forward = 1;
  comm_reverse = 3;
  nextra = 4;
  pvector = new double[nextra]();

  // placeholder for the contact history, so that it keeps this place in the list of fixes

  modify->add_fix("NEIGH_HISTORY_DCM_DUMMY all DUMMY");
}

PairDCMContact::~PairDCMContact()
{
  if (copymode) return;
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
  auto choose = [&](const char *key, const char *text, const std::vector<std::string> &names) {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end())
      error->all(FLERR, "{}: {} is {}, must be one of: {}", STYLE, key, text,
                 utils::join_words(names, " "));
    return (int) (found - names.begin());
  };

  for (int iarg = 0; iarg < narg; iarg += 2) {
    const std::string key = arg[iarg];
    if (iarg + 2 > narg) error->all(FLERR, "{}: keyword {} needs a value", STYLE, key);
    const char *text = arg[iarg + 1];
    if (key == "law") {
      now.law = choose("law", text, {"dmt", "maugis"});
    } else if (key == "branch") {
      now.history = choose("branch", text, {"cutoff", "history"});
    } else if (key == "concave") {
      now.concave = choose("concave", text, {"flat", "negative"});
    } else if (key == "points") {
      if (strlen(text) != 1 || text[0] < '1' || text[0] > '4')
        error->all(FLERR, "{}: points is {}, must be 1 to 4", STYLE, text);
      now.points = text[0] - '0';
    } else if (key == "h0") {
      now.h0_auto = strcmp(text, "auto") == 0;
      if (now.h0_auto) {
        iarg++;
        if (iarg + 2 > narg) error->all(FLERR, "{}: keyword h0 auto needs a value", STYLE);
        text = arg[iarg + 1];
      }
      now.h0 = parameters->number("h0", text, DCMParameters::POSITIVE);
    } else if (key == "rmax") {
      now.rmax = parameters->number("rmax", text, DCMParameters::POSITIVE);
      if (now.rmax < 1.0)
        error->all(FLERR, "{}: rmax is {}, must be at least 1 (a round cell)", STYLE, now.rmax);
    } else if (key == "range") {
      now.range = parameters->number("range", text, DCMParameters::POSITIVE);
    } else if (key == "maxoverlap") {
      now.maxoverlap = parameters->number("maxoverlap", text, DCMParameters::POSITIVE);
    } else {
      error->all(FLERR,
                 "{}: unknown keyword {}; known: law branch points h0 rmax range concave "
                 "maxoverlap",
                 STYLE, key);
    }
  }
  if (now.history && now.law != MAUGIS)
    error->all(FLERR, "{}: branch history is for law maugis; law dmt has no neck to remember",
               STYLE);
  if (now.h0_auto != set.h0_auto || now.h0 != set.h0) h0_used = 0.0;
  if (now.range != set.range || h0_used == 0.0) range_used = 0.0;
  set = now;
}

/* ----------------------------------------------------------------------
   pair_coeff * * FILE name1 ... nameN [keyword value ...]
------------------------------------------------------------------------- */

void PairDCMContact::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  if (narg < 3 || strcmp(arg[0], "*") != 0 || strcmp(arg[1], "*") != 0)
    error->all(FLERR, "{}: expected 'pair_coeff * * FILE name1 ... nameN [keyword value ...]'",
               STYLE);
  static const std::vector<std::string> known = {
      "E_contact", "nu_contact", "W", "friction_normal", "friction_tangential", "a1",
      "a2",        "a3",         "a4"};
  parameters = std::make_unique<DCMParameters>(lmp, STYLE);
  int iarg = 2 + parameters->parse(narg - 2, arg + 2, atom->ntypes);
  while (iarg < narg) {
    const int used = parameters->parse_keyword(narg - iarg, arg + iarg, known);
    if (!used)
      error->all(FLERR, "{}: unknown pair_coeff keyword {}; known: {}", STYLE, arg[iarg],
                 utils::join_words(known, " "));
    iarg += used;
  }
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) setflag[i][j] = 1;
}

/* ---------------------------------------------------------------------- */

void PairDCMContact::init_style()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  if (!force->newton_pair) error->all(FLERR, "{} needs newton on; remove 'newton off'", STYLE);

  // others ask for these in their init(), which comes later

  want_stress = want_partners = want_virial = false;
  want_blocks = !modify->get_fix_by_style("^dcm/motion").empty();
  built = -1;

  scan_types();
  fix_cell = nullptr;
  if (have_faces || !modify->get_fix_by_style("^dcm/cell$").empty())
    fix_cell = FixDCMCell::require(lmp, STYLE);
  measure_mesh();
  choose_lengths();
  read_types();
  if (fix_cell) {
    fix_cell->request_curvature();
    fix_cell->set_contact_range(range_used);
  }
  exclude_types();
  set_cutoff();
  setup_history();
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
   h0 and range, chosen once: a mesh that grows must not change them between
   runs. Rounded, so that they do not depend on the number of ranks.
------------------------------------------------------------------------- */

double PairDCMContact::round_up(double value)
{
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::ceil(value / unit - 1.0e-6) * unit;
}

void PairDCMContact::choose_lengths()
{
  std::string chosen;
  if (!have_faces) {
    // nothing to derive lengths from yet; spheres use neither
    if (h0_used == 0.0) overlap_used = 0.0;
    return;
  }
  if (h0_used == 0.0) {
    h0_used = set.h0;
    if (set.h0_auto && H0_AUTO * mean_edge > set.h0) h0_used = round_up(H0_AUTO * mean_edge);
    if (set.h0_auto) chosen += fmt::format(", h0 {:.6g}", h0_used);
  }
  if (range_used == 0.0) {
    range_used = set.range;
    if (range_used == 0.0) {
      range_used = std::max(round_up(RANGE * mean_edge), round_up(2.0 * h0_used));
      chosen += fmt::format(", range {:.6g}", range_used);
    }
  }
  overlap_used = set.maxoverlap > 0.0 ? set.maxoverlap : range_used;
  if (range_used < h0_used || overlap_used > range_used)
    error->all(FLERR, "{}: range is {}, must not be below h0 ({}) and maxoverlap ({})", STYLE,
               range_used, h0_used, overlap_used);
  if (!chosen.empty() && comm->me == 0)
    utils::logmesg(lmp, "{}: mean edge {:.6g}{}\n", STYLE, mean_edge, chosen);
  if (!warned_h0 && h0_used < H0_RESOLVED * mean_edge) {
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
   parameters per type, and the contact of each two classes of surface
   (class = atom type and region) in one table
------------------------------------------------------------------------- */

void PairDCMContact::read_types()
{
  const int ntypes = atom->ntypes;
  const bool growing = !modify->get_fix_by_style("^dcm/(growth|division|cycle)").empty();
  double largest = 0.0;
  any_apparent = false;
  for (int t = 1; t <= ntypes; t++) {
    TypeInfo &info = types[t];
    if (info.kind == AtomVecDCM::FACE) info.promise = FACE_GROWTH * info.radius + 0.5 * range_used;
    if (info.kind == AtomVecDCM::SPHERE)
      info.promise = (growing ? SPHERE_GROWTH : 1.0) * info.radius;
    largest = std::max(largest, info.promise);
    if (!info.active) continue;
    info.E = parameters->get(t, "E_contact", DCMParameters::POSITIVE);
    info.nu = parameters->get(t, "nu_contact", DCMParameters::ANY);
    if (!(info.nu > -1.0 && info.nu <= 0.5))
      error->all(FLERR, "{}: nu_contact of cell type {} is {}, must be above -1 and at most 0.5",
                 STYLE, parameters->name(t), info.nu);
    info.gn = parameters->get(t, "friction_normal", DCMParameters::NONNEGATIVE, 0.0);
    info.gt = parameters->get(t, "friction_tangential", DCMParameters::NONNEGATIVE, 0.0);
    for (int k = 0; k < 4; k++) {
      info.a[k] = parameters->get(t, fmt::format("a{}", k + 1), DCMParameters::ANY, 0.0);
      if (info.kind == AtomVecDCM::SPHERE && info.a[k] != 0.0) any_apparent = true;
    }
  }
  for (int t = 1; t <= ntypes; t++)
    if (types[t].active && types[t].kind == 0) types[t].promise = largest;

  nclass = NREGION * ntypes;
  table.assign((size_t) nclass * nclass, dcm::ContactMaterial());
  double neck = 0.0;
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
          m.gt = 0.5 * (a.gt + b.gt);
          if (p || q || a.kind != AtomVecDCM::SPHERE || b.kind != AtomVecDCM::SPHERE) continue;
          const dcm::JKR jkr = {m.E, dcm::effective_radius(a.promise, b.promise), m.W};
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
   restart files keep the settings and the lengths derived from the mesh;
   cell types come again from pair_coeff
------------------------------------------------------------------------- */

void PairDCMContact::write_restart(FILE *fp)
{
  fwrite(&set, sizeof(Settings), 1, fp);
  fwrite(&h0_used, sizeof(double), 1, fp);
  fwrite(&range_used, sizeof(double), 1, fp);
  fwrite(&own_cutoff, sizeof(double), 1, fp);
  face_radius.resize(atom->ntypes + 1, 0.0);
  fwrite(face_radius.data(), sizeof(double), face_radius.size(), fp);
}

void PairDCMContact::read_restart(FILE *fp)
{
  face_radius.assign(atom->ntypes + 1, 0.0);
  if (comm->me == 0) {
    utils::sfread(FLERR, &set, sizeof(Settings), 1, fp, nullptr, error);
    utils::sfread(FLERR, &h0_used, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &range_used, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, &own_cutoff, sizeof(double), 1, fp, nullptr, error);
    utils::sfread(FLERR, face_radius.data(), sizeof(double), face_radius.size(), fp, nullptr,
                  error);
  }
  MPI_Bcast(&set, sizeof(Settings), MPI_BYTE, 0, world);
  MPI_Bcast(&h0_used, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&range_used, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(&own_cutoff, 1, MPI_DOUBLE, 0, world);
  MPI_Bcast(face_radius.data(), (int) face_radius.size(), MPI_DOUBLE, 0, world);
}

/* ---------------------------------------------------------------------- */

void *PairDCMContact::extract(const char *name, int &dim)
{
  dim = 0;
  if (strcmp(name, "h0") == 0) return &h0_used;
  if (strcmp(name, "range") == 0) return &range_used;
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
  bytes += (double) (area.capacity() + stress.capacity() + moment.capacity() + modulus.capacity()) *
           sizeof(double);
  bytes += (double) contacts.capacity() * sizeof(dcm::ContactBlock);
  bytes += (double) spheres.capacity() * sizeof(dcm::EdgeBlock);
  bytes += (double) table.capacity() * sizeof(dcm::ContactMaterial);
  return bytes;
}
