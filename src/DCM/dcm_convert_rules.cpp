/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// The rules of fix dcm/convert. Those that measure cells look before atoms move, at the surfaces
// and contacts of the last force evaluation, which a run that restarts there has as well.

#include "dcm_convert_rules.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "dcm_allgather.h"
#include "dcm_args.h"
#include "dcm_cell_bins.h"
#include "dcm_cell_variable.h"
#include "dcm_compat.h"
#include "dcm_role.h"
#include "domain.h"
#include "error.h"
#include "fix_dcm_cell.h"
#include "force.h"
#include "law/volume.h"
#include "modify.h"
#include "pair_dcm_contact.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using dcm::Form;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/convert";

namespace {

/* ----------------------------------------------------------------------
   region IN OUT
------------------------------------------------------------------------- */

class RegionRule : public DCMConvertRule {
 public:
  RegionRule(LAMMPS *lmp, DCMArgs &args) : DCMConvertRule(lmp)
  {
    args.need(2);
    for (auto &it : id) it = args.text();
  }

  void init(const Fix *, FixDCMCell *) override
  {
    for (int k = 0; k < 2; k++) region[k] = dcm_find_region(lmp, STYLE, id[k]);
  }

  void look(const Cells &) override
  {
    for (auto *const it : region) it->prematch();
  }

  Form wants(const Cells &cells, size_t n) const override
  {
    const double *const x = cells[n].x;
    if (region[0]->match(x[0], x[1], x[2])) return Form::DEFORMABLE;
    return region[1]->match(x[0], x[1], x[2]) ? Form::ANY : Form::SPHERE;
  }

 private:
  std::string id[2];
  Region *region[2] = {nullptr, nullptr};
};

/* ----------------------------------------------------------------------
   variable v_NAME
------------------------------------------------------------------------- */

class VariableRule : public DCMConvertRule {
 public:
  VariableRule(LAMMPS *lmp, DCMArgs &args) : DCMConvertRule(lmp), name(args.variable()) {}

  void init(const Fix *, FixDCMCell *) override { dcm_find_variable(lmp, STYLE, name); }

  void look(const Cells &cells) override
  {
    std::vector<tagint> molecules;
    for (const auto &it : cells) molecules.push_back(it.molecule);
    value = dcm_cell_variable(lmp, name, molecules);
  }

  Form wants(const Cells &, size_t n) const override
  {
    return dcm::wanted_form(value[n], 0.0, 0.0);
  }

 private:
  std::string name;
  std::vector<double> value;
};

/* ----------------------------------------------------------------------
   closer than d1 to one of some places, farther than d2 from all of them
------------------------------------------------------------------------- */

class DistanceRule : public DCMConvertRule {
 public:
  DistanceRule(LAMMPS *lmp, DCMArgs &args) : DCMConvertRule(lmp)
  {
    args.need(3);
    id = args.text();
    for (double &distance : reach) distance = args.number(DCMArgs::POSITIVE);
    if (reach[1] < reach[0])
      error->all(FLERR, "{}: {}: the second distance, {}, is below the first, {}", STYLE,
                 args.keyword(), reach[1], reach[0]);
  }

  Form wants(const Cells &cells, size_t n) const override
  {
    // all places that may be near enough stand in the bins around the cell
    double nearest = std::numeric_limits<double>::infinity();
    for (const int m : bins->near(cells[n].x)) {
      Vec3 d = vec(&places[3 * (size_t) m]) - vec(cells[n].x);
      dcm_minimum_image(domain, d[0], d[1], d[2]);
      nearest = std::min(nearest, d.norm());
    }
    return dcm::wanted_near(nearest, reach[0], reach[1]);
  }

 protected:
  std::string id;    // of a group or fix

  void sort(std::vector<double> &&at)
  {
    places = std::move(at);
    bins = std::make_unique<DCMCellBins>(domain, places, reach[1]);
  }

 private:
  double reach[2];
  std::vector<double> places;
  std::unique_ptr<DCMCellBins> bins;
};

/* ----------------------------------------------------------------------
   near GROUP d1 d2
------------------------------------------------------------------------- */

class NearRule : public DistanceRule {
 public:
  using DistanceRule::DistanceRule;

  void init(const Fix *, FixDCMCell *) override { bit = dcm_find_group(lmp, STYLE, id); }

  void look(const Cells &cells) override
  {
    std::vector<double> at;
    for (const auto &it : cells)
      if (it.mask & bit) at.insert(at.end(), it.x, it.x + 3);
    sort(std::move(at));
  }

 private:
  int bit = 0;
};

/* ----------------------------------------------------------------------
   lumen FIX d1 d2: near the faces it marks. Cells that have such faces are the wall of the lumen,
   however far their centers are
------------------------------------------------------------------------- */

class LumenRule : public DistanceRule {
 public:
  using DistanceRule::DistanceRule;

