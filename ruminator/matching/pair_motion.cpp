// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/pair_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <optional>

#include "ruminator/matching/opencv_usac.h"
#include "slam/geometry/epipolar.h"
#include "slam/geometry/relative_pose.h"
#include "slam/geometry/rotation_fit.h"
#include "slam/numeric/median.h"

namespace rumi::ruminator {
namespace {

constexpr int kMinMatches = 20;  // least number of matches: twice the parameters of an essential matrix, and outliers
constexpr size_t kMostMatches = 400;  // more would not change the answer
constexpr double kMinSigmaPx = 1;     // least standard deviation of a keypoint: no lens is calibrated better
constexpr double kMaxSigmaPx = 2;  // greatest standard deviation of a keypoint: beyond it, a good fit is due to chance
constexpr double kRoughErrorPx = 3;  // largest error of an inlier while sigma is unknown
constexpr double kNearSigmas = 2;    // largest error of an inlier once sigma is known, in sigmas
constexpr int kSamples = 500;        // most RANSAC samples
constexpr int kTurnSteps = 20;
// Largest errors of a calibration that are assumed: of the log focal length, and of the radial distortion.
constexpr double kFocalSlack = 0.15, kDistortionSlack = 0.05;

using Vector5d = Eigen::Matrix<double, 5, 1>;

// Torr's constant r: a match has 4 coordinates.
constexpr double kCoordinates = 4;
struct ModelSize {
  double dimension = 0;  // dimension of the manifold on which the model's matches lie
  double parameters = 0;
};
constexpr ModelSize kTurnSize{2, 5}, kDepthSize{3, 5};
constexpr double kOutlierFactor = 2;
// The cost of a match that follows no model, but lies anywhere. A model that costs more explains nothing.
const double kUnrelatedCost = std::log(4.0) * kCoordinates;
// Blur makes keypoints uncertain along one direction. An essential matrix can explain that as depth, at a slightly
// lower cost. Therefore a lower cost is not enough for depth: at least kMovedShare of the matches that the essential
// matrix explains must be at least kMovedSigmas away from where the rotation puts them.
constexpr double kMovedShare = 0.2, kMovedSigmas = 4;

// Returns the cost per match. `squares`: squared distances of the matches from the model, in square pixels.
double gric(const std::vector<double>& squares, double sigma_px, ModelSize size) {
  const auto n = static_cast<double>(squares.size());
  const double most = kOutlierFactor * (kCoordinates - size.dimension);
  double sum = std::log(4.0) * size.dimension * n + std::log(4.0 * n) * size.parameters;
  for (const double square : squares) sum += std::min(square / (sigma_px * sigma_px), most);
  return sum / n;
}

struct Matches {
  std::vector<Eigen::Vector2d> first, second;    // rays (x/z, y/z, 1)
  std::vector<cv::Point2d> first_px, second_px;  // rays times the focal length
  double focal_px = 1;
};

Matches select(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
               const std::vector<Eigen::Vector2f>& second, const IndexPairs& pairs) {
  Matches m;
  m.focal_px = 0.5 * (camera.fx + camera.fy);
  const size_t count = std::min(pairs.size(), kMostMatches);
  for (size_t k = 0; k < count; ++k) {
    const auto& [i, j] = pairs[k * pairs.size() / count];
    m.first.push_back(camera.ray(first[i]).hnormalized());
    m.second.push_back(camera.ray(second[j]).hnormalized());
    m.first_px.emplace_back(m.focal_px * m.first.back().x(), m.focal_px * m.first.back().y());
    m.second_px.emplace_back(m.focal_px * m.second.back().x(), m.focal_px * m.second.back().y());
  }
  return m;
}

// Returns the squared Sampson distances of the matches from the epipolar constraint, in square pixels.
std::vector<double> epipolar_errors(const Matches& m, const Eigen::Matrix3d& essential) {
  std::vector<double> squares;
  for (size_t i = 0; i < m.first.size(); ++i) {
    const double px = m.focal_px * sampson_distance(essential, m.first[i].homogeneous(), m.second[i].homogeneous());
    squares.push_back(std::min(px * px, 1e12));
  }
  return squares;
}

double robust_sum(const std::vector<double>& squares) {
  double sum = 0;
  for (const double square : squares) sum += std::min(square, kRoughErrorPx * kRoughErrorPx);
  return sum;
}

// Refines the pose with the matches that it explains. Replaces `best` by its errors if they are smaller.
void offer(const Matches& m, SE3 pose, std::vector<double>* best) {
  std::vector<double> errors = epipolar_errors(m, essential_matrix(pose));
  std::vector<Eigen::Vector2d> first, second;
  for (size_t i = 0; i < errors.size(); ++i) {
    if (errors[i] > std::pow(3 * kRoughErrorPx, 2)) continue;
    first.push_back(m.first[i]);
    second.push_back(m.second[i]);
  }
  if (first.size() < 8) return;
  refine_relative_pose(first, second, 1 / m.focal_px, &pose);
  errors = epipolar_errors(m, essential_matrix(pose));
  if (best->empty() || robust_sum(errors) < robust_sum(*best)) *best = std::move(errors);
}

// Finds the essential matrix with most inliers by RANSAC. Returns an empty matrix if there is none.
cv::Mat sampled_essential(const Matches& m, std::vector<uint8_t>* is_inlier) {
  try {
    const cv::UsacParams usac =
        usac_params({.max_distance = kRoughErrorPx, .confidence = 0.999, .iterations = kSamples});
    const cv::Matx33d k(m.focal_px, 0, 0, 0, m.focal_px, 0, 0, 0, 1);
    const cv::Mat e =
        cv::findEssentialMat(m.first_px, m.second_px, k, k, cv::noArray(), cv::noArray(), *is_inlier, usac);
    if (e.rows == 3 && e.cols == 3 && is_inlier->size() == m.first.size()) return e;
  } catch (const cv::Exception&) {  // degenerate matches, for example all at one point
  }
  is_inlier->clear();
  return {};
}

// Returns the errors of the essential matrix that explains most matches: the sampled one, or one made of the rotation
// `turn` and a step in any direction, refined. The steps are tried because for a small motion sampling finds many
// matrices that fit equally well.
std::vector<double> depth_errors(const Matches& m, const Eigen::Matrix3d& turn, const cv::Mat& sampled) {
  std::vector<double> best;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = 0; z <= 1; ++z)
        if (const Eigen::Vector3d step(x, y, z); z > 0 || x > 0 || (x == 0 && y > 0))
          offer(m, SE3(turn, step.normalized()), &best);
  if (sampled.empty()) return best;
  cv::Mat r1, r2, t;
  cv::decomposeEssentialMat(sampled, r1, r2, t);
  Eigen::Vector3d step;
  cv::cv2eigen(t, step);
  for (const cv::Mat& r : {r1, r2}) {
    Eigen::Matrix3d rotation;
    cv::cv2eigen(r, rotation);
    offer(m, SE3(rotation, step.normalized()), &best);
  }
  return best;
}

// A rotation of a camera whose true lens differs slightly from the calibration.
struct Turn {
  Eigen::Matrix3d second_from_first = Eigen::Matrix3d::Identity();
  double log_focal = 0;   // logarithm of the true focal length over the calibrated one
  double distortion = 0;  // radial distortion that remains after undistorting

