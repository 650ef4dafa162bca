/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_polarity.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_cell_variable.h"
#include "dcm_compat.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "law/random.h"
#include "law/volume.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/polarity";
static constexpr int RECORD = 1;    // version of the restart record

// a point nearer than this to the center of a cell, in radii, lies in no direction but round-off's

static constexpr double NEAR = 1.0e-6;

static_assert(static_cast<int>(dcm::LATERAL) == AtomVecDCM::LATERAL &&
                  static_cast<int>(dcm::POLAR) == AtomVecDCM::POLAR &&
                  static_cast<int>(dcm::APICAL) == AtomVecDCM::APICAL &&
                  static_cast<int>(dcm::JUNCTION) == AtomVecDCM::JUNCTION &&
                  static_cast<int>(dcm::BASAL) == AtomVecDCM::BASAL,
              "regions of the law are those of the atom style");

/* ----------------------------------------------------------------------
   fix ID group dcm/polarity seed S [polar a] [form cone|belt] [apical b] [basal b|none]
       [junction lo hi|auto|none] [free theta] [sees all|lumen|outside] [weight count|area]
       [plane none|x|y|z] [init random|free|toward x y z|variable v_x v_y v_z] [freeze T] [every N]
------------------------------------------------------------------------- */

FixDCMPolarity::FixDCMPolarity(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), seed(0), ribbon_auto(false), by_area(false), sees(ALL), blind(false),
    marks(nullptr), theta(0.05), axis(-1), start_mode(RANDOM), point(Vec3::Zero()), freeze(600.0),
    dcm(nullptr), cell(nullptr), contact(nullptr), begun(false), warned(false), nturned(0),
    nclosed(0)
{
  AtomVecDCM::require(lmp, STYLE);
  every = 0;
  parse(narg - 3, arg + 3);

  vector_flag = 1;
  size_vector = 5;
  extvector = 0;
  global_freq = 1;
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

void FixDCMPolarity::parse(int narg, char **arg)
{
  DCMArgs args(lmp, STYLE, narg, arg,
               {"seed", "polar", "form", "apical", "basal", "junction", "free", "sees", "weight",
                "plane", "init", "freeze", "every"});
  auto part = [&args]() {
    const double value = args.number();
    args.check(value > 0.0 && value < 1.0, "above 0 and below 1");
    return value;
  };
  bool basal_given = false;
  while (args.next()) {
    if (args.is("seed")) {
      seed = args.whole();
    } else if (args.is("polar")) {
      cones.polar = part();
    } else if (args.is("form")) {
      cones.belt = args.choose({"cone", "belt"}) == 1;
    } else if (args.is("apical")) {
      cones.apical = part();
    } else if (args.is("basal")) {
      basal_given = true;
      cones.basal = args.word("none") ? dcm::NO_REGION : part();
    } else if (args.is("junction")) {
      parse_junction(args);
    } else if (args.is("free")) {
      theta = part();
    } else if (args.is("sees")) {
      sees = args.choose({"all", "lumen", "outside"});
    } else if (args.is("weight")) {
      by_area = args.choose({"count", "area"}) == 1;
    } else if (args.is("plane")) {
      axis = args.choose({"none", "x", "y", "z"}) - 1;
    } else if (args.is("init")) {
      start_mode = (Start) args.choose({"random", "free", "toward", "variable"},
                                       "random, free, toward x y z or variable v_x v_y v_z");
      if (start_mode == TOWARD)
        for (double &coordinate : point) coordinate = args.number();
      if (start_mode == VARIABLE)
        for (auto &name : variable_name) name = args.variable();
    } else if (args.is("freeze")) {
      freeze = args.number(DCMArgs::NONNEGATIVE);
    } else {
      every = (int) args.whole();
    }
  }
  if (!basal_given) cones.basal = cones.apical;
  if (seed == 0) error->all(FLERR, "{}: keyword seed is missing; give a positive number", STYLE);
}

void FixDCMPolarity::parse_junction(DCMArgs &args)
{
  ribbon_auto = args.word("auto");
  cones.low = cones.high = dcm::NO_REGION;
  if (ribbon_auto || args.word("none")) return;
  for (double *cosine : {&cones.low, &cones.high}) {
    *cosine = args.number();
    args.check(*cosine > -1.0 && *cosine < 1.0, "two cosines above -1 and below 1, auto or none");
  }
  if (cones.low >= cones.high)
    error->all(FLERR,
               "{}: junction is {} {}, an empty ribbon; the first cosine must be below the second",
               STYLE, cones.low, cones.high);
}

/* ---------------------------------------------------------------------- */

int FixDCMPolarity::setmask()
{
  return INITIAL_INTEGRATE | PRE_FORCE;
}

/* ----------------------------------------------------------------------
   fixes of this style share the columns: a cell has one A and one P, whoever sets them
------------------------------------------------------------------------- */

void FixDCMPolarity::init()
{
  nevery = look_every(lmp, every, 10);
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (!contact)
    error->all(FLERR,
               "{}: which faces are free is known to pair_style dcm/contact; add it to the deck",
               STYLE);
  for (auto *const fix : modify->get_fix_by_style("^dcm/polarity$")) {
    const auto *const other = dynamic_cast<FixDCMPolarity *>(fix);
    if (vectors || !other->vectors) continue;
    vectors = other->vectors;
    frozen = other->frozen;
    apical_area = other->apical_area;
    junction_area = other->junction_area;
  }
  marks = DCMRole::marker_of(lmp);
  if (sees == LUMEN && !marks && !blind) {
    blind = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "{}: sees lumen, and nothing marks the faces at a lumen, so that no cell "
                     "turns; add a fix dcm/osmosis, or use sees all",
                     STYLE);
  }
  auto &table = cell->change_cells();
  vectors = table.add(STYLE, "polarity", DCMColumn::INHERIT, 0.0,
                      {"ax", "ay", "az", "px", "py", "pz"}, vectors);
  frozen = table.add(STYLE, "polarity_frozen", DCMColumn::RESET, 0.0, {}, frozen);
  apical_area = table.add(STYLE, "apical_area", DCMColumn::RESET, 0.0, {}, apical_area);
  junction_area = table.add(STYLE, "junction_area", DCMColumn::RESET, 0.0, {}, junction_area);

  if (start_mode == TOWARD) dcm_check_point(lmp, STYLE, "init toward", point.data());
  if (start_mode == VARIABLE)
    for (const auto &name : variable_name) dcm_find_variable(lmp, STYLE, name);
  for (const auto *const style :
       {"dcm/cell", "dcm/growth", "dcm/division", "dcm/death", "dcm/convert"})
    check_after(lmp, this, STYLE, style);
  check_before_motion(lmp, this, STYLE);
  cell->refresh();
  check_groups();
}

