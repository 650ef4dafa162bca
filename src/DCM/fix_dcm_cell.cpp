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
#include "law/curvature.h"
#include "dcm_args.h"
#include "dcm_parameters.h"
#include "dcm_record.h"
#include "dcm_rest_file.h"
#include "law/volume.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

enum { IMAGE_SPHERE, IMAGE_LINE, IMAGE_TRI };    // as in dump_image.cpp

static const char STYLE[] = "Fix dcm/cell";
static constexpr int RECORD = 1;    // version of the restart record

static constexpr int NSUM = 5;     // per cell: volume, area, displacement of the mean node
static constexpr int NCURV = 7;    // per node: Laplace vector, normal, area

/* ---------------------------------------------------------------------- */

FixDCMCell::FixDCMCell(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), table(lmp)
{
  dcm = AtomVecDCM::require(lmp, "Fix dcm/cell");
  DCMArgs args(lmp, "Fix dcm/cell", narg - 3, arg + 3, {"types"});
  while (args.next()) {
    types = std::make_unique<DCMParameters>(lmp, "Fix dcm/cell", std::vector<std::string>());
    types->parse_table(args, atom->ntypes);
  }
  if (igroup != 0) error->all(FLERR, "Fix dcm/cell must have group all, not {}", arg[1]);
  if (!modify->get_fix_by_style("^dcm/cell$").empty())
    error->all(FLERR, "There is a fix dcm/cell already (ID {}); a deck has exactly one",
               modify->get_fix_by_style("^dcm/cell$")[0]->id);
  comm_forward = 4;
  comm_reverse = NCURV;
  restart_global = 1;
}

FixDCMCell::~FixDCMCell() = default;

int FixDCMCell::setmask()
{
  return PRE_NEIGHBOR | PRE_FORCE | MIN_PRE_NEIGHBOR | MIN_PRE_FORCE;
}

FixDCMCell *FixDCMCell::require(LAMMPS *lmp, const std::string &asking)
{
  AtomVecDCM::require(lmp, asking);
  const auto found = lmp->modify->get_fix_by_style("^dcm/cell$");
  if (found.empty())
    lmp->error->all(FLERR, "{} needs a fix dcm/cell; add 'fix cell all dcm/cell' to the deck",
                    asking);
  return dynamic_cast<FixDCMCell *>(found[0]);
}

// with the ID that decks use, so that one that the deck defines later replaces it

void FixDCMCell::ensure(LAMMPS *lmp, const std::string &asking)
{
  if (!lmp->modify->get_fix_by_style("^dcm/cell$").empty()) return;
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
  if (update->whichflag == 2) check_minimize();
  table.reserve_molecules();
}

void FixDCMCell::setup_pre_neighbor()
{
  pre_neighbor();
}

void FixDCMCell::setup_pre_force(int vflag)
{
  pre_force(vflag);
  check_surfaces();
  table.forget_saved();
}

/* ----------------------------------------------------------------------
   membership and face topology hold until the next rebuild
------------------------------------------------------------------------- */

