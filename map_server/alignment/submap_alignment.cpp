// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/alignment/submap_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "map_server/alignment/bent_end.h"
#include "slam/numeric/median.h"
#include "slam/optimization/sim3_refinement.h"

namespace rumi::map_server {
namespace {

// The two poses of a shared keyframe agree if their rotations differ by at most kMaxRotationDeg, and their camera
// centres by at most kMaxCenterDepthRatio of the median depth.
constexpr double kMaxRotationDeg = 3.0;
constexpr double kMaxCenterDepthRatio = 0.1;
constexpr double kMinKeyframeRatio = 0.7;  // share of the shared keyframes that must agree
// The scale is measured by the depths of common landmarks. Their errors are correlated, so they count as at most
// kIndependentDepths independent ones, and the standard deviation of the log scale is at least kMinSigmaDepthScale.
constexpr int kIndependentDepths = 10;
constexpr double kMinSigmaDepthScale = 0.005;

// A landmark match, with the values that scoring needs.
struct Pair {
  Eigen::Vector3d point_a, point_b;
  Eigen::Vector2d pixel;
  double depth_a, depth_b, sigma_px;
  const SE3* cam_from_a;
  const SE3* cam_from_b;
};

class Aligner {
 public:
  Aligner(const Submap& a, const Submap& b, const Correspondences& common, const AlignmentOptions& options)
      : a_(a), b_(b), common_(common), o_(options) {
    for (const LandmarkMatch& match : common.landmarks) {
      const SharedKeyframe& shared = common.keyframes[match.shared];
      const Keyframe& in_a = *a.keyframe(shared.a);
      const Keyframe& in_b = *b.keyframe(shared.b);
      const Eigen::Vector3d point_a = a.landmark(match.a)->position, point_b = b.landmark(match.b)->position;
      pairs_.push_back({point_a, point_b, in_b.features->undistorted[match.keypoint_b].cast<double>(),
                        (in_a.cam_from_submap * point_a).z(), (in_b.cam_from_submap * point_b).z(),
                        b.pyramid.scale(in_b.features->keypoints[match.keypoint_b].octave), &in_a.cam_from_submap,
                        &in_b.cam_from_submap});
    }
  }

  Alignment run() {
    Alignment best = estimate([](size_t) { return true; });
    judge(&best);
    return best;
  }

 private:
  using Chosen = std::function<bool(size_t shared)>;

  // Lets each of the chosen shared keyframes propose a similarity, and scores the proposals on all shared keyframes.
  Alignment estimate(const Chosen& chosen) const {
    Alignment best;
    best.landmarks = static_cast<int>(pairs_.size());
    best.keyframes = static_cast<int>(common_.keyframes.size());
    for (size_t k = 0; k < common_.keyframes.size(); ++k) {
      const std::optional<Sim3> proposal = chosen(k) ? propose(static_cast<int>(k)) : std::nullopt;
      if (!proposal) continue;
      Alignment candidate = best;
      score(*proposal, &candidate);
      if (candidate.landmark_inliers > best.landmark_inliers) best = candidate;
    }
    if (best.landmark_inliers > 0) refine(chosen, &best);
    return best;
  }

  std::optional<Sim3> propose(int shared) const {
    const ScaleRatio ratio = scale_ratio(a_, b_, common_, shared, std::max(3, o_.min_landmarks / 4));
    if (!std::isfinite(ratio.sigma)) return std::nullopt;
    const SE3& cam_from_a = a_.keyframe(common_.keyframes[shared].a)->cam_from_submap;
    const SE3& cam_from_b = b_.keyframe(common_.keyframes[shared].b)->cam_from_submap;
    return similarity_through(cam_from_a, cam_from_b, std::exp(ratio.log_b_over_a));
  }

  double error_px(const Sim3& b_from_a, const Pair& pair) const {
    const Eigen::Vector3d in_b = *pair.cam_from_b * (b_from_a * pair.point_a);
    const Eigen::Vector3d in_a = *pair.cam_from_a * (b_from_a.inverse() * pair.point_b);
    if (!(in_a.z() > 1e-9 && in_b.z() > 1e-9)) return std::numeric_limits<double>::infinity();
    const double forward = (b_.camera.project_undistorted(in_b) - pair.pixel).norm();
    const double backward = (a_.camera.project_undistorted(in_a) - pair.pixel).norm();
    return std::max(forward, backward) / pair.sigma_px;
  }

