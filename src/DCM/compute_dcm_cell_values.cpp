/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Values of compute dcm/cell: what each is, for a deformable and for a center-based cell.

#include "compute_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "fix_dcm_cell.h"
#include "law/cell_shape.h"
#include "math_const.h"
#include "pair_dcm_contact.h"

#include <algorithm>

using namespace LAMMPS_NS;
using MathConst::MY_4PI;

// what is printed for a deformable and for a center-based cell

// clang-format off
const std::vector<ComputeDCMCell::Value> ComputeDCMCell::VALUES = {
    {"volume", &ComputeDCMCell::volume, &ComputeDCMCell::volume_of_sphere, NOTHING},
    {"volume0", &ComputeDCMCell::volume0, &ComputeDCMCell::volume_of_sphere, NOTHING},
    {"area", &ComputeDCMCell::area, &ComputeDCMCell::area_of_sphere, NOTHING},
    {"pressure", &ComputeDCMCell::pressure, &ComputeDCMCell::pressure_of_sphere, NOTHING},
    {"x", &ComputeDCMCell::center<0>, &ComputeDCMCell::atom_x<0>, NOTHING},
    {"y", &ComputeDCMCell::center<1>, &ComputeDCMCell::atom_x<1>, NOTHING},
    {"z", &ComputeDCMCell::center<2>, &ComputeDCMCell::atom_x<2>, NOTHING},
    {"vx", &ComputeDCMCell::summed<2>, &ComputeDCMCell::atom_v<0>, VELOCITY},
    {"vy", &ComputeDCMCell::summed<3>, &ComputeDCMCell::atom_v<1>, VELOCITY},
    {"vz", &ComputeDCMCell::summed<4>, &ComputeDCMCell::atom_v<2>, VELOCITY},
    {"contact_area", &ComputeDCMCell::summed<0>, &ComputeDCMCell::contact_area_of_sphere, AREA},
    {"free_area", &ComputeDCMCell::summed<1>, &ComputeDCMCell::free_area_of_sphere, AREA},
    {"neighbors", &ComputeDCMCell::neighbors, &ComputeDCMCell::neighbors, NEIGHBORS},
    {"axis1", &ComputeDCMCell::shape<0>, &ComputeDCMCell::shape_of_sphere<0>, SHAPE},
    {"axis2", &ComputeDCMCell::shape<1>, &ComputeDCMCell::shape_of_sphere<1>, SHAPE},
    {"axis3", &ComputeDCMCell::shape<2>, &ComputeDCMCell::shape_of_sphere<2>, SHAPE},
    {"long_x", &ComputeDCMCell::shape<3>, &ComputeDCMCell::shape_of_sphere<3>, SHAPE},
    {"long_y", &ComputeDCMCell::shape<4>, &ComputeDCMCell::shape_of_sphere<4>, SHAPE},
    {"long_z", &ComputeDCMCell::shape<5>, &ComputeDCMCell::shape_of_sphere<5>, SHAPE},
    {"asphericity", &ComputeDCMCell::shape<6>, &ComputeDCMCell::shape_of_sphere<6>, SHAPE},
    {"acylindricity", &ComputeDCMCell::shape<7>, &ComputeDCMCell::shape_of_sphere<7>, SHAPE},
    {"anisotropy", &ComputeDCMCell::shape<8>, &ComputeDCMCell::shape_of_sphere<8>, SHAPE},
    {"exx", &ComputeDCMCell::shape<9>, &ComputeDCMCell::shape_of_sphere<9>, SHAPE},
    {"eyy", &ComputeDCMCell::shape<10>, &ComputeDCMCell::shape_of_sphere<10>, SHAPE},
    {"ezz", &ComputeDCMCell::shape<11>, &ComputeDCMCell::shape_of_sphere<11>, SHAPE},
    {"exy", &ComputeDCMCell::shape<12>, &ComputeDCMCell::shape_of_sphere<12>, SHAPE},
    {"exz", &ComputeDCMCell::shape<13>, &ComputeDCMCell::shape_of_sphere<13>, SHAPE},
    {"eyz", &ComputeDCMCell::shape<14>, &ComputeDCMCell::shape_of_sphere<14>, SHAPE},
    {"sphericity", &ComputeDCMCell::sphericity, &ComputeDCMCell::sphericity_of_sphere, NOTHING},
    {"shape_index", &ComputeDCMCell::shape_index, &ComputeDCMCell::shape_index_of_sphere, NOTHING},
    {"sxx", &ComputeDCMCell::stress<0>, &ComputeDCMCell::stress_of_sphere<0>, STRESS},
    {"syy", &ComputeDCMCell::stress<1>, &ComputeDCMCell::stress_of_sphere<1>, STRESS},
    {"szz", &ComputeDCMCell::stress<2>, &ComputeDCMCell::stress_of_sphere<2>, STRESS},
    {"sxy", &ComputeDCMCell::stress<3>, &ComputeDCMCell::stress_of_sphere<3>, STRESS},
    {"sxz", &ComputeDCMCell::stress<4>, &ComputeDCMCell::stress_of_sphere<4>, STRESS},
    {"syz", &ComputeDCMCell::stress<5>, &ComputeDCMCell::stress_of_sphere<5>, STRESS},
    {"kind", &ComputeDCMCell::kind, &ComputeDCMCell::kind, NOTHING},
    {"molecule", &ComputeDCMCell::molecule, &ComputeDCMCell::molecule, NOTHING},
    {"mother", &ComputeDCMCell::mother, &ComputeDCMCell::mother, NOTHING},
    {"generation", &ComputeDCMCell::generation, &ComputeDCMCell::generation, NOTHING},
    {"birth", &ComputeDCMCell::birth, &ComputeDCMCell::birth, NOTHING},
    {"phase", &ComputeDCMCell::phase, &ComputeDCMCell::phase, NOTHING}};
