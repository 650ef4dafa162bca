/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#ifndef LMP_DCM_SLOTS_H
#define LMP_DCM_SLOTS_H

#include "atom.h"
#include "error.h"
#include "neighbor.h"
#include "pointers.h"
#include "update.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// bits of a number spread over all others (splitmix64)

inline uint64_t dcm_mix(uint64_t z)
{
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

// Atom::map() with an array does not look whether an ID is one

inline int dcm_index_of(Atom *atom, tagint tag)
{
  return tag < 1 || tag > atom->map_tag_max ? -1 : atom->map(tag);
}

// Rest lengths and angles are state of the slot in which an atom stores a bond or dihedral. This
// finds the slot of every entry of neighbor's list, which NTopo fills in the order of atoms and
// slots, leaving out what is switched off or belongs to another style of a hybrid one.

class DCMSlots : protected Pointers {
 public:
  struct Stored {
    int owner, type;    // columns of the list: the atom that stores it, and its type
    const int *count;
    int *const *types;
    std::vector<std::pair<int, tagint *const *>> tags;    // column, and the ID stored for it
  };

  // asking: for messages; what: bonds or dihedrals
  DCMSlots(class LAMMPS *lmp, const std::string &_asking, const std::string &_what) :
      Pointers(lmp), asking(_asking), what(_what), lastcall(-1), lastncalls(-1)
  {
  }

  // the slot of entry n
  int operator[](int n) const { return slot[n]; }

  bool stale(int nlist) const
  {
    return neighbor->lastcall != lastcall || neighbor->ncalls != lastncalls ||
           nlist != (int) slot.size();
  }
  // lists are rebuilt in setup, possibly at the same step: call it in init_style()
  void forget() { lastcall = lastncalls = -1; }

  // see(entry, slot) is called for each, to give a rest value to one that has none
  template <class See> void match(int **list, int nlist, const Stored &stored, See see);

  double memory_usage() const { return (double) slot.capacity() * sizeof(int); }

 private:
  std::string asking, what;
  std::vector<int> slot;
  bigint lastcall, lastncalls;
};

template <class See> void DCMSlots::match(int **list, int nlist, const Stored &stored, See see)
{
  auto same = [&](const int *entry, int i, int m) {
    if (entry[stored.owner] != i || entry[stored.type] != stored.types[i][m]) return false;
    for (const auto &it : stored.tags)
      if (atom->tag[entry[it.first]] != it.second[i][m]) return false;
    return true;
  };
  slot.resize(nlist);
  int n = 0;
  for (int i = 0; i < atom->nlocal && n < nlist; i++)
    for (int m = 0; m < stored.count[i] && n < nlist; m++) {
      if (!same(list[n], i, m)) continue;
      see(list[n], m);
      slot[n++] = m;
    }
  if (n != nlist)
    error->one(FLERR,
               "{}: {} of {} {} of the neighbor list are not stored with the atoms; another style "
               "must have changed the list or the {} at step {}",
               asking, nlist - n, nlist, what, what, update->ntimestep);
  lastcall = neighbor->lastcall;
  lastncalls = neighbor->ncalls;
}

}    // namespace LAMMPS_NS

#endif
