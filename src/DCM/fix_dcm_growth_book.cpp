/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// The book of fix dcm/growth: who is in it, who enters and leaves, and its restart record.

#include "fix_dcm_growth.h"

#include "atom.h"
#include "comm.h"
#include "dcm_gather.h"
#include "dcm_parameters.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static const char STYLE[] = "Fix dcm/growth";

/* ----------------------------------------------------------------------
   cells that are not in the book yet, and out with those that are gone
------------------------------------------------------------------------- */

void FixDCMGrowth::enroll()
{
  std::vector<Entry> now;
  for (const auto &it : dcm_cell_atoms(lmp)) {
    if (!(it.mask & groupbit) || !parameters->used(it.type)) continue;
    if (it.molecule <= 0 || (!now.empty() && now.back().molecule == it.molecule))
      error->all(FLERR,
                 "{}: two cells have molecule ID {}; every cell needs a positive one of "
                 "its own",
                 STYLE, it.molecule);
    const Entry *known = find(it.molecule);
    now.push_back(known ? *known : newcomer(it.molecule, it.type, it.deformable, it.volume0));
  }
  book.swap(now);

  tagint last = 0;
  for (int i = 0; i < atom->nlocal; i++) last = std::max(last, atom->molecule[i]);
  MPI_Allreduce(MPI_IN_PLACE, &last, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  next_molecule = std::max(next_molecule, last + 1);
}

/* ----------------------------------------------------------------------
   a cell without mother: newborn, unless its size or the deck says otherwise
------------------------------------------------------------------------- */

FixDCMGrowth::Entry FixDCMGrowth::newcomer(tagint molecule, int type, int deformable,
                                           double volume0) const
{
  Entry it = {};
  it.molecule = molecule;
  it.type = type;
  it.deformable = deformable;
  it.birth = time();
  it.volume0 = it.born = volume0;
  it.length = it.ratio = 1.0;
  draw_cycle(it);
  double grown = 0.0;
  if (newborn > 0.0 && it.cycle > 0.0) {
    grown = dcm::growth_progress(law, volume0 / newborn);
    if (grown < -1.0e-9 || grown > 1.0 + 1.0e-9)
      error->all(FLERR,
                 "{}: cell {} has rest volume {}, not between newborn {} and twice that; change "
                 "its size or keyword newborn",
                 STYLE, molecule, volume0, newborn);
    grown = std::max(0.0, std::min(1.0, grown));
  } else if (random_age) {
    grown = dcm::Random(seed, molecule, 1, dcm::RandomPurpose::CYCLE).uniform();
  }
  it.born = volume0 / dcm::growth_factor(law, grown);
  it.progress = grown * (1.0 - rounding);
  return it;
}

void FixDCMGrowth::draw_cycle(Entry &it) const
{
  const double mean = parameters->get(it.type, "cycle_time", DCMParameters::NONNEGATIVE, 0.0);
  const double sd = parameters->get(it.type, "cycle_sd", DCMParameters::NONNEGATIVE, 0.0);
  it.cycle =
      mean > 0.0
          ? dcm::cycle_time(mean, sd, dcm::Random(seed, it.molecule, 0, dcm::RandomPurpose::CYCLE))
          : 0.0;
  it.phase = it.cycle > 0.0 ? GROWING : QUIESCENT;
}

/* ---------------------------------------------------------------------- */

FixDCMGrowth::Entry *FixDCMGrowth::find(tagint molecule)
{
  auto found =
      std::lower_bound(book.begin(), book.end(), molecule, [](const Entry &it, tagint mol) {
        return it.molecule < mol;
      });
  return found == book.end() || found->molecule != molecule ? nullptr : &*found;
}

/* ----------------------------------------------------------------------
   volume is conserved over generations: each daughter gets half the rest volume
------------------------------------------------------------------------- */

void FixDCMGrowth::divide(const Entry &given, tagint daughter1, tagint daughter2, double volume)
{
  const Entry mother = given;
  remove(mother.molecule);
  deaths--;
  for (const tagint molecule : {daughter1, daughter2}) {
    Entry it = mother;
    it.molecule = molecule;
    it.mother = mother.molecule;
    it.generation = mother.generation + 1;
    it.birth = time();
    it.volume0 = it.born = 0.5 * mother.volume0;
    if (it.newborn == 0.0) it.newborn = volume;    // else the mother's: sizes do not drift
    it.progress = 0.0;
    it.length = 1.0;
    it.pressure_before = it.pressure = 0.0;
    draw_cycle(it);
    book.push_back(it);    // new molecule IDs are the highest
    births++;
  }
}

void FixDCMGrowth::remove(tagint molecule)
{
  const Entry *it = find(molecule);
  if (!it) return;
  book.erase(book.begin() + (it - book.data()));
  deaths++;
}

void FixDCMGrowth::fade(tagint molecule, double duration)
{
  Entry *it = find(molecule);
  if (!it || it->phase == DYING) return;
  it->phase = DYING;
  it->fading = duration;
  it->dying0 = it->volume0;
}

void FixDCMGrowth::convert(tagint molecule, int type, bool deformable, double volume0, double ratio)
{
  Entry *it = find(molecule);
  if (!it) return;
  it->type = type;
  it->deformable = deformable;
  it->born *= volume0 / it->volume0;
  it->dying0 *= volume0 / it->volume0;
  it->volume0 = volume0;
  it->ratio = ratio;
}

/* ---------------------------------------------------------------------- */

void FixDCMGrowth::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  const bigint numbers[4] = {(bigint) book.size(), births, deaths, next_molecule};
  const int size = (int) (sizeof(numbers) + book.size() * sizeof(Entry));
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(numbers, sizeof(bigint), 4, fp);
  fwrite(book.data(), sizeof(Entry), book.size(), fp);
}

void FixDCMGrowth::restart(char *buf)
{
  bigint numbers[4];
  memcpy(numbers, buf, sizeof(numbers));
  book.resize(numbers[0]);
  births = numbers[1];
  deaths = numbers[2];
  next_molecule = (tagint) numbers[3];
  memcpy((void *) book.data(), buf + sizeof(numbers), book.size() * sizeof(Entry));
}
