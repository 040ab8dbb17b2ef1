// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/sim3_graph.h"

#include <gtest/gtest.h>

#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

// Returns nodes on a circle of radius 5 that look along it, each with a unit of its own (0.5 to 2 of the map's).
std::vector<Sim3> circle(int count, SyntheticScene& scene) {
  std::vector<Sim3> nodes;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    nodes.emplace_back(i == 0 ? 1.0 : scene.uniform(0.5, 2), so3_exp({0, -angle, 0}),
                       Eigen::Vector3d(5 * std::cos(angle), 0.2 * std::sin(3 * angle), 5 * std::sin(angle)));
  }
  return nodes;
}

Vector7d random_step(SyntheticScene& scene, double rotation, double translation, double log_scale) {
  std::normal_distribution<double> n(0, 1);
  Vector7d step;
  for (int k = 0; k < 7; ++k) step[k] = n(scene.rng()) * (k < 3 ? rotation : k < 6 ? translation : log_scale);
  return step;
}

// Returns the true edge between two nodes; its sigmas are small against the circle.
Sim3Graph::Edge edge_between(const std::vector<Sim3>& truth, int first, int second) {
  Sim3Graph::Edge e;
  e.first = first;
  e.second = second;
  e.second_from_first = truth[second].inverse() * truth[first];
  e.sigma_rotation_rad = 0.005;
  e.sigma_translation = 0.01;
  e.sigma_log_scale = 0.005;
  return e;
}

void disturb(SyntheticScene& scene, Sim3Graph::Edge* e) {
  e->second_from_first = e->second_from_first.plus(
      random_step(scene, e->sigma_rotation_rad, e->sigma_translation, e->sigma_log_scale), e->pivot_first);
}

// Returns a graph in which node 0 is fixed at the truth. The other nodes are placed by the first `truth.size() - 1`
// edges, which form a chain.
Sim3Graph chained(const std::vector<Sim3>& truth, const std::vector<Sim3Graph::Edge>& edges) {
  Sim3Graph graph;
  graph.edges = edges;
  graph.nodes.push_back({truth[0], true});
  for (size_t i = 1; i < truth.size(); ++i)
    graph.nodes.push_back({graph.nodes[i - 1].map_from_node * edges[i - 1].second_from_first.inverse(), false});
  return graph;
}

double worst_distance(const Sim3Graph& graph, const std::vector<Sim3>& truth) {
  double worst = 0;
  for (size_t i = 0; i < truth.size(); ++i)
    worst = std::max(worst, (graph.nodes[i].map_from_node.translation - truth[i].translation).norm());
  return worst;
}

TEST(Sim3Graph, DriftingLoopIsClosedByOneEdge) {
  SyntheticScene scene(1);
  const int count = 100;
  const std::vector<Sim3> truth = circle(count, scene);
  std::vector<Sim3Graph::Edge> edges;
  Vector7d drift = Vector7d::Zero();  // 10 % of scale and 6 degrees per lap
  drift[6] = std::log(1.1) / count;
  drift[1] = 0.1 / count;
  for (int i = 1; i < count; ++i) {
    edges.push_back(edge_between(truth, i - 1, i));
    edges.back().second_from_first = edges.back().second_from_first.plus(drift);
  }
  Sim3Graph graph = chained(truth, edges);
  EXPECT_GT(worst_distance(graph, truth), 0.6);
  graph.edges.push_back(edge_between(truth, count - 1, 0));
  const Sim3GraphReport report = solve_sim3_graph({}, &graph);
  ASSERT_TRUE(report.usable && report.converged) << report.reason;
  EXPECT_LT(worst_distance(graph, truth), 0.05);
  for (int i = 0; i < count; ++i) {
    const Vector7d error = graph.nodes[i].map_from_node.minus(truth[i]);
    EXPECT_LT(error.head<3>().norm(), 0.005);
    EXPECT_LT(std::abs(error[6]), 0.005);
  }
  EXPECT_LT(report.final_cost, 0.05 * report.initial_cost);
}

