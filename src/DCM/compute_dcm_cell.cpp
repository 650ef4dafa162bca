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
#include "dcm_deck_check.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "math_const.h"
#include "memory.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using MathConst::MY_4PI;

static const std::string STYLE = "Compute dcm/cell";

static constexpr int NSUM = 5;    // per deformable cell: contact area, free area, velocity

// what is printed for a deformable and for a center-based cell

// clang-format off
const std::vector<ComputeDCMCell::Value> ComputeDCMCell::VALUES = {
    {"volume", &ComputeDCMCell::volume, &ComputeDCMCell::volume_of_sphere, NOTHING},
    {"volume0", &ComputeDCMCell::volume0, &ComputeDCMCell::volume_of_sphere, NOTHING},
    {"area", &ComputeDCMCell::area, &ComputeDCMCell::area_of_sphere, NOTHING},
    {"pressure", &ComputeDCMCell::pressure, &ComputeDCMCell::pressure_of_sphere, NOTHING},
    {"x", &ComputeDCMCell::center<0>, &ComputeDCMCell::atom_x<0>, NOTHING},
    {"y", &ComputeDCMCell::center<1>, &ComputeDCMCell::atom_x<1>, NOTHING},
    {"z", &ComputeDCMCell::center<2>, &ComputeDCMCell::atom_x<2>, NOTHING},
    {"vx", &ComputeDCMCell::summed<2>, &ComputeDCMCell::atom_v<0>, VELOCITY},
    {"vy", &ComputeDCMCell::summed<3>, &ComputeDCMCell::atom_v<1>, VELOCITY},
    {"vz", &ComputeDCMCell::summed<4>, &ComputeDCMCell::atom_v<2>, VELOCITY},
    {"contact_area", &ComputeDCMCell::summed<0>, &ComputeDCMCell::contact_area_of_sphere, AREA},
    {"free_area", &ComputeDCMCell::summed<1>, &ComputeDCMCell::free_area_of_sphere, AREA},
    {"neighbors", &ComputeDCMCell::neighbors, &ComputeDCMCell::neighbors, NEIGHBORS},
    {"kind", &ComputeDCMCell::kind, &ComputeDCMCell::kind, NOTHING},
    {"molecule", &ComputeDCMCell::molecule, &ComputeDCMCell::molecule, NOTHING},
    {"mother", &ComputeDCMCell::mother, &ComputeDCMCell::mother, NOTHING},
    {"generation", &ComputeDCMCell::generation, &ComputeDCMCell::generation, NOTHING},
    {"birth", &ComputeDCMCell::birth, &ComputeDCMCell::birth, NOTHING},
    {"phase", &ComputeDCMCell::phase, &ComputeDCMCell::phase, NOTHING}};
// clang-format on

static const std::vector<std::string> OF_TABLE = {"mother", "generation", "birth", "phase"};

/* ----------------------------------------------------------------------
   compute ID group dcm/cell value1 value2 ...
------------------------------------------------------------------------- */

