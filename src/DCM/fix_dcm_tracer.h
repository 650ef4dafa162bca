/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/tracer,DCMTimedFix<FixDCMTracer>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_TRACER_H
#define LMP_FIX_DCM_TRACER_H

#include "dcm_cell_surgery.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "dcm_tracer_faces.h"
#include "fix.h"
#include "law/tracer.h"
#include "law/voxels.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// Brownian tracers that secreting cells let out through their apical faces (law/tracer.h). They are
// atoms of a type of their own, without molecule; the cell they are in is in the atom style.
//
// initial_integrate   settle and walk, at the surfaces of the last force evaluation
// pre_exchange        tracers are made, handed on when cells divide, and deleted

class FixDCMTracer : public Fix, public DCMRole {
 public:
  FixDCMTracer(class LAMMPS *, int, char **);
  ~FixDCMTracer() override;
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup_pre_neighbor() override { pre_neighbor(); }
  void setup_post_neighbor() override { post_neighbor(); }
  void setup(int) override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void pre_neighbor() override;
  void post_neighbor() override;
  void min_pre_force(int) override;
  void reset_dt() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;
  double memory_usage() override;

  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;

  unsigned traits() const override { return HAS_TRACERS | KEEPS_PLACES; }
  void touch_faces(double, std::vector<int> &) override;
  void cell_divided(const DCMCellTable::Division &) override;
  void cell_removed(int) override;
  void cell_converted(int, double) override;

 private:
  using Walk = dcm::TracerWalk<DCMTracerFaces>;

  // ---- settings

  int type, number, substeps, bounce;
  double D, drift, far;    // far < 0: choose
  std::uint64_t seed;
  int slab_axis;    // -1: none
  double slab_lo, slab_hi;
  double covered;    // part of a face in contact from which on the slit before it is shut
  bool reflect_far, slits_shut, topup, release;

  // ---- others

  struct DCMAtoms *dcm;
  class FixDCMCell *cell;
  class PairDCMContact *contact;
  DCMCellTable::Handle secretes;    // 1: the cell has been given its tracers
  std::shared_ptr<const DCMColumn> polarity;
  int polarity_field;

  // ---- state kept over restarts

  struct Kept {
    double scale = 0.0;    // edge of the mesh, rounded, when first seen: lengths of rules
    int begun = 0;         // the first tracers have been made
    int have_box = 0;      // `box`: around all nodes, at the last look
    double box[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};    // x, y, z: low, high
  } kept;
  dcm::TracerCounts before;    // of earlier runs, on rank 0
  std::int64_t deleted = 0, deleted_before = 0;
  bool restored = false, unsure = false;    // unsure: surfaces have moved without tracers

  // ---- of this rank

  DCMTracerFaces faces;
  dcm::Voxels voxels;
  Walk walk;
  std::vector<int> mine;              // tracers, by local index
  bool anywhere = false;              // are there any, on all processes
  std::vector<int> shut, *touched;    // per atom
  std::vector<double> last_place;     // of the corners of faces, when tracers were settled
  bool stale = true;                  // faces have been numbered anew
  double slack = 0.0, since_build = 0.0;
  double longest = 0.0;               // way of a tracer in a step
  double largest = 0.0;               // reach of the largest face, all ranks
  double limit_lo[3], limit_hi[3];    // beyond these the next step may not fit
  bool limited = false;
  double asked = 0.0;    // largest range of touch_faces()

  // cells that came and went in this step

  std::vector<tagint> fresh;                           // with a new surface
  std::map<tagint, std::pair<tagint, tagint>> gone;    // and their daughters, 0: none

  static constexpr double MOST_SIGMA = 4.5;    // longest step, in sqrt(2 D dt)
  static constexpr tagint DOOMED = -1;         // in place of WEIGHTS: to be deleted in this step

  struct Shape;    // of a cell, known to all ranks

  void parse(int, char **);
  void check_types();
  void check_homes();
  void check_start();
  void choose_lengths();
  void set_limits();
  void refresh_faces();
  double moved_since_settled();
  void send_shut();
  void settle_all(double);
  void walk_all();
  void look_far();
  void ask_for_rebuild(int &);
  dcm::Tracer load(int);
  void store(int, const dcm::Tracer &);
  [[noreturn]] void no_place(int);

  bool acts_on(const DCMCellTable::Cell &it) const { return it.deformable && (it.mask & groupbit); }
  std::vector<tagint> needy() const;
  bool any_needy() const;
  std::vector<tagint> heirs(tagint) const;
  void hand_on();
  void make(const std::vector<tagint> &);
  std::vector<dcm::Vec3> fill(const Shape &, int) const;
  void take_away();
  std::vector<Shape> shapes_of(std::vector<tagint>) const;
  dcm::Vec3 near_cell(int, const Shape &) const;
  void shift(int, const dcm::Vec3 &);
  dcm::TracerCounts summed() const;
  std::int64_t summed_deleted() const;

  int ghost_group = -1;    // -1: not set here
  void keep_from_ghosts();
  void let_be_ghosts();
  void mark_ghosts();
};

}    // namespace LAMMPS_NS

#endif
#endif
