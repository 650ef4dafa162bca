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
#include "dcm_gather.h"
#include "law/volume.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

enum { IMAGE_SPHERE, IMAGE_LINE, IMAGE_TRI };    // as in dump_image.cpp

static constexpr int NSUM = 5;     // per cell: volume, area, displacement of the mean node
static constexpr int NCURV = 7;    // per node: Laplace vector, normal, area

/* ---------------------------------------------------------------------- */

FixDCMCell::FixDCMCell(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  dcm = AtomVecDCM::require(lmp, "Fix dcm/cell");
  if (narg > 3) error->all(FLERR, "Fix dcm/cell: unknown keyword {}; it takes none", arg[3]);
  if (igroup != 0) error->all(FLERR, "Fix dcm/cell must have group all, not {}", arg[1]);
  if (!modify->get_fix_by_style("^dcm/cell$").empty())
    error->all(FLERR, "There is a fix dcm/cell already (ID {}); a deck has exactly one",
               modify->get_fix_by_style("^dcm/cell$")[0]->id);
  comm_forward = 4;
  comm_reverse = NCURV;
}

int FixDCMCell::setmask()
{
  return PRE_NEIGHBOR | PRE_FORCE;
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

/* ---------------------------------------------------------------------- */

void FixDCMCell::init()
{
  dcm = AtomVecDCM::require(lmp, "Fix dcm/cell");
  if (!force->newton_pair || !force->newton_bond)
    error->all(FLERR, "Fix dcm/cell needs newton on for pairs and bonds; remove 'newton off'");
}

void FixDCMCell::setup_pre_neighbor()
{
  pre_neighbor();
}

void FixDCMCell::setup_pre_force(int vflag)
{
  pre_force(vflag);
  check_surfaces();
}

/* ----------------------------------------------------------------------
   membership and face topology hold until the next rebuild
------------------------------------------------------------------------- */

void FixDCMCell::pre_neighbor()
{
  gather_cells();
  snap_centers();
  build_faces();
  count_members();
  move_faces();
  commflag = GEOMETRY;
  comm->forward_comm(this, 4);
}

void FixDCMCell::pre_force(int /*vflag*/)
{
  measure_faces();
  measure_cells();
  if (want_curvature) measure_curvature();
}

/* ----------------------------------------------------------------------
   table of all deformable cells from their center atoms, the same on all ranks
------------------------------------------------------------------------- */

void FixDCMCell::gather_cells()
{
  struct Entry {
    tagint molecule, tag;
    int type, mask;
    double volume0, x[3];
  };
  std::vector<Entry> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::CENTER) continue;
    const double *x = atom->x[i];
    mine.push_back({atom->molecule[i],
                    atom->tag[i],
                    atom->type[i],
                    atom->mask[i],
                    dcm->volume0[i],
                    {x[0], x[1], x[2]}});
  }
  auto all = dcm_allgather(mine, world);
  std::sort(all.begin(), all.end(), [](const Entry &a, const Entry &b) {
    return a.molecule < b.molecule;
  });

  std::vector<Cell> old;
  old.swap(cells);
  for (const auto &e : all) {
    if (!cells.empty() && cells.back().molecule == e.molecule)
      error->all(FLERR, "Fix dcm/cell: cell {} has two center atoms, {} and {}", e.molecule,
                 cells.back().center_tag, e.tag);
    Cell cell = {};
    cell.molecule = e.molecule;
    cell.center_tag = e.tag;
    cell.type = e.type;
    cell.mask = e.mask;
    cell.volume0 = e.volume0;
    for (int k = 0; k < 3; k++) cell.x[k] = e.x[k];
    cells.push_back(cell);
  }

  // what was measured before stays readable until the next pre_force

  size_t n = 0;
  for (auto &cell : cells) {
    while (n < old.size() && old[n].molecule < cell.molecule) n++;
    if (n == old.size() || old[n].molecule != cell.molecule) continue;
    cell.volume = old[n].volume;
    cell.area = old[n].area;
    cell.pressure = old[n].pressure;
  }
}

void FixDCMCell::refresh_centers()
{
  gather_cells();
  count_members();
}

int FixDCMCell::find_cell(tagint molecule) const
{
  auto found =
      std::lower_bound(cells.begin(), cells.end(), molecule, [](const Cell &cell, tagint mol) {
        return cell.molecule < mol;
      });
  return (found == cells.end() || found->molecule != molecule) ? -1 : (int) (found - cells.begin());
}

