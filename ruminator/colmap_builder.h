// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ruminator/build_worker.h"

namespace rumi {

// The builder of everything but tests: build_back_submap with these options.
Builder colmap_builder(const BuildOptions& options);

}  // namespace rumi
