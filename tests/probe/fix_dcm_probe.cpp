/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "fix_dcm_probe.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_args.h"
#include "dcm_unknowns.h"
#include "law/friction.h"
#include "law/stiffness.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "pair_dcm_contact.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;

static const char STYLE[] = "Fix dcm/probe";

// fix ID group dcm/probe [send yes|no] [every N] [stiffness yes|no]

FixDCMProbe::FixDCMProbe(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), contact(nullptr), send(true), stiff(false),
    every(1), values{}
{
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"send", "every", "stiffness"});
  while (args.next()) {
    if (args.is("send"))
      send = args.choose({"no", "yes"}) == 1;
    else if (args.is("stiffness"))
      stiff = args.choose({"no", "yes"}) == 1;
    else
      every = (int) args.whole();
  }
  vector_flag = 1;
  size_vector = NVALUES;
  global_freq = 1;
  extvector = 0;
  nevery = 1;
  comm_forward = 1;
}

int FixDCMProbe::setmask()
{
  return END_OF_STEP;
}

void FixDCMProbe::init()
{
  cell = FixDCMCell::require(lmp, STYLE);
  adjacency = cell->request_adjacency();
  contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
  if (contact) partners = contact->request_partners(every);
  if (contact && stiff) stiffness = contact->request_stiffness();
}

void FixDCMProbe::setup(int)
{
  end_of_step();
}

void FixDCMProbe::end_of_step()
{
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, STYLE);
  const auto &faces = cell->faces();
  std::fill_n(values, (int) NVALUES, 0.0);

  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    const auto around = cell->faces_of_node(i);
    values[NODES] += 1.0;
    values[AROUND] += (double) around.size();
    if (around.size() < 5) values[FEWEST] += 1.0;
    for (int m = 0; m < atom->num_bond[i]; m++) {
      const tagint ends[2] = {atom->tag[i], atom->bond_atom[i][m]};
      const auto two = cell->faces_of_edge(i, atom->map(ends[1]));
      values[EDGES] += 1.0;
      if (two[0] < 0 || two[1] < 0 ||
          atom->tag[faces[two[0]].atom] == atom->tag[faces[two[1]].atom])
        continue;
      const bool hold = std::all_of(two.begin(), two.end(), [&](int f) {
        return std::all_of(ends, ends + 2, [&](tagint end) {
          return std::any_of(faces[f].v, faces[f].v + 3, [&](int v) {
            return atom->tag[v] == end;
          });
        });
      });
      if (hold) values[BOTH] += 1.0;
    }
  }

  auto wanted = [this](int i) {
    return (int) ((atom->tag[i] + update->ntimestep) % AtomVecDCM::NREGION);
  };
  for (int f = 0; f < cell->nowned(); f++) cell->set_region(f, wanted(faces[f].atom));
  if (send) cell->update_regions();
  for (int f = cell->nowned(); f < (int) faces.size(); f++) {
    const int i = faces[f].atom;
    values[GHOSTS] += 1.0;
    if (dcm->region[i] != wanted(i)) values[STALE] += 1.0;
  }
  if (stiffness) values[STIFFNESS] = contact_stiffness();
  look_at_sharing();
  MPI_Allreduce(MPI_IN_PLACE, values, NVALUES, MPI_DOUBLE, MPI_SUM, world);

  if (!contact) return;
  for (const auto &pair : contact->partners()) {    // the same on all ranks
    values[PAIRS] += 1.0;
    values[PAIR_AREA] += pair.area;
  }
}

/* ----------------------------------------------------------------------
   sums over the processes that share a cell, and what all know of it when asked
------------------------------------------------------------------------- */

