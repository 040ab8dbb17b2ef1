// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment by Ceres, for comparison with solve_bundle().
#pragma once

#include "slam/optimization/bundle_adjustment.h"

namespace rumi {

BundleReport solve_by_ceres(const Camera& camera, const BundleOptions& options, BundleProblem* problem);

}  // namespace rumi
