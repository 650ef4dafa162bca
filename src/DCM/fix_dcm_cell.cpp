/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_compat.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "dcm_parameters.h"
#include "dcm_record.h"
#include "dcm_rest_file.h"
#include "dcm_retype.h"
#include "dcm_version.h"
#include "law/volume.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_dcm_contact.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/cell";
static constexpr int RECORD = 1;    // version of the restart record

static constexpr int NSUM = 5;    // per cell: volume, area, displacement of the mean node

/* ---------------------------------------------------------------------- */

FixDCMCell::FixDCMCell(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), table(lmp), sharing(world)
{
  dcm = AtomVecDCM::require(lmp, "Fix dcm/cell");
  DCMArgs args(lmp, "Fix dcm/cell", narg - 3, arg + 3, {"types"});
  while (args.next()) {
    types = std::make_unique<DCMParameters>(lmp, "Fix dcm/cell", std::vector<std::string>());
    types->parse_table(args, atom->ntypes);
  }
  if (igroup != 0) error->all(FLERR, "Fix dcm/cell must have group all, not {}", arg[1]);
  if (const auto *const other = find(lmp))
    error->all(FLERR, "There is a fix dcm/cell already (ID {}{}); a deck has exactly one",
               other->id,
               other->by_deck
                   ? ""
                   : ", added for a style above; define yours before that style, or with this ID");
  comm_forward = 4;
  comm_reverse = NCURVATURE;
  restart_global = 1;
  stores_ids = 1;    // of vertices, which reset_atoms id does not know
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix dcm/cell: version {} of the package DCM\n", DCM_VERSION);
}

FixDCMCell::~FixDCMCell() = default;

int FixDCMCell::setmask()
{
  return PRE_EXCHANGE | PRE_NEIGHBOR | PRE_FORCE | MIN_PRE_EXCHANGE | MIN_PRE_NEIGHBOR |
         MIN_PRE_FORCE;
}

FixDCMCell *FixDCMCell::find(LAMMPS *lmp)
{
  const auto found = lmp->modify->get_fix_by_style("^dcm/cell$");
  return found.empty() ? nullptr : dynamic_cast<FixDCMCell *>(found[0]);
}

FixDCMCell *FixDCMCell::require(LAMMPS *lmp, const std::string &asking)
{
  AtomVecDCM::require(lmp, asking);
  auto *const fix = find(lmp);
  if (!fix)
    lmp->error->all(FLERR, "{} needs a fix dcm/cell; add 'fix cell all dcm/cell' to the deck",
                    asking);
  return fix;
}

void FixDCMCell::check_current(LAMMPS *lmp, const std::string &asking, const FixDCMCell *cell)
{
  if (!cell || find(lmp) != cell)
    lmp->error->all(
        FLERR,
        "{}: fix dcm/cell was removed or defined anew since the last step; do a 'run 0' "
        "before using values of this style",
        asking);
}

void FixDCMCell::check_current(LAMMPS *lmp, const std::string &asking,
                               const PairDCMContact *contact)
{
  // one that was made anew may have the address of the last, but has measured nothing yet
  const bool there = contact && lmp->force->pair_match("dcm/contact", 1) == contact;
  if (!there || (lmp->atom->nlocal > 0 && !contact->contact_area()))
    lmp->error->one(
        FLERR,
        "{}: pair_style dcm/contact was removed or defined anew since the last step; do "
        "a 'run 0' before using values of this style",
        asking);
}

void FixDCMCell::check_atoms(const std::string &asking) const
{
  const size_t nall = atom->nlocal + atom->nghost;
  if (known_tags.size() != nall || !std::equal(known_tags.begin(), known_tags.end(), atom->tag))
    error->one(
        FLERR,
        "{}: atoms were added, deleted or given to other processes since the last step; do a "
        "'run 0' before using values of this style",
        asking);
}

// with the ID that decks use, so that one that the deck defines later replaces it

void FixDCMCell::ensure(LAMMPS *lmp, const std::string &asking)
{
  if (find(lmp)) return;
  const std::string id = lmp->modify->get_fix_by_id("cell") ? "DCM_CELL" : "cell";
  dynamic_cast<FixDCMCell *>(lmp->modify->add_fix(id + " all dcm/cell"))->by_deck = false;
  if (lmp->comm->me == 0)
    utils::logmesg(lmp, "{}: added 'fix {} all dcm/cell', which keeps the table of cells\n", asking,
                   id);
}

