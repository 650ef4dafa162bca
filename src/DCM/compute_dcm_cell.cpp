/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "compute_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_gather.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "fix_dcm_growth.h"
#include "force.h"
#include "math_const.h"
#include "memory.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "update.h"
#include "utils.h"

#include <algorithm>

using namespace LAMMPS_NS;
using MathConst::MY_4PI;

static const std::string STYLE = "Compute dcm/cell";

// as enum Value

static const std::vector<std::string> NAMES = {
    "volume",   "volume0", "area",       "pressure",     "x",         "y",         "z",
    "vx",       "vy",      "vz",         "contact_area", "free_area", "neighbors", "kind",
    "molecule", "mother",  "generation", "birth",        "phase",     "progress"};

static constexpr int NSUM = 5;    // per deformable cell: contact area, free area, velocity

/* ----------------------------------------------------------------------
   compute ID group dcm/cell value1 value2 ...
------------------------------------------------------------------------- */

ComputeDCMCell::ComputeDCMCell(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), want_velocity(false), want_area(false), want_neighbors(false), nmax(0),
    dcm(nullptr), cell(nullptr), contact(nullptr), growth(nullptr), has_volume(false)
{
  AtomVecDCM::require(lmp, STYLE);
  const std::string known = utils::join_words(NAMES, " ");
  if (narg < 4) error->all(FLERR, "{}: no values given; known: {}", STYLE, known);
  for (int iarg = 3; iarg < narg; iarg++) {
    const auto found = std::find(NAMES.begin(), NAMES.end(), arg[iarg]);
    if (found == NAMES.end())
      error->all(FLERR, "{}: unknown value {}; known: {}", STYLE, arg[iarg], known);
    const int value = (int) (found - NAMES.begin());
    columns.push_back(value);
    if (value == VX || value == VY || value == VZ) want_velocity = true;
    if (value == CONTACT_AREA || value == FREE_AREA) want_area = true;
    if (value == NEIGHBORS) want_neighbors = true;
  }

  peratom_flag = 1;
  size_peratom_cols = columns.size() == 1 ? 0 : (int) columns.size();
  vector_flag = 1;
  size_vector = 6;
  extvector = 0;
  vector = new double[size_vector]();
}

ComputeDCMCell::~ComputeDCMCell()
{
  memory->destroy(vector_atom);
  memory->destroy(array_atom);
  delete[] vector;
}

/* ----------------------------------------------------------------------
   ask for what the pair style records on request only; it forgets at every
   start of a run
------------------------------------------------------------------------- */

void ComputeDCMCell::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  int any = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::CENTER) any = 1;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
  cell = nullptr;
  if (any || !modify->get_fix_by_style("^dcm/cell$").empty())
    cell = FixDCMCell::require(lmp, STYLE);
  has_volume = !modify->get_fix_by_style("^dcm/volume$").empty();

  growth = nullptr;
  for (int value : columns)
    if (value >= MOTHER)
      growth = FixDCMGrowth::require(lmp, fmt::format("{}: value {}", STYLE, NAMES[value]));

  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (contact) {
    contact->request_virial();
    if (want_neighbors) contact->request_partners();
  }
  for (int value : columns)
    if (!contact && (value == CONTACT_AREA || value == FREE_AREA || value == NEIGHBORS))
      error->all(FLERR, "{}: value {} needs pair_style dcm/contact; add it or remove the value",
                 STYLE, NAMES[value]);
}

/* ----------------------------------------------------------------------
   asked for between two runs, when the deck has changed the atoms
------------------------------------------------------------------------- */

void ComputeDCMCell::check_current() const
{
  if (cell && (int) cell->cell_of.size() < atom->nlocal)
    error->one(FLERR, "{}: atoms were added since the last step; do a 'run 0' before using it",
               STYLE);
}

/* ----------------------------------------------------------------------
   contact areas are those of the forces of this step: pair_style dcm/contact has
   summed them over ranks; faces of a cell may have several owners
------------------------------------------------------------------------- */

