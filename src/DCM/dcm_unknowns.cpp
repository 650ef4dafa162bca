/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "dcm_unknowns.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "fix_dcm_cell.h"

using namespace LAMMPS_NS;

DCMUnknowns::DCMUnknowns(LAMMPS *lmp, dcm::FrictionSystem &_system, dcm::FrictionComm &_messages) :
    Pointers(lmp), system(_system), messages(_messages),
    dcm(AtomVecDCM::require(lmp, "Fix dcm/motion")), atoms(1, -1)
{
}

bool DCMUnknowns::moves(int i, int groupbit) const
{
  return (dcm->kind[i] == AtomVecDCM::NODE || dcm->kind[i] == AtomVecDCM::SPHERE) &&
         (atom->mask[i] & groupbit);
}

/* ---------------------------------------------------------------------- */

void DCMUnknowns::number(int groupbit, const std::vector<double> &owner)
{
  dcm = AtomVecDCM::require(lmp, "Fix dcm/motion");
  owner_of = owner;
  first_node.clear();
  const int nlocal = atom->nlocal, nghost = atom->nghost;
  slots.assign(nlocal + nghost, FIXED);
  atoms.assign(1, -1);
  for (int i = 0; i < nlocal; i++) {
    if (!moves(i, groupbit)) continue;
    slots[i] = (int) atoms.size();
    atoms.push_back(i);
  }
  system.nowned = system.nall = nowned();

  std::vector<int> known(comm->nprocs, 0);
  for (int i = nlocal; i < nlocal + nghost; i++) {
    if (!moves(i, groupbit)) continue;
    const int j = atom->map(atom->tag[i]);
    if (j < nlocal)
      slots[i] = slots[j];
    else {
      slots[i] = NOT_ASKED;
      known[(int) owner_of[i]]++;
    }
  }
  messages.connect(known);
}

int DCMUnknowns::ask(int i)
{
  const int j = atom->map(atom->tag[i]);    // one slot for all copies
  if (slots[j] == NOT_ASKED) {
    slots[j] = ++system.nall;
    messages.request((int) owner_of[j], atom->tag[j], slots[j]);
  }
  slots[i] = slots[j];
  return slots[i];
}

void DCMUnknowns::send_requests()
{
  messages.update([this](std::int64_t tag) {
    return slots[atom->map((tagint) tag)];
  });
}

/* ----------------------------------------------------------------------
   once after a rebuild, if somebody asks: a counting sort over the cells
------------------------------------------------------------------------- */

void DCMUnknowns::sort_nodes()
{
  const auto *const cell = FixDCMCell::require(lmp, "Fix dcm/motion");
  first_node.assign((size_t) cell->cells().size() + 1, 0);
  const auto row_of = [&](int slot) {
    const int i = atoms[slot];
    return dcm->kind[i] == AtomVecDCM::NODE ? cell->cell_of(i) : -1;
  };
  for (int s = 1; s <= nowned(); s++)
    if (row_of(s) >= 0) first_node[row_of(s) + 1]++;
  for (size_t row = 1; row < first_node.size(); row++) first_node[row] += first_node[row - 1];
  nodes.resize(first_node.back());
  std::vector<int> next(first_node.begin(), first_node.end() - 1);
  for (int s = 1; s <= nowned(); s++)
    if (row_of(s) >= 0) nodes[next[row_of(s)]++] = s;
}

double DCMUnknowns::memory_usage() const
{
  return (double) owner_of.capacity() * sizeof(double) +
         (double) (slots.capacity() + atoms.capacity() + first_node.capacity() + nodes.capacity()) *
             sizeof(int);
}
