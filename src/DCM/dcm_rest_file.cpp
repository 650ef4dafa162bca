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
#include "bond.h"
#include "comm.h"
#include "dcm_allgather.h"
#include "dcm_slots.h"
#include "dcm_text.h"
#include "dihedral.h"
#include "error.h"
#include "force.h"
#include "tokenizer.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

using namespace LAMMPS_NS;

static const char STYLE[] = "Fix dcm/cell";
static constexpr char LAST[] = "# end:";
static constexpr char HEADER[] = "# LAMMPS-DCM rest state: edges (2 tags) and hinges (4 tags)";

namespace {

// the atoms of a bond or dihedral and its rest value

struct RestValue {
  tagint tag[4];    // bond: two tags and zeros
  double value;
};

// what there is, of this rank or of all

struct Count {
  bigint edges = 0, hinges = 0;

  void add(LAMMPS *lmp)
  {
    bigint both[2] = {edges, hinges};
    MPI_Allreduce(MPI_IN_PLACE, both, 2, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
    edges = both[0];
    hinges = both[1];
  }
};

}    // namespace

// those of other styles of a hybrid one are no edges; before there are styles all are taken for
// such

template <class Style> static bool owns(const Style *style, int type)
{
  return !style || !style->allocated || style->setflag[std::abs(type)];
}

static Count count_slots(LAMMPS *lmp)
{
  const Atom *const atom = lmp->atom;
  const Bond *const bond = lmp->force->bond_match("dcm/cortex");
  const Dihedral *const dihedral = lmp->force->dihedral_match("dcm/bend");
  Count count;
  for (int i = 0; i < atom->nlocal; i++) {
    for (int m = 0; m < atom->num_bond[i]; m++)
      if (owns(bond, atom->bond_type[i][m])) count.edges++;
    for (int m = 0; m < atom->num_dihedral[i]; m++)
      if (owns(dihedral, atom->dihedral_type[i][m])) count.hinges++;
  }
  count.add(lmp);
  return count;
}

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

/* ----------------------------------------------------------------------
   the last line of a file: what is in it, and a checksum of all lines before, so that one that was
   cut short or changed is known
------------------------------------------------------------------------- */

static std::string last_line(const Count &count, const std::string &text)
{
  return fmt::format("{} {} edges, {} hinges, checksum {:016x}\n", LAST, count.edges, count.hinges,
                     dcm_checksum(text.data(), text.size()));
}

void LAMMPS_NS::dcm_write_rest_file(LAMMPS *lmp, const std::string &file)
{
  const Atom *const atom = lmp->atom;
  const DCMAtoms *const dcm = AtomVecDCM::require(lmp, STYLE);
  const Count there = count_slots(lmp);
  auto all = dcm_gather(collect(atom, dcm), lmp->world);
  std::string fault;
  if (lmp->comm->me == 0) {
    std::sort(all.begin(), all.end(), [](const RestValue &a, const RestValue &b) {
      return std::lexicographical_compare(a.tag, a.tag + 4, b.tag, b.tag + 4);
    });
    std::string text = fmt::format("{}\n", HEADER);
    Count count;
    for (const auto &rest : all) {
      text += fmt::format("{} {}", rest.tag[0], rest.tag[1]);
      if (rest.tag[2]) text += fmt::format(" {} {}", rest.tag[2], rest.tag[3]);
      text += fmt::format(" {:.17g}\n", rest.value);
      (rest.tag[2] ? count.hinges : count.edges)++;
    }
    if (count.edges < there.edges)
      fault = fmt::format("{} of {} edges have no rest length yet; do a 'run 0' before",
                          there.edges - count.edges, there.edges);
    else
      fault = dcm_replace_text(file, text + last_line(count, text));
  }
  dcm_bcast(lmp->world, fault);
  if (!fault.empty())
    lmp->error->all(FLERR, "{}: cannot write rest-state file {}: {}", STYLE, file, fault);
}

namespace {

// what lines of a file were about, of the edges and hinges that this rank stores

struct Applied {
  Count count;
  std::vector<std::vector<char>> edge, hinge;    // per atom and slot: named before
  bool doubled = false;
};

}    // namespace

static void apply(Atom *atom, DCMAtoms *dcm, const RestValue &rest, Applied &done)
{
  const tagint *tag = rest.tag;
  auto mark = [&done](std::vector<char> &seen, int m, bigint &count) {
    if ((int) seen.size() <= m) seen.resize(m + 1, 0);
    done.doubled = done.doubled || seen[m];
    seen[m] = 1;
    count++;
  };
  if (tag[2] == 0) {
    for (int end = 0; end < 2; end++) {
      const int i = dcm_index_of(atom, tag[end]);
      if (i < 0 || i >= atom->nlocal) continue;
      for (int m = 0; m < atom->num_bond[i]; m++) {
        if (atom->bond_atom[i][m] != tag[1 - end]) continue;
        dcm->l0[i][m] = rest.value;
        mark(done.edge[i], m, done.count.edges);
        return;
      }
    }
    return;
  }
  const int i = dcm_index_of(atom, tag[1]);
  if (i < 0 || i >= atom->nlocal) return;
  for (int m = 0; m < atom->num_dihedral[i]; m++) {
    if (atom->dihedral_atom1[i][m] != tag[0] || atom->dihedral_atom3[i][m] != tag[2] ||
        atom->dihedral_atom4[i][m] != tag[3])
      continue;
    dcm->theta0[i][m] = rest.value;
    mark(done.hinge[i], m, done.count.hinges);
    return;
  }
}

void LAMMPS_NS::dcm_read_rest_file(LAMMPS *lmp, const std::string &file, bool partial)
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

