// SPDX-License-Identifier: BSD-3-Clause
// Compares two ways to find the wrong loops of a pose graph: graduated non-convexity, and dropping the worst loop and
// solving again. Counts the wrong loops that are kept and the right ones that are lost.
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "slam/optimization/graduated_sim3_graph.h"
#include "tests/slam/optimization/walk_with_loops.h"

namespace rumi {
namespace {

using testing::WalkWithLoops;

constexpr unsigned kSeeds = 20;
constexpr int kRight = 10;

struct Score {
  int right_kept = 0, right = 0, wrong_kept = 0, wrong = 0;
  double worst_error = 0, sum_error = 0;
  int runs = 0;
  void add(const WalkWithLoops& walk, const std::vector<bool>& is_wrong, const Sim3Graph& graph) {
    for (size_t g = 0; g < is_wrong.size(); ++g) {
      (walk.is_right()[g] ? right : wrong) += 1;
      (walk.is_right()[g] ? right_kept : wrong_kept) += !is_wrong[g];
    }
    const double error = walk.error(graph);
    worst_error = std::max(worst_error, error);
    sum_error += error;
    ++runs;
  }
};

// Drops the group of edges with the largest median chi2 and solves again, until no median exceeds 100. Returns which
// groups were dropped.
std::vector<bool> drop_one_by_one(const WalkWithLoops& walk, Sim3Graph* graph) {
  std::vector<bool> is_wrong(walk.groups().size(), false);
  for (;;) {
    *graph = Sim3Graph{walk.graph().nodes, {}};
    WalkWithLoops::Groups left;
    std::vector<size_t> name;
    std::vector<bool> drop(walk.graph().edges.size(), false);
    for (size_t g = 0; g < is_wrong.size(); ++g)
      for (const int e : walk.groups()[g]) drop[e] = is_wrong[g];
    std::vector<int> place(drop.size(), 0);
    for (size_t e = 0; e < drop.size(); ++e) {
      place[e] = static_cast<int>(graph->edges.size());
      if (!drop[e]) graph->edges.push_back(walk.graph().edges[e]);
    }
    for (size_t g = 0; g < is_wrong.size(); ++g) {
      if (is_wrong[g]) continue;
      name.push_back(g);
      left.emplace_back();
      for (const int e : walk.groups()[g]) left.back().push_back(place[e]);
    }
    const Sim3GraphReport solved = solve_sim3_graph({}, graph);
    double worst = 100;
    size_t goes = is_wrong.size();
    for (size_t g = 0; g < left.size(); ++g) {
      std::vector<double> all;
      for (const int e : left[g]) all.push_back(solved.edge_chi2[e]);
      std::nth_element(all.begin(), all.begin() + static_cast<long>(all.size()) / 2, all.end());
      if (all[all.size() / 2] > worst) {
        worst = all[all.size() / 2];
        goes = name[g];
      }
    }
    if (goes == is_wrong.size()) return is_wrong;
    is_wrong[goes] = true;
  }
}

// If `alike`, all wrong loops agree with each other; otherwise each has an error of its own.
WalkWithLoops make_walk(unsigned seed, int wrong, bool alike) {
  WalkWithLoops walk(seed);
  for (int i = 0; i < kRight; ++i) walk.add_group(true, 2, Sim3());
  const Sim3 moved = walk.somewhere();
  const int first = walk.integer(0, 50), second = first + 25;
  for (int i = 0; i < wrong; ++i) {
    if (alike)
      walk.add_group(false, 2, moved, first + i % 8, second + i % 8);
    else
      walk.add_group(false, 2, walk.somewhere());
  }
  return walk;
}

void compare(int wrong, bool alike) {
  Score graduated, one_by_one;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const WalkWithLoops walk = make_walk(seed, wrong, alike);
    Sim3Graph graph = walk.graph();
    const GraduatedReport report = solve_graduated(
        {}, walk.groups(), [](size_t) { return true; }, &graph);
    graduated.add(walk, report.is_wrong, graph);
    const std::vector<bool> dropped = drop_one_by_one(walk, &graph);
    one_by_one.add(walk, dropped, graph);
  }
  for (const auto& [name, s] : {std::pair("graduated", graduated), std::pair("one by one", one_by_one)})
    std::printf("| %d, %s | %s | %d of %d | %d of %d | %.3f | %.3f |\n", wrong, alike ? "alike" : "any", name,
                s.right_kept, s.right, s.wrong_kept, s.wrong, s.sum_error / s.runs, s.worst_error);
}

}  // namespace
}  // namespace rumi

int main() {
  std::printf(
      "| wrong, beside 10 right | how | right kept | wrong kept | mean error, m | worst "
      "|\n|---|---|---|---|---|---|\n");
  for (const bool alike : {false, true})
    for (const int wrong : {0, 2, 5, 10, 20}) rumi::compare(wrong, alike);
}
