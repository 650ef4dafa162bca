/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/osmosis,DCMTimedFix<FixDCMOsmosis>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_OSMOSIS_H
#define LMP_FIX_DCM_OSMOSIS_H

#include "dcm_cell_table.h"
#include "dcm_face_graph.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"
#include "law/lumen.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Osmotic pressure in lumens (S1 "Osmotic effects"): marks the faces that bound one, and pushes on
// them. Which faces these are is looked into every so many steps, in initial_integrate: faces that
// the fluid secreted at apical faces can reach (flood), or that tracers have touched.
//
// fix_dcm_osmosis.cpp: arguments, checks, time; fix_dcm_osmosis_pressure.cpp: volume, pressure,
// forces; fix_dcm_osmosis_marks.cpp: marks.

class FixDCMOsmosis : public Fix, public DCMRole {
 public:
  FixDCMOsmosis(class LAMMPS *, int, char **);
  ~FixDCMOsmosis() override;
  int setmask() override;
  void init() override;
  void setup_pre_reverse(int, int) override;
  void initial_integrate(int) override;
  void pre_reverse(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  double memory_usage() override;

  const int *marked_faces() const override { return mark; }
  double next_event() override;
  double longest_step() override;
  void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) override;
  void cell_divided(const DCMCellTable::Division &) override;
  void cell_removed(int) override { now.due = 1; }
  void cell_converted(int, double) override { now.due = 1; }
  void cell_retyped(int, int) override { now.due = 1; }

 private:
  double pressure;                 // kPa
  std::string variable;            // instead
  double dilute;                   // volume above which the pressure falls, 0: never
  double rate, kT, loss, least;    // of solute; least: volume that counts at least
  bool solute;
  bool tracers, memory_kept, weigh_free;
  double theta, range;
  std::string secretes;     // group, empty: that of the fix
  int secrete_bit, axis;    // axis: of the slab, -1: none
  double lo, hi, ramp, longest;
  int every;    // as given, 0: not
  enum { NO_STARTER, AT_POINT, APICAL } starter;
  double point[3], radius, starting;    // of the starter: where, and for how long

  struct State {    // kept in restart files
    int started, due, warned, nfaces, ncells, fill;
    double clock, begun;    // time since the first setup, also if the deck resets that of LAMMPS;
                            // of the first mark, < 0: none yet
    double amount, counted, secreting;    // solute, when it was counted, area that secretes it
    double work, lost;                    // work: of runs on another number of processes
    double center[3];                     // volumes are measured from here
  } now;

  class FixDCMCell *cell;
  struct DCMAtoms *dcm;
  class PairDCMContact *contact;
  DCMFaceGraph graph;
  DCMCellTable::Handle marked_area, joined;
  std::vector<Fix *> makers;    // of cells, that a snapshot is taken for
  DCMRole *tracer;
  int *mark, *whole;    // per atom: face is marked; counts in full since a starter marked it

  double acting, worked;         // pressure now; work of this process
  double falls;                  // by so much for each volume that is added (pressure/volume), >= 0
  std::vector<double> pushed;    // per atom, 3 numbers: force of a unit of pressure
  bool measured;
  dcm::LumenSums sums;    // of the marked faces as they are now
  double wall, net;       // their area, size of the force on them

  std::vector<int> state;    // per atom, of a look
  struct Corner {
    tagint molecule;
    double x[9];
  };
  std::vector<Corner> snapshot;    // marked faces of all processes, before cells divide
  struct Birth {
    tagint daughter, mother;
  };
  std::vector<Birth> newborn;

  bool acts_on(int row) const;
  bool secreting(int row) const;
  void parse_starter(class DCMArgs &);
  void check_start();
  void check_places();
  void evaluate_pressure();
  double free_part(int f) const;
  double power() const;
  void measure();
  void tally(int, const double *, const double *, const double *);

  void look();
  void note_joined();
  int find_sources();
  void find_states();
  double near_slab(double) const;
  bool in_slab(const double *) const;
  bool near_starter(const double *) const;
  bool starting_at(int row) const;
  bool started_across(int f) const;
  double covered_part(int f) const;
  void set_marks();
  void count_solute(double);
  void warn_if_open(double);
  void take_snapshot();
  void inherit();
};

}    // namespace LAMMPS_NS

#endif
#endif