void ComputeDCMCell::sum_cells()
{
  cell_sums.assign(NSUM * cell->cells.size(), 0.0);
  if (want_area) {
    const double *const covered = contact->contact_area();
    for (int f = 0; f < cell->nowned; f++) {
      const auto &face = cell->faces[f];
      double *const sums = &cell_sums[NSUM * (size_t) face.cell];
      sums[0] += covered[face.atom];
      sums[1] += std::max(0.0, cell->area[f] - covered[face.atom]);
    }
  }
  if (want_velocity) {
    for (int i = 0; i < atom->nlocal; i++) {
      if (dcm->kind[i] != AtomVecDCM::NODE) continue;
      const int c = cell->cell_of[i];
      double *const sums = &cell_sums[NSUM * (size_t) c];
      for (int k = 0; k < 3; k++) sums[2 + k] += atom->v[i][k] / cell->cells[c].nnodes;
    }
  }
  cell->sum(cell_sums);
}

/* ----------------------------------------------------------------------
   a pair of cells may have contacts on several ranks, but is one neighbor
------------------------------------------------------------------------- */

void ComputeDCMCell::gather_contacts()
{
  std::vector<tagint> mine;
  for (const auto &pair : contact->partners()) {
    if (!(pair.area > 0.0)) continue;
    mine.push_back(pair.molecule);
    mine.push_back(pair.other);
  }
  const auto all = dcm_allgather(mine, world);

  in_contact.clear();
  for (size_t m = 0; m < all.size(); m += 2) {
    in_contact.emplace_back(all[m], all[m + 1]);
    in_contact.emplace_back(all[m + 1], all[m]);
  }
  std::sort(in_contact.begin(), in_contact.end());
  in_contact.erase(std::unique(in_contact.begin(), in_contact.end()), in_contact.end());
}

double ComputeDCMCell::neighbors_of(tagint molecule) const
{
  const std::pair<tagint, tagint> first(molecule, 0), next(molecule + 1, 0);
  return (double) (std::lower_bound(in_contact.begin(), in_contact.end(), next) -
                   std::lower_bound(in_contact.begin(), in_contact.end(), first));
}

/* ----------------------------------------------------------------------
   p = sum of force times distance from the center to the contact / (3 V)
   (S1, center-based cells), positive in compression
------------------------------------------------------------------------- */

double ComputeDCMCell::sphere_volume(int i) const
{
  const double r = atom->radius[i];
  return MY_4PI / 3.0 * r * r * r;
}

double ComputeDCMCell::sphere_pressure(int i) const
{
  const double volume = sphere_volume(i);
  return contact && volume > 0.0 ? contact->sphere_virial()[i] / (3.0 * volume) : 0.0;
}

/* ----------------------------------------------------------------------
   one value of a cell from the book of fix dcm/growth; 0 for a cell that is not in it
------------------------------------------------------------------------- */

double ComputeDCMCell::cycle_value(tagint molecule, int value) const
{
  const auto *const it = growth->find(molecule);
  if (!it) return 0.0;
  switch (value) {
    case MOTHER:
      return (double) it->mother;
    case GENERATION:
      return it->generation;
    case BIRTH:
      return it->birth;
    case PHASE:
      return it->phase;
    default:
      return it->progress;
  }
}

/* ----------------------------------------------------------------------
   one value of the deformable cell whose center is atom i
------------------------------------------------------------------------- */

double ComputeDCMCell::cell_value(int i, int value) const
{
  const int c = cell->cell_of[i];
  const FixDCMCell::Cell &it = cell->cells[c];
  const double *const sums = cell_sums.data() + NSUM * (size_t) c;
  switch (value) {
    case VOLUME:
      return it.volume;
    case VOLUME0:
      return it.volume0;
    case AREA:
      return it.area;
    case PRESSURE:
      return has_volume ? it.pressure : 0.0;
    case X:
    case Y:
    case Z:
      return it.x[value - X];
    case VX:
    case VY:
    case VZ:
      return sums[2 + value - VX];
    case CONTACT_AREA:
      return sums[0];
    case FREE_AREA:
      return sums[1];
    case NEIGHBORS:
      return neighbors_of(it.molecule);
    case KIND:
      return dcm->kind[i];
    case MOLECULE:
      return (double) it.molecule;
    default:
      return cycle_value(it.molecule, value);
  }
}

