/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "dcm_tracer_faces.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "fix_dcm_cell.h"

using namespace LAMMPS_NS;

void DCMTracerFaces::attach(Atom *_atom, DCMAtoms *_dcm, FixDCMCell *_cell,
                            const std::vector<int> *_shut)
{
  atom = _atom;
  dcm = _dcm;
  cell = _cell;
  shut = _shut;
}

void DCMTracerFaces::forget()
{
  const size_t n = cell->faces().size();
  if (faces.size() != n) {
    faces.resize(n);
    loaded.assign(n, now);
  }
  now++;
}

void DCMTracerFaces::load(int f)
{
  loaded[f] = now;
  dcm::TracerFace &face = faces[f];
  const auto &from = cell->faces()[f];
  const int i = from.atom;
  face.known = from.whole();
  if (!face.known) return;
  for (int k = 0; k < 3; k++) face.corner[k] = dcm::vec(atom->x[from.v[k]]);
  face.measure();
  face.tag = atom->tag[i];
  face.cell = atom->molecule[i];
  face.open = dcm->region[i] == AtomVecDCM::APICAL;
  face.shut = !shut->empty() && (*shut)[i];
}
