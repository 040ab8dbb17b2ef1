# SPDX-License-Identifier: BSD-3-Clause
# Compiler settings that hold for every target, and the helpers that declare them.

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1")
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

find_program(CCACHE ccache)
if(CCACHE)
  # Without these settings, ccache does not keep objects that were compiled with precompiled headers.
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
endif()

add_compile_options(-Wall -Wextra -Wpedantic $<$<CXX_COMPILER_ID:GNU>:-Wshadow=local>)
add_compile_options(-Werror=unused-result)  # refuses code that ignores a Result (base/result.h)
# Results are repeatable to the bit only if the compiler may not fuse floating-point operations.
add_compile_options(-ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-mpopcnt)  # compares binary descriptors; every x86-64 processor since 2008 has it
endif()
if(RUMI_SANITIZE)
  # The checks that are left out take half of the compiler's time, and find nothing that AddressSanitizer would not report, too
  # (such as a null pointer). GCC 12 mistakes code that sanitizers insert for uses of uninitialized variables.
  add_compile_options(-fsanitize=${RUMI_SANITIZE} -fno-sanitize=null,vptr,alignment,object-size -fno-sanitize-recover=all
                      -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  add_link_options(-fsanitize=${RUMI_SANITIZE})
endif()

if(RUMI_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    message(FATAL_ERROR "RUMI_FUZZ needs clang (-DCMAKE_CXX_COMPILER=clang++-14): libFuzzer is part of it")
  endif()
  # All code is instrumented for fuzzing; the fuzzer itself is linked only into the programs of fuzz/.
  set(fuzz_sanitizers address,undefined,float-cast-overflow)
  add_compile_options(-fsanitize=fuzzer-no-link,${fuzz_sanitizers} -fno-sanitize=vptr -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${fuzz_sanitizers})
endif()

# Every file includes this header before Eigen, so that all have the same eigen_assert. The precompiled headers begin with it.
# GCC uses them only if nothing is included before, so only targets without them include this header by an option.
set(RUMI_EIGEN_ASSERT ${PROJECT_SOURCE_DIR}/base/eigen_assert.h)
set(precompiled $<TARGET_PROPERTY:PRECOMPILE_HEADERS>$<TARGET_PROPERTY:PRECOMPILE_HEADERS_REUSE_FROM>)
add_compile_options("$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<STREQUAL:${precompiled},>>:SHELL:-include ${RUMI_EIGEN_ASSERT}>")

include(Precompiled)

# There are three components to install, each with a target that builds it.
add_custom_target(programs)  # the processes and `rumi`, with their configuration, units and pages
add_custom_target(lcmtypes)  # the wire types for C++ and C
add_custom_target(python)    # the wire types for Python, and a module that reads logs and the bus
add_custom_target(apps)      # all three: exactly what `cmake --install` needs
add_dependencies(apps programs lcmtypes python)
add_custom_target(sanitized_tests)  # tests of code that handles messages, files and images: `make test-all` sanitizes it
add_custom_target(threaded_tests)   # tests with threads: `make tsan` runs these under ThreadSanitizer

# rumi_install_needs(COMPONENT FILE): if FILE is missing, the installation says which target to build; CMake alone would only
# say that it cannot find FILE.
function(rumi_install_needs component file)
  install(CODE "
if(NOT EXISTS \"${file}\")
  if(CMAKE_INSTALL_COMPONENT)
    set(target ${component})
  else()
    set(target apps)
  endif()
  message(FATAL_ERROR \"${file} is not built yet. First: cmake --build ${CMAKE_BINARY_DIR} --target \${target}\")
endif()" COMPONENT ${component})
endfunction()

# Components in which every conversion that may change a value must be written as a cast; GCC refuses others.
set(rumi_without_narrowing slam base bus formats synth camera_driver front_tracker ruminator)

# rumi_library(NAME SOURCES... [LINK libs...]): one static library per folder; includes are relative to the project root.
function(rumi_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK" ${ARGN})
  add_library(rumi_${name} STATIC ${arg_SOURCES})
  target_include_directories(rumi_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(rumi_${name} PUBLIC ${arg_LINK})
  if(name IN_LIST rumi_without_narrowing AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(rumi_${name} PRIVATE -Wconversion -Werror=conversion)
  endif()
  rumi_use_precompiled(rumi_${name} rumi_precompiled)
endfunction()

# rumi_executable(NAME SOURCES... [LINK libs...] INSTALL_TO folder): a program that is built in build/bin and installed.
function(rumi_executable name)
  cmake_parse_arguments(arg "" "INSTALL_TO" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LINK})
  add_dependencies(programs ${name})
  rumi_install_needs(programs $<TARGET_FILE:${name}>)
  install(TARGETS ${name} RUNTIME DESTINATION ${arg_INSTALL_TO} COMPONENT programs)
endfunction()

# The processes are installed outside the PATH, because others have programs of these names, too. `rumi up` knows where they
# are (rumi/run/program_folder.h).
set(RUMI_INSTALL_PROGRAM_DIR ${CMAKE_INSTALL_LIBEXECDIR}/rumi)
file(RELATIVE_PATH RUMI_PROGRAMS_FROM_BIN ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBEXECDIR}/rumi)
# The folder of the web page's files (rumi/web/page_files.h).
set(RUMI_INSTALL_PAGE_DIR ${CMAKE_INSTALL_DATADIR}/rumi/web)
file(RELATIVE_PATH RUMI_PAGE_FROM_BIN ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR}/rumi/web)

# rumi_component(NAME [EXCEPT sources...] LINK libs... [MAIN_LINK libs...]): a folder that is a process. It makes a program of
# main.cpp, which also links MAIN_LINK, and a library of all other sources.
function(rumi_component name)
  cmake_parse_arguments(arg "" "" "EXCEPT;LINK;MAIN_LINK" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/main.cpp ${arg_EXCEPT})
  rumi_library(${name} SOURCES ${sources} LINK ${arg_LINK})
  rumi_executable(${name} SOURCES main.cpp LINK rumi_${name} rumi_about ${arg_MAIN_LINK} INSTALL_TO ${RUMI_INSTALL_PROGRAM_DIR})
endfunction()

# Options of test code, which is optimized less than the code that it tests, to compile quickly.
add_library(rumi_test_options INTERFACE)
target_link_libraries(rumi_test_options INTERFACE GTest::gtest GTest::gmock)
target_compile_options(rumi_test_options INTERFACE $<$<CONFIG:RelWithDebInfo>:-O1>)
if(RUMI_SANITIZE MATCHES undefined)
  target_compile_options(rumi_test_options INTERFACE -fno-sanitize=undefined)
endif()

# rumi_test_helper(NAME SOURCES... LINK libs...): a program that tests or scripts use, in build/tests.
function(rumi_test_helper name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
endfunction()

# rumi_test_program(NAME SOURCES... LINK libs...): a GoogleTest binary in build/tests, no CTest entry yet.
function(rumi_test_program name)
  rumi_test_helper(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE rumi_test_options GTest::gtest_main)
  rumi_use_precompiled(${name} rumi_test_precompiled)
endfunction()

function(rumi_add_test_entry name program filter timeout labels)
  add_test(NAME ${name} COMMAND ${program} "--gtest_filter=${filter}")
  if(RUMI_SANITIZE)
    math(EXPR timeout "${timeout} * 4")  # sanitizers are slow, and the limit is only for tests that hang
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${timeout} LABELS "${labels}")
  rumi_suppress_false_reports(${name})
endfunction()

# Suppresses false reports of sanitizers, about code that they cannot see.
function(rumi_suppress_false_reports name)
  if(RUMI_SANITIZE MATCHES address)
    set_property(TEST ${name} PROPERTY ENVIRONMENT LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp)
  elseif(RUMI_SANITIZE MATCHES thread)
    set_property(TEST ${name} PROPERTY ENVIRONMENT TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp)
  endif()
endfunction()

# rumi_test(NAME [SANITIZED] SOURCES... LINK libs... [TIMEOUT s] [LONG filters...] [THREADED filters...]): a GoogleTest binary
# with up to three CTest entries. NAME has the label quick. NAME_long has the label long, and the tests named by LONG, which
# take more than some two seconds each. Under ThreadSanitizer, NAME_threads has the label threads, and the tests named by
# THREADED, which use threads. SANITIZED tests also run with sanitizers, without the long ones (run the binary for those).
function(rumi_test name)
  cmake_parse_arguments(arg "SANITIZED" "TIMEOUT" "SOURCES;LINK;LONG;THREADED" ${ARGN})
  rumi_test_program(${name} SOURCES ${arg_SOURCES} LINK ${arg_LINK})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  set(labels quick)
  if(arg_SANITIZED)
    list(APPEND labels sanitized)
    add_dependencies(sanitized_tests ${name})
  endif()
  list(JOIN arg_LONG ":" long)
  rumi_add_test_entry(${name} ${name} "*-${long}" ${arg_TIMEOUT} "${labels}")
  if(arg_LONG)
    rumi_add_test_entry(${name}_long ${name} "${long}" ${arg_TIMEOUT} long)
  endif()
  if(arg_THREADED AND RUMI_SANITIZE MATCHES thread)
    list(JOIN arg_THREADED ":" threaded)
    rumi_add_test_entry(${name}_threads ${name} "${threaded}" ${arg_TIMEOUT} threads)
    add_dependencies(threaded_tests ${name})
  endif()
endfunction()