// clang-format on

/* ----------------------------------------------------------------------
   p = sum of force times distance from the center to the contact / (3 V)
   (S1, center-based cells), positive in compression
------------------------------------------------------------------------- */

double ComputeDCMCell::sphere_volume(int i) const
{
  const double r = atom->radius[i];
  return MY_4PI / 3.0 * r * r * r;
}

double ComputeDCMCell::sphere_pressure(int i) const
{
  const double volume = sphere_volume(i);
  return contact && volume > 0.0 ? contact->sphere_virial()[i] / (3.0 * volume) : 0.0;
}

/* ----------------------------------------------------------------------
   one value of the cell whose center or sphere is atom i and that stands in a row of the table
   (-1: a sphere that is not in it)
------------------------------------------------------------------------- */

template <int FIELD> double ComputeDCMCell::summed(int, int row) const
{
  return cell_sums[NSUM * (size_t) row + FIELD];
}

template <int K> double ComputeDCMCell::center(int, int row) const
{
  return cell->cells()[row].x[K];
}

template <int K> double ComputeDCMCell::atom_x(int i, int) const
{
  return atom->x[i][K];
}

template <int K> double ComputeDCMCell::atom_v(int i, int) const
{
  return atom->v[i][K];
}

double ComputeDCMCell::volume(int, int row) const
{
  return cell->cells()[row].volume;
}

double ComputeDCMCell::volume0(int, int row) const
{
  return cell->cells()[row].volume0;
}

double ComputeDCMCell::area(int, int row) const
{
  return cell->cells()[row].area;
}

double ComputeDCMCell::pressure(int, int row) const
{
  return cell->cells().value("pressure", row);
}

double ComputeDCMCell::kind(int i, int) const
{
  return dcm->kind[i];
}

double ComputeDCMCell::molecule(int i, int) const
{
  return (double) atom->molecule[i];
}

double ComputeDCMCell::neighbors(int i, int) const
{
  return neighbors_of(atom->molecule[i]);
}

double ComputeDCMCell::volume_of_sphere(int i, int) const
{
  return sphere_volume(i);
}

double ComputeDCMCell::area_of_sphere(int i, int) const
{
  return MY_4PI * atom->radius[i] * atom->radius[i];
}

double ComputeDCMCell::pressure_of_sphere(int i, int) const
{
  return sphere_pressure(i);
}

double ComputeDCMCell::contact_area_of_sphere(int i, int) const
{
  return contact->contact_area()[i];
}

double ComputeDCMCell::free_area_of_sphere(int i, int row) const
{
  return std::max(0.0, area_of_sphere(i, row) - contact->contact_area()[i]);
}

double ComputeDCMCell::mother(int, int row) const
{
  return row < 0 ? 0.0 : (double) cell->cells()[row].mother;
}

double ComputeDCMCell::generation(int, int row) const
{
  return row < 0 ? 0.0 : cell->cells()[row].generation;
}

double ComputeDCMCell::birth(int, int row) const
{
  return row < 0 ? 0.0 : cell->cells()[row].birth;
}

double ComputeDCMCell::phase(int, int row) const
{
  return row < 0 ? 0.0 : cell->cells()[row].phase;
}

/* ----------------------------------------------------------------------
   shape and stress: of deformable cells as measured, of spheres in closed form
------------------------------------------------------------------------- */

template <int K> double ComputeDCMCell::shape(int, int row) const
{
  return shapes[NSHAPE * (size_t) row + K];
}

template <int K> double ComputeDCMCell::shape_of_sphere(int i, int) const
{
  return K < 3 ? atom->radius[i] : 0.0;    // no long axis, no anisotropy, no strain
}

template <int K> double ComputeDCMCell::stress(int, int row) const
{
  return stresses[6 * (size_t) row + K];
}

template <int K> double ComputeDCMCell::stress_of_sphere(int i, int) const
{
  const double volume = sphere_volume(i);
  return contact && volume > 0.0 ? -contact->sphere_tensor()[6 * (size_t) i + K] / volume : 0.0;
}

double ComputeDCMCell::sphericity(int i, int row) const
{
  return dcm::sphericity(volume(i, row), area(i, row));
}

double ComputeDCMCell::shape_index(int i, int row) const
{
  return dcm::shape_index(volume(i, row), area(i, row));
}

double ComputeDCMCell::sphericity_of_sphere(int, int) const
{
  return 1.0;
}

double ComputeDCMCell::shape_index_of_sphere(int, int) const
{
  return dcm::shape_index(dcm::ball_volume(1.0), MY_4PI);
}