ComputeDCMCell::ComputeDCMCell(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), needs(NOTHING), nmax(0), dcm(nullptr), cell(nullptr), contact(nullptr)
{
  AtomVecDCM::require(lmp, STYLE);
  if (narg < 4) error->all(FLERR, "{}: no values given; known: {}", STYLE, known());
  for (int iarg = 3; iarg < narg; iarg++) {
    Column column;
    column.name = arg[iarg];
    for (const auto &value : VALUES)
      if (column.name == value.name) column.value = &value;
    if (column.value) needs |= column.value->needs;
    columns.push_back(column);
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

std::string ComputeDCMCell::known() const
{
  std::string names;
  for (const auto &value : VALUES) names += std::string(names.empty() ? "" : " ") + value.name;
  if (const auto *const fix = FixDCMCell::find(lmp))
    for (const auto &name : fix->cells().column_names()) names += " " + name;
  return names;
}

void ComputeDCMCell::unknown(const std::string &name) const
{
  error->all(FLERR, "{}: unknown value {}; known: {}", STYLE, name, known());
}

/* ----------------------------------------------------------------------
   ask for what others record on request only
------------------------------------------------------------------------- */

void ComputeDCMCell::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
  int any = 0;
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::CENTER) any = 1;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
  bool from_table = false;
  for (const auto &column : columns) {
    if (!column.value && !FixDCMCell::find(lmp)) unknown(column.name);
    if (!column.value || std::find(OF_TABLE.begin(), OF_TABLE.end(), column.name) != OF_TABLE.end())
      from_table = true;
  }
  cell = nullptr;
  if (any || from_table || FixDCMCell::find(lmp)) cell = FixDCMCell::require(lmp, STYLE);
  spheres = from_table ? cell->request_spheres() : DCMRequest<>();

  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (contact) {
    virial = contact->request_virial();
    if (needs & NEIGHBORS) partners = contact->request_partners();
  }
  for (const auto &column : columns)
    if (!contact && column.value && (column.value->needs & (AREA | NEIGHBORS)))
      error->all(FLERR, "{}: value {} needs pair_style dcm/contact; add it or remove the value",
                 STYLE, column.name);
}

/* ----------------------------------------------------------------------
   columns of the table are there when all fixes have been initialized
------------------------------------------------------------------------- */

void ComputeDCMCell::setup()
{
  for (auto &column : columns) {
    if (column.value) continue;
    const auto found = cell->cells().column(column.name, column.field);
    column.table = found;
    if (!found) unknown(column.name);
  }
}

/* ----------------------------------------------------------------------
   asked for between two runs, when the deck has changed the atoms
------------------------------------------------------------------------- */

void ComputeDCMCell::check_current() const
{
  if (!cell) return;
  FixDCMCell::check_current(lmp, STYLE, cell);
  cell->check_atoms(STYLE);
}

/* ----------------------------------------------------------------------
   contact areas are those of the forces of this step: pair_style dcm/contact has
   summed them over ranks; faces of a cell may have several owners
------------------------------------------------------------------------- */

void ComputeDCMCell::sum_cells()
{
  const auto &table = cell->cells();
  cell_sums.assign(NSUM * table.size(), 0.0);
  if (needs & AREA) {
    const double *const covered = contact->contact_area();
    for (int f = 0; f < cell->nowned(); f++) {
      const auto &face = cell->faces()[f];
      double *const sums = &cell_sums[NSUM * (size_t) face.cell];
      sums[0] += covered[face.atom];
      sums[1] += std::max(0.0, cell->area(f) - covered[face.atom]);
    }
  }
  if (needs & VELOCITY) {
    for (int i = 0; i < atom->nlocal; i++) {
      if (dcm->kind[i] != AtomVecDCM::NODE) continue;
      const int c = cell->cell_of(i);
      double *const sums = &cell_sums[NSUM * (size_t) c];
      for (int k = 0; k < 3; k++) sums[2 + k] += atom->v[i][k] / table[c].nnodes;
    }
  }
  cell->sum_owned(cell_sums, NSUM);
}

/* ----------------------------------------------------------------------
   a pair of cells may have contacts on several ranks, but is one neighbor
------------------------------------------------------------------------- */

