/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_osmosis.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "group.h"
#include "input.h"
#include "memory.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <cstring>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/osmosis";
static constexpr int RECORD = 3;    // version of the restart record
// s, the longest step while a lumen is fed: it opens by what contact lets go of in the step
// before, so that long steps make it slow [ours]

static constexpr double LONGEST = 10.0;
static constexpr double FOREVER = std::numeric_limits<double>::infinity();

/* ----------------------------------------------------------------------
   fix ID group dcm/osmosis [pressure P|v_name [dilute V]] [solute rate R kT E [loss T] [least V]]
       marks flood|tracer [secrete GROUP] [free theta] [range r] [weight free|full] [memory yes|no]
       [slab x|y|z lo hi] [starter x y z r T | apical T] [ramp T] [every N]
       [longest T]
------------------------------------------------------------------------- */

FixDCMOsmosis::FixDCMOsmosis(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), pressure(0.0), dilute(0.0), rate(0.0), kT(0.0), loss(FOREVER), least(1.0),
    solute(false), tracers(false), memory_kept(false), weigh_free(true), theta(0.05), range(0.0),
    secrete_bit(groupbit), axis(-1), lo(0.0), hi(0.0), ramp(0.0),
    starter(NO_STARTER), point{0.0, 0.0, 0.0}, radius(0.0), starting(0.0), now(), cell(nullptr),
    contact(nullptr), graph(lmp, STYLE), tracer(nullptr), mark(nullptr), whole(nullptr),
    acting(0.0), worked(0.0), falls(0.0), measured(false), wall(0.0), net(0.0)
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  every = 0;
  longest = LONGEST;

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3,
               {"pressure", "dilute", "solute", "marks", "secrete", "free", "range", "weight",
                "memory", "slab", "starter", "ramp", "every", "longest"});
  bool has_pressure = false, has_marks = false;
  while (args.next()) {
    if (args.is("pressure")) {
      has_pressure = true;
      pressure = 0.0;
      variable.clear();    // the last one given counts
      if (args.ahead() && strncmp(args.ahead(), "v_", 2) == 0) {
        variable = args.text() + 2;
        args.check(!variable.empty(), "a number, or v_NAME of an equal-style variable");
      } else {
        pressure = args.number();
      }
    } else if (args.is("dilute")) {
      dilute = args.number(DCMArgs::POSITIVE);
    } else if (args.is("solute")) {
      solute = true;
      args.need(4);
      if (!args.word("rate")) error->all(FLERR, "{}: solute needs 'rate R kT E'", STYLE);
      rate = args.number(DCMArgs::NONNEGATIVE, "solute rate");
      if (!args.word("kT")) error->all(FLERR, "{}: solute needs 'rate R kT E'", STYLE);
      kT = args.number(DCMArgs::POSITIVE, "solute kT");
      if (args.word("loss")) loss = args.number(DCMArgs::POSITIVE, "solute loss");
      if (args.word("least")) least = args.number(DCMArgs::POSITIVE, "solute least");
    } else if (args.is("marks")) {
      has_marks = true;
      tracers = args.choose({"flood", "tracer"}) == 1;
    } else if (args.is("secrete")) {
      secretes = args.text();
    } else if (args.is("free")) {
      theta = args.number(DCMArgs::POSITIVE);
      args.check(theta <= dcm::MARK_FALLS, "above 0 and at most 0.5, where marks fall");
    } else if (args.is("range")) {
      range = args.number(DCMArgs::POSITIVE);
    } else if (args.is("weight")) {
      weigh_free = args.choose({"free", "full"}) == 0;
    } else if (args.is("memory")) {
      memory_kept = args.choose({"no", "yes"}) == 1;
    } else if (args.is("slab")) {
      args.need(3);
      axis = args.axis();
      lo = args.number(DCMArgs::ANY, "slab lo");
      hi = args.number(DCMArgs::ANY, "slab hi");
      if (!(lo < hi))
        error->all(FLERR, "{}: slab from {} to {} is empty; give the lower bound first", STYLE, lo,
                   hi);
    } else if (args.is("starter")) {
      parse_starter(args);
    } else if (args.is("ramp")) {
      ramp = args.number(DCMArgs::NONNEGATIVE);
    } else if (args.is("longest")) {
      longest = args.number(DCMArgs::POSITIVE);
    } else {
      every = (int) args.whole();
    }
  }
  if (!has_pressure && !solute)
    error->all(FLERR, "{}: give 'pressure P', 'solute rate R kT E' or both", STYLE);
  if (!has_marks) error->all(FLERR, "{}: add 'marks flood' or 'marks tracer'", STYLE);
  if (dilute > 0.0 && !has_pressure)
    error->all(FLERR, "{}: keyword dilute needs keyword pressure", STYLE);
  if (pressure < 0.0 && comm->me == 0)
    error->warning(FLERR, "{}: pressure is {}, which sucks lumens shut", STYLE, pressure);

  now.begun = now.counted = -1.0;
  now.due = 1;
  scalar_flag = vector_flag = 1;
  size_vector = 9;
  extscalar = extvector = 0;
  global_freq = 1;
  virial_global_flag = virial_peratom_flag = 1;
  thermo_virial = 1;
  comm_forward = 1;
  comm_reverse = 3;
  restart_global = restart_peratom = 1;
  create_attribute = 1;
  maxexchange = 1;
  FixDCMOsmosis::grow_arrays(std::max(1, atom->nmax));    // there is always an array
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) FixDCMOsmosis::set_arrays(i);
}

