// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window_sampler.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

namespace rumi {

WindowSampler::WindowSampler(const WindowOptions& options)
    : options_(options), approach_(options.stride), departure_(options.stride) {}

std::optional<RuminationWindow> WindowSampler::process(const FrameEvent& frame) {
  if (!has_begun_ || frame.session != session_) {
    std::optional<RuminationWindow> ended = finish("front_tracker was started again");
    start_session(frame.session);
    process(frame);  // the first frame of a session opens a window or not, but ends none
    return ended;
  }
  if (frame.utime_us <= last_utime_us_) {
    ++ignored_;
    return std::nullopt;
  }
  last_utime_us_ = frame.utime_us;
  return frame.submap_id == kNoSubmap ? on_untracked(frame) : on_tracked(frame);
}

void WindowSampler::start_session(int64_t session) {
  session_ = session;
  has_begun_ = true;
  last_utime_us_ = std::numeric_limits<int64_t>::min();
  submap_ = kNoSubmap;
  known_submaps_.clear();
  approach_.clear();
  last_tracked_.reset();
}

std::optional<RuminationWindow> WindowSampler::on_tracked(const FrameEvent& frame) {
  std::optional<RuminationWindow> ended;
  if (open_ && !open_->is_lost() && frame.submap_id != open_->submap_after)
    ended = close(fmt::format("tracking went over to submap {}", frame.submap_id));
  if (frame.submap_id != submap_) approach_.clear();
  submap_ = frame.submap_id;
  const Sample sample{frame.utime_us, frame.is_keyframe, frame.submap_id, frame.cam_from_submap};
  approach_.add(sample, frame.has_image);
  approach_.keep_newest(options_.window_length);
  if (frame.has_image) last_tracked_ = sample;

  if (open_) {
    if (open_->is_lost()) {
      open_->resumed_utime_us = frame.utime_us;
      open_->submap_after = frame.submap_id;
      resumed_in_known_ = known_submaps_.contains(frame.submap_id);
    }
    departure_.add(sample, frame.has_image);
    open_->departure.assign(departure_.samples().begin(), departure_.samples().end());
    if (frame.has_image) since_resume_.push_back(sample);
    keyframes_since_resume_ += frame.is_keyframe;
    if (is_complete()) ended = close("");
  }
  known_submaps_.insert(frame.submap_id);
  return ended;
}

bool WindowSampler::is_complete() const {
  const int samples = static_cast<int>(departure_.samples().size());
  return keyframes_since_resume_ >= options_.departure_min_keyframes || samples >= options_.departure_max_samples ||
         (resumed_in_known_ && samples >= options_.window_length);
}

std::optional<RuminationWindow> WindowSampler::on_untracked(const FrameEvent& frame) {
  std::optional<RuminationWindow> ended;
  if (open_ && !open_->is_lost()) {
    if (resumed_in_known_)
      ended = close("tracking was lost again");
    else
      extend_window();
  }
  if (!open_) begin_window(frame);
  submap_ = kNoSubmap;
  approach_.clear();
  last_tracked_.reset();
  if (frame.has_image) add_to_gap({.utime_us = frame.utime_us});
  return ended;
}

void WindowSampler::begin_window(const FrameEvent& frame) {
  open_.emplace();
  open_->id = ++last_id_;
  open_->session = session_;
  open_->submap_before = submap_;
  open_->lost_utime_us = frame.utime_us;
  gap_stride_ = 1;
  gap_phase_ = 0;
  if (submap_ == kNoSubmap) return;
  open_->approach.assign(approach_.samples().begin(), approach_.samples().end());
  // The last tracked frame is the nearest to the gap and ties it to the submap.
  if (last_tracked_ && (open_->approach.empty() || open_->approach.back().utime_us != last_tracked_->utime_us)) {
    open_->approach.push_back(*last_tracked_);
    if (static_cast<int>(open_->approach.size()) > options_.window_length)
      open_->approach.erase(open_->approach.begin());
  }
}

void WindowSampler::extend_window() {
  for (const Sample& sample : since_resume_) add_to_gap(sample);
  open_->submap_after = kNoSubmap;
  open_->resumed_utime_us = 0;
  since_resume_.clear();
  departure_.clear();
  open_->departure.clear();
  keyframes_since_resume_ = 0;
}

void WindowSampler::add_to_gap(const Sample& frame) {
  if (gap_phase_++ % gap_stride_ != 0) return;
  open_->gap.push_back(frame);
  if (static_cast<int>(open_->gap.size()) > options_.gap_max_frames) thin_gap();
}

bool WindowSampler::thin_gap() {
  if (!open_ || open_->gap.size() < 2) return false;
  std::vector<Sample> thinner;
  for (size_t i = 0; i < open_->gap.size(); i += 2) thinner.push_back(open_->gap[i]);
  // The next frame to be taken follows the last one kept at the new distance.
  const int since_taken = (gap_phase_ - 1) % gap_stride_;
  gap_phase_ = 1 + since_taken + (open_->gap.size() % 2 == 0 ? gap_stride_ : 0);
  gap_stride_ *= 2;
  open_->gap = std::move(thinner);
  return true;
}

std::optional<RuminationWindow> WindowSampler::close(const std::string& reason) {
  RuminationWindow window = std::move(*open_);
  open_.reset();
  window.reason = reason;
  departure_.clear();
  since_resume_.clear();
  keyframes_since_resume_ = 0;
  resumed_in_known_ = false;
  return window;
}

std::optional<RuminationWindow> WindowSampler::finish(const std::string& reason) {
  if (!open_) return std::nullopt;
  return close(reason);
}

std::set<int64_t> WindowSampler::retained() const {
  std::set<int64_t> utimes;
  const auto add = [&utimes](const auto& samples) {
    for (const Sample& sample : samples) utimes.insert(sample.utime_us);
  };
  add(approach_.samples());
  if (last_tracked_) utimes.insert(last_tracked_->utime_us);
  if (open_) {
    add(open_->approach);
    add(open_->gap);
    add(open_->departure);
    add(since_resume_);
  }
  return utimes;
}

}  // namespace rumi