  Eigen::Vector2d corrected(const Eigen::Vector2d& ray) const {
    return ray * std::exp(-log_focal) * (1 + distortion * ray.squaredNorm());
  }
};

Turn moved(const Turn& turn, const Vector5d& step) {
  Turn result;
  result.second_from_first = so3_exp(step.head<3>()).toRotationMatrix() * turn.second_from_first;
  result.log_focal = std::clamp(turn.log_focal + step(3), -kFocalSlack, kFocalSlack);
  result.distortion = std::clamp(turn.distortion + step(4), -kDistortionSlack, kDistortionSlack);
  return result;
}

// Returns the residual of each match in the second image, in pixels. Both keypoints have errors, so its variance is
// twice that of a keypoint.
std::vector<Eigen::Vector2d> residuals(const Matches& m, const Turn& turn) {
  std::vector<Eigen::Vector2d> all;
  const double px = m.focal_px * std::exp(turn.log_focal);
  for (size_t i = 0; i < m.first.size(); ++i) {
    const Eigen::Vector3d there = turn.second_from_first * turn.corrected(m.first[i]).homogeneous();
    const Eigen::Vector2d miss = px * (there.hnormalized() - turn.corrected(m.second[i]));
    all.push_back(there.z() > 1e-3 && miss.allFinite() ? miss : Eigen::Vector2d::Constant(1e6));
  }
  return all;
}

std::vector<double> turn_errors(const std::vector<Eigen::Vector2d>& residuals) {
  std::vector<double> squares;
  squares.reserve(residuals.size());
  for (const Eigen::Vector2d& r : residuals) squares.push_back(0.5 * r.squaredNorm());
  return squares;
}

// Sums up Geman and McClure's cost, in which outliers have almost no influence.
double cost_of(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0;
  for (const Eigen::Vector2d& r : residuals) sum += 1 - 1 / (1 + r.squaredNorm() / (kRoughErrorPx * kRoughErrorPx));
  return sum;
}

struct NormalEquations {
  Eigen::Matrix<double, 5, 5> h = Eigen::Matrix<double, 5, 5>::Zero();
  Vector5d g = Vector5d::Zero();

