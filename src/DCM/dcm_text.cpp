/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_text.h"

#include "utils.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

using namespace LAMMPS_NS;
namespace fs = std::filesystem;

bool LAMMPS_NS::dcm_read_text(Comm *comm, MPI_Comm world, const std::string &path,
                              std::string &text)
{
  int good = 1;
  if (comm->me == 0) {
    text.clear();
    FILE *const fp = fopen(path.c_str(), "r");
    if (fp) {
      char part[1 << 16];
      for (size_t n; (n = fread(part, 1, sizeof(part), fp)) > 0;) text.append(part, n);
    }
    good = fp && !ferror(fp) && text.size() < (size_t) MAXSMALLINT;
    if (fp) fclose(fp);
    if (text.compare(0, 3, "\xEF\xBB\xBF") == 0) text.erase(0, 3);
    if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
  }
  MPI_Bcast(&good, 1, MPI_INT, 0, world);
  if (good) dcm_bcast(world, text);
  return good;
}

std::string LAMMPS_NS::dcm_replace_text(const std::string &path, const std::string &text)
{
  // devices and pipes are written to, a link stays one

  std::error_code none;
  const bool special = fs::exists(path, none) && !fs::is_regular_file(path, none);
  fs::path target = path;
  for (int n = 0; n < 10 && fs::is_symlink(target, none); n++)    // also one to nowhere
    target = target.parent_path() / fs::read_symlink(target, none);
  const std::string name = special ? path : target.string() + ".part";

  FILE *const fp = fopen(name.c_str(), "w");
  if (!fp) return utils::getsyserror();
  bool ok = fwrite(text.data(), 1, text.size(), fp) == text.size() && fflush(fp) == 0;
  std::string fault = ok ? "" : utils::getsyserror();
  if (fclose(fp) != 0 && ok) fault = utils::getsyserror();
  if (special) return fault;
  std::error_code failed;
  if (fault.empty()) fs::rename(name, target, failed);
  if (failed) fault = failed.message();
  if (!fault.empty()) fs::remove(name, none);
  return fault;
}

std::uint64_t LAMMPS_NS::dcm_checksum(const void *data, std::size_t size)
{
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  const auto *const bytes = static_cast<const unsigned char *>(data);
  for (std::size_t i = 0; i < size; i++) sum = (sum ^ bytes[i]) * 0x100000001b3ULL;
  return sum;
}

void LAMMPS_NS::dcm_bcast(MPI_Comm world, std::string &text, int root)
{
  int size = (int) text.size();
  MPI_Bcast(&size, 1, MPI_INT, root, world);
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, root, world);
}
