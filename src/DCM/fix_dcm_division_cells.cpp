/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// The division of one cell of fix dcm/division: its sub-simulation, or two spheres.

#include "fix_dcm_division.h"

#include "atom_vec_dcm.h"
#include "bond_dcm_cortex.h"
#include "comm.h"
#include "dihedral_dcm_bend.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "fix_dcm_volume.h"
#include "force.h"
#include "law/rest_state.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/division";

// Sums differ in their last bits with the number of ranks and the place in the box, and a
// minimization makes micrometers out of them. The mother's shape, seen from one of its nodes, is
// therefore rounded, to this part of its size, before it divides: far more than the differences, so
// that few of the coordinates, if any, are rounded to another side, and less than what it matters:
// 0.5 nm of 12 um, a tenth of a membrane. What the daughters take over is not rounded: volume, rest
// volume, rest lengths. The factor of these that their sub-simulation sees is one number only.

static constexpr double ROUNDING = 0x1p-14, ROUNDING_OF_REST = 0x1p-20;

static double rounded(double value, double unit)
{
  return unit * std::round(value / unit);
}

/* ----------------------------------------------------------------------
   the icosphere with the mother's number of nodes, or the next one
------------------------------------------------------------------------- */

const DCMCellBuilder::Topology &FixDCMDivision::round_mesh(DCMCellSurgery &surgery, size_t nnodes)
{
  int level = 1;
  size_t size = 42;
  while (level < 5 && size < nnodes) {
    size = 4 * size - 6;
    level++;
  }
  auto found = topology.find(level);
  if (found == topology.end())
    found = topology.emplace(level, surgery.builder.prepare(dcm::icosphere(level), true)).first;
  return found->second;
}

/* ----------------------------------------------------------------------
   what the sub-simulation needs: plane, the laws' constants, the prestress of the cortex
------------------------------------------------------------------------- */

FixDCMDivision::Job FixDCMDivision::prepare(DCMCellSurgery &surgery,
                                            const DCMCellSurgery::Cell &mother)
{
  Job job = {};
  job.mother = mother;
  job.origin = mother.mesh.nodes.front();
  const double unit = ROUNDING * std::exp2(std::round(std::log2(mother.volume0) / 3.0));
  for (Vec3 &x : job.mother.mesh.nodes)
    for (int k = 0; k < 3; k++) x[k] = rounded(x[k] - job.origin[k], unit);
  job.round = &round_mesh(surgery, mother.mesh.nodes.size());
  job.volume = dcm::volume(mother.mesh);
  job.rounded_volume = dcm::volume(job.mother.mesh);
  job.plane = dcm::halving_plane(job.mother.mesh, axis_of(job.mother));

  auto *const cortex = dynamic_cast<BondDCMCortex *>(force->bond_match("dcm/cortex"));
  auto *const bend = dynamic_cast<DihedralDCMBend *>(force->dihedral_match("dcm/bend"));
  job.material.ks = cortex->stiffness(mother.types.bond);
  job.material.kb = bend->stiffness(mother.types.dihedral);
  job.material.flat = !bend->rest_angles(mother.types.dihedral);
  const auto &table = cell->cells();
  const int row = table.find(mother.molecule);
  for (auto *fix : modify->get_fix_by_style("^dcm/volume$"))
    job.material.K_V =
        std::max(job.material.K_V, dynamic_cast<FixDCMVolume *>(fix)->bulk_modulus(table[row]));
  if (job.material.K_V <= 0.0)
    error->all(FLERR, "{}: cell {} is to divide at step {} but no fix dcm/volume acts on it", STYLE,
               mother.molecule, update->ntimestep);

  // before rounding up
  const double length = table.value("rounding_factor", row, 1.0);
  job.rest = dcm::rest_factor(mother.mesh, mother.l0, mother.volume0, job.round->mesh) / length;
  return job;
}

/* ----------------------------------------------------------------------
   the daughters are shared out among the ranks; all get all results
------------------------------------------------------------------------- */

void FixDCMDivision::grow(std::vector<Job> &jobs)
{
  // rest lengths are those of the rest volume, the settings those of the volume

  const auto rest_asked = [](const Job &job) {
    return rounded(job.rest * std::cbrt(job.mother.volume0 / job.rounded_volume), ROUNDING_OF_REST);
  };
  for (size_t n = 0; n < 2 * jobs.size(); n++) {
    if ((int) (n % comm->nprocs) != comm->me) continue;
    Job &job = jobs[n / 2];
    dcm::Daughter &daughter = job.daughter[n % 2];
    dcm::DivisionSettings mine = settings;
    mine.volume = 0.5 * job.rounded_volume;
    mine.rest = rest_asked(job);
    try {
      daughter = dcm::grow_daughter(job.mother.mesh, job.plane, n % 2, job.round->mesh,
                                    job.material, mine);
    } catch (std::exception &e) {
      daughter.problem = e.what();
    }
  }

  for (size_t n = 0; n < 2 * jobs.size(); n++) {
    dcm::Daughter &d = jobs[n / 2].daughter[n % 2];
    const int root = (int) (n % comm->nprocs);
    double numbers[7] = {(double) d.iterations, d.residual, d.volume, d.outside, d.quality,
                         (double) d.converged,  d.rest};
    MPI_Bcast(numbers, 7, MPI_DOUBLE, root, world);
    d.iterations = (int) numbers[0];
    d.residual = numbers[1];
    d.volume = numbers[2];
    d.outside = numbers[3];
    d.quality = numbers[4];
    d.converged = numbers[5] != 0.0;
    d.rest = numbers[6];
    int sizes[2] = {(int) d.mesh.nodes.size(), (int) d.problem.size()};
    MPI_Bcast(sizes, 2, MPI_INT, root, world);
    d.mesh.nodes.resize(sizes[0]);
    d.problem.resize(sizes[1]);
    if (sizes[0]) MPI_Bcast(d.mesh.nodes[0].data(), 3 * sizes[0], MPI_DOUBLE, root, world);
    if (sizes[1]) MPI_Bcast(&d.problem[0], sizes[1], MPI_CHAR, root, world);

    const Job &job = jobs[n / 2];
    const double larger = job.volume / job.rounded_volume;
    for (Vec3 &x : d.mesh.nodes) x = job.plane.point + std::cbrt(larger) * (x - job.plane.point);
    d.volume *= larger;
    d.rest /= rest_asked(job);    // below 1 if slack was taken up
  }
}