/* ---------------------------------------------------------------------- */

void FixDCMCell::init()
{
  dcm = AtomVecDCM::require(lmp, "Fix dcm/cell");
  if (!force->newton_pair || !force->newton_bond)
    error->all(FLERR, "Fix dcm/cell needs newton on for pairs and bonds; remove 'newton off'");
  dcm_check_deck(lmp, STYLE);
  if (update->whichflag == 2) check_minimize();
  table.reserve_molecules();
  nlists = 0;
  lists_for.clear();
}

void FixDCMCell::setup_pre_neighbor()
{
  pre_neighbor();
}

void FixDCMCell::setup_pre_force(int vflag)
{
  pre_force(vflag);
  check_surfaces();
  check_topology();
  table.forget_saved();
}

/* ----------------------------------------------------------------------
   membership and face topology hold until the next rebuild
------------------------------------------------------------------------- */

void FixDCMCell::pre_neighbor()
{
  count_list();
  table.refresh(spheres_wanted.any());
  snap_centers();
  build_faces();
  count_members();
  report_fault();
  if (domain->box_change) check_width();
  if (adjacency_wanted.any()) build_adjacency();
  move_faces();
  commflag = GEOMETRY;
  comm->forward_comm(this, 4);
}

void FixDCMCell::pre_force(int /*vflag*/)
{
  table.begin_step();
  measure_faces();
  measure_cells();
  if (curvature_wanted.any()) measure_curvature();
}

/* ----------------------------------------------------------------------
   cells that came, went or changed without a rebuild, between runs
------------------------------------------------------------------------- */

void FixDCMCell::refresh()
{
  update_all();
  table.refresh(spheres_wanted.any());
  list_centers();
}

void FixDCMCell::list_centers()
{
  centers.clear();
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::CENTER) centers.push_back(table.find(atom->molecule[i]));
  std::sort(centers.begin(), centers.end());
}

/* ----------------------------------------------------------------------
   deformable cells only, so that it costs no more where there are spheres in the table
------------------------------------------------------------------------- */

void FixDCMCell::sum(std::vector<double> &values, int width)
{
  if (comm->nprocs == 1) return;
  const auto &rows = table.all_deformable();
  if (rows.empty()) return;
  packed.resize(width * rows.size());
  for (size_t n = 0; n < rows.size(); n++)
    std::copy_n(&values[(size_t) width * rows[n]], width, &packed[width * n]);
  MPI_Allreduce(MPI_IN_PLACE, packed.data(), (int) packed.size(), MPI_DOUBLE, MPI_SUM, world);
  for (size_t n = 0; n < rows.size(); n++)
    std::copy_n(&packed[width * n], width, &values[(size_t) width * rows[n]]);
}

void FixDCMCell::begin_sum(std::vector<double> &values, int width) const
{
  if (values.size() < (size_t) width * table.size()) values.resize((size_t) width * table.size());
  for (const int row : table.deformable()) std::fill_n(&values[(size_t) width * row], width, 0.0);
}

void FixDCMCell::update_all()
{
  if (comm->nprocs > 1) table.update_all(centers);
}

/* ----------------------------------------------------------------------
   which cell each node, face and center belongs to; members of each cell, and who shares it
------------------------------------------------------------------------- */

