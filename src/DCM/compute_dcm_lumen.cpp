/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "compute_dcm_lumen.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_compat.h"
#include "dcm_deck_check.h"
#include "dcm_role.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "memory.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Compute dcm/lumen";

/* ----------------------------------------------------------------------
   compute ID group dcm/lumen [plane x|y|z at] [slab lo hi] [min A] [range r]
------------------------------------------------------------------------- */

ComputeDCMLumen::ComputeDCMLumen(LAMMPS *lmp, int narg, char **arg) :
    Compute(lmp, narg, arg), plane(2), at(0.0), has_plane(false), has_slab(false), lo(0.0), hi(0.0),
    least(0.0), range(0.0), cell(nullptr), contact(nullptr), marks(nullptr), graph(lmp, STYLE),
    found_at(-1), nmax(0), nrows(0)
{
  AtomVecDCM::require(lmp, STYLE);
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"plane", "slab", "min", "range"});
  while (args.next()) {
    if (args.is("plane")) {
      args.need(2);
      has_plane = true;
      plane = args.axis();
      at = args.number(DCMArgs::ANY, "plane position");
    } else if (args.is("slab")) {
      args.need(2);
      has_slab = true;
      lo = args.number(DCMArgs::ANY, "slab lo");
      hi = args.number(DCMArgs::ANY, "slab hi");
      if (!(lo < hi))
        error->all(FLERR, "{}: slab from {} to {} is empty; give the lower bound first", STYLE, lo,
                   hi);
    } else if (args.is("min")) {
      least = args.number(DCMArgs::NONNEGATIVE);
    } else {
      range = args.number(DCMArgs::POSITIVE);
    }
  }
  if (has_slab && !has_plane)
    error->all(FLERR, "{}: slab needs 'plane x|y|z at', the direction that it is cut across",
               STYLE);

  vector_flag = array_flag = peratom_flag = 1;
  size_vector = 2 + NVALUES;
  extvector = extarray = 0;
  vector = new double[size_vector]();
  size_array_cols = NVALUES + 4;
  size_array_rows = 0;
  size_array_rows_variable = 1;
  size_peratom_cols = 0;
  comm_forward = 1;
}

ComputeDCMLumen::~ComputeDCMLumen()
{
  delete[] vector;
  memory->destroy(array);
  memory->destroy(vector_atom);
}

void ComputeDCMLumen::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::CENTER});
  graph.init();
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  marks = DCMRole::marker_of(lmp);
  if (!marks)
    error->all(FLERR,
               "{}: nothing marks the faces at a lumen; add a fix dcm/osmosis (pressure 0 measures "
               "without a force)",
               STYLE);
  found_at = -1;
}

void ComputeDCMLumen::setup()
{
  graph.check_cutoff(range);
}

/* ----------------------------------------------------------------------
   once a step, whoever asks
------------------------------------------------------------------------- */

void ComputeDCMLumen::find()
{
  FixDCMCell::check_current(lmp, STYLE, cell);
  FixDCMCell::check_current(lmp, STYLE, contact);
  cell->check_atoms(STYLE);
  if (DCMRole::marker_of(lmp) != marks)
    error->all(FLERR,
               "{}: the style that marks faces was removed or defined anew since the last step; do "
               "a 'run 0' before using this compute",
               STYLE);
  if (found_at == update->ntimestep) return;
  found_at = update->ntimestep;
  find_sets();
  measure();
}

/* ----------------------------------------------------------------------
   marked faces of the group's cells, linked as fix dcm/osmosis links them
------------------------------------------------------------------------- */

void ComputeDCMLumen::find_sets()
{
  const double *const area = contact->contact_area();
  const int *const mark = marks->marked_faces();
  state.assign(atom->nlocal + atom->nghost, 0);
  for (int f = 0; f < cell->nowned(); f++) {
    const int i = cell->faces()[f].atom, row = cell->faces()[f].cell;
    if (mark[i] && row >= 0 && (cell->cells()[row].mask & groupbit))
      state[i] = DCMFaceGraph::NODE;
    else if (!mark[i] && area[i] > dcm::MARK_FALLS * cell->area(f))
      state[i] = DCMFaceGraph::SHUT;
  }
  comm->forward_comm(this);
  graph.collect(range);
  graph.build(state);

  // the same on all processes, face after face in the order of their tags

  std::vector<Lumen> sets(graph.nsets());
  std::vector<std::vector<tagint>> molecules(sets.size());
  std::vector<const double *> first(sets.size(), nullptr);
  for (const auto &face : graph.faces()) {
    Lumen &it = sets[face.set];
    if (!first[face.set]) first[face.set] = face.mid;
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = face.mid[k] - first[face.set][k];
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    vec(it.center) += face.area * vec(d);
    it.wall += face.area;
    molecules[face.set].push_back(face.molecule);
  }
  lumens.clear();
  for (int s = 0; s < (int) sets.size(); s++) {
    Lumen &it = sets[s];
    if (!(it.wall > least)) continue;
    vec(it.center) = vec(first[s]) + vec(it.center) / it.wall;
    if (has_plane && domain->periodicity[plane]) {    // the image next to plane and slab
      const double near = has_slab ? 0.5 * (lo + hi) : at, length = domain->prd[plane];
      it.center[plane] -= length * std::round((it.center[plane] - near) / length);
    }
    std::sort(molecules[s].begin(), molecules[s].end());
    it.ncells =
        (int) (std::unique(molecules[s].begin(), molecules[s].end()) - molecules[s].begin());
    it.set = s;
    lumens.push_back(it);
  }
  std::stable_sort(lumens.begin(), lumens.end(), [](const Lumen &a, const Lumen &b) {
    return a.wall > b.wall;
  });
  place.assign(sets.size(), -1);
  for (size_t n = 0; n < lumens.size(); n++) place[lumens[n].set] = (int) n;
}

