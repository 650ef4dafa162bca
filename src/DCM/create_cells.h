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
#include "dcm_mesh.h"

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
  struct CellType {    // atom, bond and dihedral types of a named cell type
    int center, node, face, bond, dihedral;
  };

  struct Request {    // one cell to create
    std::string name;
    bool deformable;
    dcm::Vec3 x;
    double radius;
  };

  struct DCMAtoms *dcm = nullptr;
  std::map<std::pair<std::string, bool>, CellType> types;    // by name and deformable
  std::vector<Request> requests;
  dcm::Mesh mesh;    // shape of all deformable cells, mean radius 1
  std::vector<std::array<int, 4>> hinges;
  std::vector<int> owner;    // per hinge: 1 or 2, which end of the edge stores bond and dihedral
  int slots = 0;             // most bonds stored at one node
  double rest = 1.0;
  int rotate_seed = 0;
  bool equal_volume = true;

  void read_table(const std::string &);
  void add_request(const std::vector<std::string> &, const std::string &);
  int parse_keyword(int, char **);
  void prepare_mesh();
  void reserve_slots();
  bool create(const double *, int, int, tagint, tagint);
  void create_sphere(const Request &, tagint, tagint);
  void create_deformable(const Request &, tagint, tagint);
  double number(const std::string &, const std::string &) const;
  int type_number(const std::string &, const std::string &, int) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
