// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment by Ceres and CHOLMOD: for maps of many views, of which each sees the same as its neighbours only.
#pragma once

#include "slam/optimization/bundle_adjustment.h"

namespace rumi {

// As solve_bundle(), which see.
BundleReport solve_sparse_bundle(const Camera& camera, const BundleOptions& options, BundleProblem* problem);

}  // namespace rumi
