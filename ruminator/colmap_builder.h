// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "ruminator/queue/build_worker.h"

namespace rumi::ruminator {

// build_back_submap() with these options; tests use other builders.
struct ColmapBuilder {
  Builder builder;
  std::function<std::string()> problem;  // what is wrong with COLMAP, for a person; empty while nothing is known
};

// Asks COLMAP at once, in a thread of its own, whether it works, so that the answer is there before the first window.
ColmapBuilder colmap_builder(const BuildOptions& options);

}  // namespace rumi::ruminator
