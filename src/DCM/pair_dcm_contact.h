/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef PAIR_CLASS
// clang-format off
PairStyle(dcm/contact,DCMTimedForce<PairDCMContact>);
// clang-format on
#else

#ifndef LMP_PAIR_DCM_CONTACT_H
#define LMP_PAIR_DCM_CONTACT_H

#include "law/contact.h"
#include "law/friction_blocks.h"
#include "dcm_parameters.h"
#include "dcm_request.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "pair.h"

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// Contact of cell surfaces: face-face and face-sphere by a Maugis-Dugdale or DMT law integrated
// over the common part of two faces, sphere-sphere by JKR (S1 "Contact model", eqs 14-16).
// Besides forces it delivers, once per step, the contact areas and the friction blocks that
// fix dcm/motion puts into its matrix.

class PairDCMContact : public Pair, public DCMRole {
 public:
  // contact of two cells: area, sum of the forces of its parts, compression positive, and as a
  // vector, on the first cell
  struct Partner {
    tagint molecule, other;    // molecule < other
    double area, normal, force[3];
  };

  // two spheres, the daughters of one cell, that a division left deep inside each other: their
  // contact is held back (HeldJKR in law/jkr.h) until they have moved apart
  struct Sisters {
    tagint molecule, other;
    double most = 0.0;     // largest repulsive force, 0: no limit
    double scale = 1.0;    // factor on modulus and adhesion
  };

  // of the last step on this rank
  struct Counters {
    bigint pairs = 0;             // pairs in the neighbor list
    bigint contacts = 0;          // of them in contact
    double area = 0.0;            // total contact area
    double overlap = 0.0;         // largest overlap of two faces, in steps in which it is output
    double share = 0.0;           // largest part of what the smaller cell bears
    double deepest = 0.0;         // that overlap
    tagint deep[2] = {0, 0};      // and between which cells
    double seconds = 0.0;         // wall time of compute()
    double list_seconds = 0.0;    // of it, sorting a new neighbor list and checks
  };

  PairDCMContact(class LAMMPS *);
  ~PairDCMContact() override;
  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;

  // friction of this step, recorded while something solves for velocities or after
  // request_blocks()
  void add_friction(dcm::FrictionSystem &, class DCMUnknowns &) override;

