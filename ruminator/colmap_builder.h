// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "ruminator/queue/build_worker.h"

namespace rumi::ruminator {

// Calls build_back_submap() with the options of colmap_builder(). Tests use other builders.
struct ColmapBuilder {
  Builder builder;
  std::function<std::string()> problem;  // returns the fault of COLMAP, for users; empty while none is known
};

// Starts to ask COLMAP in a thread whether it works, so that the answer is known before the first window.
ColmapBuilder colmap_builder(const BuildOptions& options);

}  // namespace rumi::ruminator