void FixDCMCell::count_members()
{
  const int nall = atom->nlocal + atom->nghost;
  cell_of_atom.assign(nall, -1);
  known_tags.assign(atom->tag, atom->tag + nall);
  cell_sums.assign(2 * table.size(), 0.0);
  parts.assign(table.size(), dcm::CellSharing::NONE);
  const bool spheres = spheres_wanted.any();
  int last = -1;    // atoms of a cell follow each other
  for (int i = 0; i < nall; i++) {
    const int kind = dcm->kind[i];
    if (kind == AtomVecDCM::SPHERE && spheres) cell_of_atom[i] = table.find(atom->molecule[i]);
    if (kind < AtomVecDCM::SPHERE || kind > AtomVecDCM::TRACER) wrong_kind(i);
    if (kind != AtomVecDCM::NODE && kind != AtomVecDCM::FACE && kind != AtomVecDCM::CENTER)
      continue;
    if (last < 0 || table[last].molecule != atom->molecule[i]) last = table.find(atom->molecule[i]);
    if (last < 0 || !table[last].deformable) {
      fault(atom->tag[i],
            fmt::format("{} {} belongs to cell {}, which has no center atom; delete whole cells "
                        "only, and leave 'reset_atoms mol' out, which knows bonds only",
                        kind == AtomVecDCM::NODE ? "node" : "face", atom->tag[i],
                        atom->molecule[i]));
      last = -1;
      continue;
    }
    cell_of_atom[i] = last;
    if (i < atom->nlocal)
      parts[last] = dcm::CellSharing::OWNS;
    else if (parts[last] == dcm::CellSharing::NONE)
      parts[last] = dcm::CellSharing::TOUCHES;
    if (i < atom->nlocal && kind == AtomVecDCM::NODE) {
      cell_sums[2 * last] += 1.0;
      const bigint stamp = AtomVecDCM::stamp(atom, i);
      if (dcm->bonded[i] == 0) dcm->bonded[i] = stamp;
      if (dcm->bonded[i] != stamp && !adopt_bonds(i))
        fault(atom->tag[i],
              fmt::format("the bonds or dihedrals of node {} (cell {}) were edited before step {}; "
                          "rest lengths and angles of cells do not follow delete_bonds, "
                          "create_bonds, delete_atoms of some nodes with 'bond yes' and fixes that "
                          "change bonds: leave these out (delete whole cells), or use a "
                          "bond style of their own for other bonds (bond_style hybrid)",
                          atom->tag[i], atom->molecule[i], update->ntimestep));
    }
    if (i < atom->nlocal && kind == AtomVecDCM::FACE) cell_sums[2 * last + 1] += 1.0;
  }
  list_centers();
  sum(cell_sums, 2);
  for (const int c : table.all_deformable())
    table.counted(c, (int) cell_sums[2 * c], (int) cell_sums[2 * c + 1]);
  sharing.connect(parts);
  std::vector<int> here;
  for (const int c : table.all_deformable())
    if (parts[c] != dcm::CellSharing::NONE) here.push_back(c);
  table.set_here(here);
  for (auto &face : face_list) face.cell = cell_of_atom[face.atom];
}

/* ----------------------------------------------------------------------
   after a rebuild measure from a grid point near each center: in a run that goes
   on the center atom was moved by its velocity, in one that restarts here it is
   the mean node, and the two differ in the last bits
------------------------------------------------------------------------- */

void FixDCMCell::snap_centers()
{
  for (const int c : table.all_deformable()) {
    const auto &cell = table[c];
    if (!(cell.volume0 > 0.0)) continue;
    const double unit = std::exp2(std::floor(std::log2(cell.volume0) / 3.0) - 4.0);
    double x[3];
    for (int k = 0; k < 3; k++) x[k] = unit * std::round(cell.x[k] / unit);
    table.place(c, x);
  }
}

/* ----------------------------------------------------------------------
   volume, area and mean node of every cell; positions relative to the last
   center, so that a cell may straddle a periodic boundary
------------------------------------------------------------------------- */

void FixDCMCell::measure_cells()
{
  double **x = atom->x;
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  auto from_center = [&](int i, int c) {
    const double *const center = table[c].x;
    Vec3 d(x[i][0] - center[0], x[i][1] - center[1], x[i][2] - center[2]);
    if (periodic) dcm_minimum_image(domain, d[0], d[1], d[2]);
    return d;
  };

  begin_sum(cell_sums, NSUM);
  for (int f = 0; f < nowned_faces; f++) {
    const Face &face = face_list[f];
    double *sums = &cell_sums[NSUM * face.cell];
    const Vec3 a = from_center(face.v[0], face.cell);
    const Vec3 b = a + (vec(x[face.v[1]]) - vec(x[face.v[0]]));
    const Vec3 c = a + (vec(x[face.v[2]]) - vec(x[face.v[0]]));
    sums[0] += dcm::face_volume(a, b, c);
    sums[1] += face_area[f];
  }
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    double *sums = &cell_sums[NSUM * cell_of_atom[i]];
    vec(sums + 2) += from_center(i, cell_of_atom[i]);
  }
  sum_shared(cell_sums, NSUM);

  for (const int c : table.deformable()) {
    const auto &cell = table[c];
    const double *sums = &cell_sums[NSUM * c];
    if (!std::isfinite(sums[0]) || sums[0] <= 0.0)
      error->one(FLERR,
                 "Fix dcm/cell: cell {} has volume {} at step {}: its surface is inverted "
                 "(a mesh given inside out, or a time step too large); flip the mesh's faces or "
                 "reduce the timestep",
                 cell.molecule, sums[0], update->ntimestep);
    double center[3] = {cell.x[0], cell.x[1], cell.x[2]};
    if (cell.nnodes > 0)
      for (int k = 0; k < 3; k++) center[k] += sums[2 + k] / cell.nnodes;
    table.measured(c, sums[0], sums[1], center);
  }
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::CENTER) vec(x[i]) = vec(table[cell_of_atom[i]].x);
}

