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
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_compile_options(-Wall -Wextra -Wpedantic -Wshadow=local)
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

add_custom_target(apps)        # every executable that is installed
add_custom_target(unit_tests)  # every test that is fast enough to run under a sanitizer too
add_custom_target(sanitized_tests)  # those that `make test` runs so: of the code that messages, files and images reach

# rumi_library(NAME SOURCES... [LINK libs...]): one static library per folder; includes are relative to the project root.
function(rumi_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK" ${ARGN})
  add_library(rumi_${name} STATIC ${arg_SOURCES})
  target_include_directories(rumi_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(rumi_${name} PUBLIC ${arg_LINK})
endfunction()

# rumi_executable(NAME SOURCES... [LINK libs...]): lands in build/bin and is installed.
function(rumi_executable name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LINK})
  add_dependencies(apps ${name})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# rumi_test(NAME [SANITIZED] SOURCES... LINK libs... [TIMEOUT s] [LABELS ...] [TOO_LONG_SANITIZED filters]): a GoogleTest
# binary, one CTest entry. Without the label "slow" it is a unit test; a SANITIZED one `make test` runs under sanitizers too, but
# for the tests left out because they would take minutes there (run the binary itself for them).
function(rumi_test name)
  cmake_parse_arguments(arg "SANITIZED" "TIMEOUT" "SOURCES;LINK;LABELS;TOO_LONG_SANITIZED" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LINK} GTest::gtest_main GTest::gmock)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_test(NAME ${name} COMMAND ${name})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  if(NOT slow IN_LIST arg_LABELS)
    list(APPEND arg_LABELS unit)
    add_dependencies(unit_tests ${name})
  endif()
  if(arg_SANITIZED)
    list(APPEND arg_LABELS sanitized)
    add_dependencies(sanitized_tests ${name})
  endif()
  # What tests is not what is tested: compiled quickly.
  target_compile_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1>)
  if(RUMI_SANITIZE MATCHES undefined)
    target_compile_options(${name} PRIVATE -fno-sanitize=undefined)
  endif()
  if(RUMI_SANITIZE)
    math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * 4")  # it only ends what hangs
    list(JOIN arg_TOO_LONG_SANITIZED ":" too_long)
    set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT "GTEST_FILTER=-${too_long}")
  endif()
  if(RUMI_SANITIZE MATCHES address)
    set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp)
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}")
endfunction()
