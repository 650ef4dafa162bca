/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Faces of fix dcm/cell: their vertices, positions, areas and normals, curvature at their nodes,
// what ghosts are told, and how they look.

#include "fix_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_slots.h"
#include "domain.h"
#include "law/curvature.h"
#include "law/volume.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

enum { IMAGE_SPHERE, IMAGE_LINE, IMAGE_TRI };    // as in dump_image.cpp

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
      const int j = dcm_index_of(atom, tag);
      if (j >= 0 && (dcm->kind[j] != AtomVecDCM::NODE || atom->molecule[j] != atom->molecule[i]))
        wrong_vertex(i, j);
      if (j >= 0) face.v[k] = domain->closest_image(i, j);

      if (j >= 0) {
        const double *const there = atom->x[face.v[k]], *const here = atom->x[i];
        if (domain->minimum_image_check(there[0] - here[0], there[1] - here[1], there[2] - here[2]))
          face.torn = true;
      }
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
    if (!face.whole()) continue;
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
   signed scalar curvature 2H of every node, owned and ghost (doc page theory)
------------------------------------------------------------------------- */

void FixDCMCell::measure_curvature()
{
  double **x = atom->x;
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  node_sums.assign((size_t) NCURVATURE * nall, 0.0);
  for (int f = 0; f < nowned_faces; f++) {
    const int *v = face_list[f].v;
    const auto part = dcm::face_curvature_parts(vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]]));
    for (int k = 0; k < 3; k++) {
      double *sums = &node_sums[(size_t) NCURVATURE * v[k]];
      vec(sums) += part.laplace[k];
      vec(sums + 3) += part.normal[k];
      sums[6] += part.area[k];
    }
  }
  commflag = CURVATURE;
  comm->reverse_comm(this, NCURVATURE);

  node_curvature.resize(nall);
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const double *sums = &node_sums[(size_t) NCURVATURE * i];
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
    const double *sums = &node_sums[(size_t) NCURVATURE * i];
    for (int k = 0; k < NCURVATURE; k++) buf[m++] = sums[k];
  }
  return m;
}

void FixDCMCell::unpack_reverse_comm(int n, int *list, double *buf)
{
  int m = 0;
  for (int i = 0; i < n; i++) {
    if (dcm->kind[list[i]] != AtomVecDCM::NODE) continue;
    double *sums = &node_sums[(size_t) NCURVATURE * list[i]];
    for (int k = 0; k < NCURVATURE; k++) sums[k] += buf[m++];
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
