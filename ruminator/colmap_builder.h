// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "ruminator/queue/build_worker.h"

namespace rumi::ruminator {

// The builder of everything but tests: build_back_submap with these options.
struct ColmapBuilder {
  Builder builder;
  std::function<std::string()> problem;  // with COLMAP, for a person; empty while none is known
};

// COLMAP is asked at once, in a thread beside, whether it is there and works, so that this is known before it is
// wanted.
ColmapBuilder colmap_builder(const BuildOptions& options);

}  // namespace rumi::ruminator