/* ----------------------------------------------------------------------
   each process adds up its own faces
------------------------------------------------------------------------- */

void ComputeDCMLumen::measure()
{
  double **x = atom->x;
  for (int f = 0; f < cell->nowned(); f++) {
    const auto &face = cell->faces()[f];
    if (!(state[face.atom] & DCMFaceGraph::NODE)) continue;
    const auto *const it = graph.find(atom->tag[face.atom]);
    if (!it || place[it->set] < 0) continue;
    Lumen &lumen = lumens[place[it->set]];
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = x[face.v[0]][k] - lumen.center[k];
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    const Vec3 a = vec(d), b = a + (vec(x[face.v[1]]) - vec(x[face.v[0]])),
               c = a + (vec(x[face.v[2]]) - vec(x[face.v[0]]));
    const double shift = lumen.center[plane];
    if (has_slab) {
      dcm::add_face_in_slab(lumen.sums, a, b, c, plane, lo - shift, hi - shift);
      dcm::add_covered_in_slab(lumen.sums, a, b, c, plane, lo - shift, hi - shift);
    } else {
      dcm::add_face(lumen.sums, a, b, c);
      dcm::add_covered(lumen.sums, a, b, c);
    }
    dcm::add_section(lumen.sums, a, b, c, plane, has_plane ? at - shift : 0.0);
  }

  constexpr int N = sizeof(dcm::LumenSums) / sizeof(double);
  static_assert(sizeof(dcm::LumenSums) % sizeof(double) == 0, "doubles only");
  std::vector<double> sums(N * lumens.size());
  for (size_t n = 0; n < lumens.size(); n++)
    std::copy_n(reinterpret_cast<const double *>(&lumens[n].sums), N, &sums[N * n]);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), (int) sums.size(), MPI_DOUBLE, MPI_SUM, world);
  for (size_t n = 0; n < lumens.size(); n++)
    std::copy_n(&sums[N * n], N, reinterpret_cast<double *>(&lumens[n].sums));
}

/* ---------------------------------------------------------------------- */

void ComputeDCMLumen::values(const Lumen &it, double *row) const
{
  row[0] = it.sums.volume;
  row[1] = it.sums.area;
  row[2] = it.sums.section;
  row[3] = has_slab ? it.sums.missing_outline() : it.sums.closure();
  row[4] = it.ncells;
  row[5] = it.sums.circularity();
}

void ComputeDCMLumen::compute_vector()
{
  invoked_vector = update->ntimestep;
  find();
  std::fill_n(vector, size_vector, 0.0);
  vector[0] = (double) lumens.size();
  if (lumens.empty()) return;
  values(lumens[0], vector + 1);
  vector[1 + NVALUES] = lumens[0].sums.covered;    // last, as below: elements keep their numbers
}

void ComputeDCMLumen::compute_array()
{
  invoked_array = update->ntimestep;
  find();
  size_array_rows = (int) lumens.size();
  if (size_array_rows > nrows) {
    nrows = size_array_rows;
    memory->destroy(array);
    memory->create(array, nrows, size_array_cols, "dcm/lumen:array");
  }
  for (int n = 0; n < size_array_rows; n++) {
    values(lumens[n], array[n]);
    double x[3] = {lumens[n].center[0], lumens[n].center[1], lumens[n].center[2]};
    domain->remap(x);
    for (int k = 0; k < 3; k++) array[n][NVALUES + k] = x[k];
    array[n][NVALUES + 3] = lumens[n].sums.covered;
  }
}

/* ----------------------------------------------------------------------
   number of the lumen a face is at, as in the rows of the array, from 1; 0: none
------------------------------------------------------------------------- */

void ComputeDCMLumen::compute_peratom()
{
  invoked_peratom = update->ntimestep;
  find();
  if (atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(vector_atom);
    memory->create(vector_atom, nmax, "dcm/lumen:vector_atom");
  }
  for (int i = 0; i < atom->nlocal; i++) {
    vector_atom[i] = 0.0;
    if (!(state[i] & DCMFaceGraph::NODE)) continue;
    const auto *const face = graph.find(atom->tag[i]);
    if (face) vector_atom[i] = 1.0 + place[face->set];
  }
}

/* ---------------------------------------------------------------------- */

int ComputeDCMLumen::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  for (int i = 0; i < n; i++) buf[i] = state[list[i]];
  return n;
}

void ComputeDCMLumen::unpack_forward_comm(int n, int first, double *buf)
{
  for (int i = 0; i < n; i++) state[first + i] = (int) buf[i];
}

double ComputeDCMLumen::memory_usage()
{
  return (double) nmax * sizeof(double) + (double) state.capacity() * sizeof(int) +
         graph.memory_usage();
}
