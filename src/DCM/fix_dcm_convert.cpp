/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_convert.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_compat.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "law/random.h"
#include "law/shape.h"
#include "law/volume.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "group.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/convert";
static constexpr int RECORD = 1;    // version of the restart record

/* ----------------------------------------------------------------------
   fix ID group dcm/convert dcm Tcenter Tnode Tface Tbond Tdihedral cbm Tsphere
       region IN OUT | near GROUP d1 d2 | variable v_name | lumen FIX d1 d2 |
       pressure P1 P2 | strain S1 S2
       [mesh icosphere level] [rest factor] [hold T] [every N] [seed S]
------------------------------------------------------------------------- */

FixDCMConvert::FixDCMConvert(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), level(2), rest(1.0), hold(0.0), nrules(0),
    seed(1), counts{0, 0}
{
  AtomVecDCM::require(lmp, STYLE);
  every = 0;
  parse(narg - 3, arg + 3);
  if (sphere.center == 0 || deformable.center == 0)
    error->all(FLERR,
               "{}: give the types of both forms: dcm Tcenter Tnode Tface Tbond Tdihedral "
               "cbm Tsphere",
               STYLE);
  if (nrules != 1)
    error->all(FLERR, "{}: give one rule of {}, not {}", STYLE,
               utils::join_words(DCMConvertRule::names(), ", "), nrules);
  top = DCMCellBuilder(lmp, STYLE, false).prepare(dcm::icosphere(level), true);

  vector_flag = 1;
  size_vector = 2;
  extvector = 0;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

/* ---------------------------------------------------------------------- */

void FixDCMConvert::parse(int narg, char **arg)
{
  DCMArgs args(lmp, STYLE, narg, arg, {"mesh", "rest", "hold", "every", "seed"});
  args.add_keywords(DCMConvertRule::names());
  args.add_keywords({"dcm", "cbm"});
  while (args.next()) {
    if (auto found = DCMConvertRule::read(lmp, args)) {
      rule = std::move(found);
      nrules++;
    } else if (args.is("dcm")) {
      args.need(5);
      deformable.center = args.type(atom->ntypes);
      deformable.node = args.type(atom->ntypes);
      deformable.face = args.type(atom->ntypes);
      deformable.bond = args.type(atom->nbondtypes);
      deformable.dihedral = args.type(atom->ndihedraltypes);
    } else if (args.is("cbm")) {
      sphere.center = args.type(atom->ntypes);
    } else if (args.is("mesh")) {
      args.choose({"icosphere"}, "icosphere LEVEL");
      level = (int) args.whole(1, 5);
    } else if (args.is("rest")) {
      rest = args.number(DCMArgs::POSITIVE);
    } else if (args.is("hold")) {
      hold = args.number(DCMArgs::NONNEGATIVE);
    } else if (args.is("every")) {
      every = (int) args.whole();
    } else {
      seed = args.whole();
    }
  }
}

/* ---------------------------------------------------------------------- */

int FixDCMConvert::setmask()
{
  return INITIAL_INTEGRATE | PRE_EXCHANGE;
}

/* ----------------------------------------------------------------------
   no list is laid out for spheres to come where the group has nobody, and gets nobody in a run
------------------------------------------------------------------------- */

unsigned FixDCMConvert::traits() const
{
  if (!group->dynamic[igroup] && group->count(igroup) == 0) return 0U;
  return MAKES_CELLS | GROWS_SPHERES;
}

void FixDCMConvert::init()
{
  nevery = look_every(lmp, every, 100);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
  if (!cell->expects_deformable())
    error->all(FLERR, "{} needs a fix dcm/cell; add 'fix cell all dcm/cell' to the deck", STYLE);
  spheres = cell->request_spheres();
  ratio = cell->change_cells().share(STYLE, "rest_ratio", DCMColumn::INHERIT, 1.0);
  if (hold > 0.0) until = cell->change_cells().share(STYLE, "form_until", DCMColumn::RESET);
  cell->refresh();
  cell->cells().require_ids(STYLE);
  rule->init(this, cell);
  DCMCellSurgery::require_laws(lmp, STYLE);
  DCMCellSurgery::check_order(lmp, this, STYLE);
  if (traits()) DCMCellBuilder(lmp, STYLE, false).reserve_slots(top.slots);
  next_reneighbor = -1;
}

/* ----------------------------------------------------------------------
   has the cell been converted less than `hold` ago? Times of steps are sums with round-off
------------------------------------------------------------------------- */

bool FixDCMConvert::held(int row) const
{
  if (hold == 0.0) return false;
  const double end = (*until)(row);
  return end - cell->cells().time() > 1.0e-9 * hold;
}

/* ----------------------------------------------------------------------
   is the group empty, on all processes?
------------------------------------------------------------------------- */

bool FixDCMConvert::nobody() const
{
  int any = 0;
  for (int i = 0; i < atom->nlocal; i++) any |= atom->mask[i] & groupbit;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_BOR, world);
  return any == 0;
}

/* ---------------------------------------------------------------------- */

