// SPDX-License-Identifier: BSD-3-Clause
// Solves a pose graph that may have wrong edges, and finds these edges. It uses graduated non-convexity with truncated
// least squares (Yang, Antonante, Tzoumas and Carlone, "Graduated Non-Convexity for Robust Spatial Perception", RA-L
// 2020): at first all groups of edges have full weight. Step by step, the weight of groups that contradict the others
// falls, until each group has full weight or none.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "slam/optimization/sim3_graph.h"

namespace rumi {

struct GraduatedOptions {
  Sim3GraphOptions graph;
  double max_chi2 = 100;  // largest group_chi2 of a right group
};

struct GraduatedReport {
  Sim3GraphReport solved;          // solution without the wrong groups; edge_chi2 has all edges, also those of wrong
                                   // groups
  std::vector<double> group_chi2;  // by group: median of its edges' chi2; 0 if the graph cannot be solved
  std::vector<bool> is_wrong;      // by group
};

// `groups`: edges that are right or wrong together; an edge is in one group at most, and right if it is in none.
// `may_be_wrong(i)`: false if group i must be kept. It is called only if some group exceeds max_chi2 in the first
// solution; otherwise no group is wrong. At least one node must be fixed.
GraduatedReport solve_graduated(const GraduatedOptions& options, const std::vector<std::vector<int>>& groups,
                                const std::function<bool(size_t group)>& may_be_wrong, Sim3Graph* graph);

}  // namespace rumi
