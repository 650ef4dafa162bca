/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_volume.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_compat.h"
#include "dcm_deck_check.h"
#include "dcm_unknowns.h"
#include "law/curvature.h"
#include "law/mean_stress.h"
#include "law/stiffness.h"
#include "law/volume.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/volume";
static constexpr double NOT_NAMED = -1.0;
static constexpr int NSUM = 7;    // sums per node of the Voronoi form

/* ----------------------------------------------------------------------
   fix ID group dcm/volume [FILE name1..nameN] [K_V v] [form gradient|voronoi]
------------------------------------------------------------------------- */

FixDCMVolume::FixDCMVolume(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), parameters(lmp, STYLE, {"K_V"}), voronoi(false)
{
  AtomVecDCM::require(lmp, STYLE);

  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"form"});
  parameters.parse(args, atom->ntypes);
  while (args.next())
    if (!parameters.parse_keyword(args)) voronoi = args.choose({"gradient", "voronoi"}) == 1;

  scalar_flag = 1;
  extscalar = 1;
  vector_flag = 1;
  size_vector = 3;
  extvector = 0;
  global_freq = 1;
  energy_global_flag = 1;
  virial_global_flag = virial_peratom_flag = 1;
  thermo_energy = thermo_virial = 1;
  comm_reverse = voronoi ? NSUM : 3;
}

/* ---------------------------------------------------------------------- */

int FixDCMVolume::setmask()
{
  return PRE_REVERSE | MIN_PRE_REVERSE;
}

/* ---------------------------------------------------------------------- */

void FixDCMVolume::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  sum = cell->change_cells().contribute("pressure");
  parameters.resolve();
  read_moduli();
}

/* ----------------------------------------------------------------------
   only types of deformable cells need a K_V, so that one list of names can serve all styles;
   cells of the others may come later, and then it is missed
------------------------------------------------------------------------- */

void FixDCMVolume::read_moduli()
{
  const auto centers = AtomVecDCM::types_holding(lmp, {AtomVecDCM::CENTER}, groupbit);
  K_V.assign(atom->ntypes + 1, NOT_NAMED);
  for (int i = 1; i <= atom->ntypes; i++) {
    if (!parameters.used(i)) continue;
    K_V[i] = centers[i] ? parameters.get(i, "K_V", DCMParameters::POSITIVE)
                        : parameters.get(i, "K_V", DCMParameters::NONNEGATIVE, 0.0);
  }
}

/* ---------------------------------------------------------------------- */

void FixDCMVolume::setup_pre_reverse(int eflag, int vflag)
{
  for (const auto &fix : modify->get_fix_by_style("^dcm/volume$")) {
    const auto *const other = dynamic_cast<FixDCMVolume *>(fix);
    if (!other || other == this) continue;
    for (const int c : cell->cells().all_deformable()) {
      const auto &it = cell->cells()[c];
      if (acts_on(it) && other->acts_on(it))
        error->all(FLERR,
                   "{}: fixes {} and {} both act on cell {}, its pressure would count twice; give "
                   "them different groups or cell types",
                   STYLE, id, other->id, it.molecule);
    }
  }
  pre_reverse(eflag, vflag);
}

bool FixDCMVolume::acts_on(const DCMCellTable::Cell &it) const
{
  return K_V[it.type] != NOT_NAMED && (it.mask & groupbit);
}

/* ----------------------------------------------------------------------
   forces on ghost vertices too: added before they are summed, and after the pair
   style has summed its virial, in which one face's unbalanced force has no place
------------------------------------------------------------------------- */

void FixDCMVolume::pre_reverse(int /*eflag*/, int vflag)
{
  v_init(vflag);
  cell_pressures();
  if (!anyone) return;
  if (voronoi)
    voronoi_forces();
  else
    gradient_forces();
}

/* ----------------------------------------------------------------------
   pressures of the cells that have atoms here
------------------------------------------------------------------------- */

