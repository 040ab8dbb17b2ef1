// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/landmark_colours.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

using map_server::Colour;
using map_server::LandmarkRef;

// A pixel at which a keyframe saw a landmark.
struct Sight {
  LandmarkRef landmark;
  Eigen::Vector2f pixel;
};

struct Look {
  const Submap* submap = nullptr;
  std::vector<Sight> sights;
};

using Looks = std::map<int64_t, std::map<SubmapKey, Look>>;  // by the time of the keyframe

// Returns the observation of the first keyframe that saw the landmark, and two from other places: an occlusion or a
// reflection is in one of them only.
std::vector<Observation> chosen(const std::vector<Observation>& observations) {
  if (observations.size() < 3) return observations;
  return {observations.front(), observations[observations.size() / 2], observations.back()};
}

Looks looks_at(const map_server::Atlas& atlas) {
  Looks looks;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (!owner.in_map) continue;
    for (const auto& [id, landmark] : owner.submap.landmarks) {
      if (!atlas.stands_for_itself(owner, id)) continue;
      for (const Observation& observation : chosen(landmark.observations)) {
        const Keyframe* keyframe = owner.submap.keyframe(observation.keyframe_id);
        if (!keyframe) continue;
        Look& look = looks[keyframe->utime_us][key];
        look.submap = &owner.submap;
        look.sights.push_back({{key, id}, keyframe->features->keypoints[observation.keypoint_index].pixel});
      }
    }
  }
  return looks;
}

// True if the image may be of the submap's stream. An image that names no stream belongs to the stream of its session
// (docs/wire.md).
bool may_show(const image_t& image, const Submap& submap) {
  return submap.stream == stream_of(image) || submap.stream == submap.key.session;
}

// Returns the colour at a pixel of the submap's working images, which may be smaller than `bgr`.
Colour colour_at(const cv::Mat& bgr, const Eigen::Vector2f& pixel, const Camera& camera) {
  const auto nearest = [](float at, int side, int full_side) {
    const double full = (at + 0.5) * full_side / side - 0.5;
    return std::clamp(static_cast<int>(std::lround(full)), 0, full_side - 1);
  };
  const auto& value =
      bgr.at<cv::Vec3b>(nearest(pixel.y(), camera.height, bgr.rows), nearest(pixel.x(), camera.width, bgr.cols));
  return {value[2], value[1], value[0]};
}

Colour median_colour(const std::vector<Colour>& colours) {
  const auto middle = [&](uint8_t Colour::*channel) {
    std::vector<uint8_t> values;
    values.reserve(colours.size());
    for (const Colour& colour : colours) values.push_back(colour.*channel);
    return median(&values);
  };
  return {middle(&Colour::red), middle(&Colour::green), middle(&Colour::blue)};
}

}  // namespace

SeenColours landmark_colours(const map_server::Atlas& atlas, camera_driver::ImageSource& recording) {
  SeenColours result;
  const Looks looks = looks_at(atlas);
  std::set<int64_t> utimes_us;
  for (const auto& [utime_us, by_submap] : looks) {
    utimes_us.insert(utime_us);
    result.keyframes += static_cast<int64_t>(by_submap.size());
  }
  std::map<LandmarkRef, std::vector<Colour>> seen;
  recording.play_again(utimes_us, camera_driver::ImageSource::Pixels::kColour);
  while (const std::optional<image_t> image = recording.next()) {
    const cv::Mat bgr = decode_bgr(*image).value_or(cv::Mat());
    if (bgr.empty()) continue;
    for (const auto& [key, look] : looks.at(image->utime)) {
      if (!may_show(*image, *look.submap)) continue;
      ++result.seen;
      for (const Sight& sight : look.sights)
        seen[sight.landmark].push_back(colour_at(bgr, sight.pixel, look.submap->camera));
    }
  }
  for (const auto& [landmark, colours] : seen) result.colours[landmark] = median_colour(colours);
  return result;
}

}  // namespace rumi::tool
