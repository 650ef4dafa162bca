/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#ifndef LMP_DCM_COEFS_H
#define LMP_DCM_COEFS_H

#include "dcm_parameters.h"

#include "comm.h"
#include "error.h"
#include "utils.h"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// one coefficient of a bond or dihedral style, under the keyword the deck has for it: a parameter
// of the cell type, or a choice

struct DCMField {
  const char *keyword;
  double *number;    // nullptr: a choice
  DCMParameters::Range range;
  double preset;    // NAN: the parameter must be given
  int *choice;
  std::vector<std::string> names;    // of the choices

  DCMField(const char *_keyword, double &_number, DCMParameters::Range _range,
           double _preset = NAN) :
      keyword(_keyword),
      number(&_number), range(_range), preset(_preset), choice(nullptr)
  {
  }
  DCMField(const char *_keyword, int &_choice, const std::vector<std::string> &_names) :
      keyword(_keyword), number(nullptr), range(DCMParameters::ANY), preset(NAN), choice(&_choice),
      names(_names)
  {
  }
};

// Coefficients per bond or dihedral type: reads `coeff N [FILE] CELLTYPE [keyword value ...]`, and
// writes and reads restart and data files. A Coef says once what it is made of:
//   std::vector<DCMField> fields();
//   std::string derive();    what follows from them; returns what is wrong, "" if all is well

template <class Coef> class DCMCoefs : protected Pointers {
 public:
  DCMCoefs(class LAMMPS *lmp, const std::string &_asking) : Pointers(lmp), asking(_asking) {}

  const Coef &operator[](int type) const { return entries[type].coef; }
  Coef &operator[](int type) { return entries[type].coef; }
  int count() const { return (int) entries.size() - 1; }    // types 1 to count()

  void allocate(int ntypes) { entries.assign(ntypes + 1, Entry()); }
  void parse(int narg, char **arg, int *setflag);
  void resolve();    // in init_style(): values of cell types that fix dcm/cell names
  void write_restart(FILE *);
  void read_restart(FILE *);
  void write_data(FILE *);

 private:
  // section of a restart file: these two, then per type numbers, choices and the cell type
  static constexpr int MAGIC = 0x434d4344, VERSION = 1;    // "DCMC"

  struct Entry {
    Coef coef;
    std::string name;                          // cell type
    std::shared_ptr<DCMParameters> pending;    // where the values come from at init
  };
  std::string asking;
  std::vector<Entry> entries;

  void take_values(Entry &, const DCMParameters &);
  void derive(Entry &);
};

/* ---------------------------------------------------------------------- */

template <class Coef> void DCMCoefs<Coef>::parse(int narg, char **arg, int *setflag)
{
  if (narg < 1) error->all(FLERR, "{}: expected a type and a cell type", asking);
  int ilo, ihi;
  utils::bounds(FLERR, arg[0], 1, count(), ilo, ihi, error);

  Entry entry;
  auto fields = entry.coef.fields();
  std::vector<std::string> numbers, choices;
  for (const auto &field : fields) (field.number ? numbers : choices).emplace_back(field.keyword);

  auto parameters = std::make_shared<DCMParameters>(lmp, asking, numbers);
  DCMArgs args(lmp, asking, narg - 1, arg + 1, choices);
  parameters->parse_one(args);
  while (args.next()) {
    if (parameters->parse_keyword(args)) continue;
    for (auto &field : fields)
      if (args.is(field.keyword)) *field.choice = args.choose(field.names);
  }
  if (parameters->own())
    take_values(entry, *parameters);
  else
    entry.pending = parameters;
  for (int i = ilo; i <= ihi; i++) {
    entries[i] = entry;
    setflag[i] = 1;
  }
}

template <class Coef> void DCMCoefs<Coef>::take_values(Entry &entry, const DCMParameters &from)
{
  for (auto &field : entry.coef.fields()) {
    if (!field.number) continue;
    *field.number = std::isnan(field.preset)
                        ? from.get(1, field.keyword, field.range)
                        : from.get(1, field.keyword, field.range, field.preset);
  }
  entry.name = from.used(1) ? from.name(1) : "NULL";
  derive(entry);
}

template <class Coef> void DCMCoefs<Coef>::derive(Entry &entry)
{
  const std::string problem = entry.coef.derive();
  if (!problem.empty()) error->all(FLERR, "{}: cell type {}: {}", asking, entry.name, problem);
}

template <class Coef> void DCMCoefs<Coef>::resolve()
{
  for (auto &entry : entries) {
    if (!entry.pending) continue;
    entry.pending->resolve();
    take_values(entry, *entry.pending);
  }
}

/* ----------------------------------------------------------------------
   restart files hold the coefficients, so that no parameter file is needed
------------------------------------------------------------------------- */

template <class Coef> void DCMCoefs<Coef>::write_restart(FILE *fp)
{
  const int head[2] = {MAGIC, VERSION};
  fwrite(head, sizeof(int), 2, fp);
  for (int i = 1; i <= count(); i++) {
    std::vector<double> numbers;
    std::vector<int> choices;
    for (const auto &field : entries[i].coef.fields()) {
      if (field.number)
        numbers.push_back(*field.number);
      else
        choices.push_back(*field.choice);
    }
    choices.push_back((int) entries[i].name.size());
    fwrite(numbers.data(), sizeof(double), numbers.size(), fp);
    fwrite(choices.data(), sizeof(int), choices.size(), fp);
    fwrite(entries[i].name.data(), sizeof(char), entries[i].name.size(), fp);
  }
}

template <class Coef> void DCMCoefs<Coef>::read_restart(FILE *fp)
{
  auto read = [&](void *to, size_t size, int n) {
    if (comm->me == 0) utils::sfread(FLERR, to, size, n, fp, nullptr, error);
    MPI_Bcast(to, (int) size * n, MPI_BYTE, 0, world);
  };
  int head[2];
  read(head, sizeof(int), 2);
  if (head[0] != MAGIC || head[1] != VERSION)
    error->all(FLERR,
               "{}: the restart file holds coefficients in {}, this version of the package reads "
               "version {}; continue with the version that wrote it, or let that one write a data "
               "file (write_data) and start from it",
               asking,
               head[0] == MAGIC ? fmt::format("version {} of their form", head[1])
                                : std::string("an old or foreign form"),
               VERSION);
  for (int i = 1; i <= count(); i++) {
    Entry &entry = entries[i];
    int size = 0;
    auto fields = entry.coef.fields();
    for (auto &field : fields)
      if (field.number) read(field.number, sizeof(double), 1);
    for (auto &field : fields)
      if (field.choice) read(field.choice, sizeof(int), 1);
    read(&size, sizeof(int), 1);
    entry.name.resize(size);
    read(&entry.name[0], sizeof(char), size);
    derive(entry);
  }
}

/* ----------------------------------------------------------------------
   coefficients as arguments that parse() reads back, all digits kept
------------------------------------------------------------------------- */

template <class Coef> void DCMCoefs<Coef>::write_data(FILE *fp)
{
  for (int i = 1; i <= count(); i++) {
    utils::print(fp, "{} NULL {}", i, entries[i].name);
    for (const auto &field : entries[i].coef.fields()) {
      if (field.number)
        utils::print(fp, " {} {:.17g}", field.keyword, *field.number);
      else
        utils::print(fp, " {} {}", field.keyword, field.names[*field.choice]);
    }
    utils::print(fp, "\n");
  }
}

}    // namespace LAMMPS_NS

#endif