FixDCMOsmosis::~FixDCMOsmosis()
{
  if (copymode) return;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(mark);
  memory->destroy(whole);
}

void FixDCMOsmosis::parse_starter(DCMArgs &args)
{
  if (args.word("apical")) {
    starter = APICAL;
  } else {
    args.need(5);
    starter = AT_POINT;
    for (double &x : point) x = args.number(DCMArgs::ANY, "starter point");
    radius = args.number(DCMArgs::POSITIVE, "starter radius");
  }
  starting = args.number(DCMArgs::POSITIVE, "starter time");
}

/* ---------------------------------------------------------------------- */

int FixDCMOsmosis::setmask()
{
  return INITIAL_INTEGRATE | PRE_REVERSE;
}

void FixDCMOsmosis::init()
{
  nevery = look_every(lmp, every, 10);
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  graph.init();
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  auto &table = cell->change_cells();
  marked_area = table.add(STYLE, "marked_area", DCMColumn::RESET, 0.0, {}, marked_area);
  joined = table.add(STYLE, "secretes_since", DCMColumn::INHERIT, -1.0, {}, joined);
  secrete_bit = secretes.empty() ? groupbit
                                 : dcm_find_group(lmp, std::string(STYLE) + ": secrete", secretes);
  if (!variable.empty()) {
    const int ivar = input->variable->find(variable.c_str());
    if (ivar < 0 || !input->variable->equalstyle(ivar))
      error->all(FLERR, "{}: there is no equal-style variable {}", STYLE, variable);
  }

  tracer = nullptr;
  makers.clear();
  for (auto *const fix : std::vector<Fix *>(modify->get_fix_list())) {
    auto *const role = dynamic_cast<DCMRole *>(fix);
    if (role && (role->traits() & HAS_TRACERS)) tracer = role;
    if (role && (role->traits() & MAKES_CELLS)) makers.push_back(fix);
  }
  if (tracers && !tracer)
    error->all(FLERR,
               "{}: marks tracer needs tracers; add a fix dcm/tracer before it, or use marks flood",
               STYLE);
  check_before_motion(lmp, this, STYLE);
  for (const char *const style :
       {"dcm/growth", "dcm/division", "dcm/death", "dcm/convert", "dcm/polarity", "dcm/tracer"})
    check_after(lmp, this, STYLE, style);
}

/* ----------------------------------------------------------------------
   errors before the first step. Later cells may die or change
------------------------------------------------------------------------- */

void FixDCMOsmosis::check_start()
{
  graph.check_cutoff(range);
  if (now.started) return;
  const auto &table = cell->cells();
  bool any = false, source = starter == AT_POINT;
  for (const int row : table.all_deformable()) {
    any = any || acts_on(row);
    source = source || (starter == AT_POINT ? acts_on(row) : secreting(row));
  }
  if (!any)
    error->all(FLERR, "{}: no deformable cell has its center in group {}", STYLE,
               group->names[igroup]);
  check_places();
  if (tracers) return;
  if (!source)
    error->all(FLERR, "{}: no deformable cell secretes; none has its center in group {}", STYLE,
               secretes.empty() ? group->names[igroup] : secretes.c_str());
  int field, apical = starter == AT_POINT || table.column("ax", field) != nullptr;
  for (int f = 0; f < cell->nowned(); f++)
    if (dcm->region[cell->faces()[f].atom] == AtomVecDCM::APICAL) apical = 1;
  MPI_Allreduce(MPI_IN_PLACE, &apical, 1, MPI_INT, MPI_MAX, world);
  if (!apical)
    error->all(FLERR,
               "{}: marks flood begins at apical faces, and no face is apical; add a fix "
               "dcm/polarity before it",
               STYLE);
}

