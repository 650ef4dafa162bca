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

set(DCM_EXTRA_DIRS "" CACHE STRING
  "folders with styles of your own to build into the plugin (doc/howto_extend.rst)")

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

# what all sources of styles are compiled with
function(dcm_compile target)
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden
    POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} SYSTEM PRIVATE "${LAMMPS_SOURCE_DIR}")
  target_compile_definitions(${target} PRIVATE LAMMPS_${LAMMPS_SIZES} LMP_PLUGIN OMPI_SKIP_MPICXX=1
    DCM_LAMMPS_VERSION=${lammps_version})
  target_link_libraries(${target} PRIVATE dcm_options MPI::MPI_CXX)
endfunction()

# the package's own styles, compiled once for all plugins
file(GLOB DCM_SOURCES CONFIGURE_DEPENDS src/DCM/*.cpp)
add_library(dcm_styles OBJECT ${DCM_SOURCES})
dcm_compile(dcm_styles)

# dcm_plugin(TARGET FOLDER [DIR...]): FOLDER/dcmplugin.so with the styles of src/DCM and of each
# DIR. It registers what the style macros in their headers name, as LAMMPS' own style files do.
function(dcm_plugin target folder)
  set(sources "")
  set(style_includes "")
  set(dirs "")
  foreach(dir src/DCM ${ARGN})
    get_filename_component(dir "${dir}" ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
    file(GLOB headers CONFIGURE_DEPENDS RELATIVE "${dir}" "${dir}/*.h")
    list(FILTER headers INCLUDE REGEX "^(atom_vec|bond|dihedral|pair|fix|compute|create)_.*\\.h$")
    if(NOT headers)
      message(FATAL_ERROR "DCM_EXTRA_DIRS: ${dir} holds no header of a style (fix_NAME.h, "
        "compute_NAME.h, ...); name the folder that does, or remove it from DCM_EXTRA_DIRS")
    endif()
    foreach(header IN LISTS headers)
      string(APPEND style_includes "#include \"${header}\"\n")
    endforeach()
    list(APPEND dirs "${dir}")
    if(NOT dir STREQUAL "${PROJECT_SOURCE_DIR}/src/DCM")
      file(GLOB found CONFIGURE_DEPENDS "${dir}/*.cpp")
      list(APPEND sources ${found})
    endif()
  endforeach()
  set(generated ${CMAKE_BINARY_DIR}/${target}.styles)
  file(CONFIGURE OUTPUT ${generated}/dcm_style_headers.h CONTENT "${style_includes}")

  add_library(${target} MODULE src/plugin/dcmplugin.cpp ${sources} $<TARGET_OBJECTS:dcm_styles>)
  dcm_compile(${target})
  target_include_directories(${target} PRIVATE ${generated} ${dirs})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME dcmplugin
    LIBRARY_OUTPUT_DIRECTORY "${folder}")
  # styles stay registered in LAMMPS after `plugin unload`: the code must stay as well
  target_link_options(${target} PRIVATE -Wl,-z,nodelete)
endfunction()

dcm_plugin(dcmplugin ${CMAKE_BINARY_DIR} ${DCM_EXTRA_DIRS})
if(DCM_TESTS)
  dcm_plugin(dcmplugin_extend ${CMAKE_BINARY_DIR}/extend examples/extend tests/probe)
endif()