void FixDCMCell::pre_neighbor()
{
  table.refresh(spheres_wanted.any());
  snap_centers();
  build_faces();
  count_members();
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
  table.refresh(spheres_wanted.any());
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

/* ----------------------------------------------------------------------
   which cell each node, face and center belongs to; members of each cell
------------------------------------------------------------------------- */

void FixDCMCell::count_members()
{
  const int nall = atom->nlocal + atom->nghost;
  cell_of_atom.assign(nall, -1);
  cell_sums.assign(2 * table.size(), 0.0);
  const bool spheres = spheres_wanted.any();
  int last = -1;    // atoms of a cell follow each other
  for (int i = 0; i < nall; i++) {
    const int kind = dcm->kind[i];
    if (kind == AtomVecDCM::SPHERE && spheres) cell_of_atom[i] = table.find(atom->molecule[i]);
    if (kind != AtomVecDCM::NODE && kind != AtomVecDCM::FACE && kind != AtomVecDCM::CENTER)
      continue;
    if (last < 0 || table[last].molecule != atom->molecule[i]) last = table.find(atom->molecule[i]);
    if (last < 0 || !table[last].deformable)
      error->one(FLERR,
                 "Fix dcm/cell: {} {} belongs to cell {}, which has no center atom; delete "
                 "whole cells only",
                 kind == AtomVecDCM::NODE ? "node" : "face", atom->tag[i], atom->molecule[i]);
    cell_of_atom[i] = last;
    if (i < atom->nlocal && kind == AtomVecDCM::NODE) cell_sums[2 * last] += 1.0;
    if (i < atom->nlocal && kind == AtomVecDCM::FACE) cell_sums[2 * last + 1] += 1.0;
  }
  sum(cell_sums, 2);
  for (const int c : table.deformable())
    table.counted(c, (int) cell_sums[2 * c], (int) cell_sums[2 * c + 1]);
  for (auto &face : face_list) face.cell = cell_of_atom[face.atom];
}

/* ----------------------------------------------------------------------
   after a rebuild measure from a grid point near each center: in a run that goes
   on the center atom was moved by its velocity, in one that restarts here it is
   the mean node, and the two differ in the last bits
------------------------------------------------------------------------- */

void FixDCMCell::snap_centers()
{
  for (const int c : table.deformable()) {
    const auto &cell = table[c];
    if (!(cell.volume0 > 0.0)) continue;
    const double unit = std::exp2(std::floor(std::log2(cell.volume0) / 3.0) - 4.0);
    double x[3];
    for (int k = 0; k < 3; k++) x[k] = unit * std::round(cell.x[k] / unit);
    table.place(c, x);
  }
}

/* ----------------------------------------------------------------------
   faces and the local indices of their vertices, owned faces first
------------------------------------------------------------------------- */

void FixDCMCell::build_faces()
{
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  face_list.clear();
  face_of_atom.assign(nall, -1);
  for (int i = 0; i < nall; i++) {
    if (i == nlocal) nowned_faces = (int) face_list.size();
    if (dcm->kind[i] != AtomVecDCM::FACE) continue;
    Face face = {i, {-1, -1, -1}, -1};
    for (int k = 0; k < 3; k++) {
      const tagint tag = atom->tag[i] + dcm->vertex[i][k];
      const int j = tag > atom->map_tag_max ? -1 : atom->map(tag);    // map() does not check
      if (j >= 0) face.v[k] = domain->closest_image(i, j);
      if (face.v[k] < 0 && i < nlocal) missing_vertex(i, tag);
    }
    face_of_atom[i] = (int) face_list.size();
    face_list.push_back(face);
  }
  if (atom->nghost == 0) nowned_faces = (int) face_list.size();
  face_area.assign(face_list.size(), 0.0);
  normals_current = false;
}

/* ----------------------------------------------------------------------
   put owned faces exactly at their centroids and set their radii before the
   neighbor build; ghosts get the owner's values, bit for bit
------------------------------------------------------------------------- */

void FixDCMCell::move_faces()
{
  double **x = atom->x;
  double contact_range = 0.0;
  ranges.each([&contact_range](double range) {
    contact_range = std::max(contact_range, range);
  });
  double sums[2] = {0.0, 3.0 * nowned_faces};
  for (int f = 0; f < nowned_faces; f++) {
    const Face &face = face_list[f];
    const Vec3 a = vec(x[face.v[0]]), b = vec(x[face.v[1]]), c = vec(x[face.v[2]]);
    const Vec3 mid = (a + b + c) / 3.0;
    vec(x[face.atom]) = mid;
    const double rsq =
        std::max({(a - mid).squaredNorm(), (b - mid).squaredNorm(), (c - mid).squaredNorm()});
    atom->radius[face.atom] = std::sqrt(rsq) + 0.5 * contact_range;
    sums[0] += (b - a).norm() + (c - b).norm() + (a - c).norm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, world);
  edge_mean = sums[1] > 0.0 ? sums[0] / sums[1] : 0.0;
}

/* ---------------------------------------------------------------------- */

void FixDCMCell::measure_faces()
{
  double **x = atom->x;
  for (size_t f = 0; f < face_list.size(); f++) {
    const Face &face = face_list[f];
    if (face.v[0] < 0 || face.v[1] < 0 || face.v[2] < 0) continue;
    const Vec3 a = vec(x[face.v[0]]), b = vec(x[face.v[1]]), c = vec(x[face.v[2]]);
    face_area[f] = dcm::face_area_vector(a, b, c).norm();
    vec(x[face.atom]) = (a + b + c) / 3.0;
  }
  normals_current = false;
}

const double *FixDCMCell::normals()
{
  if (normals_current) return face_normal.data();
  double **x = atom->x;
  face_normal.assign(3 * face_list.size(), 0.0);
  for (size_t f = 0; f < face_list.size(); f++) {
    const int *v = face_list[f].v;
    if (v[0] < 0 || v[1] < 0 || v[2] < 0 || !(face_area[f] > 0.0)) continue;
    vec(&face_normal[3 * f]) =
        dcm::face_area_vector(vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]])) / face_area[f];
  }
  normals_current = true;
  return face_normal.data();
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

  cell_sums.assign(NSUM * table.size(), 0.0);
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
  sum(cell_sums, NSUM);

  for (const int c : table.deformable()) {
    const auto &cell = table[c];
    const double *sums = &cell_sums[NSUM * c];
    if (!std::isfinite(sums[0]) || sums[0] <= 0.0)
      error->all(FLERR,
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
   signed scalar curvature 2H of every node, owned and ghost (doc page theory)
------------------------------------------------------------------------- */

void FixDCMCell::measure_curvature()
{
  double **x = atom->x;
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  node_sums.assign((size_t) NCURV * nall, 0.0);
  for (int f = 0; f < nowned_faces; f++) {
    const int *v = face_list[f].v;
    const auto part = dcm::face_curvature_parts(vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]]));
    for (int k = 0; k < 3; k++) {
      double *sums = &node_sums[(size_t) NCURV * v[k]];
      vec(sums) += part.laplace[k];
      vec(sums + 3) += part.normal[k];
      sums[6] += part.area[k];
    }
  }
  commflag = CURVATURE;
  comm->reverse_comm(this, NCURV);

  node_curvature.resize(nall);
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const double *sums = &node_sums[(size_t) NCURV * i];
    node_curvature[i] = dcm::node_curvature(vec(sums), vec(sums + 3), sums[6]);
  }
  comm->forward_comm(this, 1);
}

