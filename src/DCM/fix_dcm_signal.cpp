/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_signal.h"

#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/signal";
static constexpr int RECORD = 2;    // version of the restart record

// the time is over when nothing but round-off is missing

static constexpr double DONE = 1.0 - 1.0e-9;

/* ----------------------------------------------------------------------
   fix ID group dcm/signal from GROUP to Tcenter Tnode Tface [Tbond Tdihedral] time T|inf
       [area A_min] [lumen yes|no] [lapse reset|hold] [join GROUP] [leave GROUP] [every N]
------------------------------------------------------------------------- */

FixDCMSignal::FixDCMSignal(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), from(0), to(lmp, STYLE), least_area(0.2), signal_time(-1.0), lumen(true),
    hold(false), cell(nullptr), contact(nullptr), since(-1.0), switched(0)
{
  AtomVecDCM::require(lmp, STYLE);
  nevery = 1;
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"from", "area", "time", "lumen", "lapse", "every"});
  args.add_keywords(DCMRetype::KEYWORDS);
  args.may_repeat(DCMRetype::REPEATABLE);
  while (args.next()) {
    if (to.parse(args)) continue;
    if (args.is("from")) {
      from_id = args.text();
    } else if (args.is("area")) {
      least_area = args.number(DCMArgs::NONNEGATIVE);
      args.check(least_area <= 1.0, "a part of the cell's area, 0 to 1");
    } else if (args.is("time")) {
      signal_time = args.word("inf") ? std::numeric_limits<double>::infinity()
                                     : args.number(DCMArgs::NONNEGATIVE);
    } else if (args.is("lumen")) {
      lumen = args.choose({"no", "yes"}) == 1;
    } else if (args.is("lapse")) {
      hold = args.choose({"reset", "hold"}) == 1;
    } else {
      nevery = (int) args.whole();
    }
  }
  if (from_id.empty())
    error->all(FLERR, "{}: keyword from is missing; name the group of cells that signal", STYLE);
  if (signal_time < 0.0)
    error->all(FLERR, "{}: keyword time is missing; give the time of contact, 0 or inf for never",
               STYLE);
  to.join_group(from_id);

  vector_flag = 1;
  size_vector = 4;
  extvector = 0;
  global_freq = 1;
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

int FixDCMSignal::setmask()
{
  return INITIAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixDCMSignal::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  spheres = cell->request_spheres();    // that may signal as well
  auto &table = cell->change_cells();
  signal = table.add(STYLE, "signal", DCMColumn::RESET, 0.0, {}, signal);
  fate = table.add(STYLE, "fate", DCMColumn::RESET, 0.0, {}, fate);
  cell->refresh();
  table.require_ids(STYLE);

  from = dcm_find_group(lmp, STYLE, from_id);
  to.init();
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (!contact)
    error->all(FLERR, "{}: nothing measures contact between cells; it needs pair_style dcm/contact",
               STYLE);
  partners = contact->request_partners(nevery);
  if (!contact->has_cell_type(to.types().face))
    error->all(FLERR,
               "{}: the new faces' atom type {} has no cell type in pair_coeff, so that they would "
               "touch nothing; give it one in place of NULL",
               STYLE, to.types().face);

  check_before_motion(lmp, this, STYLE);
  check_after(lmp, this, STYLE, "dcm/growth");
  check_after(lmp, this, STYLE, "dcm/osmosis");
  if (!warned && modify->get_fix_by_style("^dcm/division$").empty()) {
    warned = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "{}: cells change their type when they divide, and there is no fix "
                     "dcm/division: all keep theirs",
                     STYLE);
  }
}

/* ----------------------------------------------------------------------
   other styles add their columns in init(), also after this one
------------------------------------------------------------------------- */

void FixDCMSignal::setup(int /*vflag*/)
{
  if (!lumen) return;
  int field;
  if (!cell->cells().column("marked_area", field))
    error->all(FLERR,
               "{}: nothing marks the faces at a lumen, so that no cell would ever switch; add a "
               "fix dcm/osmosis, or use 'lumen no'",
               STYLE);
}

