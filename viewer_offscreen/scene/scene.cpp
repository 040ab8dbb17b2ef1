// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "slam/geometry/alignment.h"
#include "viewer_offscreen/scene/covisibility.h"

namespace rumi::viewer_offscreen {
namespace {

using Eigen::Vector3d;

constexpr int64_t kTruthTolerance_us = 50'000;
constexpr double kLargest = 1e12;  // coordinates of this size or more are not drawn

constexpr int kMinShared = 40;  // common landmarks of two keyframes that are shown as covisible, at least

bool usable(const Vector3d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kLargest; }

void add_keyframes(const Submap& submap, SubmapView* view) {
  std::map<int, size_t> index_of;
  for (const auto& [id, keyframe] : submap.keyframes) {
    const SE3 map_from_cam = keyframe.cam_from_submap.inverse();
    if (!map_from_cam.is_finite() || !usable(map_from_cam.translation)) continue;
    index_of[id] = view->keyframe_poses.size();
    view->keyframe_poses.push_back({keyframe.utime_us, map_from_cam});
  }
  for (const auto& [a, b] : covisible_pairs(submap, kMinShared))
    if (index_of.contains(a) && index_of.contains(b)) view->covisible.emplace_back(index_of[a], index_of[b]);
}

// The colour follows from the number of older submaps of the same kind, so that a submap keeps its colour when others
// come.
void set_colors(std::vector<SubmapView>* submaps) {
  for (SubmapView& view : *submaps)
    view.color = static_cast<int>(std::count_if(submaps->begin(), submaps->end(), [&](const SubmapView& other) {
      return other.kind == view.kind &&
             std::pair(other.key.session, std::abs(other.key.id)) < std::pair(view.key.session, std::abs(view.key.id));
    }));
}

// Calls found(index in the list), in order of time, for each frame of the submap that is in the list.
template <class Found>
void each_frame(const SubmapView& submap, const std::vector<FrameNote>& frames, Found found) {
  size_t i = 0;
  for (const TrajectoryPoint& p : submap.trajectory) {
    while (i < frames.size() && frames[i].utime_us < p.utime_us) ++i;
    if (i < frames.size() && frames[i].utime_us == p.utime_us) found(i);
  }
}

// Returns the frames that have a pose, for a picture without a list of all frames.
std::vector<FrameNote> frames_with_pose(const std::vector<SubmapView>& submaps) {
  std::map<int64_t, FrameNote> frames;
  for (const SubmapView& submap : submaps)
    for (const TrajectoryPoint& p : submap.trajectory) frames[p.utime_us] = {p.utime_us, FrameNote::kUnknownState, {}};
  std::vector<FrameNote> all;
  all.reserve(frames.size());
  for (const auto& [utime_us, frame] : frames) all.push_back(frame);
  return all;
}

void add_timeline(const MapPicture& picture, Scene* scene) {
  const std::vector<FrameNote> frames = picture.frames.empty() ? frames_with_pose(scene->submaps) : picture.frames;
  if (frames.empty()) return;
  std::vector<int> tracked_in(frames.size(), -1), placed_in(frames.size(), -1);
  std::vector<bool> posed(frames.size());
  for (const SubmapKind kind : {SubmapKind::kFront, SubmapKind::kBack})  // a pose in a front submap counts before one
                                                                         // in a back submap
    for (size_t s = 0; s < scene->submaps.size(); ++s) {
      const SubmapView& submap = scene->submaps[s];
      if (submap.kind != kind) continue;
      each_frame(submap, frames, [&](size_t i) {
        posed[i] = true;
        if (submap.placed && placed_in[i] < 0) placed_in[i] = static_cast<int>(s);
      });
    }
  for (size_t s = 0; s < scene->submaps.size(); ++s) {
    const SubmapView& submap = scene->submaps[s];
    const int64_t newest_us = submap.trajectory.empty() ? 0 : submap.trajectory.back().utime_us;
    for (size_t i = 0; i < frames.size(); ++i) {
      if (frames[i].submap.id == kNoSubmap || frames[i].submap != submap.key) continue;
      tracked_in[i] = static_cast<int>(s);
      if (frames[i].utime_us <= newest_us) continue;
      posed[i] = true;  // the update with its pose has not come yet
      if (submap.placed && placed_in[i] < 0) placed_in[i] = static_cast<int>(s);
    }
  }
  scene->timeline = make_timeline(frames, tracked_in, placed_in);
  for (const int s : placed_in) {
    if (s < 0) continue;
    ++scene->frames_in_map;
    scene->timeline.filled += scene->submaps[static_cast<size_t>(s)].kind == SubmapKind::kBack;
  }
  scene->frames = static_cast<int64_t>(picture.frames.size());
  scene->first_us = frames.front().utime_us;
  scene->last_us = frames.back().utime_us;
  if (!picture.frames.empty()) scene->lost = find_lost(frames, posed);
}

void mark_losses(const std::vector<LostSpan>& spans, std::vector<TrajectoryPoint>& trajectory) {
  for (const LostSpan& span : spans) {
    const auto after = std::upper_bound(trajectory.begin(), trajectory.end(), span.last_us,
                                        [](int64_t t, const TrajectoryPoint& p) { return t < p.utime_us; });
    if (after != trajectory.end() && after != trajectory.begin()) after->after_loss = true;
  }
}

// Returns the positions, by either submap, at an image that both have. If there is none, returns the positions of the
// keyframes that are nearest to each other, because a link by appearance does not say which places it compared.
std::optional<MergeView> view_merge(const SubmapView& a, const SubmapView& b, bool same_images) {
  std::vector<MergeView> same;
  for (const KeyframeView& of_a : a.keyframe_poses) {
    if (!same_images) break;
    const auto of_b = std::find_if(b.keyframe_poses.begin(), b.keyframe_poses.end(),
                                   [&](const KeyframeView& view) { return view.utime_us == of_a.utime_us; });
    if (of_b != b.keyframe_poses.end())
      same.push_back({of_a.map_from_cam.translation, of_b->map_from_cam.translation, true});
  }
  if (!same.empty()) return same[same.size() / 2];
  std::optional<MergeView> nearest;
  double least = 0;
  for (const KeyframeView& of_a : a.keyframe_poses)
    for (const KeyframeView& of_b : b.keyframe_poses) {
      const Vector3d &at_a = of_a.map_from_cam.translation, &at_b = of_b.map_from_cam.translation;
      const double distance = (at_a - at_b).squaredNorm();
      if (nearest && distance >= least) continue;
      nearest = {at_a, at_b, same_images};
      least = distance;
    }
  return nearest;
}

void add_merges(const MapPicture& picture, Scene* scene) {
  const auto find = [&](SubmapKey key) -> const SubmapView* {
    for (const SubmapView& view : scene->submaps)
      if (view.key == key && view.placed) return &view;
    return nullptr;
  };
  for (const MapPicture::Link& link : picture.links) {
    scene->refused_links += !link.accepted;
    const SubmapView *a = find(link.a), *b = find(link.b);
    if (!link.accepted || link.a == link.b || !a || !b) continue;
    if (const auto merge = view_merge(*a, *b, link.same_images)) scene->merges.push_back(*merge);
  }
}

// Adds the true path to the scene, aligned to the map at the times of poses in the map.
void align_truth(const std::map<int64_t, Vector3d>& truth, Scene* scene) {
  std::vector<Vector3d> source, target;
  for (const SubmapView& submap : scene->submaps) {
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
  if (!map_from_truth) return;
  scene->metres_per_unit = 1 / map_from_truth->scale;
  for (const auto& [utime_us, position] : truth)
    if (const Vector3d p = *map_from_truth * position; usable(p)) scene->truth.push_back(p);
}

void set_camera_shape(const Camera& camera, Scene* scene) {
  if (!camera.check().empty()) return;
  scene->camera_aspect = double(camera.width) / camera.height;
  scene->camera_half_width = 0.5 * camera.width / camera.fx;
}

}  // namespace

SubmapView view_submap(const Submap& submap) {
  SubmapView view;
  view.key = submap.key;
  view.kind = submap.kind;
  view.frames = static_cast<int64_t>(submap.frames.size());
  view.keyframes = static_cast<int64_t>(submap.keyframes.size());
  view.landmark_count = static_cast<int64_t>(submap.landmarks.size());
  for (const auto& [utime_us, frame] : submap.frames) {
    if (!submap.keyframe(frame.reference_keyframe)) continue;
    const Vector3d p = submap.cam_from_submap(frame).center();
    if (usable(p)) view.trajectory.push_back({utime_us, p, false});
  }
  add_keyframes(submap, &view);
  view.landmarks.reserve(submap.landmarks.size());
  for (const auto& [id, landmark] : submap.landmarks)
    if (usable(landmark.position)) view.landmarks.push_back(landmark.position.cast<float>());
  return view;
}

Scene make_scene(const MapPicture& picture) {
  std::vector<SubmapView> submaps;
  for (const MapPicture::Item& item : picture.submaps) submaps.push_back(view_submap(*item.submap));
  return make_scene(picture, std::move(submaps));
}

Scene make_scene(const MapPicture& picture, std::vector<SubmapView> submaps) {
  Scene scene;
  scene.title = picture.title;
  const bool any_placed =
      std::any_of(picture.submaps.begin(), picture.submaps.end(), [](const auto& item) { return item.in_map; });
  const Submap* stand_in = nullptr;
  for (const MapPicture::Item& item : picture.submaps)
    if (!any_placed && (!stand_in || item.submap->frames.size() > stand_in->frames.size())) stand_in = item.submap;

  scene.submaps = std::move(submaps);
  for (size_t i = 0; i < scene.submaps.size(); ++i) {
    const MapPicture::Item& item = picture.submaps[i];
    scene.submaps[i].placed = item.in_map || item.submap == stand_in;
    set_camera_shape(item.submap->camera, &scene);
  }
  set_colors(&scene.submaps);
  add_timeline(picture, &scene);
  for (SubmapView& submap : scene.submaps) mark_losses(scene.lost, submap.trajectory);
  add_merges(picture, &scene);
  if (!picture.groundtruth.empty()) align_truth(picture.groundtruth, &scene);
  scene.camera_view = picture.camera_view;

  if (picture.camera && picture.camera->is_finite()) {
    scene.camera = picture.camera;
  } else {
    int64_t latest_us = -1;
    for (const SubmapView& submap : scene.submaps) {
      if (!submap.placed || submap.keyframe_poses.empty() || submap.keyframe_poses.back().utime_us <= latest_us)
        continue;
      latest_us = submap.keyframe_poses.back().utime_us;
      scene.camera = submap.keyframe_poses.back().map_from_cam;
    }
  }
  return scene;
}

}  // namespace rumi::viewer_offscreen
