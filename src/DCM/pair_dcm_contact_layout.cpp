/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// pair style dcm/contact: what the neighbor list is laid out for, exclusions and ghost cutoff;
// restart files, which keep it

#include "pair_dcm_contact.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_compat.h"
#include "dcm_record.h"
#include "dcm_slots.h"
#include "error.h"
#include "fix_neigh_history.h"
#include "force.h"
#include "modify.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static const std::string STYLE = "Pair style dcm/contact";
static constexpr int RECORD = 5;    // version of the restart record

// the mesh of faces that no run has seen yet may be twice as coarse as was guessed

static constexpr double COARSE = 2.0;

// atom types share bins if their reach differs by less than this factor; size of bins of atoms that
// have no contact, in mean edges: a few nodes in each

static constexpr double SAME_REACH = 1.35, EMPTY_BIN = 2.0;

// bins that a process may have for one collection of types, 256 MB: LAMMPS lays them through the
// box and all room for ghosts, which a single large sphere makes wide

static constexpr double MOST_BINS = 0x1p26, WIDER = 1.25;    // WIDER: else a size once chosen stays

/* ----------------------------------------------------------------------
   mean edge and largest face per type at the start of a run, at a time when no ghosts exist yet:
   vertices that other ranks own are asked from all. The mean is that of cells that are solved for,
   if there are any: a slab that rests or is moved changes nothing of the others
------------------------------------------------------------------------- */

void PairDCMContact::measure_mesh()
{
  mean_edge = largest_edge = 0.0;
  if (!have_faces) return;
  const int nlocal = atom->nlocal;

  std::vector<tagint> mine;
  auto owned = [&](tagint tag) {
    const int j = dcm_index_of(atom, tag);
    return j >= 0 && j < nlocal ? j : -1;
  };
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::FACE) continue;
    for (int k = 0; k < 3; k++) {
      const tagint tag = atom->tag[i] + dcm->vertex[i][k];
      if (owned(tag) < 0) mine.push_back(tag);
    }
  }
  std::vector<int> offsets;
  const auto asked = dcm_allgather(mine, world, &offsets);
  std::vector<double> answer(3 * asked.size(), 0.0);
  for (size_t m = 0; m < asked.size(); m++) {
    const int j = owned(asked[m]);
    if (j >= 0) vec(&answer[3 * m]) = vec(atom->x[j]);
  }
  if (!answer.empty())
    MPI_Allreduce(MPI_IN_PLACE, answer.data(), (int) answer.size(), MPI_DOUBLE, MPI_SUM, world);

  struct Edges {
    tagint molecule;
    double sum, n, solved;
  };
  std::vector<Edges> cells;
  std::vector<double> largest(atom->ntypes + 1, 0.0);
  double sums[2] = {0.0, 0.0};
  const double *next = answer.data() + 3 * (size_t) offsets[comm->me];
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::FACE) continue;
    Vec3 v[3];
    for (int k = 0; k < 3; k++) {
      const int j = owned(atom->tag[i] + dcm->vertex[i][k]);
      if (j >= 0) {
        v[k] = vec(atom->x[j]);
      } else {
        v[k] = vec(next);
        next += 3;
      }
      if (k == 0) continue;
      Vec3 d = v[k] - v[0];
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      v[k] = v[0] + d;
    }
    if (cells.empty() || cells.back().molecule != atom->molecule[i])
      cells.push_back({atom->molecule[i], 0.0, 0.0, 0.0});
    const Vec3 mid = (v[0] + v[1] + v[2]) / 3.0;
    for (int k = 0; k < 3; k++) {
      largest[atom->type[i]] = std::max(largest[atom->type[i]], (v[k] - mid).norm());
      const double edge = (v[(k + 1) % 3] - v[k]).norm();
      sums[0] += edge;
      sums[1] += 1.0;
      cells.back().sum += edge;
      cells.back().n += 1.0;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), atom->ntypes + 1, MPI_DOUBLE, MPI_MAX, world);
  mean_edge = sums[0] / sums[1];

  int solved = 0, moved = 0;
  for (const auto *const role : DCMRole::of(lmp)) {
    solved |= role->solved_bits();
    moved |= role->moved_bits();
  }
  for (int i = 0; i < nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE || !(atom->mask[i] & solved) || (atom->mask[i] & moved))
      continue;
    if (cells.empty() || cells.back().molecule != atom->molecule[i] || cells.back().solved == 0.0)
      cells.push_back({atom->molecule[i], 0.0, 0.0, 1.0});
  }

  // mean edge of the coarsest cell: first one entry a cell of this process, then of all

  auto merge = [](std::vector<Edges> &list) {
    std::stable_sort(list.begin(), list.end(), [](const Edges &a, const Edges &b) {
      return a.molecule < b.molecule;
    });
    size_t n = 0;
    for (const auto &item : list) {
      if (n && list[n - 1].molecule == item.molecule) {
        list[n - 1].sum += item.sum;
        list[n - 1].n += item.n;
        list[n - 1].solved = std::max(list[n - 1].solved, item.solved);
      } else {
        list[n++] = item;
      }
    }
    list.resize(n);
  };
  merge(cells);
  cells = dcm_allgather(cells, world);
  merge(cells);
  double some[2] = {0.0, 0.0};
  bool all = true;
  for (const auto &cell : cells) {
    largest_edge = std::max(largest_edge, cell.sum / cell.n);
    all = all && cell.solved > 0.0;
    some[0] += cell.solved * cell.sum;
    some[1] += cell.solved * cell.n;
  }
  if (!all && some[1] > 0.0) mean_edge = some[0] / some[1];

  for (int t = 1; t <= atom->ntypes; t++)
    if (types[t].kind == AtomVecDCM::FACE) types[t].radius = largest[t];
}

