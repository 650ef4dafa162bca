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
#include "memory.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

static const std::string STYLE = "Compute dcm/cell";

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
    if (needs & STRESS) tensor = contact->request_tensor();
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

  if (cell && (needs & SHAPE)) measure_shapes();
  if (cell && (needs & STRESS)) measure_stresses();
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
  bytes +=
      (double) (cell_sums.capacity() + shapes.capacity() + stresses.capacity()) * sizeof(double);
  bytes += (double) in_contact.capacity() * 2 * sizeof(tagint);
  return bytes;
}
