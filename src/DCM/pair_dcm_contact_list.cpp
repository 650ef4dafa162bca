/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: the neighbor list, sorted by kind

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "fix_neigh_history.h"
#include "law/mesh.h"
#include "law/volume.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using dcm::Vec3;

// of a mesh that loses its order: face_quality(), area over the mean of the cell; icospheres
// have 0.9 and 1.2

static constexpr double LEAST_QUALITY = 0.3, LARGEST_FACE = 1.5;

/* ----------------------------------------------------------------------
   after each rebuild: sort the neighbor list by kind, so that the loops of
   every step neither look up kinds nor meet pairs that never interact
------------------------------------------------------------------------- */

void PairDCMContact::sort_pairs()
{
  check_radii();
  built = neighbor->lastcall;
  if (fix_cell && !fix_cell->cells().all_deformable().empty())
    guessed = 0.0;    // this run made them: keep the guess
  face_pairs.clear();
  faces_of_cell.clear();
  mixed_pairs.clear();
  sphere_pairs.clear();
  face_touch.clear();
  mixed_touch.clear();
  sphere_touch.clear();

  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    if (!types[atom->type[i]].active) continue;
    const int *jlist = list->firstneigh[i];
    const int jnum = list->numneigh[i];
    int *touch = use_history ? fix_history->firstflag[i] : nullptr;
    for (int jj = 0; jj < jnum; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      if (types[atom->type[j]].active) add_pair(i, j, touch ? touch + jj : nullptr);
    }
  }

  used_faces.clear();
  if (!fix_cell) return;
  geometry.resize(fix_cell->faces().size());
  outline.resize(fix_cell->faces().size());
  face_class.assign(fix_cell->faces().size(), -1);
  auto use = [this](int f) {
    if (face_class[f] >= 0) return;
    face_class[f] = 0;
    used_faces.push_back(f);
  };
  for (const auto &pair : face_pairs) {
    use(pair.f);
    use(pair.g);
  }
  for (const auto &pair : mixed_pairs) use(pair.i);

  const auto &faces = fix_cell->faces();
  for (int f : used_faces) {
    const int *v = faces[f].v;
    if (v[0] >= 0 && v[1] >= 0 && v[2] >= 0) continue;
    error->one(
        FLERR,
        "Pair style dcm/contact: a vertex of face {} (cell {}) lies beyond the ghost cutoff "
        "at step {}; nodes must be known {:.4} away: set 'comm_modify cutoff {:.4}' or, with "
        "mode multi, this cutoff for the atom types of nodes",
        atom->tag[faces[f].atom], atom->molecule[faces[f].atom], update->ntimestep, own_cutoff,
        own_cutoff);
  }
}

/* ----------------------------------------------------------------------
   the two faces stand in the order of their IDs, so that a pair is computed
   in the same way on whatever rank
------------------------------------------------------------------------- */

void PairDCMContact::add_pair(int i, int j, int *touch)
{
  const int ki = dcm->kind[i], kj = dcm->kind[j];
  if (atom->molecule[i] == atom->molecule[j]) return;
  if (ki == AtomVecDCM::FACE && kj == AtomVecDCM::FACE) {
    if (atom->tag[i] > atom->tag[j]) std::swap(i, j);
    face_pairs.push_back({fix_cell->face_of(i), fix_cell->face_of(j)});
    if (use_history && set.history) face_touch.push_back(touch);
  } else if (ki == AtomVecDCM::SPHERE && kj == AtomVecDCM::SPHERE) {
    if (atom->tag[i] > atom->tag[j]) std::swap(i, j);
    sphere_pairs.push_back({i, j});
    sphere_touch.push_back(touch);
  } else if (ki == AtomVecDCM::FACE && kj == AtomVecDCM::SPHERE) {
    mixed_pairs.push_back({fix_cell->face_of(i), j});
    if (use_history && set.history) mixed_touch.push_back(touch);
  } else if (ki == AtomVecDCM::SPHERE && kj == AtomVecDCM::FACE) {
    mixed_pairs.push_back({fix_cell->face_of(j), i});
    if (use_history && set.history) mixed_touch.push_back(touch);
  }
}

/* ----------------------------------------------------------------------
   a face or sphere larger than what the list was built for may miss partners
------------------------------------------------------------------------- */

