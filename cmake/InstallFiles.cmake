# SPDX-License-Identifier: BSD-3-Clause
# Installs the files that are not built, by component (programs, lcmtypes, python).
set(config_dir ${CMAKE_INSTALL_DATADIR}/rumi/config)
set(example_dir ${CMAKE_INSTALL_DOCDIR}/examples)

install(FILES config/rumi.yaml config/expert.yaml DESTINATION ${config_dir} COMPONENT programs)
install(DIRECTORY config/cameras DESTINATION ${config_dir} COMPONENT programs)
install(DIRECTORY rumi/web/page/ DESTINATION ${RUMI_INSTALL_PAGE_DIR} COMPONENT programs)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
foreach(component programs lcmtypes python)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT ${component})
endforeach()
install(FILES examples/CMakeLists.txt examples/listener.cpp DESTINATION ${example_dir} COMPONENT lcmtypes)
install(FILES examples/listener.py examples/read_log.py DESTINATION ${example_dir} COMPONENT python)

# Files that start the programs name their folder, which is known only during installation (`cmake --install --prefix`).
install(CODE "
set(source \"${PROJECT_SOURCE_DIR}/config\")
set(program_dir \"${RUMI_INSTALL_PROGRAM_DIR}\")
set(procman_dir \"${config_dir}/procman\")
include(\"${CMAKE_CURRENT_LIST_DIR}/InstallStartFiles.cmake\")" COMPONENT programs)
