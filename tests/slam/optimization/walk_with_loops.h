// SPDX-License-Identifier: BSD-3-Clause
// A pose graph with loops, some of them wrong.
#pragma once

#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "slam/optimization/sim3_graph.h"

namespace rumi::testing {

// A camera that walks three rounds. Each step is measured, places are seen again, and some places are taken for others.
class WalkWithLoops {
 public:
  static constexpr int kNodes = 120, kRound = 40;
  using Groups = std::vector<std::vector<int>>;

  explicit WalkWithLoops(unsigned seed) : random_(seed) {
    for (int i = 0; i < kNodes; ++i) {
      const double angle = 2 * M_PI * i / kRound;
      truth_.emplace_back(1, so3_exp({0, -angle, 0}),
                          Eigen::Vector3d(5 * std::cos(angle), 0.02 * i, 5 * std::sin(angle)));
    }
    graph_.nodes.push_back({truth_[0], true});
    for (int i = 1; i < kNodes; ++i) {
      add_edge(i - 1, i, Sim3(), 0.1 * M_PI / 180, 0.01, 0.005);
      graph_.nodes.push_back({graph_.nodes[i - 1].map_from_node * graph_.edges.back().second_from_first.inverse()});
    }
  }

  // Adds a group of `edges` successive edges that agree with each other. Each measures moved * the true
  // second_from_first.
  void add_group(bool is_right, int edges, const Sim3& moved, int first = kAnywhere, int second = kAnywhere) {
    std::vector<int>& group = groups_.emplace_back();
    is_right_.push_back(is_right);
    if (first == kAnywhere) first = integer(0, kNodes - kRound - 6);
    if (second == kAnywhere) second = is_right ? first + kRound : integer(0, kNodes - 6);
    if (std::abs(second - first) < 10) second = (first + kNodes / 2) % (kNodes - 6);
    for (int i = 0; i < edges; ++i) {
      group.push_back(static_cast<int>(graph_.edges.size()));
      add_edge(first + i, second + i, moved, 0.3 * M_PI / 180, 0.03, 0.02);
    }
  }
  Sim3 somewhere() {
    const auto number = [this] { return std::uniform_real_distribution<double>(-1, 1)(random_); };
    return {std::exp(0.4 * number()), so3_exp(1.5 * Eigen::Vector3d(number(), number(), number())),
            3 * Eigen::Vector3d(number(), number(), number())};
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  double error(const Sim3Graph& graph) const {
    double sum = 0;
    for (int i = 0; i < kNodes; ++i)
      sum += (graph.nodes[i].map_from_node.translation - truth_[i].translation).squaredNorm();
    return std::sqrt(sum / kNodes);
  }
  const Sim3Graph& graph() const { return graph_; }
  const Groups& groups() const { return groups_; }
  const std::vector<bool>& is_right() const { return is_right_; }

 private:
  static constexpr int kAnywhere = -1;

  void add_edge(int first, int second, const Sim3& moved, double rotation_rad, double translation, double log_scale) {
    std::normal_distribution<double> normal;
    Vector7d noise;
    for (int k = 0; k < 7; ++k) noise[k] = normal(random_) * (k < 3 ? rotation_rad : k < 6 ? translation : log_scale);
    const Sim3 measured = moved * (truth_[second].inverse() * truth_[first]).plus(noise);
    graph_.edges.push_back({first, second, measured, rotation_rad, translation, log_scale, Eigen::Vector3d::Zero()});
  }

  std::mt19937 random_;
  std::vector<Sim3> truth_;
  Sim3Graph graph_;
  Groups groups_;
  std::vector<bool> is_right_;
};

}  // namespace rumi::testing