/* ----------------------------------------------------------------------
   by the contacts and areas of the end of the last step, and the phases of this one
------------------------------------------------------------------------- */

void FixDCMSignal::initial_integrate(int /*vflag*/)
{
  if (since >= 0.0) since += update->dt;
  if ((update->ntimestep - 1) % nevery == 0) {
    const bool heard = anyone_signals();
    measure_contacts(heard);
    count_time(heard);
  }
  const auto &table = cell->cells();
  for (const int row : table.all_deformable())
    if ((*fate)(row) > 0.0 && table[row].phase == DCMCellTable::READY) {
      to.look();    // before the mothers go
      return;
    }
}

bool FixDCMSignal::listens(const DCMCellTable::Cell &it) const
{
  return it.deformable && (it.mask & groupbit) && !(it.mask & from) &&
         it.phase != DCMCellTable::DYING;
}

/* ----------------------------------------------------------------------
   the same on all processes; where nobody does, no contact is asked for
------------------------------------------------------------------------- */

bool FixDCMSignal::anyone_signals() const
{
  const auto &all = cell->cells().all();
  return std::any_of(all.begin(), all.end(), [this](const DCMCellTable::Cell &it) {
    return (it.mask & from) != 0;
  });
}

void FixDCMSignal::measure_contacts(bool heard)
{
  const auto &table = cell->cells();
  contact_area.assign(table.size(), 0.0);
  if (!heard) return;
  for (const auto &pair : contact->partners()) {
    const int a = table.find(pair.molecule), b = table.find(pair.other);
    if (a < 0 || b < 0) continue;
    if (table[b].mask & from) contact_area[a] += pair.area;
    if (table[a].mask & from) contact_area[b] += pair.area;
  }
}

void FixDCMSignal::count_time(bool heard)
{
  const auto &table = cell->cells();
  const double passed = since < 0.0 ? nevery * update->dt : since;
  since = 0.0;
  int field = 0;
  const auto marked = table.column("marked_area", field);    // not kept: it is another's
  if (heard) cell->update_all();
  for (const int row : table.all_deformable()) {
    const auto &it = table[row];
    if (!listens(it) || (*fate)(row) > 0.0) continue;
    if (heard && contact_area[row] > least_area * it.area &&
        (!lumen || (marked && (*marked)(row, field) > 0.0))) {
      (*signal)(row) += passed;
      if ((*signal)(row) >= DONE * signal_time) (*fate)(row) = 1.0;
    } else if (!hold) {
      (*signal)(row) = 0.0;
    }
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMSignal::daughters_take(int row, DCMCellBuilder::Types &types,
                                  DCMCellBuilder::Masks &masks)
{
  if (!((*fate)(row) > 0.0)) return;
  to.apply(types, masks);
  switched++;
}

/* ---------------------------------------------------------------------- */

void FixDCMSignal::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(switched);
  record.put(since);
  record.write(fp);
}

void FixDCMSignal::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(switched);
  record.get(since);
}

/* ----------------------------------------------------------------------
   cells with time counted and no fate yet, cells with their fate decided, cells that have divided
   with it; longest time of those counted
------------------------------------------------------------------------- */

double FixDCMSignal::compute_vector(int n)
{
  if (n == 2) return (double) switched;
  double values[4] = {0.0, 0.0, 0.0, 0.0};
  if (!signal) return 0.0;
  FixDCMCell::check_current(lmp, STYLE, cell);
  for (const int row : cell->cells().all_deformable()) {
    const double time = (*signal)(row);
    if ((*fate)(row) > 0.0) {
      values[1] += 1.0;
    } else if (time > 0.0) {
      values[0] += 1.0;
      values[3] = std::max(values[3], time);
    }
  }
  return values[n];
}