/* ----------------------------------------------------------------------
   a cell that two fixes want to orient; cells can join a group in a run
------------------------------------------------------------------------- */

void FixDCMPolarity::check_groups() const
{
  const auto &table = cell->cells();
  for (auto *const fix : modify->get_fix_by_style("^dcm/polarity$")) {
    if (fix == this) continue;
    for (const int row : table.all_deformable())
      if ((table[row].mask & groupbit) && (table[row].mask & fix->groupbit))
        error->all(FLERR,
                   "{}: cell {} is in the groups of fix {} and fix {}; groups of fixes of this "
                   "style must have no cell in common",
                   STYLE, table[row].molecule, id, fix->id);
  }
}

bool FixDCMPolarity::polar(const DCMCellTable::Cell &it) const
{
  return it.deformable && (it.mask & groupbit);
}

Vec3 FixDCMPolarity::A(int row) const
{
  return Vec3((*vectors)(row, 0), (*vectors)(row, 1), (*vectors)(row, 2));
}

Vec3 FixDCMPolarity::P(int row) const
{
  return Vec3((*vectors)(row, 3), (*vectors)(row, 4), (*vectors)(row, 5));
}

void FixDCMPolarity::set(int row, const Vec3 &A, const Vec3 &P)
{
  for (int k = 0; k < 3; k++) {
    (*vectors)(row, k) = A[k];
    (*vectors)(row, 3 + k) = P[k];
  }
}

