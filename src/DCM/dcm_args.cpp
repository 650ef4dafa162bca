/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_args.h"

#include "domain.h"
#include "error.h"
#include "group.h"
#include "input.h"
#include "region.h"
#include "utils.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace LAMMPS_NS;

DCMArgs::DCMArgs(LAMMPS *lmp, const std::string &_asking, int _narg, char **_arg,
                 const std::vector<std::string> &_keywords) :
    Pointers(lmp),
    asking(_asking), narg(_narg), iarg(0), ikey(-1), arg(_arg), keywords(_keywords)
{
}

void DCMArgs::add_keywords(const std::vector<std::string> &more)
{
  keywords.insert(keywords.begin(), more.begin(), more.end());
}

void DCMArgs::may_repeat(const std::vector<std::string> &these)
{
  repeatable.insert(repeatable.end(), these.begin(), these.end());
}

std::string DCMArgs::known() const
{
  return utils::join_words(keywords, " ");
}

bool DCMArgs::keyword_ahead(int n) const
{
  return n >= left() ||
         std::find(keywords.begin(), keywords.end(), arg[iarg + n]) != keywords.end();
}

bool DCMArgs::next()
{
  if (iarg >= narg) return false;
  key = arg[iarg];
  if (!keyword_ahead())
    error->all(FLERR, "{}: unknown keyword {}; known: {}", asking, key, known());
  const auto among = [this](const std::vector<std::string> &list) {
    return std::find(list.begin(), list.end(), key) != list.end();
  };
  if (among(given) && !among(repeatable))
    error->all(FLERR, "{}: keyword {} is there twice; keep the one that is meant", asking, key);
  given.push_back(key);
  ikey = iarg++;
  return true;
}

/* ---------------------------------------------------------------------- */

void DCMArgs::need(int n) const
{
  if (left() < n)
    error->all(FLERR, "{}: keyword {} needs {} values, got {}", asking, key, n, left());
}

const char *DCMArgs::text()
{
  if (left() < 1) {
    std::string so_far = key;
    for (int n = ikey + 1; n < iarg; n++) so_far += std::string(" ") + arg[n];
    error->all(FLERR, "{}: keyword {} needs a value", asking, so_far);
  }
  return arg[iarg++];
}

bool DCMArgs::word(const char *which)
{
  if (left() < 1 || std::string(which) != arg[iarg]) return false;
  iarg++;
  return true;
}

double DCMArgs::number(Range range, const std::string &what)
{
  return number(lmp, asking, what.empty() ? key : what, text(), range);
}

bigint DCMArgs::whole(bigint least, bigint most)
{
  const double value = number();
  const bool usual = least == 1 && most == MAXSMALLINT;
  check(value == std::floor(value) && value >= (double) least && value <= (double) most,
        usual ? fmt::format("a positive whole number of at most {}", most)
              : fmt::format("a whole number of {} to {}", least, most));
  return (bigint) value;
}

int DCMArgs::type(int ntypes)
{
  const double value = number();
  check(value == std::floor(value) && value >= 1.0 && value <= (double) ntypes,
        fmt::format("a type of 1 to {}; reserve more in create_box", ntypes));
  return (int) value;
}

int DCMArgs::choose(const std::vector<std::string> &names, const std::string &shown)
{
  const std::string value = text();
  const auto found = std::find(names.begin(), names.end(), value);
  if (found == names.end()) {
    std::string list = names[0];
    for (size_t n = 1; n < names.size(); n++)
      list += (n + 1 < names.size() ? ", " : " or ") + names[n];
    error->all(FLERR, "{}: {} must be {}, not {}", asking, key, shown.empty() ? list : shown,
               value);
  }
  return (int) (found - names.begin());
}

int DCMArgs::axis()
{
  return choose({"x", "y", "z"});
}

std::string DCMArgs::variable()
{
  const std::string value = text();
  if (value.compare(0, 2, "v_") != 0 || value.size() == 2)
    error->all(FLERR, "{}: {} is {}, expected an atom-style variable v_NAME", asking, key, value);
  return value.substr(2);
}

void DCMArgs::check(bool ok, const std::string &must) const
{
  if (!ok) error->all(FLERR, "{}: {} is {}, must be {}", asking, key, arg[iarg - 1], must);
}

/* ----------------------------------------------------------------------
   not utils::numeric(), whose error about a number like 1e999 names neither style nor keyword
------------------------------------------------------------------------- */

double DCMArgs::number(LAMMPS *lmp, const std::string &asking, const std::string &what,
                       const char *text, Range range)
{
  if (!utils::is_double(text))
    lmp->error->all(FLERR, "{}: {} is '{}', expected a number", asking, what, text);
  return in_range(lmp, asking, what, std::strtod(text, nullptr), range);
}

double DCMArgs::in_range(LAMMPS *lmp, const std::string &asking, const std::string &what,
                         double value, Range range)
{
  const bool ok = std::isfinite(value) && (range == ANY || (range == POSITIVE && value > 0.0) ||
                                           (range == NONNEGATIVE && value >= 0.0));
  if (!ok)
    lmp->error->all(FLERR, "{}: {} is {}, must be {}", asking, what, value,
                    range == POSITIVE ? "a positive number"
                                      : (range == NONNEGATIVE ? "zero or positive" : "finite"));
  return value;
}

/* ---------------------------------------------------------------------- */

int LAMMPS_NS::dcm_find_group(LAMMPS *lmp, const std::string &asking, const std::string &id)
{
  const int found = lmp->group->find(id);
  if (found < 0) lmp->error->all(FLERR, "{}: there is no group {}", asking, id);
  return lmp->group->bitmask[found];
}

Region *LAMMPS_NS::dcm_find_region(LAMMPS *lmp, const std::string &asking, const std::string &id)
{
  Region *const found = lmp->domain->get_region_by_id(id);
  if (!found) lmp->error->all(FLERR, "{}: there is no region {}", asking, id);
  found->init();
  return found;
}

void LAMMPS_NS::dcm_find_variable(LAMMPS *lmp, const std::string &asking, const std::string &name)
{
  const int ivar = lmp->input->variable->find(name.c_str());
  if (ivar < 0 || !lmp->input->variable->atomstyle(ivar))
    lmp->error->all(FLERR, "{}: there is no atom-style variable {}", asking, name);
}

void LAMMPS_NS::dcm_check_point(LAMMPS *lmp, const std::string &asking, const std::string &what,
                                const double *x)
{
  const auto *const domain = lmp->domain;
  for (int k = 0; k < 3; k++)
    if (domain->periodicity[k] &&
        (x[k] < domain->boxlo[k] - domain->prd[k] || x[k] > domain->boxhi[k] + domain->prd[k]))
      lmp->error->all(FLERR,
                      "{}: {} {} {} {} lies outside the periodic box, which reaches from {:.4g} to "
                      "{:.4g} in {}; give a point in the box",
                      asking, what, x[0], x[1], x[2], domain->boxlo[k], domain->boxhi[k], "xyz"[k]);
}
