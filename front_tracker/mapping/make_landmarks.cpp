// SPDX-License-Identifier: BSD-3-Clause
// The part of Mapper that triangulates keypoints without a landmark, matched along epipolar lines between two
// keyframes.
#include <opencv2/core/hal/intrin.hpp>

#include "front_tracker/frame/certainty.h"
#include "front_tracker/mapping/mapper.h"
#include "front_tracker/patches/align_keypoints.h"
#include "slam/geometry/epipolar.h"
#include "slam/geometry/triangulation.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {
namespace {

// A place that has been seen on three visits is known. It gets no more landmarks beside those that it has; otherwise
// the submap would grow with every visit.
constexpr int kVisits = 3;
constexpr int64_t kBetweenVisits_us = 10'000'000;  // time between two visits, at least
constexpr float kBeside = 0.05F;                   // distance within which a keypoint lies beside another, as a share
                                                   // of the image's width

bool is_known(const Submap& map, const Landmark& landmark) {
  int visits = 0;
  int64_t last_us = INT64_MIN;
  for (const Observation& o : landmark.observations) {
    const int64_t utime_us = map.keyframe(o.keyframe_id)->utime_us;
    if (last_us <= utime_us - kBetweenVisits_us) ++visits;
    last_us = utime_us;
  }
  return visits >= kVisits;
}

// Returns for each of the keyframe's keypoints whether it lies beside one that observes a known landmark.
std::vector<char> beside_known(const FrontSubmap& submap, const Keyframe& kf) {
  const float radius = kBeside * static_cast<float>(submap.map.camera.width);
  const KeypointGrid& grid = submap.grids.at(kf.id);
  std::vector<char> beside(kf.landmark_ids.size(), 0);
  for (size_t i = 0; i < kf.landmark_ids.size(); ++i) {
    const Landmark* lm = kf.landmark_ids[i] == kNone ? nullptr : submap.map.landmark(kf.landmark_ids[i]);
    if (!lm || !is_known(submap.map, *lm)) continue;
    const Eigen::Vector2f& pixel = kf.features->undistorted[i];
    grid.for_each_near(pixel, radius, [&](int k) {
      if ((kf.features->undistorted[k] - pixel).norm() < radius) beside[k] = 1;
    });
  }
  return beside;
}

std::vector<int> free_keypoints(const Keyframe& kf) {
  std::vector<int> free;
  for (size_t i = 0; i < kf.landmark_ids.size(); ++i)
    if (kf.landmark_ids[i] == kNone) free.push_back(static_cast<int>(i));
  return free;
}

constexpr int kLanes = cv::v_float32x4::nlanes;

// The keypoints that may be matched, and their largest squared distance (px²) from the epipolar line. The vectors are
// padded to a whole number of lanes.
class Candidates {
 public:
  Candidates(const Keyframe& kf, const std::vector<double>& scales) : keypoints_(free_keypoints(kf)) {
    const size_t size = (keypoints_.size() + kLanes - 1) / kLanes * kLanes;
    x_.resize(size);
    y_.resize(size);
    max_off2_.resize(size, -1);
    for (size_t k = 0; k < keypoints_.size(); ++k) {
      const Eigen::Vector2f& pixel = kf.features->undistorted[keypoints_[k]];
      const float sigma = static_cast<float>(scales[kf.features->keypoints[keypoints_[k]].octave]);
      x_[k] = pixel.x();
      y_[k] = pixel.y();
      max_off2_[k] = 3.84F * sigma * sigma;
    }
  }

  // Calls visit(candidate) for each keypoint near the line, whose normal has unit length.
  template <class Visit>
  void for_each_near(const Eigen::Vector3f& line, Visit visit) const {
    const cv::v_float32x4 a = cv::v_setall_f32(line.x()), b = cv::v_setall_f32(line.y()),
                          c = cv::v_setall_f32(line.z());
    for (size_t k = 0; k < x_.size(); k += kLanes) {
      const cv::v_float32x4 off = a * cv::v_load(&x_[k]) + b * cv::v_load(&y_[k]) + c;
      const int near = cv::v_signmask(off * off <= cv::v_load(&max_off2_[k]));
      for (int lane = 0; near >> lane; ++lane)
        if (near >> lane & 1) visit(k + lane);
    }
  }
  int keypoint(size_t candidate) const { return keypoints_[candidate]; }
  void take(size_t candidate) { max_off2_[candidate] = -1; }

