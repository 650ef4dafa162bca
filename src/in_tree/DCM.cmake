# Settings of LAMMPS' own CMake build for the DCM package; includes of law/ need nothing here, since
# LAMMPS puts the package's folder on the include path

pkg_depends(DCM MPI)

if(CMAKE_CXX_STANDARD LESS 17)
  message(FATAL_ERROR "The DCM package needs C++17: pass -D CMAKE_CXX_STANDARD=17")
endif()

find_package(Eigen3 3.3 QUIET NO_MODULE)
mark_as_advanced(Eigen3_DIR)
if(NOT Eigen3_FOUND)
  message(FATAL_ERROR "The DCM package needs the headers of Eigen 3.3 or newer: install them "
    "(Debian: libeigen3-dev), or pass -D Eigen3_DIR=<folder of Eigen3Config.cmake>")
endif()
target_link_libraries(lammps PRIVATE Eigen3::Eigen)
