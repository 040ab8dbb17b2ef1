# SPDX-License-Identifier: BSD-3-Clause
# Target `manual` makes man pages (by help2man) and completion for bash and zsh (by Python) from --help. Only those who install
# need it, so it is no part of `all` or `apps`. Parts that were not built are not installed.
set(manual_dir ${CMAKE_BINARY_DIR}/manual)
set(script_dir ${PROJECT_SOURCE_DIR}/packaging)
find_program(HELP2MAN help2man)
find_package(Python3 COMPONENTS Interpreter)
add_custom_target(manual)

# rumi_manual_part(NAME CAN_BE_MADE SCRIPT WITHOUT): `SCRIPT RUMI FOLDER` writes the part NAME. If it cannot be made, WITHOUT
# is printed, which says what will be missing, and why.
function(rumi_manual_part name can_be_made script without)
  if(can_be_made AND NOT CMAKE_CROSSCOMPILING)
    add_custom_command(OUTPUT ${manual_dir}/${name}.done
                       COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual_dir}/${name}
                       COMMAND ${script_dir}/${script} $<TARGET_FILE:rumi> ${manual_dir}/${name}
                       COMMAND ${CMAKE_COMMAND} -E touch ${manual_dir}/${name}.done
                       DEPENDS rumi camera_driver front_tracker ruminator map_server viewer_offscreen ${script_dir}/${script}
                       VERBATIM)
    add_custom_target(manual_${name} DEPENDS ${manual_dir}/${name}.done)
  else()
    add_custom_target(manual_${name} COMMAND ${CMAKE_COMMAND} -E echo ${without})
  endif()
  add_dependencies(manual manual_${name})
endfunction()
rumi_manual_part(man "${HELP2MAN}" man_pages.sh "There will be no man pages: they need help2man, and a program that runs here.")
rumi_manual_part(completions "${Python3_FOUND}" completions.py
                 "There will be no completion for bash and zsh: it needs Python 3, and a program that runs here.")

install(DIRECTORY ${manual_dir}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs OPTIONAL)
install(FILES ${manual_dir}/completions/rumi DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT programs OPTIONAL)
install(FILES ${manual_dir}/completions/_rumi DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions
        COMPONENT programs OPTIONAL)
