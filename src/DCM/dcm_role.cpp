/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "dcm_role.h"

#include "bond_hybrid.h"
#include "dihedral_hybrid.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "pair_hybrid.h"

#include <algorithm>

using namespace LAMMPS_NS;

// the sub-styles of a hybrid pair style are for its own use

namespace {
struct HybridStyles : PairHybrid {
  static int count(PairHybrid *pair) { return pair->*(&HybridStyles::nstyles); }
  static Pair *style(PairHybrid *pair, int n) { return (pair->*(&HybridStyles::styles))[n]; }
};
}    // namespace

template <class Style> static void add(Style *style, std::vector<DCMRole *> &roles)
{
  if (auto *const role = dynamic_cast<DCMRole *>(style)) roles.push_back(role);
}

std::vector<DCMRole *> DCMRole::of(LAMMPS *lmp)
{
  std::vector<DCMRole *> roles;
  const Force *const force = lmp->force;
  add(force->bond, roles);
  if (auto *const hybrid = dynamic_cast<BondHybrid *>(force->bond))
    for (int n = 0; n < hybrid->nstyles; n++) add(hybrid->styles[n], roles);
  add(force->dihedral, roles);
  if (auto *const hybrid = dynamic_cast<DihedralHybrid *>(force->dihedral))
    for (int n = 0; n < hybrid->nstyles; n++) add(hybrid->styles[n], roles);
  add(force->pair, roles);
  if (auto *const hybrid = dynamic_cast<PairHybrid *>(force->pair))
    for (int n = 0; n < HybridStyles::count(hybrid); n++)
      add(HybridStyles::style(hybrid, n), roles);
  for (auto *const fix : std::vector<Fix *>(lmp->modify->get_fix_list())) add(fix, roles);
  return roles;
}

unsigned DCMRole::traits_of(LAMMPS *lmp)
{
  unsigned traits = 0U;
  for (const auto *const role : of(lmp)) traits |= role->traits();
  return traits;
}

int DCMRole::look_every(LAMMPS *lmp, int given, int usual)
{
  if (given) return given;
  return (traits_of(lmp) & CHOOSES_STEP) ? 1 : usual;
}

DCMRole *DCMRole::marker_of(LAMMPS *lmp)
{
  for (auto *const role : of(lmp))
    if (role->marked_faces()) return role;
  return nullptr;
}

/* ----------------------------------------------------------------------
   LAMMPS calls fixes in the order of the deck. Its list of them is made anew by each call of
   get_fix_list(), so that loops whose body may ask for it again, here as elsewhere, go over a copy
------------------------------------------------------------------------- */

static int place_of(Modify *modify, const Fix *fix)
{
  const auto &list = modify->get_fix_list();
  return (int) (std::find(list.begin(), list.end(), fix) - list.begin());
}

void DCMRole::check_before_motion(LAMMPS *lmp, const Fix *me, const std::string &asking)
{
  for (auto *const fix : std::vector<Fix *>(lmp->modify->get_fix_list())) {
    const auto *const role = dynamic_cast<DCMRole *>(fix);
    if (!role || !(role->traits() & MOVES)) continue;
    if (place_of(lmp->modify, me) > place_of(lmp->modify, fix))
      lmp->error->all(
          FLERR,
          "{}: fix {} stands after fix {} (dcm/motion), which moves the cells before it "
          "has decided; define it before fix {}",
          asking, me->id, fix->id, fix->id);
  }
}

void DCMRole::check_after(LAMMPS *lmp, const Fix *me, const std::string &asking,
                          const std::string &style)
{
  for (auto *const fix : lmp->modify->get_fix_by_style("^" + style + "$"))
    if (place_of(lmp->modify, me) < place_of(lmp->modify, fix))
      lmp->error->all(FLERR,
                      "{}: fix {} stands before fix {} ({}), whose decisions of the step it uses; "
                      "define it after fix {}",
                      asking, me->id, fix->id, style, fix->id);
}
