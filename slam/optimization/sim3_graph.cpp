// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/sim3_graph.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rumi {
namespace {

using Node = Sim3Graph::Node;
using Edge = Sim3Graph::Edge;
using NodeParameters = std::array<double, 8>;

// A similarity as 8 numbers (x y z w of the quaternion, translation, log scale) that moves by Sim3::plus. The Jacobians
// of cost functions have the derivative by that step in their first seven columns, and zeros in the eighth.
class Sim3Manifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 8; }
  int TangentSize() const override { return 7; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    Vector7d step = Eigen::Map<const Vector7d>(delta);
    // Ceres also evaluates a step along the whole gradient. If the result were NaN, Ceres would report convergence or
    // not depending on how the processor compares NaN.
    step[6] = std::clamp(step[6], -kLargestStep, kLargestStep);
    write(read(x).plus(step), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 8, 7, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.topRows<7>().setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector7d>{y_minus_x} = read(y).minus(read(x));
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 8, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.leftCols<7>().setIdentity();
    return true;
  }
  static constexpr double kLargestStep = 100;  // largest change of the log scale in one step

  static Sim3 read(const double* x) {
    return {std::exp(x[7]), Eigen::Quaterniond(x[3], x[0], x[1], x[2]), Eigen::Vector3d(x[4], x[5], x[6])};
  }
  static void write(const Sim3& s, double* x) {
    Eigen::Map<Eigen::Vector4d>{x} = s.rotation.coeffs();
    Eigen::Map<Eigen::Vector3d>{x + 4} = s.translation;
    x[7] = std::log(s.scale);
  }
};

Vector7d weights(const Edge& e) {
  Vector7d w;
  w << Eigen::Vector3d::Constant(1 / e.sigma_rotation_rad), Eigen::Vector3d::Constant(1 / e.sigma_translation),
      1 / e.sigma_log_scale;
  return w;
}

// The residual of an edge in units of sigma.
Vector7d edge_error(const Edge& e, const Sim3& map_from_first, const Sim3& map_from_second) {
  const Sim3 predicted = map_from_second.inverse() * map_from_first;
  return weights(e).cwiseProduct(predicted.minus(e.second_from_first, e.pivot_first));
}

class EdgeError final : public ceres::SizedCostFunction<7, 8, 8> {
 public:
  explicit EdgeError(const Edge& edge) : edge_(edge), weights_(weights(edge)) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Sim3 first = Sim3Manifold::read(parameters[0]), second = Sim3Manifold::read(parameters[1]);
    if (!std::isnormal(first.scale) || !std::isnormal(second.scale)) return false;
    Eigen::Map<Vector7d> error(residuals);
    error = edge_error(edge_, first, second);
    if (!jacobians) return true;

    const Sim3 measured = edge_.second_from_first;
    const Eigen::Matrix3d second_from_map = second.rotation.conjugate().toRotationMatrix();
    const Eigen::Vector3d turn = so3_log(second.rotation.conjugate() * first.rotation * measured.rotation.conjugate());
    const Eigen::Matrix3d by_turn = so3_left_jacobian(turn).inverse() * second_from_map;
    const Eigen::Matrix3d by_move = second_from_map / second.scale;
    const Eigen::Vector3d arm = first.scale * (first.rotation * edge_.pivot_first);  // from the first node to the
                                                                                     // pivot, in the map
    const Eigen::Vector3d pivot = arm + first.translation - second.translation;
    if (jacobians[0]) write(by_turn, by_move, arm, 1, jacobians[0]);
    if (jacobians[1]) write(by_turn, by_move, pivot, -1, jacobians[1]);
    return true;
  }

 private:
  // Writes the derivative of the error by the step of one node. `arm` leads from that node to the pivot, in the map.
  // `sign` is -1 for the second node, whose step acts the opposite way.
  void write(const Eigen::Matrix3d& by_turn, const Eigen::Matrix3d& by_move, const Eigen::Vector3d& arm, double sign,
             double* jacobian) const {
    Eigen::Map<Eigen::Matrix<double, 7, 8, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.topLeftCorner<3, 3>() = sign * by_turn;
    j.block<3, 3>(3, 0) = -sign * by_move * skew(arm);
    j.block<3, 3>(3, 3) = sign * by_move;
    j.block<3, 1>(3, 6) = sign * by_move * arm;
    j(6, 6) = sign;
    j = weights_.asDiagonal() * j;
  }

  Edge edge_;
  Vector7d weights_;
};

bool positive(double sigma) { return sigma > 0; }

