/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_CELL_BINS_H
#define LMP_DCM_CELL_BINS_H

#include "domain.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {

// Which of some points may lie within a distance of a place, periodic images included: the points
// are sorted into bins of at least that size, so that asking about all of them costs as much as
// there are neighbors. For what is done now and then about whole cells.

class DCMCellBins {
 public:
  // x: 3 numbers a point

  DCMCellBins(Domain *_domain, const std::vector<double> &x, double reach) : domain(_domain)
  {
    const int n = (int) x.size() / 3;
    // thickness of the box between its faces, which a tilted one has less of than its edges say
    double thick[3] = {domain->prd[0], domain->prd[1], domain->prd[2]};
    if (domain->triclinic)
      for (int k = 0; k < 3; k++) {
        const double *const h = domain->h_inv;
        const double row[3][3] = {{h[0], h[5], h[4]}, {0.0, h[1], h[3]}, {0.0, 0.0, h[2]}};
        thick[k] =
            1.0 / std::sqrt(row[k][0] * row[k][0] + row[k][1] * row[k][1] + row[k][2] * row[k][2]);
      }
    const int most = std::max(1, (int) std::cbrt((double) n));    // no more bins than points
    for (int k = 0; k < 3; k++)
      count[k] = std::min(most, std::max(1, (int) std::min(1.0e6, thick[k] / reach)));
    first.assign(count[0] * count[1] * count[2] + 1, 0);
    std::vector<int> bin(n);
    for (int i = 0; i < n; i++) {
      int at[3];
      place(&x[3 * (size_t) i], at);
      bin[i] = index(at);
      first[bin[i] + 1]++;
    }
    for (size_t b = 1; b < first.size(); b++) first[b] += first[b - 1];
    std::vector<int> fill(first.begin(), first.end() - 1);
    member.resize(n);
    for (int i = 0; i < n; i++) member[fill[bin[i]]++] = i;
  }

  // points that may be within reach of x, each once, in their order

  std::vector<int> near(const double *x) const
  {
    int at[3];
    place(x, at);
    std::vector<int> found;
    std::vector<int> range[3];
    for (int k = 0; k < 3; k++)
      for (int d = -1; d <= 1; d++) {
        int b = at[k] + d;
        if (domain->periodicity[k]) b = (b + count[k]) % count[k];
        if (b < 0 || b >= count[k]) continue;
        if (std::find(range[k].begin(), range[k].end(), b) == range[k].end()) range[k].push_back(b);
      }
    for (const int a : range[0])
      for (const int b : range[1])
        for (const int c : range[2]) {
          const int cell[3] = {a, b, c}, m = index(cell);
          found.insert(found.end(), member.begin() + first[m], member.begin() + first[m + 1]);
        }
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  Domain *domain;
  int count[3];
  std::vector<int> first, member;    // of each bin

  int index(const int *at) const { return (at[0] * count[1] + at[1]) * count[2] + at[2]; }

  // bin of a place; beyond an open border the outermost one

  void place(const double *x, int *at) const
  {
    double lamda[3], copy[3] = {x[0], x[1], x[2]};
    if (domain->triclinic)
      domain->x2lamda(copy, lamda);
    else
      for (int k = 0; k < 3; k++) lamda[k] = (x[k] - domain->boxlo[k]) / domain->prd[k];
    for (int k = 0; k < 3; k++) {
      if (domain->periodicity[k]) lamda[k] -= std::floor(lamda[k]);
      const double b = std::floor(lamda[k] * count[k]);
      at[k] = (int) std::max(0.0, std::min(count[k] - 1.0, b));
    }
  }
};

}    // namespace LAMMPS_NS

#endif
