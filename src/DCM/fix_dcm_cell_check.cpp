/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Checks of fix dcm/cell: are the surfaces whole, closed, outward and small enough for the box?

#include "fix_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_compat.h"
#include "dcm_text.h"
#include "law/vector.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "irregular.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

/* ----------------------------------------------------------------------
   a face without all its vertices: too few ghosts, or the node is gone
------------------------------------------------------------------------- */

void FixDCMCell::missing_vertex(int i, tagint vertex)
{
  const double cutoff = comm->get_comm_cutoff(), need = 2.0 * atom->radius[i] + neighbor->skin;
  if (comm->nprocs > 1 && cutoff < need)
    return fault(atom->tag[i],
                 fmt::format("vertex {} of face {} (cell {}) is not known to this rank at step {}: "
                             "the ghost cutoff {:.4} is below an edge length; set 'comm_modify "
                             "cutoff {:.4}'",
                             vertex, atom->tag[i], atom->molecule[i], update->ntimestep, cutoff,
                             need));
  fault(atom->tag[i],
        fmt::format("vertex {} of face {} (cell {}) does not exist at step {}: {}", vertex,
                    atom->tag[i], atom->molecule[i], update->ntimestep,
                    vertex < 1
                        ? "atom IDs were changed by 'reset_atoms id' before fix dcm/cell was "
                          "defined, which vertices of faces do not follow; leave it out"
                        : "it was deleted (delete whole cells only), is missing in the data file, "
                          "was given another ID ('reset_atoms id' does not know the vertices of "
                          "faces), or was lost through a fixed boundary (use 'boundary s' or p, or "
                          "reduce the timestep)"));
}

/* ----------------------------------------------------------------------
   atoms at a rebuild that are not what they should be
------------------------------------------------------------------------- */

static const char *const KINDS[] = {"atom", "sphere", "center", "node", "face", "tracer"};

void FixDCMCell::wrong_vertex(int face, int vertex)
{
  const int kind = dcm->kind[vertex];
  fault(atom->tag[face],
        fmt::format("face {} of cell {} has vertex {}, which is a {} of cell {} at step {}; a face "
                    "has three nodes of its own cell: correct the data file or the molecule IDs, "
                    "and leave 'reset_atoms' out, which vertices of faces do not follow",
                    atom->tag[face], atom->molecule[face], atom->tag[vertex],
                    KINDS[kind < 0 || kind > AtomVecDCM::TRACER ? 0 : kind], atom->molecule[vertex],
                    update->ntimestep));
}

void FixDCMCell::wrong_kind(int i)
{
  fault(atom->tag[i],
        fmt::format("atom {} has kind {} at step {}: it was made by a command or fix that does not "
                    "know cells; make cells with create_cells",
                    atom->tag[i], dcm->kind[i], update->ntimestep));
}

void FixDCMCell::fault(tagint tag, const std::string &text)
{
  if (!update->setupflag) error->one(FLERR, "Fix dcm/cell: {}", text);
  if (first_fault.tag == 0 || tag < first_fault.tag) first_fault = {tag, text};
}

void FixDCMCell::report_fault()
{
  if (!update->setupflag) return;
  tagint mine = first_fault.tag ? first_fault.tag : MAXTAGINT, lowest;
  MPI_Allreduce(&mine, &lowest, 1, MPI_LMP_TAGINT, MPI_MIN, world);
  if (lowest == MAXTAGINT) return;
  int rank = mine == lowest ? comm->me : comm->nprocs, teller;    // ghosts are looked at as well
  MPI_Allreduce(&rank, &teller, 1, MPI_INT, MPI_MIN, world);
  std::string text = first_fault.text;
  first_fault = Fault();
  dcm_bcast(world, text, teller);
  error->all(FLERR, "Fix dcm/cell: {}", text);
}

/* ----------------------------------------------------------------------
   a box that changes may get too small for the closest images of a cell's atoms. Cells that fill a
   box of two by two span a little more than half of it, which does no harm in a run
------------------------------------------------------------------------- */

// of box lengths, how far a node may be from its center in a run. Closest images end at one half: a
// node that gets past it between two checks is seen on the other side, as far from the center,
// unless it moves by twice the margin in a step

static constexpr double REACH = 0.45;

void FixDCMCell::check_width()
{
  double **x = atom->x;
  for (int f = 0; f < nowned_faces; f++) {
    const Face &face = face_list[f];
    const auto &cell = table[face.cell];
    Vec3 d = vec(x[face.v[0]]) - vec(cell.x);
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    for (int k = 0; k < 3; k++)
      if (domain->periodicity[k] && std::fabs(d[k]) > REACH * domain->prd[k])
        error->one(FLERR,
                   "Fix dcm/cell: cell {} spans {:.3} of a periodic box length at step {}; it must "
                   "not come near itself around a box that shrinks: keep the box at least two "
                   "cells wide",
                   cell.molecule, 2.0 * std::fabs(d[k]) / domain->prd[k], update->ntimestep);
  }
}