// The residuals at the solution are as large as their sigmas promise.
TEST(Sim3Graph, CostIsThatOfTheRedundantEquations) {
  double chi2 = 0, equations = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    SyntheticScene scene(seed);
    const int count = 20;
    const std::vector<Sim3> truth = circle(count, scene);
    std::vector<Sim3Graph::Edge> edges;
    for (int step = 1; step <= 3; ++step)
      for (int i = step; i < count; ++i) {
        edges.push_back(edge_between(truth, i - step, i));
        edges.back().pivot_first = {1, -2, 3};
        disturb(scene, &edges.back());
      }
    Sim3Graph graph = chained(truth, edges);
    const Sim3GraphReport report = solve_sim3_graph({50, kInfinity}, &graph);
    ASSERT_TRUE(report.usable && report.converged);
    for (const double e : report.edge_chi2) chi2 += e;
    equations += 7.0 * (static_cast<double>(edges.size()) - (count - 1));
  }
  EXPECT_NEAR(chi2 / equations, 1.0, 0.03);
}

TEST(Sim3Graph, AFalseEdgeIsOutvoted) {
  SyntheticScene scene(3);
  const int count = 60;
  const std::vector<Sim3> truth = circle(count, scene);
  std::vector<Sim3Graph::Edge> edges;
  for (int step = 1; step <= 3; ++step)
    for (int i = step; i < count; ++i) {
      edges.push_back(edge_between(truth, i - step, i));
      disturb(scene, &edges.back());
    }
  edges.push_back(edge_between(truth, count - 1, 0));
  const Sim3Graph start = chained(truth, edges);
  Sim3Graph without = start, robust = start, squared = start;
  solve_sim3_graph({}, &without);
  Sim3Graph::Edge lie = edge_between(truth, 10, 40);
  lie.second_from_first = Sim3(0.3, so3_exp({0.5, 1, 0}), Eigen::Vector3d(1, 2, 3));
  robust.edges.push_back(lie);
  squared.edges.push_back(lie);
  const Sim3GraphReport report = solve_sim3_graph({}, &robust);
  ASSERT_TRUE(report.usable);
  ASSERT_TRUE(solve_sim3_graph({50, kInfinity}, &squared).usable);
  EXPECT_GT(report.edge_chi2.back(), 1000);  // it shows that the edge is false
  EXPECT_LT(worst_distance(robust, truth), worst_distance(without, truth) + 0.15);
  EXPECT_GT(worst_distance(squared, truth), 5 * worst_distance(robust, truth));
}

// Edges contradict each other, and their scales are hardly measured. If errors were in the map's unit, shrinking the
// map would reduce them.
TEST(Sim3Graph, ContradictionsDoNotShrinkTheMap) {
  SyntheticScene scene(4);
  const int count = 30;
  std::vector<Sim3> truth = circle(count, scene);
  for (Sim3& node : truth) node.scale = 1;
  std::vector<Sim3Graph::Edge> edges;
  for (int step = 1; step <= 3; ++step)
    for (int i = step; i < count; ++i) {
      edges.push_back(edge_between(truth, i - step, i));
      edges.back().second_from_first.translation += random_step(scene, 0, 0.2, 0).segment<3>(3);
      edges.back().sigma_translation = 0.2;
      edges.back().sigma_log_scale = 0.3;
    }
  Sim3Graph graph = chained(truth, edges);
  ASSERT_TRUE(solve_sim3_graph({200, 14.067}, &graph).usable);
  double mean_log_scale = 0;
  for (const auto& node : graph.nodes) mean_log_scale += std::log(node.map_from_node.scale) / count;
  EXPECT_LT(std::abs(mean_log_scale), 0.15);
}

