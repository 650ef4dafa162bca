/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/cell,DCMTimedFix<FixDCMCell>);
// clang-format on
#else

#ifndef LMP_FIX_DCM_CELL_H
#define LMP_FIX_DCM_CELL_H

#include "dcm_cell_table.h"
#include "dcm_request.h"
#include "dcm_role.h"
#include "dcm_timed.h"
#include "fix.h"
#include "law/cell_sharing.h"

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Owner of what several styles need of cells: the table of cells of both kinds, who belongs to
// which cell, the faces of deformable cells with their vertices and areas, the sums over each cell,
// and on request curvature and adjacency. Exactly one per deck; the other styles find it with
// require().
//
// valid from pre_neighbor (each rebuild) on:   faces, face_of, cell_of, membership in the table
// valid from pre_force (each step) on:         area, volume, area and x of cells, curvature

class FixDCMCell : public Fix, public DCMRole {
 public:
  struct Face {
    int atom;    // local index of the face atom
    int v[3];    // local indices of its vertices (closest images), -1: beyond the ghost cutoff
    int cell;    // row of the table of cells
    bool torn = false;    // of a ghost at the border of what is known here: a vertex is another
                          // periodic image than the face is

    // are all vertices known, in the image of the face? Always so for owned faces.
    bool whole() const { return v[0] >= 0 && v[1] >= 0 && v[2] >= 0 && !torn; }
  };

  FixDCMCell(class LAMMPS *, int, char **);
  ~FixDCMCell() override;
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup_pre_neighbor() override;
  void pre_neighbor() override;
  void setup_pre_force(int) override;
  void pre_force(int) override;
  void min_pre_neighbor() override { pre_neighbor(); }
  void min_pre_force(int vflag) override { pre_force(vflag); }
  void write_restart(FILE *) override;
  void restart(char *) override;

  // cell types of the deck (keyword types) for styles without names of their own, nullptr: not
  // given
  const class DCMParameters *cell_types() const { return types.get(); }

  // the table; to be changed only by those who change the atoms as well

  const DCMCellTable &cells() const { return table; }
  DCMCellTable &change_cells() { return table; }

  int nowned() const { return nowned_faces; }    // faces()[0..nowned()) are owned, others ghosts
  const std::vector<Face> &faces() const { return face_list; }
  int face_of(int i) const { return face_of_atom[i]; }    // owned or ghost atom; -1: no face
  int cell_of(int i) const { return cell_of_atom[i]; }    // row of the table; -1: none
  double area(int f) const { return face_area[f]; }

  // outward unit normals, 3 numbers a face, 0 for a degenerate one; computed when first asked for
  // in a step

  const double *normals();

  // signed scalar 2H of nodes, owned and ghost, per atom; while requested

  double curvature(int i) const { return node_curvature[i]; }

  // requests: ask in init(), every run, and keep the handle

  DCMRequest<> request_curvature() { return curvature_wanted.add(); }
  DCMRequest<> request_adjacency() { return adjacency_wanted.add(); }
  DCMRequest<> request_spheres() { return spheres_wanted.add(); }
  DCMRequest<double> request_contact_range(double range) { return ranges.add(range); }

  // the faces around a node (owned, or ghost as far as its faces are known) and the two at an edge;
  // each face once, in the order of their atom IDs; -1: not known here. While requested, from
  // pre_neighbor on

  std::vector<int> faces_of_node(int i) const;
  std::array<int, 2> faces_of_edge(int i, int j) const;

  // region of an owned face; collective update_regions() after the last change of a step makes
  // those of ghost faces current

  void set_region(int f, int region);
  void update_regions();

  // rows of the deformable cells whose center atom this process owns: each cell is counted once

  const std::vector<int> &owned_cells() const { return centers; }

  // sums over the processes, `width` numbers per row of the table, of deformable cells only.
  // sum: all rows, over all processes; for what is not done in every step. sum_shared: only rows of
  // cells that have atoms here, ghosts included (DCMCellTable::deformable); sum_owned: only of
  // cells that own atoms here, as needed for forces on them. The latter two cost what is near, and
  // are the same to the last bit on all that share a cell. begin_sum makes room and zeros for these
  // two

