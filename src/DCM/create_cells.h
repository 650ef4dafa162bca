/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(create_cells,CreateCells);
// clang-format on
#else

#ifndef LMP_CREATE_CELLS_H
#define LMP_CREATE_CELLS_H

#include "command.h"
#include "dcm_cell_builder.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// create_cells single NAME dcm|cbm x y z R keyword ...
// create_cells table FILE keyword ...
// create_cells meshes NAME x y z PATH ... keyword ...

class CreateCells : public Command {
 public:
  CreateCells(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;

 private:
  struct Request {    // one cell to create
    std::string name;
    bool deformable;
    dcm::Vec3 x;            // its place; of a cell that keeps its own: the way it is moved
    double radius = 0.0;    // 0: its own
    std::string file;       // its own mesh, "": that of keyword mesh
    std::string where;      // what it was asked for in, for messages
    int shape = 0;
  };
  struct Shape {
    std::string file;
    int cell;          // the first that has it, from 1; 0: that of keyword mesh
    dcm::Mesh mesh;    // as given
    DCMCellBuilder::Topology top;
  };

  std::map<std::pair<std::string, bool>, DCMCellBuilder::Types> types;    // by name and deformable
  std::vector<Request> requests;
  std::vector<Shape> shapes;
  double rest = 1.0;
  double overlap = 0.0;    // most that cells of own place may share, 0: default
  int rotate_seed = 0;
  bool equal_volume = true, keep = false;    // keyword scale

  void read_table(const std::string &);
  void add_request(const std::vector<std::string> &, const std::string &);
  void parse_keywords(class DCMArgs &, bool meshes);
  dcm::Vec3 point(const std::vector<std::string> &, const std::string &) const;
  double number(const std::string &, const std::string &) const;
  DCMCellBuilder::Types find_types(const Request &) const;
  DCMCellBuilder::Deformable make(const Request &, tagint) const;

  // create_cells_meshes.cpp
  void add_files(const std::string &, const Request &);
  void find_shapes(const DCMCellBuilder &);
  std::string fault_of(Shape &) const;
  bool own_place(const Request &) const;
  std::string called(size_t) const;
  dcm::Vec3 middle(const Request &) const;
  void check_place(size_t) const;
  double allowed_overlap() const;
  void check_overlaps() const;
};

}    // namespace LAMMPS_NS

#endif
#endif
