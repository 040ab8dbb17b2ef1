// SPDX-License-Identifier: BSD-3-Clause
// A pose graph over similarities, solved with Ceres: finds the places of submaps (or keyframes) in a map that agree
// best with measured similarities between them.
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
  // A measured similarity. Its error is (map_from_second^-1 * map_from_first).minus(second_from_first, pivot_first).
  // The error's translation is in the unit of the second node, as measured: so it does not shrink if the map gets
  // smaller.
  struct Edge {
    int first = 0, second = 0;
    Sim3 second_from_first;
    // Standard deviations; infinity means that the component was not measured.
    double sigma_rotation_rad = 0.01;  // deviation of each component of the rotation vector
    double sigma_translation = 0.1;    // deviation of each coordinate of the pivot, in the unit of the second node
    double sigma_log_scale = 0.01;
    // The point of the first node whose place in the second node was measured with sigma_translation, independently of
    // rotation and scale (Sim3RefinementReport::pivot_a).
    Eigen::Vector3d pivot_first = Eigen::Vector3d::Zero();
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
};

struct Sim3GraphOptions {
  int iterations = 50;
  // Squared error of an edge, in sigma^2, beyond which the loss is linear: 95 % of a 7-D normal distribution. With
  // infinity the loss is squared everywhere. A wrong edge still pulls with a constant force: if it bends chains of
  // single edges, take out the edges of large chi2 and solve again.
  double huber_chi2 = 14.067;
};

struct Sim3GraphReport {
  bool usable = false;  // false: the graph is unchanged, and `reason` says why
  bool converged = false;
  std::string reason;
  int iterations = 0;
  // The number of nodes that no chain of edges connects to a fixed node. These are not moved.
  int unconnected_nodes = 0;
  double initial_cost = 0, final_cost = 0;  // half the sum of the edges' losses
  std::vector<double> edge_chi2;            // by edge: squared error in sigma^2 in the solution, without the loss
};

// Returns the squared error of each edge in sigma^2, at the present places of the nodes.
std::vector<double> edge_chi2(const Sim3Graph& graph);

// At least one node must be fixed.
Sim3GraphReport solve_sim3_graph(const Sim3GraphOptions& options, Sim3Graph* graph);

}  // namespace rumi
