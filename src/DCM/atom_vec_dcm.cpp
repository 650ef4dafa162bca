/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "atom_vec_dcm.h"

#include "atom.h"
#include "comm.h"
#include "dcm_slots.h"
#include "dcm_text.h"
#include "error.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>

using namespace LAMMPS_NS;

// The arrays must outlive the atom style: ~AtomVec frees them through the addresses registered in
// Atom::peratom, and a restart or replicate makes a second style for the same Atom. So they live
// in one struct per Atom that is never freed, registered once and re-registered in place.

static DCMAtoms *arrays_of(Atom *atom)
{
  static std::map<Atom *, std::unique_ptr<DCMAtoms>> all;
  auto &entry = all[atom];
  if (!entry) entry = std::make_unique<DCMAtoms>();
  return entry.get();
}

static void forget_peratom(Atom *atom, const std::string &name)
{
  auto &list = atom->peratom;
  list.erase(std::remove_if(list.begin(), list.end(),
                            [&name](const Atom::PerAtom &item) {
                              return item.name == name;
                            }),
             list.end());
}

/* ---------------------------------------------------------------------- */

AtomVecDCM::AtomVecDCM(LAMMPS *lmp) : AtomVec(lmp)
{
  molecular = Atom::MOLECULAR;
  bonds_allow = dihedrals_allow = 1;
  mass_type = PER_TYPE;

  atom->molecule_flag = 1;
  atom->radius_flag = 1;

  // a cell's atoms follow each other from their creation on, which is the order the loops want;
  // spatial sorting would tear cells apart and change the order of sums after a restart

  atom->sortfreq = 0;

  data = arrays_of(atom);
  *data = DCMAtoms();

  for (const char *name : {"dcm_kind", "dcm_region", "dcm_vertex", "dcm_volume0", "dcm_l0",
                           "dcm_theta0", "dcm_bonded"})
    forget_peratom(atom, name);
  const int tagtype = (sizeof(tagint) == 8) ? Atom::BIGINT : Atom::INT;
  atom->add_peratom("dcm_kind", &data->kind, Atom::INT, 0);
  atom->add_peratom("dcm_region", &data->region, Atom::INT, 0);
  atom->add_peratom("dcm_vertex", &data->vertex, tagtype, 3);
  atom->add_peratom("dcm_volume0", &data->volume0, Atom::DOUBLE, 0);
  atom->add_peratom_vary("dcm_l0", &data->l0, Atom::DOUBLE, &atom->bond_per_atom, &atom->num_bond);
  atom->add_peratom_vary("dcm_theta0", &data->theta0, Atom::DOUBLE, &atom->dihedral_per_atom,
                         &atom->num_dihedral);
  atom->add_peratom("dcm_bonded", &data->bonded, Atom::BIGINT, 0);

  // order of fields in a string does not matter, except in fields_data_atom & fields_data_vel

  // clang-format off
  fields_grow = {"molecule", "radius", "num_bond", "bond_type", "bond_atom", "num_dihedral",
    "dihedral_type", "dihedral_atom1", "dihedral_atom2", "dihedral_atom3", "dihedral_atom4",
    "nspecial", "special", "dcm_kind", "dcm_region", "dcm_vertex", "dcm_volume0", "dcm_l0",
    "dcm_theta0", "dcm_bonded"};
  fields_copy = fields_grow;
  fields_border = {"molecule", "radius", "dcm_kind", "dcm_region", "dcm_vertex"};
  fields_border_vel = fields_border;
  fields_exchange = fields_grow;
  fields_restart = {"molecule", "radius", "num_bond", "bond_type", "bond_atom", "num_dihedral",
    "dihedral_type", "dihedral_atom1", "dihedral_atom2", "dihedral_atom3", "dihedral_atom4",
    "dcm_kind", "dcm_region", "dcm_vertex", "dcm_volume0", "dcm_l0", "dcm_theta0"};
  fields_create = {"molecule", "radius", "num_bond", "num_dihedral", "nspecial", "dcm_kind",
    "dcm_region", "dcm_vertex", "dcm_volume0", "dcm_bonded"};
  fields_data_atom = {"id", "molecule", "type", "dcm_kind", "radius", "x", "dcm_vertex",
    "dcm_region", "dcm_volume0"};
  fields_data_vel = {"id", "v"};
  // clang-format on

  setup_fields();
}

/* ----------------------------------------------------------------------
   mark rest lengths and angles of all slots as not set: whoever adds a bond
   or dihedral sets them, else the styles take the shape at the first setup
------------------------------------------------------------------------- */

void AtomVecDCM::init_slots(int i)
{
  for (int m = 0; m < atom->bond_per_atom; m++) data->l0[i][m] = UNSET_L0;
  for (int m = 0; m < atom->dihedral_per_atom; m++) data->theta0[i][m] = UNSET_THETA0;
}

