// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// The friction system of the overdamped equation of motion (S1, "Equation of motion"):
//
//   Gamma_ECM,i v_i + sum_edges gamma (v_i - v_j) + sum_contacts Gamma_cc (v_f - v_g) = F_i
//
// as a sum of contributed blocks. Every block is symmetric and positive semi-definite by its form,
// and only sees velocity differences, so that the sum conserves momentum; the ECM diagonal alone
// ties the cells to the surroundings.
//
// The isotropic part of all blocks acts alike on x, y and z: merge() sums it into one sparse matrix
// of scalars, of which the upper half is kept. Some ten blocks per node shrink to four entries
// that way. What is left of a block, friction along one direction, stays as it is.
//
// Indices are compact unknowns: slot 0 stands for everything that is fixed (velocity 0), then the
// owned unknowns 1..nowned, then those of other processes. A vector holds 4 numbers per slot, the
// fourth always zero, since processors like to work on four at a time.
// Units: friction coefficients in force * time / length (um, nN, s: nN s/um).

#ifndef DCM_FRICTION_H
#define DCM_FRICTION_H

#include <cmath>
#include <cstddef>
#include <vector>

namespace dcm {

// iso I + along e e^T between i and j, in the form of a graph Laplacian; e a unit vector.
// Edges of the cortex with their dashpot, and pairs of spheres

struct EdgeBlock {
  int i, j;
  double iso, along;
  double e[3];
};

// w w^T (x) [tangential (I - u u^T) + normal u u^T]: friction between two points, each a weighted
// mean of up to three nodes (or one sphere), w = (+wf, -wg), sum(w) = 0; unused slots repeat an
// index with w = 0; u the unit normal of the contact

struct ContactBlock {
  int n[6];
  double w[6];
  double u[3];
  double normal, tangential;
};

// iso I between i and j: the usual cortex edge

struct IsoEdge {
  int i, j;
  double iso;
};

constexpr int STRIDE = 4;    // numbers per slot of a vector

/* ----------------------------------------------------------------------
   y += (the part of a block along its direction) * p; returns p . (that part) p
------------------------------------------------------------------------- */

inline double add_along(const EdgeBlock &b, const double *p, double *y)
{
  const double *pi = p + STRIDE * (std::size_t) b.i, *pj = p + STRIDE * (std::size_t) b.j;
  double *yi = y + STRIDE * (std::size_t) b.i, *yj = y + STRIDE * (std::size_t) b.j;
  double d = 0.0;
  for (int k = 0; k < 3; k++) d += (pi[k] - pj[k]) * b.e[k];
  const double c = b.along * d;
  for (int k = 0; k < 3; k++) yi[k] += c * b.e[k];
  for (int k = 0; k < 3; k++) yj[k] -= c * b.e[k];
  return c * d;
}

inline double add_along(const ContactBlock &b, const double *p, double *y)
{
  double d = 0.0;
  for (int l = 0; l < 6; l++) {
    const double *pl = p + STRIDE * (std::size_t) b.n[l];
    d += b.w[l] * (pl[0] * b.u[0] + pl[1] * b.u[1] + pl[2] * b.u[2]);
  }
  const double c = (b.normal - b.tangential) * d;
  for (int l = 0; l < 6; l++) {
    double *yl = y + STRIDE * (std::size_t) b.n[l];
    for (int k = 0; k < 3; k++) yl[k] += c * b.w[l] * b.u[k];
  }
  return c * d;
}

/* ----------------------------------------------------------------------
   add c e e^T to a symmetric 3x3 matrix kept as xx yy zz xy xz yz
------------------------------------------------------------------------- */

inline void add_symmetric(double *m, double c, const double *e)
{
  m[0] += c * e[0] * e[0];
  m[1] += c * e[1] * e[1];
  m[2] += c * e[2] * e[2];
  m[3] += c * e[0] * e[1];
  m[4] += c * e[0] * e[2];
  m[5] += c * e[1] * e[2];
}

/* ----------------------------------------------------------------------
   add the diagonal 3x3 blocks of the part along the direction to d, 6 numbers per slot
------------------------------------------------------------------------- */

inline void add_diagonal(const EdgeBlock &b, double *d)
{
  for (int n : {b.i, b.j}) add_symmetric(d + 6 * (std::size_t) n, b.along, b.e);
}

inline void add_diagonal(const ContactBlock &b, double *d)
{
  // a node may stand in two slots: an unused slot repeats another, a cell may touch itself
  for (int k = 0; k < 6; k++) {
    double weight = 0.0;
    for (int l = 0; l < 6; l++)
      if (b.n[l] == b.n[k]) weight += b.w[l];
    add_symmetric(d + 6 * (std::size_t) b.n[k], b.w[k] * weight * (b.normal - b.tangential), b.u);
  }
}

/* ----------------------------------------------------------------------
   the blocks of one process and the products with them
------------------------------------------------------------------------- */

class FrictionSystem {
 public:
  int nowned = 0, nall = 0;    // unknowns: owned, owned + those of other processes