void FixDCMVolume::cell_pressures()
{
  const auto &table = cell->cells();
  if (checked != table.changes()) {    // all ranks hold all cells and find the same error
    checked = table.changes();
    for (const int c : table.all_deformable())
      if (acts_on(table[c]) && K_V[table[c].type] == 0.0)
        parameters.get(table[c].type, "K_V", DCMParameters::POSITIVE);
  }
  const auto &rows = table.all_deformable();
  anyone = std::any_of(rows.begin(), rows.end(), [&](int c) {
    return acts_on(table[c]);
  });
  if (pressure.size() < (size_t) table.size()) pressure.resize(table.size());
  for (const int c : table.deformable()) {
    const auto &it = table[c];
    pressure[c] = 0.0;
    if (!acts_on(it)) continue;
    const double K = K_V[it.type];
    if (!(it.volume > 0.0) || !std::isfinite(it.volume) || !(it.volume0 > 0.0))
      error->one(
          FLERR,
          "{}: cell {} has volume {} (rest volume {}) at step {}: it is inverted, or "
          "its coordinates are not finite; reduce the time step, or check the forces on this "
          "cell and its start shape",
          STYLE, it.molecule, it.volume, it.volume0, update->ntimestep);
    const double p = dcm::pressure(K, it.volume, it.volume0);
    pressure[c] = p;
    (*sum)(c) += p;
  }
  cell->change_cells().contributed();

  // of the cells whose centers are here: summed over all processes when somebody asks

  constexpr double MOST = std::numeric_limits<double>::infinity();
  energy = total = count = 0.0;
  extremes[0] = extremes[1] = -MOST;
  summed = false;
  for (const int c : cell->owned_cells()) {
    const auto &it = table[c];
    if (!acts_on(it)) continue;
    energy += dcm::pressure_energy(K_V[it.type], it.volume, it.volume0);
    total += pressure[c];
    count += 1.0;
    extremes[0] = std::max(extremes[0], -pressure[c]);
    extremes[1] = std::max(extremes[1], pressure[c]);
  }
}

void FixDCMVolume::sum_up()
{
  if (summed) return;
  summed = true;
  double sums[3] = {energy, total, count};
  MPI_Allreduce(sums, all, 3, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, extremes, 2, MPI_DOUBLE, MPI_MAX, world);
}

/* ----------------------------------------------------------------------
   virial of a force on a vertex, about its cell's center: independent of the
   center because the forces on a cell sum to zero
------------------------------------------------------------------------- */

void FixDCMVolume::tally(int i, const double *xi, const double *center, const double *fi)
{
  double d[3] = {xi[0] - center[0], xi[1] - center[1], xi[2] - center[2]};
  dcm_minimum_image(domain, d[0], d[1], d[2]);
  double v[6] = {d[0] * fi[0], d[1] * fi[1], d[2] * fi[2],
                 d[0] * fi[1], d[0] * fi[2], d[1] * fi[2]};
  v_tally(i, v);
}

/* ----------------------------------------------------------------------
   p dV/dr: a third of p times the area vector of each face
------------------------------------------------------------------------- */

void FixDCMVolume::gradient_forces()
{
  double **x = atom->x;
  double **f = atom->f;

  for (int n = 0; n < cell->nowned(); n++) {
    const FixDCMCell::Face &face = cell->faces()[n];
    const double p = face.cell < 0 ? 0.0 : pressure[face.cell];
    if (p == 0.0) continue;
    const int *v = face.v;
    const dcm::Vec3 third =
        dcm::face_pressure_force(p, dcm::vec(x[v[0]]), dcm::vec(x[v[1]]), dcm::vec(x[v[2]]));
    for (int k = 0; k < 3; k++) dcm::vec(f[v[k]]) += third;
    if (evflag)
      for (int k = 0; k < 3; k++)
        tally(face.atom, x[v[k]], cell->cells()[face.cell].x, third.data());
  }
}

/* ----------------------------------------------------------------------
   p S N: mixed Voronoi area and outward curvature direction of each node
------------------------------------------------------------------------- */

void FixDCMVolume::voronoi_forces()
{
  double **x = atom->x;
  double **f = atom->f;

  width = NSUM;
  node.assign((size_t) NSUM * (atom->nlocal + atom->nghost), 0.0);
  for (int n = 0; n < cell->nowned(); n++) {
    const FixDCMCell::Face &face = cell->faces()[n];
    if (face.cell < 0 || pressure[face.cell] == 0.0) continue;
    const int *v = face.v;
    const dcm::FaceCurvature part =
        dcm::face_curvature_parts(dcm::vec(x[v[0]]), dcm::vec(x[v[1]]), dcm::vec(x[v[2]]));
    for (int k = 0; k < 3; k++) {
      double *const sums = &node[(size_t) NSUM * v[k]];
      sums[0] += part.area[k];
      dcm::vec(sums + 1) += part.laplace[k];
      dcm::vec(sums + 4) += part.normal[k];
    }
  }
  comm->reverse_comm(this);

  for (int i = 0; i < atom->nlocal; i++) {
    const double *const sums = &node[(size_t) NSUM * i];
    if (sums[0] == 0.0) continue;

    // the curvature vector points inward where the surface is concave, and nowhere where flat

    const int c = cell->cell_of(i);
    const auto laplace = dcm::vec(sums + 1), normal = dcm::vec(sums + 4);
    const double along = laplace.dot(normal);
    dcm::Vec3 direction = along == 0.0 ? dcm::Vec3(normal) : dcm::Vec3(laplace);
    if (along < 0.0) direction = -direction;
    direction.normalize();
    const dcm::Vec3 fi = dcm::voronoi_pressure_force(pressure[c], sums[0], direction);
    dcm::vec(f[i]) += fi;
    if (evflag) tally(i, x[i], cell->cells()[c].x, fi.data());
  }
}

