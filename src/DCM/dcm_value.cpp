/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_value.h"

#include "atom.h"
#include "error.h"
#include "input.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void DCMValue::parse(DCMArgs &args, const std::string &called)
{
  what = called.empty() ? args.keyword() : called;
  if (args.ahead() && strncmp(args.ahead(), "v_", 2) == 0) {
    name = args.text() + 2;
    args.check(!name.empty(), "a number, or v_NAME of an equal-style or atom-style variable");
  } else {
    name.clear();
    style = NUMBER;
    now = args.number(DCMArgs::ANY, what);
  }
}

void DCMValue::find(LAMMPS *lmp, const std::string &asking)
{
  if (name.empty()) return;
  Variable *const variable = lmp->input->variable;
  const int ivar = variable->find(name.c_str());
  const bool equal = ivar >= 0 && variable->equalstyle(ivar);
  if (ivar < 0 || !(equal || variable->atomstyle(ivar)))
    lmp->error->all(FLERR, "{}: {}: there is no equal-style or atom-style variable {}", asking,
                    what, name);
  style = equal ? EQUAL : ATOM;
}

/* ---------------------------------------------------------------------- */

void DCMValue::evaluate(LAMMPS *lmp, const std::string &asking,
                        const std::vector<DCMValue *> &values, int igroup)
{
  if (std::none_of(values.begin(), values.end(), [](const DCMValue *v) {
        return v->varies();
      }))
    return;
  lmp->modify->clearstep_compute();
  for (DCMValue *const value : values)
    if (value->varies()) value->compute(lmp, asking, igroup);
  lmp->modify->addstep_compute(lmp->update->ntimestep + 1);
}

void DCMValue::compute(LAMMPS *lmp, const std::string &asking, int igroup)
{
  Variable *const variable = lmp->input->variable;
  const int ivar = variable->find(name.c_str());
  const bigint step = lmp->update->ntimestep;
  if (style == EQUAL) {
    now = variable->compute_equal(ivar);
    if (!std::isfinite(now))
      lmp->error->all(FLERR, "{}: variable {} gives the {} {} at step {}; it must be a number",
                      asking, name, what, now, step);
    return;
  }
  atoms.resize(std::max(1, lmp->atom->nmax));
  variable->compute_atom(ivar, igroup, atoms.data(), 1, 0);
}

void DCMValue::complain(LAMMPS *lmp, const std::string &asking, int i) const
{
  lmp->error->one(FLERR,
                  "{}: variable {} gives the {} {} for atom {} at step {}; it must be a number",
                  asking, name, what, atoms[i], lmp->atom->tag[i], lmp->update->ntimestep);
}
