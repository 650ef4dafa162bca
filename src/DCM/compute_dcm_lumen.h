/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(dcm/lumen,DCMTimedCompute<ComputeDCMLumen>);
// clang-format on
#else

#ifndef LMP_COMPUTE_DCM_LUMEN_H
#define LMP_COMPUTE_DCM_LUMEN_H

#include "compute.h"
#include "dcm_face_graph.h"
#include "dcm_timed.h"
#include "law/lumen.h"

#include <vector>

namespace LAMMPS_NS {

// Lumens: sets of marked faces that are linked by the space in front of them, and their measures.

class ComputeDCMLumen : public Compute {
 public:
  ComputeDCMLumen(class LAMMPS *, int, char **);
  ~ComputeDCMLumen() override;
  void init() override;
  void setup() override;
  void compute_vector() override;
  void compute_array() override;
  void compute_peratom() override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  double memory_usage() override;

 private:
  static constexpr int NVALUES = 6;    // volume, wall, section, closure, cells, circularity

  struct Lumen {
    dcm::LumenSums sums;
    double wall = 0.0;    // area, of the whole faces
    double center[3] = {0.0, 0.0, 0.0};
    int set = 0, ncells = 0;
  };

  int plane;    // normal of the plane of the section, 0 to 2
  double at;    // its place
  bool has_plane, has_slab;
  double lo, hi, least, range;

  class FixDCMCell *cell;
  class PairDCMContact *contact;
  class DCMRole *marks;
  DCMFaceGraph graph;
  std::vector<int> state;       // per atom
  std::vector<Lumen> lumens;    // largest wall first
  std::vector<int> place;       // of each set of the graph among the lumens, -1: too small
  bigint found_at;
  int nmax, nrows;

  void find();
  void find_sets();
  void measure();
  void values(const Lumen &, double *) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