// The fixed node determines the map's place, attitude and unit. Another choice gives the same map in other units.
TEST(Sim3Graph, TheGaugeDoesNotMatter) {
  SyntheticScene scene(5);
  const int count = 30;
  const std::vector<Sim3> truth = circle(count, scene);
  std::vector<Sim3Graph::Edge> edges;
  for (int step = 1; step <= 2; ++step)
    for (int i = step; i < count; ++i) {
      edges.push_back(edge_between(truth, i - step, i));
      disturb(scene, &edges.back());
    }
  Sim3Graph graph = chained(truth, edges), other = graph;
  const Sim3 other_from_map(1e-3, so3_exp({1, 0.5, -2}), Eigen::Vector3d(7, 8, 9));
  for (auto& node : other.nodes) node.map_from_node = other_from_map * node.map_from_node;
  const Sim3GraphReport a = solve_sim3_graph({}, &graph), b = solve_sim3_graph({}, &other);
  ASSERT_TRUE(a.usable && b.usable);
  EXPECT_NEAR(a.final_cost, b.final_cost, 1e-3 * a.final_cost);
  for (int i = 0; i < count; ++i) {
    const Sim3 expected = other_from_map * graph.nodes[i].map_from_node;
    const Vector7d error = other.nodes[i].map_from_node.minus(expected);
    EXPECT_LT(error.head<3>().norm(), 1e-3);
    EXPECT_LT(error.segment<3>(3).norm(), 1e-3 * 1e-2);
    EXPECT_LT(std::abs(error[6]), 1e-3);
  }
}

TEST(Sim3Graph, WhatWasNotMeasuredIsFree) {
  SyntheticScene scene(6);
  const std::vector<Sim3> truth = circle(3, scene);
  Sim3Graph graph = chained(truth, {edge_between(truth, 0, 1), edge_between(truth, 1, 2)});
  Sim3Graph::Edge e = edge_between(truth, 0, 2);
  e.second_from_first.scale *= 5;
  e.sigma_log_scale = kInfinity;
  graph.edges.push_back(e);
  ASSERT_TRUE(solve_sim3_graph({}, &graph).usable);
  EXPECT_LT(worst_distance(graph, truth), 1e-6);
}

TEST(Sim3Graph, WhatNothingMeasuresStays) {
  SyntheticScene scene(10);
  const std::vector<Sim3> truth = circle(2, scene);
  Sim3Graph graph;
  graph.nodes = {{truth[0], true}, {truth[1].plus(random_step(scene, 0.05, 0.5, 0)), false}};
  graph.edges = {edge_between(truth, 1, 0)};
  graph.edges[0].sigma_log_scale = kInfinity;
  ASSERT_TRUE(solve_sim3_graph({}, &graph).usable);
  EXPECT_LT(graph.nodes[1].map_from_node.minus(truth[1]).norm(), 1e-6);
}

// The graph is large enough for CHOLMOD.
TEST(Sim3Graph, LargeGraph) {
  SyntheticScene scene(11);
  const int count = 800;
  const std::vector<Sim3> truth = circle(count, scene);
  std::vector<Sim3Graph::Edge> edges;
  for (int step = 1; step <= 3; ++step)
    for (int i = step; i < count; ++i) {
      edges.push_back(edge_between(truth, i - step, i));
      edges.back().sigma_rotation_rad = edges.back().sigma_translation = edges.back().sigma_log_scale = 0.002;
      disturb(scene, &edges.back());
    }
  edges.push_back(edge_between(truth, count - 1, 0));
  Sim3Graph graph = chained(truth, edges), again = graph;
  const double before = worst_distance(graph, truth);
  const Sim3GraphReport report = solve_sim3_graph({}, &graph);
  ASSERT_TRUE(report.usable && report.converged);
  EXPECT_LT(worst_distance(graph, truth), 0.5 * before);
  EXPECT_NEAR(2 * report.final_cost / (7.0 * (static_cast<double>(edges.size()) - (count - 1))), 1.0, 0.06);
  solve_sim3_graph({}, &again);
  for (int i = 0; i < count; ++i)
    EXPECT_EQ(graph.nodes[i].map_from_node.translation, again.nodes[i].map_from_node.translation);
}

