/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_rest_file.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_text.h"
#include "error.h"
#include "tokenizer.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static const char STYLE[] = "Fix dcm/cell";
static constexpr char HEADER[] = "# LAMMPS-DCM rest state: edges (2 tags) and hinges (4 tags)";

namespace {

// the atoms of a bond or dihedral and its rest value

struct RestValue {
  tagint tag[4];    // bond: two tags and zeros
  double value;
};

}    // namespace

static std::vector<RestValue> collect(const Atom *atom, const DCMAtoms *dcm)
{
  std::vector<RestValue> mine;
  for (int i = 0; i < atom->nlocal; i++) {
    for (int m = 0; m < atom->num_bond[i]; m++) {
      const tagint a = atom->tag[i], b = atom->bond_atom[i][m];
      if (dcm->l0[i][m] >= 0.0)
        mine.push_back({{std::min(a, b), std::max(a, b), 0, 0}, dcm->l0[i][m]});
    }
    for (int m = 0; m < atom->num_dihedral[i]; m++)
      if (std::fabs(dcm->theta0[i][m]) < AtomVecDCM::UNSET_THETA0)
        mine.push_back({{atom->dihedral_atom1[i][m], atom->dihedral_atom2[i][m],
                         atom->dihedral_atom3[i][m], atom->dihedral_atom4[i][m]},
                        dcm->theta0[i][m]});
  }
  return mine;
}

void LAMMPS_NS::dcm_write_rest_file(LAMMPS *lmp, const std::string &file)
{
  auto all = dcm_gather(collect(lmp->atom, AtomVecDCM::require(lmp, STYLE)), lmp->world);
  int failed = 0;
  if (lmp->comm->me == 0) {
    std::sort(all.begin(), all.end(), [](const RestValue &a, const RestValue &b) {
      return std::lexicographical_compare(a.tag, a.tag + 4, b.tag, b.tag + 4);
    });
    FILE *fp = fopen(file.c_str(), "w");
    if (fp) {
      fmt::print(fp, "{}\n", HEADER);
      for (const auto &rest : all) {
        fmt::print(fp, "{} {}", rest.tag[0], rest.tag[1]);
        if (rest.tag[2]) fmt::print(fp, " {} {}", rest.tag[2], rest.tag[3]);
        fmt::print(fp, " {:.17g}\n", rest.value);
      }
      failed = ferror(fp);
      failed |= fclose(fp);
    } else {
      failed = 1;
    }
  }
  MPI_Bcast(&failed, 1, MPI_INT, 0, lmp->world);
  if (failed) lmp->error->all(FLERR, "{}: cannot write rest-state file {}", STYLE, file);
}

// returns 1 if this rank stores that bond or dihedral

static bigint apply(Atom *atom, DCMAtoms *dcm, const RestValue &rest)
{
  const tagint *tag = rest.tag;
  if (tag[2] == 0) {
    for (int end = 0; end < 2; end++) {
      const int i = atom->map(tag[end]);
      if (i < 0 || i >= atom->nlocal) continue;
      for (int m = 0; m < atom->num_bond[i]; m++) {
        if (atom->bond_atom[i][m] != tag[1 - end]) continue;
        dcm->l0[i][m] = rest.value;
        return 1;
      }
    }
    return 0;
  }
  const int i = atom->map(tag[1]);
  if (i < 0 || i >= atom->nlocal) return 0;
  for (int m = 0; m < atom->num_dihedral[i]; m++) {
    if (atom->dihedral_atom1[i][m] != tag[0] || atom->dihedral_atom3[i][m] != tag[2] ||
        atom->dihedral_atom4[i][m] != tag[3])
      continue;
    dcm->theta0[i][m] = rest.value;
    return 1;
  }
  return 0;
}

void LAMMPS_NS::dcm_read_rest_file(LAMMPS *lmp, const std::string &file)
{
  Error *const error = lmp->error;
  Atom *const atom = lmp->atom;
  DCMAtoms *const dcm = AtomVecDCM::require(lmp, STYLE);
  if (atom->map_style == Atom::MAP_NONE) {
    atom->map_init();
    atom->map_set();
  }

  std::string text;
  if (!dcm_read_text(lmp->comm, lmp->world, file, text))
    error->all(FLERR, "{}: cannot open rest-state file {}", STYLE, file);

  bigint nlines = 0, napplied = 0;
  for (const auto &line : Tokenizer(text, "\n").as_vector()) {
    if (line[0] == '#') continue;
    nlines++;
    try {
      ValueTokenizer values(line);
      const int ntags = (int) values.count() - 1;
      if (ntags != 2 && ntags != 4) throw TokenizerException("expected 2 or 4 tags", "");
      RestValue rest = {{0, 0, 0, 0}, 0.0};
      for (int k = 0; k < ntags; k++) rest.tag[k] = values.next_tagint();
      rest.value = values.next_double();
      if (!std::isfinite(rest.value) || (ntags == 2 && rest.value <= 0.0))
        throw TokenizerException("bad rest value", "");
      napplied += apply(atom, dcm, rest);
    } catch (TokenizerException &e) {
      error->all(FLERR, "{}: rest-state file {}: '{}': {}", STYLE, file, line, e.what());
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &napplied, 1, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
  if (napplied != nlines)
    error->all(FLERR,
               "{}: only {} of the {} edges and hinges in rest-state file {} exist; "
               "it belongs to another data file",
               STYLE, napplied, nlines, file);
}