void FixDCMConvert::initial_integrate(int /*vflag*/)
{
  changing.clear();
  if (update->ntimestep % nevery || nobody()) return;
  const auto &table = cell->cells();
  const auto cells = DCMCellTable::gather(lmp, true);
  rule->look(cells);
  for (size_t n = 0; n < cells.size(); n++) {
    const auto &it = cells[n];
    if (!(it.mask & groupbit)) continue;
    if (it.type != (it.deformable ? deformable.center : sphere.center)) continue;
    const int row = table.find(it.molecule);
    if (row < 0 || held(row)) continue;
    // who is about to divide does so as it is; its daughters can change
    const int phase = table[row].phase;
    if (phase == DCMCellTable::ROUNDING || phase == DCMCellTable::READY) continue;
    const dcm::Form other = it.deformable ? dcm::Form::SPHERE : dcm::Form::DEFORMABLE;
    if (rule->wants(cells, n) == other) changing.push_back({it.molecule, !it.deformable});
  }
  if (!changing.empty()) next_reneighbor = update->ntimestep;
}

/* ---------------------------------------------------------------------- */

void FixDCMConvert::pre_exchange()
{
  if (changing.empty() || next_reneighbor != update->ntimestep) return;
  const auto all = DCMCellTable::gather(lmp, true);

  // another fix may have divided, converted or taken away a cell in this very step; a sphere deep
  // inside a neighbor waits until it has room

  std::vector<tagint> molecules;
  for (const auto &it : changing) {
    const int row = cell->cells().find(it.molecule);
    if (row < 0 || cell->cells()[row].deformable == it.to_deformable) continue;
    if (!it.to_deformable || can_be_shaped(it.molecule, all)) molecules.push_back(it.molecule);
  }
  DCMCellSurgery surgery(lmp, STYLE);
  auto cells = surgery.gather(molecules);
  for (auto &it : cells)    // by the atoms there are, before any of them changes
    it.masks = surgery.masks_after(it.mesh.nodes.empty() ? deformable : sphere, it);
  surgery.begin();
  surgery.remove(molecules);
  for (const auto &it : cells) {
    if (it.mesh.nodes.empty())
      to_deformable(surgery, it, all);
    else
      to_sphere(surgery, it);
  }
  surgery.end();
  changing.clear();
}

void FixDCMConvert::to_sphere(DCMCellSurgery &surgery, const DCMCellSurgery::Cell &from)
{
  const double volume = dcm::volume(from.mesh);
  DCMCellBuilder::Sphere to;
  to.molecule = from.molecule;
  to.mask = from.masks.center;
  to.radius = dcm::ball_radius(volume);
  to.x = from.x;
  for (int k = 0; k < 3; k++) to.v[k] = from.v[k];
  surgery.insert(sphere, to);
  (*ratio)(cell->cells().find(from.molecule)) = from.volume0 / volume;
  changed(from.molecule, sphere.center, false, volume);
}

void FixDCMConvert::changed(tagint molecule, int type, bool to_deformable, double volume0)
{
  cell->change_cells().converted(molecule, type, to_deformable, volume0);
  if (hold > 0.0) (*until)(cell->cells().find(molecule)) = cell->cells().time() + hold;
  counts[to_deformable ? 0 : 1]++;
}

/* ----------------------------------------------------------------------
   all other cells as balls, at their images closest to x
------------------------------------------------------------------------- */

std::vector<dcm::Ball> FixDCMConvert::neighbors_of(tagint molecule, const Vec3 &x,
                                                   const Cells &all) const
{
  std::vector<dcm::Ball> neighbors;
  for (const auto &other : all) {
    if (other.molecule == molecule) continue;
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = other.x[k] - x[k];
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    neighbors.push_back({x + Vec3(d[0], d[1], d[2]), dcm::ball_radius(other.volume0)});
  }
  return neighbors;
}

bool FixDCMConvert::can_be_shaped(tagint molecule, const Cells &all) const
{
  for (const auto &it : all)
    if (it.molecule == molecule) {
      const Vec3 x(it.x[0], it.x[1], it.x[2]);
      return dcm::has_room({x, dcm::ball_radius(it.volume0)}, neighbors_of(molecule, x, all));
    }
  return false;
}

/* ----------------------------------------------------------------------
   the rest volume is that for the pressure the cell had when it was last deformable
------------------------------------------------------------------------- */

void FixDCMConvert::to_deformable(DCMCellSurgery &surgery, const DCMCellSurgery::Cell &from,
                                  const Cells &all)
{
  const auto neighbors = neighbors_of(from.molecule, from.x, all);
  const double volume = dcm::ball_volume(from.radius);
  double &rest_ratio = (*ratio)(cell->cells().find(from.molecule));

  dcm::Random random(seed, from.molecule, 0, dcm::RandomPurpose::CONVERSION);
  const Vec3 axis = random.gaussian_vector();
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(random.gaussian(), axis[0], axis[1], axis[2]).normalized();
  dcm::Mesh round = top.mesh;
  for (Vec3 &x : round.nodes) x = rotation * x;

  DCMCellBuilder::Deformable to;
  to.molecule = from.molecule;
  to.mask = from.masks;
  to.volume0 = rest_ratio * volume;
  rest_ratio = 1.0;
  for (int k = 0; k < 3; k++) to.v[k] = from.v[k];
  to.x = dcm::fit_between({from.x, from.radius}, volume, neighbors, round);
  DCMCellBuilder::set_round_rest(top, rest, to);
  surgery.insert(deformable, top, to);
  changed(from.molecule, deformable.center, true, to.volume0);
}

/* ---------------------------------------------------------------------- */

void FixDCMConvert::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(counts);
  record.write(fp);
}

void FixDCMConvert::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(counts);
}

/* ----------------------------------------------------------------------
   conversions to deformable and to center-based cells so far
------------------------------------------------------------------------- */

double FixDCMConvert::compute_vector(int i)
{
  return (double) counts[i];
}