void ComputeDCMCell::gather_contacts()
{
  in_contact.clear();
  for (const auto &pair : contact->partners()) {
    if (!(pair.area > 0.0)) continue;
    in_contact.emplace_back(pair.molecule, pair.other);
    in_contact.emplace_back(pair.other, pair.molecule);
  }
  std::sort(in_contact.begin(), in_contact.end());
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
   one value of the cell whose center or sphere is atom i and that stands in a row of the table
   (-1: a sphere that is not in it)
------------------------------------------------------------------------- */

template <int FIELD> double ComputeDCMCell::summed(int, int row) const
{
  return cell_sums[NSUM * (size_t) row + FIELD];
}

template <int K> double ComputeDCMCell::center(int, int row) const
{
  return cell->cells()[row].x[K];
}

template <int K> double ComputeDCMCell::atom_x(int i, int) const
{
  return atom->x[i][K];
}

template <int K> double ComputeDCMCell::atom_v(int i, int) const
{
  return atom->v[i][K];
}

double ComputeDCMCell::volume(int, int row) const
{
  return cell->cells()[row].volume;
}

double ComputeDCMCell::volume0(int, int row) const
{
  return cell->cells()[row].volume0;
}

double ComputeDCMCell::area(int, int row) const
{
  return cell->cells()[row].area;
}

double ComputeDCMCell::pressure(int, int row) const
{
  return cell->cells().value("pressure", row);
}

double ComputeDCMCell::kind(int i, int) const
{
  return dcm->kind[i];
}

double ComputeDCMCell::molecule(int i, int) const
{
  return (double) atom->molecule[i];
}

double ComputeDCMCell::neighbors(int i, int) const
{
  return neighbors_of(atom->molecule[i]);
}

double ComputeDCMCell::volume_of_sphere(int i, int) const
{
  return sphere_volume(i);
}

double ComputeDCMCell::area_of_sphere(int i, int) const
{
  return MY_4PI * atom->radius[i] * atom->radius[i];
}

double ComputeDCMCell::pressure_of_sphere(int i, int) const
{
  return sphere_pressure(i);
}

double ComputeDCMCell::contact_area_of_sphere(int i, int) const
{
  return contact->contact_area()[i];
}

double ComputeDCMCell::free_area_of_sphere(int i, int row) const
{
  return std::max(0.0, area_of_sphere(i, row) - contact->contact_area()[i]);
}

double ComputeDCMCell::mother(int, int row) const
{
  return row < 0 ? 0.0 : (double) cell->cells()[row].mother;
}

double ComputeDCMCell::generation(int, int row) const
{
  return row < 0 ? 0.0 : cell->cells()[row].generation;
}

double ComputeDCMCell::birth(int, int row) const
{
  return row < 0 ? 0.0 : cell->cells()[row].birth;
}

double ComputeDCMCell::phase(int, int row) const
{
  return row < 0 ? 0.0 : cell->cells()[row].phase;
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

  std::vector<std::shared_ptr<const DCMColumn>> table(ncolumns);
  for (int k = 0; k < ncolumns; k++) {
    if (columns[k].value) continue;
    table[k] = columns[k].table.lock();
    if (!table[k])
      error->all(FLERR,
                 "{}: no style gives value {} yet, or any more; do a 'run 0' before using it",
                 STYLE, columns[k].name);
  }

  if (cell && (needs & (AREA | VELOCITY))) sum_cells();
  if (needs & NEIGHBORS) gather_contacts();

  for (int i = 0; i < atom->nlocal; i++) {
    double *const to = ncolumns == 1 ? &vector_atom[i] : array_atom[i];
    std::fill_n(to, ncolumns, 0.0);
    const bool deformable = dcm->kind[i] == AtomVecDCM::CENTER;
    if (!(atom->mask[i] & groupbit) || (!deformable && dcm->kind[i] != AtomVecDCM::SPHERE))
      continue;
    const int row = cell ? cell->cell_of(i) : -1;
    for (int k = 0; k < ncolumns; k++) {
      const Column &column = columns[k];
      if (column.value)
        to[k] = (this->*(deformable ? column.value->deformable : column.value->sphere))(i, row);
      else if (row >= 0)
        to[k] = (*table[k])(row, column.field);
    }
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
    cell->update_all();
    const auto &table = cell->cells();
    for (const int c : table.all_deformable()) {
      const auto &it = table[c];
      if (!(it.mask & groupbit)) continue;
      const double p = table.value("pressure", c);
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
