// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/camera_images.h"

#include <fmt/format.h>

#include <algorithm>

#include "bus/wire/image_codec.h"
#include "viewer_offscreen/picture/timeline_strip.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr size_t kMaxRecent = 12;  // 0.4 s at 30 Hz; front_tracker is not that late
constexpr size_t kMaxKeyframes = 10;
constexpr int64_t kOld_us = 3'000'000;

const char* state_words(int8_t state) {
  switch (state) {
    case track_t::TRACKING:
      return "tracked";
    case track_t::RECENTLY_LOST:
      return "recently lost";
    case track_t::LOST:
      return "lost";
    default:
      return "not initialized";
  }
}

CameraView view_image(const image_t& image, int64_t first_us) {
  CameraView view;
  view.image = decode_bgr(image).value_or(cv::Mat());  // front_tracker reports broken images; here they are left out
  view.utime_us = image.utime;
  view.caption = "at " + format_time(1e-6 * static_cast<double>(image.utime - first_us));
  return view;
}

void add_keypoints(const Submap& submap, const Keyframe& keyframe, CameraView* view) {
  view->size = {submap.camera.width, submap.camera.height};
  for (size_t i = 0; i < keyframe.features->size(); ++i) {
    const bool sees_landmark = i < keyframe.landmark_ids.size() && keyframe.landmark_ids[i] != kNone;
    const Eigen::Vector2f& pixel = keyframe.features->keypoints[i].pixel;
    (sees_landmark ? view->on_landmarks : view->others).emplace_back(pixel.x(), pixel.y());
  }
  view->caption += fmt::format(": {} of {} keypoints mapped", view->on_landmarks.size(), keyframe.features->size());
}

}  // namespace

void CameraImages::add(const image_t& image) {
  recent_.push_back(image);
  if (recent_.size() > kMaxRecent) recent_.pop_front();
}

void CameraImages::add(const track_t& track) {
  latest_ = track;
  if (!track.is_keyframe) return;
  const auto image =
      std::find_if(recent_.begin(), recent_.end(), [&](const image_t& i) { return i.utime == track.utime; });
  if (image == recent_.end()) return;
  keyframes_.push_back({{track.session, track.submap_id}, *image});
  if (keyframes_.size() > kMaxKeyframes) keyframes_.pop_front();
}

CameraView CameraImages::view(int64_t first_us, const std::function<const Submap*(SubmapKey)>& find) const {
  if (recent_.empty()) return {};
  const image_t& latest = recent_.back();
  for (auto it = keyframes_.rbegin(); it != keyframes_.rend(); ++it) {
    const Submap* submap = find(it->submap);
    if (!submap || latest.utime - it->image.utime > kOld_us) continue;
    for (const auto& [id, keyframe] : submap->keyframes) {
      if (keyframe.utime_us != it->image.utime || !keyframe.features) continue;
      CameraView view = view_image(it->image, first_us);
      add_keypoints(*submap, keyframe, &view);
      return view;
    }
  }
  CameraView view = view_image(latest, first_us);
  if (latest_.utime == latest.utime) view.caption += std::string(", ") + state_words(latest_.state);
  return view;
}

}  // namespace rumi::viewer_offscreen