  Count named;
  Applied done;
  done.edge.resize(atom->nlocal);
  done.hinge.resize(atom->nlocal);
  bool whole = false;
  std::string before;
  for (const auto &line : Tokenizer(text, "\n").as_vector()) {
    const std::string words = utils::trim(line);
    if (words.compare(0, strlen(LAST), LAST) == 0) {
      whole = words + "\n" == last_line(named, before);
      if (!whole)
        error->all(FLERR,
                   "{}: rest-state file {} is damaged: it was changed, or lines of it are missing; "
                   "it has {} edges and {} hinges, its last line is '{}'. Without this line it is "
                   "read as it stands",
                   STYLE, file, named.edges, named.hinges, words);
      continue;
    }
    if (words.empty()) continue;
    before += words + "\n";
    if (words[0] == '#') continue;
    try {
      ValueTokenizer values(words);
      const int ntags = (int) values.count() - 1;
      if (ntags != 2 && ntags != 4) throw TokenizerException("expected 2 or 4 tags", "");
      RestValue rest = {{0, 0, 0, 0}, 0.0};
      for (int k = 0; k < ntags; k++) rest.tag[k] = values.next_tagint();
      rest.value = values.next_double();
      if (!std::isfinite(rest.value) || (ntags == 2 && rest.value <= 0.0))
        throw TokenizerException("bad rest value", "");
      (ntags == 2 ? named.edges : named.hinges)++;
      apply(atom, dcm, rest, done);
    } catch (TokenizerException &e) {
      error->all(FLERR, "{}: rest-state file {}: '{}': {}", STYLE, file, words, e.what());
    }
  }
  done.count.add(lmp);
  int doubled = done.doubled;
  MPI_Allreduce(MPI_IN_PLACE, &doubled, 1, MPI_INT, MPI_MAX, lmp->world);
  const Count there = count_slots(lmp);
  if (done.count.edges + done.count.hinges != named.edges + named.hinges)
    error->all(FLERR,
               "{}: only {} of the {} edges and hinges in rest-state file {} exist; "
               "it belongs to another data file",
               STYLE, done.count.edges + done.count.hinges, named.edges + named.hinges, file);
  if (doubled)
    error->all(FLERR, "{}: rest-state file {} names an edge or hinge twice", STYLE, file);
  if (partial) return;
  if (named.edges != there.edges || (named.hinges != there.hinges && (named.hinges || !whole)))
    error->all(FLERR,
               "{}: rest-state file {} names {} of {} edges and {} of {} hinges: it was cut short, "
               "or belongs to another data file. If the others are to keep their rest state, add "
               "'partial' behind its name",
               STYLE, file, named.edges, there.edges, named.hinges, there.hinges);
}
