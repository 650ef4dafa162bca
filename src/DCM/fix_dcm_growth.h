/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/growth,FixDCMGrowth);
// clang-format on
#else

#ifndef LMP_FIX_DCM_GROWTH_H
#define LMP_FIX_DCM_GROWTH_H

#include "law/growth.h"
#include "fix.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// The cell cycle (S1 "Cell cycle and cell division"): rest volumes and rest lengths grow, cells
// round up and become ready to divide, rest or die. It keeps the book of all cells of its group,
// deformable and center-based, the same on all ranks; fix dcm/division, dcm/death and dcm/convert
// find it with require() and write their changes into it.

class FixDCMGrowth : public Fix {
 public:
  enum Phase { GROWING, ROUNDING, READY, QUIESCENT, DYING, NPHASE };

  struct Entry {    // one per cell, sorted by molecule
    tagint molecule, mother;
    int generation, type;    // type: atom type of the center or sphere
    int deformable, phase;
    double birth;       // time
    double cycle;       // cycle time of this cell, 0: its type does not divide
    double born;        // rest volume at birth
    double newborn;     // volume at birth, 0: not measured yet
    double progress;    // of the cycle, 0 to 1
    double volume0;     // rest volume
    double length;      // factor on the rest lengths: 1, below while rounding up
    double fading;      // dying: time until the rest volume is gone
    double dying0;      // dying: rest volume when it began
    double ratio;       // rest volume over volume when it was last deformable, else 1
    double pressure_before, pressure;    // when rounding up began, largest since
  };
  std::vector<Entry> book;

  FixDCMGrowth(class LAMMPS *, int, char **);
  ~FixDCMGrowth() override;
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void initial_integrate(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  double memory_usage() override;

  // the one instance; error naming the asking style when there is none
  static FixDCMGrowth *require(class LAMMPS *, const std::string &asking);

  // entry of a cell, nullptr: not in the book
  Entry *find(tagint molecule);

  // for those who change cells: what they do has to be done to the atoms as well
  tagint new_molecule() { return next_molecule++; }
  tagint last_molecule() const { return next_molecule - 1; }    // highest ID ever used
  double time() const;
  void divide(const Entry &mother, tagint daughter1, tagint daughter2, double volume);
  void remove(tagint molecule);
  void fade(tagint molecule, double duration);
  void convert(tagint molecule, int type, bool deformable, double volume0, double ratio);

 private:
  std::unique_ptr<class DCMParameters> parameters;
  struct DCMAtoms *dcm;
  class FixDCMCell *cell;           // nullptr: no deformable cells
  class PairDCMContact *contact;    // nullptr: no compression, or no center-based cells
  std::uint64_t seed;
  dcm::GrowthLaw law;
  double half, exponent;          // slowing by compression; half = 0: none
  double rounding, shortening;    // part of the cycle; factor on rest lengths at its end
  bool until_volume, random_age;
  double newborn;                      // rest volume of a newborn, 0: that of each first cell
  std::vector<double> bulk_modulus;    // per atom type, 0: unknown; for compression
  std::vector<double> fraction;        // per atom type: proliferating fraction, < 0: not held
  std::vector<std::string> fraction_names;
  std::vector<double> fraction_values;

  tagint next_molecule;
  bigint births, deaths;
  std::vector<int> entry_of;           // per owned + ghost sphere: index into book
  std::vector<double> built_radius;    // per entry: radius of the sphere at the last rebuild
  std::vector<double> lengths;         // per deformable cell: factor on its rest lengths
  std::vector<double> sphere_pressure;

  void parse_keyword(class DCMArgs &);
  void enroll();
  Entry newcomer(tagint molecule, int type, int deformable, double volume0) const;
  void draw_cycle(Entry &) const;
  void hold_fractions();
  void measure_spheres();
  double volume_of(const Entry &) const;
  double strain(const Entry &, size_t) const;
  double advance(Entry &, double rate);
  void apply();
};

}    // namespace LAMMPS_NS

#endif
#endif