/* ----------------------------------------------------------------------
   the largest radius of each type that the list can hold, and with it bins,
   ghost cutoff and the order of sums: chosen in the first run and kept, also
   over restarts, so that these change nothing while cells grow. Larger only
   if what is there does not fit, or if cells did not grow before.
------------------------------------------------------------------------- */

void PairDCMContact::lay_out()
{
  const int ntypes = atom->ntypes;
  const bool growing = traits_of_deck & GROWS_SPHERES;
  const double face = set.growth > 0.0 ? set.growth : FACE_GROWTH;
  const double sphere = set.growth > 0.0 ? set.growth : growing ? SPHERE_GROWTH : 1.0;
  const double half = 0.5 * range_used;
  const bool begins = sphere > sphere_growth;
  sphere_growth = std::max(sphere, sphere_growth);
  laid_out.resize(ntypes + 1, 0.0);

  auto prepare = [&](int t, double now, double later, bool grows) {
    if (now <= laid_out[t] && !(grows && later > laid_out[t])) return;
    if (laid_out[t] > 0.0 && comm->me == 0)
      utils::logmesg(lmp,
                     "{}: radii of atom type {} up to {:.6g}, neighbor list laid out for {:.6g}"
                     " (before {:.6g})\n",
                     STYLE, t, now, later, laid_out[t]);
    laid_out[t] = later;
  };
  double face_max = 0.0, largest = 0.0;
  for (int t = 1; t <= ntypes; t++) {
    TypeInfo &info = types[t];
    if (info.kind == AtomVecDCM::FACE) {
      prepare(t, info.radius + half, face * info.radius + half, false);
      face_max = std::max(face_max, info.radius);
    } else if (info.kind == AtomVecDCM::SPHERE) {
      prepare(t, info.radius, sphere * info.radius, begins);
    } else {
      continue;
    }
    info.promise = laid_out[t];
    largest = std::max(largest, info.promise);
  }

  // types without atoms: whatever the others hold; if cells change their kind, also a sphere as
  // large as a deformable cell

  for (int t = 1; t <= ntypes; t++) {
    TypeInfo &info = types[t];
    if (!info.active || info.kind) continue;
    info.promise = largest;
    if (!expect_new) continue;
    const double room = std::max(largest, sphere * cell_radius) + half;
    prepare(t, std::max(largest, cell_radius), room, false);
    info.promise = laid_out[t];
  }

  if (bin_edge == 0.0 || face_max > face_reach) bin_edge = mean_edge;
  if (expect_faces && !have_faces && face_reach == 0.0)
    face_reach = face * COARSE * mean_edge / std::sqrt(3.0);
  if (face_max > face_reach) face_reach = face * face_max;
}

