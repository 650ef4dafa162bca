# dcmplugin.so: the styles of src/DCM and the entry point that LAMMPS looks for

set(LAMMPS_SOURCE_DIR "$ENV{LAMMPS_SOURCE_DIR}" CACHE PATH
  "LAMMPS' src folder (the one with version.h); default: the environment's variable")
set(LAMMPS_SIZES "SMALLBIG" CACHE STRING "integer sizes LAMMPS was built with: SMALLBIG or BIGBIG")
set_property(CACHE LAMMPS_SIZES PROPERTY STRINGS SMALLBIG BIGBIG)

if(NOT EXISTS "${LAMMPS_SOURCE_DIR}/version.h")
  message(FATAL_ERROR "LAMMPS_SOURCE_DIR='${LAMMPS_SOURCE_DIR}' is not LAMMPS' src folder: it has "
    "no version.h.\nPass -D LAMMPS_SOURCE_DIR=/path/to/lammps/src (version 4 Feb 2025 or newer, "
    "built with PKG_PLUGIN=yes), or use tools/run, which builds a LAMMPS of its own. "
    "-D DCM_PLUGIN=OFF builds only the unit tests, which need no LAMMPS.")
endif()

find_package(MPI REQUIRED COMPONENTS CXX)

# LAMMPS' version as the number that lammps_version() returns, e.g. 4 Feb 2025 -> 20250204
file(STRINGS "${LAMMPS_SOURCE_DIR}/version.h" version_line REGEX "LAMMPS_VERSION")
string(REGEX MATCH "\"([0-9]+) ([A-Z][a-z][a-z])[a-z]* ([0-9]+)\"" found "${version_line}")
if(NOT found)
  message(FATAL_ERROR "cannot read the version in ${LAMMPS_SOURCE_DIR}/version.h: ${version_line}")
endif()
set(day ${CMAKE_MATCH_1})
set(year ${CMAKE_MATCH_3})
set(months Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec)
list(FIND months ${CMAKE_MATCH_2} month)
math(EXPR lammps_version "${year} * 10000 + (${month} + 1) * 100 + ${day}")

# the style headers, in the form LAMMPS' own style files have: the plugin registers what they name
file(GLOB DCM_SOURCES CONFIGURE_DEPENDS src/DCM/*.cpp)
file(GLOB DCM_HEADERS CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/src/DCM src/DCM/*.h)
list(FILTER DCM_HEADERS INCLUDE REGEX "^(atom_vec|bond|dihedral|pair|fix|compute|create)_.*\\.h$")
set(style_includes "")
foreach(header IN LISTS DCM_HEADERS)
  string(APPEND style_includes "#include \"${header}\"\n")
endforeach()
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/dcm_style_headers.h CONTENT "${style_includes}")

add_library(dcmplugin MODULE ${DCM_SOURCES} src/plugin/dcmplugin.cpp)
set_target_properties(dcmplugin PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden)
target_include_directories(dcmplugin PRIVATE src/DCM ${CMAKE_CURRENT_BINARY_DIR})
target_include_directories(dcmplugin SYSTEM PRIVATE "${LAMMPS_SOURCE_DIR}")
target_compile_definitions(dcmplugin PRIVATE LAMMPS_${LAMMPS_SIZES} LMP_PLUGIN OMPI_SKIP_MPICXX=1
  DCM_LAMMPS_VERSION=${lammps_version})
target_link_libraries(dcmplugin PRIVATE dcm_options MPI::MPI_CXX)
# styles stay registered in LAMMPS after `plugin unload`: the code must stay as well
target_link_options(dcmplugin PRIVATE -Wl,-z,nodelete)
