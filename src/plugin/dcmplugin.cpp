/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Entry point of dcmplugin.so: registers every style whose header is in src/DCM, through the same
// style macros by which LAMMPS' own build collects them.

#include "atom.h"
#include "atom_vec.h"
#include "force.h"
#include "input.h"
#include "lammpsplugin.h"
#include "library.h"
#include "lmptype.h"
#include "modify.h"
#include "version.h"

#include "dcm_style_headers.h"
#include "dcm_version.h"

#include <cstdio>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;

namespace {

template <class Style> void *create1(void *lmp)
{
  return new Style((LAMMPS *) lmp);
}

template <class Style> void *create2(void *lmp, int narg, char **arg)
{
  return new Style((LAMMPS *) lmp, narg, arg);
}

template <class Style> AtomVec *create_avec(LAMMPS *lmp)
{
  return new Style(lmp);
}

// the same with the types of LAMMPS' own tables

template <class Base, class Style> Base *make1(LAMMPS *lmp)
{
  return new Style(lmp);
}

template <class Base, class Style> Base *make2(LAMMPS *lmp, int narg, char **arg)
{
  return new Style(lmp, narg, arg);
}

class Registry {
 public:
  Registry(void *_lmp, void *handle, void *regfunc) : lmp(_lmp), add((lammpsplugin_regfunc) regfunc)
  {
    plugin.version = LAMMPS_VERSION;
    plugin.info = "LAMMPS-DCM " DCM_VERSION ", deformable cell model";
    plugin.author = "the LAMMPS-DCM developers";
    plugin.handle = handle;
  }

  void style1(const char *style, const char *name, lammpsplugin_factory1 *creator)
  {
    plugin.style = style;
    plugin.name = name;
    plugin.creator.v1 = creator;
    (*add)(&plugin, lmp);
  }

  void style2(const char *style, const char *name, lammpsplugin_factory2 *creator)
  {
    plugin.style = style;
    plugin.name = name;
    plugin.creator.v2 = creator;
    (*add)(&plugin, lmp);
  }

 private:
  void *lmp;
  lammpsplugin_regfunc add;
  lammpsplugin_t plugin;
};

// whether this host may have the plugin's styles: it must not have them already, and LAMMPS has no
// stable binary interface, so that only C library functions may be called before it is sure that
// the host is the LAMMPS this file was compiled for

bool may_load(void *lmp)
{
  const bool speaks = lammps_extract_setting(lmp, "world_rank") == 0;
  if (lammps_config_has_package("DCM")) {
    if (speaks)
      fprintf(stderr,
              "WARNING: plugin dcmplugin.so not loaded: this LAMMPS has the package DCM built in, "
              "and its styles are used\n");
    return false;
  }

  const struct {
    const char *name;
    int size;
  } integers[] = {{"bigint", (int) sizeof(bigint)},
                  {"tagint", (int) sizeof(tagint)},
                  {"imageint", (int) sizeof(imageint)}};

  std::string problem;
  const int mine = DCM_LAMMPS_VERSION, host = lammps_version(lmp);
  if (mine != host)
    problem = "it was compiled for LAMMPS version " + std::to_string(mine) +
              ", this LAMMPS is version " + std::to_string(host);
  for (const auto &type : integers)
    if (problem.empty() && type.size != lammps_extract_setting(lmp, type.name))
      problem = std::string("its ") + type.name + " has " + std::to_string(type.size * 8) +
                " bits, this LAMMPS' has " +
                std::to_string(lammps_extract_setting(lmp, type.name) * 8);
  if (problem.empty()) return true;

  if (speaks)
    fprintf(stderr,
            "ERROR: plugin dcmplugin.so not loaded: %s. Rebuild the plugin with "
            "cmake -D LAMMPS_SOURCE_DIR=<the src folder of this LAMMPS> -D LAMMPS_SIZES=...\n",
            problem.c_str());
  return false;
}

}    // namespace

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  if (!may_load(lmp)) return;
  Registry registry(lmp, handle, regfunc);

  // LAMMPS lists plugins once per process, and gives those in the list to no second instance: what
  // an instance lacks goes into its tables directly
  const auto *const force = ((LAMMPS *) lmp)->force;
  const auto *const modify = ((LAMMPS *) lmp)->modify;
  const auto *const input = ((LAMMPS *) lmp)->input;

#define BOND_CLASS
#define BondStyle(key, Class)                    \
  registry.style1("bond", #key, create1<Class>); \
  force->bond_map->emplace(#key, make1<Bond, Class>);
#include "dcm_style_headers.h"
#undef BOND_CLASS
#define DIHEDRAL_CLASS
#define DihedralStyle(key, Class)                    \
  registry.style1("dihedral", #key, create1<Class>); \
  force->dihedral_map->emplace(#key, make1<Dihedral, Class>);
#include "dcm_style_headers.h"
#undef DIHEDRAL_CLASS
#define PAIR_CLASS
#define PairStyle(key, Class)                    \
  registry.style1("pair", #key, create1<Class>); \
  force->pair_map->emplace(#key, make1<Pair, Class>);
#include "dcm_style_headers.h"
#undef PAIR_CLASS
#define FIX_CLASS
#define FixStyle(key, Class)                    \
  registry.style2("fix", #key, create2<Class>); \
  modify->fix_map->emplace(#key, make2<Fix, Class>);
#include "dcm_style_headers.h"
#undef FIX_CLASS
#define COMPUTE_CLASS
#define ComputeStyle(key, Class)                    \
  registry.style2("compute", #key, create2<Class>); \
  modify->compute_map->emplace(#key, make2<Compute, Class>);
#include "dcm_style_headers.h"
#undef COMPUTE_CLASS
#define COMMAND_CLASS
#define CommandStyle(key, Class)                    \
  registry.style1("command", #key, create1<Class>); \
  input->command_map->emplace(#key, make1<Command, Class>);
#include "dcm_style_headers.h"
#undef COMMAND_CLASS

  // LAMMPS has no plugin type for atom styles, but its table of them is public
#define ATOM_CLASS
#define AtomStyle(key, Class) (*((LAMMPS *) lmp)->atom->avec_map)[#key] = &create_avec<Class>
#include "dcm_style_headers.h"
#undef ATOM_CLASS
}