/* ----------------------------------------------------------------------
   restart files keep the settings, the lengths derived from the mesh, and
   what the list is laid out for; cell types come again from pair_coeff
------------------------------------------------------------------------- */

void PairDCMContact::write_restart(FILE *fp)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.put(set);
  record.put(law_names()[set.law]);    // a number would mean another law where there are more
  for (double *value : kept()) record.put(*value);
  laid_out.resize(atom->ntypes + 1, 0.0);
  record.put(laid_out);
  record.put(checked);
  record.write_plain(fp);
}

void PairDCMContact::read_restart(FILE *fp)
{
  DCMRecord record(lmp, STYLE, RECORD);
  record.read_plain(fp);
  record.get(set);
  std::string law;
  record.get(law);
  const auto laws = law_names();
  set.law = (int) (std::find(laws.begin(), laws.end(), law) - laws.begin());
  if (set.law == (int) laws.size())
    error->all(FLERR, "{}: the restart file has law {}, this program has: {}", STYLE, law,
               utils::join_words(laws, " "));
  for (double *value : kept()) record.get(*value);
  record.get(laid_out);
  record.get(checked);
}

std::vector<double *> PairDCMContact::kept()
{
  return {&h0_used,  &range_used, &own_cutoff,    &bin_edge,
          &wide_bin, &face_reach, &sphere_growth, &guessed};
}

/* ----------------------------------------------------------------------
   take an exclusion back: LAMMPS only knows how to drop them all, those of the deck as well
------------------------------------------------------------------------- */

void PairDCMContact::allow_types(int s, int t)
{
  int n = 0;
  for (int m = 0; m < neighbor->nex_type; m++) {
    const int a = neighbor->ex1_type[m], b = neighbor->ex2_type[m];
    if (std::min(a, b) == s && std::max(a, b) == t) continue;
    neighbor->ex1_type[n] = a;
    neighbor->ex2_type[n++] = b;
  }
  neighbor->nex_type = n;
}

/* ----------------------------------------------------------------------
   keep what never touches out of the neighbor list
------------------------------------------------------------------------- */

void PairDCMContact::exclude_types()
{
  std::vector<std::pair<int, int>> now;
  for (int n = 0; n < neighbor->nex_type; n++)
    now.emplace_back(std::minmax(neighbor->ex1_type[n], neighbor->ex2_type[n]));
  excluded_here.erase(std::remove_if(excluded_here.begin(), excluded_here.end(),
                                     [&now](const std::pair<int, int> &it) {
                                       return std::find(now.begin(), now.end(), it) == now.end();
                                     }),
                      excluded_here.end());
  for (int s = 1; s <= atom->ntypes; s++)
    for (int t = s; t <= atom->ntypes; t++) {
      const bool excluded = std::find(now.begin(), now.end(), std::make_pair(s, t)) != now.end();
      const bool wanted = types[s].active && types[t].active;
      const auto mine = std::find(excluded_here.begin(), excluded_here.end(), std::make_pair(s, t));
      if (excluded && wanted && mine != excluded_here.end()) {
        allow_types(s, t);    // of an earlier run, before the type lost its atoms or took others
        excluded_here.erase(mine);
      } else if (excluded && wanted)
        error->all(FLERR,
                   "{}: types {} and {} are to interact but excluded from the neighbor list; add "
                   "'neigh_modify exclude none' before the run",
                   STYLE, s, t);
      if (!excluded && !wanted) {
        neighbor->modify_params(fmt::format("exclude type {} {}", s, t));
        excluded_here.emplace_back(s, t);
      }
    }

  bool molecules = false;
  for (int n = 0; n < neighbor->nex_mol; n++)
    if (neighbor->ex_mol_group[n] == 0 && neighbor->ex_mol_intra[n]) molecules = true;
  if (molecules || !expect_faces) return;
  neighbor->modify_params("exclude molecule/intra all");
  own_molecules = true;
}

/* ----------------------------------------------------------------------
   ghosts must reach as far as the list plus the vertices of the last face in
   it. A deck that sets no cutoff gets this one.
------------------------------------------------------------------------- */

