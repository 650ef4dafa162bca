/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_tension.h"

#include "atom.h"
#include "dcm_deck_check.h"
#include "dcm_unknowns.h"
#include "error.h"
#include "group.h"
#include "law/mean_stress.h"
#include "law/stiffness.h"
#include "law/tension.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/tension";
static const char TENSION[] = "tension";
static constexpr double NOT_GIVEN = -1.0, PER_FACE = std::numeric_limits<double>::max();

// tension, or tension:REGION

static std::string keyword_of(int region)
{
  const std::string all = TENSION;
  return region == AtomVecDCM::NREGION ? all : all + ":" + DCMParameters::region_name(region);
}

static std::vector<std::string> keywords()
{
  std::vector<std::string> names = {TENSION};
  for (int r = 0; r < AtomVecDCM::NREGION; r++) names.push_back(keyword_of(r));
  return names;
}

/* ----------------------------------------------------------------------
   fix ID group dcm/tension [FILE name1..nameN] [tension T|v_name] [tension:REGION T|v_name] ...
------------------------------------------------------------------------- */

FixDCMTension::FixDCMTension(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), parameters(lmp, STYLE, keywords()), varies(false),
    started(false), of_face(), energy(), all_energy(), summed(false)
{
  dcm = AtomVecDCM::require(lmp, STYLE);

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {});
  parameters.parse(args, atom->ntypes);
  while (args.next()) parse(args);
  for (const auto &one : given) varies = varies || one.value.varies();

  scalar_flag = vector_flag = 1;
  size_vector = NREGION;
  extscalar = extvector = 1;
  global_freq = 1;
  energy_global_flag = energy_peratom_flag = 1;
  virial_global_flag = virial_peratom_flag = 1;
  thermo_energy = thermo_virial = 1;
}

// the last one given counts, number or variable

void FixDCMTension::parse(DCMArgs &args)
{
  for (int r = 0; r <= ALL; r++) {
    if (!args.is(keyword_of(r))) continue;
    given[r] = Given();
    given[r].yes = true;
    given[r].value.parse(args);
    args.check(given[r].value.varies() || given[r].value() >= 0.0, "zero or positive");
  }
}

/* ---------------------------------------------------------------------- */

int FixDCMTension::setmask()
{
  return PRE_REVERSE | MIN_PRE_REVERSE;
}

void FixDCMTension::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  parameters.resolve();
  for (auto &one : given) one.value.find(lmp, STYLE);
  for (int r = 0; r < NREGION; r++) {
    const Given *const one = given_for(r);
    of_face[r] = one && one->value.per_atom() ? &one->value : nullptr;
  }
  read_tensions();
}

// what the deck says of a region, nullptr: nothing

const FixDCMTension::Given *FixDCMTension::given_for(int region) const
{
  for (const int r : {region, ALL})
    if (given[r].yes) return &given[r];
  return nullptr;
}

/* ----------------------------------------------------------------------
   values of the deck go before those of the file, and those of a region before that of all of them
   only types of deformable cells need one, so that one list of names can serve all styles; cells
   of the others may come later, and then it is missed
------------------------------------------------------------------------- */

void FixDCMTension::read_tensions()
{
  const auto centers = AtomVecDCM::types_holding(lmp, {AtomVecDCM::CENTER}, groupbit);
  of_type.assign(atom->ntypes + 1, Tensions());
  for (int i = 1; i <= atom->ntypes; i++)
    for (int r = 0; r < NREGION; r++) {
      if (!parameters.used(i)) continue;
      const bool known = given[r].yes || given[ALL].yes || parameters.has(i, keyword_of(r)) ||
                         parameters.has(i, TENSION);
      of_type[i][r] = centers[i] || known ? tension_of(i, r) : NOT_GIVEN;
    }
}

double FixDCMTension::tension_of(int type, int region) const
{
  if (of_face[region]) return PER_FACE;
  const Given *const one = given_for(region);
  if (one) return one->value();
  const std::string own = keyword_of(region);
  return parameters.get(type, parameters.has(type, own) ? own : TENSION,
                        DCMParameters::NONNEGATIVE);
}

/* ----------------------------------------------------------------------
   atom-style variables at all atoms: which of them are faces of the cells is not told by the group
------------------------------------------------------------------------- */

void FixDCMTension::evaluate_variables()
{
  if (!varies) return;
  std::vector<DCMValue *> values;
  for (auto &one : given)
    if (one.value.varies()) values.push_back(&one.value);
  DCMValue::evaluate(lmp, STYLE, values, 0);
  for (const DCMValue *const value : values)
    if (!value->per_atom() && value->operator()() < 0.0) refuse(*value, value->operator()());
  read_tensions();
}

void FixDCMTension::refuse(const DCMValue &value, double T) const
{
  const std::string what = fmt::format(
      "{}: variable {} gives the tension {} at step {}; it must be a number >= 0, since a surface "
      "that gains energy by growing crumples",
      STYLE, value.variable(), T, update->ntimestep);
  if (value.per_atom()) error->one(FLERR, what);
  error->all(FLERR, what);
}

/* ---------------------------------------------------------------------- */