/* ----------------------------------------------------------------------
   one value of the center-based cell that is atom i
------------------------------------------------------------------------- */

double ComputeDCMCell::sphere_value(int i, int value) const
{
  const double r = atom->radius[i];
  switch (value) {
    case VOLUME:
    case VOLUME0:
      return sphere_volume(i);
    case AREA:
      return MY_4PI * r * r;
    case PRESSURE:
      return sphere_pressure(i);
    case X:
    case Y:
    case Z:
      return atom->x[i][value - X];
    case VX:
    case VY:
    case VZ:
      return atom->v[i][value - VX];
    case CONTACT_AREA:
      return contact->contact_area()[i];
    case FREE_AREA:
      return std::max(0.0, MY_4PI * r * r - contact->contact_area()[i]);
    case NEIGHBORS:
      return neighbors_of(atom->molecule[i]);
    case KIND:
      return dcm->kind[i];
    case MOLECULE:
      return (double) atom->molecule[i];
    default:
      return cycle_value(atom->molecule[i], value);
  }
}

/* ---------------------------------------------------------------------- */

void ComputeDCMCell::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  check_current();
  const int ncolumns = (int) columns.size();
  if (atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(vector_atom);
    memory->destroy(array_atom);
    if (ncolumns == 1)
      memory->create(vector_atom, nmax, "dcm/cell:vector_atom");
    else
      memory->create(array_atom, nmax, ncolumns, "dcm/cell:array_atom");
  }

  if (cell && (want_area || want_velocity)) sum_cells();
  if (want_neighbors) gather_contacts();

  for (int i = 0; i < atom->nlocal; i++) {
    double *const row = ncolumns == 1 ? &vector_atom[i] : array_atom[i];
    const bool inside = atom->mask[i] & groupbit;
    if (inside && dcm->kind[i] == AtomVecDCM::CENTER)
      for (int k = 0; k < ncolumns; k++) row[k] = cell_value(i, columns[k]);
    else if (inside && dcm->kind[i] == AtomVecDCM::SPHERE)
      for (int k = 0; k < ncolumns; k++) row[k] = sphere_value(i, columns[k]);
    else
      std::fill_n(row, ncolumns, 0.0);
  }
}

/* ----------------------------------------------------------------------
   number, mean and largest pressure of deformable cells; number and mean pressure
   of center-based cells; volume of both
------------------------------------------------------------------------- */

void ComputeDCMCell::compute_vector()
{
  invoked_vector = update->ntimestep;
  check_current();

  double ndcm = 0.0, sum = 0.0, highest = 0.0, volume = 0.0;
  if (cell) {
    for (const auto &it : cell->cells) {
      if (!(it.mask & groupbit)) continue;
      const double p = has_volume ? it.pressure : 0.0;
      highest = ndcm > 0.0 ? std::max(highest, p) : p;
      ndcm += 1.0;
      sum += p;
      volume += it.volume;
    }
  }

  double spheres[3] = {0.0, 0.0, 0.0};    // number, sum of pressures, volume
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::SPHERE || !(atom->mask[i] & groupbit)) continue;
    spheres[0] += 1.0;
    spheres[1] += sphere_pressure(i);
    spheres[2] += sphere_volume(i);
  }
  MPI_Allreduce(MPI_IN_PLACE, spheres, 3, MPI_DOUBLE, MPI_SUM, world);

  vector[0] = ndcm;
  vector[1] = ndcm > 0.0 ? sum / ndcm : 0.0;
  vector[2] = highest;
  vector[3] = spheres[0];
  vector[4] = spheres[0] > 0.0 ? spheres[1] / spheres[0] : 0.0;
  vector[5] = volume + spheres[2];
}

/* ---------------------------------------------------------------------- */

double ComputeDCMCell::memory_usage()
{
  double bytes = (double) nmax * columns.size() * sizeof(double);
  bytes += (double) cell_sums.capacity() * sizeof(double);
  bytes += (double) in_contact.capacity() * 2 * sizeof(tagint);
  return bytes;
}