void PairDCMContact::set_cutoff()
{
  double pair = 0.0;
  for (const auto &info : types)
    if (info.active) pair = std::max(pair, 2.0 * info.promise);
  const double need = round_up(pair + neighbor->skin + face_reach);
  const double before = own_cutoff;
  own_cutoff = need;
  if (!expect_faces || comm->mode != Comm::SINGLE) return;

  // 0: not set by the deck; equal: set here in an earlier run

  if (comm->cutghostuser == 0.0 || comm->cutghostuser == before) {
    comm->cutghostuser = need;
    if (comm->me == 0 && need != before)
      utils::logmesg(lmp, "{}: ghost cutoff set to {:.6g}\n", STYLE, need);
  } else if (comm->cutghostuser < need) {
    error->all(FLERR,
               "{}: the ghost cutoff {:.6g} is too small, some faces would miss their vertices; "
               "set 'comm_modify cutoff {:.6g}' or remove that command",
               STYLE, comm->cutghostuser, need);
  }
}

/* ----------------------------------------------------------------------
   who has touched whom: spheres always, faces only with branch history
------------------------------------------------------------------------- */

void PairDCMContact::setup_history()
{
  use_history = expect_spheres || set.history;
  if (use_history && comm->style == Comm::TILED)
    error->all(
        FLERR,
        "{}: contact history of {} works with 'comm_style brick' only (fix NEIGH_HISTORY of "
        "LAMMPS cannot communicate in tiled style); use brick, with 'fix balance shift' if ranks "
        "need balancing",
        STYLE, expect_spheres ? "spheres" : "branch history");
  neighbor->add_request(this, use_history ? NeighConst::REQ_SIZE | NeighConst::REQ_HISTORY
                                          : NeighConst::REQ_SIZE);
  if (use_history && !fix_history) {
    fix_history = dynamic_cast<FixNeighHistory *>(
        modify->replace_fix("NEIGH_HISTORY_DCM_DUMMY", "NEIGH_HISTORY_DCM all NEIGH_HISTORY 1", 1));
    fix_history->pair = this;
  }
}

/* ----------------------------------------------------------------------
   what this style has set for itself is not the deck's: the next pair style finds it as it was
------------------------------------------------------------------------- */

void PairDCMContact::take_back()
{
  if (comm->cutghostuser == own_cutoff) comm->cutghostuser = 0.0;
  if (!neighbor) return;
  drop_collections();
  for (const auto &[s, t] : excluded_here) allow_types(s, t);
  for (int n = 0; own_molecules && n < neighbor->nex_mol; n++) {
    if (neighbor->ex_mol_group[n] != 0 || !neighbor->ex_mol_intra[n]) continue;
    for (int m = n + 1; m < neighbor->nex_mol; m++) {
      neighbor->ex_mol_group[m - 1] = neighbor->ex_mol_group[m];
      neighbor->ex_mol_intra[m - 1] = neighbor->ex_mol_intra[m];
    }
    neighbor->nex_mol--;
    own_molecules = false;
  }
}

void PairDCMContact::drop_collections()
{
  if (own_bins) neighbor->binsizeflag = 0;
  own_bins = false;
  if (!own_collections) return;
  neighbor->custom_collection_flag = 0;
  neighbor->ncollections = atom->ntypes;
  own_collections = false;
}

/* ----------------------------------------------------------------------
   the smallest bins of which no process has more than MOST_BINS, in the box as it will be when the
   run begins: a shrink-wrapped one is that of the atoms by then
------------------------------------------------------------------------- */

