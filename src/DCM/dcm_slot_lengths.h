/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_SLOT_LENGTHS_H
#define LMP_DCM_SLOT_LENGTHS_H

#include "fix.h"
#include "law/constriction.h"

#include <vector>

namespace LAMMPS_NS {

// A fix that changes rest lengths of single edges and keeps beside each what it would be without:
// per bond slot, with the atom that stores the bond, through exchanges and restarts.

class DCMSlotLengths : public Fix {
 public:
  DCMSlotLengths(class LAMMPS *, int, char **);
  ~DCMSlotLengths() override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;

 protected:
  struct Slot {
    double edge = 0.0;                                  // what edge it is, for the fix
    dcm::ConstrictedLength length = {0.0, 0.0, 0.0};    // factor 0: the fix leaves it alone
  };

  struct DCMAtoms *dcm;

  // in the constructor of a fix that keeps lengths, and in its init()
  void keep_lengths();
  void init_lengths();

  Slot &slot(int i, int m) { return slots[(size_t) i * width + m]; }
  const Slot &slot(int i, int m) const { return slots[(size_t) i * width + m]; }
  int nslots(int i) const;    // all bonds of the atom, 0: the fix has changed none of them
  double bytes() const { return (double) slots.capacity() * sizeof(Slot); }

 private:
  static constexpr int NSLOT = 4;    // numbers of a Slot in messages

  bool kept = false;
  int width = 0;              // slots per atom
  std::vector<Slot> slots;    // of local atoms

  void widen();
};

}    // namespace LAMMPS_NS

#endif
