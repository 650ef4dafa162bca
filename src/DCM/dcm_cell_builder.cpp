/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_cell_builder.h"

#include "atom.h"
#include "atom_vec.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "law/hinge.h"
#include "law/volume.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::Vec3;

/* ---------------------------------------------------------------------- */

DCMCellBuilder::DCMCellBuilder(LAMMPS *lmp, const std::string &_asking, bool _strict) :
    Pointers(lmp), asking(_asking), strict(_strict), dcm(AtomVecDCM::require(lmp, _asking))
{
}

/* ----------------------------------------------------------------------
   check the mesh, bring it to mean position 0 and size 1, share out bonds and
   hinges so that no node stores many
------------------------------------------------------------------------- */

DCMCellBuilder::Topology DCMCellBuilder::prepare(dcm::Mesh mesh, bool equal_volume) const
{
  const std::string problem = dcm::check_mesh(mesh);
  if (!problem.empty()) error->all(FLERR, "{}: bad mesh: {}", asking, problem);

  Vec3 mid = Vec3::Zero();
  for (const auto &x : mesh.nodes) mid += x / (double) mesh.nodes.size();
  double reach = 0.0;
  for (auto &x : mesh.nodes) {
    x -= mid;
    reach = std::max(reach, x.norm());
  }
  const double size = equal_volume ? dcm::ball_radius(dcm::volume(mesh)) : reach;
  for (auto &x : mesh.nodes) x /= size;

  Topology top;
  top.mesh = std::move(mesh);
  top.equal_volume = equal_volume;
  top.mid = mid;
  top.scale = size;
  top.hinges = dcm::hinges(top.mesh);
  std::vector<int> stored(top.mesh.nodes.size(), 0);
  for (const auto &hinge : top.hinges) {
    top.owner.push_back(stored[hinge[1]] <= stored[hinge[2]] ? 1 : 2);
    top.slots = std::max(top.slots, ++stored[hinge[top.owner.back()]]);
  }
  return top;
}

/* ---------------------------------------------------------------------- */

void DCMCellBuilder::set_round_rest(const Topology &top, double rest, Deformable &cell)
{
  const auto &x = top.mesh.nodes;
  const double size = std::cbrt(cell.volume0 / dcm::volume(top.mesh));
  cell.l0.clear();
  cell.theta0.clear();
  for (const auto &n : top.hinges) {
    cell.l0.push_back(rest * size * (x[n[2]] - x[n[1]]).norm());
    cell.theta0.push_back(dcm::hinge_angle(x[n[0]], x[n[1]], x[n[2]], x[n[3]]));
  }
}

/* ----------------------------------------------------------------------
   topology slots are fixed once atoms exist; until then they can be made here
------------------------------------------------------------------------- */

void DCMCellBuilder::reserve_slots(int slots)
{
  if (atom->bond_per_atom >= slots && atom->dihedral_per_atom >= slots) return;
  if (atom->natoms > 0)
    error->all(FLERR,
               "{0}: a node needs {1} bond and {1} dihedral slots, there are {2} and {3}; add "
               "'extra/bond/per/atom {1} extra/dihedral/per/atom {1}' to create_box or read_data",
               asking, slots, atom->bond_per_atom, atom->dihedral_per_atom);

  atom->bond_per_atom = std::max(atom->bond_per_atom, slots);
  atom->dihedral_per_atom = std::max(atom->dihedral_per_atom, slots);
  atom->avec->grow(atom->nmax);
}

/* ----------------------------------------------------------------------
   add an atom if it is mine and return its index, else -1
------------------------------------------------------------------------- */

int DCMCellBuilder::create_atom(const double *coord, int type, int kind, tagint tag,
                                tagint molecule, int mask, const double *v)
{
  double x[3] = {coord[0], coord[1], coord[2]};
  imageint image =
      ((imageint) IMGMAX << IMG2BITS) | ((imageint) IMGMAX << IMGBITS) | (imageint) IMGMAX;
  domain->remap(x, image);
  if (strict && !domain->inside(x)) return -1;
  double lamda[3];
  if (domain->triclinic) domain->x2lamda(x, lamda);
  int igx, igy, igz;
  if (comm->coord2proc(domain->triclinic ? lamda : x, igx, igy, igz) != comm->me) return -1;

  const int i = atom->nlocal;
  atom->avec->create_atom(type, x);
  atom->tag[i] = tag;
  atom->molecule[i] = molecule;
  atom->image[i] = image;
  atom->mask[i] = mask;
  for (int k = 0; k < 3; k++) atom->v[i][k] = v[k];
  dcm->kind[i] = kind;
  clear_extra(i);
  return i;
}