  NormalEquations(const Matches& m, const Turn& turn, const std::vector<Eigen::Vector2d>& at) {
    constexpr double kStep = 1e-5;
    std::array<std::vector<Eigen::Vector2d>, 5> beside;
    Vector5d step;
    for (int k = 0; k < 5; ++k) {
      // At the limit of an allowed calibration error, takes the derivative from the other side.
      step(k) = (k == 3 && turn.log_focal > 0) || (k == 4 && turn.distortion > 0) ? -kStep : kStep;
      beside[k] = residuals(m, moved(turn, step(k) * Vector5d::Unit(k)));
    }
    for (size_t i = 0; i < at.size(); ++i) {
      Eigen::Matrix<double, 2, 5> j;
      for (int k = 0; k < 5; ++k) j.col(k) = (beside[k][i] - at[i]) / step(k);
      const double w = 1 / std::pow(1 + at[i].squaredNorm() / (kRoughErrorPx * kRoughErrorPx), 2);
      h += w * j.transpose() * j;
      g += w * j.transpose() * at[i];
    }
  }
  Vector5d step(double damping) const {
    Eigen::Matrix<double, 5, 5> damped = h;
    damped.diagonal() *= 1 + damping;
    damped.diagonal().array() += 1e-9;
    return -damped.ldlt().solve(g);
  }
};

Turn refine(const Matches& m, Turn turn) {
  std::vector<Eigen::Vector2d> at = residuals(m, turn);
  double damping = 1e-3;
  for (int i = 0; i < kTurnSteps && damping < 1e6; ++i) {
    const Turn next = moved(turn, NormalEquations(m, turn, at).step(damping));
    std::vector<Eigen::Vector2d> there = residuals(m, next);
    if (!(cost_of(there) < cost_of(at))) {
      damping *= 10;
      continue;
    }
    turn = next;
    at = std::move(there);
    damping *= 0.1;
  }
  return turn;
}

// Fits a rotation twice, starting from all matches and from the inliers of the essential matrix, among which few are
// wrong, and returns the better fit. Returns nullopt if no rotation fits.
std::optional<Turn> fit_turn(const Matches& m, const std::vector<uint8_t>& is_inlier) {
  std::optional<Turn> best;
  for (const bool all : {true, false}) {
    std::vector<Eigen::Vector3d> a, b;
    for (size_t i = 0; i < m.first.size(); ++i) {
      if (!all && (is_inlier.empty() || is_inlier[i] == 0)) continue;
      a.push_back(m.first[i].homogeneous());
      b.push_back(m.second[i].homogeneous());
    }
    const std::optional<RotationFit> fit = fit_rotation(std::move(a), std::move(b));
    if (!fit) continue;
    const Turn turn = refine(m, Turn{fit->b_from_a});
    if (!best || cost_of(residuals(m, turn)) < cost_of(residuals(m, *best))) best = turn;
  }
  return best;
}

// Estimates the standard deviation of a keypoint from the matches that the more general model explains.
double sigma_of(const std::vector<double>& squares) {
  std::vector<double> errors;
  for (const double square : squares)
    if (square < kRoughErrorPx * kRoughErrorPx) errors.push_back(std::sqrt(square));
  if (errors.empty()) return kMaxSigmaPx;
  return std::clamp(kSigmaFromMad * median(&errors), kMinSigmaPx, kMaxSigmaPx);
}

int count_inliers(const std::vector<double>& squares, double sigma_px) {
  const double most = std::pow(kNearSigmas * sigma_px, 2);
  return static_cast<int>(std::count_if(squares.begin(), squares.end(), [most](double s) { return s < most; }));
}

double moved_share(const std::vector<double>& turn, const std::vector<double>& depth, double sigma_px) {
  const double near = std::pow(kNearSigmas * sigma_px, 2), far = std::pow(kMovedSigmas * sigma_px, 2);
  int explained = 0, moved = 0;
  for (size_t i = 0; i < turn.size(); ++i) {
    if (depth[i] > near) continue;
    ++explained;
    moved += turn[i] > far;
  }
  return explained > 0 ? static_cast<double>(moved) / explained : 0;
}

}  // namespace