  std::vector<double> ecm;    // per slot: scalar diagonal; parts of it may lie on any process
  std::vector<IsoEdge> iso_edges;
  std::vector<EdgeBlock> edges;
  std::vector<ContactBlock> contacts;

  // scalar diagonal of the isotropic part, per slot, this process' share

  std::vector<double> diagonal;

  // to be called when all blocks are there and again after any has changed

  void merge()
  {
    const std::size_t n = (std::size_t) nall + 1;
    directed.clear();
    for (const auto &b : edges)
      if (b.along != 0.0) directed.push_back(b);
    directed_contacts.clear();
    for (const auto &b : contacts)
      if (b.normal != b.tangential) directed_contacts.push_back(b);

    sum_diagonal();
    first.assign(n + 1, 0);
    visit_pairs([this](int i, int, double) {
      first[i + 1]++;
    });
    for (std::size_t i = 0; i < n; i++) first[i + 1] += first[i];
    raw.resize(first[n]);
    fill.assign(first.begin(), first.end() - 1);
    visit_pairs([this](int i, int j, double value) {
      raw[fill[i]++] = {j, value};
    });

    // sum entries of equal row and column; where[j] is the place of column j in this row

    entries.resize(raw.size());
    where.assign(n, -1);
    int total = 0;
    for (std::size_t i = 0; i < n; i++) {
      const int begin = total;
      for (int k = first[i]; k < first[i + 1]; k++) {
        const int j = raw[k].column;
        if (where[j] >= begin) {
          entries[where[j]].value += raw[k].value;
        } else {
          where[j] = total;
          entries[total++] = raw[k];
        }
      }
      first[i] = begin;
    }
    first[n] = total;
    entries.resize(total);
  }

  // is there friction that depends on the direction?

  bool isotropic() const { return directed.empty() && directed_contacts.empty(); }

  // y = A p of this process' blocks; slots of other processes are to be added to their owners.
  // Returns this process' share of p . A p

  double apply(const double *p, double *y) const
  {
    const std::size_t n = (std::size_t) nall + 1;
    double sum[STRIDE] = {0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < n; i++)
      for (int k = 0; k < STRIDE; k++) y[STRIDE * i + k] = diagonal[i] * p[STRIDE * i + k];
    for (std::size_t i = 1; i < n; i++) {
      double pi[STRIDE], yi[STRIDE];
      for (int k = 0; k < STRIDE; k++) pi[k] = p[STRIDE * i + k];
      for (int k = 0; k < STRIDE; k++) yi[k] = y[STRIDE * i + k];
      for (int m = first[i]; m < first[i + 1]; m++) {
        const double value = entries[m].value;
        const double *pj = p + STRIDE * (std::size_t) entries[m].column;
        double *yj = y + STRIDE * (std::size_t) entries[m].column;
        for (int k = 0; k < STRIDE; k++) yi[k] += value * pj[k];
        for (int k = 0; k < STRIDE; k++) yj[k] += value * pi[k];
      }
      for (int k = 0; k < STRIDE; k++) y[STRIDE * i + k] = yi[k];    // complete: columns are > i
      for (int k = 0; k < STRIDE; k++) sum[k] += pi[k] * yi[k];
    }
    double along = 0.0;
    for (const auto &b : directed) along += add_along(b, p, y);
    for (const auto &b : directed_contacts) along += add_along(b, p, y);
    for (int k = 0; k < STRIDE; k++) y[k] = 0.0;
    return sum[0] + sum[1] + sum[2] + along;
  }

  // diagonal 3x3 blocks of A, 6 numbers per slot

