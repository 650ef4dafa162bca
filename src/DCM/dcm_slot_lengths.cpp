/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_slot_lengths.h"

#include "atom.h"
#include "atom_vec_dcm.h"

#include <algorithm>

using namespace LAMMPS_NS;

DCMSlotLengths::DCMSlotLengths(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), dcm(nullptr)
{
}

void DCMSlotLengths::keep_lengths()
{
  kept = true;
  dcm = AtomVecDCM::require(lmp, style);
  restart_peratom = 1;
  create_attribute = 1;    // atoms that come in a run begin with empty slots
  DCMSlotLengths::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
}

DCMSlotLengths::~DCMSlotLengths()
{
  if (!kept) return;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

void DCMSlotLengths::init_lengths()
{
  widen();
  maxexchange = 1 + NSLOT * width;
}

/* ---------------------------------------------------------------------- */

void DCMSlotLengths::grow_arrays(int nmax)
{
  widen();
  slots.resize((size_t) nmax * width);
}

// bond slots per atom may have become more since; then no atom has any yet, or few

void DCMSlotLengths::widen()
{
  const int wanted = atom->bond_per_atom;
  if (wanted <= width) return;
  std::vector<Slot> before;
  before.swap(slots);
  slots.resize((size_t) atom->nmax * wanted);
  for (size_t i = 0; width > 0 && (i + 1) * width <= before.size(); i++)
    std::copy_n(before.begin() + i * width, width, slots.begin() + i * wanted);
  width = wanted;
}

void DCMSlotLengths::copy_arrays(int i, int j, int /*delflag*/)
{
  std::copy_n(slots.begin() + (size_t) i * width, width, slots.begin() + (size_t) j * width);
}

void DCMSlotLengths::set_arrays(int i)
{
  widen();
  std::fill_n(slots.begin() + (size_t) i * width, width, Slot());
}

// slots to be sent: all bonds of the atom, none if none of them is changed

int DCMSlotLengths::nslots(int i) const
{
  const int n = std::min(atom->num_bond[i], width);
  const auto first = slots.begin() + (size_t) i * width;
  return std::any_of(first, first + n,
                     [](const Slot &mine) {
                       return mine.length.factor > 0.0;
                     })
             ? n
             : 0;
}

int DCMSlotLengths::pack_exchange(int i, double *buf)
{
  const int n = nslots(i);
  buf[0] = n;
  for (int m = 0; m < n; m++) {
    const Slot &mine = slot(i, m);
    const double values[NSLOT] = {mine.edge, mine.length.factor, mine.length.base,
                                  mine.length.written};
    std::copy_n(values, NSLOT, buf + 1 + NSLOT * m);
  }
  return 1 + NSLOT * n;
}

int DCMSlotLengths::unpack_exchange(int i, double *buf)
{
  set_arrays(i);
  const int n = (int) buf[0];
  for (int m = 0; m < n; m++) {
    const double *const values = buf + 1 + NSLOT * m;
    slot(i, m) = {values[0], {values[1], values[2], values[3]}};
  }
  return 1 + NSLOT * n;
}

int DCMSlotLengths::pack_restart(int i, double *buf)
{
  buf[0] = size_restart(i);
  return 1 + pack_exchange(i, buf + 1);
}

void DCMSlotLengths::unpack_restart(int i, int nth)
{
  double *extra = atom->extra[i];
  for (int n = 0; n < nth; n++) extra += (int) *extra;
  unpack_exchange(i, extra + 1);
}

int DCMSlotLengths::size_restart(int i)
{
  return 2 + NSLOT * nslots(i);
}

int DCMSlotLengths::maxsize_restart()
{
  return 2 + NSLOT * atom->bond_per_atom;
}
