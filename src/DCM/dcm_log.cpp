/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "dcm_log.h"

#include "comm.h"
#include "error.h"

using namespace LAMMPS_NS;

DCMLog::DCMLog(LAMMPS *lmp, const std::string &_asking, const std::string &_header) :
    Pointers(lmp), asking(_asking), header(_header), continued(false), leftover(false), fp(nullptr)
{
}

DCMLog::~DCMLog()
{
  if (fp) fclose(fp);
}

void DCMLog::open()
{
  if (file.empty() || fp || comm->me != 0) return;
  fp = fopen(file.c_str(), "a");
  if (!fp) error->one(FLERR, "{}: cannot open log {}: {}", asking, file, utils::getsyserror());
  if (fseek(fp, 0, SEEK_END) == 0 && ftell(fp) == 0)
    write(header);
  else
    leftover = !continued;
  flush();
}

void DCMLog::clear()
{
  leftover = false;
  fp = freopen(file.c_str(), "w", fp);
  if (!fp) error->one(FLERR, "{}: cannot open log {}: {}", asking, file, utils::getsyserror());
  write(header);
  flush();
}

void DCMLog::write(const std::string &line)
{
  if (fwrite(line.data(), 1, line.size(), fp) != line.size()) fail();
}

void DCMLog::flush()
{
  if (fp && (fflush(fp) != 0 || ferror(fp))) fail();
}

void DCMLog::fail()
{
  error->one(FLERR, "{}: cannot write to log {}: {}", asking, file, utils::getsyserror());
}
