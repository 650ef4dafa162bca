/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/division,DCMTimedFix<FixDCMDivision>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_DIVISION_H
#define LMP_FIX_DCM_DIVISION_H

#include "law/division.h"
#include "dcm_args.h"
#include "dcm_cell_surgery.h"
#include "dcm_log.h"
#include "dcm_request.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Division of the cells that are READY, by fix dcm/growth for instance (S1 "Cell cycle and cell
// division", "CBM: Cell division"). A deformable cell gives two whose shapes come from
// law/division.h, a center-based one two spheres in its space, whose contact is held back until
// they have relaxed.

class FixDCMDivision : public Fix, public DCMRole {
 public:
  FixDCMDivision(class LAMMPS *, int, char **);
  int setmask() override;
  void post_constructor() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;
  double memory_usage() override;

  unsigned traits() const override { return MAKES_CELLS; }
  std::string work() override;

 private:
  enum Plane { RANDOM, LONG, GIVEN, VARIABLE, POLARITY };
  enum Sphere { SOFTEN, TRUNCATE };

  struct Job {                      // one division
    DCMCellSurgery::Cell mother;    // positions relative to origin, like those of plane, daughters
    dcm::Vec3 origin;               // place of its first node
    dcm::DivisionPlane plane;
    double volume;    // of the mother, and of her rounded shape, which is what the daughters see
    double rounded_volume;
    dcm::DivisionMaterial material;
    double rest;    // rest length over edge of the round cell of her rest volume
    const DCMCellBuilder::Topology *round;
    dcm::Daughter daughter[2];
  };

  struct Pair {    // sister spheres still held back
    tagint molecule, other;
    double since;
  };

  class FixDCMCell *cell;
  DCMRequest<> spheres;
  class PairDCMContact *contact;
  std::uint64_t seed;
  Plane plane_mode;
  dcm::Vec3 given;
  std::string variable_name[3];
  Sphere sphere_mode;
  double sphere_value;    // time of softening or largest force
  dcm::DivisionSettings settings;
  DCMLog log;

  std::vector<tagint> ready;                           // molecules to divide in this step
  std::map<tagint, dcm::Vec3> variable_axis;           // of the ready cells
  std::map<int, DCMCellBuilder::Topology> topology;    // icospheres by level
  std::vector<Pair> sisters;

  bigint ndcm, ncbm;    // divisions so far
  bigint iterations;    // of sub-simulations so far
  double seconds;       // wall time of divisions since the fix was defined
  double outside;       // largest depth of a node outside its envelope, over the radius
  double quality;       // worst face of a newborn cell

  void parse(int, char **);
  void parse_plane(DCMArgs &);
  void evaluate_variables();
  dcm::Vec3 axis_of(const DCMCellSurgery::Cell &);
  const DCMCellBuilder::Topology &round_mesh(DCMCellSurgery &, size_t nnodes);
  Job prepare(DCMCellSurgery &, const DCMCellSurgery::Cell &);
  void grow(std::vector<Job> &);
  void check(const Job &) const;
  void insert(DCMCellSurgery &, Job &);
  static std::vector<int> regions_of(const Job &, const std::vector<dcm::Vec3> &);
  void insert_spheres(DCMCellSurgery &, const DCMCellSurgery::Cell &);
  void hold_back_sisters();
  void write_log(const DCMCellSurgery::Cell &, const dcm::Vec3 &axis, const tagint *daughters,
                 double volume, double volume1, double volume2, int niter);
};

}    // namespace LAMMPS_NS

#endif
#endif
