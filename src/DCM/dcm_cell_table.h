/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CELL_TABLE_H
#define LMP_DCM_CELL_TABLE_H

#include "pointers.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// A quantity of cells that a style adds to the table: `width` numbers a cell, zero-based rows as in
// the table. It lives as long as a style keeps the handle that DCMCellTable::add() returned.

class DCMColumn {
 public:
  // what the daughters of a cell begin with: the mother's value, half of it, the preset. EACH_STEP:
  // zero at the start of every step, then whoever contributes adds; not kept in restart files

  enum Heredity { INHERIT, SPLIT, RESET, EACH_STEP };

  const std::string name;
  const std::vector<std::string> fields;    // names of its numbers; one: the column's own
  const Heredity heredity;
  const double preset;

  int width() const { return (int) fields.size(); }
  double operator()(int row, int k = 0) const { return values[(size_t) row * width() + k]; }
  double &operator()(int row, int k = 0) { return values[(size_t) row * width() + k]; }

  // all numbers of a row, as the struct of doubles that a style keeps per cell

  template <class Record> Record load(int row) const
  {
    static_assert(sizeof(Record) % sizeof(double) == 0, "doubles only");
    Record record;
    copy_row(row, reinterpret_cast<double *>(&record), sizeof(Record) / sizeof(double));
    return record;
  }
  template <class Record> void store(int row, const Record &record)
  {
    static_assert(sizeof(Record) % sizeof(double) == 0, "doubles only");
    set_row(row, reinterpret_cast<const double *>(&record), sizeof(Record) / sizeof(double));
  }

 private:
  friend class DCMCellTable;    // which keeps its rows

  DCMColumn(const std::string &, const std::vector<std::string> &, Heredity, double);
  std::vector<double> values;

  void copy_row(int, double *, size_t) const;
  void set_row(int, const double *, size_t);
};

// The one table of cells, of both kinds, sorted by molecule ID; owned by fix dcm/cell, which all
// styles ask for it. Deformable cells are always in it, center-based ones (spheres) while somebody
// has asked for them: fix dcm/cell request_spheres().
//
// A row number is good until the next rebuild of the neighbor lists or the next change of a cell.
// All processes hold all cells and know their membership, lineage, rest volume and columns; but
// volume, area, x and columns EACH_STEP of deformable cells are kept up to date only for those that
// have atoms, owned or ghost, on this process: deformable(). Elsewhere they are not a number, until
// somebody asks for those of all(): FixDCMCell::update_all().

class DCMCellTable : protected Pointers {
 public:
  enum Phase { GROWING, ROUNDING, READY, QUIESCENT, DYING, NPHASE };

  struct Cell {
    tagint molecule, tag;    // tag: of the center or sphere
    int type, mask;          // of that atom
    bool deformable;
    int nnodes, nfaces;     // 0: a sphere
    double volume0;         // rest volume; sphere: its volume
    double built0;          // that when the neighbor lists were last built
    double volume, area;    // these and x: see above
    double x[3];    // deformable: mean of the nodes, unwrapped next to the center atom; sphere:
                    // where it was at the last rebuild, wrapped
    int phase;      // of its life; cells that no style makes grow are QUIESCENT
    tagint mother;
    int generation;
    double birth;    // time
  };

  // a division: the mother's row, still there, and those of the two daughters

  struct Division {
    int mother, daughter[2];
    double volume;    // of the mother when it divided
  };

  // the atom that stands for a cell, as it is now: the center of a deformable one, or the sphere

  struct CellAtom {
    tagint molecule, tag;
    int type, mask, deformable;
    double volume0;    // rest volume
    double x[3];       // as stored: wrapped
  };

  DCMCellTable(class LAMMPS *);

  // ---- reading

  int size() const { return (int) cells.size(); }
  const Cell &operator[](int row) const { return cells[row]; }
  int find(tagint molecule) const;    // row, -1: no such cell

  // deformable cells that have atoms on this process, ghosts included; after a change of cells all,
  // until the next rebuild

  const std::vector<int> &deformable() const { return here; }

