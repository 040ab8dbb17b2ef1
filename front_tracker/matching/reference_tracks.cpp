// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/reference_tracks.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/rotation_fit.h"

namespace rumi::front_tracker {
namespace {

constexpr int kMaxDistance = 60;   // Hamming distance of a match, at most
constexpr double kMaxRatio = 0.8;  // best / second-best distance, at most

Eigen::Vector2f turn(const Camera& camera, const Eigen::Matrix3d& rotation, const Eigen::Vector2f& pixel) {
  const Eigen::Vector3d ray = rotation * camera.ray(pixel);
  return ray.z() > 0.1 ? camera.project_undistorted(ray).cast<float>() : pixel;
}

}  // namespace

ReferenceTracks::ReferenceTracks(std::shared_ptr<const Features> reference)
    : reference_(std::move(reference)),
      expected_(reference_->undistorted.begin(), reference_->undistorted.end()),
      unseen_(reference_->size(), 0) {}

// Returns the keypoint near the expected place that looks most like that of the reference. Returns no match (index
// kNone) if none looks like it, or two do.
BestMatch ReferenceTracks::find(size_t keypoint, const Frame& frame, float radius_px) const {
  const Features& now = *frame.features;
  const int octave = reference_->keypoints[keypoint].octave;
  const Descriptor& descriptor = reference_->descriptors[keypoint];
  BestMatch best;
  frame.grid.for_each_near(expected_[keypoint], radius_px, [&](int i) {
    if (std::abs(now.keypoints[i].octave - octave) > 1) return;
    if ((now.undistorted[i] - expected_[keypoint]).squaredNorm() > radius_px * radius_px) return;
    best.offer(hamming_distance(descriptor, now.descriptors[i]), i);
  });
  const bool is_match = best.distance <= kMaxDistance && best.distance <= kMaxRatio * best.second_distance;
  return is_match ? best : BestMatch();
}

void ReferenceTracks::follow(const Camera& camera, const FrameMotion& motion, const Frame& frame) {
  const Features& now = *frame.features;
  const double farthest_px = kFarthestMotion * camera.width;
  std::vector<Match> claims(now.size(),
                            {kNone, kNone, 257});  // by keypoint of the frame: the best match that claims it
  for (size_t i = 0; i < expected_.size(); ++i) {
    expected_[i] = turn(camera, motion.b_from_a, expected_[i]);
    const double radius = std::min(farthest_px, motion.radius_px * (1 + unseen_[i]));
    const BestMatch match = find(i, frame, static_cast<float>(radius));
    ++unseen_[i];
    if (match.index != kNone && match.distance < claims[match.index].distance)
      claims[match.index] = {static_cast<int>(i), match.index, match.distance};
  }
  std::erase_if(claims, [](const Match& m) { return m.first == kNone; });
  keep_consistent_rotations(*reference_, now, &claims);
  std::vector<int>& found = found_.emplace_back(expected_.size(), kNone);
  for (const Match& m : claims) {
    found[m.first] = m.second;
    expected_[m.first] = now.undistorted[m.second];
    unseen_[m.first] = 0;
  }
  count_ = static_cast<int>(claims.size());
  measure_motion(camera, now);
}

void ReferenceTracks::measure_motion(const Camera& camera, const Features& now) {
  constexpr int kMost = 300;
  std::vector<Eigen::Vector3d> a, b;
  const int step = std::max(1, count_ / kMost);
  int seen = 0;
  for (size_t i = 0; i < expected_.size(); ++i) {
    const int at = found_.back()[i];
    if (at == kNone || seen++ % step != 0) continue;
    a.push_back(camera.ray(reference_->undistorted[i]));
    b.push_back(camera.ray(now.undistorted[at]));
  }
  const auto fit = fit_rotation(std::move(a), std::move(b));
  motion_px_ = fit ? 0.5 * (camera.fx + camera.fy) * fit->median_residual_rad : 0;
}

}  // namespace rumi::front_tracker
