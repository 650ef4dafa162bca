/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */
#ifndef LMP_DCM_LOG_H
#define LMP_DCM_LOG_H

#include "pointers.h"
#include "utils.h"

#include <cstdio>
#include <string>

namespace LAMMPS_NS {

// Log of events, a line each: of births, deaths, ... Rank 0 writes it; the others may call as well.
// A run that goes on from a restart file adds to what is there.

class DCMLog : protected Pointers {
 public:
  // asking: for messages; header: lines that begin with #, for a new file
  DCMLog(class LAMMPS *, const std::string &asking, const std::string &header);
  ~DCMLog();
  DCMLog(const DCMLog &) = delete;
  DCMLog &operator=(const DCMLog &) = delete;

  void name(const std::string &_file) { file = _file; }    // without one nothing is written
  void go_on() { continued = true; }                       // call it in restart()

  // call it in setup(), when all input has been checked: an error if it cannot be written. No
  // effect from the second time on
  void open();

  // call it when a step begins: what an earlier run has left there goes now, and not if this one
  // ends in set-up
  void begin()
  {
    if (leftover) clear();
  }

  // an error if the disk is full
  template <typename... Args> void print(const std::string &format, const Args &...args)
  {
    if (fp) write(fmt::vformat(format, fmt::make_format_args(args...)));
  }
  void flush();

 private:
  std::string asking, header, file;
  bool continued, leftover;
  FILE *fp;

  void clear();

  void write(const std::string &line);
  [[noreturn]] void fail();
};

}    // namespace LAMMPS_NS

#endif