  void sum(std::vector<double> &values, int width);
  void begin_sum(std::vector<double> &values, int width) const;
  void sum_shared(std::vector<double> &values, int width) { sharing.sum(values.data(), width); }
  void sum_owned(std::vector<double> &values, int width)
  {
    sharing.sum(values.data(), width, true);
  }
  dcm::CellSharing &shared_cells() { return sharing; }

  // volume, area, x and columns EACH_STEP of cells elsewhere as well: to be called by whoever reads
  // those of all(), on all processes alike; once a step it costs a sum over all cells
  void update_all();

  // take in cells, or values of their atoms, that somebody has changed; collective

  void refresh();

  // mean edge length over all faces of a cell type's cells at the last rebuild
  double mean_edge() const { return edge_mean; }

  // edge of a deformable cell's mean face, from its area in this step
  double mean_edge(int row) const;

  // the one instance, nullptr if the deck has none; or an error naming the asking style
  static FixDCMCell *find(class LAMMPS *);
  static FixDCMCell *require(class LAMMPS *, const std::string &asking);

  // for values that are asked for between two runs: errors if the deck has removed, since the last
  // step, this fix, the pair style, or has changed the atoms (as do delete_atoms, write_restart)
  static void check_current(class LAMMPS *, const std::string &asking, const FixDCMCell *cell);
  static void check_current(class LAMMPS *, const std::string &asking,
                            const class PairDCMContact *contact);
  void check_atoms(const std::string &asking) const;

  // make one if the deck has none, for styles that work without deformable cells: in
  // post_constructor
  static void ensure(class LAMMPS *, const std::string &asking);
  bool expects_deformable() const { return by_deck; }    // the deck has asked for it

  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  int image(int *&, double **&) override;
  int modify_param(int, char **) override;
  double memory_usage() override;
  std::vector<Note> report() override;

 private:
  enum Comm { GEOMETRY, CURVATURE, REGION };
  static constexpr int NCURVATURE =
      7;    // sums per node: Laplace vector, normal, mixed Voronoi area

  struct DCMAtoms *dcm;
  std::unique_ptr<class DCMParameters> types;
  DCMCellTable table;
  int nowned_faces = 0;
  std::vector<Face> face_list;
  std::vector<int> face_of_atom, cell_of_atom;
  std::vector<double> face_area, face_normal;
  std::vector<double> node_curvature;
  bool normals_current = false, by_deck = true;
  DCMRequests<> curvature_wanted, adjacency_wanted, spheres_wanted;
  DCMRequests<double> ranges;    // of contact

  Comm commflag = GEOMETRY;
  double edge_mean = 0.0;
  std::vector<double> node_sums;    // per atom, for the curvature
  std::vector<double> cell_sums, packed;
  dcm::CellSharing sharing;
  std::vector<int> centers;
  std::vector<char> parts;                  // what there is here of each cell
  std::vector<int> first_around, around;    // faces around each node, by the atom map's copy of it
  std::vector<int> image_kind;
  std::vector<double> image_values;
  std::vector<double *> image_rows;
  std::vector<tagint>
      known_tags;    // of all atoms, when it was found out to which cell they belong

  // new neighbor lists of the run, and of them those that a fix, by its ID, or a restart file made

  bigint nlists = 0;
  std::map<std::string, bigint> lists_for;

  void count_list();
  Note report_lists() const;
  void report_faces(std::vector<Note> &) const;

  void count_members();
  void list_centers();
  void snap_centers();
  void build_faces();
  void build_adjacency();
  void missing_vertex(int, tagint);
  void wrong_vertex(int, int);
  void wrong_kind(int);
  bool adopt_bonds(int);
  void check_width();

  // what is wrong with atoms at a rebuild: of a run an error at once, at its start that of the
  // lowest ID, so that there is one, the same on any number of processes

  struct Fault {
    tagint tag = 0;
    std::string text;
  } first_fault;
  void fault(tagint tag, const std::string &text);
  void report_fault();
  void move_faces();
  void measure_faces();
  void measure_cells();
  void measure_curvature();
  void check_surfaces();
  void check_topology();
  void check_minimize();
};

}    // namespace LAMMPS_NS

#endif
#endif
