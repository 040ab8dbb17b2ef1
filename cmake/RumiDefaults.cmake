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
  # Else it does not keep what was compiled with precompiled headers.
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
endif()

add_compile_options(-Wall -Wextra -Wpedantic $<$<CXX_COMPILER_ID:GNU>:-Wshadow=local>)
add_compile_options(-Werror=unused-result)  # a Result (base/result.h) that nobody looks at
# The generated code is repeatable to the bit only if the compiler may not fuse or reorder floating point.
add_compile_options(-ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-mpopcnt)  # binary descriptors; in every x86-64 processor since 2008
endif()
if(RUMI_SANITIZE)
  # The checks left out take half of the compiler's time and find nothing that AddressSanitizer would not end in a report too
  # (a null pointer). GCC 12 takes what the sanitizers insert for uses of uninitialized variables.
  add_compile_options(-fsanitize=${RUMI_SANITIZE} -fno-sanitize=null,vptr,alignment,object-size -fno-sanitize-recover=all
                      -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  add_link_options(-fsanitize=${RUMI_SANITIZE})
endif()

if(RUMI_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    message(FATAL_ERROR "RUMI_FUZZ needs clang (-DCMAKE_CXX_COMPILER=clang++-14): libFuzzer is part of it")
  endif()
  # What is fuzzed is instrumented; the fuzzer itself is linked into the programs of fuzz/ only.
  set(fuzz_sanitizers address,undefined,float-cast-overflow)
  add_compile_options(-fsanitize=fuzzer-no-link,${fuzz_sanitizers} -fno-sanitize=vptr -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${fuzz_sanitizers})
endif()

# Every file gets this header before Eigen, so that all have the same one. The precompiled headers begin with it; GCC takes
# them only where nothing comes before them, so only targets without them include it by an option.
set(RUMI_EIGEN_ASSERT ${PROJECT_SOURCE_DIR}/base/eigen_assert.h)
set(precompiled $<TARGET_PROPERTY:PRECOMPILE_HEADERS>$<TARGET_PROPERTY:PRECOMPILE_HEADERS_REUSE_FROM>)
add_compile_options("$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<STREQUAL:${precompiled},>>:SHELL:-include ${RUMI_EIGEN_ASSERT}>")

include(Precompiled)

# What is installed has three components, each with a target that builds it.
add_custom_target(programs)  # the processes and `rumi`, with their configuration, units and pages
add_custom_target(lcmtypes)  # the wire types for C++ and C
add_custom_target(python)    # the same for Python, and what reads logs and the bus there
add_custom_target(apps)      # all of it: what `cmake --install` needs, and no more
add_dependencies(apps programs lcmtypes python)
add_custom_target(sanitized_tests)  # tests of the code that messages, files and images reach: `make test-all` sanitizes them
add_custom_target(threaded_tests)   # tests with threads: `make tsan` runs these under ThreadSanitizer

# rumi_install_needs(COMPONENT FILE): installing says what to build where CMake alone would say what it cannot find.
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

# Components in which every conversion that may change a value is written as a cast. GCC finds what is not.
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

# rumi_executable(NAME SOURCES... [LINK libs...] INSTALL_TO folder): lands in build/bin and is installed.
function(rumi_executable name)
  cmake_parse_arguments(arg "" "INSTALL_TO" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LINK})
  add_dependencies(programs ${name})
  rumi_install_needs(programs $<TARGET_FILE:${name}>)
  install(TARGETS ${name} RUNTIME DESTINATION ${arg_INSTALL_TO} COMPONENT programs)
endfunction()

# Off the PATH: others have programs of these names, too. `rumi up` knows where they are (rumi/run/program_folder.h).
set(RUMI_INSTALL_PROGRAM_DIR ${CMAKE_INSTALL_LIBEXECDIR}/rumi)
file(RELATIVE_PATH RUMI_PROGRAMS_FROM_BIN ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBEXECDIR}/rumi)
# What a browser shows of it (rumi/web/page_files.h).
set(RUMI_INSTALL_PAGE_DIR ${CMAKE_INSTALL_DATADIR}/rumi/web)
file(RELATIVE_PATH RUMI_PAGE_FROM_BIN ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR}/rumi/web)

# rumi_component(NAME [EXCEPT sources...] LINK libs... [MAIN_LINK libs...]): a folder that is a process: main.cpp, which
# also links MAIN_LINK, and a library of all else.
function(rumi_component name)
  cmake_parse_arguments(arg "" "" "EXCEPT;LINK;MAIN_LINK" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/main.cpp ${arg_EXCEPT})
  rumi_library(${name} SOURCES ${sources} LINK ${arg_LINK})
  rumi_executable(${name} SOURCES main.cpp LINK rumi_${name} rumi_about ${arg_MAIN_LINK} INSTALL_TO ${RUMI_INSTALL_PROGRAM_DIR})
endfunction()

# What tests is not what is tested: compiled quickly.
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
    math(EXPR timeout "${timeout} * 4")  # it only ends what hangs
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${timeout} LABELS "${labels}")
  rumi_suppress_false_reports(${name})
endfunction()

# Of sanitizers, about what they cannot see.
function(rumi_suppress_false_reports name)
  if(RUMI_SANITIZE MATCHES address)
    set_property(TEST ${name} PROPERTY ENVIRONMENT LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp)
  elseif(RUMI_SANITIZE MATCHES thread)
    set_property(TEST ${name} PROPERTY ENVIRONMENT TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp)
  endif()
endfunction()

# rumi_test(NAME [SANITIZED] SOURCES... LINK libs... [TIMEOUT s] [LONG filters...] [THREADED filters...]): a GoogleTest binary. One CTest entry,
# NAME, of label quick; the tests named by LONG, which take more than some two seconds each, are another, NAME_long, of label
# long. Sanitizers are for SANITIZED ones, without the long tests (run the binary itself for them). Under ThreadSanitizer
# the tests named by THREADED, those that use threads, are a third entry, NAME_threads, of label threads.
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