PairMotion judge_motion(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
                        const std::vector<Eigen::Vector2f>& second, const IndexPairs& matches) {
  PairMotion motion;
  if (static_cast<int>(matches.size()) < kMinMatches) return motion;
  const Matches m = select(camera, first, second, matches);
  std::vector<uint8_t> is_inlier;
  const cv::Mat sampled = sampled_essential(m, &is_inlier);
  const std::optional<Turn> fit = fit_turn(m, is_inlier);
  if (!fit) return motion;
  const std::vector<double> turn = turn_errors(residuals(m, *fit));
  const std::vector<double> depth = depth_errors(m, fit->second_from_first, sampled);
  if (depth.empty()) return motion;
  motion.sigma_px = sigma_of(depth);
  motion.turn_rad = std::abs(Eigen::AngleAxisd(fit->second_from_first).angle());
  motion.turn_cost = gric(turn, motion.sigma_px, kTurnSize);
  motion.depth_cost = gric(depth, motion.sigma_px, kDepthSize);
  motion.moved = moved_share(turn, depth, motion.sigma_px);
  const bool turns = motion.turn_cost <= std::min(motion.depth_cost, kUnrelatedCost);
  const bool has_depth = motion.depth_cost < std::min(motion.turn_cost, kUnrelatedCost) && motion.moved >= kMovedShare;
  motion.matches = count_inliers(turns ? turn : depth, motion.sigma_px);
  if (motion.matches < kMinMatches || std::min(motion.turn_cost, motion.depth_cost) > kUnrelatedCost) return motion;
  motion.evidence = static_cast<double>(turn.size()) * (motion.turn_cost - motion.depth_cost);
  if (!turns && !has_depth) return motion;
  const bool is_still = motion.turn_rad * m.focal_px < 2 * motion.sigma_px;
  motion.kind = has_depth ? MotionKind::kDepth : is_still ? MotionKind::kStill : MotionKind::kTurn;
  return motion;
}

}  // namespace rumi::ruminator