/* ----------------------------------------------------------------------
   Where the box follows the atoms, a run may begin in a much smaller one than the deck gave, and
   atoms be far from their process. LAMMPS hands them to the next one only and loses the others.
------------------------------------------------------------------------- */

void FixDCMCell::setup_pre_exchange()
{
  if (comm->nprocs == 1 || domain->nonperiodic != 2) return;
  if (domain->triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  domain->reset_box();
  Irregular irregular(lmp);
  if (comm->layout != LAMMPS_NS::Comm::LAYOUT_TILED && irregular.migrate_check())
    irregular.migrate_atoms(1);
  if (domain->triclinic) domain->lamda2x(atom->nlocal);
}

/* ----------------------------------------------------------------------
   at the start of every run: are these closed, outward surfaces that fit the box?
------------------------------------------------------------------------- */

void FixDCMCell::check_surfaces()
{
  double **x = atom->x;
  const double *const normal = normals();
  const int ncells = table.size();
  std::vector<double> sums(4 * ncells, 0.0), reach(ncells, 0.0);
  double smallest[2] = {1.0, (double) comm->me};
  tagint thin = 0;
  for (int f = 0; f < nowned_faces; f++) {
    const Face &face = face_list[f];
    const auto &cell = table[face.cell];
    vec(&sums[4 * face.cell]) += face_area[f] * vec(&normal[3 * f]);
    const double relative = face_area[f] * cell.nfaces / cell.area;
    if (relative < smallest[0]) {
      smallest[0] = relative;
      thin = atom->tag[face.atom];
    }
    Vec3 d = vec(x[face.v[0]]) - vec(cell.x);
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    for (int k = 0; k < 3; k++)
      if (domain->periodicity[k])
        reach[face.cell] = std::max(reach[face.cell], std::fabs(d[k]) / domain->prd[k]);
  }
  sum(sums, 4);
  if (ncells) MPI_Allreduce(MPI_IN_PLACE, reach.data(), ncells, MPI_DOUBLE, MPI_MAX, world);

  update_all();
  for (const int c : table.all_deformable()) {
    const auto &cell = table[c];
    if (cell.nfaces != 2 * cell.nnodes - 4)
      error->all(FLERR,
                 "Fix dcm/cell: cell {} has {} nodes and {} faces; a closed surface of "
                 "sphere topology has {} faces",
                 cell.molecule, cell.nnodes, cell.nfaces, 2 * cell.nnodes - 4);
    if (vec(&sums[4 * c]).norm() > 1.0e-8 * cell.area)
      error->all(FLERR,
                 "Fix dcm/cell: the surface of cell {} is not closed or some faces are "
                 "flipped: its face area vectors sum to {} of its area",
                 cell.molecule, vec(&sums[4 * c]).norm() / cell.area);
    if (reach[c] > 0.25)
      error->all(FLERR,
                 "Fix dcm/cell: cell {} spans {:.3} of a periodic box length; a periodic box "
                 "must be at least two cells wide in every periodic direction",
                 cell.molecule, 2.0 * reach[c]);
  }

  struct {
    double value;
    int rank;
  } least = {smallest[0], comm->me};
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);
  MPI_Bcast(&thin, 1, MPI_LMP_TAGINT, least.rank, world);
  if (least.value < 1.0e-6)
    error->all(FLERR,
               "Fix dcm/cell: face {} is degenerate: its area is {} of its cell's mean face "
               "area; repair the mesh",
               thin, least.value);
}

/* ----------------------------------------------------------------------
   minimizers: faces follow their vertices and pressure, cortex, bending and contact act as in a
   run. Contact derives from no energy, which those with a line search follow.
------------------------------------------------------------------------- */

void FixDCMCell::check_minimize()
{
  for (const char *style : {"^neb$", "^neb/spin$"})
    if (!modify->get_fix_by_style(style).empty())
      error->all(FLERR,
                 "Fix dcm/cell: fix neb moves the atoms of replicas one by one, which tears the "
                 "faces of cells off their vertices; there is no way to use it with cells");
  int any = 0;    // two spheres have an energy
  for (int i = 0; i < atom->nlocal; i++)
    if (dcm->kind[i] == AtomVecDCM::CENTER) any = 1;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
  const std::string style = update->minimize_style;
  const bool damped = utils::strmatch(style, "^fire") || utils::strmatch(style, "^quickmin");
  if (any && !damped && force->pair_match("dcm/contact", 1))
    error->all(FLERR,
               "Fix dcm/cell: min_style {} follows the energy, and contacts of deformable cells "
               "have none; use 'min_style fire' (or quickmin), which follows the forces",
               style);
}