  // all cells of the tissue, the same on all processes

  const std::vector<Cell> &all() const { return cells; }
  const std::vector<int> &all_deformable() const { return deformable_rows; }
  static std::vector<CellAtom> gather(class LAMMPS *, bool spheres);

  // error unless every cell has a positive molecule ID of its own

  void require_ids(const std::string &asking) const;

  // ---- columns

  // a new column of one owner; values of a restart file return by its name. Call it in init(): the
  // handle of the run before is given back. names: of its numbers, {}: one, the column's own

  using Handle = std::shared_ptr<DCMColumn>;
  Handle add(const std::string &asking, const std::string &name, DCMColumn::Heredity heredity,
             double preset = 0.0, const std::vector<std::string> &names = {}, Handle mine = {});

  // a column of one number that several fixes of one style have in common

  Handle share(const std::string &asking, const std::string &name, DCMColumn::Heredity heredity,
               double preset = 0.0);

  // the column of a sum to which several styles contribute in each step, such as pressure; call
  // contributed() when it is done for the rows of deformable()

  Handle contribute(const std::string &name);
  void contributed() { current = false; }

  // read any column: nullptr if nobody has it; field: which of its numbers has this name

  std::shared_ptr<const DCMColumn> column(const std::string &name, int &field) const;
  double value(const std::string &name, int row, double otherwise = 0.0) const;
  std::vector<std::string> column_names() const;

  double time() const;    // of the simulation, also with time steps that change

  // how often cells have come, gone or changed: what was found out about all cells holds until then

  bigint changes() const { return nchanges; }

  // ---- changing, for those who change the atoms as well

  void set_volume0(int row, double volume0) { cells[row].volume0 = volume0; }
  void set_phase(int row, Phase phase) { cells[row].phase = phase; }
  tagint new_molecule();
  tagint last_molecule() const { return next_molecule - 1; }    // highest ID ever used

  // tell everybody (DCMRole); rows change
  void divided(tagint mother, tagint daughter1, tagint daughter2, double volume);
  void removed(tagint molecule);
  void converted(tagint molecule, int type, bool deformable, double volume0);
  void retyped(tagint molecule, int type, int mask);    // of its center

  // ---- for fix dcm/cell alone

  void refresh(bool spheres);    // collective: take in the cells that atoms stand for now
  void reserve_molecules();      // collective: new IDs are above all there are
  void measured(int row, double volume, double area, const double *x);
  void counted(int row, int nnodes, int nfaces);
  void place(int row, const double *x);
  void set_here(const std::vector<int> &rows);      // deformable ones, ascending
  void begin_step();                                // zeros for columns EACH_STEP
  void update_all(const std::vector<int> &mine);    // collective; rows this process stands for
  void put(class DCMRecord &) const;
  void get(class DCMRecord &);
  void forget_saved() { saved = Saved(); }
  double memory_usage() const;

 private:
  struct Saved {    // what a restart file says, until cells and styles have taken it up
    struct Values {
      std::string name;
      int width;
      std::vector<double> values;
    };
    std::vector<Cell> cells;    // their lives only
    std::vector<Values> columns;
  } saved;

  std::vector<Cell> cells;    // sorted by molecule
  std::vector<int> deformable_rows;
  std::vector<int> here, elsewhere;       // deformable ones on this process, and not on it
  bool current = true, erased = false;    // what is measured elsewhere: up to date, not a number
  bigint nchanges = 0;
  std::vector<double> packed;
  std::vector<std::weak_ptr<DCMColumn>> columns;
  tagint next_molecule = 1, doubled = 0;    // doubled: an ID that several cells have

  template <class Function> void each_column(Function &&) const;
  Handle make(const std::string &, const std::vector<std::string> &, DCMColumn::Heredity, double);
  Cell newcomer(tagint molecule) const;
  void fill_saved(DCMColumn &, int row) const;
  void list_deformable();
  void take_over(const std::vector<Cell> &rows, const std::vector<int> &from);
  int require(tagint molecule) const;
};

}    // namespace LAMMPS_NS

#endif