// read_data adds the slots after the atoms, once it has counted bonds and dihedrals

void AtomVecDCM::grow_pointers()
{
  for (int i = 0; i < atom->nmax; i++) {
    const bool exists = i < atom->nlocal;
    for (int m = exists ? atom->num_bond[i] : 0; m < atom->bond_per_atom; m++)
      data->l0[i][m] = UNSET_L0;
    for (int m = exists ? atom->num_dihedral[i] : 0; m < atom->dihedral_per_atom; m++)
      data->theta0[i][m] = UNSET_THETA0;
  }
}

void AtomVecDCM::create_atom_post(int ilocal)
{
  init_slots(ilocal);
}

/* ----------------------------------------------------------------------
   vertices are stored as tag differences, so that an ID offset applied to
   the whole cell (read_data add append) keeps them valid
------------------------------------------------------------------------- */

void AtomVecDCM::data_atom_post(int ilocal)
{
  const tagint tag = atom->tag[ilocal];
  const int kind = data->kind[ilocal];
  if (kind < SPHERE || kind > TRACER)
    error->one(FLERR, "Atom style dcm: atom {} has kind {}, must be {} to {}", tag, kind,
               (int) SPHERE, (int) TRACER);
  if (data->region[ilocal] < 0 || data->region[ilocal] >= NREGION)
    error->one(FLERR, "Atom style dcm: atom {} has region {}, must be 0 to {}", tag,
               data->region[ilocal], NREGION - 1);
  if (!(atom->radius[ilocal] >= 0.0) || (kind == SPHERE && atom->radius[ilocal] == 0.0))
    error->one(FLERR,
               "Atom style dcm: atom {} has radius {}; it must be positive for a sphere and "
               "not negative otherwise",
               tag, atom->radius[ilocal]);
  if (kind == CENTER && !(data->volume0[ilocal] > 0.0))
    error->one(FLERR, "Atom style dcm: cell center {} has rest volume {}, must be positive", tag,
               data->volume0[ilocal]);

  if (kind == FACE) {
    for (int k = 0; k < 3; k++) {
      if (data->vertex[ilocal][k] <= 0)
        error->one(FLERR, "Atom style dcm: face {} has vertex ID {}, must be positive", tag,
                   data->vertex[ilocal][k]);
      data->vertex[ilocal][k] -= tag;
    }
  } else if (kind == TRACER) {
    for (int k = 0; k < 3; k++)
      if (data->vertex[ilocal][k] < 0)
        error->one(
            FLERR,
            "Atom style dcm: tracer {} has {} {}, must not be negative (home: molecule ID of "
            "the cell it is in, 0 outside; host and place on it: 0 unless it is caught)",
            tag,
            k == HOME   ? "home"
            : k == HOST ? "host"
                        : "place on its host",
            data->vertex[ilocal][k]);
    if (atom->molecule[ilocal] != 0)
      error->one(
          FLERR,
          "Atom style dcm: tracer {} has molecule ID {}, must be 0: it is no part of a cell; "
          "the cell it is in is its home, in the place of the first vertex",
          tag, atom->molecule[ilocal]);
  }
  atom->num_bond[ilocal] = 0;
  atom->num_dihedral[ilocal] = 0;
  atom->nspecial[ilocal][0] = 0;
  atom->nspecial[ilocal][1] = 0;
  atom->nspecial[ilocal][2] = 0;
  data->bonded[ilocal] = 0;
  init_slots(ilocal);
}

// also called for each atom that replicate makes, before it gets its ID

void AtomVecDCM::unpack_restart_init(int ilocal)
{
  data->bonded[ilocal] = stamp(atom, ilocal);
}

/* ----------------------------------------------------------------------
   in a restart file each atom has a checksum behind it, so that a damaged one is refused
------------------------------------------------------------------------- */

static double checksum_of(const double *buf, int n)
{
  return ubuf((int64_t) dcm_checksum(buf, n * sizeof(double))).d;
}

int AtomVecDCM::size_restart()
{
  return AtomVec::size_restart() + atom->nlocal;
}

int AtomVecDCM::pack_restart(int i, double *buf)
{
  const int n = AtomVec::pack_restart(i, buf);
  buf[0] = n + 1;
  buf[n] = checksum_of(buf, n);
  return n + 1;
}

int AtomVecDCM::unpack_restart(double *buf)
{
  // length, x, id, type, mask, image, v: what the buffer holds at least

  const int n = (int) buf[0] - 1;
  double sum = 0.0;
  if (n >= 11) sum = checksum_of(buf, n);
  if (n < 11 || memcmp(&sum, &buf[n], sizeof(double)) != 0)
    error->one(FLERR,
               "Atom style dcm: an atom in the restart file is damaged, or written by a version of "
               "the package without checksums; use an earlier restart file, or start from a data "
               "file");
  buf[0] = n;    // what is left at the end belongs to fixes
  const int read = AtomVec::unpack_restart(buf);
  buf[0] = n + 1;
  return read + 1;
}

