// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/graduated_sim3_graph.h"

#include <algorithm>
#include <cmath>

#include "slam/numeric/median.h"

namespace rumi {
namespace {

constexpr double kStep = 1.4;  // factor by which mu grows in each step, as in the paper
constexpr int kMostSteps = 40;

class Graduated {
 public:
  Graduated(const GraduatedOptions& options, const std::vector<std::vector<int>>& groups, Sim3Graph* graph)
      : o_(options), groups_(groups), graph_(*graph), weights_(groups.size(), 1.0) {}

  GraduatedReport run(const std::function<bool(size_t)>& may_be_wrong) {
    GraduatedReport report;
    report.solved = solve();
    report.group_chi2 = group_chi2(report.solved);
    if (worst(report) > o_.max_chi2) {
      for (size_t g = 0; g < groups_.size(); ++g) may_be_wrong_[g] = may_be_wrong(g);
      if (const double chi2 = worst(report); chi2 > o_.max_chi2)
        anneal(o_.max_chi2 / (2 * chi2 - o_.max_chi2), &report);
    }
    for (size_t g = 0; g < groups_.size(); ++g)
      report.is_wrong.push_back(may_be_wrong_[g] && (weights_[g] < 0.5 || report.group_chi2[g] > o_.max_chi2));
    return report;
  }

 private:
  double worst(const GraduatedReport& report) const {
    double worst = 0;
    for (size_t g = 0; g < groups_.size(); ++g)
      if (may_be_wrong_[g]) worst = std::max(worst, report.group_chi2[g]);
    return worst;
  }

  // Solves again and again, while the loss goes from nearly convex to truncated least squares.
  void anneal(double mu, GraduatedReport* report) {
    for (int step = 0; step < kMostSteps; ++step, mu *= kStep) {
      for (size_t g = 0; g < groups_.size(); ++g)
        if (may_be_wrong_[g]) weights_[g] = weight(report->group_chi2[g], mu);
      const Sim3GraphReport solved = solve();
      if (!solved.usable) return;
      report->solved = solved;
      report->group_chi2 = group_chi2(solved);
      if (std::all_of(weights_.begin(), weights_.end(), [](double w) { return w == 0 || w == 1; })) return;
    }
  }

  // Returns the weight of a group with this chi2: equation 14 of the paper.
  double weight(double chi2, double mu) const {
    if (chi2 <= mu / (mu + 1) * o_.max_chi2) return 1;
    if (!(chi2 < (mu + 1) / mu * o_.max_chi2)) return 0;
    return std::sqrt(o_.max_chi2 * mu * (mu + 1) / chi2) - mu;
  }

  Sim3GraphReport solve() {
    Sim3Graph weighted{graph_.nodes, {}};
    std::vector<double> weight_of(graph_.edges.size(), 1.0);
    for (size_t g = 0; g < groups_.size(); ++g)
      for (const int edge : groups_[g]) weight_of[edge] = weights_[g];
    for (size_t e = 0; e < graph_.edges.size(); ++e) {
      if (weight_of[e] == 0) continue;
      Sim3Graph::Edge& edge = weighted.edges.emplace_back(graph_.edges[e]);
      const double looser = 1 / std::sqrt(weight_of[e]);
      for (double* sigma : {&edge.sigma_rotation_rad, &edge.sigma_translation, &edge.sigma_log_scale}) *sigma *= looser;
    }
    Sim3GraphReport report = solve_sim3_graph(o_.graph, &weighted);
    if (!report.usable) return report;
    graph_.nodes = std::move(weighted.nodes);
    report.edge_chi2 = edge_chi2(graph_);
    return report;
  }

  std::vector<double> group_chi2(const Sim3GraphReport& solved) const {
    std::vector<double> medians;
    for (const std::vector<int>& group : groups_) {
      std::vector<double> all;
      for (const int edge : group)
        if (solved.usable) all.push_back(solved.edge_chi2[edge]);
      medians.push_back(all.empty() ? 0 : median(&all));
    }
    return medians;
  }

  const GraduatedOptions& o_;
  const std::vector<std::vector<int>>& groups_;
  Sim3Graph& graph_;
  std::vector<double> weights_;
  std::vector<bool> may_be_wrong_ = std::vector<bool>(groups_.size(), true);
};

}  // namespace

GraduatedReport solve_graduated(const GraduatedOptions& options, const std::vector<std::vector<int>>& groups,
                                const std::function<bool(size_t)>& may_be_wrong, Sim3Graph* graph) {
  return Graduated(options, groups, graph).run(may_be_wrong);
}

}  // namespace rumi
