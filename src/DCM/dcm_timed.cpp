/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "dcm_timed.h"

#include "dcm_role.h"
#include "bond.h"
#include "comm.h"
#include "compute.h"
#include "dihedral.h"
#include "fix.h"
#include "fmt/format.h"
#include "force.h"
#include "modify.h"
#include "pair.h"
#include "timer.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <vector>

using namespace LAMMPS_NS;

namespace {

struct Row {
  std::string name;    // as in the deck
  DCMWatch *watch;
  DCMRole *role;    // nullptr: none
};

// the styles of the deck that have a watch, fixes last: one of them prints the table; all
// processes have the same

std::vector<Row> rows_of(LAMMPS *lmp)
{
  std::vector<Row> rows;
  const Force *const force = lmp->force;
  for (auto *const role : DCMRole::of(lmp)) {
    auto *const watch = dynamic_cast<DCMWatch *>(role);
    if (!watch || dynamic_cast<Fix *>(role)) continue;
    std::string name;
    if (dynamic_cast<Bond *>(role)) name = std::string("bond_style ") + force->bond_style;
    if (dynamic_cast<Dihedral *>(role))
      name = std::string("dihedral_style ") + force->dihedral_style;
    if (dynamic_cast<Pair *>(role)) name = std::string("pair_style ") + force->pair_style;
    rows.push_back({name, watch, role});
  }
  for (auto *const compute : std::vector<Compute *>(lmp->modify->get_compute_list()))
    if (auto *const watch = dynamic_cast<DCMWatch *>(compute))
      rows.push_back({fmt::format("compute {} {}", compute->id, compute->style), watch, nullptr});
  for (auto *const fix : std::vector<Fix *>(lmp->modify->get_fix_list()))
    if (auto *const watch = dynamic_cast<DCMWatch *>(fix))
      rows.push_back(
          {fmt::format("fix {} {}", fix->id, fix->style), watch, dynamic_cast<DCMRole *>(fix)});
  return rows;
}

}    // namespace

/* ---------------------------------------------------------------------- */

bool DCMWatch::in_run(LAMMPS *lmp)
{
  return lmp->update->setupflag == 0;
}

/* ---------------------------------------------------------------------- */

void DCMWatch::begin(LAMMPS *lmp, const DCMWatch *asking)
{
  const auto rows = rows_of(lmp);
  if (rows.back().watch != asking) return;
  for (const auto &row : rows) row.watch->seconds = 0.0;
}

/* ---------------------------------------------------------------------- */

void DCMWatch::look(LAMMPS *lmp, DCMWatch *asking)
{
  const auto rows = rows_of(lmp);
  const bigint steps = lmp->update->ntimestep - lmp->update->firststep;
  if (rows.back().watch != asking || steps <= 0) return;

  std::vector<double> mine, sum, most;
  size_t width = 0;
  for (const auto &row : rows) {
    mine.push_back(row.watch->seconds);
    width = std::max(width, row.name.size());
  }
  mine.push_back(lmp->timer->get_wall(Timer::TOTAL));
  sum.resize(mine.size());
  most.resize(mine.size());
  MPI_Allreduce(mine.data(), sum.data(), (int) mine.size(), MPI_DOUBLE, MPI_SUM, lmp->world);
  MPI_Allreduce(mine.data(), most.data(), (int) mine.size(), MPI_DOUBLE, MPI_MAX, lmp->world);

  const double total = sum.back();
  const auto percent = [total](double part) {
    return total > 0.0 ? 100.0 * part / total : 0.0;
  };
  std::string text = "Time of the DCM styles, s: mean of all processes, most of any\n";
  double rest = total;
  for (size_t n = 0; n < rows.size(); n++) {
    const std::string work = rows[n].role ? rows[n].role->work() : "";
    text += fmt::format("  {:{}} {:10.4g} {:10.4g} {:5.1f} %{}{}\n", rows[n].name, width,
                        sum[n] / lmp->comm->nprocs, most[n], percent(sum[n]),
                        work.empty() ? "" : "  ", work);
    rest -= sum[n];
  }
  text += fmt::format("  {:{}} {:10.4g} {:10} {:5.1f} %\n", "LAMMPS and others", width,
                      std::max(0.0, rest) / lmp->comm->nprocs, "", percent(std::max(0.0, rest)));
  std::string notes;
  for (const auto &row : rows) {
    if (!row.role) continue;
    for (const auto &note : row.role->report()) {
      notes += "  " + note.text + "\n";
      if (!note.advice.empty()) notes += "    advice: " + note.advice + "\n";
    }
  }
  if (!notes.empty()) text += "Of this run\n" + notes;
  if (lmp->comm->me == 0) asking->table = text;
}

/* ---------------------------------------------------------------------- */

void DCMWatch::tell(LAMMPS *lmp)
{
  if (!table.empty()) utils::logmesg(lmp, table);
  table.clear();
}
