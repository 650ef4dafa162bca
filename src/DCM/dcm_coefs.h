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
#include "dcm_record.h"

#include "error.h"
#include "utils.h"

#include <cmath>
#include <cstring>
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
  static constexpr int RECORD = 2;    // version of the record in restart files

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
  int ilo = -1, ihi = -1;
  if (strlen(arg[0]) < 12) utils::bounds(FLERR, arg[0], 1, count(), ilo, ihi, nullptr);
  if (ilo < 1 || ihi > count() || ilo > ihi)
    error->all(FLERR, "{}: type is {}, must be one of the {} types of the box, or a range of them",
               asking, arg[0], count());

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
  DCMRecord record(lmp, asking, RECORD);
  for (int i = 1; i <= count(); i++) {
    for (const auto &field : entries[i].coef.fields())
      if (field.number)
        record.put(*field.number);
      else
        record.put(*field.choice);
    record.put(entries[i].name);
  }
  record.write_plain(fp);
}

template <class Coef> void DCMCoefs<Coef>::read_restart(FILE *fp)
{
  DCMRecord record(lmp, asking, RECORD);
  record.read_plain(fp);
  for (int i = 1; i <= count(); i++) {
    Entry &entry = entries[i];
    auto fields = entry.coef.fields();
    for (auto &field : fields)
      if (field.number)
        record.get(*field.number);
      else
        record.get(*field.choice);
    record.get(entry.name);
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