  // stiffness of this step, recorded after request_stiffness(); friction blocks then as well
  void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) override;

  // contact area of faces and spheres, per atom; owned atoms: summed over ranks
  const double *contact_area() const { return area.data(); }
  const double *covered_area() const override { return area.data(); }
  std::string work() override;
  std::vector<Note> report() override;

  // necks that are stretched belong to pairs of faces
  unsigned traits() const override { return set.history ? KEEPS_PLACES : 0U; }

  // ask in init(), every run, and keep the handle: normal contact force per face or sphere
  // (compression positive), virial of spheres, the same as a tensor, friction blocks, stiffness,
  // contact per pair of cells in the steps that are multiples of `every`, or in those in which a
  // compute with timeflag is going to be read, and the first and last step of a run
  DCMRequest<> request_stress() { return stress_requests.add(); }
  DCMRequest<> request_virial() { return virial_requests.add(); }
  DCMRequest<> request_tensor() { return tensor_requests.add(); }
  DCMRequest<> request_blocks() { return blocks_requests.add(); }
  DCMRequest<> request_stiffness() { return stiffness_requests.add(); }
  DCMRequest<int> request_partners(int every = 1) { return partner_requests.add(every); }
  DCMRequest<class Compute *> request_partners(class Compute *reader)
  {
    return reader_requests.add(reader);
  }

  const double *normal_force() const { return stress.data(); }

  // all pairs of cells in contact, sorted, summed over ranks, the same on all ranks; of the last
  // step in which they were recorded. Collective
  const std::vector<Partner> &partners();
  bigint partners_step() const { return partners_at; }    // that step, -1: none yet

  // per owned sphere, sum over its contacts of repulsive force times distance from the center:
  // half the distance of two spheres, or that to the plane of contact with a face
  const double *sphere_virial() const { return moment.data(); }

  // the same by components, compression positive: six numbers (law/symmetric.h)
  const double *sphere_tensor() const { return tensor.data(); }

  // the whole list of sisters, the same on all ranks, in any order: call it in init(), every run,
  // and whenever the list or a value changes, before the forces of a step; empty: none, no cost
  void set_sisters(const std::vector<Sisters> &);
  const std::vector<Sisters> &sisters() const { return sister_list; }    // molecule < other, sorted

  // collective, in the order of sisters(): force of the full law, neither softer nor limited, when
  // forces were last computed; < 0: attraction, 0: apart, infinite: not computed since
  // set_sisters()
  std::vector<double> sister_forces() const;

  // does the atom type have a cell type, so that its faces or spheres touch others
  bool has_cell_type(int type) const { return types[type].used; }

  const Counters &counters() const { return count; }

  // does this atom type take part in contacts, now or as soon as it gets atoms? From init_style on
  bool touches(int type) const { return types[type].active; }
  double h0() const { return h0_used; }
  double range() const { return range_used; }

 private:
  // what the list is laid out for: radii grow by these factors, spheres only if something makes
  // cells grow
  static constexpr double FACE_GROWTH = 1.5, SPHERE_GROWTH = 1.3;

  // overlap that a cell bears, in mean edges of its mesh; parts of it from which on there is a
  // warning; volumes of cells over that of the box, likewise

  static constexpr double RANGE = 0.75, DEEP = 0.3, OVERFILLED = 1.01;

  using Contacts = void (PairDCMContact::*)();
  struct Law {
    const char *name;
    std::array<Contacts, 2> contacts;        // without and with slopes for the stiffness
    std::array<Contacts, 2> with_history;    // nullptr: no neck to remember
  };
  static const Law LAWS[];             // of keyword law
  enum { DMT, MAUGIS, FOUNDATION };    // their order
  enum CommMode { SUMS, NEIGHBORS, MODULUS };

  DCMRequests<> stress_requests, virial_requests, tensor_requests, blocks_requests,
      stiffness_requests;
  DCMRequests<int> partner_requests;
  DCMRequests<class Compute *> reader_requests;
  DCMRequest<> curvature;
  DCMRequest<double> contact_range;

  // settings; what is derived from the mesh is derived once and kept, also over restarts, so that
  // a run continues unchanged

  struct Settings {
    int law = FOUNDATION, history = 0, points = 2, concave = 0, h0_auto = 1;
    double h0 = dcm::H0_LEAST, rmax = 10.0;
    double range = 0.0, maxoverlap = 0.0;    // 0: choose
    double growth = 0.0;                     // of radii, 0: choose
    dcm::Facing facing;
  } set;
  double h0_used = 0.0, range_used = 0.0, overlap_used = 0.0;
  double own_cutoff = 0.0;         // ghost cutoff set here
  double bin_edge = 0.0;           // mean edge, for the bins of types without contact
  double wide_bin = 0.0;           // least size of bins, if those of small faces would be too many
  double face_reach = 0.0;         // largest face the ghost cutoff is laid out for
  double sphere_growth = 0.0;      // growth of spheres the list is laid out for
  double guessed = 0.0;            // 1: h0, range derived before there was any mesh
  std::vector<double> laid_out;    // per type: TypeInfo::promise, 0: not yet
  bool own_collections = false;    // of neighbor style multi
  bool own_bins = false;
  bool warned_h0 = false, warned_filled = false, warned_overlap = false;
  double filled = 0.0, overlap = 0.0;    // measure_overlap()
  struct Deepest {                       // overlap of the run, by its share
    double share = 0.0, depth = 0.0;     // depth, cells: where rank is this process
    tagint cells[2] = {0, 0};
    bigint step = 0;
    int rank = 0;
  } deepest;
  double stiffest = 0.0;                             // law foundation: largest stiffness per area
  std::vector<std::pair<int, int>> excluded_here;    // types kept apart by this style
  bool own_molecules = false;                        // and nodes of one cell

  struct TypeInfo {
    bool used = false;       // has a cell type, not NULL
    int kind = 0;            // the one kind its atoms have, 0: no atoms yet, any may come
    bool active = false;     // its atoms take part in contacts
    double radius = 0.0;     // largest radius (contact range not included)
    double promise = 0.0;    // largest radius the neighbor list is built for (range included)
    double E = 0.0, nu = 0.0, layer = 0.0, gn = 0.0, gt = 0.0, a[4] = {0.0, 0.0, 0.0, 0.0};
  };

  std::unique_ptr<DCMParameters> parameters;
  struct DCMAtoms *dcm;
  class FixDCMCell *fix_cell;
  class FixNeighHistory *fix_history;
  std::vector<TypeInfo> types;                // [1..ntypes]
  std::vector<dcm::ContactMaterial> table;    // class x class, class = 4 (type - 1) + region
  int nclass;
  bool have_spheres, have_faces;        // at the start of the run
  bool expect_new;                      // types without atoms may get some in the run
  bool expect_spheres, expect_faces;    // at the start, or they may come in the run
  bool any_apparent, use_history;
  unsigned traits_of_deck = 0U;
  bool want_stress, want_partners, want_blocks;    // in this step
  bool want_virial = false, want_tensor = false, want_stiffness = false, want_overlap = false;
  double mean_edge, cell_radius;    // at the start of the run; largest deformable cell
  double largest_edge = 0.0;        // largest mean edge of a cell
  bigint built;
  uint64_t checked = 0;    // places() where check_start() has nothing to say: the end of a run

  // pairs of the neighbor list, sorted by kind at each rebuild

  struct FacePair {
    int f, g;    // indices into FixDCMCell::faces
  };
  struct SpherePair {
    int i, j;    // local atoms; face-sphere: i = index into FixDCMCell::faces
  };
  std::vector<FacePair> face_pairs;
  std::vector<SpherePair> mixed_pairs, sphere_pairs;
  std::vector<int *> face_touch, mixed_touch, sphere_touch;    // in contact before, from history
  std::vector<int> used_faces;                                 // faces that stand in some pair
  std::vector<std::vector<int>> faces_of_cell;                 // by row, for deep_inside()

  // per face of FixDCMCell, this step

  struct Outline {    // what find_candidates() needs of a face
    float mid[3], reach, center[3], R;
  };
  std::vector<dcm::FaceGeometry> geometry;
  std::vector<Outline> outline;
  double blur = 0.0;              // round-off of an outline, a length
  std::vector<int> candidates;    // indices into face_pairs
  std::vector<int> face_class;
  std::vector<double> rmax_cell, bears;    // bears: largest overlap, per row of the table

  std::vector<double> area, stress, moment, modulus, near_sum, near_count;    // per atom
  std::vector<double> tensor;                                                 // six
  std::vector<dcm::ContactBlock> contacts;
  std::vector<dcm::EdgeBlock> spheres;
  struct Slope {
    double slope, tilt[2][6];    // normal force/overlap, >= 0; contact_tilt.h
  };
  std::vector<Slope> contact_slope;                // of contacts
  std::vector<dcm::EdgeBlock> sphere_stiffness;    // of spheres
  std::vector<Partner> partner_list;               // of this rank, or merged of all
  bool partners_merged = true;
  bigint partners_at = -1;
  std::vector<Sisters> sister_list;
  std::vector<double> sister_force;    // of the full law, on this rank
  Counters count;
  CommMode commmode;

  void allocate();
  void scan_types();
  void expect_types();
  void forget_layout();
  std::vector<double *> kept();
  void measure_mesh();
  void choose_lengths();
  void check_scale();
  void lay_out();
  void read_types();
  void report_layers();
  void exclude_types();
  void allow_types(int, int);
  void take_back();
  void drop_collections();
  void set_cutoff();
  void setup_history();
  double size_of_bins() const;
  void choose_collections();

  double bearable(double, double) const;
  const char *remedy_for_overlap() const;
  void measure_overlap();
  void find_wanted();
  void sort_pairs();
  void add_pair(int, int, int *);
  void check_radii();
  [[noreturn]] void fail_radius(int, double, double);
  std::string shape_of(int) const;
  void make_faces();
  void find_candidates();
  template <class State, bool HISTORY> static constexpr std::array<Contacts, 2> contacts_of();
  template <class State, bool HISTORY, bool SLOPE> void compute_cells();
  template <class State, bool HISTORY, bool SLOPE> void compute_faces();
  template <class State, bool HISTORY, bool SLOPE> void compute_mixed();
  void compute_moduli();
  void compute_spheres(int);
  template <bool SISTERS, bool SLOPE> void sphere_contacts(int);
  void clear_blocks();
  static Slope slope_of(const dcm::ContactResult &, const dcm::FaceGeometry &, double weight,
                        const dcm::FaceGeometry *);
  static std::vector<std::string> law_names();
  int find_sisters(tagint, tagint) const;
  void add_partner(tagint, tagint, double area, double force, const dcm::Vec3 &axis);
  void check_start();
  uint64_t places() const;
  void check_law(double);
  bool may_be(const TypeInfo &info, int kind) const
  {
    return info.kind == kind || (info.active && info.kind == 0 && expect_new);
  }
  bool has_fix_cell() const;
  static double round_up(double);
  bool deep_inside(const dcm::Vec3 &, int, double);
  bool deep_in_each_other(int, const dcm::Vec3 &, int, const dcm::Vec3 &, double);
  bool ran_into(int, int, const dcm::Vec3 &, double);
  void note_overlap(int, int, const dcm::Vec3 &, double);
  bool swallowed(int, int);
  void fail_pair(int, int, double, double, double);
  void report_fault();

  struct Fault {
    tagint i = 0, j = 0;    // the lower pair of atoms counts
    std::string text;
  } first_fault;    // of setup, in which a fault is one error on all processes
};

}    // namespace LAMMPS_NS

#endif
#endif