/* ----------------------------------------------------------------------
   that of an equilateral triangle: within a few per cent of the mean edge of its mesh
------------------------------------------------------------------------- */

double FixDCMCell::mean_edge(int row) const
{
  const auto &cell = table[row];
  return std::sqrt(4.0 / std::sqrt(3.0) * cell.area / std::max(1, cell.nfaces));
}

/* ---------------------------------------------------------------------- */

double FixDCMCell::memory_usage()
{
  double bytes = table.memory_usage() + sharing.memory_usage();
  bytes += (double) (cell_sums.capacity() + packed.capacity()) * sizeof(double);
  bytes += (double) face_list.capacity() * (sizeof(Face) + sizeof(double));
  bytes += (double) cell_of_atom.capacity() * (2 * sizeof(int) + sizeof(tagint));
  bytes += (double) (first_around.capacity() + around.capacity()) * sizeof(int);
  bytes += (double) (node_sums.capacity() + node_curvature.capacity() + face_normal.capacity()) *
           sizeof(double);
  return bytes;
}

/* ---------------------------------------------------------------------- */

int FixDCMCell::modify_param(int narg, char **arg)
{
  if (strcmp(arg[0], "retype") == 0) {
    dcm_retype_cells(lmp, this, narg - 1, arg + 1);
    return narg;
  }
  const bool writing = strcmp(arg[0], "rest/write") == 0;
  if (!writing && strcmp(arg[0], "rest/read") != 0) return 0;
  if (narg < 2) error->all(FLERR, "Fix_modify {} {} needs a file name", id, arg[0]);
  const bool partial = !writing && narg > 2 && strcmp(arg[2], "partial") == 0;
  if (writing) {
    tagint edited = 0;
    for (int i = 0; i < atom->nlocal; i++)
      if (dcm->kind[i] == AtomVecDCM::NODE && dcm->bonded[i] &&
          dcm->bonded[i] != AtomVecDCM::stamp(atom, i) && !adopt_bonds(i))
        edited = std::max(edited, atom->tag[i]);
    MPI_Allreduce(MPI_IN_PLACE, &edited, 1, MPI_LMP_TAGINT, MPI_MAX, world);
    if (edited)
      error->all(FLERR,
                 "Fix dcm/cell: rest-state file {} is not written: the bonds or dihedrals of node "
                 "{} were edited, and its rest lengths and angles do not follow delete_bonds, "
                 "create_bonds, delete_atoms of some nodes or fixes that change bonds",
                 arg[1], edited);
    dcm_write_rest_file(lmp, arg[1]);
  } else
    dcm_read_rest_file(lmp, arg[1], partial);
  return partial ? 3 : 2;
}

/* ---------------------------------------------------------------------- */

void FixDCMCell::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  table.put(record);
  record.put(std::string(DCM_VERSION));
  record.write(fp);
}

void FixDCMCell::restart(char *buf)
{
  // LAMMPS writes the time at which the time step last changed, and forgets what has passed since
  // when a run begins; here, before that, the steps are still known

  update->update_time();
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  table.get(record);
  std::string by = "without a number";
  if (record.more()) record.get(by);
  if (by != DCM_VERSION && comm->me == 0)
    utils::logmesg(lmp, "Fix dcm/cell: the restart file is of version {} of the package\n", by);
}