void FixDCMCell::sum(std::vector<double> &values) const
{
  if (comm->nprocs > 1 && !values.empty())
    MPI_Allreduce(MPI_IN_PLACE, values.data(), (int) values.size(), MPI_DOUBLE, MPI_SUM, world);
}

/* ----------------------------------------------------------------------
   which cell each node, face and center belongs to; members of each cell
------------------------------------------------------------------------- */

void FixDCMCell::count_members()
{
  const int nall = atom->nlocal + atom->nghost;
  cell_of.assign(nall, -1);
  cell_sums.assign(2 * cells.size(), 0.0);
  int last = -1;    // atoms of a cell follow each other
  for (int i = 0; i < nall; i++) {
    const int kind = dcm->kind[i];
    if (kind != AtomVecDCM::NODE && kind != AtomVecDCM::FACE && kind != AtomVecDCM::CENTER)
      continue;
    if (last < 0 || cells[last].molecule != atom->molecule[i]) last = find_cell(atom->molecule[i]);
    if (last < 0)
      error->one(FLERR,
                 "Fix dcm/cell: {} {} belongs to cell {}, which has no center atom; delete "
                 "whole cells only",
                 kind == AtomVecDCM::NODE ? "node" : "face", atom->tag[i], atom->molecule[i]);
    cell_of[i] = last;
    if (i < atom->nlocal && kind == AtomVecDCM::NODE) cell_sums[2 * last] += 1.0;
    if (i < atom->nlocal && kind == AtomVecDCM::FACE) cell_sums[2 * last + 1] += 1.0;
  }
  sum(cell_sums);
  for (size_t c = 0; c < cells.size(); c++) {
    cells[c].nnodes = (int) cell_sums[2 * c];
    cells[c].nfaces = (int) cell_sums[2 * c + 1];
  }
  for (auto &face : faces) face.cell = cell_of[face.atom];
}

/* ----------------------------------------------------------------------
   after a rebuild measure from a grid point near each center: in a run that goes
   on the center atom was moved by its velocity, in one that restarts here it is
   the mean node, and the two differ in the last bits
------------------------------------------------------------------------- */

void FixDCMCell::snap_centers()
{
  for (auto &cell : cells) {
    if (!(cell.volume0 > 0.0)) continue;
    const double unit = std::exp2(std::floor(std::log2(cell.volume0) / 3.0) - 4.0);
    for (double &x : cell.x) x = unit * std::round(x / unit);
  }
}

/* ----------------------------------------------------------------------
   faces and the local indices of their vertices, owned faces first
------------------------------------------------------------------------- */

void FixDCMCell::build_faces()
{
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  faces.clear();
  face_of.assign(nall, -1);
  for (int i = 0; i < nall; i++) {
    if (i == nlocal) nowned = (int) faces.size();
    if (dcm->kind[i] != AtomVecDCM::FACE) continue;
    Face face = {i, {-1, -1, -1}, -1};
    for (int k = 0; k < 3; k++) {
      const tagint tag = atom->tag[i] + dcm->vertex[i][k];
      const int j = tag > atom->map_tag_max ? -1 : atom->map(tag);    // map() does not check
      if (j >= 0) face.v[k] = domain->closest_image(i, j);
      if (face.v[k] < 0 && i < nlocal) missing_vertex(i, tag);
    }
    face_of[i] = (int) faces.size();
    faces.push_back(face);
  }
  if (atom->nghost == 0) nowned = (int) faces.size();
  has_normals = false;
  area.assign(faces.size(), 0.0);
}

/* ----------------------------------------------------------------------
   put owned faces exactly at their centroids and set their radii before the
   neighbor build; ghosts get the owner's values, bit for bit
------------------------------------------------------------------------- */

void FixDCMCell::move_faces()
{
  double **x = atom->x;
  double sums[2] = {0.0, 3.0 * nowned};
  for (int f = 0; f < nowned; f++) {
    const Face &face = faces[f];
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
  has_normals = false;
  double **x = atom->x;
  for (size_t f = 0; f < faces.size(); f++) {
    const Face &face = faces[f];
    if (face.v[0] < 0 || face.v[1] < 0 || face.v[2] < 0) continue;
    const Vec3 a = vec(x[face.v[0]]), b = vec(x[face.v[1]]), c = vec(x[face.v[2]]);
    area[f] = dcm::face_area_vector(a, b, c).norm();
    vec(x[face.atom]) = (a + b + c) / 3.0;
  }
}

const double *FixDCMCell::normals()
{
  if (has_normals) return normal.data();
  double **x = atom->x;
  normal.assign(3 * faces.size(), 0.0);
  for (size_t f = 0; f < faces.size(); f++) {
    const int *v = faces[f].v;
    if (v[0] < 0 || v[1] < 0 || v[2] < 0 || !(area[f] > 0.0)) continue;
    vec(&normal[3 * f]) = dcm::face_area_vector(vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]])) / area[f];
  }
  has_normals = true;
  return normal.data();
}