// num_bond counts the new bond already

void AtomVecDCM::data_bonds_post(int m, int num_bond, tagint, tagint, tagint)
{
  data->l0[m][num_bond - 1] = UNSET_L0;
}

/* ----------------------------------------------------------------------
   vertices in the data file are absolute tags
------------------------------------------------------------------------- */

void AtomVecDCM::pack_data_pre(int ilocal)
{
  if (data->kind[ilocal] != FACE) return;
  for (int k = 0; k < 3; k++) data->vertex[ilocal][k] += atom->tag[ilocal];
}

void AtomVecDCM::pack_data_post(int ilocal)
{
  if (data->kind[ilocal] != FACE) return;
  for (int k = 0; k < 3; k++) data->vertex[ilocal][k] -= atom->tag[ilocal];
}

/* ----------------------------------------------------------------------
   names for compute property/atom
------------------------------------------------------------------------- */

static const std::vector<std::string> PROPERTIES = {"kind",    "region",  "volume0", "vertex1",
                                                    "vertex2", "vertex3", "home",    "host"};
static constexpr int FIRST_VERTEX = 3, FIRST_TRACER = 6;

int AtomVecDCM::property_atom(const std::string &name)
{
  auto found = std::find(PROPERTIES.begin(), PROPERTIES.end(), name);
  return found == PROPERTIES.end() ? -1 : (int) (found - PROPERTIES.begin());
}

void AtomVecDCM::pack_property_atom(int index, double *buf, int nvalues, int groupbit)
{
  const int *mask = atom->mask;
  int n = 0;
  for (int i = 0; i < atom->nlocal; i++, n += nvalues) {
    buf[n] = 0.0;
    if (!(mask[i] & groupbit)) continue;
    if (index == 0)
      buf[n] = data->kind[i];
    else if (index == 1)
      buf[n] = data->region[i];
    else if (index == 2)
      buf[n] = data->volume0[i];
    else if (index < FIRST_TRACER && data->kind[i] == FACE)
      buf[n] = (double) (data->vertex[i][index - FIRST_VERTEX] + atom->tag[i]);
    else if (index >= FIRST_TRACER && data->kind[i] == TRACER)
      buf[n] = (double) data->vertex[i][index - FIRST_TRACER];
  }
}

/* ---------------------------------------------------------------------- */

DCMAtoms *AtomVecDCM::require(LAMMPS *lmp, const std::string &asking)
{
  if (!lmp->atom->style_match("dcm"))
    lmp->error->all(FLERR, "{} needs atom_style dcm; the atom style is {}", asking,
                    lmp->atom->atom_style ? lmp->atom->atom_style : "none");
  return arrays_of(lmp->atom);
}

bigint AtomVecDCM::stamp(const Atom *atom, int i)
{
  return stamp(atom, i, atom->num_bond[i], atom->num_dihedral[i]);
}

bigint AtomVecDCM::stamp(const Atom *atom, int i, int nbonds, int ndihedrals)
{
  const tagint tag = atom->tag[i];
  uint64_t hash = 0;
  auto add = [&hash](tagint value) {
    hash = dcm_mix(hash ^ (uint64_t) value);
  };
  for (int m = 0; m < nbonds; m++) {
    add(atom->bond_type[i][m] > 0);
    add(atom->bond_atom[i][m] - tag);
  }
  add(0);
  for (int m = 0; m < ndihedrals; m++) {
    add(atom->dihedral_type[i][m] > 0);
    add(atom->dihedral_atom1[i][m] - tag);
    add(atom->dihedral_atom3[i][m] - tag);
    add(atom->dihedral_atom4[i][m] - tag);
  }
  return (bigint) (hash | 1);
}

std::vector<int> AtomVecDCM::types_holding(LAMMPS *lmp, const std::vector<Kind> &kinds,
                                           int groupbit)
{
  const Atom *const atom = lmp->atom;
  const int *const kind = arrays_of(lmp->atom)->kind;
  std::vector<int> holding(atom->ntypes + 1, 0);
  for (int i = 0; i < atom->nlocal; i++)
    if ((atom->mask[i] & groupbit) && std::find(kinds.begin(), kinds.end(), kind[i]) != kinds.end())
      holding[atom->type[i]] = 1;
  MPI_Allreduce(MPI_IN_PLACE, holding.data(), atom->ntypes + 1, MPI_INT, MPI_MAX, lmp->world);
  return holding;
}
