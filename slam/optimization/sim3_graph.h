// SPDX-License-Identifier: BSD-3-Clause
// Pose graph over similarities, with Ceres: places of submaps (or keyframes) in a map that agree best with measured
// similarities between them.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi {

struct Sim3Graph {
  struct Node {
    Sim3 map_from_node;
    bool fixed = false;
  };
  // A measured similarity. Its error is (map_from_second^-1 * map_from_first).minus(second_from_first, pivot_first):
  // the translation is in the unit of the second node, as it was measured, so that neither a smaller map nor other
  // units of it make a graph agree better.
  struct Edge {
    int first = 0, second = 0;
    Sim3 second_from_first;
    // Standard deviations; infinite: not measured.
    double sigma_rotation_rad = 0.01;  // of each component of the rotation vector
    double sigma_translation = 0.1;    // of each coordinate of the pivot, in the unit of the second node
    double sigma_log_scale = 0.01;
    // The point of the first node whose place in the second was measured with sigma_translation, independently of
    // rotation and scale (Sim3RefinementReport::pivot_a).
    Eigen::Vector3d pivot_first = Eigen::Vector3d::Zero();
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
};

struct Sim3GraphOptions {
  int iterations = 50;
  // Squared error of an edge where the loss turns from squared to linear, in sigma^2: 95 % of a 7-D normal
  // distribution. Infinite: squared loss. A false edge still pulls with a constant force: where chains of single edges
  // must bear it, take out edges of large chi2 and solve again.
  double huber_chi2 = 14.067;
};

struct Sim3GraphReport {
  bool usable = false;  // false: the graph is unchanged, `reason` says why
  bool converged = false;
  std::string reason;
  int iterations = 0;
  // Nodes that no chain of edges joins to a fixed node. They stay where they are.
  int unconnected_nodes = 0;
  double initial_cost = 0, final_cost = 0;  // half the sum of the edges' losses
  std::vector<double> edge_chi2;            // per edge, squared error over sigma^2 after the solution, without the loss
};

// Squared error over sigma^2 of each edge as the nodes are.
std::vector<double> edge_chi2(const Sim3Graph& graph);

// At least one node must be fixed.
Sim3GraphReport solve_sim3_graph(const Sim3GraphOptions& options, Sim3Graph* graph);

}  // namespace rumi