/* ---------------------------------------------------------------------- */

int FixDCMVolume::pack_reverse_comm(int n, int first, double *buf)
{
  const double *const from = &node[(size_t) width * first];
  std::copy(from, from + (size_t) width * n, buf);
  return width * n;
}

void FixDCMVolume::unpack_reverse_comm(int n, int *list, double *buf)
{
  for (int i = 0, m = 0; i < n; i++)
    for (int k = 0; k < width; k++) node[(size_t) width * list[i] + k] += buf[m++];
}

/* ----------------------------------------------------------------------
   K_V/V G G^T of each cell, G = dV/dr: of the gradient form of the force; the other form
   differs from it by O(edge^2)
------------------------------------------------------------------------- */

void FixDCMVolume::add_stiffness(dcm::StiffnessSystem &system, DCMUnknowns &unknowns)
{
  if (!anyone) return;
  double **x = atom->x;
  width = 3;
  node.assign((size_t) width * (atom->nlocal + atom->nghost), 0.0);
  for (int n = 0; n < cell->nowned(); n++) {
    const FixDCMCell::Face &face = cell->faces()[n];
    if (face.cell < 0) continue;
    const int *v = face.v;
    const dcm::Vec3 third =
        dcm::face_pressure_force(1.0, dcm::vec(x[v[0]]), dcm::vec(x[v[1]]), dcm::vec(x[v[2]]));
    for (int k = 0; k < 3; k++) dcm::vec(&node[(size_t) width * v[k]]) += third;
  }
  comm->reverse_comm(this, width);

  const auto &table = cell->cells();
  const int field = system.add_field(table.size());
  for (const int c : table.deformable()) {
    const auto &it = table[c];
    if (!acts_on(it)) continue;
    const size_t begin = system.nodes.size();
    for (const int s : unknowns.nodes_of(c)) {
      const double *const g = &node[(size_t) width * unknowns.atom_of(s)];
      system.nodes.push_back({s, {g[0], g[1], g[2]}});
    }
    system.cells.push_back(
        {begin, system.nodes.size(), dcm::pressure_stiffness(K_V[it.type], it.volume), c, field});
  }
}

/* ----------------------------------------------------------------------
   the gradient of the volume by the positions, times these, is the volume in each direction; form
   voronoi has that in the limit of fine meshes
------------------------------------------------------------------------- */

void FixDCMVolume::add_cell_virial(std::vector<double> &virial)
{
  for (const int c : cell->owned_cells())
    dcm::add_pressure_virial(&virial[6 * (size_t) c], pressure[c], cell->cells()[c].volume);
}

/* ----------------------------------------------------------------------
   the pressure that a change of rest volume adds, with the gradients of add_stiffness()
------------------------------------------------------------------------- */

void FixDCMVolume::add_ahead(const std::vector<RestAhead> &ahead, std::vector<double> &forces,
                             DCMUnknowns &unknowns)
{
  const auto &table = cell->cells();
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, STYLE);
  for (int s = 1; s <= unknowns.nowned(); s++) {
    const int i = unknowns.atom_of(s);
    const int row = dcm->kind[i] == AtomVecDCM::NODE ? cell->cell_of(i) : -1;
    if (row < 0 || ahead[row].volume0 == 1.0 || !acts_on(table[row])) continue;
    const double more = K_V[table[row].type] * std::log(ahead[row].volume0);
    dcm::vec(&forces[dcm::STRIDE * (size_t) s]) += more * dcm::vec(&node[(size_t) width * i]);
  }
}

/* ----------------------------------------------------------------------
   energy of all cells acted on
------------------------------------------------------------------------- */

double FixDCMVolume::compute_scalar()
{
  sum_up();
  return all[0];
}

/* ----------------------------------------------------------------------
   mean, lowest and highest pressure of the cells acted on
------------------------------------------------------------------------- */

double FixDCMVolume::compute_vector(int i)
{
  sum_up();
  const double n = all[2];
  if (n == 0.0) return 0.0;
  return i == 0 ? all[1] / n : (i == 1 ? -extremes[0] : extremes[1]);
}

/* ---------------------------------------------------------------------- */

double FixDCMVolume::memory_usage()
{
  return (double) (pressure.capacity() + node.capacity()) * sizeof(double);
}
