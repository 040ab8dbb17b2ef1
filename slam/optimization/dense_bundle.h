// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment by Levenberg-Marquardt with the points eliminated (Triggs et al., "Bundle Adjustment: A Modern
// Synthesis", 2000, 6.1) and a dense system of the views: for local windows, and for maps of some hundred views where
// most see the same. Steps, damping and the end of the iterations as Ceres has them, of whose time with ten views more
// than half went into its own bookkeeping.
#pragma once

#include "slam/optimization/bundle_adjustment.h"

namespace rumi {

// As solve_bundle(), which see. Memory: 288 bytes times the square of the number of views that are not fixed.
BundleReport solve_dense_bundle(const Camera& camera, const BundleOptions& options, BundleProblem* problem);

}  // namespace rumi