void FixDCMDivision::check(const Job &job) const
{
  for (const auto &d : job.daughter) {
    if (!d.problem.empty() && (d.converged || d.iterations < settings.maxiter))
      error->all(
          FLERR,
          "{}: cell {} (volume {:.6}) cannot divide at step {}: {}; reduce the time step, or "
          "let the cell round up longer (fix dcm/growth rounding)",
          STYLE, job.mother.molecule, job.volume, update->ntimestep, d.problem);
    if (!d.converged)
      error->all(FLERR,
                 "{}: the sub-simulation of cell {} at step {} is not in balance after {} "
                 "iterations: largest force {:.3} of its scale, tolerance {:.3}; raise maxiter "
                 "({}) or tolerance",
                 STYLE, job.mother.molecule, update->ntimestep, d.iterations, d.residual,
                 settings.tolerance, settings.maxiter);
  }
}

/* ----------------------------------------------------------------------
   faces of a daughter take the region of the mother's face they lie on, those at the division plane
   are new surface: lateral. Empty if the mother is lateral all over
------------------------------------------------------------------------- */

std::vector<int> FixDCMDivision::regions_of(const Job &job, const std::vector<Vec3> &x)
{
  const auto &mother = job.mother.region;
  std::vector<int> regions;
  if (std::all_of(mother.begin(), mother.end(), [](int region) {
        return region == AtomVecDCM::LATERAL;
      }))
    return regions;
  const dcm::Envelope envelope(job.mother.mesh);
  for (const auto &v : job.round->mesh.faces) {
    const Vec3 mid = (x[v[0]] + x[v[1]] + x[v[2]]) / 3.0;
    const auto nearest = envelope.nearest(mid, -1);
    const double from_plane = std::fabs(job.plane.normal.dot(mid - job.plane.point));
    regions.push_back(from_plane < std::fabs(nearest.distance) ? AtomVecDCM::LATERAL
                                                               : mother[nearest.face]);
  }
  return regions;
}

/* ----------------------------------------------------------------------
   two deformable daughters at rest as round cells of half the mother's rest volume
------------------------------------------------------------------------- */

void FixDCMDivision::insert(DCMCellSurgery &surgery, Job &job)
{
  const auto &top = *job.round;
  DCMCellBuilder::Deformable daughter;
  auto types = job.mother.types;
  daughter.mask = job.mother.masks;
  for (auto *const role : DCMRole::of(lmp))
    role->daughters_take(cell->cells().find(job.mother.molecule), types, daughter.mask);
  daughter.volume0 = 0.5 * job.mother.volume0;
  for (int k = 0; k < 3; k++) daughter.v[k] = job.mother.v[k];

  tagint molecule[2];
  for (int side = 0; side < 2; side++) {
    const dcm::Daughter &d = job.daughter[side];
    DCMCellBuilder::set_round_rest(top, d.rest * job.rest, daughter);
    daughter.molecule = molecule[side] = cell->change_cells().new_molecule();
    daughter.x = d.mesh.nodes;
    for (Vec3 &x : daughter.x) x += job.origin;
    daughter.region = regions_of(job, d.mesh.nodes);
    surgery.insert(types, top, daughter);
    iterations += d.iterations;
    outside = std::max(outside, d.outside / dcm::ball_radius(d.volume));
    quality = std::min(quality, d.quality);
  }
  ndcm++;
  write_log(job.mother, job.plane.normal, molecule, job.volume, job.daughter[0].volume,
            job.daughter[1].volume, job.daughter[0].iterations + job.daughter[1].iterations);
  cell->change_cells().divided(job.mother.molecule, molecule[0], molecule[1], job.volume);
  if (types.center == job.mother.types.center) return;
  for (const tagint it : molecule)
    cell->change_cells().retyped(it, types.center, daughter.mask.center);
}

/* ----------------------------------------------------------------------
   two spheres of half the volume that reach no farther than the mother did
------------------------------------------------------------------------- */

void FixDCMDivision::insert_spheres(DCMCellSurgery &surgery, const DCMCellSurgery::Cell &mother)
{
  const Vec3 axis = axis_of(mother);
  DCMCellBuilder::Sphere daughter;
  daughter.mask = mother.masks.center;
  daughter.radius = mother.radius / std::cbrt(2.0);
  for (int k = 0; k < 3; k++) daughter.v[k] = mother.v[k];

  tagint molecule[2];
  for (int side = 0; side < 2; side++) {
    daughter.molecule = molecule[side] = cell->change_cells().new_molecule();
    daughter.x = mother.x + (side == 0 ? 1.0 : -1.0) * (mother.radius - daughter.radius) * axis;
    surgery.insert(mother.types, daughter);
  }
  ncbm++;
  sisters.push_back({molecule[0], molecule[1], cell->cells().time()});
  const double volume = dcm::ball_volume(mother.radius);
  write_log(mother, axis, molecule, volume, 0.5 * volume, 0.5 * volume, 0);
  cell->change_cells().divided(mother.molecule, molecule[0], molecule[1], volume);
}