  void score(const Sim3& b_from_a, Alignment* alignment) const {
    alignment->b_from_a = b_from_a;
    alignment->inlier.assign(pairs_.size(), 0);
    alignment->landmark_inliers = 0;
    double sum = 0;
    for (size_t i = 0; i < pairs_.size(); ++i) {
      const double error = error_px(b_from_a, pairs_[i]);
      if (error > o_.max_reprojection_px) continue;
      alignment->inlier[i] = 1;
      ++alignment->landmark_inliers;
      sum += error * error;
    }
    alignment->rmse_px = std::sqrt(sum / std::max(1, alignment->landmark_inliers));
    score_frames(alignment);
  }

  void score_frames(Alignment* alignment) const {
    alignment->keyframe_inlier.assign(common_.keyframes.size(), 0);
    alignment->keyframe_inliers = 0;
    for (size_t k = 0; k < common_.keyframes.size(); ++k) {
      const SE3& cam_from_a = a_.keyframe(common_.keyframes[k].a)->cam_from_submap;
      const SE3& cam_from_b = b_.keyframe(common_.keyframes[k].b)->cam_from_submap;
      const SE3 moved = alignment->b_from_a.transform_camera(cam_from_a);
      std::vector<double> depths;
      for (size_t i = 0; i < pairs_.size(); ++i)
        if (common_.landmarks[i].shared == static_cast<int>(k) && pairs_[i].depth_b > 0)
          depths.push_back(pairs_[i].depth_b);
      if (depths.empty()) continue;
      const double angle = moved.rotation.angularDistance(cam_from_b.rotation) * 180 / M_PI;
      const double distance = (moved.center() - cam_from_b.center()).norm() / median(&depths);
      if (!(angle <= kMaxRotationDeg && distance <= kMaxCenterDepthRatio)) continue;
      alignment->keyframe_inlier[k] = 1;
      ++alignment->keyframe_inliers;
    }
  }

  // Returns the scale from the depths of the inliers, and its standard deviation from their scatter. If the camera
  // hardly moves in the shared keyframes, nothing else determines the scale.
  Sim3RefinementProblem::ScaleMeasurement scale_from_depths(const std::vector<size_t>& inliers) const {
    std::vector<double> logs;
    logs.reserve(inliers.size());
    for (size_t i : inliers) logs.push_back(std::log(pairs_[i].depth_b / pairs_[i].depth_a));
    const RobustMean scale = robust_mean(&logs, std::min<double>(static_cast<double>(logs.size()), kIndependentDepths));
    return {scale.value, std::max(scale.sigma, kMinSigmaDepthScale)};
  }

  // Solves equation 8 of the paper, in both directions, with the inliers of the best proposal in the chosen keyframes.
  void refine(const Chosen& chosen, Alignment* best) const {
    Sim3RefinementProblem problem;
    std::vector<size_t> with_depths;
    for (size_t i = 0; i < pairs_.size(); ++i) {
      if (!best->inlier[i] || !chosen(common_.landmarks[i].shared)) continue;
      const Pair& pair = pairs_[i];
      if (pair.depth_a > 0 && pair.depth_b > 0) with_depths.push_back(i);
      problem.a_into_b.push_back({pair.point_a, *pair.cam_from_b, pair.pixel, pair.sigma_px});
      problem.b_into_a.push_back({pair.point_b, *pair.cam_from_a, pair.pixel, pair.sigma_px});
    }
    if (!with_depths.empty()) problem.scales.push_back(scale_from_depths(with_depths));
    Alignment refined = *best;
    const Sim3RefinementReport report = refine_sim3(b_.camera, {}, problem, &refined.b_from_a);
    if (!report.usable) {
      best->doubt = report.reason;
      return;
    }
    score(refined.b_from_a, &refined);
    refined.sigma_rotation_deg = report.sigma_rotation_rad * 180 / M_PI;
    refined.sigma_log_scale = report.sigma_log_scale;
    *best = std::move(refined);
  }