  void init(const Fix *asking, FixDCMCell *_cell) override
  {
    cell = _cell;
    auto *const fix = modify->get_fix_by_id(id);
    if (!fix)
      error->all(FLERR, "{}: lumen: there is no fix {}; name the fix dcm/osmosis that marks faces",
                 STYLE, id);
    marks = dynamic_cast<DCMRole *>(fix);
    // a process without atoms may have no array of marks
    int any = marks && marks->marked_faces() ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
    if (!any)
      error->all(FLERR, "{}: lumen: fix {} ({}) marks no faces at a lumen; name a fix dcm/osmosis",
                 STYLE, id, fix->style);
    DCMRole::check_before_motion(lmp, asking, std::string(STYLE) + ": lumen");
  }

  void look(const Cells &) override
  {
    struct Place {
      tagint molecule;
      double x[3];
    };
    std::vector<Place> mine;
    const int *const mark = marks->marked_faces();
    for (int f = 0; f < cell->nowned(); f++) {
      const int i = cell->faces()[f].atom;
      if (mark[i])
        mine.push_back({atom->molecule[i], {atom->x[i][0], atom->x[i][1], atom->x[i][2]}});
    }
    std::vector<double> at;
    wall.clear();
    for (const auto &it : dcm_allgather(mine, world)) {
      wall.push_back(it.molecule);
      at.insert(at.end(), it.x, it.x + 3);
    }
    std::sort(wall.begin(), wall.end());
    sort(std::move(at));
  }

  Form wants(const Cells &cells, size_t n) const override
  {
    if (std::binary_search(wall.begin(), wall.end(), cells[n].molecule)) return Form::DEFORMABLE;
    return DistanceRule::wants(cells, n);
  }

 private:
  FixDCMCell *cell = nullptr;
  const DCMRole *marks = nullptr;
  std::vector<tagint> wall;    // who has marked faces, sorted, once for each face
};

/* ----------------------------------------------------------------------
   a measure of cells, per row of the table, above the first number or below the second
------------------------------------------------------------------------- */

class MeasureRule : public DCMConvertRule {
 public:
  MeasureRule(LAMMPS *lmp, DCMArgs &args, const std::string &_column) :
      DCMConvertRule(lmp), name(args.keyword()), column(_column)
  {
    args.need(2);
    on = args.number(DCMArgs::POSITIVE);
    off = args.number(DCMArgs::ANY);
    if (off > on)
      error->all(FLERR,
                 "{}: {}: the second number, {}, below which a cell becomes a sphere, is above the "
                 "first, {}",
                 STYLE, name, off, on);
  }

  void init(const Fix *asking, FixDCMCell *_cell) override
  {
    cell = _cell;
    DCMRole::check_before_motion(lmp, asking, std::string(STYLE) + ": " + name);
    seen = cell->change_cells().share(STYLE, column, DCMColumn::RESET);
  }

  void look(const Cells &cells) override
  {
    cell->update_all();
    std::vector<double> value(cell->cells().size(), 0.0);
    measure(cells, value);
    for (int row = 0; row < (int) value.size(); row++) (*seen)(row) = value[row];
  }

  Form wants(const Cells &cells, size_t n) const override
  {
    const int row = cell->cells().find(cells[n].molecule);
    return row < 0 ? Form::ANY : dcm::wanted_form((*seen)(row), on, off);
  }

 protected:
  FixDCMCell *cell = nullptr;
  double on, off;

  // per row of the table, zeros at first; in the end the same on all processes

  virtual void measure(const Cells &, std::vector<double> &value) = 0;

  // from a cell's center, at the image next to it

  Vec3 from_center(int row, const double *x) const
  {
    Vec3 d = vec(x) - vec(cell->cells()[row].x);
    dcm_minimum_image(domain, d[0], d[1], d[2]);
    return d;
  }

 private:
  std::string name, column;
  DCMCellTable::Handle seen;    // at the last look: for output as well
};

/* ----------------------------------------------------------------------
   pressure P1 P2: mean pressure that its surroundings put on the cell: on a sphere by its contacts,
   on a deformable cell what its own forces hold in balance. These change little from step to step,
   where single contacts are stiff
------------------------------------------------------------------------- */

class PressureRule : public MeasureRule {
 public:
  PressureRule(LAMMPS *lmp, DCMArgs &args) : MeasureRule(lmp, args, "outer_pressure") {}

  void init(const Fix *asking, FixDCMCell *_cell) override
  {
    MeasureRule::init(asking, _cell);
    contact = dynamic_cast<PairDCMContact *>(force->pair_match("dcm/contact", 1));
    if (!contact)
      error->all(FLERR,
                 "{}: pressure needs pair_style dcm/contact, which knows the forces of contacts; "
                 "add it, or use another rule",
                 STYLE);
    spheres = contact->request_virial();
  }