/* ----------------------------------------------------------------------
   what fix property/atom adds to atoms begins at 0: it does not set them itself, and values of an
   atom that is gone may stand at this place in memory
------------------------------------------------------------------------- */

void DCMCellBuilder::clear_extra(int i)
{
  for (int k = 0; k < atom->nivector; k++)
    if (atom->ivector[k]) atom->ivector[k][i] = 0;
  for (int k = 0; k < atom->ndvector; k++)
    if (atom->dvector[k]) atom->dvector[k][i] = 0.0;
  for (int k = 0; k < atom->niarray; k++)
    if (atom->iarray[k]) std::fill_n(atom->iarray[k][i], atom->icols[k], 0);
  for (int k = 0; k < atom->ndarray; k++)
    if (atom->darray[k]) std::fill_n(atom->darray[k][i], atom->dcols[k], 0.0);
  if (atom->q_flag) atom->q[i] = 0.0;
  if (atom->rmass_flag) atom->rmass[i] = 0.0;
  if (atom->temperature_flag) atom->temperature[i] = 0.0;
  if (atom->heatflow_flag) atom->heatflow[i] = 0.0;
}

void DCMCellBuilder::create(const Types &type, const Sphere &cell)
{
  const int i = create_atom(cell.x.data(), type.center, AtomVecDCM::SPHERE, cell.tag, cell.molecule,
                            cell.mask, cell.v);
  if (i >= 0) atom->radius[i] = cell.radius;
}

void DCMCellBuilder::create(int type, const Tracer &tracer)
{
  const double rest[3] = {0.0, 0.0, 0.0};
  const int i =
      create_atom(tracer.x.data(), type, AtomVecDCM::TRACER, tracer.tag, 0, tracer.mask, rest);
  if (i >= 0) dcm->vertex[i][0] = tracer.home;
}

/* ----------------------------------------------------------------------
   tags of a cell: center, nodes in mesh order, faces in mesh order
------------------------------------------------------------------------- */

void DCMCellBuilder::create(const Types &type, const Topology &top, const Deformable &cell)
{
  Vec3 center = Vec3::Zero();
  for (const auto &x : cell.x) center += x / (double) cell.x.size();
  const int c = create_atom(center.data(), type.center, AtomVecDCM::CENTER, cell.tag, cell.molecule,
                            cell.mask.center, cell.v);
  if (c >= 0) dcm->volume0[c] = cell.volume0;

  const tagint first = cell.tag + 1, first_face = first + (tagint) cell.x.size();
  std::vector<int> local;
  for (size_t n = 0; n < cell.x.size(); n++)
    local.push_back(create_atom(cell.x[n].data(), type.node, AtomVecDCM::NODE, first + (tagint) n,
                                cell.molecule, cell.mask.node, cell.v));

  for (size_t h = 0; h < top.hinges.size(); h++) {
    std::array<int, 4> n = top.hinges[h];
    if (top.owner[h] == 2) n = {n[3], n[2], n[1], n[0]};    // the same hinge from the other end
    const int i = local[n[1]];
    if (i < 0) continue;
    int m = atom->num_bond[i]++;
    atom->bond_type[i][m] = type.bond;
    atom->bond_atom[i][m] = first + n[2];
    dcm->l0[i][m] = cell.l0[h];
    m = atom->num_dihedral[i]++;
    atom->dihedral_type[i][m] = type.dihedral;
    atom->dihedral_atom1[i][m] = first + n[0];
    atom->dihedral_atom2[i][m] = first + n[1];
    atom->dihedral_atom3[i][m] = first + n[2];
    atom->dihedral_atom4[i][m] = first + n[3];
    dcm->theta0[i][m] = cell.theta0[h];
  }
  for (const int i : local)
    if (i >= 0) dcm->bonded[i] = AtomVecDCM::stamp(atom, i);

  for (size_t f = 0; f < top.mesh.faces.size(); f++) {
    const auto &v = top.mesh.faces[f];
    const Vec3 mid = (cell.x[v[0]] + cell.x[v[1]] + cell.x[v[2]]) / 3.0;
    const tagint tag = first_face + (tagint) f;
    const int i = create_atom(mid.data(), type.face, AtomVecDCM::FACE, tag, cell.molecule,
                              cell.mask.face, cell.v);
    if (i < 0) continue;
    if (!cell.region.empty()) dcm->region[i] = cell.region[f];
    for (int k = 0; k < 3; k++) {
      dcm->vertex[i][k] = first + v[k] - tag;
      atom->radius[i] = std::max(atom->radius[i], (cell.x[v[k]] - mid).norm());
    }
  }
}
