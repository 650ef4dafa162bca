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
#include "dcm_args.h"
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
  } else if (source == "meshes") {
    if (narg < 6) utils::missing_cmd_args(FLERR, "create_cells meshes", error);
    iarg = 5;
  } else {
    error->all(FLERR, "Create_cells: unknown source {}; use single, table or meshes", source);
  }

  DCMArgs args(lmp, "Create_cells", narg - iarg, arg + iarg,
               {"dcm", "cbm", "mesh", "overlap", "rest", "rotate", "scale"});
  args.may_repeat({"dcm", "cbm"});
  if (source == "meshes") {
    Request request;
    request.name = arg[1];
    request.deformable = true;
    request.where = "meshes";
    request.x = point({arg + 2, arg + 5}, request.where);
    if (args.keyword_ahead())
      error->all(FLERR, "Create_cells: meshes: name mesh files, or folders of them, after x y z");
    while (!args.keyword_ahead()) add_files(args.take(), request);
  }
  shapes.push_back({"", 0, dcm::icosphere(3), {}});
  parse_keywords(args, source == "meshes");
  DCMCellBuilder builder(lmp, "Create_cells", true);
  find_shapes(builder);

  int slots = 0;
  for (size_t n = 0; n < requests.size(); n++) {
    find_types(requests[n]);
    check_place(n);
    if (requests[n].deformable) slots = std::max(slots, shapes[requests[n].shape].top.slots);
  }
  check_overlaps();
  if (slots) builder.reserve_slots(slots);

  // tags and molecules follow those that exist

  tagint last[2] = {0, 0};
  const int nlocal_previous = atom->nlocal;
  for (int i = 0; i < nlocal_previous; i++) {
    last[0] = std::max(last[0], atom->tag[i]);
    last[1] = std::max(last[1], atom->molecule[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, last, 2, MPI_LMP_TAGINT, MPI_MAX, world);

  tagint ids = 0;
  for (const auto &request : requests)
    ids += request.deformable ? shapes[request.shape].top.size() : 1;
  if (last[0] > MAXTAGINT - ids)
    error->all(FLERR,
               "Create_cells: no atom IDs are left for {} new atoms: they count on from the "
               "highest, {}; give the atoms of the data file lower ones",
               ids, last[0]);

  bigint ncreated[2] = {0, 0}, natoms = 0;
  if (const auto *const fix = FixDCMCell::find(lmp))    // IDs of dead cells stay theirs
    last[1] = std::max(last[1], fix->cells().last_molecule());
  if (last[1] > MAXTAGINT - (tagint) requests.size())
    error->all(FLERR,
               "Create_cells: no molecule IDs are left for {} new cells: they count on from the "
               "highest, {}; give the cells lower ones with 'set group ... mol'",
               requests.size(), last[1]);
  tagint tag = last[0] + 1, molecule = last[1] + 1;
  bigint nhinges = 0;
  size_t least = 0, most = 0;    // nodes of a cell
  for (const auto &request : requests) {
    const auto type = find_types(request);
    tagint used = 1;
    if (request.deformable) {
      const auto &top = shapes[request.shape].top;
      DCMCellBuilder::Deformable cell = make(request, molecule);
      cell.tag = tag;
      builder.create(type, top, cell);
      used = top.size();
      nhinges += (bigint) top.hinges.size();
      most = std::max(most, top.mesh.nodes.size());
      least = least ? std::min(least, top.mesh.nodes.size()) : most;
    } else {
      DCMCellBuilder::Sphere cell;
      cell.molecule = molecule;
      cell.tag = tag;
      cell.x = request.x;
      cell.radius = request.radius;
      builder.create(type, cell);
    }
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
  atom->nbonds += nhinges;
  atom->ndihedrals += nhinges;
  atom->tag_check();
  if (atom->map_style != Atom::MAP_NONE) {
    atom->nghost = 0;
    atom->map_init();
    atom->map_set();
  }
  if (comm->me == 0)
    utils::logmesg(lmp, "Created {} deformable cells{} and {} center-based cells\n", ncreated[1],
                   least < most  ? fmt::format(" of {} to {} nodes", least, most)
                   : ncreated[1] ? fmt::format(" of {} nodes", most)
                                 : "",
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
  request.where = where;
  request.x = point({words.begin() + 2, words.begin() + 5}, where);
  if (request.deformable && dcm::is_mesh_file(words[5])) {
    add_files(words[5], request);
    return;
  }
  request.radius = number(where, words[5]);
  requests.push_back(request);
}

/* ----------------------------------------------------------------------
   the types of each cell type's atoms, and the shape of deformable cells
------------------------------------------------------------------------- */

void CreateCells::parse_keywords(DCMArgs &args, bool meshes)
{
  std::string moves;    // a keyword that cells at their own place cannot have
  while (args.next()) {
    if (args.is("dcm")) {
      args.need(6);
      const std::string name = args.text();
      DCMCellBuilder::Types given;
      given.center = args.type(atom->ntypes);
      given.node = args.type(atom->ntypes);
      given.face = args.type(atom->ntypes);
      given.bond = args.type(atom->nbondtypes);
      given.dihedral = args.type(atom->ndihedraltypes);
      if (given.center == given.node || given.node == given.face || given.face == given.center)
        error->all(FLERR,
                   "Create_cells: cell type {}: center, node and face need three different "
                   "atom types",
                   name);
      types[{name, true}] = given;
    } else if (args.is("cbm")) {
      args.need(2);
      const std::string name = args.text();
      const int given = args.type(atom->ntypes);
      types[{name, false}] = {given, given, given, 0, 0};
    } else if (args.is("mesh")) {
      args.need(2);
      const bool file = args.choose({"icosphere", "file"}, "icosphere LEVEL or file PATH") == 1;
      try {
        shapes[0].file = file ? args.text() : "";
        if (!file) shapes[0].mesh = dcm::icosphere((int) args.whole(-MAXSMALLINT));
      } catch (LAMMPSException &) {
        throw;
      } catch (std::exception &e) {
        error->all(FLERR, "Create_cells: {}", e.what());
      }
      if (meshes) moves = "mesh";
    } else if (args.is("rest")) {
      rest = args.number();
      args.check(rest > 0.0 && rest <= 2.0, "above 0 and at most 2");
    } else if (args.is("rotate")) {
      rotate_seed = (int) args.whole();
      if (meshes) moves = "rotate";
    } else if (args.is("overlap")) {
      overlap = args.number(DCMArgs::POSITIVE);
    } else {
      const int scale = args.choose({"volume", "nodes", "none"});
      keep = scale == 2;
      equal_volume = scale != 1;
      if (meshes && !keep) moves = "scale";
    }
  }
  if (!moves.empty())
    error->all(FLERR,
               "Create_cells: the cells of meshes have the size and place of their files; remove "
               "keyword {}",
               moves);
  if (keep && !meshes && shapes[0].file.empty())
    error->all(FLERR,
               "Create_cells: scale none takes size and place from a mesh file, an icosphere has "
               "none; add 'mesh file PATH' or use scale volume");
  if (keep && rotate_seed)
    error->all(FLERR,
               "Create_cells: scale none leaves cells as the file has them; remove keyword rotate");
  for (const auto &request : requests)
    if (!own_place(request) && request.radius <= 0.0)
      error->all(FLERR, "Create_cells: {}: radius is {}, must be positive", request.where,
                 request.radius);
}

double CreateCells::number(const std::string &where, const std::string &text) const
{
  if (!utils::is_double(text))
    error->all(FLERR, "Create_cells: {}: '{}' is not a number", where, text);
  const double value = utils::numeric(FLERR, text, false, lmp);
  if (!std::isfinite(value)) error->all(FLERR, "Create_cells: {}: {} is not finite", where, text);
  return value;
}

Vec3 CreateCells::point(const std::vector<std::string> &words, const std::string &where) const
{
  return {number(where, words[0]), number(where, words[1]), number(where, words[2])};
}

DCMCellBuilder::Types CreateCells::find_types(const Request &request) const
{
  const auto type = types.find({request.name, request.deformable});
  if (type == types.end())
    error->all(FLERR, "Create_cells: no atom types for {} cells of type {}; add '{} {} {}'",
               request.deformable ? "deformable" : "center-based", request.name,
               request.deformable ? "dcm" : "cbm", request.name,
               request.deformable ? "Tcenter Tnode Tface Tbond Tdihedral" : "Tsphere");
  return type->second;
}

/* ----------------------------------------------------------------------
   the cell of a request, at rest but for the prestress of its cortex
------------------------------------------------------------------------- */

DCMCellBuilder::Deformable CreateCells::make(const Request &request, tagint molecule) const
{
  const auto &top = shapes[request.shape].top;
  const double size = own_place(request) ? top.scale : request.radius;
  const Vec3 mid = middle(request);
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (rotate_seed && !own_place(request)) {
    dcm::Random random(rotate_seed, molecule, 0);
    const Vec3 v = random.gaussian_vector();
    rotation = Eigen::Quaterniond(random.gaussian(), v[0], v[1], v[2]).normalized();
  }
  DCMCellBuilder::Deformable cell;
  cell.molecule = molecule;
  cell.volume0 = std::pow(size, 3) * dcm::volume(top.mesh);
  for (const auto &node : top.mesh.nodes) cell.x.push_back(mid + size * (rotation * node));
  DCMCellBuilder::set_round_rest(top, rest, cell);
  return cell;
}
