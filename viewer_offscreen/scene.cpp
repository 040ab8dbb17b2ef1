// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/scene.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "slam/geometry/alignment.h"

namespace rumi {
namespace {

using Eigen::Vector3d;

constexpr int64_t kTruthTolerance_us = 50'000;
constexpr double kLargest = 1e12;  // beyond it a number is no coordinate

bool usable(const Vector3d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kLargest; }

SubmapView view_submap(const Submap& submap, bool placed) {
  SubmapView view;
  view.id = submap.key.id;
  view.placed = placed;
  view.frames = static_cast<int64_t>(submap.frames.size());
  view.keyframes = static_cast<int64_t>(submap.keyframes.size());
  view.landmark_count = static_cast<int64_t>(submap.landmarks.size());
  for (const auto& [utime_us, frame] : submap.frames) {
    if (!submap.keyframe(frame.reference_keyframe)) continue;
    const Vector3d p = submap.cam_from_submap(frame).center();
    if (usable(p)) view.trajectory.push_back({utime_us, p, false});
  }
  for (const auto& [id, keyframe] : submap.keyframes) {
    const SE3 map_from_cam = keyframe.cam_from_submap.inverse();
    if (map_from_cam.is_finite() && usable(map_from_cam.translation)) view.keyframe_poses.push_back(map_from_cam);
  }
  for (const auto& [id, landmark] : submap.landmarks) {
    if (usable(landmark.position)) view.landmarks.push_back(landmark.position);
  }
  return view;
}

std::vector<LostSpan> find_lost(const std::vector<int64_t>& all, const std::set<int64_t>& posed) {
  std::vector<LostSpan> spans;
  bool lost = false;
  for (const int64_t utime_us : all) {
    const bool here = !posed.contains(utime_us);
    if (here && !lost) spans.push_back({utime_us, utime_us, 0});
    if (here) {
      spans.back().last_us = utime_us;
      ++spans.back().frames;
    }
    lost = here;
  }
  return spans;
}

void mark_losses(const std::vector<LostSpan>& spans, std::vector<TrajectoryPoint>& trajectory) {
  for (const LostSpan& span : spans) {
    const auto after = std::upper_bound(trajectory.begin(), trajectory.end(), span.last_us,
                                        [](int64_t t, const TrajectoryPoint& p) { return t < p.utime_us; });
    if (after != trajectory.end() && after != trajectory.begin()) after->after_loss = true;
  }
}

// The true path where the map has poses, in the map's gauge.
std::vector<Vector3d> align_truth(const std::map<int64_t, Vector3d>& truth, const std::vector<SubmapView>& submaps) {
  std::vector<Vector3d> source, target;
  for (const SubmapView& submap : submaps) {
    if (!submap.placed) continue;
    for (const TrajectoryPoint& p : submap.trajectory) {
      auto next = truth.lower_bound(p.utime_us);
      if (next != truth.begin() &&
          (next == truth.end() || next->first - p.utime_us > p.utime_us - std::prev(next)->first))
        --next;
      if (next == truth.end() || std::abs(next->first - p.utime_us) > kTruthTolerance_us) continue;
      source.push_back(next->second);
      target.push_back(p.position);
    }
  }
  const std::optional<Sim3> map_from_truth = umeyama(source, target);
  std::vector<Vector3d> path;
  if (!map_from_truth) return path;
  for (const auto& [utime_us, position] : truth)
    if (const Vector3d p = *map_from_truth * position; usable(p)) path.push_back(p);
  return path;
}

void set_camera_shape(const Camera& camera, Scene* scene) {
  if (!camera.check().empty()) return;
  scene->camera_aspect = double(camera.width) / camera.height;
  scene->camera_half_width = 0.5 * camera.width / camera.fx;
}

}  // namespace

Scene make_scene(const MapPicture& picture) {
  Scene scene;
  scene.title = picture.title;
  const bool any_placed =
      std::any_of(picture.submaps.begin(), picture.submaps.end(), [](const auto& item) { return item.in_map; });
  const Submap* stand_in = nullptr;
  for (const MapPicture::Item& item : picture.submaps)
    if (!any_placed && (!stand_in || item.submap->frames.size() > stand_in->frames.size())) stand_in = item.submap;

  std::set<int64_t> posed, in_map;
  for (const MapPicture::Item& item : picture.submaps) {
    scene.submaps.push_back(view_submap(*item.submap, item.in_map || item.submap == stand_in));
    set_camera_shape(item.submap->camera, &scene);
    for (const TrajectoryPoint& p : scene.submaps.back().trajectory) {
      posed.insert(p.utime_us);
      if (scene.submaps.back().placed) in_map.insert(p.utime_us);
    }
  }
  scene.frames = static_cast<int64_t>(picture.frame_utimes_us.size());
  scene.frames_in_map = static_cast<int64_t>(in_map.size());
  scene.lost = find_lost(picture.frame_utimes_us, posed);
  if (!picture.frame_utimes_us.empty())
    scene.first_us = picture.frame_utimes_us.front();
  else if (!posed.empty())
    scene.first_us = *posed.begin();
  for (SubmapView& submap : scene.submaps) mark_losses(scene.lost, submap.trajectory);
  if (!picture.groundtruth.empty()) scene.truth = align_truth(picture.groundtruth, scene.submaps);

  if (picture.camera && picture.camera->is_finite()) {
    scene.camera = picture.camera;
  } else {
    for (const SubmapView& submap : scene.submaps)
      if (submap.placed && !submap.keyframe_poses.empty()) scene.camera = submap.keyframe_poses.back();
  }
  return scene;
}

}  // namespace rumi
