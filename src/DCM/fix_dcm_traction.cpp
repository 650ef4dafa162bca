/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_dcm_traction.h"

#include "atom.h"
#include "dcm_args.h"
#include "dcm_deck_check.h"
#include "dcm_parameters.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "law/traction.h"
#include "region.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;
using dcm::vec;
using dcm::Vec3;

static const char STYLE[] = "Fix dcm/traction";

/* ----------------------------------------------------------------------
   fix ID group dcm/traction [pressure P] [vector tx ty tz] [region ID] [faces REGION ...]
------------------------------------------------------------------------- */

FixDCMTraction::FixDCMTraction(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cell(nullptr), region(nullptr), nobody(false), sums(), all(), summed(true)
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  loaded.fill(true);

  bool any = false;
  DCMArgs args(lmp, STYLE, narg - 3, arg + 3, {"pressure", "vector", "region", "faces"});
  while (args.next()) {
    if (args.is("pressure")) {
      pressure.parse(args);
      any = true;
    } else if (args.is("vector")) {
      args.need(3);
      for (int k = 0; k < 3; k++) traction[k].parse(args, std::string("vector ") + "xyz"[k]);
      any = true;
    } else if (args.is("region")) {
      region_id = args.text();
    } else {
      loaded.fill(false);
      for (const int r : DCMParameters::parse_regions(args)) loaded[r] = true;
    }
  }
  if (!any) error->all(FLERR, "{}: give 'pressure P', 'vector TX TY TZ' or both", STYLE);

  vector_flag = 1;
  size_vector = 4;
  extvector = 1;
  global_freq = 1;
  virial_global_flag = virial_peratom_flag = 1;
}

/* ---------------------------------------------------------------------- */

int FixDCMTraction::setmask()
{
  return PRE_REVERSE | MIN_PRE_REVERSE;
}

std::vector<DCMValue *> FixDCMTraction::values()
{
  return {&pressure, &traction[0], &traction[1], &traction[2]};
}

void FixDCMTraction::init()
{
  dcm = AtomVecDCM::require(lmp, STYLE);
  cell = FixDCMCell::require(lmp, STYLE);
  dcm_check_group(lmp, STYLE, igroup, {AtomVecDCM::FACE});
  if (!region_id.empty()) region = dcm_find_region(lmp, STYLE, region_id);
  for (DCMValue *const value : values()) value->find(lmp, STYLE);
  nobody = group->count(igroup) == 0 && !group->dynamic[igroup] && !(traits_of(lmp) & MAKES_CELLS);
}

void FixDCMTraction::setup_pre_reverse(int eflag, int vflag)
{
  pre_reverse(eflag, vflag);
}

/* ----------------------------------------------------------------------
   in the box: faces are wrapped into a periodic one at rebuilds only, and the answer must not wait
------------------------------------------------------------------------- */

bool FixDCMTraction::inside(const double *x) const
{
  double at[3] = {x[0], x[1], x[2]};
  domain->remap(at);
  return region->match(at[0], at[1], at[2]) != 0;
}

/* ----------------------------------------------------------------------
   on ghost vertices too, before forces are summed. The virial is that of a force from outside, as
   of fix addforce: by the place of the face, at which its resultant acts
------------------------------------------------------------------------- */

void FixDCMTraction::pre_reverse(int /*eflag*/, int vflag)
{
  v_init(vflag);
  std::fill_n(sums, 4, 0.0);
  summed = false;
  if (nobody) return;
  const auto given = values();
  DCMValue::evaluate(lmp, STYLE, given, igroup);
  if (region) region->prematch();
  double **x = atom->x, **f = atom->f;

  for (int n = 0; n < cell->nowned(); n++) {
    const FixDCMCell::Face &face = cell->faces()[n];
    const int i = face.atom;
    if (!(atom->mask[i] & groupbit) || !loaded[dcm->region[i]]) continue;
    if (region && !inside(x[i])) continue;
    for (const DCMValue *const value : given) value->check(lmp, STYLE, i);
    const int *const v = face.v;
    const Vec3 t(traction[0](i), traction[1](i), traction[2](i));
    const dcm::FaceLoad load =
        dcm::face_load(pressure(i), t, vec(x[v[0]]), vec(x[v[1]]), vec(x[v[2]]));
    for (int k = 0; k < 3; k++) vec(f[v[k]]) += load.third;
    vec(sums) += 3.0 * load.third;
    sums[3] += load.area;
    if (!evflag) continue;
    double at[3];
    domain->unmap(x[i], atom->image[i], at);
    const Vec3 force = 3.0 * load.third;
    double virial[6] = {at[0] * force[0], at[1] * force[1], at[2] * force[2],
                        at[0] * force[1], at[0] * force[2], at[1] * force[2]};
    v_tally(i, virial);
  }
}

/* ----------------------------------------------------------------------
   force on all loaded faces, and their area
------------------------------------------------------------------------- */

double FixDCMTraction::compute_vector(int n)
{
  if (!summed) MPI_Allreduce(sums, all, 4, MPI_DOUBLE, MPI_SUM, world);
  summed = true;
  return all[n];
}

/* ---------------------------------------------------------------------- */

double FixDCMTraction::memory_usage()
{
  double bytes = pressure.memory_usage();
  for (const DCMValue &t : traction) bytes += t.memory_usage();
  return bytes;
}
