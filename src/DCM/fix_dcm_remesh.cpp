/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_remesh.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "bond_dcm_cortex.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_args.h"
#include "dcm_cell_change.h"
#include "dcm_deck_check.h"
#include "dcm_record.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "math_const.h"
#include "modify.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/remesh";
static constexpr int RECORD = 1;    // version of the restart record
static constexpr int USUAL = 100;
static const char HEADER[] =
    "# LAMMPS-DCM remesh log; distance in mean edges, volume, area and energy relative\n"
    "# step time cell flips slides moves quality_before quality distance volume area energy\n";

// a cell that could be made no better is tried again when it is worse by this

static constexpr double AGAIN = 0.95;

// goal, unless given: this part of the way from the quality to 1

static constexpr double MARGIN = 0.25;

// the law sees positions rounded to this part of a cell's size, as in fix dcm/division: what it
// decides must not hang on the last bits, which differ with the number of ranks

static constexpr double ROUNDING = 0x1p-24;

/* ----------------------------------------------------------------------
   fix ID group dcm/remesh [every N] [quality Q] [goal G] [longest R] [distance D] [angle A]
       [energy E] [carry strain|load] [log FILE]
------------------------------------------------------------------------- */

FixDCMRemesh::FixDCMRemesh(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), every(0), springs(true), log(lmp, STYLE, HEADER), ncells(0),
    nflips(0), nslides(0), nmoves(0), nleft(0), distance(0.0), volume(0.0)
{
  AtomVecDCM::require(lmp, STYLE);
  if (!modify->get_fix_by_style("^dcm/remesh$").empty())
    error->all(FLERR, "There is a fix dcm/remesh already (ID {}); a deck has at most one",
               modify->get_fix_by_style("^dcm/remesh$")[0]->id);
  parse(narg - 3, arg + 3);

  vector_flag = 1;
  size_vector = 8;
  extvector = 0;
  global_freq = 1;
  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

void FixDCMRemesh::parse(int narg, char **arg)
{
  DCMArgs args(
      lmp, STYLE, narg, arg,
      {"every", "quality", "goal", "longest", "distance", "angle", "energy", "carry", "log"});
  bool have_goal = false;
  while (args.next()) {
    if (args.is("every")) {
      every = (int) args.whole();
    } else if (args.is("quality")) {
      settings.quality = args.number(DCMArgs::POSITIVE);
      args.check(settings.quality < 1.0, "below 1, the quality of an equilateral face");
    } else if (args.is("goal")) {
      settings.goal = args.number(DCMArgs::POSITIVE);
      args.check(settings.goal < 1.0, "below 1, the quality of an equilateral face");
      have_goal = true;
    } else if (args.is("longest")) {
      settings.longest = args.number(DCMArgs::POSITIVE);
      args.check(settings.longest > 1.5, "above 1.5: a good mesh has such edges");
    } else if (args.is("distance")) {
      settings.distance = args.number(DCMArgs::POSITIVE);
      args.check(settings.distance <= 0.5, "at most 0.5 mean edges");
    } else if (args.is("angle")) {
      const double degrees = args.number(DCMArgs::POSITIVE);
      args.check(degrees <= 90.0, "at most 90 degrees");
      settings.angle = MathConst::DEG2RAD * degrees;
    } else if (args.is("energy")) {
      settings.energy = args.number(DCMArgs::POSITIVE);
    } else if (args.is("carry")) {
      settings.load = args.choose({"strain", "load"}, "strain or load") == 1;
    } else {
      log.name(args.text());
    }
  }
  if (!have_goal) settings.goal = settings.quality + MARGIN * (1.0 - settings.quality);
  if (settings.goal < settings.quality)
    error->all(FLERR, "{}: goal {} is below quality {}; a cell would be remeshed at every look",
               STYLE, settings.goal, settings.quality);
}

/* ---------------------------------------------------------------------- */

int FixDCMRemesh::setmask()
{
  return INITIAL_INTEGRATE | PRE_EXCHANGE;
}

void FixDCMRemesh::init()
{
  nevery = look_every(lmp, every, USUAL);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  check_others();
  springs = dynamic_cast<BondDCMCortex *>(force->bond_match("dcm/cortex")) != nullptr;
  tried = cell->change_cells().add(STYLE, "remesh_tried", DCMColumn::RESET, UNTRIED, {}, tried);
  DCMCellSurgery::check_order(lmp, this, STYLE);
  next_reneighbor = -1;
}

/* ----------------------------------------------------------------------
   styles whose numbers would be those of edges and faces that are gone
------------------------------------------------------------------------- */

void FixDCMRemesh::check_others() const
{
  for (auto *const role : of(lmp)) {
    if (!(role->traits() & KEEPS_PLACES)) continue;
    const auto *const fix = dynamic_cast<Fix *>(role);
    error->all(FLERR,
               "{}: {} keeps numbers of single faces or edges, which a new mesh does not have; "
               "take one of the two out of the deck",
               STYLE,
               fix ? fmt::format("fix {} ({})", fix->id, fix->style)
                   : fmt::format("pair_style {} with branch history", force->pair_style));
  }
}

void FixDCMRemesh::setup(int /*vflag*/)
{
  log.open();
}

/* ----------------------------------------------------------------------
   who needs it: from the faces that each process owns
------------------------------------------------------------------------- */

void FixDCMRemesh::initial_integrate(int /*vflag*/)
{
  log.begin();
  needy.clear();
  if (update->ntimestep % nevery) return;
  const auto &table = cell->cells();
  const auto &faces = cell->faces();
  std::map<int, double> mine;    // need per row
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = faces[f];
    if (!(table[face.cell].mask & groupbit)) continue;
    Vec3 x[3];
    for (int k = 0; k < 3; k++) x[k] = dcm::vec(atom->x[face.v[k]]);
    const double longest =
        std::max({(x[1] - x[0]).norm(), (x[2] - x[1]).norm(), (x[0] - x[2]).norm()});
    const double need = dcm::remesh_need(dcm::face_quality(x[0], x[1], x[2]),
                                         longest / cell->mean_edge(face.cell), settings);
    if (!(need < std::min(1.0, AGAIN * (*tried)(face.cell)))) continue;
    const auto at = mine.emplace(face.cell, need).first;
    at->second = std::min(at->second, need);
  }
  std::vector<Needy> list;
  for (const auto &it : mine) list.push_back({table[it.first].molecule, it.second});
  list = dcm_allgather(list, world);
  std::sort(list.begin(), list.end(), [](const Needy &a, const Needy &b) {
    return a.molecule != b.molecule ? a.molecule < b.molecule : a.need < b.need;
  });
  for (const Needy &it : list)
    if (needy.empty() || needy.back().molecule != it.molecule) needy.push_back(it);
  if (!needy.empty()) next_reneighbor = update->ntimestep;
}