  void diagonal_blocks(double *d) const
  {
    const std::size_t n = (std::size_t) nall + 1;
    for (std::size_t i = 0; i < n; i++)
      for (int k = 0; k < 6; k++) d[6 * i + k] = (k < 3) ? diagonal[i] : 0.0;
    for (const auto &b : directed) add_diagonal(b, d);
    for (const auto &b : directed_contacts) add_diagonal(b, d);
    for (int k = 0; k < 6; k++) d[k] = 0.0;
  }

  double memory_usage() const
  {
    return (double) sizeof(IsoEdge) * iso_edges.capacity() +
           (double) sizeof(EdgeBlock) * (edges.capacity() + directed.capacity()) +
           (double) sizeof(ContactBlock) * (contacts.capacity() + directed_contacts.capacity()) +
           (double) sizeof(Entry) * (raw.capacity() + entries.capacity()) +
           (double) sizeof(double) * (ecm.capacity() + diagonal.capacity()) +
           (double) sizeof(int) * (first.capacity() + fill.capacity() + where.capacity());
  }

 private:
  struct Entry {
    int column;
    double value;
  };
  std::vector<int> first;        // per row: its first entry
  std::vector<Entry> entries;    // above the diagonal
  std::vector<Entry> raw;        // before entries of equal place are summed
  std::vector<int> fill, where;
  std::vector<EdgeBlock> directed;
  std::vector<ContactBlock> directed_contacts;

  void sum_diagonal()
  {
    diagonal.assign(ecm.begin(), ecm.end());
    for (const auto &b : iso_edges) {
      diagonal[b.i] += b.iso;
      diagonal[b.j] += b.iso;
    }
    for (const auto &b : edges) {
      diagonal[b.i] += b.iso;
      diagonal[b.j] += b.iso;
    }
    for (const auto &b : contacts)
      for (int k = 0; k < 6; k++) {
        double weight = 0.0;
        for (int l = 0; l < 6; l++)
          if (b.n[l] == b.n[k]) weight += b.w[l];
        diagonal[b.n[k]] += b.tangential * b.w[k] * weight;
      }
    diagonal[0] = 0.0;
  }

  // all pairs i < j of unknowns with the scalar that couples them

  template <class Pair> void visit_pairs(Pair &&pair)
  {
    auto couple = [&pair](int i, int j, double value) {
      if (i < j)
        pair(i, j, value);
      else
        pair(j, i, value);
    };
    for (const auto &b : iso_edges)
      if (b.i > 0 && b.j > 0) couple(b.i, b.j, -b.iso);
    for (const auto &b : edges)
      if (b.i > 0 && b.j > 0 && b.iso != 0.0) couple(b.i, b.j, -b.iso);
    for (const auto &b : contacts)
      for (int k = 1; k < 6; k++) {
        if (b.n[k] == 0 || b.w[k] == 0.0) continue;
        const double weight = b.tangential * b.w[k];
        for (int l = 0; l < k; l++)
          if (b.n[l] > 0 && b.n[l] != b.n[k] && b.w[l] != 0.0)
            couple(b.n[k], b.n[l], weight * b.w[l]);
      }
  }
};

/* ----------------------------------------------------------------------
   inverse of a symmetric 3x3 block; a nearly singular one (two coplanar projected dashpots and
   nothing else) is shifted by a tiny part of its trace: the inverse only preconditions
   false if the block is zero or not finite
------------------------------------------------------------------------- */

inline bool invert_symmetric(const double *m, double *inverse)
{
  const double trace = m[0] + m[1] + m[2];
  if (!(trace > 0.0) || !std::isfinite(trace)) return false;
  const double shift = 1e-10 * trace;
  const double a = m[0] + shift, b = m[1] + shift, c = m[2] + shift;
  const double d = m[3], e = m[4], f = m[5];
  const double ca = b * c - f * f, cd = e * f - d * c, ce = d * f - e * b;
  const double det = a * ca + d * cd + e * ce;
  if (!(det > 0.0)) {    // lost to round-off: fall back to the scalar mean
    for (int k = 0; k < 3; k++) inverse[k] = 3.0 / trace;
    for (int k = 3; k < 6; k++) inverse[k] = 0.0;
    return true;
  }
  const double s = 1.0 / det;
  inverse[0] = s * ca;
  inverse[1] = s * (a * c - e * e);
  inverse[2] = s * (a * b - d * d);
  inverse[3] = s * cd;
  inverse[4] = s * ce;
  inverse[5] = s * (d * e - a * f);
  return true;
}

}    // namespace dcm

#endif
