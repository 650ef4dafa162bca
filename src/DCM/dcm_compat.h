/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// the few places where the supported LAMMPS versions differ

#ifndef LMP_DCM_COMPAT_H
#define LMP_DCM_COMPAT_H

#include "domain.h"

#if __has_include("safe_pointers.h")
#define DCM_LAMMPS_2026 1
#endif

namespace LAMMPS_NS {
inline void dcm_minimum_image(Domain *domain, double &dx, double &dy, double &dz)
{
#ifdef DCM_LAMMPS_2026
  domain->minimum_image(FLERR, dx, dy, dz);
#else
  domain->minimum_image(dx, dy, dz);
#endif
}
}    // namespace LAMMPS_NS

#endif
