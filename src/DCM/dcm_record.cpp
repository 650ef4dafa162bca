/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#include "dcm_record.h"

#include "comm.h"
#include "dcm_text.h"
#include "error.h"
#include "utils.h"

#include <algorithm>
#include <cstddef>

using namespace LAMMPS_NS;

static constexpr char MAGIC[8] = {'D', 'C', 'M', '-', 'r', 'e', '2', '\n'};

DCMRecord::DCMRecord(LAMMPS *lmp, const std::string &_style, int _version) :
    Pointers(lmp), style(_style), version(_version)
{
}

/* ---------------------------------------------------------------------- */

DCMRecord::Header DCMRecord::header() const
{
  Header head = {};
  memcpy(head.magic, MAGIC, sizeof(MAGIC));
  memcpy(head.style, style.data(), std::min(style.size(), sizeof(head.style) - 1));
  head.version = version;
  head.size = (std::int64_t) bytes.size();
  head.checksum = dcm_checksum(bytes.data(), bytes.size());
  head.own = dcm_checksum(&head, offsetof(Header, own));
  return head;
}

void DCMRecord::check_header(const Header &head) const
{
  const Header mine = header();
  if (memcmp(head.magic, mine.magic, sizeof(MAGIC)) != 0 ||
      memcmp(head.style, mine.style, sizeof(mine.style)) != 0)
    error->all(FLERR,
               "{}: its record in the restart file was not written by this style, or by a version "
               "of the package whose records had no number or no checksum; run that one, or start "
               "from a data file",
               style);
  if (head.version != version)
    error->all(FLERR,
               "{}: its record in the restart file has version {}, this program reads version {}; "
               "use the version of the package that wrote it, or start from a data file",
               style, head.version, version);
  check(head.own == dcm_checksum(&head, offsetof(Header, own)) && head.size >= 0);
}

void DCMRecord::check(bool whole) const
{
  if (!whole)
    error->all(FLERR,
               "{}: its record in the restart file is damaged; use an earlier restart file, or "
               "start from a data file",
               style);
}

/* ---------------------------------------------------------------------- */

void DCMRecord::write(FILE *fp) const
{
  const int size = (int) (sizeof(Header) + bytes.size());
  fwrite(&size, sizeof(int), 1, fp);
  write_plain(fp);
}

void DCMRecord::write_plain(FILE *fp) const
{
  const Header head = header();
  fwrite(&head, sizeof(Header), 1, fp);
  fwrite(bytes.data(), 1, bytes.size(), fp);
}

void DCMRecord::load(const char *buf)
{
  Header head = {};
  memcpy(head.magic, buf, sizeof(MAGIC));    // no more: a foreign record may be shorter
  if (memcmp(head.magic, MAGIC, sizeof(MAGIC)) == 0) memcpy(&head, buf, sizeof(Header));
  check_header(head);
  bytes.assign(buf + sizeof(Header), buf + sizeof(Header) + head.size);
  check(head.checksum == dcm_checksum(bytes.data(), bytes.size()));
  at = 0;
}

void DCMRecord::read_plain(FILE *fp)
{
  Header head = {};
  if (comm->me == 0) utils::sfread(FLERR, &head, sizeof(Header), 1, fp, nullptr, error);
  MPI_Bcast(&head, sizeof(Header), MPI_BYTE, 0, world);
  check_header(head);
  bytes.resize(head.size);
  if (comm->me == 0) utils::sfread(FLERR, bytes.data(), 1, bytes.size(), fp, nullptr, error);
  MPI_Bcast(bytes.data(), (int) bytes.size(), MPI_BYTE, 0, world);
  check(head.checksum == dcm_checksum(bytes.data(), bytes.size()));
  at = 0;
}

/* ---------------------------------------------------------------------- */

void DCMRecord::append(const void *from, size_t n)
{
  const char *const first = static_cast<const char *>(from);
  bytes.insert(bytes.end(), first, first + n);
}

void DCMRecord::extract(void *to, size_t n)
{
  check_left(1, n);
  if (n) memcpy(to, bytes.data() + at, n);
  at += n;
}

void DCMRecord::check_left(std::int64_t n, size_t size) const
{
  if (n < 0 || (std::uint64_t) n * size > bytes.size() - at)
    error->all(FLERR, "{}: its record in the restart file is cut short", style);
}