void FixDCMProbe::look_at_sharing()
{
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, STYLE);
  const auto &table = cell->cells();
  std::vector<char> touched(table.size(), 0), owned(table.size(), 0), every(table.size(), 1);
  for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
    const int row = cell->cell_of(i);
    if (row < 0 || !table[row].deformable) continue;
    touched[row] = 1;
    if (i < atom->nlocal) owned[row] = 1;
  }
  std::vector<double> sums, owned_sums;
  cell->begin_sum(sums, 2);
  cell->begin_sum(owned_sums, 2);
  for (int i = 0; i < atom->nlocal; i++) {
    if (dcm->kind[i] != AtomVecDCM::NODE) continue;
    for (auto *const it : {&sums, &owned_sums}) {
      (*it)[2 * cell->cell_of(i)] += 1.0;
      (*it)[2 * cell->cell_of(i) + 1] += 1.0 / (double) atom->tag[i];
    }
  }
  cell->sum_shared(sums, 2);
  cell->sum_owned(owned_sums, 2);
  auto differ = unequal(sums, 2, touched);
  const auto differ_owned = unequal(owned_sums, 2, owned);
  for (const int row : table.deformable()) {
    values[SHARES] += 1.0;
    differ[row] |= differ_owned[row] || !touched[row] || sums[2 * row] != table[row].nnodes ||
                   (owned[row] && owned_sums[2 * row + 1] != sums[2 * row + 1]);
  }
  for (const int row : table.all_deformable()) {
    if (differ[row]) values[DIFFER] += 1.0;
    if (touched[row]) continue;
    values[ELSEWHERE] += 1.0;
    if (std::isnan(table[row].volume) && std::isnan(table.value("pressure", row)))
      values[BLANK] += 1.0;
  }
  cell->update_all();
  std::vector<double> measures;
  for (const auto &it : table.all())
    measures.insert(measures.end(), {it.volume, it.area, it.x[0], it.x[1], it.x[2],
                                     table.value("pressure", table.find(it.molecule))});
  for (const char is : unequal(measures, 6, every)) values[UNEQUAL] += is;
}

// rows in which values are not the same numbers on all processes that have them

std::vector<char> FixDCMProbe::unequal(const std::vector<double> &all, int width,
                                       const std::vector<char> &has) const
{
  std::vector<char> result(has.size(), 0);
  std::vector<double> most(2 * width * has.size(), -std::numeric_limits<double>::infinity());
  for (size_t n = 0; n < width * has.size(); n++) {
    if (!has[n / width]) continue;
    most[2 * n] = std::isfinite(all[n]) ? all[n] : std::numeric_limits<double>::infinity();
    most[2 * n + 1] = -all[n];
  }
  MPI_Allreduce(MPI_IN_PLACE, most.data(), (int) most.size(), MPI_DOUBLE, MPI_MAX, world);
  for (size_t n = 0; n < width * has.size(); n++)
    if (most[2 * n] != -most[2 * n + 1]) result[n / width] = 1;
  return result;
}

/* ----------------------------------------------------------------------
   this process' share of v K v, as a solver would have it
------------------------------------------------------------------------- */

double FixDCMProbe::contact_stiffness()
{
  owner.assign(atom->nlocal + atom->nghost, comm->me);
  comm->forward_comm(this, 1);
  dcm::FrictionSystem system;
  dcm::FrictionComm messages(world);
  DCMUnknowns unknowns(lmp, system, messages);
  unknowns.number(groupbit, owner);
  dcm::StiffnessSystem blocks;
  contact->add_stiffness(blocks, unknowns);

  std::vector<int> moving;
  for (int i = 0; i < atom->nlocal + atom->nghost; i++)
    if (atom->molecule[i] == 1 && unknowns.moves(i, groupbit)) moving.push_back(unknowns(i));
  std::vector<double> v((size_t) dcm::STRIDE * (system.nall + 1), 0.0), y = v;
  for (const int slot : moving) v[(size_t) dcm::STRIDE * slot] = 1.0;
  struct {
    void sum(double *, int) {}
    void sum_cells(double *, int) {}
  } alone;    // contacts need no sums over cells
  blocks.merge();
  return blocks.apply(1.0, (size_t) system.nall + 1, v.data(), y.data(), alone);
}

int FixDCMProbe::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  for (int i = 0; i < n; i++) buf[i] = owner[list[i]];
  return n;
}

void FixDCMProbe::unpack_forward_comm(int n, int first, double *buf)
{
  for (int i = 0; i < n; i++) owner[first + i] = buf[i];
}

double FixDCMProbe::compute_vector(int i)
{
  return values[i];
}
