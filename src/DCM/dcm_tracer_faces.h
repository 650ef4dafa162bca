/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_TRACER_FACES_H
#define LMP_DCM_TRACER_FACES_H

#include "law/tracer.h"

#include <vector>

namespace LAMMPS_NS {

// The faces of fix dcm/cell as the law of tracers sees them. A face is measured when it is first
// asked for in a step: few of them have tracers near by.

class DCMTracerFaces {
 public:
  // shut: per atom
  void attach(class Atom *, struct DCMAtoms *, class FixDCMCell *, const std::vector<int> *shut);
  void forget();    // faces have moved, or are others

  int size() const { return (int) faces.size(); }
  const dcm::TracerFace &operator[](int f)
  {
    if (loaded[f] != now) load(f);
    return faces[f];
  }
  double memory_usage() const
  {
    return (double) faces.capacity() * sizeof(dcm::TracerFace) +
           (double) loaded.capacity() * sizeof(unsigned);
  }

 private:
  class Atom *atom = nullptr;
  struct DCMAtoms *dcm = nullptr;
  class FixDCMCell *cell = nullptr;
  const std::vector<int> *shut = nullptr;
  std::vector<dcm::TracerFace> faces;
  std::vector<unsigned> loaded;    // `now` of the time when it was measured
  unsigned now = 0;

  void load(int);
};

}    // namespace LAMMPS_NS

#endif
