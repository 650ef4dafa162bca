/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// command create_cells: meshes of files, and what is wrong with them, found before anything is
// created

#include "create_cells.h"

#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_args.h"
#include "dcm_cell_bins.h"
#include "dcm_compat.h"
#include "dcm_text.h"
#include "domain.h"
#include "error.h"
#include "law/contact_law.h"
#include "law/mesh_io.h"
#include "law/mesh_overlap.h"
#include "law/self_crossing.h"
#include "tokenizer.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <tuple>

using namespace LAMMPS_NS;
using dcm::Vec3;
namespace fs = std::filesystem;

// mesh files of a folder, one a line, in the order of their names; "" if it is no folder

static std::string files_of(const std::string &path)
{
  std::error_code none;
  if (!fs::is_directory(path, none)) return "";
  std::vector<std::string> names;
  for (fs::directory_iterator it(path, none), end; !none && it != end; it.increment(none))
    if (dcm::is_mesh_file(it->path().string())) names.push_back(it->path().string());
  std::sort(names.begin(), names.end());
  std::string text = "\n";
  for (const auto &name : names) text += name + "\n";
  return text;
}

/* ----------------------------------------------------------------------
   one cell for a mesh file, or for each file of a folder; rank 0 looks at the folder
------------------------------------------------------------------------- */

void CreateCells::add_files(const std::string &path, const Request &like)
{
  std::string text = comm->me == 0 ? files_of(path) : "";
  dcm_bcast(world, text);
  std::vector<std::string> names = {path};
  if (!text.empty()) names = Tokenizer(text, "\n").as_vector();
  if (names.empty())
    error->all(FLERR, "Create_cells: folder {} has no mesh files, whose names end in .off or .obj",
               path);
  for (const auto &name : names) {
    requests.push_back(like);
    requests.back().file = name;
  }
}

/* ----------------------------------------------------------------------
   a mesh for each request, read and checked: one error for all files
------------------------------------------------------------------------- */

void CreateCells::find_shapes(const DCMCellBuilder &builder)
{
  std::map<std::string, int> known;
  bool needed = false;    // the mesh of the keyword
  for (size_t n = 0; n < requests.size(); n++) {
    Request &request = requests[n];
    if (request.file.empty()) {
      needed = needed || request.deformable;
      continue;
    }
    const auto [at, fresh] = known.emplace(request.file, (int) shapes.size());
    if (fresh) shapes.push_back({request.file, (int) n + 1, {}, {}});
    request.shape = at->second;
  }

  std::string first, others;
  int nothers = 0;
  for (auto &shape : shapes) {
    if (shape.cell == 0 && shape.file.empty() && !needed) continue;
    const std::string fault = fault_of(shape);
    if (fault.empty()) {
      shape.top = builder.prepare(shape.mesh, shape.cell || equal_volume);
    } else if (first.empty()) {
      first = fault;
    } else if (nothers++ < 8) {
      others += " " + shape.file;
    }
  }
  if (!first.empty())
    error->all(FLERR, "Create_cells: {}{}", first,
               nothers ? fmt::format("; bad are also {} more:{}{}", nothers, others,
                                     nothers > 8 ? " ..." : "")
                       : "");
}

/* ----------------------------------------------------------------------
   read the file of a shape; what makes it no cell, "" if nothing does
------------------------------------------------------------------------- */

std::string CreateCells::fault_of(Shape &shape) const
{
  if (shape.file.empty()) return "";
  try {
    shape.mesh = dcm::read_mesh(shape.file);
  } catch (std::exception &e) {
    return e.what();
  }
  std::string fault = dcm::check_mesh(shape.mesh);
  if (fault.empty()) {
    const auto faces = dcm::self_crossing(shape.mesh);
    if (faces[0] >= 0)
      fault = fmt::format("the surface runs through itself at faces {} and {}; repair it, or "
                          "reconstruct the surface",
                          faces[0] + 1, faces[1] + 1);
  }
  if (fault.empty()) return "";
  return fmt::format("bad mesh {}{}: {}", shape.file,
                     shape.cell ? fmt::format(" of cell {}", shape.cell) : "", fault);
}

/* ----------------------------------------------------------------------
   place of cells; those at their own are moved by x
------------------------------------------------------------------------- */

bool CreateCells::own_place(const Request &request) const
{
  return request.deformable && (keep || !request.file.empty());
}

Vec3 CreateCells::middle(const Request &request) const
{
  return own_place(request) ? Vec3(request.x + shapes[request.shape].top.mid) : request.x;
}

// a cell for messages, by its place in the command and what tells it apart there

std::string CreateCells::called(size_t n) const
{
  const Request &request = requests[n];
  if (!request.file.empty()) return fmt::format("{} ({})", n + 1, request.file);
  return fmt::format("{} ({} at {:.6g} {:.6g} {:.6g})", n + 1, request.name, request.x[0],
                     request.x[1], request.x[2]);
}

