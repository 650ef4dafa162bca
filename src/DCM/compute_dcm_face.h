/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(dcm/face,DCMTimedCompute<ComputeDCMFace>);
// clang-format on
#else

#ifndef LMP_COMPUTE_DCM_FACE_H
#define LMP_COMPUTE_DCM_FACE_H

#include "compute.h"
#include "dcm_request.h"
#include "dcm_timed.h"

#include <vector>

namespace LAMMPS_NS {

// Values of the faces of deformable cells, stored with the face atoms. Other atoms have 0.
// Doc page compute_dcm_face.

class ComputeDCMFace : public Compute {
 public:
  ComputeDCMFace(class LAMMPS *, int, char **);
  ~ComputeDCMFace() override;
  void init() override;
  void compute_peratom() override;
  double memory_usage() override;

 private:
  // in the order of their names
  enum Value { AREA, CONTACT_AREA, FREE_AREA, STRESS, CURVATURE, NX, NY, NZ, REGION, MARK };

  std::vector<int> columns;    // a Value each
  int nmax;

  struct DCMAtoms *dcm;
  class FixDCMCell *cell;
  class PairDCMContact *contact;    // nullptr: no such pair style
  class DCMRole *marks;             // nullptr: nothing marks faces
  DCMRequest<> curvature, stress;

  bool wants(int) const;
  double face_value(int, int) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