 protected:
  void measure(const Cells &, std::vector<double> &value) override
  {
    const auto &table = cell->cells();
    std::vector<double> virial(6 * (size_t) table.size(), 0.0);
    for (auto *const role : DCMRole::of(lmp)) role->add_cell_virial(virial);
    for (int row = 0; row < table.size(); row++) {
      const double *const six = &virial[6 * (size_t) row];
      value[row] += six[0] + six[1] + six[2];
    }
    for (int i = 0; i < atom->nlocal; i++) {
      const int row = cell->cell_of(i);
      if (row >= 0 && !table[row].deformable) value[row] += contact->sphere_virial()[i];
    }
    MPI_Allreduce(MPI_IN_PLACE, value.data(), (int) value.size(), MPI_DOUBLE, MPI_SUM, world);
    for (int row = 0; row < table.size(); row++) {
      const auto &it = table[row];
      value[row] = dcm::mean_pressure(value[row], it.deformable ? it.volume : it.volume0);
    }
  }

 private:
  PairDCMContact *contact = nullptr;
  DCMRequest<> spheres;
};

/* ----------------------------------------------------------------------
   strain S1 S2: flattening of the surface; that of a sphere is what it would be converted with
------------------------------------------------------------------------- */

class StrainRule : public MeasureRule {
 public:
  StrainRule(LAMMPS *lmp, DCMArgs &args) : MeasureRule(lmp, args, "flattening")
  {
    if (on + dcm::SHAPE_NEAREST >= 1.0)
      error->all(FLERR,
                 "{}: strain: the first number, {}, must be below {:.4g}: spheres that are "
                 "flattened more have no room to be shaped",
                 STYLE, on, 1.0 - dcm::SHAPE_NEAREST);
  }

 protected:
  void measure(const Cells &cells, std::vector<double> &value) override
  {
    measure_deformable(value);
    measure_spheres(cells, value);
  }

 private:
  void measure_deformable(std::vector<double> &value)
  {
    const auto &table = cell->cells();
    const auto *const dcm = AtomVecDCM::require(lmp, STYLE);
    std::vector<double> nearest(table.size(), std::numeric_limits<double>::max());
    for (int i = 0; i < atom->nlocal; i++) {
      if (dcm->kind[i] != AtomVecDCM::NODE) continue;
      const int row = cell->cell_of(i);
      nearest[row] = std::min(nearest[row], from_center(row, atom->x[i]).norm());
    }
    MPI_Allreduce(MPI_IN_PLACE, nearest.data(), (int) nearest.size(), MPI_DOUBLE, MPI_MIN, world);
    for (const int row : table.all_deformable())
      value[row] = dcm::flattening(nearest[row], dcm::ball_radius(table[row].volume));
  }

  void measure_spheres(const Cells &cells, std::vector<double> &value)
  {
    std::vector<double> places;
    std::vector<double> radius;
    for (const auto &it : cells) {
      places.insert(places.end(), it.x, it.x + 3);
      radius.push_back(dcm::ball_radius(it.volume0));
    }
    if (radius.empty()) return;
    const double largest = *std::max_element(radius.begin(), radius.end());
    const DCMCellBins bins(domain, places, 2.0 * largest);
    for (size_t n = 0; n < cells.size(); n++) {
      const int row = cells[n].deformable ? -1 : cell->cells().find(cells[n].molecule);
      if (row < 0) continue;
      const dcm::Ball ball = {Vec3::Zero(), radius[n]};
      for (const int m : bins.near(cells[n].x)) {
        if ((size_t) m == n) continue;
        Vec3 d = vec(cells[m].x) - vec(cells[n].x);
        dcm_minimum_image(domain, d[0], d[1], d[2]);
        if (d.norm() < radius[n] + radius[m])
          value[row] = std::max(value[row], dcm::flattening(ball, {d, radius[m]}));
      }
    }
  }
};

template <class Rule> std::unique_ptr<DCMConvertRule> make(LAMMPS *lmp, DCMArgs &args)
{
  return std::make_unique<Rule>(lmp, args);
}

struct Entry {
  const char *name;
  std::unique_ptr<DCMConvertRule> (*make)(LAMMPS *, DCMArgs &);
};

const Entry RULES[] = {{"region", make<RegionRule>},     {"near", make<NearRule>},
                       {"variable", make<VariableRule>}, {"lumen", make<LumenRule>},
                       {"pressure", make<PressureRule>}, {"strain", make<StrainRule>}};

}    // namespace

/* ---------------------------------------------------------------------- */

std::vector<std::string> DCMConvertRule::names()
{
  std::vector<std::string> names;
  for (const auto &it : RULES) names.emplace_back(it.name);
  return names;
}

std::unique_ptr<DCMConvertRule> DCMConvertRule::read(LAMMPS *lmp, DCMArgs &args)
{
  for (const auto &it : RULES)
    if (args.is(it.name)) return it.make(lmp, args);
  return nullptr;
}
