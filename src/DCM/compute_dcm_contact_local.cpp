/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "compute_dcm_contact_local.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_allgather.h"
#include "dcm_deck_check.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static const std::string STYLE = "Compute dcm/contact/local";

// clang-format off
const std::vector<ComputeDCMContactLocal::Value> ComputeDCMContactLocal::VALUES = {
    {"molecule1", [](const Partner &it) { return (double) it.molecule; }},
    {"molecule2", [](const Partner &it) { return (double) it.other; }},
    {"area", [](const Partner &it) { return it.area; }},
    {"force", [](const Partner &it) { return std::hypot(it.force[0], it.force[1], it.force[2]); }},
    {"fx", [](const Partner &it) { return it.force[0]; }},
    {"fy", [](const Partner &it) { return it.force[1]; }},
    {"fz", [](const Partner &it) { return it.force[2]; }},
    {"normal", [](const Partner &it) { return it.normal; }}};
// clang-format on

/* ----------------------------------------------------------------------
   compute ID group dcm/contact/local value1 value2 ...
------------------------------------------------------------------------- */

ComputeDCMContactLocal::ComputeDCMContactLocal(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), nmax(0), cell(nullptr), contact(nullptr)
{
  AtomVecDCM::require(lmp, STYLE);
  if (narg < 4) error->all(FLERR, "{}: no values given; known: {}", STYLE, known());
  for (int iarg = 3; iarg < narg; iarg++) {
    const std::string name = arg[iarg];
    const auto found = std::find_if(VALUES.begin(), VALUES.end(), [&name](const Value &value) {
      return name == value.name;
    });
    if (found == VALUES.end())
      error->all(FLERR, "{}: unknown value {}; known: {}", STYLE, name, known());
    columns.push_back(&*found);
  }

  local_flag = 1;
  size_local_rows = 0;
  size_local_cols = columns.size() == 1 ? 0 : (int) columns.size();
  timeflag = 1;    // LAMMPS notes the steps in which somebody is going to read it
}

ComputeDCMContactLocal::~ComputeDCMContactLocal()
{
  memory->destroy(vector_local);
  memory->destroy(array_local);
}

std::string ComputeDCMContactLocal::known()
{
  std::string names;
  for (const auto &value : VALUES) names += std::string(names.empty() ? "" : " ") + value.name;
  return names;
}

/* ---------------------------------------------------------------------- */

void ComputeDCMContactLocal::init()
{
  AtomVecDCM::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER, AtomVecDCM::SPHERE});
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (!contact)
    error->all(FLERR, "{} needs pair_style dcm/contact; add it or remove the compute", STYLE);
  partners = contact->request_partners(this);
  cell = FixDCMCell::find(lmp);
}

/* ----------------------------------------------------------------------
   molecule IDs of the cells with this group bit whose centers or spheres are
   owned here, sorted
------------------------------------------------------------------------- */

std::vector<tagint> ComputeDCMContactLocal::owned_cells(int bit) const
{
  const int *const kind = AtomVecDCM::require(lmp, STYLE)->kind;
  std::vector<tagint> molecules;
  for (int i = 0; i < atom->nlocal; i++)
    if ((kind[i] == AtomVecDCM::CENTER || kind[i] == AtomVecDCM::SPHERE) && (atom->mask[i] & bit))
      molecules.push_back(atom->molecule[i]);
  std::sort(molecules.begin(), molecules.end());
  return molecules;
}

/* ----------------------------------------------------------------------
   the pair style has the same list of pairs on all processes; whoever owns the
   first cell has the row. Members of the group may be owned anywhere.
------------------------------------------------------------------------- */

void ComputeDCMContactLocal::find_rows()
{
  const auto has = [](const std::vector<tagint> &list, tagint molecule) {
    return std::binary_search(list.begin(), list.end(), molecule);
  };
  const int everybody = group->bitmask[0];
  const auto mine = owned_cells(everybody);
  std::vector<tagint> members;
  if (groupbit != everybody) {
    members = dcm_allgather(owned_cells(groupbit), world);
    std::sort(members.begin(), members.end());
  }
  rows.clear();
  for (const auto &pair : contact->partners()) {
    if ((pair.area == 0.0 && pair.normal == 0.0) || !has(mine, pair.molecule)) continue;
    if (groupbit == everybody || has(members, pair.molecule) || has(members, pair.other))
      rows.push_back(&pair);
  }
}

/* ---------------------------------------------------------------------- */

void ComputeDCMContactLocal::compute_local()
{
  invoked_local = update->ntimestep;
  FixDCMCell::check_current(lmp, STYLE, contact);
  if (cell) {
    FixDCMCell::check_current(lmp, STYLE, cell);
    cell->check_atoms(STYLE);
  }
  if (contact->partners_step() != update->ntimestep)
    error->all(FLERR,
               "{}: contacts of step {} were not recorded, since nothing had announced that it "
               "would read them; read them by a dump, a fix or thermo output, or do a 'run 0'",
               STYLE, update->ntimestep);
  find_rows();

  const int nrows = (int) rows.size(), ncolumns = (int) columns.size();
  size_local_rows = nrows;
  if (nrows > nmax) {
    nmax = nrows;
    memory->destroy(vector_local);
    memory->destroy(array_local);
    if (ncolumns == 1)
      memory->create(vector_local, nmax, "dcm/contact/local:vector_local");
    else
      memory->create(array_local, nmax, ncolumns, "dcm/contact/local:array_local");
  }
  for (int n = 0; n < nrows; n++)
    for (int k = 0; k < ncolumns; k++)
      (ncolumns == 1 ? vector_local[n] : array_local[n][k]) = columns[k]->of(*rows[n]);
}

/* ---------------------------------------------------------------------- */

double ComputeDCMContactLocal::memory_usage()
{
  return (double) nmax * columns.size() * sizeof(double) +
         (double) rows.capacity() * sizeof(const Partner *);
}
