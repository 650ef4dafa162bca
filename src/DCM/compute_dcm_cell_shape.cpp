/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Shape and mean stress of deformable cells, for compute dcm/cell. Doc page compute_dcm_cell.

#include "compute_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_compat.h"
#include "dcm_role.h"
#include "domain.h"
#include "fix_dcm_cell.h"
#include "law/cell_shape.h"
#include "law/mean_stress.h"

#include <algorithm>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

/* ----------------------------------------------------------------------
   from the middle of the cell to an atom of it, across periodic borders
------------------------------------------------------------------------- */

static Vec3 from_middle(Domain *domain, const double *x, const double *middle)
{
  Vec3 d = vec(x) - vec(middle);
  dcm_minimum_image(domain, d[0], d[1], d[2]);
  return d;
}

/* ----------------------------------------------------------------------
   moments of the volume, a tetrahedron per owned face, over the processes that share the cell
------------------------------------------------------------------------- */

void ComputeDCMCell::measure_shapes()
{
  const auto &table = cell->cells();
  std::vector<double> &moments = cell_sums;
  moments.assign(dcm::BODY_MOMENTS * (size_t) table.size(), 0.0);
  double **x = atom->x;
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    const Vec3 a = from_middle(domain, x[face.v[0]], table[face.cell].x);
    const Vec3 b = a + vec(x[face.v[1]]) - vec(x[face.v[0]]);
    const Vec3 c = a + vec(x[face.v[2]]) - vec(x[face.v[0]]);
    dcm::add_moments(&moments[dcm::BODY_MOMENTS * (size_t) face.cell], a, b, c);
  }
  cell->sum_owned(moments, dcm::BODY_MOMENTS);

  shapes.assign(NSHAPE * (size_t) table.size(), 0.0);
  for (const int row : cell->owned_cells()) {
    const dcm::CellShape shape(&moments[dcm::BODY_MOMENTS * (size_t) row]);
    double *to = &shapes[NSHAPE * (size_t) row];
    for (int k = 0; k < 3; k++) *to++ = shape.axis(k);
    const Vec3 along = shape.longest();
    for (int k = 0; k < 3; k++) *to++ = along[k];
    *to++ = shape.asphericity();
    *to++ = shape.acylindricity();
    *to++ = shape.anisotropy();
    const dcm::Symmetric strain = shape.strain(dcm::ball_radius(table[row].volume0));
    std::copy(strain.begin(), strain.end(), to);
  }
}

/* ----------------------------------------------------------------------
   What acts from outside is all force on the nodes less that of the cell's own styles. On a node
   that another style holds or moves it is also what holds it: then all forces add up to zero.
------------------------------------------------------------------------- */

void ComputeDCMCell::measure_stresses()
{
  const auto &table = cell->cells();
  int solved = 0, moved = 0;
  bool moves = false;
  std::vector<double> within(6 * (size_t) table.size(), 0.0);
  for (auto *const role : DCMRole::of(lmp)) {
    role->add_cell_virial(within);
    moves = moves || (role->traits() & DCMRole::MOVES);
    solved |= role->solved_bits();
    moved |= role->moved_bits();
  }

  // both in one message: all, then within

  cell_sums.assign(12 * (size_t) table.size(), 0.0);
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    if (moves && (!(atom->mask[i] & solved) || (atom->mask[i] & moved))) continue;
    const int row = cell->cell_of(i);
    dcm::add_outer(&cell_sums[12 * (size_t) row], vec(atom->f[i]),
                   from_middle(domain, atom->x[i], table[row].x));
  }
  for (int row = 0; row < table.size(); row++)
    std::copy_n(&within[6 * (size_t) row], 6, &cell_sums[12 * (size_t) row + 6]);
  cell->sum_owned(cell_sums, 12);

  stresses.assign(6 * (size_t) table.size(), 0.0);
  for (const int row : cell->owned_cells()) {
    const double *const sums = &cell_sums[12 * (size_t) row];
    const dcm::Symmetric s = dcm::mean_stress(sums, sums + 6, table[row].volume);
    std::copy(s.begin(), s.end(), &stresses[6 * (size_t) row]);
  }
}