 private:
  std::vector<int> keypoints_;
  std::vector<float> x_, y_,
      max_off2_;  // undistorted pixels; max_off2_ is negative for a keypoint that is taken, and for padding
};

bool agrees(const Camera& camera, const Eigen::Vector3d& point_cam, const Eigen::Vector2f& pixel, double sigma) {
  return (camera.project_undistorted(point_cam) - pixel.cast<double>()).squaredNorm() < 5.991 * sigma * sigma;
}

}  // namespace

void Mapper::make_landmarks(FrontSubmap& submap, int keyframe_id) const {
  Submap& map = submap.map;
  Keyframe& kf = *map.keyframe(keyframe_id);
  const std::vector<char> known = beside_known(submap, kf);
  int used = 0;
  for (const auto& [id, shared] : map.covisible_keyframes(keyframe_id)) {
    if (used++ == options_.neighbours) break;
    if (log_baseline_variance(submap, keyframe_id, id) <= options_.max_log_baseline * options_.max_log_baseline)
      make_landmarks_between(submap, kf, *map.keyframe(id), known);
  }
}

// Returns the point that both keypoints observe, or nullopt if they cannot observe the same point.
std::optional<Eigen::Vector3d> Mapper::triangulate_between(const FrontSubmap& submap, const Keyframe& a, int keypoint_a,
                                                           const Keyframe& b, int keypoint_b) const {
  const std::vector<double>& scales = submap.octave_scales;
  const Eigen::Vector2f &pa = a.features->undistorted[keypoint_a], &pb = b.features->undistorted[keypoint_b];
  const auto point = triangulate(a.cam_from_submap, camera_.ray(pa), b.cam_from_submap, camera_.ray(pb));
  if (!point) return std::nullopt;
  const double sa = scales[a.features->keypoints[keypoint_a].octave],
               sb = scales[b.features->keypoints[keypoint_b].octave];
  const Eigen::Vector3d to_a = *point - a.cam_from_submap.center(), to_b = *point - b.cam_from_submap.center();
  // The standard deviation of the point's log distance is hypot(sa, sb) / (focal_px * sine).
  const double sine = to_a.normalized().cross(to_b.normalized()).norm(), focal_px = 0.5 * (camera_.fx + camera_.fy);
  if (std::hypot(sa, sb) > options_.max_log_distance * focal_px * sine) return std::nullopt;
  if (!agrees(camera_, a.cam_from_submap * *point, pa, sa) || !agrees(camera_, b.cam_from_submap * *point, pb, sb))
    return std::nullopt;
  // The ratio of the distances must fit the ratio of the octaves' scales.
  const double distance_ratio = to_b.norm() / to_a.norm(), octave_ratio = sa / sb, slack = 1.5 * scales[1];
  if (distance_ratio * slack < octave_ratio || distance_ratio > octave_ratio * slack) return std::nullopt;
  return point;
}

void Mapper::make_landmarks_between(FrontSubmap& submap, Keyframe& a, Keyframe& b,
                                    const std::vector<char>& known) const {
  const std::vector<double>& scales = submap.octave_scales;
  const Eigen::Matrix3f f = fundamental_matrix(camera_, b.cam_from_submap * a.cam_from_submap.inverse()).cast<float>();
  Candidates candidates(b, scales);
  const double scale_variance = log_scale_variance_between(submap, a.id, b.id);
  KeyframeAligner aligner(submap, a.id);
  for (int i : free_keypoints(a)) {
    if (known[i]) continue;
    const Eigen::Vector2f pa = a.features->undistorted[i];
    Eigen::Vector3f line = f * Eigen::Vector3f(pa.x(), pa.y(), 1);
    line /= line.head<2>().norm();
    size_t best = 0;
    int best_distance = options_.max_distance + 1;
    candidates.for_each_near(line, [&](size_t candidate) {
      const int distance =
          hamming_distance(a.features->descriptors[i], b.features->descriptors[candidates.keypoint(candidate)]);
      if (distance < best_distance) {
        best_distance = distance;
        best = candidate;
      }
    });
    if (best_distance > options_.max_distance) continue;
    const int keypoint = candidates.keypoint(best);
    auto point = triangulate_between(submap, a, i, b, keypoint);
    if (point && aligner.align(i, *point, {{b.id, keypoint}})) point = triangulate_between(submap, a, i, b, keypoint);
    if (!point) continue;
    Landmark& lm = submap.add_landmark(*point);
    submap.map.add_observation(lm.id, a.id, i);
    submap.map.add_observation(lm.id, b.id, keypoint);
    candidates.take(best);
    update_landmark_view(submap.map, &lm);
    submap.recent_landmarks.emplace_back(lm.id, a.id);
    lm.log_scale_variance = scale_variance;
  }
}

}  // namespace rumi::front_tracker
