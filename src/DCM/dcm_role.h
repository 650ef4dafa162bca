/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_ROLE_H
#define LMP_DCM_ROLE_H

#include "dcm_cell_builder.h"
#include "dcm_cell_table.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace dcm {
class FrictionSystem;
class StiffnessSystem;
}    // namespace dcm

namespace LAMMPS_NS {

// What a style of this package is to the others, so that none of them needs to know its name:
// mixed into a fix, pair, bond or dihedral style, found with of().
//
// LAMMPS calls Pair::init_style() before Fix::init(): a fix cannot tell a pair style what it is
// about to do, but can be asked.

class DCMRole {
 public:
  enum Trait : unsigned {
    MOVES = 1U,              // solves for velocities, wants the friction of all others
    GIVES_PRESSURE = 2U,     // contributes to the pressure of deformable cells
    GROWS_SPHERES = 4U,      // radii of spheres grow in a run, or larger spheres come
    MAKES_CELLS = 8U,        // cells appear in a run or change their kind: empty types may fill
    MAKES_READY = 16U,       // brings cells to phase READY, to divide
    HAS_TRACERS = 32U,       // touch_faces() tells what tracers are near to
    FIXED_STEP = 64U,        // its scheme in time needs steps of one length
    IMPLICIT = 128U,         // wants the stiffness of all others as well
    CHOOSES_STEP = 256U,     // and takes steps that others stand
    SHORTENS_STEP = 512U,    // takes shorter steps than the timestep of the deck where it must
    KEEPS_PLACES = 1024U     // keeps numbers of single faces, edges or pairs of faces, which a new
                             // mesh of the cell does not have
  };

  virtual unsigned traits() const { return 0U; }

  // what the style did in this run, in a few words for the table at its end (DCMWatch); collective

  virtual std::string work() { return {}; }

  // what it has seen in this run or finds at its end that tells how good the run was, a line each,
  // below that table; collective. advice: what to do about it, empty where nothing is wrong

  struct Note {
    std::string text, advice;
  };
  virtual std::vector<Note> report() { return {}; }

  // ---- cell events, on all processes; rows are those of the table of cells

  virtual void cell_divided(const DCMCellTable::Division &) {}
  virtual void cell_removed(int /*row*/) {}                                 // before it goes
  virtual void cell_converted(int /*row*/, double /*volume0_before*/) {}    // after
  virtual void cell_retyped(int /*row*/, int /*type_before*/) {}            // after

  // ---- friction of fix dcm/motion: blocks between the unknowns that its numbering names

  virtual void list_friction(dcm::FrictionSystem &, class DCMUnknowns &) {
  }    // until the next rebuild
  virtual void add_friction(dcm::FrictionSystem &, class DCMUnknowns &) {}    // of this step

  // area of faces and spheres that is in contact, where friction with the surroundings does not
  // act; per atom, nullptr: this style covers none

  virtual const double *covered_area() const { return nullptr; }

  // add the virial of the forces that a style makes within deformable cells, the sum over their
  // nodes of force times position (nN um), six numbers per row of the table (law/symmetric.h): of
  // what this process owns. As the last forces were

  virtual void add_cell_virial(std::vector<double> &) {}

  // ---- lumens

  // faces that bound a lumen: per owned atom, 1: marked; nullptr: this style marks none. Current
  // from its own initial_integrate (or setup_pre_reverse) on, until the next one

  virtual const int *marked_faces() const { return nullptr; }

  // set `touched` (per owned atom) of faces within `range` of a tracer that is outside all cells
  // and in front of them; collective

  virtual void touch_faces(double /*range*/, std::vector<int> & /*touched*/) {}

  // ---- division: types and groups that both daughters of a cell take instead of their mother's;
  // asked while she still has her row, on all processes

  virtual void daughters_take(int /*row*/, DCMCellBuilder::Types &, DCMCellBuilder::Masks &) {}

  // ---- stiffness of a linearly implicit step (fix dcm/motion scheme implicit), asked for when the
  // forces of the step are there: blocks of law/stiffness.h, all positive semidefinite

  virtual void add_stiffness(dcm::StiffnessSystem &, class DCMUnknowns &) {}

  // factors on the rest state of a cell from now, when the forces are known, to the end of the step
  // that begins: on its rest volume and, beyond what follows from that, on its rest lengths

  struct RestAhead {
    double volume0 = 1.0, length = 1.0;
    double lengths() const { return std::cbrt(volume0) * length; }    // all in all
  };

  // tell, for a step of length dt: multiply the factors of rows of the table (the same on all
  // processes); true if any is not 1

  virtual bool rest_ahead(double /*dt*/, std::vector<RestAhead> &) { return false; }

  // add what that changes of the forces: per slot, STRIDE numbers, after add_stiffness()

  virtual void add_ahead(const std::vector<RestAhead> &, std::vector<double> & /*forces*/,
                         class DCMUnknowns &)
  {
  }

  // ---- bodies that move as the deck says. Bits of the groups whose nodes and spheres this style
  // moves; mean velocity of one of them, an owned atom, over a step of length dt from now; and what
  // the others do to it: none yet, then the force on each owned atom (nN)

  virtual int moved_bits() const { return 0; }
  virtual int solved_bits() const { return 0; }    // and of what it solves for (MOVES)
  virtual void move_body(int /*i*/, double /*dt*/, double * /*v*/) {}
  virtual void begin_load() {}
  virtual void add_load(int /*i*/, const double * /*force*/) {}

  // ---- steps of chosen length; the same on all processes: time from now to the next event that a
  // step should end at (a cell gets ready), and the longest step that the style's own scheme in
  // time stands (a ramp, a controller)

  virtual double next_event() { return std::numeric_limits<double>::infinity(); }
  virtual double longest_step() { return std::numeric_limits<double>::infinity(); }

  // all styles of the deck with a role: bond, dihedral and pair styles (those of hybrid styles as
  // well), then fixes in the order of the deck

  static std::vector<DCMRole *> of(class LAMMPS *);
  static unsigned traits_of(class LAMMPS *);    // of any of them

  // steps between two looks at the cells: as given, 0: `usual`, but every step where steps are
  // chosen as long as they may be

  static int look_every(class LAMMPS *, int given, int usual);
  static DCMRole *marker_of(class LAMMPS *);    // the one that marks faces, nullptr: none

  // errors in init() of a fix that decides in initial_integrate: it has to come before the fix that
  // moves atoms, and after all fixes of a style whose decisions of this step it uses

  static void check_before_motion(class LAMMPS *, const class Fix *, const std::string &asking);
  static void check_after(class LAMMPS *, const class Fix *, const std::string &asking,
                          const std::string &style);

 protected:
  ~DCMRole() = default;
};

}    // namespace LAMMPS_NS

#endif
