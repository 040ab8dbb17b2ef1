// SPDX-License-Identifier: BSD-3-Clause
// A pose graph some of whose edges may be wrong: which are, and where the nodes are without them. Graduated
// non-convexity with truncated least squares (Yang, Antonante, Tzoumas and Carlone, "Graduated Non-Convexity for Robust
// Spatial Perception", RA-L 2020): all are believed at first, and the farther out of what the others say one is, the
// less it counts, step by step, until each counts in full or not at all.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "slam/optimization/sim3_graph.h"

namespace rumi {

struct GraduatedOptions {
  Sim3GraphOptions graph;
  double max_chi2 = 100;  // of a group that is right
};

struct GraduatedReport {
  Sim3GraphReport solved;          // without the wrong groups; edge_chi2 of all edges, those of wrong groups too
  std::vector<double> group_chi2;  // median of its edges
  std::vector<bool> is_wrong;      // per group
};

// groups: indices of edges that are right or wrong together, each in one group at most; edges of none are right, and so
// are groups that cannot be wrong, which is asked only if there is one above max_chi2 in the first solution. Where none
// is, nothing is wrong. At least one node must be fixed.
GraduatedReport solve_graduated(const GraduatedOptions& options, const std::vector<std::vector<int>>& groups,
                                const std::function<bool(size_t group)>& may_be_wrong, Sim3Graph* graph);

}  // namespace rumi
