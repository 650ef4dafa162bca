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
#include "dcm_cell_bins.h"
#include "dcm_compat.h"
#include "dcm_cell_variable.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "law/random.h"
#include "law/shape.h"
#include "law/volume.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "modify.h"
#include "region.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/convert";
static constexpr int RECORD = 1;    // version of the restart record

enum { STAY, TO_DEFORMABLE, TO_SPHERE };

/* ----------------------------------------------------------------------
   fix ID group dcm/convert dcm Tcenter Tnode Tface Tbond Tdihedral cbm Tsphere
       region IN OUT | near GROUP d1 d2 | variable v_name
       [mesh icosphere level] [rest factor] [every N] [seed S]
------------------------------------------------------------------------- */

FixDCMConvert::FixDCMConvert(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), level(2), rest(1.0), region{nullptr, nullptr},
    near_bit(0), near{0.0, 0.0}, seed(1), counts{0, 0}
{
  AtomVecDCM::require(lmp, STYLE);
  every = 0;
  parse(narg - 3, arg + 3);
  if (sphere.center == 0 || deformable.center == 0)
    error->all(FLERR,
               "{}: give the types of both forms: dcm Tcenter Tnode Tface Tbond Tdihedral "
               "cbm Tsphere",
               STYLE);
  const int nrules = !region_id[0].empty() + !variable.empty() + !group_id.empty();
  if (nrules != 1)
    error->all(FLERR, "{}: give one rule, region, near or variable, not {}", STYLE, nrules);
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
  DCMArgs args(lmp, STYLE, narg, arg,
               {"dcm", "cbm", "region", "near", "variable", "mesh", "rest", "every", "seed"});
  while (args.next()) {
    if (args.is("dcm")) {
      args.need(5);
      deformable.center = args.type(atom->ntypes);
      deformable.node = args.type(atom->ntypes);
      deformable.face = args.type(atom->ntypes);
      deformable.bond = args.type(atom->nbondtypes);
      deformable.dihedral = args.type(atom->ndihedraltypes);
    } else if (args.is("cbm")) {
      sphere.center = args.type(atom->ntypes);
    } else if (args.is("region")) {
      args.need(2);
      for (auto &id : region_id) id = args.text();
    } else if (args.is("near")) {
      args.need(3);
      group_id = args.text();
      for (double &distance : near) distance = args.number(DCMArgs::POSITIVE);
      if (near[1] < near[0])
        error->all(FLERR, "{}: near: the second distance, {}, is below the first, {}", STYLE,
                   near[1], near[0]);
    } else if (args.is("variable")) {
      variable = args.variable();
    } else if (args.is("mesh")) {
      args.choose({"icosphere"}, "icosphere LEVEL");
      level = (int) args.whole(1, 5);
    } else if (args.is("rest")) {
      rest = args.number(DCMArgs::POSITIVE);
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

void FixDCMConvert::init()
{
  nevery = look_every(lmp, every, 100);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
  if (!cell->expects_deformable())
    error->all(FLERR, "{} needs a fix dcm/cell; add 'fix cell all dcm/cell' to the deck", STYLE);
  spheres = cell->request_spheres();
  ratio = cell->change_cells().add(STYLE, "rest_ratio", DCMColumn::INHERIT, 1.0, {}, ratio);
  cell->refresh();
  cell->cells().require_ids(STYLE);
  for (int k = 0; k < 2; k++)
    if (!region_id[k].empty()) region[k] = dcm_find_region(lmp, STYLE, region_id[k]);
  if (!variable.empty()) dcm_find_variable(lmp, STYLE, variable);
  if (!group_id.empty()) near_bit = dcm_find_group(lmp, STYLE, group_id);
  DCMCellSurgery::require_laws(lmp, STYLE);
  DCMCellSurgery::check_order(lmp, this, STYLE);
  DCMCellBuilder(lmp, STYLE, false).reserve_slots(top.slots);
  next_reneighbor = -1;
}

/* ----------------------------------------------------------------------
   what the rule asks of every cell
------------------------------------------------------------------------- */

std::vector<int> FixDCMConvert::wanted(const Cells &cells)
{
  std::vector<int> change(cells.size(), STAY);
  for (auto *it : region)
    if (it) it->prematch();
  std::vector<double> value;
  if (!variable.empty()) {
    std::vector<tagint> molecules;
    for (const auto &it : cells) molecules.push_back(it.molecule);
    value = dcm_cell_variable(lmp, variable, molecules);
  }
  std::vector<double> places;    // of the cells that others are near to
  std::unique_ptr<DCMCellBins> bins;
  if (near_bit) {
    for (const auto &it : cells)
      if (it.mask & near_bit) places.insert(places.end(), it.x, it.x + 3);
    bins = std::make_unique<DCMCellBins>(domain, places, near[1]);
  }
  for (size_t n = 0; n < cells.size(); n++) {
    const auto &it = cells[n];
    if (!(it.mask & groupbit)) continue;
    if (it.type != (it.deformable ? deformable.center : sphere.center)) continue;
    bool in = false, out = false;
    if (region[0]) {
      in = region[0]->match(it.x[0], it.x[1], it.x[2]);
      out = !region[1]->match(it.x[0], it.x[1], it.x[2]);
    } else if (!variable.empty()) {
      in = value[n] > 0.0;
      out = value[n] < 0.0;
    } else {
      // all centers of the group that may be near enough stand in the bins around the cell
      out = true;
      for (const int m : bins->near(it.x)) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = places[3 * (size_t) m + k] - it.x[k];
        dcm_minimum_image(domain, d[0], d[1], d[2]);
        const double distance = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        in = in || distance < near[0];
        out = out && distance > near[1];
      }
    }
    if (in && !it.deformable) change[n] = TO_DEFORMABLE;
    if (out && it.deformable) change[n] = TO_SPHERE;
  }
  return change;
}

/* ---------------------------------------------------------------------- */

void FixDCMConvert::initial_integrate(int /*vflag*/)
{
  changing.clear();
  if (update->ntimestep % nevery) return;
  const auto &table = cell->cells();
  const auto cells = DCMCellTable::gather(lmp, true);
  const auto change = wanted(cells);
  for (size_t n = 0; n < cells.size(); n++) {
    const int row = table.find(cells[n].molecule);
    if (change[n] == STAY || row < 0) continue;
    // who is about to divide does so as it is; its daughters can change
    const int phase = table[row].phase;
    if (phase == DCMCellTable::ROUNDING || phase == DCMCellTable::READY) continue;
    changing.push_back({cells[n].molecule, change[n] == TO_DEFORMABLE});
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
  cell->change_cells().converted(from.molecule, sphere.center, false, volume);
  counts[1]++;
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
  cell->change_cells().converted(from.molecule, deformable.center, true, to.volume0);
  counts[0]++;
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