/* ----------------------------------------------------------------------
   is all of a cell in the box? LAMMPS puts an atom back into a periodic box by one box length after
   the other
------------------------------------------------------------------------- */

void CreateCells::check_place(size_t n) const
{
  const Request &request = requests[n];
  const Vec3 mid = middle(request);
  dcm_check_point(lmp, "Create_cells", "cell at", mid.data());
  const auto &top = shapes[request.shape].top;
  double reach = request.radius;
  if (own_place(request)) {
    reach = 0.0;
    for (const auto &node : top.mesh.nodes) reach = std::max(reach, top.scale * node.norm());
  }
  for (int k = 0; request.deformable && k < 3; k++)
    if (domain->periodicity[k] && reach > domain->prd[k])
      error->all(FLERR,
                 "Create_cells: a cell of radius {} does not fit into the periodic box, which is "
                 "{:.4g} long in {}; it must be at least two cells wide",
                 reach, domain->prd[k], "xyz"[k]);
  if (!own_place(request)) return;
  for (size_t i = 0; i < top.mesh.nodes.size(); i++) {
    Vec3 x = mid + top.scale * top.mesh.nodes[i];
    const Vec3 shown = x;
    domain->remap(x.data());
    if (!domain->inside(x.data()))
      error->all(FLERR,
                 "Create_cells: cell {}: node {} at {:.6g} {:.6g} {:.6g} lies outside the box; "
                 "enlarge the box or move the cells",
                 called(n), i + 1, shown[0], shown[1], shown[2]);
  }
}

/* ----------------------------------------------------------------------
   range of adhesion that a pair style without settings will have: what contacts bear anyway
------------------------------------------------------------------------- */

double CreateCells::allowed_overlap() const
{
  if (overlap > 0.0) return overlap;
  double sum = 0.0, count = 0.0;
  for (const auto &request : requests) {
    if (!own_place(request)) continue;
    const auto &top = shapes[request.shape].top;
    const double nedges = (double) top.hinges.size();
    sum += nedges * top.scale * dcm::mean_edge(top.mesh);
    count += nedges;
  }
  return count > 0.0 ? std::max(dcm::H0_LEAST, dcm::H0_AUTO * sum / count) : dcm::H0_LEAST;
}

/* ----------------------------------------------------------------------
   cells at their own place that share more than a contact bears: faces that start on the wrong side
   see no contact. Each rank looks at its share of the cells.
------------------------------------------------------------------------- */

void CreateCells::check_overlaps() const
{
  struct Fault {
    int outer, inner, node;
    double depth;
  };
  std::vector<size_t> own;
  std::vector<double> places;
  double reach = 0.0;
  for (size_t n = 0; n < requests.size(); n++) {
    if (!own_place(requests[n])) continue;
    const auto &top = shapes[requests[n].shape].top;
    const Vec3 mid = middle(requests[n]);
    own.push_back(n);
    places.insert(places.end(), mid.data(), mid.data() + 3);
    for (const auto &node : top.mesh.nodes) reach = std::max(reach, top.scale * node.norm());
  }
  if (own.size() < 2) return;

  const double limit = allowed_overlap();
  const DCMCellBins bins(domain, places, 2.0 * reach);
  std::vector<Fault> mine;
  for (size_t a = comm->me; a < own.size(); a += comm->nprocs) {
    const Shape &outer = shapes[requests[own[a]].shape];
    const Vec3 here = middle(requests[own[a]]);
    const dcm::Envelope envelope(outer.mesh);
    for (const int b : bins.near(&places[3 * a])) {
      if ((size_t) b == a) continue;
      const Shape &inner = shapes[requests[own[b]].shape];
      Vec3 d = middle(requests[own[b]]) - here;
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      // into the frame of the envelope's file
      const auto found = dcm::mesh_overlap(envelope, inner.mesh, outer.top.mid + d - inner.top.mid);
      if (found.depth > limit)
        mine.push_back({(int) own[a], (int) own[b], found.node, found.depth});
    }
  }
  auto faults = dcm_allgather(mine, world);
  if (faults.empty()) return;
  std::sort(faults.begin(), faults.end(), [](const Fault &a, const Fault &b) {
    return std::tie(b.depth, a.outer, a.inner) < std::tie(a.depth, b.outer, b.inner);
  });
  const Fault &worst = faults[0];
  std::set<std::pair<int, int>> pairs;
  for (const auto &f : faults) pairs.insert(std::minmax(f.outer, f.inner));
  error->all(FLERR,
             "Create_cells: cell {} is {:.4g} deep{} inside cell {}, more than {:.4g}{}; mend the "
             "meshes, or allow more with 'overlap'",
             called(worst.inner), worst.depth,
             worst.node >= 0 ? fmt::format(" at node {}", worst.node + 1) : "", called(worst.outer),
             limit,
             pairs.size() > 1 ? fmt::format(" ({} more pairs do so)", pairs.size() - 1) : "");
}