  // Returns true if a similarity estimated from the even keyframes also holds in the odd ones.
  bool holds_where_not_used() const {
    const Alignment even = estimate([](size_t k) { return k % 2 == 0; });
    int landmarks = 0, inliers = 0;
    for (size_t i = 0; i < even.inlier.size(); ++i) {
      if (common_.landmarks[i].shared % 2 == 0) continue;
      ++landmarks;
      inliers += even.inlier[i];
    }
    return inliers > 0 && inliers >= o_.min_inlier_ratio * landmarks;
  }

  void judge(Alignment* best) const {
    if (!best->doubt.empty()) return;
    const int wanted = std::max(o_.min_landmarks, static_cast<int>(std::ceil(o_.min_inlier_ratio * best->landmarks)));
    if (best->keyframes < kMinSharedKeyframes)
      best->doubt = fmt::format("{} shared keyframes of {} wanted", best->keyframes, kMinSharedKeyframes);
    else if (best->landmark_inliers < wanted)
      best->doubt =
          fmt::format("{} of {} common landmarks agree, {} wanted", best->landmark_inliers, best->landmarks, wanted);
    else if (best->keyframe_inliers < kMinKeyframeRatio * best->keyframes)
      best->doubt = fmt::format("{} of {} shared keyframes agree", best->keyframe_inliers, best->keyframes);
    else if (best->sigma_rotation_deg > o_.max_sigma_rotation_deg || best->sigma_log_scale > o_.max_sigma_log_scale)
      best->doubt = fmt::format("known to {:.2f} deg and {:.1f} % of the scale only", best->sigma_rotation_deg,
                                100 * best->sigma_log_scale);
    else if (!holds_where_not_used())
      best->doubt = "what half of the shared keyframes tell does not hold in the other half";
  }

  const Submap& a_;
  const Submap& b_;
  const Correspondences& common_;
  const AlignmentOptions& o_;
  std::vector<Pair> pairs_;
};

// Extends the result for a run to all correspondences: those outside the run count as not agreeing.
Alignment spread(Alignment part, const SharedRun& run, const Correspondences& common) {
  const auto in_run = [&](size_t shared) { return shared >= run.first && shared < run.first + run.count; };
  std::vector<char> keyframe_inlier, inlier;
  auto next_keyframe = part.keyframe_inlier.begin(), next_landmark = part.inlier.begin();
  for (size_t k = 0; k < common.keyframes.size(); ++k) keyframe_inlier.push_back(in_run(k) ? *next_keyframe++ : 0);
  for (const LandmarkMatch& match : common.landmarks)
    inlier.push_back(in_run(static_cast<size_t>(match.shared)) ? *next_landmark++ : 0);
  part.keyframe_inlier = std::move(keyframe_inlier);
  part.inlier = std::move(inlier);
  part.keyframes = static_cast<int>(common.keyframes.size());
  part.landmarks = static_cast<int>(common.landmarks.size());
  return part;
}

}  // namespace

Alignment align_submaps(const Submap& a, const Submap& b, const Correspondences& common,
                        const AlignmentOptions& options) {
  Alignment whole = Aligner(a, b, common, options).run();
  if (whole.doubt.empty()) return whole;
  const std::vector<SharedRun> runs = runs_beside_bent_end(a, b, common);
  if (runs.empty() ||
      !back_submap_holds(a, b, common, options.min_landmarks, options.min_inlier_ratio, options.max_reprojection_px))
    return whole;
  for (const SharedRun& run : runs) {
    Alignment part = Aligner(a, b, part_of(common, run), options).run();
    // A back submap that is wrong as a whole may agree with the front submap in a few places, so no keyframe of the run
    // may disagree.
    if (!part.doubt.empty() || (run.is_back_bent && part.keyframe_inliers < part.keyframes)) continue;
    return spread(std::move(part), run, common);
  }
  return whole;
}

}  // namespace rumi::map_server
