/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/probe,FixDCMProbe);
// clang-format on
#else

#ifndef LMP_FIX_DCM_PROBE_H
#define LMP_FIX_DCM_PROBE_H

#include "dcm_request.h"
#include "fix.h"

#include <vector>

namespace LAMMPS_NS {

// For tests only: asks fix dcm/cell and the pair style for what no shipped style asks for yet, and
// counts what it gets. In every step it sets the region of each face from its atom ID and the step;
// keyword send: are ghosts told?

class FixDCMProbe : public Fix {
 public:
  FixDCMProbe(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void end_of_step() override;
  double compute_vector(int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;

 private:
  enum {    // places in the vector, summed over ranks
    NODES,
    AROUND,    // faces around nodes
    FEWEST,    // nodes with less than five
    EDGES,
    BOTH,         // of them with two different faces that hold both ends
    GHOSTS,       // ghost faces
    STALE,        // of them with a region that is not their owner's
    PAIRS,        // of cells in contact
    PAIR_AREA,    // sum over them
    STIFFNESS,    // v K v of contacts, with the cell of molecule 1 moving along x by 1
    SHARES,       // processes that a deformable cell has atoms on, summed over cells
    DIFFER,       // cells whose shared or owned sum is not the same, bit for bit, on all of these
    ELSEWHERE,    // deformable cells without atoms on a process, summed over processes
    BLANK,        // of them those whose volume is no number there before it is asked for
    UNEQUAL,      // cells whose measures then are not the same on all processes
    NVALUES
  };
  class FixDCMCell *cell;
  class PairDCMContact *contact;
  DCMRequest<> adjacency, stiffness;
  DCMRequest<int> partners;
  bool send, stiff;
  int every;    // contact areas per pair of cells
  double values[NVALUES];
  std::vector<double> owner;    // process of every owned and ghost atom

  double contact_stiffness();
  void look_at_sharing();
  std::vector<char> unequal(const std::vector<double> &, int, const std::vector<char> &) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
