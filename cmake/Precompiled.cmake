# SPDX-License-Identifier: BSD-3-Clause
# Headers that most files include are parsed once; otherwise they take a third of the compiler's time. Every file must still
# include what it uses: a build with -DRUMI_PRECOMPILED=OFF finds includes that were forgotten.
option(RUMI_PRECOMPILED "Precompile the headers that most files include" ON)

set(common_headers ${RUMI_EIGEN_ASSERT}
                   <algorithm> <array> <cmath> <cstdint> <deque> <filesystem> <fstream> <functional> <limits> <map> <memory>
                   <mutex> <optional> <set> <sstream> <string> <utility> <vector>
                   <Eigen/Core> <Eigen/Geometry> <opencv2/core.hpp> <fmt/format.h>)
# Libraries that the headers above need. Their definitions must be the same in all targets that use the headers.
set(common_libraries Eigen3::Eigen opencv_core fmt::fmt)

# GCC accepts a precompiled header only with the options that it was made with: libraries are position independent, tests
# are executables and have options of their own (rumi_test_options).
if(RUMI_PRECOMPILED)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled/main.cpp CONTENT "int main() { return 0; }\n")
  add_library(rumi_precompiled OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/precompiled/main.cpp)
  target_link_libraries(rumi_precompiled PRIVATE ${common_libraries})
  target_precompile_headers(rumi_precompiled PRIVATE ${common_headers})
endif()

# rumi_use_precompiled(TARGET SET): SET is rumi_precompiled or rumi_test_precompiled.
function(rumi_use_precompiled target set)
  if(RUMI_PRECOMPILED)
    target_link_libraries(${target} PRIVATE ${common_libraries})
    target_precompile_headers(${target} REUSE_FROM ${set})
  endif()
endfunction()

# To be called once the tests' options and GoogleTest are known.
function(rumi_precompile_for_tests)
  if(RUMI_PRECOMPILED)
    add_executable(rumi_test_precompiled EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/precompiled/main.cpp)
    target_link_libraries(rumi_test_precompiled PRIVATE rumi_test_options ${common_libraries})
    target_precompile_headers(rumi_test_precompiled PRIVATE ${common_headers} <gtest/gtest.h> <gmock/gmock.h>)
  endif()
endfunction()
