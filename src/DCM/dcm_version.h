/* -*- c++ -*- ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   This software is distributed under the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifndef LMP_DCM_VERSION_H
#define LMP_DCM_VERSION_H

// version of the package, the only place of it: CMake, the manual and tools/run read this line
#define DCM_VERSION "0.1.0"

#endif
