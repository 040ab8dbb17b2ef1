// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ruminator/queue/build_worker.h"

namespace rumi::ruminator {

// The builder of everything but tests: build_back_submap with these options.
Builder colmap_builder(const BuildOptions& options);

}  // namespace rumi::ruminator