bool FixDCMPolarity::has_vectors(int row) const
{
  return A(row).norm() > 0.5;
}

void FixDCMPolarity::forget(int row)
{
  set(row, Vec3::Zero(), Vec3::Zero());
  (*frozen)(row) = (*apical_area)(row) = (*junction_area)(row) = 0.0;
}

/* ----------------------------------------------------------------------
   A stays while a cell rounds up to divide, and for a time after its birth
------------------------------------------------------------------------- */

bool FixDCMPolarity::stays(int row) const
{
  const auto &table = cell->cells();
  const int phase = table[row].phase;
  const double left = (*frozen)(row) -table.time();
  return phase == DCMCellTable::ROUNDING || phase == DCMCellTable::READY ||
         (left > 0.0 && left <= freeze + update->dt);    // more: the deck has set the time back
}

/* ----------------------------------------------------------------------
   step 0 has vectors and regions before its forces are computed. Only in the very first run: later
   a cell without A has joined in the last step, and gets hers in the next one, as in a run that
   has not been interrupted
------------------------------------------------------------------------- */

void FixDCMPolarity::setup_pre_force(int /*vflag*/)
{
  if (!begun && find_due(false)) look(false);
}

void FixDCMPolarity::initial_integrate(int /*vflag*/)
{
  const bool turning = !begun || update->ntimestep % nevery == 0;
  begun = true;
  if (find_due(turning)) look(turning);
}

/* ----------------------------------------------------------------------
   cells whose faces want regions now, the same on all processes: those that leave or begin, or
   all polar ones
------------------------------------------------------------------------- */

bool FixDCMPolarity::find_due(bool all)
{
  const auto &table = cell->cells();
  due.assign(table.size(), 0);
  forget_leavers();
  std::vector<int> beginners;
  for (const int row : table.all_deformable()) {
    if (!polar(table[row])) continue;
    if (all) due[row] = 1;
    if (!has_vectors(row) && start_mode != FREE) beginners.push_back(row);
  }
  if (!beginners.empty()) start(beginners);
  for (const int row : beginners) due[row] = 1;
  return std::find(due.begin(), due.end(), 1) != due.end();
}

/* ----------------------------------------------------------------------
   cells that are in no group of a fix of this style any more; the first of the fixes does it
------------------------------------------------------------------------- */

void FixDCMPolarity::forget_leavers()
{
  const auto fixes = modify->get_fix_by_style("^dcm/polarity$");
  if (fixes.size() > 1) check_groups();
  if (fixes[0] != this) return;
  int groups = 0;
  for (const auto *const fix : fixes) groups |= fix->groupbit;
  const auto &table = cell->cells();
  for (int row = 0; row < table.size(); row++) {
    if (!has_vectors(row) || (table[row].deformable && (table[row].mask & groups))) continue;
    forget(row);
    if (table[row].deformable) due[row] = 1;
  }
}

/* ----------------------------------------------------------------------
   first vectors
------------------------------------------------------------------------- */

void FixDCMPolarity::start(const std::vector<int> &rows)
{
  cell->update_all();
  const auto &table = cell->cells();
  std::vector<tagint> molecules;
  for (const int row : rows) molecules.push_back(table[row].molecule);
  std::vector<double> value[3];
  for (int k = 0; k < 3; k++) {
    if (start_mode == VARIABLE) value[k] = dcm_cell_variable(lmp, variable_name[k], molecules);
    value[k].resize(rows.size());
  }
  for (size_t n = 0; n < rows.size(); n++) {
    const Vec3 A = given_vector(rows[n], Vec3(value[0][n], value[1][n], value[2][n]));
    set(rows[n], A, turned(rows[n], Vec3::Zero(), A));
  }
}

