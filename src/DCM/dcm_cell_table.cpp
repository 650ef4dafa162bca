/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "dcm_cell_table.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_allgather.h"
#include "dcm_record.h"
#include "dcm_role.h"
#include "error.h"
#include "law/volume.h"
#include "update.h"

#include <algorithm>
#include <iterator>
#include <limits>

using namespace LAMMPS_NS;

static const char STYLE[] = "The table of cells (fix dcm/cell)";

/* ---------------------------------------------------------------------- */

DCMColumn::DCMColumn(const std::string &_name, const std::vector<std::string> &names,
                     Heredity _heredity, double _preset) :
    name(_name),
    fields(names.empty() ? std::vector<std::string>{_name} : names), heredity(_heredity),
    preset(_preset)
{
}

void DCMColumn::copy_row(int row, double *to, size_t n) const
{
  std::copy_n(values.begin() + (size_t) row * width(), n, to);
}

void DCMColumn::set_row(int row, const double *from, size_t n)
{
  std::copy_n(from, n, values.begin() + (size_t) row * width());
}

/* ---------------------------------------------------------------------- */

DCMCellTable::DCMCellTable(LAMMPS *lmp) : Pointers(lmp) {}

static int find_in(const std::vector<DCMCellTable::Cell> &cells, tagint molecule)
{
  const auto found = std::lower_bound(cells.begin(), cells.end(), molecule,
                                      [](const DCMCellTable::Cell &cell, tagint mol) {
                                        return cell.molecule < mol;
                                      });
  return found == cells.end() || found->molecule != molecule ? -1 : (int) (found - cells.begin());
}

int DCMCellTable::find(tagint molecule) const
{
  return find_in(cells, molecule);
}

double DCMCellTable::time() const
{
  return update->atime + (double) (update->ntimestep - update->atimestep) * update->dt;
}

int DCMCellTable::require(tagint molecule) const
{
  const int row = find(molecule);
  if (row < 0)
    error->all(FLERR, "{}: there is no cell {} at step {}", STYLE, molecule, update->ntimestep);
  return row;
}

void DCMCellTable::require_ids(const std::string &asking) const
{
  if (doubled)
    error->all(FLERR,
               "{}: two cells have molecule ID {}; every cell needs a positive one of its own",
               asking, doubled > 0 ? doubled : 0);
}

/* ----------------------------------------------------------------------
   the atoms that stand for cells, sorted by molecule
------------------------------------------------------------------------- */

std::vector<DCMCellTable::CellAtom> DCMCellTable::gather(LAMMPS *lmp, bool spheres)
{
  const Atom *const atom = lmp->atom;
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, STYLE);
  std::vector<CellAtom> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    const int kind = dcm->kind[i];
    if (kind != AtomVecDCM::CENTER && !(spheres && kind == AtomVecDCM::SPHERE)) continue;
    const double *const x = atom->x[i], r = atom->radius[i];
    const bool deformable = kind == AtomVecDCM::CENTER;
    mine.push_back({atom->molecule[i],
                    atom->tag[i],
                    atom->type[i],
                    atom->mask[i],
                    deformable,
                    deformable ? dcm->volume0[i] : dcm::ball_volume(r),
                    {x[0], x[1], x[2]}});
  }
  auto all = dcm_allgather(mine, lmp->world);
  std::sort(all.begin(), all.end(), [](const CellAtom &a, const CellAtom &b) {
    return a.molecule != b.molecule ? a.molecule < b.molecule : a.tag < b.tag;
  });
  return all;
}

DCMCellTable::Cell DCMCellTable::newcomer(tagint molecule) const
{
  const int row = find_in(saved.cells, molecule);
  if (row >= 0) return saved.cells[row];
  Cell cell = {};
  cell.molecule = molecule;
  cell.phase = QUIESCENT;
  cell.birth = time();
  return cell;
}

/* ----------------------------------------------------------------------
   rows of the cells there are; what is known of a cell stays with it. Those whose atoms the deck
   has deleted are gone without an event
------------------------------------------------------------------------- */