std::string check(const Sim3Graph& graph) {
  const int count = static_cast<int>(graph.nodes.size());
  const auto sane = [](const Sim3& s) { return s.is_finite() && s.scale > 0; };
  for (int i = 0; i < count; ++i)
    if (!sane(graph.nodes[i].map_from_node)) return "nodes[" + std::to_string(i) + "] is not a finite similarity";
  if (std::none_of(graph.nodes.begin(), graph.nodes.end(), [](const Node& n) { return n.fixed; }))
    return "no node is fixed";
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const Edge& e = graph.edges[i];
    const std::string name = "edges[" + std::to_string(i) + "]";
    if (e.first < 0 || e.first >= count || e.second < 0 || e.second >= count || e.first == e.second)
      return name + " does not join two nodes";
    if (!sane(e.second_from_first) || !e.pivot_first.allFinite()) return name + " is not a finite similarity";
    if (!positive(e.sigma_rotation_rad) || !positive(e.sigma_translation) || !positive(e.sigma_log_scale))
      return name + ": sigma <= 0";
  }
  return {};
}

// Returns for each node whether a chain of edges connects it to a fixed node.
std::vector<bool> connected_nodes(const Sim3Graph& graph) {
  std::vector<std::vector<int>> neighbours(graph.nodes.size());
  for (const Edge& e : graph.edges) {
    neighbours[e.first].push_back(e.second);
    neighbours[e.second].push_back(e.first);
  }
  std::vector<bool> connected(graph.nodes.size(), false);
  std::vector<int> stack;
  const auto reach = [&](int node) {
    if (connected[node]) return;
    connected[node] = true;
    stack.push_back(node);
  };
  for (size_t i = 0; i < graph.nodes.size(); ++i)
    if (graph.nodes[i].fixed) reach(static_cast<int>(i));
  while (!stack.empty()) {
    const int node = stack.back();
    stack.pop_back();
    for (const int n : neighbours[node]) reach(n);
  }
  return connected;
}

ceres::Solver::Options solver_options(const Sim3GraphOptions& options, size_t nodes) {
  // CHOLMOD is four times as fast on thousands of nodes. On few, its threads cost more than they save.
  constexpr size_t kLarge = 500;
  const bool cholmod = nodes >= kLarge && ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::SUITE_SPARSE);
  ceres::Solver::Options o;
  o.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  o.sparse_linear_algebra_library_type = cholmod ? ceres::SUITE_SPARSE : ceres::EIGEN_SPARSE;
  o.max_num_iterations = options.iterations;
  // The solver begins nearly as Gauss-Newton: the default radius damps the slow bending of long chains, which is what
  // we want to find.
  o.initial_trust_region_radius = 1e10;
  o.num_threads = 1;  // so that results are the same to the bit
  o.logging_type = ceres::SILENT;
  return o;
}

void solve(const Sim3GraphOptions& options, const std::vector<bool>& connected, Sim3Graph* graph,
           Sim3GraphReport* report) {
  std::vector<NodeParameters> parameters(graph->nodes.size());
  for (size_t i = 0; i < parameters.size(); ++i)
    Sim3Manifold::write(graph->nodes[i].map_from_node, parameters[i].data());
  Sim3Manifold manifold;
  ceres::HuberLoss huber(std::sqrt(options.huber_chi2));
  ceres::LossFunction* const loss = std::isinf(options.huber_chi2) ? nullptr : &huber;
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  for (const Edge& e : graph->edges)
    if (connected[e.first])
      problem.AddResidualBlock(new EdgeError(e), loss, parameters[e.first].data(), parameters[e.second].data());
  for (size_t i = 0; i < parameters.size(); ++i) {
    if (!problem.HasParameterBlock(parameters[i].data())) continue;
    problem.SetManifold(parameters[i].data(), &manifold);
    if (graph->nodes[i].fixed) problem.SetParameterBlockConstant(parameters[i].data());
  }

  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(options, parameters.size()), &problem, &summary);
  report->iterations = static_cast<int>(summary.iterations.size());
  report->initial_cost = summary.initial_cost;
  report->final_cost = summary.final_cost;
  report->usable = summary.IsSolutionUsable();
  report->converged = summary.termination_type == ceres::CONVERGENCE;
  if (!report->usable) {
    report->reason = summary.message;
    return;
  }
  for (size_t i = 0; i < parameters.size(); ++i)
    if (connected[i] && !graph->nodes[i].fixed)
      graph->nodes[i].map_from_node = Sim3Manifold::read(parameters[i].data());
}

}  // namespace

std::vector<double> edge_chi2(const Sim3Graph& graph) {
  std::vector<double> chi2;
  for (const Edge& e : graph.edges)
    chi2.push_back(
        edge_error(e, graph.nodes[e.first].map_from_node, graph.nodes[e.second].map_from_node).squaredNorm());
  return chi2;
}

Sim3GraphReport solve_sim3_graph(const Sim3GraphOptions& options, Sim3Graph* graph) {
  Sim3GraphReport report;
  report.reason = check(*graph);
  if (!report.reason.empty()) return report;
  const std::vector<bool> connected = connected_nodes(*graph);
  report.unconnected_nodes = static_cast<int>(std::count(connected.begin(), connected.end(), false));
  solve(options, connected, graph, &report);
  if (report.usable) report.edge_chi2 = edge_chi2(*graph);
  return report;
}

}  // namespace rumi
