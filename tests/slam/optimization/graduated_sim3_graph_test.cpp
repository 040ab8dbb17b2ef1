// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/graduated_sim3_graph.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/slam/optimization/walk_with_loops.h"

namespace rumi {
namespace {

using testing::WalkWithLoops;

const auto kAnyMayBeWrong = [](size_t) { return true; };

double error_without_wrong_ones(unsigned seed) {
  WalkWithLoops walk(seed);
  for (int i = 0; i < 10; ++i) walk.add_group(true, 2, Sim3());
  Sim3Graph graph = walk.graph();
  solve_sim3_graph({}, &graph);
  return walk.error(graph);
}

void expect_the_wrong_ones_found(const WalkWithLoops& walk, double error) {
  Sim3Graph graph = walk.graph();
  const GraduatedReport report = solve_graduated({}, walk.groups(), kAnyMayBeWrong, &graph);
  ASSERT_TRUE(report.solved.usable);
  ASSERT_EQ(report.is_wrong.size(), walk.is_right().size());
  for (size_t g = 0; g < report.is_wrong.size(); ++g)
    EXPECT_NE(report.is_wrong[g], walk.is_right()[g]) << "group " << g;
  EXPECT_NEAR(walk.error(graph), error, 1e-3);
}

TEST(GraduatedSim3Graph, FindsTwiceAsManyWrongLoopsAsRightOnes) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    WalkWithLoops walk(seed);
    for (int i = 0; i < 10; ++i) walk.add_group(true, 2, Sim3());
    for (int i = 0; i < 20; ++i) walk.add_group(false, 2, walk.somewhere());
    expect_the_wrong_ones_found(walk, error_without_wrong_ones(seed));
  }
}

// One place looks like another, so that all wrong loops agree with each other.
TEST(GraduatedSim3Graph, FindsWrongLoopsThatBearEachOtherOut) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    WalkWithLoops walk(seed);
    for (int i = 0; i < 10; ++i) walk.add_group(true, 2, Sim3());
    const Sim3 moved = walk.somewhere();
    for (int i = 0; i < 10; ++i) walk.add_group(false, 2, moved, 20 + i % 8, 45 + i % 8);
    expect_the_wrong_ones_found(walk, error_without_wrong_ones(seed));
  }
}

TEST(GraduatedSim3Graph, WithoutContradictionItIsThePlainSolution) {
  WalkWithLoops walk(1);
  for (int i = 0; i < 10; ++i) walk.add_group(true, 2, Sim3());
  Sim3Graph graduated = walk.graph(), plain = walk.graph();
  const auto never = [](size_t) {
    ADD_FAILURE() << "asked without need";
    return true;
  };
  solve_graduated({}, walk.groups(), never, &graduated);
  solve_sim3_graph({}, &plain);
  for (size_t i = 0; i < plain.nodes.size(); ++i)
    EXPECT_EQ(plain.nodes[i].map_from_node.translation, graduated.nodes[i].map_from_node.translation);
}

TEST(GraduatedSim3Graph, WhatCannotBeWrongStays) {
  WalkWithLoops walk(1);
  for (int i = 0; i < 3; ++i) walk.add_group(true, 2, Sim3());
  walk.add_group(false, 2, walk.somewhere());
  Sim3Graph graph = walk.graph();
  const auto not_the_last = [&](size_t group) { return group + 1 < walk.groups().size(); };
  const GraduatedReport report = solve_graduated({}, walk.groups(), not_the_last, &graph);
  EXPECT_FALSE(report.is_wrong.back());
}

TEST(GraduatedSim3Graph, NothingIsChangedWhereNothingCanBeSolved) {
  WalkWithLoops walk(1);
  walk.add_group(false, 2, walk.somewhere());
  Sim3Graph graph = walk.graph();
  graph.nodes[0].fixed = false;
  const GraduatedReport report = solve_graduated({}, walk.groups(), kAnyMayBeWrong, &graph);
  EXPECT_FALSE(report.solved.usable);
  EXPECT_EQ(report.solved.reason, "no node is fixed");
  EXPECT_EQ(std::count(report.is_wrong.begin(), report.is_wrong.end(), true), 0);
}

}  // namespace
}  // namespace rumi
