// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/alignment/bent_end.h"

#include <algorithm>

namespace rumi::map_server {
namespace {

constexpr size_t kMinRun = 4;
constexpr size_t kMinRunShare = 3;  // a run has at least a third of the shared keyframes

struct Span {
  int64_t first_us = 0, last_us = 0;  // times of the first and last keyframe
  explicit Span(const Submap& submap) {
    first_us = last_us = submap.keyframes.begin()->second.utime_us;
    for (const auto& [id, keyframe] : submap.keyframes) {
      first_us = std::min(first_us, keyframe.utime_us);
      last_us = std::max(last_us, keyframe.utime_us);
    }
  }
};

bool observes(const Submap& submap, const Landmark& landmark, const Observation& o, double max_error_px) {
  const Keyframe& keyframe = *submap.keyframe(o.keyframe_id);
  const Eigen::Vector3d in_cam = keyframe.cam_from_submap * landmark.position;
  if (!(in_cam.z() > 1e-9)) return false;
  const double scale = submap.pyramid.scale(keyframe.features->keypoints[o.keypoint_index].octave);
  const Eigen::Vector2d seen = keyframe.features->undistorted[o.keypoint_index].cast<double>();
  return (submap.camera.project_undistorted(in_cam) - seen).norm() <= max_error_px * scale;
}

// True if enough landmarks are observed, with small errors, both before `utime_us` and from it on.
bool hangs_together_at(int64_t utime_us, const Submap& submap, int min_landmarks, double min_ratio,
                       double max_error_px) {
  int on_both_sides = 0, right_on_both = 0;
  for (const auto& [id, landmark] : submap.landmarks) {
    bool seen[2] = {false, false}, right[2] = {false, false};
    for (const Observation& o : landmark.observations) {
      const bool after = submap.keyframe(o.keyframe_id)->utime_us >= utime_us;
      seen[after] = true;
      right[after] = right[after] || observes(submap, landmark, o, max_error_px);
    }
    on_both_sides += seen[0] && seen[1];
    right_on_both += right[0] && right[1];
  }
  return right_on_both >= min_landmarks && right_on_both >= min_ratio * on_both_sides;
}

}  // namespace

std::vector<SharedRun> runs_beside_bent_end(const Submap& a, const Submap& b, const Correspondences& common) {
  std::vector<SharedRun> runs;
  if (a.kind == b.kind || common.keyframes.empty()) return runs;
  const Span front(a.kind == SubmapKind::kFront ? a : b), back(a.kind == SubmapKind::kFront ? b : a);
  const size_t all = common.keyframes.size(), least = std::max(kMinRun, (all + kMinRunShare - 1) / kMinRunShare);
  for (size_t count = all - 1; count >= least && count < all; --count) {
    runs.push_back({0, count, back.last_us <= front.last_us});
    runs.push_back({all - count, count, back.first_us >= front.first_us});
  }
  for (size_t count = all - 2; count >= least && count < all; --count)
    for (size_t first = 1; first + count < all; ++first) runs.push_back({first, count, true});
  return runs;
}

bool back_submap_holds(const Submap& a, const Submap& b, const Correspondences& common, int min_landmarks,
                       double min_ratio, double max_error_px) {
  const Submap& back = a.kind == SubmapKind::kBack ? a : b;
  return std::all_of(common.keyframes.begin() + 1, common.keyframes.end(), [&](const SharedKeyframe& shared) {
    return hangs_together_at(shared.utime_us, back, min_landmarks, min_ratio, max_error_px);
  });
}

Correspondences part_of(const Correspondences& common, const SharedRun& run) {
  Correspondences part{common.frames, {}, {}};
  const auto first = common.keyframes.begin() + static_cast<long>(run.first);
  part.keyframes.assign(first, first + static_cast<long>(run.count));
  for (LandmarkMatch match : common.landmarks) {
    match.shared -= static_cast<int>(run.first);
    if (match.shared >= 0 && match.shared < static_cast<int>(run.count)) part.landmarks.push_back(match);
  }
  return part;
}

}  // namespace rumi::map_server
