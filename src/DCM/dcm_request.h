/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_REQUEST_H
#define LMP_DCM_REQUEST_H

#include <memory>
#include <vector>

namespace LAMMPS_NS {

// What is computed only while somebody wants it. Whoever wants it asks in its init(), in every run,
// and keeps the handle: a new one replaces that of the run before, and none outlives its keeper.
//
//   owner:   DCMRequests<> curvature_wanted;    ...    if (curvature_wanted.any()) measure();
//   asker:   DCMRequest<> curvature;            ...    curvature = cell->request_curvature();

template <class Value = char> using DCMRequest = std::shared_ptr<const Value>;

template <class Value = char> class DCMRequests {
 public:
  DCMRequest<Value> add(const Value &value = Value())
  {
    size_t n = 0;
    for (const auto &it : asked)
      if (!it.expired()) asked[n++] = it;
    asked.resize(n);
    auto handle = std::make_shared<const Value>(value);
    asked.push_back(handle);
    return handle;
  }

  bool any() const
  {
    for (const auto &it : asked)
      if (!it.expired()) return true;
    return false;
  }

  // do something with what each of them wants

  template <class Function> void each(Function &&f) const
  {
    for (const auto &it : asked)
      if (const auto value = it.lock()) f(*value);
  }

 private:
  std::vector<std::weak_ptr<const Value>> asked;
};

}    // namespace LAMMPS_NS

#endif