TEST(Sim3Graph, UnconnectedNodesStay) {
  SyntheticScene scene(7);
  const std::vector<Sim3> truth = circle(8, scene);
  Sim3Graph graph;
  for (const Sim3& t : truth) graph.nodes.push_back({t.plus(random_step(scene, 0.01, 0.1, 0.01)), false});
  graph.nodes[0] = {truth[0], true};
  graph.edges = {edge_between(truth, 0, 1), edge_between(truth, 2, 1), edge_between(truth, 4, 5),
                 edge_between(truth, 5, 6)};
  const Sim3Graph before = graph;
  const Sim3GraphReport report = solve_sim3_graph({}, &graph);
  ASSERT_TRUE(report.usable) << report.reason;
  EXPECT_EQ(report.unconnected_nodes, 5);
  EXPECT_EQ(report.edge_chi2.size(), 4u);
  for (int i : {0, 3, 4, 5, 6, 7}) {
    EXPECT_EQ(graph.nodes[i].map_from_node.translation, before.nodes[i].map_from_node.translation);
    EXPECT_EQ(graph.nodes[i].map_from_node.scale, before.nodes[i].map_from_node.scale);
  }
  for (int i : {1, 2}) EXPECT_LT((graph.nodes[i].map_from_node.translation - truth[i].translation).norm(), 1e-6) << i;
}

TEST(Sim3Graph, NothingToMoveIsNoError) {
  Sim3Graph graph;
  graph.nodes = {{Sim3(), true}, {Sim3(), false}};
  EXPECT_TRUE(solve_sim3_graph({}, &graph).usable);
  graph.nodes[1].fixed = true;
  graph.edges.push_back({0, 1, Sim3(2, Eigen::Quaterniond::Identity(), {1, 0, 0})});
  const Sim3GraphReport report = solve_sim3_graph({}, &graph);
  EXPECT_TRUE(report.usable) << report.reason;
  EXPECT_GT(report.edge_chi2[0], 100);
  EXPECT_EQ(graph.nodes[1].map_from_node.scale, 1);
}

TEST(Sim3Graph, RefusesNonsenseWithAReason) {
  SyntheticScene scene(8);
  const std::vector<Sim3> truth = circle(4, scene);
  const Sim3Graph good =
      chained(truth, {edge_between(truth, 0, 1), edge_between(truth, 1, 2), edge_between(truth, 2, 3)});
  const auto reason = [&](auto spoil) {
    Sim3Graph graph = good;
    spoil(&graph);
    const Sim3GraphReport report = solve_sim3_graph({}, &graph);
    EXPECT_FALSE(report.usable);
    return report.reason;
  };
  EXPECT_EQ(reason([](Sim3Graph* g) { *g = {}; }), "no node is fixed");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->nodes[0].fixed = false; }), "no node is fixed");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->nodes[2].map_from_node.translation.x() = kNaN; }),
            "nodes[2] is not a finite similarity");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->nodes[2].map_from_node.scale = -1; }), "nodes[2] is not a finite similarity");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->edges[1].second_from_first.scale = 0; }),
            "edges[1] is not a finite similarity");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->edges[1].pivot_first.z() = kNaN; }), "edges[1] is not a finite similarity");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->edges[1].second = 4; }), "edges[1] does not join two nodes");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->edges[1].first = 2; }), "edges[1] does not join two nodes");
  EXPECT_EQ(reason([](Sim3Graph* g) { g->edges[2].sigma_log_scale = kNaN; }), "edges[2]: sigma <= 0");
}

TEST(Sim3Graph, RunsAreIdentical) {
  SyntheticScene scene(9);
  const std::vector<Sim3> truth = circle(50, scene);
  std::vector<Sim3Graph::Edge> edges;
  for (int i = 1; i < 50; ++i) {
    edges.push_back(edge_between(truth, i - 1, i));
    disturb(scene, &edges.back());
  }
  edges.push_back(edge_between(truth, 49, 0));
  Sim3Graph a = chained(truth, edges), b = a;
  solve_sim3_graph({}, &a);
  solve_sim3_graph({}, &b);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(a.nodes[i].map_from_node.translation, b.nodes[i].map_from_node.translation);
}

}  // namespace
}  // namespace rumi
