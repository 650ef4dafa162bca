/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "create_cells.h"

#include "atom.h"
#include "atom_vec.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "law/mesh_io.h"
#include "law/random.h"
#include "dcm_text.h"
#include "domain.h"
#include "fix_dcm_cell.h"
#include "modify.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "tokenizer.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using dcm::Vec3;

/* ---------------------------------------------------------------------- */

void CreateCells::command(int narg, char **arg)
{
  if (!domain->box_exist)
    error->all(FLERR, "Create_cells command before simulation box is defined");
  AtomVecDCM::require(lmp, "Create_cells");
  if (!force->newton_bond) error->all(FLERR, "Create_cells needs newton on; remove 'newton off'");
  if (narg < 2) utils::missing_cmd_args(FLERR, "create_cells", error);

  int iarg = 2;
  const std::string source = arg[0];
  if (source == "table") {
    read_table(arg[1]);
  } else if (source == "single") {
    if (narg < 7) utils::missing_cmd_args(FLERR, "create_cells single", error);
    add_request({arg + 1, arg + 7}, "single");
    iarg = 7;
  } else {
    error->all(FLERR, "Create_cells: unknown source {}; use single or table", source);
  }

  mesh = dcm::icosphere(3);
  while (iarg < narg) iarg += parse_keyword(narg - iarg, arg + iarg);
  DCMCellBuilder builder(lmp, "Create_cells", true);
  top = builder.prepare(mesh, equal_volume);

  bool deformable = false;
  for (const auto &request : requests) {
    const auto type = types.find({request.name, request.deformable});
    if (type == types.end())
      error->all(FLERR, "Create_cells: no atom types for {} cells of type {}; add '{} {} {}'",
                 request.deformable ? "deformable" : "center-based", request.name,
                 request.deformable ? "dcm" : "cbm", request.name,
                 request.deformable ? "Tcenter Tnode Tface Tbond Tdihedral" : "Tsphere");
    deformable = deformable || request.deformable;
  }
  if (deformable) builder.reserve_slots(top.slots);

  // tags and molecules follow those that exist

  tagint last[2] = {0, 0};
  const int nlocal_previous = atom->nlocal;
  for (int i = 0; i < nlocal_previous; i++) {
    last[0] = std::max(last[0], atom->tag[i]);
    last[1] = std::max(last[1], atom->molecule[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, last, 2, MPI_LMP_TAGINT, MPI_MAX, world);

  bigint ncreated[2] = {0, 0}, natoms = 0;
  tagint tag = last[0] + 1, molecule = last[1] + 1;
  for (auto *fix : modify->get_fix_by_style("^dcm/cell$"))    // IDs of dead cells stay theirs
    molecule = std::max(molecule, dynamic_cast<FixDCMCell *>(fix)->cells().last_molecule() + 1);
  for (const auto &request : requests) {
    const auto &type = types[{request.name, request.deformable}];
    if (request.deformable) {
      DCMCellBuilder::Deformable cell = shape(request, molecule);
      cell.tag = tag;
      builder.create(type, top, cell);
    } else {
      DCMCellBuilder::Sphere cell;
      cell.molecule = molecule;
      cell.tag = tag;
      cell.x = request.x;
      cell.radius = request.radius;
      builder.create(type, cell);
    }
    const tagint used = request.deformable ? top.size() : 1;
    tag += used;
    natoms += used;
    ncreated[request.deformable]++;
    molecule++;
  }

  bigint nlocal = atom->nlocal - nlocal_previous, nall;
  MPI_Allreduce(&nlocal, &nall, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (nall != natoms)
    error->all(FLERR,
               "Create_cells: {} of {} atoms lie outside the box; enlarge the box or move "
               "the cells",
               natoms - nall, natoms);
  atom->data_fix_compute_variable(nlocal_previous, atom->nlocal);
  atom->natoms += natoms;
  atom->nbonds += ncreated[1] * (bigint) top.hinges.size();
  atom->ndihedrals += ncreated[1] * (bigint) top.hinges.size();
  atom->tag_check();
  if (atom->map_style != Atom::MAP_NONE) {
    atom->nghost = 0;
    atom->map_init();
    atom->map_set();
  }
  if (comm->me == 0)
    utils::logmesg(lmp, "Created {} deformable cells{} and {} center-based cells\n", ncreated[1],
                   ncreated[1] ? fmt::format(" of {} nodes", top.mesh.nodes.size()) : "",
                   ncreated[0]);
}

/* ----------------------------------------------------------------------
   rank 0 reads the table, all parse it: lines of NAME dcm|cbm x y z R
------------------------------------------------------------------------- */

void CreateCells::read_table(const std::string &file)
{
  std::string text;
  if (!dcm_read_text(comm, world, file, text))
    error->all(FLERR, "Create_cells: cannot open cells table {}", file);
  for (const auto &line : Tokenizer(text, "\n").as_vector()) {
    const auto words = Tokenizer(line.substr(0, line.find('#'))).as_vector();
    if (!words.empty()) add_request(words, "table " + file + ": '" + utils::trim(line) + "'");
  }
  if (requests.empty()) error->all(FLERR, "Create_cells: cells table {} names no cell", file);
}

void CreateCells::add_request(const std::vector<std::string> &words, const std::string &where)
{
  if (words.size() != 6 || (words[1] != "dcm" && words[1] != "cbm"))
    error->all(FLERR, "Create_cells: {}: expected NAME dcm|cbm x y z radius", where);
  Request request;
  request.name = words[0];
  request.deformable = (words[1] == "dcm");
  for (int k = 0; k < 3; k++) request.x[k] = number(where, words[2 + k]);
  request.radius = number(where, words[5]);
  if (request.radius <= 0.0)
    error->all(FLERR, "Create_cells: {}: radius is {}, must be positive", where, request.radius);
  requests.push_back(request);
}

/* ---------------------------------------------------------------------- */

int CreateCells::parse_keyword(int narg, char **arg)
{
  const std::string keyword = arg[0];
  auto need = [&](int n) {
    if (narg <= n)
      error->all(FLERR, "Create_cells: keyword {} needs {} values, got {}", keyword, n, narg - 1);
    return n + 1;
  };

  if (keyword == "dcm") {
    const int used = need(6);
    DCMCellBuilder::Types type;
    type.center = type_number(keyword, arg[2], atom->ntypes);
    type.node = type_number(keyword, arg[3], atom->ntypes);
    type.face = type_number(keyword, arg[4], atom->ntypes);
    type.bond = type_number(keyword, arg[5], atom->nbondtypes);
    type.dihedral = type_number(keyword, arg[6], atom->ndihedraltypes);
    if (type.center == type.node || type.node == type.face || type.face == type.center)
      error->all(FLERR,
                 "Create_cells: cell type {}: center, node and face need three different "
                 "atom types",
                 arg[1]);
    types[{arg[1], true}] = type;
    return used;
  }
  if (keyword == "cbm") {
    const int used = need(2);
    const int type = type_number(keyword, arg[2], atom->ntypes);
    types[{arg[1], false}] = {type, type, type, 0, 0};
    return used;
  }
  if (keyword == "mesh") {
    const int used = need(2);
    try {
      if (strcmp(arg[1], "icosphere") == 0)
        mesh = dcm::icosphere(utils::inumeric(FLERR, arg[2], false, lmp));
      else if (strcmp(arg[1], "file") == 0)
        mesh = dcm::read_mesh(arg[2]);
      else
        error->all(FLERR, "Create_cells: unknown mesh {}; use icosphere LEVEL or file PATH",
                   arg[1]);
    } catch (LAMMPSException &) {
      throw;
    } catch (std::exception &e) {
      error->all(FLERR, "Create_cells: {}", e.what());
    }
    return used;
  }
  if (keyword == "rest") {
    const int used = need(1);
    rest = number(keyword, arg[1]);
    if (rest <= 0.0 || rest > 2.0)
      error->all(FLERR, "Create_cells: rest is {}, must be above 0 and at most 2", rest);
    return used;
  }
  if (keyword == "rotate") {
    const int used = need(1);
    rotate_seed = utils::inumeric(FLERR, arg[1], false, lmp);
    if (rotate_seed <= 0)
      error->all(FLERR, "Create_cells: rotate needs a positive seed, not {}", rotate_seed);
    return used;
  }
  if (keyword == "scale") {
    const int used = need(1);
    if (strcmp(arg[1], "volume") != 0 && strcmp(arg[1], "nodes") != 0)
      error->all(FLERR, "Create_cells: scale is {}, must be volume or nodes", arg[1]);
    equal_volume = (strcmp(arg[1], "volume") == 0);
    return used;
  }
  error->all(FLERR, "Create_cells: unknown keyword {}; known: dcm cbm mesh rest rotate scale",
             keyword);
  return 0;
}

double CreateCells::number(const std::string &where, const std::string &text) const
{
  if (!utils::is_double(text))
    error->all(FLERR, "Create_cells: {}: '{}' is not a number", where, text);
  const double value = utils::numeric(FLERR, text, false, lmp);
  if (!std::isfinite(value)) error->all(FLERR, "Create_cells: {}: {} is not finite", where, text);
  return value;
}

int CreateCells::type_number(const std::string &where, const std::string &text, int ntypes) const
{
  if (!utils::is_integer(text))
    error->all(FLERR, "Create_cells: {}: '{}' is not a type number", where, text);
  const int type = utils::inumeric(FLERR, text, false, lmp);
  if (type < 1 || type > ntypes)
    error->all(FLERR, "Create_cells: {}: type {} is not between 1 and {}; reserve it in create_box",
               where, type, ntypes);
  return type;
}

/* ----------------------------------------------------------------------
   the round cell of a request, at rest but for the prestress of its cortex
------------------------------------------------------------------------- */

DCMCellBuilder::Deformable CreateCells::shape(const Request &request, tagint molecule) const
{
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (rotate_seed) {
    dcm::Random random(rotate_seed, molecule, 0);
    const Vec3 v = random.gaussian_vector();
    rotation = Eigen::Quaterniond(random.gaussian(), v[0], v[1], v[2]).normalized();
  }
  DCMCellBuilder::Deformable cell;
  cell.molecule = molecule;
  cell.volume0 = std::pow(request.radius, 3) * dcm::volume(top.mesh);
  for (const auto &node : top.mesh.nodes)
    cell.x.push_back(request.x + request.radius * (rotation * node));
  DCMCellBuilder::set_round_rest(top, rest, cell);
  return cell;
}
