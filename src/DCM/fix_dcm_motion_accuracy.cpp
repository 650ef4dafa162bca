/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// fix dcm/motion, keyword accuracy: what it chooses, what it says, and the check of steps against
// half of their length

#include "fix_dcm_motion.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "law/accuracy.h"
#include "force.h"
#include "math_const.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::STRIDE;
using MathConst::MY_4PI;

static const char STYLE[] = "Fix dcm/motion";

/* ----------------------------------------------------------------------
   the keyword stands for dt auto tol X and, unless the deck has it, tolerance
------------------------------------------------------------------------- */

void FixDCMMotion::plan_accuracy()
{
  if (control.tolerance > 0.0)
    error->all(FLERR, "{}: accuracy {} chooses tol of dt auto; leave one of them out", STYLE,
               half.accuracy);
  if (!implicit)
    error->all(FLERR, "{}: accuracy {} chooses the steps, which does not go with scheme explicit",
               STYLE, half.accuracy);
  if (solver.tolerance == 0.0) solver.tolerance = dcm::accuracy_tolerance(half.accuracy);
  if (!automatic) given = update->dt;
  automatic = true;
  find_limits();
}

/* ----------------------------------------------------------------------
   Before the first step: lengths for the cells there are, which stay for all later runs. Rest
   volumes and nodes are known on all processes
------------------------------------------------------------------------- */

void FixDCMMotion::tell_accuracy()
{
  const double A = half.accuracy;
  const bool first = radius == 0.0;
  double sum = 0.0;
  int ncells = 0, fewest = 0;
  for (const auto &one : cell->cells().all()) {
    ncells++;
    sum += std::cbrt(3.0 * one.volume0 / MY_4PI);
    if (one.deformable && (fewest == 0 || one.nnodes < fewest)) fewest = one.nnodes;
  }
  if (ncells == 0) {    // spheres that no style asks for
    double local[2] = {0.0, 0.0}, all[2];
    for (int i = 0; i < atom->nlocal; i++)
      if (dcm->kind[i] == AtomVecDCM::SPHERE) {
        local[0] += atom->radius[i];
        local[1] += 1.0;
      }
    MPI_Allreduce(local, all, 2, MPI_DOUBLE, MPI_SUM, world);
    sum = all[0];
    ncells = (int) all[1];
  }
  if (first && ncells > 0) radius = sum / ncells;
  control.tolerance = dcm::accuracy_step(A, radius);
  half.floor = dcm::accuracy_floor(A, radius);
  if (!first || comm->me != 0) return;

  utils::logmesg(
      lmp,
      "{}: accuracy {:g}, for cells of radius {:.4g}: steps of {:.4g} to {:.4g} that are off by "
      "{:g} of their way and {:.3g} from two of half the length; sudden changes up to "
      "{:.3g}; solver tolerance {:.3g}\n",
      STYLE, A, radius, control.least, control.longest, A, half.floor, control.tolerance,
      solver.tolerance);
  if (fewest == 0) return;
  if (dcm::mesh_error(fewest) > 1.001 * A)
    error->warning(
        FLERR,
        "{}: the mesh does not hold accuracy {:g}: cells of {} nodes leave about {:.2g} in "
        "areas and forces of contacts, {:.0f} nodes would do; steps are chosen for it all "
        "the same",
        STYLE, A, fewest, dcm::mesh_error(fewest), dcm::mesh_nodes(A));
  int dim;
  const auto *const h0 = force->pair ? static_cast<double *>(force->pair->extract("h0", dim))
                                     : nullptr;
  const double edge = cell->mean_edge();
  if (h0 && *h0 > 0.0 && dcm::range_error(*h0, edge) > 1.001 * A)
    error->warning(
        FLERR,
        "{}: the range of adhesion h0 {:.3g} does not hold accuracy {:g} on edges of "
        "{:.3g}: it leaves about {:.2g} in adhering contacts; h0 {:.3g} or edges of {:.3g} "
        "would do",
        STYLE, *h0, A, edge, dcm::range_error(*h0, edge), *h0 * dcm::range_error(*h0, edge) / A,
        edge * A / dcm::range_error(*h0, edge));
}

/* ----------------------------------------------------------------------
   the largest over all cells of a function of two sums: means over the nodes of a deformable cell,
   or of a sphere what it is by itself. terms(s, sums) adds those of slot s
------------------------------------------------------------------------- */

template <class Terms, class Function>
double FixDCMMotion::largest_of_cells(Terms &&terms, Function &&function)
{
  const auto &table = cell->cells();
  cell_means.assign(2 * table.all().size(), 0.0);
  double most = 0.0;
  for (int s = 1; s <= system.nowned; s++) {
    const int i = unknowns.atom_of(s);
    double one[2] = {0.0, 0.0};
    terms(STRIDE * (size_t) s, one);
    if (dcm->kind[i] == AtomVecDCM::SPHERE) {
      most = std::max(most, function(one));
      continue;
    }
    const size_t row = cell->cell_of(i);
    for (int k = 0; k < 2; k++) cell_means[2 * row + k] += one[k] / std::max(1, table[row].nnodes);
  }
  cell->sum_shared(cell_means, 2);
  for (const int row : table.deformable()) most = std::max(most, function(&cell_means[2 * row]));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, world);
  return most;
}

/* ----------------------------------------------------------------------
   change of the velocities against those of the last step: root mean square over the nodes of a
   cell, or of a sphere, where it is largest
------------------------------------------------------------------------- */

double FixDCMMotion::change_of_velocity()
{
  return largest_of_cells(
      [&](size_t n, double *sums) {
        sums[0] = (dcm::vec(&velocity[n]) - dcm::vec(&before[n])).squaredNorm();
      },
      [](const double *sums) {
        return std::sqrt(sums[0]);
      });
}

/* ----------------------------------------------------------------------
   a step of length dt has been solved: solve one of half the length, and compare. Sets the limit of
   the coming steps; a step that is far off becomes the half one. Returns the length of the step
------------------------------------------------------------------------- */

double FixDCMMotion::check_half(double dt)
{
  const auto whole = velocity;
  const auto solution = last;
  const double move = largest_move;
  const int where = slot_move;
  solve_system(0.5 * dt, 0.0);

  const double most = largest_of_cells(
      [&](size_t n, double *sums) {
        sums[0] = (dcm::vec(&whole[n]) - dcm::vec(&velocity[n])).squaredNorm();
        sums[1] = dcm::vec(&whole[n]).squaredNorm();
      },
      [&](const double *sums) {
        return half.excess(dt * std::sqrt(sums[0]), dt * std::sqrt(sums[1]));
      });
  half.take(dt, most);

  if (most > dcm::HalfStep::REJECTED && !control.shortest(dt)) {
    rejected += 1.0;
    error_of_step = 0.25 * dt * change_of_velocity();
    return 0.5 * dt;
  }
  velocity = whole;
  last = solution;
  largest_move = move;
  slot_move = where;
  return dt;
}
