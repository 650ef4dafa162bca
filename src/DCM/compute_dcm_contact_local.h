/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(dcm/contact/local,DCMTimedCompute<ComputeDCMContactLocal>);
// clang-format on
#else

#ifndef LMP_COMPUTE_DCM_CONTACT_LOCAL_H
#define LMP_COMPUTE_DCM_CONTACT_LOCAL_H

#include "compute.h"
#include "dcm_request.h"
#include "dcm_timed.h"
#include "pair_dcm_contact.h"

#include <vector>

namespace LAMMPS_NS {

// Pairs of cells in contact, a row each on the process that owns the first cell's center or sphere.
// Doc page compute_dcm_contact_local.

class ComputeDCMContactLocal : public Compute {
 public:
  ComputeDCMContactLocal(class LAMMPS *, int, char **);
  ~ComputeDCMContactLocal() override;
  void init() override;
  void compute_local() override;
  double memory_usage() override;

 private:
  using Partner = PairDCMContact::Partner;
  struct Value {
    const char *name;
    double (*of)(const Partner &);
  };
  static const std::vector<Value> VALUES;

  std::vector<const Value *> columns;
  int nmax;
  class FixDCMCell *cell;    // nullptr: spheres only
  PairDCMContact *contact;
  DCMRequest<Compute *> partners;
  std::vector<const Partner *> rows;

  static std::string known();
  void find_rows();
  std::vector<tagint> owned_cells(int bit) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