void DCMCellTable::refresh(bool spheres)
{
  std::vector<Cell> rows;
  std::vector<int> from;    // old row of each, -1: new
  doubled = 0;
  for (const auto &it : gather(lmp, spheres)) {
    const bool again = !rows.empty() && rows.back().molecule == it.molecule;
    if (again && it.deformable && rows.back().deformable)
      error->all(
          FLERR,
          "Fix dcm/cell: cell {} has two center atoms, {} and {}; every cell needs a "
          "molecule ID of its own, from 1 ('reset_atoms mol' knows bonds only: leave it out)",
          it.molecule, rows.back().tag, it.tag);
    if (again || it.molecule <= 0) doubled = it.molecule > 0 ? it.molecule : -1;
    if (again && !it.deformable) continue;    // spheres without an ID of their own are nobody's row
    if (it.molecule <= 0 && !it.deformable) continue;
    if (again) {
      rows.pop_back();
      from.pop_back();
    }
    const int old = find(it.molecule);
    Cell cell = old < 0 ? newcomer(it.molecule) : cells[old];
    cell.tag = it.tag;
    cell.type = it.type;
    cell.mask = it.mask;
    cell.deformable = it.deformable;
    // a radius does not give back the last digit of the volume that it was made from
    if (it.deformable || dcm::ball_volume(dcm::ball_radius(cell.volume0)) != it.volume0)
      cell.volume0 = it.volume0;
    cell.built0 = cell.volume0;
    for (int k = 0; k < 3; k++) cell.x[k] = it.x[k];
    if (!it.deformable) cell.volume = cell.volume0;
    cell.nnodes = cell.nfaces = 0;
    rows.push_back(cell);
    from.push_back(old);
  }

  take_over(rows, from);
}

void DCMCellTable::take_over(const std::vector<Cell> &rows, const std::vector<int> &from)
{
  each_column([&](DCMColumn &column) {
    const int width = column.width();
    std::vector<double> values(rows.size() * width, column.preset);
    for (size_t row = 0; row < rows.size(); row++)
      if (from[row] >= 0)
        std::copy_n(column.values.begin() + (size_t) from[row] * width, width,
                    values.begin() + row * width);
    column.values.swap(values);
  });
  cells = rows;
  list_deformable();
  if (saved.cells.empty()) return;
  each_column([&](DCMColumn &column) {
    for (int row = 0; row < size(); row++)
      if (from[row] < 0) fill_saved(column, row);
  });
}

// values of a cell that comes from a restart file

void DCMCellTable::fill_saved(DCMColumn &column, int row) const
{
  const int from = find_in(saved.cells, cells[row].molecule);
  if (from < 0) return;
  for (const auto &it : saved.columns)
    if (it.name == column.name)
      std::copy_n(it.values.begin() + (size_t) from * it.width, it.width,
                  column.values.begin() + (size_t) row * it.width);
}

void DCMCellTable::list_deformable()
{
  deformable_rows.clear();
  for (int row = 0; row < size(); row++)
    if (cells[row].deformable) deformable_rows.push_back(row);
  here = deformable_rows;
  elsewhere.clear();
  nchanges++;
}

void DCMCellTable::set_here(const std::vector<int> &rows)
{
  here = rows;
  elsewhere.clear();
  std::set_difference(deformable_rows.begin(), deformable_rows.end(), here.begin(), here.end(),
                      std::back_inserter(elsewhere));
  current = erased = false;
}