Vec3 FixDCMPolarity::given_vector(int row, const Vec3 &variable) const
{
  const auto &it = cell->cells()[row];
  if (start_mode == RANDOM) {
    dcm::Random random(seed, it.molecule, 0, dcm::RandomPurpose::POLARITY);
    return dcm::direction(dcm::in_plane(random.unit_vector(), axis));
  }
  Vec3 v = variable;
  double least = 0.0;
  if (start_mode == TOWARD) {
    v = point - dcm::vec(it.x);
    dcm_minimum_image(domain, v[0], v[1], v[2]);
    v = dcm::in_plane(v, axis);
    least = NEAR * dcm::ball_radius(it.volume0);
  }
  // scaled, since the square of a huge or a tiny component is no number
  const double size = v.cwiseAbs().maxCoeff();
  if (!v.allFinite() || !(size > 0.0) || !(Vec3(v / size).norm() > least / size))
    error->all(FLERR,
               "{}: init {} gives cell {} the apical vector {} {} {} at step {}; it needs a "
               "direction",
               STYLE, start_mode == TOWARD ? "toward" : "variable", it.molecule, v[0], v[1], v[2],
               update->ntimestep);
  const Vec3 scaled = v / size;
  if (axis >= 0 && std::fabs(scaled[axis]) > 1.0e-6 * scaled.norm())
    error->all(FLERR,
               "{}: init variable gives cell {} the apical vector {} {} {} at step {}, not "
               "perpendicular to {}; remove plane {} or make this component zero",
               STYLE, it.molecule, v[0], v[1], v[2], update->ntimestep, "xyz"[axis], "xyz"[axis]);
  return dcm::direction(dcm::in_plane(scaled, axis));
}

/* ----------------------------------------------------------------------
   P to a new A; at random where the old one does not say
------------------------------------------------------------------------- */

Vec3 FixDCMPolarity::turned(int row, const Vec3 &P, const Vec3 &A) const
{
  Vec3 now = dcm::polar_vector(P, A, axis);
  dcm::Random random(seed, cell->cells()[row].molecule, 0, dcm::RandomPurpose::POLARITY);
  random.unit_vector();    // was for A
  while (!(now.norm() > 0.5)) now = dcm::polar_vector(random.unit_vector(), A, axis);
  return now;
}

/* ----------------------------------------------------------------------
   daughters have A and P of their mother, and keep A for a while
------------------------------------------------------------------------- */

void FixDCMPolarity::cell_divided(const DCMCellTable::Division &division)
{
  const auto &table = cell->cells();
  if (!polar(table[division.mother]) || !has_vectors(division.mother)) return;
  for (const int row : division.daughter) (*frozen)(row) = table.time() + freeze;
}

void FixDCMPolarity::cell_converted(int row, double /*volume0_before*/)
{
  forget(row);
}

/* ---------------------------------------------------------------------- */

void FixDCMPolarity::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(begun);
  record.put(warned);
  record.put(nturned);
  record.put(nclosed);
  record.write(fp);
}

void FixDCMPolarity::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(begun);
  record.get(warned);
  record.get(nturned);
  record.get(nclosed);
}

/* ----------------------------------------------------------------------
   polar cells that have their vectors, mean area of their apical faces and of their ribbon; at the
   last look: vectors that turned far, cells without free face
------------------------------------------------------------------------- */

double FixDCMPolarity::compute_vector(int n)
{
  if (!vectors) return 0.0;
  FixDCMCell::check_current(lmp, STYLE, cell);
  if (n == 3) return nturned;
  if (n == 4) return nclosed;
  const auto &table = cell->cells();
  double npolar = 0.0, sum = 0.0;
  for (const int row : table.all_deformable()) {
    if (!polar(table[row]) || !has_vectors(row)) continue;
    npolar += 1.0;
    sum += n == 1 ? (*apical_area)(row) : (*junction_area)(row);
  }
  return n == 0 ? npolar : (npolar > 0.0 ? sum / npolar : 0.0);
}

/* ---------------------------------------------------------------------- */

double FixDCMPolarity::memory_usage()
{
  return (double) outward.capacity() * sizeof(Vec3) + (double) sums.capacity() * sizeof(Sums) +
         (double) packed.capacity() * sizeof(std::int64_t);
}