/* ---------------------------------------------------------------------- */

int FixDCMCell::pack_forward_comm(int n, int *list, double *buf, int pbc_flag, int *pbc)
{
  const int *kind = dcm->kind;
  int m = 0;
  if (commflag == CURVATURE) {
    for (int i = 0; i < n; i++)
      if (kind[list[i]] == AtomVecDCM::NODE) buf[m++] = node_curvature[list[i]];
    return m;
  }

  if (commflag == REGION) {
    for (int i = 0; i < n; i++)
      if (kind[list[i]] == AtomVecDCM::FACE) buf[m++] = dcm->region[list[i]];
    return m;
  }

  double shift[3] = {0.0, 0.0, 0.0};
  if (pbc_flag) {
    shift[0] = pbc[0] * domain->xprd + pbc[5] * domain->xy + pbc[4] * domain->xz;
    shift[1] = pbc[1] * domain->yprd + pbc[3] * domain->yz;
    shift[2] = pbc[2] * domain->zprd;
  }
  for (int i = 0; i < n; i++) {
    const int j = list[i];
    if (kind[j] != AtomVecDCM::FACE) continue;
    for (int k = 0; k < 3; k++) buf[m++] = atom->x[j][k] + shift[k];
    buf[m++] = atom->radius[j];
  }
  return m;
}

void FixDCMCell::unpack_forward_comm(int n, int first, double *buf)
{
  const int *kind = dcm->kind;
  int m = 0;
  for (int i = first; i < first + n; i++) {
    if (commflag == CURVATURE) {
      if (kind[i] == AtomVecDCM::NODE) node_curvature[i] = buf[m++];
    } else if (kind[i] != AtomVecDCM::FACE) {
      continue;
    } else if (commflag == REGION) {
      dcm->region[i] = (int) buf[m++];
    } else {
      for (int k = 0; k < 3; k++) atom->x[i][k] = buf[m++];
      atom->radius[i] = buf[m++];
    }
  }
}

int FixDCMCell::pack_reverse_comm(int n, int first, double *buf)
{
  int m = 0;
  for (int i = first; i < first + n; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const double *sums = &node_sums[(size_t) NCURV * i];
    for (int k = 0; k < NCURV; k++) buf[m++] = sums[k];
  }
  return m;
}

void FixDCMCell::unpack_reverse_comm(int n, int *list, double *buf)
{
  int m = 0;
  for (int i = 0; i < n; i++) {
    if (dcm->kind[list[i]] != AtomVecDCM::NODE) continue;
    double *sums = &node_sums[(size_t) NCURV * list[i]];
    for (int k = 0; k < NCURV; k++) sums[k] += buf[m++];
  }
}

/* ----------------------------------------------------------------------
   triangles for dump image, colored by atom type of the face
------------------------------------------------------------------------- */

int FixDCMCell::image(int *&kinds, double **&rows)
{
  image_kind.assign(nowned_faces, IMAGE_TRI);
  image_values.resize((size_t) 10 * nowned_faces);
  image_rows.resize(nowned_faces);
  for (int f = 0; f < nowned_faces; f++) {
    double *row = image_rows[f] = &image_values[(size_t) 10 * f];
    row[0] = atom->type[face_list[f].atom];
    for (int k = 0; k < 3; k++) vec(row + 1 + 3 * k) = vec(atom->x[face_list[f].v[k]]);
  }
  kinds = image_kind.data();
  rows = image_rows.data();
  return nowned_faces;
}

/* ---------------------------------------------------------------------- */

double FixDCMCell::memory_usage()
{
  double bytes = table.memory_usage();
  bytes += (double) face_list.capacity() * (sizeof(Face) + sizeof(double));
  bytes += (double) cell_of_atom.capacity() * 2 * sizeof(int);
  bytes += (double) (first_around.capacity() + around.capacity()) * sizeof(int);
  bytes += (double) (node_sums.capacity() + node_curvature.capacity() + face_normal.capacity()) *
           sizeof(double);
  return bytes;
}

/* ---------------------------------------------------------------------- */

int FixDCMCell::modify_param(int narg, char **arg)
{
  const bool writing = strcmp(arg[0], "rest/write") == 0;
  if (!writing && strcmp(arg[0], "rest/read") != 0) return 0;
  if (narg < 2) error->all(FLERR, "Fix_modify {} {} needs a file name", id, arg[0]);
  if (writing)
    dcm_write_rest_file(lmp, arg[1]);
  else
    dcm_read_rest_file(lmp, arg[1]);
  return 2;
}

/* ---------------------------------------------------------------------- */

void FixDCMCell::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  DCMRecord record(lmp, STYLE, RECORD);
  table.put(record);
  record.write(fp);
}

void FixDCMCell::restart(char *buf)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.load(buf);
  table.get(record);
}
