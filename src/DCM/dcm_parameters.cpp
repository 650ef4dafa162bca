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
#include "fix_dcm_cell.h"
#include "modify.h"
#include "tokenizer.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <set>

using namespace LAMMPS_NS;

// as enum AtomVecDCM::Region

static const std::array<std::string, 5> REGIONS = {"lateral", "polar", "apical", "junction",
                                                   "basal"};

// every keyword a cell type may have: a misspelled one is an error, not a silent default

// clang-format off
static const std::vector<std::string> KEYWORDS = {
    "E_cor", "h_cor", "nu_cor", "gamma", "K_V", "E_contact", "nu_contact", "layer",
    "friction_normal", "friction_tangential", "friction_ecm", "a1", "a2", "a3", "a4", "D",
    "cycle_time", "cycle_sd",
    "tension", "tension:lateral", "tension:polar", "tension:apical", "tension:junction",
    "tension:basal"};
// clang-format on

DCMParameters::DCMParameters(LAMMPS *lmp, const std::string &_asking,
                             const std::vector<std::string> &_keywords) :
    Pointers(lmp),
    asking(_asking), has_own(false), keywords(_keywords), names(1)
{
}

/* ----------------------------------------------------------------------
   what is no keyword must be a file: if neither, the error tells of both
------------------------------------------------------------------------- */

void DCMParameters::parse(DCMArgs &args, int ntypes)
{
  args.add_keywords(keywords);
  has_own = !args.keyword_ahead();
  if (has_own) parse_table(args, ntypes);
}

void DCMParameters::parse_table(DCMArgs &args, int ntypes)
{
  if (args.left() < 1 + ntypes)
    error->all(FLERR,
               "{}: expected {}FILE name1 ... nameN: a parameter file (or NULL) and {} cell-type "
               "names (one per atom type); got {}",
               asking, keywords.empty() ? "" : "a keyword (known: " + args.known() + ") or ",
               ntypes,
               args.left() ? fmt::format("{} and {} more", args.ahead(), args.left() - 1) : "none");
  file = args.take();
  read_file(args);
  names.assign(1, "");
  for (int i = 1; i <= ntypes; i++) {
    const std::string name = args.take();
    names.push_back(name == "NULL" ? "" : name);
    if (!names[i].empty() && !file.empty() && !types.count(names[i])) unknown_type(names[i]);
  }
}

void DCMParameters::parse_one(DCMArgs &args)
{
  args.add_keywords(keywords);
  if (args.left() == 0)
    error->all(FLERR, "{}: expected a cell type, with its parameter file before it or without",
               asking);
  has_own = !args.keyword_ahead(1);
  if (has_own)
    parse_table(args, 1);
  else
    wanted = args.take();
}

bool DCMParameters::parse_keyword(DCMArgs &args)
{
  if (std::find(keywords.begin(), keywords.end(), args.keyword()) == keywords.end()) return false;
  overrides[args.keyword()] = args.number();
  return true;
}

/* ----------------------------------------------------------------------
   at each init(), since the deck may have named other ones
------------------------------------------------------------------------- */

void DCMParameters::resolve()
{
  if (has_own) return;
  const auto *const fix = FixDCMCell::find(lmp);
  const DCMParameters *const deck = fix ? fix->cell_types() : nullptr;
  if (!deck)
    error->all(FLERR,
               "{}: expected cell-type names: say 'fix cell all dcm/cell types FILE name1 ... "
               "nameN' once for all styles, or give 'FILE name{}' to this one",
               asking, wanted.empty() ? "1 ... nameN" : "");
  file = deck->file;
  types = deck->types;
  energies = deck->energies;
  names = deck->names;
  if (wanted.empty()) return;
  const bool listed = std::find(names.begin(), names.end(), wanted) != names.end();
  if (file.empty() ? !listed : !types.count(wanted)) unknown_type(wanted);
  names = {"", wanted};
}

void DCMParameters::unknown_type(const std::string &name) const
{
  std::set<std::string> known;
  if (file.empty()) known.insert(names.begin(), names.end());
  for (const auto &type : types) known.insert(type.first);
  known.erase("");    // NULL
  error->all(FLERR, "{}: unknown cell type {}; {} has: {}", asking, name,
             file.empty() ? std::string("fix dcm/cell") : "parameter file " + file,
             utils::join_words({known.begin(), known.end()}, " "));
}

/* ----------------------------------------------------------------------
   the file is read by rank 0 and parsed by all, so that all find the same errors
------------------------------------------------------------------------- */

void DCMParameters::read_file(const DCMArgs &args)
{
  types.clear();
  energies.clear();
  if (file == "NULL") file.clear();
  if (file.empty()) return;
  const std::string path = comm->me == 0 ? utils::get_potential_file_path(file) : "";
  std::string text;
  if (!dcm_read_text(comm, world, path, text))
    error->all(FLERR,
               "{}: cannot open parameter file {}; give its path or set LAMMPS_POTENTIALS to its "
               "folder. If no file was meant: known keywords are {}",
               asking, file, args.known());

  std::string current;
  for (const auto &line : Tokenizer(text, "\n").as_vector())
    read_line(line.substr(0, line.find('#')), current);

  // misspelled, adhesion would quietly stay that of the cell type without a region

  for (const auto &it : energies) {
    const std::string name = it.first.first.substr(0, it.first.first.find(':'));
    if (types.count(name)) continue;
    std::set<std::string> known;
    for (const auto &type : types) known.insert(type.first);
    error->all(FLERR, "{}: parameter file {}: adhesion names the unknown cell type {}; it has: {}",
               asking, file, name, utils::join_words({known.begin(), known.end()}, " "));
  }
}

