/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
// One look of fix dcm/polarity at the surfaces: free faces, apical vectors, regions of faces.

#include "fix_dcm_polarity.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_compat.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "law/volume.h"
#include "pair_dcm_contact.h"

#include <cmath>

using namespace LAMMPS_NS;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/polarity";

// A turns to a sum of unit vectors that is longer than this: what is shorter is a mesh whose faces
// are spread a little unevenly. Reported if by more than 30 degrees

static constexpr double LEAST_SUM = 0.5, FAR = 0.8660254037844386;

/* ---------------------------------------------------------------------- */

void FixDCMPolarity::look(bool turning)
{
  cell->update_all();
  sums.assign(cell->cells().size(), Sums());
  find_outward();
  if (turning) {
    sum_free_faces();
    turn_cells();
  }
  set_regions();
}

/* ----------------------------------------------------------------------
   positions of faces and mean nodes are those of the last force evaluation
------------------------------------------------------------------------- */

void FixDCMPolarity::find_outward()
{
  const auto &table = cell->cells();
  const auto &faces = cell->faces();
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  outward.resize(cell->nowned());
  for (int f = 0; f < cell->nowned(); f++) {
    if (!due[faces[f].cell]) continue;
    Vec3 d = dcm::vec(atom->x[faces[f].atom]) - dcm::vec(table[faces[f].cell].x);
    if (periodic) dcm_minimum_image(domain, d[0], d[1], d[2]);
    outward[f] = dcm::direction(d);
  }
}

void FixDCMPolarity::sum_free_faces()
{
  const auto &table = cell->cells();
  const auto &faces = cell->faces();
  const double *const covered = contact->contact_area();
  // marks of the step before: whoever makes them comes after this fix. A marked face counts in
  // contact as well, as those of a lumen that is just being opened
  const int *const marked = sees == LUMEN && marks ? marks->marked_faces() : nullptr;
  for (int f = 0; f < cell->nowned(); f++) {
    if (sees == LUMEN && !(marked && marked[faces[f].atom])) continue;
    const int row = faces[f].cell;
    const double area = cell->area(f), free = area - covered[faces[f].atom];
    if (!due[row] || !(sees == LUMEN || area - free < theta * area)) continue;
    const double weight = by_area ? free * table[row].nfaces / table[row].area : 1.0;
    sums[row].normals.add(weight * outward[f]);
    sums[row].nfree++;
  }
  if (comm->nprocs == 1) return;
  packed.clear();
  for (int row = 0; row < table.size(); row++) {
    if (!due[row]) continue;
    packed.insert(packed.end(), sums[row].normals.sum, sums[row].normals.sum + 3);
    packed.push_back(sums[row].nfree);
  }
  MPI_Allreduce(MPI_IN_PLACE, packed.data(), (int) packed.size(), MPI_INT64_T, MPI_SUM, world);
  const std::int64_t *next = packed.data();
  for (int row = 0; row < table.size(); row++) {
    if (!due[row]) continue;
    for (auto &component : sums[row].normals.sum) component = *next++;
    sums[row].nfree = *next++;
  }
}

/* ----------------------------------------------------------------------
   A points to the free faces, or (sees outside) away from them; it stays if there are none, or as
   many on all sides
------------------------------------------------------------------------- */

void FixDCMPolarity::turn_cells()
{
  nturned = nclosed = 0;
  const auto &table = cell->cells();
  for (const int row : table.all_deformable()) {
    if (!due[row] || !polar(table[row])) continue;
    if (sums[row].nfree == 0) nclosed++;
    if (has_vectors(row) && stays(row)) continue;
    Vec3 now = dcm::direction(dcm::in_plane(sums[row].normals.value(), axis), LEAST_SUM);
    if (sees == OUTSIDE) now = -now;
    if (!(now.norm() > 0.5)) continue;
    if (has_vectors(row) && now.dot(A(row)) < FAR) nturned++;
    set(row, now, turned(row, P(row), now));
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMPolarity::set_regions()
{
  const auto &table = cell->cells();
  const auto &faces = cell->faces();
  struct Surface {    // of a cell, looked up once and not for each face
    bool known;
    Vec3 A, P;
    double per_area;
    dcm::SurfaceCones cones;
  };
  std::vector<Surface> surfaces(table.size());
  for (int row = 0; row < table.size(); row++)
    if (due[row])
      surfaces[row] = {has_vectors(row), A(row), P(row), 1.0 / area_unit(row), cones_of(row)};
  int nchanged = 0;
  for (int f = 0; f < cell->nowned(); f++) {
    const int row = faces[f].cell;
    if (!due[row]) continue;
    const Surface &mine = surfaces[row];
    const int region = mine.known ? mine.cones.region(mine.A, mine.P, outward[f]) : dcm::LATERAL;
    if (region != dcm->region[faces[f].atom]) {
      cell->set_region(f, region);
      nchanged++;
    }
    if (region != dcm::APICAL && region != dcm::JUNCTION) continue;
    auto &sum = region == dcm::APICAL ? sums[row].apical : sums[row].junction;
    sum += std::llround(cell->area(f) * mine.per_area);    // per_area: a power of two
  }
  if (add_up(nchanged)) cell->update_regions();
  for (int row = 0; row < table.size(); row++) {
    if (!due[row]) continue;
    (*apical_area)(row) = (double) sums[row].apical * area_unit(row);
    (*junction_area)(row) = (double) sums[row].junction * area_unit(row);
  }
}

/* ----------------------------------------------------------------------
   areas over all processes; number of faces that changed on any of them
------------------------------------------------------------------------- */

std::int64_t FixDCMPolarity::add_up(int nchanged)
{
  if (comm->nprocs == 1) return nchanged;
  packed.assign(1, nchanged);
  for (int row = 0; row < (int) due.size(); row++)
    if (due[row]) packed.insert(packed.end(), {sums[row].apical, sums[row].junction});
  MPI_Allreduce(MPI_IN_PLACE, packed.data(), (int) packed.size(), MPI_INT64_T, MPI_SUM, world);
  const std::int64_t *next = packed.data() + 1;
  for (int row = 0; row < (int) due.size(); row++) {
    if (!due[row]) continue;
    sums[row].apical = *next++;
    sums[row].junction = *next++;
  }
  return packed[0];
}

// a power of two, so that areas are summed as integers

double FixDCMPolarity::area_unit(int row) const
{
  return std::ldexp(1.0, std::ilogb(cell->cells()[row].area) - 40);
}

/* ----------------------------------------------------------------------
   cones of a cell: the ribbon may follow its mesh
------------------------------------------------------------------------- */

dcm::SurfaceCones FixDCMPolarity::cones_of(int row)
{
  const auto &it = cell->cells()[row];
  dcm::SurfaceCones mine = cones;
  if (!ribbon_auto && cones.low == dcm::NO_REGION) return mine;
  const double edge = dcm::equal_edge(it.area, it.nfaces), R = dcm::ball_radius(it.volume);
  if (ribbon_auto) {
    mine.high = cones.apical;
    mine.low = dcm::ribbon_low(cones.apical, edge, R);
    return mine;
  }
  const double width = dcm::ribbon_width(cones.low, cones.high, R);
  if (width < 0.5 * edge && !warned) {
    warned = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "{}: the ribbon of tight junctions of cell {} is {:.3} wide, less than half "
                     "an edge of its mesh ({:.3}), and has gaps; use junction auto or two cosines "
                     "farther apart",
                     STYLE, it.molecule, width, edge);
  }
  return mine;
}