double PairDCMContact::size_of_bins() const
{
  double length[3], ends[6], part[3];
  std::fill(ends, ends + 6, std::numeric_limits<double>::lowest());
  for (int i = 0; i < atom->nlocal; i++)
    for (int k = 0; k < 3; k++) {
      ends[k] = std::max(ends[k], atom->x[i][k]);
      ends[3 + k] = std::max(ends[3 + k], -atom->x[i][k]);
    }
  MPI_Allreduce(MPI_IN_PLACE, ends, 6, MPI_DOUBLE, MPI_MAX, world);
  for (int k = 0; k < 3; k++)
    part[k] = domain->triclinic ? domain->subhi_lamda[k] - domain->sublo_lamda[k]
                                : (domain->subhi[k] - domain->sublo[k]) / domain->prd[k];
  MPI_Allreduce(MPI_IN_PLACE, part, 3, MPI_DOUBLE, MPI_MAX, world);

  double volume = 1.0;
  for (int k = 0; k < 3; k++) {
    const bool shrinks = domain->boundary[k][0] > 1 && domain->boundary[k][1] > 1;
    const double box = shrinks ? std::max(0.0, ends[k] + ends[3 + k]) : domain->prd[k];
    length[k] = part[k] * box + 2.0 * std::max(own_cutoff, comm->cutghostuser);
    volume *= length[k];
  }
  auto bins = [&length](double size) {    // with those that LAMMPS adds at the ends
    return (length[0] / size + 4.0) * (length[1] / size + 4.0) * (length[2] / size + 4.0);
  };
  double size = std::cbrt(volume / MOST_BINS);
  while (bins(size) > MOST_BINS) size *= 1.05;
  return size;
}

/* ----------------------------------------------------------------------
   neighbor style multi gives every atom type bins of its own, most of them empty. Types of about
   the same reach share theirs here, and those without contact need no list: cutoff 0 looks into
   the own bin only, whose size is free for the smallest collection. Bins that would be too many
   for the memory are made larger, those of all types that would have smaller ones together.
   A deck's own collections stay.
------------------------------------------------------------------------- */

void PairDCMContact::choose_collections()
{
  drop_collections();
  const bool multi = neighbor->style == Neighbor::MULTI;
  if (neighbor->style == Neighbor::NSQ || neighbor->custom_collection_flag || force->pair != this ||
      comm->mode != Comm::SINGLE || neighbor->binsizeflag)
    return;

  std::vector<int> order;
  for (int t = 1; t <= atom->ntypes; t++) order.push_back(t);
  auto reach = [this](int t) {
    return types[t].active ? types[t].promise : 0.0;
  };
  std::stable_sort(order.begin(), order.end(), [&](int s, int t) {
    return reach(s) < reach(t);
  });

  // LAMMPS' own size is half the cutoff

  auto size = [&](int t) {
    const double own = types[t].active ? reach(t) + 0.5 * neighbor->skin : EMPTY_BIN * bin_edge;
    return own > 0.0 ? own : std::numeric_limits<double>::infinity();
  };
  const double least = size_of_bins();
  double smallest = size(order.back());
  for (int t : order) smallest = multi ? std::min(smallest, size(t)) : smallest;
  if (smallest < least && least > WIDER * wide_bin) {
    wide_bin = least;
    if (comm->me == 0)
      utils::logmesg(lmp,
                     "{}: neighbor bins of at least {:.4g}: more and smaller ones would not fit "
                     "into the memory\n",
                     STYLE, wide_bin);
  }

  auto set_bins = [this](double width) {
    own_bins = true;
    neighbor->binsizeflag = 1;
    neighbor->binsize_user = width;
  };
  if (wide_bin > 0.0) set_bins(wide_bin);
  if (!multi) return;

  std::string lists;
  int n = 0;
  double first = -1.0;    // reach of the first type of a collection
  for (int t : order) {
    const bool joins = n > 0 && (reach(t) <= SAME_REACH * first || (n == 1 && size(t) < wide_bin));
    lists += fmt::format("{}{}", joins ? "," : " ", t);
    if (joins) continue;
    first = reach(t);
    n++;
  }
  own_collections = true;
  neighbor->modify_params(fmt::format("collection/type {}{}", n, lists));
  if (wide_bin == 0.0 && reach(order[0]) == 0.0 && bin_edge > 0.0) set_bins(EMPTY_BIN * bin_edge);
}

/* ----------------------------------------------------------------------
   with a deck's own collections, types that never interact with others get a small length of their
   own (0 would make one bin of the box)
------------------------------------------------------------------------- */

double PairDCMContact::init_one(int i, int j)
{
  if (setflag[i][j] == 0) error->all(FLERR, "All pair coeffs are not set");
  if (types[i].active && types[j].active) return types[i].promise + types[j].promise;
  return i == j && !own_collections ? bin_edge : 0.0;
}
