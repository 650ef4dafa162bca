/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Rest-state files of fix dcm/cell: what a LAMMPS data file cannot hold, the rest length of every
// edge and the rest angle of every hinge, one line each and sorted by tags.

#include "fix_dcm_cell.h"

#include "atom.h"
#include "atom_vec_dcm.h"
#include "comm.h"
#include "dcm_text.h"
#include "error.h"
#include "tokenizer.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr char HEADER[] = "# LAMMPS-DCM rest state: edges (2 tags) and hinges (4 tags)";

int FixDCMCell::modify_param(int narg, char **arg)
{
  const bool writing = strcmp(arg[0], "rest/write") == 0;
  if (!writing && strcmp(arg[0], "rest/read") != 0) return 0;
  if (narg < 2) error->all(FLERR, "Fix_modify {} {} needs a file name", id, arg[0]);
  if (atom->map_style == Atom::MAP_NONE) {
    atom->map_init();
    atom->map_set();
  }
  if (writing)
    write_rest_state(arg[1]);
  else
    read_rest_state(arg[1]);
  return 2;
}

void FixDCMCell::collect_rest_values(std::vector<RestValue> &mine) const
{
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
}

void FixDCMCell::write_rest_state(const std::string &file)
{
  std::vector<RestValue> mine, all;
  collect_rest_values(mine);
  const int nbytes = (int) (mine.size() * sizeof(RestValue));
  std::vector<int> counts(comm->nprocs), offsets(comm->nprocs, 0);
  MPI_Allgather(&nbytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 1; p < comm->nprocs; p++) offsets[p] = offsets[p - 1] + counts[p - 1];
  if (comm->me == 0) all.resize((offsets.back() + counts.back()) / sizeof(RestValue));
  MPI_Gatherv(mine.data(), nbytes, MPI_BYTE, all.data(), counts.data(), offsets.data(), MPI_BYTE, 0,
              world);

  int failed = 0;
  if (comm->me == 0) {
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
  MPI_Bcast(&failed, 1, MPI_INT, 0, world);
  if (failed) error->all(FLERR, "Fix dcm/cell: cannot write rest-state file {}", file);
}

void FixDCMCell::read_rest_state(const std::string &file)
{
  std::string text;
  if (!dcm_read_text(comm, world, file, text))
    error->all(FLERR, "Fix dcm/cell: cannot open rest-state file {}", file);

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
      napplied += apply_rest_value(rest);
    } catch (TokenizerException &e) {
      error->all(FLERR, "Fix dcm/cell: rest-state file {}: '{}': {}", file, line, e.what());
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &napplied, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (napplied != nlines)
    error->all(FLERR,
               "Fix dcm/cell: only {} of the {} edges and hinges in rest-state file {} exist; "
               "it belongs to another data file",
               napplied, nlines, file);
}

// returns 1 if this rank stores that bond or dihedral

bigint FixDCMCell::apply_rest_value(const RestValue &rest)
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