/* ----------------------------------------------------------------------
   volume, area and mean node of every cell; positions relative to the last
   center, so that a cell may straddle a periodic boundary
------------------------------------------------------------------------- */

void FixDCMCell::measure_cells()
{
  double **x = atom->x;
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  auto from_center = [&](int i, const Cell &cell) {
    Vec3 d(x[i][0] - cell.x[0], x[i][1] - cell.x[1], x[i][2] - cell.x[2]);
    if (periodic) dcm_minimum_image(domain, d[0], d[1], d[2]);
    return d;
  };

  cell_sums.assign(NSUM * cells.size(), 0.0);
  for (int f = 0; f < nowned; f++) {
    const Face &face = faces[f];
    double *sums = &cell_sums[NSUM * face.cell];
    const Vec3 a = from_center(face.v[0], cells[face.cell]);
    const Vec3 b = a + (vec(x[face.v[1]]) - vec(x[face.v[0]]));
    const Vec3 c = a + (vec(x[face.v[2]]) - vec(x[face.v[0]]));
    sums[0] += dcm::face_volume(a, b, c);
    sums[1] += area[f];
  }
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    double *sums = &cell_sums[NSUM * cell_of[i]];
    vec(sums + 2) += from_center(i, cells[cell_of[i]]);
  }
  sum(cell_sums);

  for (size_t c = 0; c < cells.size(); c++) {
    Cell &cell = cells[c];
    const double *sums = &cell_sums[NSUM * c];
    cell.volume = sums[0];
    cell.area = sums[1];
    if (!std::isfinite(cell.volume) || cell.volume <= 0.0)
      error->all(FLERR,
                 "Fix dcm/cell: cell {} has volume {} at step {}: its surface is inverted "
                 "(a mesh given inside out, or a time step too large); flip the mesh's faces or "
                 "reduce the timestep",
                 cell.molecule, cell.volume, update->ntimestep);
    if (cell.nnodes > 0)
      for (int k = 0; k < 3; k++) cell.x[k] += sums[2 + k] / cell.nnodes;
  }
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::CENTER) vec(x[i]) = vec(cells[cell_of[i]].x);
}

/* ----------------------------------------------------------------------
   signed scalar curvature 2H of every node, owned and ghost (doc page theory)
------------------------------------------------------------------------- */

void FixDCMCell::measure_curvature()
{
  double **x = atom->x;
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  node_sums.assign((size_t) NCURV * nall, 0.0);
  for (int f = 0; f < nowned; f++) {
    const int *v = faces[f].v;
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

  curvature.resize(nall);
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const double *sums = &node_sums[(size_t) NCURV * i];
    curvature[i] = dcm::node_curvature(vec(sums), vec(sums + 3), sums[6]);
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
      if (kind[list[i]] == AtomVecDCM::NODE) buf[m++] = curvature[list[i]];
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
      if (kind[i] == AtomVecDCM::NODE) curvature[i] = buf[m++];
    } else if (kind[i] == AtomVecDCM::FACE) {
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
  image_kind.assign(nowned, IMAGE_TRI);
  image_values.resize((size_t) 10 * nowned);
  image_rows.resize(nowned);
  for (int f = 0; f < nowned; f++) {
    double *row = image_rows[f] = &image_values[(size_t) 10 * f];
    row[0] = atom->type[faces[f].atom];
    for (int k = 0; k < 3; k++) vec(row + 1 + 3 * k) = vec(atom->x[faces[f].v[k]]);
  }
  kinds = image_kind.data();
  rows = image_rows.data();
  return nowned;
}

/* ---------------------------------------------------------------------- */

double FixDCMCell::memory_usage()
{
  double bytes = 0.0;
  bytes += (double) faces.capacity() * (sizeof(Face) + 4 * sizeof(double));
  bytes += (double) face_of.capacity() * 2 * sizeof(int);
  bytes += (double) (node_sums.capacity() + curvature.capacity()) * sizeof(double);
  bytes += (double) cells.capacity() * sizeof(Cell);
  return bytes;
}