/* ---------------------------------------------------------------------- */

void FixDCMRemesh::pre_exchange()
{
  if (needy.empty() || next_reneighbor != update->ntimestep) return;

  // another fix may have divided, converted or taken away a cell in this very step

  const auto &table = cell->cells();
  std::vector<tagint> molecules;
  for (const Needy &it : needy) {
    const int row = table.find(it.molecule);
    if (row >= 0 && table[row].deformable) molecules.push_back(it.molecule);
  }
  needy.clear();
  const auto cells = DCMCellSurgery(lmp, STYLE).gather(molecules);
  const auto marked = marks();
  DCMCellChange change(lmp, STYLE);
  for (size_t n = 0; n < cells.size(); n++) {
    if (cells[n].l0.size() + 6 != 3 * cells[n].mesh.nodes.size())
      error->all(FLERR,
                 "{}: cell {} has {} bonds at step {}, and {} edges; bonds of other styles between "
                 "its nodes cannot be carried over, take the cell out of the group",
                 STYLE, cells[n].molecule, cells[n].l0.size(), update->ntimestep,
                 3 * cells[n].mesh.nodes.size() - 6);
    const auto now = find(cells[n], marked, (int) (n % comm->nprocs));
    count(cells[n], now);
    if (now.flips + now.slides + now.moves) change.add(cells[n], now);
  }
  change.apply();
}