void FixDCMTension::find_cells()
{
  const auto &table = cell->cells();
  of_row.assign(table.size(), nullptr);
  anyone = false;
  for (const int c : table.all_deformable()) {    // all find the same error
    const auto &it = table[c];
    if (!parameters.used(it.type) || !(it.mask & groupbit)) continue;
    for (int r = 0; r < NREGION; r++)
      if (of_type[it.type][r] == NOT_GIVEN) tension_of(it.type, r);    // ends in an error
    const auto &T = of_type[it.type];
    if (std::all_of(T.begin(), T.end(), [](double t) {
          return t == 0.0;
        }))
      continue;
    of_row[c] = &T;
    anyone = true;
  }
}

double FixDCMTension::tension(const FixDCMCell::Face &face) const
{
  const Tensions *const T = face.cell < 0 ? nullptr : of_row[face.cell];
  if (!T) return 0.0;
  const int region = dcm->region[face.atom];
  if (!of_face[region]) return (*T)[region];
  const double own = (*of_face[region])(face.atom);
  if (!(own >= 0.0 && std::isfinite(own))) refuse(*of_face[region], own);
  return own;
}

/* ----------------------------------------------------------------------
   once, before the first step: later cells may die or change
------------------------------------------------------------------------- */

void FixDCMTension::setup_pre_reverse(int eflag, int vflag)
{
  bool any = started;
  started = true;
  const auto &table = cell->cells();
  for (const int c : table.all_deformable())
    any = any || (parameters.used(table[c].type) && (table[c].mask & groupbit));
  if (!any && !(traits_of(lmp) & MAKES_CELLS))
    error->all(FLERR, "{}: no deformable cell has its center in group {} and a type with a name",
               STYLE, group->names[igroup]);
  pre_reverse(eflag, vflag);
}

/* ----------------------------------------------------------------------
   forces on ghost vertices too: added before they are summed, and after the pair style has summed
   its virial. The forces of one face balance, so that its virial needs no center
------------------------------------------------------------------------- */

void FixDCMTension::pre_reverse(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  evaluate_variables();
  find_cells();
  energy.fill(0.0);
  summed = false;
  if (!anyone) return;
  double **x = atom->x, **f = atom->f;

  for (int n = 0; n < cell->nowned(); n++) {
    const FixDCMCell::Face &face = cell->faces()[n];
    const double T = tension(face);
    if (T == 0.0) continue;
    const auto a = vec(x[face.v[0]]), b = vec(x[face.v[1]]), c = vec(x[face.v[2]]);
    const dcm::AreaGradient area = dcm::area_gradient(a, b, c);
    for (int k = 0; k < 3; k++) vec(f[face.v[k]]) -= T * area.by[k];
    energy[dcm->region[face.atom]] += T * area.area;
    if (!evflag) continue;
    if (eflag_atom) eatom[face.atom] += T * area.area;
    if (!vflag_either) continue;
    const Vec3 d[2] = {b - a, c - a};
    double v[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < 2; k++) {
      const Vec3 force = -T * area.by[k + 1];
      for (int m = 0; m < 3; m++) v[m] += d[k][m] * force[m];
      v[3] += d[k][0] * force[1];
      v[4] += d[k][0] * force[2];
      v[5] += d[k][1] * force[2];
    }
    v_tally(face.atom, v);
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMTension::add_cell_virial(std::vector<double> &virial)
{
  const double *const normal = cell->normals();
  for (int n = 0; n < cell->nowned(); n++) {
    const FixDCMCell::Face &face = cell->faces()[n];
    const double T = tension(face);
    if (T != 0.0)
      dcm::add_tension_virial(&virial[6 * (size_t) face.cell], T, cell->area(n),
                              vec(&normal[3 * (size_t) n]));
  }
}

/* ----------------------------------------------------------------------
   tensions are those of this step's forces
------------------------------------------------------------------------- */

void FixDCMTension::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  if (!anyone) return;
  double **x = atom->x;
  for (int n = 0; n < cell->nowned(); n++) {
    const FixDCMCell::Face &face = cell->faces()[n];
    const double T = tension(face);
    if (T == 0.0) continue;
    const int *const v = face.v;
    const auto iso = dcm::tension_stiffness(T, vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]]));
    for (int k = 0; k < 3; k++) {
      dcm::EdgeBlock b = {unknowns(v[(k + 1) % 3]), unknowns(v[(k + 2) % 3]), iso[k], 0.0, {}};
      if (b.iso > 0.0 && b.i != b.j) system.edges.push_back(b);
    }
  }
}

/* ----------------------------------------------------------------------
   energy of all cells acted on, and by region
------------------------------------------------------------------------- */

void FixDCMTension::sum_energies()
{
  if (summed) return;
  MPI_Allreduce(energy.data(), all_energy.data(), NREGION, MPI_DOUBLE, MPI_SUM, world);
  summed = true;
}

double FixDCMTension::compute_scalar()
{
  sum_energies();
  double sum = 0.0;
  for (const double one : all_energy) sum += one;
  return sum;
}

double FixDCMTension::compute_vector(int region)
{
  sum_energies();
  return all_energy[region];
}

/* ---------------------------------------------------------------------- */

double FixDCMTension::memory_usage()
{
  return (double) of_row.capacity() * sizeof(of_row[0]) +
         (double) of_type.capacity() * sizeof(Tensions);
}
