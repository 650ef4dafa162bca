/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(dcm/cell,FixDCMCell);
// clang-format on
#else

#ifndef LMP_FIX_DCM_CELL_H
#define LMP_FIX_DCM_CELL_H

#include "fix.h"

#include <vector>

namespace LAMMPS_NS {

// Owner of what several styles need of the deformable cells: who belongs to which cell, the faces
// with their vertices and areas, the sums over each cell, and on request normals and curvature.
// Exactly one per deck; the other styles find it with FixDCMCell::require().
//
// valid from pre_neighbor (each rebuild) on:   faces, face_of, cell_of, cells (membership)
// valid from pre_force (each step) on:         area, normals(), cells (volume, area, x), curvature

class FixDCMCell : public Fix {
 public:
  struct Face {
    int atom;    // local index of the face atom
    int v[3];    // local indices of its vertices (closest images), -1: beyond the ghost cutoff
    int cell;    // index into cells
  };

  struct Cell {    // one per deformable cell, the same on all ranks, sorted by molecule
    tagint molecule, center_tag;
    int type;    // atom type of the center
    int mask;    // group mask of the center
    int nnodes, nfaces;
    double volume0;    // rest volume
    double volume, area;
    double x[3];        // mean of the nodes, unwrapped next to the center atom
    double pressure;    // set by fix dcm/volume, else 0
  };

  int nowned = 0;    // faces[0..nowned) are owned, the others ghosts
  std::vector<Face> faces;
  std::vector<int> face_of;    // per owned + ghost atom: index into faces, -1: no face
  std::vector<int> cell_of;    // per owned + ghost atom: index into cells, -1: none
  std::vector<Cell> cells;
  std::vector<double> area;         // per face
  std::vector<double> curvature;    // per atom: signed scalar 2H of nodes, if requested

  FixDCMCell(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_neighbor() override;
  void pre_neighbor() override;
  void setup_pre_force(int) override;
  void pre_force(int) override;

  // what other styles ask for in their init()
  void request_curvature() { want_curvature = true; }
  void set_contact_range(double range) { contact_range = range; }

  // per face 3: outward unit normal (0 for a degenerate face); computed when first called in a step
  const double *normals();

  // index into cells of a molecule ID, -1: not a deformable cell
  int find_cell(tagint molecule) const;

  // sum `values` (n per cell) over all ranks
  void sum(std::vector<double> &values) const;

  // re-read volume0, type and mask of the centers after somebody has changed them
  void refresh_centers();

  // mean edge length over all faces of a cell type's cells at the last rebuild
  double mean_edge() const { return edge_mean; }

  // the one instance; error naming the asking style when there is none
  static FixDCMCell *require(class LAMMPS *, const std::string &asking);

  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  int image(int *&, double **&) override;
  int modify_param(int, char **) override;
  double memory_usage() override;

 private:
  enum Comm { GEOMETRY, CURVATURE };

  // one line of a rest-state file: the atoms of a bond or dihedral and its rest value

  struct RestValue {
    tagint tag[4];    // bond: two tags and zeros
    double value;
  };

  struct DCMAtoms *dcm;
  Comm commflag = GEOMETRY;
  bool want_curvature = false;
  double contact_range = 0.0, edge_mean = 0.0;
  std::vector<double> node_sums;    // per atom 7: Laplace vector, normal, mixed Voronoi area
  std::vector<double> cell_sums;
  std::vector<double> normal;    // of the faces as they were when has_normals was set
  bool has_normals = false;
  std::vector<int> image_kind;
  std::vector<double> image_values;
  std::vector<double *> image_rows;

  void gather_cells();
  void count_members();
  void snap_centers();
  void build_faces();
  void missing_vertex(int, tagint);
  void move_faces();
  void measure_faces();
  void measure_cells();
  void measure_curvature();
  void check_surfaces();
  void write_rest_state(const std::string &);
  void read_rest_state(const std::string &);
  void collect_rest_values(std::vector<RestValue> &) const;
  bigint apply_rest_value(const RestValue &);
};

}    // namespace LAMMPS_NS

#endif
#endif