void PairDCMContact::check_radii()
{
  for (int i = 0; i < atom->nlocal; i++) {
    const TypeInfo &info = types[atom->type[i]];
    const int kind = dcm->kind[i];
    if (kind != AtomVecDCM::FACE && kind != AtomVecDCM::SPHERE) continue;
    if (!info.used) continue;
    const char *const name = kind == AtomVecDCM::FACE ? "face" : "sphere";
    if (info.kind && info.kind != kind)
      error->one(FLERR,
                 "Pair style dcm/contact: atom {} is a {} but its type {} held atoms of another "
                 "kind when the run started; give each kind atom types of its own",
                 atom->tag[i], name, atom->type[i]);
    if (kind == AtomVecDCM::FACE && !fix_cell)
      error->one(FLERR, "Pair style dcm/contact: face {} appeared without a fix dcm/cell",
                 atom->tag[i]);
    if (kind == AtomVecDCM::FACE ? !expect_faces : !use_history)
      error->one(FLERR,
                 "Pair style dcm/contact: {} {} of cell {} appeared at step {}, in a run that "
                 "started without any and without a fix that makes cells, such as dcm/division or "
                 "dcm/convert; start a new run once it is there",
                 name, atom->tag[i], atom->molecule[i], update->ntimestep);
  }

  // the list holds pairs of cells up to the sum of two radii: the largest of each type and of
  // another cell count, so that a stretched cell among others as they were loses nothing

  const int nall = atom->nlocal + atom->nghost;
  const auto counts = [&](int i) {
    return dcm->kind[i] == AtomVecDCM::FACE || dcm->kind[i] == AtomVecDCM::SPHERE;
  };
  std::vector<int> first(atom->ntypes + 1, -1);
  std::vector<double> second(atom->ntypes + 1, 0.0);
  for (int i = 0; i < nall; i++) {
    int &largest = first[atom->type[i]];
    if (counts(i) && (largest < 0 || atom->radius[i] > atom->radius[largest])) largest = i;
  }
  for (int i = 0; i < nall; i++) {
    const int t = atom->type[i];
    if (counts(i) && atom->molecule[i] != atom->molecule[first[t]])
      second[t] = std::max(second[t], atom->radius[i]);
  }
  for (int s = 1; s <= atom->ntypes; s++)
    for (int t = 1; t <= atom->ntypes; t++) {
      if (first[s] < 0 || first[t] < 0 || !types[s].used || !types[t].used) continue;
      const double one = atom->radius[first[s]];
      const double sum = one + (s == t ? second[t] : atom->radius[first[t]]);
      const double limit = types[s].promise + types[t].promise;
      if (sum > limit && one > types[s].promise) fail_radius(first[s], sum, limit);
    }
}

// what to look for: a sound face that has grown with its cell, or a mesh that loses its order;
// by the faces of the cell that are known here

std::string PairDCMContact::shape_of(int i) const
{
  const auto *const *const x = atom->x;
  double quality = 1.0, own = 0.0, all = 0.0;
  int n = 0;
  for (const auto &face : fix_cell->faces()) {
    if (atom->molecule[face.atom] != atom->molecule[i] || !face.whole()) continue;
    const Vec3 a = dcm::vec(x[face.v[0]]), b = dcm::vec(x[face.v[1]]), c = dcm::vec(x[face.v[2]]);
    const double area = dcm::face_area_vector(a, b, c).norm();
    all += area;
    n++;
    if (face.atom != i) continue;
    own = area;
    quality = dcm::face_quality(a, b, c);
  }
  if (own == 0.0) return "";
  const double ratio = own * n / all;
  return fmt::format(quality < LEAST_QUALITY || ratio > LARGEST_FACE
                         ? "its quality is {:.2}, its area {:.3} of the mean of its cell: the mesh "
                           "loses its order, look for what pulls at it, or reduce the time "
                           "step; if it is to be so, "
                         : "it has a sound shape (quality {:.2}) and {:.3} of the mean area of "
                           "its cell, which has grown or is stretched: ",
                     quality, ratio);
}

void PairDCMContact::fail_radius(int i, double sum, double limit)
{
  const TypeInfo &info = types[atom->type[i]];
  const bool face = dcm->kind[i] == AtomVecDCM::FACE;
  const double growth = set.growth > 0.0 ? set.growth : face ? FACE_GROWTH : sphere_growth;
  const bool minimizing =
      update->whichflag == 2;    // min_style fire limits all moves but the first
  error->one(FLERR,
             "Pair style dcm/contact: the {} {} of cell {} has grown to radius {:.4} at step {}, "
             "beyond the {:.4} that the neighbor list is laid out for, and with another the sum "
             "{:.4}, beyond {:.4}; {}{}continue from before with a larger growth: "
             "'pair_style dcm/contact ... growth {:.4}' and the same pair_coeff",
             face ? "face" : "sphere", atom->tag[i], atom->molecule[i], atom->radius[i],
             update->ntimestep, info.promise, sum, limit,
             minimizing ? fmt::format("minimize with a smaller timestep than {:.4}, ", update->dt)
                        : "",
             face ? shape_of(i) : "", 1.25 * growth);
}
