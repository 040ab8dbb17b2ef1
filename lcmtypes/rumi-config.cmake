# SPDX-License-Identifier: BSD-3-Clause
# find_package(rumi) gives rumi::lcmtypes (C++ headers: #include "lcmtypes/rumi/track_t.hpp") and rumi::lcmtypes-c
# (C: #include "lcmtypes/rumi_track_t.h"). Both link liblcm.
include(${CMAKE_CURRENT_LIST_DIR}/rumi-targets.cmake)
