/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_parameters.h"

#include "comm.h"
#include "dcm_text.h"
#include "error.h"
#include "tokenizer.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

using namespace LAMMPS_NS;

static const std::array<std::string, 4> REGIONS = {"lateral", "polar", "apical", "junction"};

// every keyword a cell type may have: a misspelled one is an error, not a silent default

// clang-format off
static const std::vector<std::string> KEYWORDS = {
    "E_cor", "h_cor", "nu_cor", "gamma", "K_V", "E_contact", "nu_contact", "friction_normal",
    "friction_tangential", "friction_ecm", "a1", "a2", "a3", "a4", "D", "cycle_time", "cycle_sd"};
// clang-format on

DCMParameters::DCMParameters(LAMMPS *lmp, const std::string &_asking) :
    Pointers(lmp), asking(_asking), names(1)
{
}

/* ---------------------------------------------------------------------- */

int DCMParameters::parse(int narg, char **arg, int ncount)
{
  if (narg < 1 + ncount)
    error->all(FLERR,
               "{}: expected a parameter file (or NULL) and {} cell-type name{}, got {} "
               "arguments",
               asking, ncount, ncount == 1 ? "" : "s (one per atom type)", narg);
  file = (strcmp(arg[0], "NULL") == 0) ? "" : arg[0];
  types.clear();
  energies.clear();
  if (!file.empty()) read_file();

  names.assign(1, "");
  for (int i = 1; i <= ncount; i++) {
    const std::string name = (strcmp(arg[i], "NULL") == 0) ? "" : arg[i];
    if (!name.empty() && !file.empty() && types.count(name) == 0) {
      std::string known;
      for (auto &t : types) known += " " + t.first;
      error->all(FLERR, "{}: unknown cell type {}; parameter file {} has:{}", asking, name, file,
                 known);
    }
    names.push_back(name);
  }
  return 1 + ncount;
}

/* ---------------------------------------------------------------------- */

int DCMParameters::parse_keyword(int narg, char **arg, const std::vector<std::string> &known)
{
  if (std::find(known.begin(), known.end(), arg[0]) == known.end()) return 0;
  if (narg < 2) error->all(FLERR, "{}: keyword {} needs a value", asking, arg[0]);
  overrides[arg[0]] = number(arg[0], arg[1], ANY);
  return 2;
}

/* ----------------------------------------------------------------------
   the file is read by rank 0 and parsed by all, so that all find the same errors
------------------------------------------------------------------------- */

void DCMParameters::read_file()
{
  const std::string path = comm->me == 0 ? utils::get_potential_file_path(file) : "";
  std::string text;
  if (!dcm_read_text(comm, world, path, text))
    error->all(FLERR,
               "{}: cannot open parameter file {}; give its path or set LAMMPS_POTENTIALS to its "
               "folder",
               asking, file);

  std::string current;

  for (const auto &line : Tokenizer(text, "\n").as_vector())
    read_line(line.substr(0, line.find('#')), current);
}

// one of:  celltype NAME  |  KEYWORD VALUE  |  adhesion NAME[:REGION] NAME[:REGION] VALUE

void DCMParameters::read_line(const std::string &line, std::string &current)
{
  const auto words = Tokenizer(line).as_vector();
  if (words.empty()) return;
  const std::string where = fmt::format("parameter file {}: '{}'", file, utils::trim(line));
  if (words[0] == "celltype" && words.size() == 2) {
    current = words[1];
    types[current];
  } else if (words[0] == "adhesion" && words.size() == 4) {
    for (int k = 1; k <= 2; k++) {
      const auto colon = words[k].find(':');
      if (colon == std::string::npos) continue;
      const std::string region = words[k].substr(colon + 1);
      if (std::find(REGIONS.begin(), REGIONS.end(), region) == REGIONS.end())
        error->all(FLERR, "{}: {}: unknown region {}; known: lateral polar apical junction", asking,
                   where, region);
    }
    const double value = number("adhesion", words[3].c_str(), NONNEGATIVE);
    energies[{words[1], words[2]}] = value;
    energies[{words[2], words[1]}] = value;
  } else if (words.size() == 2 && !current.empty() &&
             std::find(KEYWORDS.begin(), KEYWORDS.end(), words[0]) != KEYWORDS.end()) {
    types[current][words[0]] = number(words[0].c_str(), words[1].c_str(), ANY);
  } else {
    error->all(FLERR,
               "{}: {}: expected 'celltype NAME', 'KEYWORD VALUE' below a celltype, or "
               "'adhesion NAME[:REGION] NAME[:REGION] VALUE'; known keywords: {}",
               asking, where, utils::join_words(KEYWORDS, " "));
  }
}

/* ---------------------------------------------------------------------- */

double DCMParameters::number(const char *keyword, const char *text, Range range) const
{
  if (!utils::is_double(text))
    error->all(FLERR, "{}: {} is '{}', expected a number", asking, keyword, text);
  // not utils::numeric(), whose error about a number like 1e999 names neither style nor keyword
  return check(keyword, std::strtod(text, nullptr), range, "");
}

double DCMParameters::check(const std::string &keyword, double value, Range range,
                            const std::string &where) const
{
  const bool ok = std::isfinite(value) && (range == ANY || (range == POSITIVE && value > 0.0) ||
                                           (range == NONNEGATIVE && value >= 0.0));
  if (!ok)
    error->all(FLERR, "{}: {}{} is {}, must be {}", asking, keyword, where, value,
               range == POSITIVE ? "a positive number"
                                 : (range == NONNEGATIVE ? "zero or positive" : "finite"));
  return value;
}

/* ---------------------------------------------------------------------- */

double DCMParameters::get(int slot, const std::string &keyword, Range range) const
{
  const auto given = overrides.find(keyword);
  if (given != overrides.end()) return check(keyword, given->second, range, "");
  const auto type = types.find(names[slot]);
  if (type == types.end() || type->second.count(keyword) == 0)
    error->all(FLERR, "{}: no value of {} for cell type {}; add it to {} or give the keyword",
               asking, keyword, names[slot],
               file.empty() ? std::string("a parameter file") : "parameter file " + file);
  return check(keyword, type->second.at(keyword), range, " of cell type " + names[slot]);
}

double DCMParameters::get(int slot, const std::string &keyword, Range range, double preset) const
{
  const auto type = types.find(names[slot]);
  const bool given = overrides.count(keyword) > 0 ||
                     (type != types.end() && type->second.count(keyword) > 0);
  return given ? get(slot, keyword, range) : preset;
}

/* ----------------------------------------------------------------------
   the most specific entry counts: both regions named, one named, none named
------------------------------------------------------------------------- */

double DCMParameters::adhesion(int i, int ri, int j, int rj) const
{
  const auto given = overrides.find("W");
  if (given != overrides.end()) return check("W", given->second, NONNEGATIVE, "");
  const std::string a = names[i], b = names[j];
  const std::string ar = a + ":" + REGIONS[ri], br = b + ":" + REGIONS[rj];
  for (const auto &key : {std::make_pair(ar, br), std::make_pair(ar, b), std::make_pair(a, br),
                          std::make_pair(a, b)}) {
    const auto found = energies.find(key);
    if (found != energies.end()) return found->second;
  }
  error->all(FLERR,
             "{}: no adhesion between cell types {} and {}; add 'adhesion {} {} W' to {} or "
             "give keyword W",
             asking, a, b, a, b,
             file.empty() ? std::string("a parameter file") : "parameter file " + file);
  return 0.0;
}
