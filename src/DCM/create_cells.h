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

class CreateCells : public Command {
 public:
  CreateCells(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;

 private:
  struct Request {    // one cell to create
    std::string name;
    bool deformable;
    dcm::Vec3 x;
    double radius;
  };

  std::map<std::pair<std::string, bool>, DCMCellBuilder::Types> types;    // by name and deformable
  std::vector<Request> requests;
  DCMCellBuilder::Topology top;    // shape of all deformable cells
  double rest = 1.0;
  int rotate_seed = 0;
  dcm::Mesh mesh;    // as given
  bool equal_volume = true, from_file = false;

  void read_table(const std::string &);
  void add_request(const std::vector<std::string> &, const std::string &);
  void parse_keywords(class DCMArgs &);
  void check_place(const Request &) const;
  DCMCellBuilder::Deformable shape(const Request &, tagint) const;
  double number(const std::string &, const std::string &) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