// a value that stands there twice, and not the same

void DCMParameters::contradiction(const std::string &where, double before, double now) const
{
  if (before != now)
    error->all(FLERR, "{}: {}: it has the value {} above already; remove one of the two", asking,
               where, before);
}

// one of:  celltype NAME  |  KEYWORD VALUE  |  adhesion NAME[:REGION] NAME[:REGION] VALUE

void DCMParameters::read_line(const std::string &line, std::string &current)
{
  const auto words = Tokenizer(line).as_vector();
  if (words.empty()) return;
  const std::string where = fmt::format("parameter file {}: '{}'", file, utils::trim(line));
  if (words[0] == "celltype" && words.size() == 2) {
    current = words[1];
    if (current.find(':') != std::string::npos || current == "NULL")
      error->all(FLERR,
                 "{}: {}: a cell type cannot have this name: ':' stands before a region, and "
                 "NULL for no cell type",
                 asking, where);
    if (types.count(current))
      error->all(FLERR, "{}: {}: there is a cell type of this name above already", asking, where);
    types[current];
  } else if (words[0] == "adhesion" && words.size() == 4) {
    for (int k = 1; k <= 2; k++) {
      const auto colon = words[k].find(':');
      if (colon == std::string::npos) continue;
      const std::string region = words[k].substr(colon + 1);
      if (std::find(REGIONS.begin(), REGIONS.end(), region) == REGIONS.end())
        error->all(FLERR, "{}: {}: unknown region {}; known: lateral polar apical junction basal",
                   asking, where, region);
    }
    const double value = DCMArgs::number(lmp, asking, "adhesion", words[3].c_str(), NONNEGATIVE);
    const auto pair = std::make_pair(words[1], words[2]);
    const auto given = energies.find(pair);
    if (given != energies.end()) contradiction(where, given->second, value);
    energies[pair] = value;
    energies[{words[2], words[1]}] = value;
  } else if (words.size() == 2 && !current.empty() &&
             std::find(KEYWORDS.begin(), KEYWORDS.end(), words[0]) != KEYWORDS.end()) {
    const double value = DCMArgs::number(lmp, asking, words[0], words[1].c_str(), ANY);
    const auto given = types[current].find(words[0]);
    if (given != types[current].end()) contradiction(where, given->second, value);
    types[current][words[0]] = value;
  } else {
    error->all(FLERR,
               "{}: {}: expected 'celltype NAME', 'KEYWORD VALUE' below a celltype, or "
               "'adhesion NAME[:REGION] NAME[:REGION] VALUE'; known keywords: {}",
               asking, where, utils::join_words(KEYWORDS, " "));
  }
}

/* ---------------------------------------------------------------------- */

double DCMParameters::get(int slot, const std::string &keyword, Range range) const
{
  const auto given = overrides.find(keyword);
  if (given != overrides.end())
    return DCMArgs::in_range(lmp, asking, keyword, given->second, range);
  const auto type = types.find(names[slot]);
  if (type == types.end() || type->second.count(keyword) == 0)
    error->all(FLERR, "{}: no value of {} for cell type {}; add it to {} or give the keyword",
               asking, keyword, names[slot],
               file.empty() ? std::string("a parameter file") : "parameter file " + file);
  return DCMArgs::in_range(lmp, asking, keyword + " of cell type " + names[slot],
                           type->second.at(keyword), range);
}

double DCMParameters::get(int slot, const std::string &keyword, Range range, double preset) const
{
  return has(slot, keyword) ? get(slot, keyword, range) : preset;
}

bool DCMParameters::has(int slot, const std::string &keyword) const
{
  const auto type = types.find(names[slot]);
  return overrides.count(keyword) > 0 || (type != types.end() && type->second.count(keyword) > 0);
}

const std::string &DCMParameters::region_name(int region)
{
  return REGIONS[region];
}

std::vector<int> DCMParameters::parse_regions(DCMArgs &args)
{
  std::vector<int> regions;
  do regions.push_back(args.choose({REGIONS.begin(), REGIONS.end()}));
  while (!args.keyword_ahead());
  return regions;
}

/* ----------------------------------------------------------------------
   the most specific entry counts: both regions named, one named, none named. Where one entry names
   the region of the one face and another that of the other, the lower value: it must not depend on
   which of the two faces comes first
------------------------------------------------------------------------- */

double DCMParameters::adhesion(int i, int ri, int j, int rj) const
{
  const auto given = overrides.find("W");
  if (given != overrides.end())
    return DCMArgs::in_range(lmp, asking, "W", given->second, NONNEGATIVE);
  const std::string a = names[i], b = names[j];
  const std::string ar = a + ":" + REGIONS[ri], br = b + ":" + REGIONS[rj];
  const auto none = energies.end(), both = energies.find({ar, br});
  if (both != none) return both->second;
  const auto first = energies.find({ar, b}), second = energies.find({a, br});
  if (first != none && second != none) return std::min(first->second, second->second);
  for (const auto &found : {first, second, energies.find({a, b})})
    if (found != none) return found->second;
  error->all(FLERR,
             "{}: no adhesion between cell types {} and {}; add 'adhesion {} {} W' to {} or "
             "give keyword W",
             asking, a, b, a, b,
             file.empty() ? std::string("a parameter file") : "parameter file " + file);
  return 0.0;
}