/* ----------------------------------------------------------------------
   faces that bound a lumen, by their IDs, sorted
------------------------------------------------------------------------- */

std::vector<tagint> FixDCMRemesh::marks() const
{
  std::vector<tagint> tags;
  const auto *const marker = marker_of(lmp);
  if (!marker) return tags;
  const int *const mark = marker->marked_faces();
  for (int i = 0; i < atom->nlocal; i++)
    if (mark[i]) tags.push_back(atom->tag[i]);
  tags = dcm_allgather(tags, world);
  std::sort(tags.begin(), tags.end());
  return tags;
}

/* ----------------------------------------------------------------------
   the cell as the law takes it. Nodes that some style moves, or that are in other groups than most
   of the cell, stay what they are; faces keep their groups and marks, so that nothing is done
across a border of these.
------------------------------------------------------------------------- */

dcm::RemeshCell FixDCMRemesh::prepare(const DCMCellSurgery::Cell &from,
                                      const std::vector<tagint> &marked) const
{
  dcm::RemeshCell to;
  to.mesh = from.mesh;
  to.l0 = from.l0;
  to.theta0 = from.theta0;
  to.region = from.region;
  to.v = from.node_v;
  const double unit = ROUNDING * std::exp2(std::round(std::log2(from.volume0) / 3.0));
  for (Vec3 &x : to.mesh.nodes)
    for (int k = 0; k < 3; k++) x[k] = unit * std::round((x[k] - from.mesh.nodes[0][k]) / unit);

  int moved = 0;
  for (const auto *const role : of(lmp)) moved |= role->moved_bits();
  std::map<int, int> masks;
  for (const int mask : from.node_mask) masks[mask]++;
  const auto usual = std::max_element(masks.begin(), masks.end(), [](auto &a, auto &b) {
    return a.second < b.second;
  });
  for (const int mask : from.node_mask)
    to.pinned.push_back(mask != usual->first || (mask & moved) != 0);

  std::map<std::pair<int, bool>, int> classes;
  for (size_t f = 0; f < from.face_tag.size(); f++) {
    const bool mark = std::binary_search(marked.begin(), marked.end(), from.face_tag[f]);
    const auto at = classes.emplace(std::make_pair(from.face_mask[f], mark), (int) classes.size());
    to.face_class.push_back(at.first->second);
  }
  return to;
}

/* ----------------------------------------------------------------------
   one rank works on a cell, all get what it found, at the place where the cell is
------------------------------------------------------------------------- */

dcm::Remeshed FixDCMRemesh::find(const DCMCellSurgery::Cell &from,
                                 const std::vector<tagint> &marked, int root)
{
  dcm::Remeshed now;
  const dcm::RemeshCell before = prepare(from, marked);
  dcm::RemeshSettings set = settings;
  if (!springs) {    // rest lengths that nobody reads
    set.energy = std::numeric_limits<double>::max();
    set.load = false;
  }
  if (comm->me == root)
    now = dcm::remesh(before, set);
  else
    now = dcm::remesh_detail::as_it_was(before);

  auto share = [this, root](void *data, size_t n, MPI_Datatype type) {
    MPI_Bcast(data, (int) n, type, root, world);
  };
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "sent as numbers");
  static_assert(sizeof(std::array<int, 3>) == 3 * sizeof(int), "sent as numbers");
  int counts[3] = {now.flips, now.slides, now.moves};
  double numbers[7] = {now.quality_before, now.quality, now.distance,     now.volume,
                       now.area,           now.energy,  now.energy_before};
  share(counts, 3, MPI_INT);
  share(numbers, 7, MPI_DOUBLE);
  now.flips = counts[0];
  now.slides = counts[1];
  now.moves = counts[2];
  now.quality_before = numbers[0];
  now.quality = numbers[1];
  now.distance = numbers[2];
  now.volume = numbers[3];
  now.area = numbers[4];
  now.energy = numbers[5];
  now.energy_before = numbers[6];
  if (now.flips + now.slides + now.moves == 0) return now;
  auto &to = now.cell;
  share(to.mesh.nodes[0].data(), 3 * to.mesh.nodes.size(), MPI_DOUBLE);
  share(to.mesh.faces[0].data(), 3 * to.mesh.faces.size(), MPI_INT);
  share(to.l0.data(), to.l0.size(), MPI_DOUBLE);
  share(to.theta0.data(), to.theta0.size(), MPI_DOUBLE);
  share(to.region.data(), to.region.size(), MPI_INT);
  share(to.v[0].data(), 3 * to.v.size(), MPI_DOUBLE);
  share(now.node_changed.data(), now.node_changed.size(), MPI_CHAR);
  share(now.face_changed.data(), now.face_changed.size(), MPI_CHAR);
  for (size_t n = 0; n < to.mesh.nodes.size(); n++)    // without the rounding
    to.mesh.nodes[n] += from.mesh.nodes[n] - before.mesh.nodes[n];
  return now;
}

