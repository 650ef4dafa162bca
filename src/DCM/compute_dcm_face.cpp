/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "compute_dcm_face.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_deck_check.h"
#include "dcm_role.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "memory.h"
#include "pair_dcm_contact.h"
#include "update.h"
#include "utils.h"

#include <algorithm>

using namespace LAMMPS_NS;

static const std::string STYLE = "Compute dcm/face";

// as enum Value

static const std::vector<std::string> NAMES = {
    "area", "contact_area", "free_area", "stress", "curvature", "nx", "ny", "nz", "region", "mark"};

/* ----------------------------------------------------------------------
   compute ID group dcm/face value1 value2 ...
------------------------------------------------------------------------- */

ComputeDCMFace::ComputeDCMFace(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), nmax(0), dcm(nullptr), cell(nullptr), contact(nullptr), marks(nullptr)
{
  AtomVecDCM::require(lmp, STYLE);
  const std::string known = utils::join_words(NAMES, " ");
  if (narg < 4) error->all(FLERR, "{}: no values given; known: {}", STYLE, known);
  for (int iarg = 3; iarg < narg; iarg++) {
    const auto found = std::find(NAMES.begin(), NAMES.end(), arg[iarg]);
    if (found == NAMES.end())
      error->all(FLERR, "{}: unknown value {}; known: {}", STYLE, arg[iarg], known);
    columns.push_back((int) (found - NAMES.begin()));
  }

  peratom_flag = 1;
  size_peratom_cols = columns.size() == 1 ? 0 : (int) columns.size();
}

ComputeDCMFace::~ComputeDCMFace()
{
  memory->destroy(vector_atom);
  memory->destroy(array_atom);
}

bool ComputeDCMFace::wants(int value) const
{
  return std::find(columns.begin(), columns.end(), value) != columns.end();
}

/* ----------------------------------------------------------------------
   ask the owners of curvature and stress for them; the pair style forgets at
   every start of a run
------------------------------------------------------------------------- */

void ComputeDCMFace::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::FACE});
  if (wants(CURVATURE)) curvature = cell->request_curvature();

  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (contact && wants(STRESS)) stress = contact->request_stress();
  marks = DCMRole::marker_of(lmp);
  if (wants(MARK) && !marks)
    error->all(FLERR,
               "{}: value mark needs a style that marks faces; add a fix dcm/osmosis or "
               "remove the value",
               STYLE);
  for (int value : columns)
    if (!contact && (value == CONTACT_AREA || value == FREE_AREA || value == STRESS))
      error->all(FLERR, "{}: value {} needs pair_style dcm/contact; add it or remove the value",
                 STYLE, NAMES[value]);
}

/* ----------------------------------------------------------------------
   one value of the owned face f; contact areas and forces are those of this step,
   summed over ranks by pair_style dcm/contact
------------------------------------------------------------------------- */

double ComputeDCMFace::face_value(int f, int value) const
{
  const FixDCMCell::Face &face = cell->faces()[f];
  const double area = cell->area(f);
  switch (value) {
    case AREA:
      return area;
    case CONTACT_AREA:
      return contact->contact_area()[face.atom];
    case FREE_AREA:
      return std::max(0.0, area - contact->contact_area()[face.atom]);
    case STRESS:
      return area > 0.0 ? contact->normal_force()[face.atom] / area : 0.0;
    case CURVATURE: {
      const int *v = face.v;
      return (cell->curvature(v[0]) + cell->curvature(v[1]) + cell->curvature(v[2])) / 3.0;
    }
    case NX:
    case NY:
    case NZ:
      return cell->normals()[3 * (size_t) f + value - NX];
    case MARK:
      return marks->marked_faces()[face.atom] != 0;
    default:
      return dcm->region[face.atom];
  }
}

/* ---------------------------------------------------------------------- */

void ComputeDCMFace::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  FixDCMCell::check_current(lmp, STYLE, cell);
  if (contact) FixDCMCell::check_current(lmp, STYLE, contact);
  cell->check_atoms(STYLE);
  if (wants(MARK) && DCMRole::marker_of(lmp) != marks)
    error->all(FLERR,
               "{}: the style that marks faces was removed or defined anew since the last step; do "
               "a 'run 0' before using value mark",
               STYLE);
  const int ncolumns = (int) columns.size();
  if (atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(vector_atom);
    memory->destroy(array_atom);
    if (ncolumns == 1)
      memory->create(vector_atom, nmax, "dcm/face:vector_atom");
    else
      memory->create(array_atom, nmax, ncolumns, "dcm/face:array_atom");
  }

  for (int i = 0; i < atom->nlocal; i++) {
    double *const row = ncolumns == 1 ? &vector_atom[i] : array_atom[i];
    const int f = (atom->mask[i] & groupbit) ? cell->face_of(i) : -1;
    for (int k = 0; k < ncolumns; k++) row[k] = f < 0 ? 0.0 : face_value(f, columns[k]);
  }
}

/* ---------------------------------------------------------------------- */

double ComputeDCMFace::memory_usage()
{
  return (double) nmax * columns.size() * sizeof(double);
}