/* ----------------------------------------------------------------------
   slab and starter hold faces of cells that may be marked
------------------------------------------------------------------------- */

void FixDCMOsmosis::check_places()
{
  if (starter == AT_POINT) dcm_check_point(lmp, STYLE, "starter", point);
  int any[2] = {axis < 0, starter != AT_POINT};
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    const double *const x = atom->x[face.atom];
    if (!acts_on(face.cell) || !in_slab(x)) continue;
    any[0] = 1;
    if (near_starter(x)) any[1] = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, any, 2, MPI_INT, MPI_MAX, world);
  if (!any[0])
    error->all(FLERR,
               "{}: no face of group {} lies in slab {} {} {}, so that none would ever be marked; "
               "move the slab to the cells",
               STYLE, group->names[igroup], "xyz"[axis], lo, hi);
  if (!any[1] && comm->me == 0)
    error->warning(
        FLERR,
        "{}: no face of group {} lies within {:.6g} of the starter's point {:.6g} {:.6g} "
        "{:.6g} at step {}; without one in its time nothing is started",
        STYLE, group->names[igroup], radius, point[0], point[1], point[2], update->ntimestep);
}

/* ----------------------------------------------------------------------
   marks are looked for in the first setup of all, never in that of a run that goes on
------------------------------------------------------------------------- */

void FixDCMOsmosis::setup_pre_reverse(int eflag, int vflag)
{
  check_start();
  if (!now.started) {
    look();
    now.started = now.due = 1;
  }
  const double before = worked;
  pre_reverse(eflag, vflag);
  worked = before;    // nothing has moved
}

/* ----------------------------------------------------------------------
   half of the work of the coming step, by the marks and forces it begins with
------------------------------------------------------------------------- */

void FixDCMOsmosis::initial_integrate(int /*vflag*/)
{
  now.clock += update->dt;
  worked += 0.5 * update->dt * power();
  if (now.due || update->ntimestep % nevery == 0) look();
  for (const auto *const fix : makers)
    if (fix->force_reneighbor && fix->next_reneighbor == update->ntimestep) {
      take_snapshot();
      break;
    }
}

/* ----------------------------------------------------------------------
   the end of a starter around a point; a tenth of the ramp while it lasts
------------------------------------------------------------------------- */

double FixDCMOsmosis::next_event()
{
  if (starter == AT_POINT && now.clock < starting) return starting - now.clock;
  return DCMRole::next_event();
}

double FixDCMOsmosis::longest_step()
{
  if (ramp > 0.0 && now.begun >= 0.0 && now.clock - now.begun < ramp)
    return std::min(longest, 0.1 * ramp);
  return now.nfaces > 0 && acting != 0.0 ? longest : DCMRole::longest_step();
}

/* ---------------------------------------------------------------------- */

void FixDCMOsmosis::write_restart(FILE *fp)
{
  // the work of each process, not their sum: this run and one that continues from the file add up
  // the same numbers in the same order, as if nothing had been written
  std::vector<double> each(comm->nprocs);
  MPI_Gather(&worked, 1, MPI_DOUBLE, each.data(), 1, MPI_DOUBLE, 0, world);
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(now);
  record.put(each);
  record.write(fp);
}

void FixDCMOsmosis::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(now);
  std::vector<double> each;
  record.get(each);
  if ((int) each.size() == comm->nprocs) {
    worked = each[comm->me];
  } else {
    now.work += std::accumulate(each.begin(), each.end(), 0.0);
    worked = 0.0;
  }
}

/* ----------------------------------------------------------------------
   work that the pressure has done
------------------------------------------------------------------------- */

double FixDCMOsmosis::compute_scalar()
{
  double all;
  MPI_Allreduce(&worked, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return now.work + all;
}

/* ----------------------------------------------------------------------
   marked area, faces, cells; volume, pressure, net force, closure; area of lost marks, solute
------------------------------------------------------------------------- */

double FixDCMOsmosis::compute_vector(int n)
{
  if (!now.started) return 0.0;
  FixDCMCell::check_current(lmp, STYLE, cell);
  FixDCMCell::check_current(lmp, STYLE, contact);
  if (!measured) cell->check_atoms(STYLE);
  measure();
  const double values[] = {wall,      (double) now.nfaces,     (double) now.ncells, sums.volume,
                           acting,    std::fabs(acting) * net, sums.closure(),      now.lost,
                           now.amount};
  return values[n];
}

/* ---------------------------------------------------------------------- */

double FixDCMOsmosis::memory_usage()
{
  return 2.0 * atom->nmax * sizeof(int) + (double) state.capacity() * sizeof(int) +
         (double) pushed.capacity() * sizeof(double) + graph.memory_usage();
}