void DCMCellTable::reserve_molecules()
{
  tagint last = 0;
  for (int i = 0; i < atom->nlocal; i++) last = std::max(last, atom->molecule[i]);
  MPI_Allreduce(MPI_IN_PLACE, &last, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (last < MAXTAGINT) next_molecule = std::max(next_molecule, last + 1);
  // IDs count on from the highest: at the end of the range there is none left
  if (last == MAXTAGINT) next_molecule = MAXTAGINT;
}

tagint DCMCellTable::new_molecule()
{
  if (next_molecule >= MAXTAGINT)
    error->all(FLERR,
               "{}: no molecule IDs are left for new cells at step {}: they count on from the "
               "highest, {}; give the cells lower ones with 'set group ... mol'",
               STYLE, update->ntimestep, MAXTAGINT);
  return next_molecule++;
}

/* ---------------------------------------------------------------------- */

void DCMCellTable::measured(int row, double volume, double area, const double *x)
{
  Cell &cell = cells[row];
  cell.volume = volume;
  cell.area = area;
  std::copy_n(x, 3, cell.x);
}

void DCMCellTable::counted(int row, int nnodes, int nfaces)
{
  cells[row].nnodes = nnodes;
  cells[row].nfaces = nfaces;
}

void DCMCellTable::place(int row, const double *x)
{
  std::copy_n(x, 3, cells[row].x);
}

// what is not kept up to date is no number, so that nobody takes an old one for that of now

void DCMCellTable::begin_step()
{
  constexpr double NONE = std::numeric_limits<double>::quiet_NaN();
  const bool erase = current || !erased;
  if (erase)
    for (const int row : elsewhere) {
      Cell &cell = cells[row];
      cell.volume = cell.area = cell.x[0] = cell.x[1] = cell.x[2] = NONE;
    }
  each_column([&](DCMColumn &column) {
    if (column.heredity != DCMColumn::EACH_STEP) return;
    for (const int row : here) column(row) = 0.0;
    if (!erase) return;
    for (const int row : elsewhere) column(row) = NONE;
  });
  current = false;
  erased = true;
}

void DCMCellTable::update_all(const std::vector<int> &mine)
{
  if (current) return;
  current = true;
  std::vector<DCMColumn *> sums;
  each_column([&sums](DCMColumn &column) {
    if (column.heredity == DCMColumn::EACH_STEP) sums.push_back(&column);
  });
  const size_t width = 5 + sums.size();
  packed.assign(width * deformable_rows.size(), 0.0);
  auto at = deformable_rows.begin();
  for (const int row : mine) {
    at = std::lower_bound(at, deformable_rows.end(), row);
    const Cell &cell = cells[row];
    double *to = &packed[width * (at - deformable_rows.begin())];
    *to++ = cell.volume;
    *to++ = cell.area;
    to = std::copy_n(cell.x, 3, to);
    for (const auto *column : sums) *to++ = (*column)(row);
  }
  MPI_Allreduce(MPI_IN_PLACE, packed.data(), (int) packed.size(), MPI_DOUBLE, MPI_SUM, world);
  at = deformable_rows.begin();
  for (const int row : elsewhere) {
    at = std::lower_bound(at, deformable_rows.end(), row);
    Cell &cell = cells[row];
    const double *from = &packed[width * (at - deformable_rows.begin())];
    cell.volume = *from++;
    cell.area = *from++;
    std::copy_n(from, 3, cell.x);
    from += 3;
    for (auto *column : sums) (*column)(row) = *from++;
  }
}

/* ----------------------------------------------------------------------
   columns
------------------------------------------------------------------------- */

template <class Function> void DCMCellTable::each_column(Function &&f) const
{
  for (const auto &it : columns)
    if (const auto column = it.lock()) f(*column);
}

DCMCellTable::Handle DCMCellTable::make(const std::string &name,
                                        const std::vector<std::string> &names,
                                        DCMColumn::Heredity heredity, double preset)
{
  columns.erase(std::remove_if(columns.begin(), columns.end(),
                               [](const std::weak_ptr<DCMColumn> &it) {
                                 return it.expired();
                               }),
                columns.end());
  Handle handle(new DCMColumn(name, names, heredity, preset));
  handle->values.assign(cells.size() * handle->width(), preset);
  columns.push_back(handle);
  return handle;
}

DCMCellTable::Handle DCMCellTable::add(const std::string &asking, const std::string &name,
                                       DCMColumn::Heredity heredity, double preset,
                                       const std::vector<std::string> &names, Handle mine)
{
  int field;
  for (const auto &it : names.empty() ? std::vector<std::string>{name} : names) {
    const auto taken = column(it, field);
    if (taken && taken == mine) return mine;
    if (taken)
      error->all(FLERR,
                 "{}: cells have a value {} already, of another style; one of the two has to go",
                 asking, it);
  }
  const Handle handle = make(name, names, heredity, preset);
  for (const auto &it : saved.columns)
    if (it.name == name && it.width != handle->width())
      error->all(
          FLERR,
          "{}: the restart file has {} numbers of {} per cell, expected {}; it was written by "
          "another version of the package",
          asking, it.width, name, handle->width());
  for (int row = 0; row < size(); row++) fill_saved(*handle, row);
  return handle;
}

DCMCellTable::Handle DCMCellTable::share(const std::string &asking, const std::string &name,
                                         DCMColumn::Heredity heredity, double preset)
{
  for (const auto &it : columns) {
    const auto handle = it.lock();
    if (handle && handle->name == name) return handle;
  }
  return add(asking, name, heredity, preset);
}

DCMCellTable::Handle DCMCellTable::contribute(const std::string &name)
{
  for (const auto &it : columns) {
    const auto handle = it.lock();
    if (handle && handle->name == name) return handle;
  }
  return make(name, {}, DCMColumn::EACH_STEP, 0.0);
}

std::shared_ptr<const DCMColumn> DCMCellTable::column(const std::string &name, int &field) const
{
  for (const auto &it : columns) {
    const auto handle = it.lock();
    if (!handle) continue;
    const auto found = std::find(handle->fields.begin(), handle->fields.end(), name);
    if (found == handle->fields.end()) continue;
    field = (int) (found - handle->fields.begin());
    return handle;
  }
  return nullptr;
}

double DCMCellTable::value(const std::string &name, int row, double otherwise) const
{
  int field = 0;
  const auto found = column(name, field);
  return found ? (*found)(row, field) : otherwise;
}

std::vector<std::string> DCMCellTable::column_names() const
{
  std::vector<std::string> names;
  each_column([&names](const DCMColumn &column) {
    names.insert(names.end(), column.fields.begin(), column.fields.end());
  });
  return names;
}

/* ----------------------------------------------------------------------
   events. New molecule IDs are the highest, so that daughters stand at the end; the
   mother goes when everybody has heard of it
------------------------------------------------------------------------- */

void DCMCellTable::divided(tagint mother, tagint daughter1, tagint daughter2, double volume)
{
  const int row = require(mother);
  std::vector<Cell> rows = cells;
  std::vector<int> from(cells.size());
  for (size_t n = 0; n < from.size(); n++) from[n] = (int) n;
  for (const tagint molecule : {daughter1, daughter2}) {
    Cell cell = cells[row];
    cell.molecule = molecule;
    cell.tag = 0;    // until the next rebuild
    cell.mother = mother;
    cell.generation++;
    cell.birth = time();
    cell.volume0 *= 0.5;    // volume is conserved over generations
    cell.phase = QUIESCENT;
    rows.push_back(cell);
    from.push_back(row);
  }
  take_over(rows, from);
  const Division division = {row, {size() - 2, size() - 1}, volume};
  each_column([&](DCMColumn &column) {
    for (const int daughter : division.daughter)
      for (int k = 0; k < column.width(); k++) {
        double &value = column(daughter, k);
        if (column.heredity == DCMColumn::SPLIT) value *= 0.5;
        if (column.heredity == DCMColumn::RESET) value = column.preset;
      }
  });
  for (auto *const role : DCMRole::of(lmp)) role->cell_divided(division);

  from.resize(size() - 1);
  rows = cells;
  rows.erase(rows.begin() + row);
  for (size_t n = 0; n < from.size(); n++) from[n] = (int) n < row ? (int) n : (int) n + 1;
  take_over(rows, from);
}

void DCMCellTable::removed(tagint molecule)
{
  const int row = require(molecule);
  for (auto *const role : DCMRole::of(lmp)) role->cell_removed(row);
  std::vector<Cell> rows = cells;
  rows.erase(rows.begin() + row);
  std::vector<int> from(rows.size());
  for (size_t n = 0; n < from.size(); n++) from[n] = (int) n < row ? (int) n : (int) n + 1;
  take_over(rows, from);
}

void DCMCellTable::converted(tagint molecule, int type, bool deformable, double volume0)
{
  const int row = require(molecule);
  const double before = cells[row].volume0;
  cells[row].type = type;
  cells[row].deformable = deformable;
  cells[row].volume0 = volume0;
  list_deformable();
  for (auto *const role : DCMRole::of(lmp)) role->cell_converted(row, before);
}

void DCMCellTable::retyped(tagint molecule, int type, int mask)
{
  const int row = require(molecule), before = cells[row].type;
  cells[row].type = type;
  cells[row].mask = mask;
  nchanges++;
  for (auto *const role : DCMRole::of(lmp)) role->cell_retyped(row, before);
}

/* ----------------------------------------------------------------------
   restart record: cells by molecule, columns by name
------------------------------------------------------------------------- */

void DCMCellTable::put(DCMRecord &record) const
{
  std::vector<tagint> lineage;
  std::vector<double> life;
  for (const auto &cell : cells) {
    lineage.insert(lineage.end(),
                   {cell.molecule, cell.mother, (tagint) cell.generation, (tagint) cell.phase});
    life.insert(life.end(), {cell.birth, cell.volume0});
  }
  record.put(next_molecule);
  record.put(lineage);
  record.put(life);
  std::vector<const DCMColumn *> kept;
  each_column([&kept](const DCMColumn &column) {
    if (column.heredity != DCMColumn::EACH_STEP) kept.push_back(&column);
  });
  record.put((int) kept.size());
  for (const auto *column : kept) {
    record.put(column->name);
    record.put(column->width());
    record.put(column->values);
  }
}

void DCMCellTable::get(DCMRecord &record)
{
  std::vector<tagint> lineage;
  std::vector<double> life;
  record.get(next_molecule);
  record.get(lineage);
  record.get(life);
  for (size_t n = 0; 2 * n < life.size(); n++) {
    Cell cell = {};
    cell.molecule = lineage[4 * n];
    cell.mother = lineage[4 * n + 1];
    cell.generation = (int) lineage[4 * n + 2];
    cell.phase = (int) lineage[4 * n + 3];
    cell.birth = life[2 * n];
    cell.volume0 = life[2 * n + 1];
    saved.cells.push_back(cell);
  }
  int ncolumns = 0;
  record.get(ncolumns);
  saved.columns.resize(ncolumns);
  for (auto &it : saved.columns) {
    record.get(it.name);
    record.get(it.width);
    record.get(it.values);
  }
}

/* ---------------------------------------------------------------------- */

double DCMCellTable::memory_usage() const
{
  double bytes = (double) cells.capacity() * sizeof(Cell);
  bytes += (double) packed.capacity() * sizeof(double);
  bytes +=
      (double) (deformable_rows.capacity() + here.capacity() + elsewhere.capacity()) * sizeof(int);
  each_column([&bytes](const DCMColumn &column) {
    bytes += (double) column.values.capacity() * sizeof(double);
  });
  return bytes;
}
