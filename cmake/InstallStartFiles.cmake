# SPDX-License-Identifier: BSD-3-Clause
# Runs while the programs are installed: writes units for systemd and the file for procman, with the programs' folder.
# Variables that must be set: source, a folder; program_dir and procman_dir, folders relative to the prefix.
cmake_path(ABSOLUTE_PATH CMAKE_INSTALL_PREFIX NORMALIZE OUTPUT_VARIABLE prefix)
cmake_path(ABSOLUTE_PATH program_dir BASE_DIRECTORY ${prefix} NORMALIZE OUTPUT_VARIABLE RUMI_PROGRAMS)

function(install_configured template folder)
  cmake_path(GET template FILENAME name)
  string(REGEX REPLACE "\\.in$" "" name ${name})
  cmake_path(ABSOLUTE_PATH folder BASE_DIRECTORY ${prefix} NORMALIZE)
  message(STATUS "Installing: $ENV{DESTDIR}${folder}/${name}")
  configure_file(${template} "$ENV{DESTDIR}${folder}/${name}" @ONLY)
  set(CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_MANIFEST_FILES};${folder}/${name}" PARENT_SCOPE)
endfunction()

# systemd looks into lib/ of /usr and /usr/local, whatever the library folder of the machine is called.
file(GLOB units ${source}/systemd/*)
foreach(unit ${units})
  install_configured(${unit} lib/systemd/system)
endforeach()
install_configured(${source}/procman/rumi.pmd.in ${procman_dir})
