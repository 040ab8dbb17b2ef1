// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/windows/window_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "lcmtypes/rumi/track_t.hpp"

namespace rumi::tool {
namespace {

constexpr int kMarginFrames = 15;  // frames that are drawn before and after the samples
constexpr int kImageWidth = 240;   // width of the kept images, px
constexpr size_t kMaxFrames = 4000;

struct Messages {
  std::map<std::pair<int32_t, int64_t>, window_t> windows;   // by id and session
  std::map<std::pair<int64_t, int64_t>, SceneFrame> frames;  // by session and utime
  int64_t begin_us = 0;
  std::string error;  // why the log could not be read to its end; empty if it could
};

void take(const track_t& track, Messages* messages) {
  const auto [it, is_new] = messages->frames.try_emplace({track.session, track.utime});
  SceneFrame& frame = it->second;
  frame.utime_us = track.utime;
  // A second track_t of the frame adds a pose afterwards, which leaves the state, or withdraws the pose, which changes
  // it.
  if (is_new || track.submap_id == 0) frame.state = track.state;
  frame.has_pose = track.submap_id != 0;
  frame.is_keyframe = track.is_keyframe;
}

Messages read_messages(const std::string& log_file) {
  Messages messages;
  LogReader reader(log_file);
  bool has_begun = false;
  while (const auto event = reader.next()) {
    if (event->channel == channels::kTrack) {
      if (track_t track; Bus::decode(event->data, &track)) take(track, &messages);
    } else if (event->channel == channels::kWindow) {
      if (window_t window; Bus::decode(event->data, &window))
        messages.windows[{window.window_id, window.session}] = window;
    } else if (event->channel == channels::kCamera && !has_begun) {
      image_t image;
      if (!Bus::decode(event->data, &image)) continue;
      has_begun = true;
      messages.begin_us = image.utime;
    }
  }
  messages.error = reader.error();
  return messages;
}

std::optional<window_t> choose(const Messages& messages, int window_id) {
  const window_t* chosen = nullptr;
  for (const auto& [key, window] : messages.windows) {
    if (window_id != 0) {
      if (window.window_id == window_id) chosen = &window;
      continue;
    }
    const bool is_typical = window.ngap > 0 && window.submap_before != 0 && window.submap_after != 0;
    if (is_typical) return window;
    if (!chosen) chosen = &window;
  }
  return chosen ? std::optional(*chosen) : std::nullopt;
}

void mark(const std::vector<int64_t>& utimes, SampledAs part, std::vector<SceneFrame>* frames) {
  for (SceneFrame& frame : *frames)
    if (std::find(utimes.begin(), utimes.end(), frame.utime_us) != utimes.end()) frame.sampled_as = part;
}

// Returns the window's frames, and some before and after.
std::vector<SceneFrame> frames_of(const window_t& window, const Messages& messages) {
  std::vector<SceneFrame> session;
  for (const auto& [key, frame] : messages.frames)
    if (key.first == window.session) session.push_back(frame);
  mark(window.approach_utime, SampledAs::kApproach, &session);
  mark(window.gap_utime, SampledAs::kGap, &session);
  mark(window.departure_utime, SampledAs::kDeparture, &session);
  const auto is_part = [&](const SceneFrame& f) {
    return f.sampled_as != SampledAs::kNot || f.utime_us == window.lost_utime || f.utime_us == window.resumed_utime;
  };
  const auto first = std::find_if(session.begin(), session.end(), is_part);
  const auto last = std::find_if(session.rbegin(), session.rend(), is_part).base();
  if (first == session.end()) return {};
  const auto begin = first - std::min<std::ptrdiff_t>(kMarginFrames, first - session.begin());
  const auto end = last + std::min<std::ptrdiff_t>(kMarginFrames, session.end() - last);
  return {begin, end};
}

cv::Mat thumbnail(const image_t& image) {
  const cv::Mat bgr = decode_bgr(image).value_or(cv::Mat());
  if (bgr.empty()) return {};
  cv::Mat small;
  cv::resize(bgr, small, {kImageWidth, std::max(1, kImageWidth * bgr.rows / bgr.cols)}, 0, 0, cv::INTER_AREA);
  return small;
}

void add_images(const std::string& log_file, std::vector<SceneFrame>* frames) {
  LogReader reader(log_file);
  while (const auto event = reader.next_on(channels::kCamera)) {
    image_t image;
    if (!Bus::decode(event->data, &image)) continue;
    const auto frame = std::lower_bound(frames->begin(), frames->end(), image.utime,
                                        [](const SceneFrame& f, int64_t utime_us) { return f.utime_us < utime_us; });
    if (frame == frames->end() || frame->utime_us != image.utime || !frame->image.empty()) continue;
    frame->image = thumbnail(image);
  }
}

}  // namespace

Result<WindowScene> read_window_scene(const std::string& log_file, int window_id) {
  const Messages messages = read_messages(log_file);
  // A log that is damaged is used up to the damage.
  if (messages.windows.empty() && !messages.error.empty()) return Error{messages.error};
  if (messages.windows.empty())
    return Error{fmt::format("no window is announced in it (channel {})", channels::kWindow), log_file};
  const std::optional<window_t> window = choose(messages, window_id);
  if (!window) {
    std::string known;
    for (const auto& [key, other] : messages.windows) known += fmt::format(" {}", other.window_id);
    return Error{fmt::format("no window {}", window_id), log_file, "there are" + known};
  }
  WindowScene scene{*window, messages.begin_us, frames_of(*window, messages)};
  if (scene.frames.empty() || scene.frames.size() > kMaxFrames)
    return Error{fmt::format("window {} spans {} frames", window->window_id, scene.frames.size()), log_file,
                 fmt::format("1 to {} can be drawn", kMaxFrames)};
  add_images(log_file, &scene.frames);
  return scene;
}

}  // namespace rumi::tool