/* ---------------------------------------------------------------------- */

void FixDCMRemesh::count(const DCMCellSurgery::Cell &from, const dcm::Remeshed &now)
{
  const double need = dcm::remesh_need(now.quality, dcm::longest_edge(now.cell.mesh), settings);
  (*tried)(cell->cells().find(from.molecule)) = need < 1.0 ? need : UNTRIED;
  if (now.flips + now.slides + now.moves == 0) {
    nleft++;
    return;
  }
  ncells++;
  nflips += now.flips;
  nslides += now.slides;
  nmoves += now.moves;
  distance = std::max(distance, now.distance);
  volume = std::max(volume, std::fabs(now.volume));
  log.print("{} {:.10g} {} {} {} {} {:.6g} {:.6g} {:.6g} {:.6g} {:.8g} {:.8g}\n", update->ntimestep,
            cell->cells().time(), from.molecule, now.flips, now.slides, now.moves,
            now.quality_before, now.quality, now.distance, now.volume, now.area,
            now.energy_before > 0.0 ? now.energy / now.energy_before : 1.0);
  log.flush();
}

/* ---------------------------------------------------------------------- */

void FixDCMRemesh::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(ncells);
  record.put(nflips);
  record.put(nslides);
  record.put(nmoves);
  record.put(nleft);
  record.put(distance);
  record.put(volume);
  record.write(fp);
}

void FixDCMRemesh::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  record.get(ncells);
  record.get(nflips);
  record.get(nslides);
  record.get(nmoves);
  record.get(nleft);
  record.get(distance);
  record.get(volume);
  log.go_on();
}

/* ----------------------------------------------------------------------
   the worst face of the group now; collective
------------------------------------------------------------------------- */

double FixDCMRemesh::quality_now() const
{
  FixDCMCell::check_current(lmp, STYLE, cell);
  double worst = 1.0;
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    if (!(cell->cells()[face.cell].mask & groupbit)) continue;
    worst = std::min(worst,
                     dcm::face_quality(dcm::vec(atom->x[face.v[0]]), dcm::vec(atom->x[face.v[1]]),
                                       dcm::vec(atom->x[face.v[2]])));
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MIN, world);
  return worst;
}

/* ----------------------------------------------------------------------
   cells remeshed, flips, slides, nodes moved, tries that changed nothing, worst face now, largest
   distance of the surface in mean edges, largest part of the volume that was given back
------------------------------------------------------------------------- */

double FixDCMRemesh::compute_vector(int i)
{
  if (i == 5) return quality_now();
  const double values[] = {(double) ncells, (double) nflips, (double) nslides,
                           (double) nmoves, (double) nleft,  0.0,
                           distance,        volume};
  return values[i];
}

std::string FixDCMRemesh::work()
{
  return fmt::format("{} times a cell, {} flips, {} nodes moved so far", ncells, nflips, nmoves);
}
