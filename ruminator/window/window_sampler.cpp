// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/window_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "slam/map/tracking_state.h"

namespace rumi::ruminator {
namespace {

// Frames that may yet get a pose, and some more: what is said of others is counted as late.
constexpr size_t kMaxUntracked = 1000;
static_assert(kMaxUntracked >= kMostRetoldFrames);
// Samples before a loss that front_tracker may yet withdraw: one in a stride, and some keyframes between.
constexpr int kMayBeWithdrawn = kMostRetoldFrames / 3;
// Samples after resuming that complete the window anyway, for a camera that stands still.
constexpr int kMaxDeparture = 40;

std::vector<Sample> list(const StrideSampler& sampler) { return {sampler.samples().begin(), sampler.samples().end()}; }

}  // namespace

WindowSampler::WindowSampler(const WindowOptions& options)
    : options_(options),
      approach_(options.stride),
      before_(options.stride),
      gap_(options.gap_max_frames),
      departure_(options.stride),
      since_resume_(options.gap_max_frames) {}

std::optional<RuminationWindow> WindowSampler::process(const FrameEvent& frame) {
  if (!has_begun_ || frame.session != session_) {
    std::optional<RuminationWindow> ended = finish("front_tracker was started again");
    start_session(frame);
    process(frame);  // the first frame of a session opens a window or not, but ends none
    return ended;
  }
  if (is_late(frame)) {
    ignored_ += !(frame.submap_id == kNoSubmap ? on_withdrawn(frame.utime_us) : on_late_pose(frame));
    return std::nullopt;
  }
  last_utime_us_ = frame.utime_us;
  std::optional<RuminationWindow> ended = frame.submap_id == kNoSubmap ? on_untracked(frame) : on_tracked(frame);
  if (open_) {
    open_->gap = gap_.samples();
    open_->departure = list(departure_);
  }
  return ended;
}

void WindowSampler::start_session(const FrameEvent& first) {
  session_ = first.session;
  stream_ = first.stream;
  has_begun_ = true;
  last_utime_us_ = std::numeric_limits<int64_t>::min();
  submap_ = kNoSubmap;
  known_submaps_.clear();
  approach_.clear();
  last_tracked_.reset();
}

GapFrame WindowSampler::measured(const FrameEvent& frame) {
  if (frame.has_image) path_px_ += frame.image.motion_px.value_or(kGapMotionPx);
  return {.sample = {frame.utime_us, frame.is_keyframe, frame.submap_id, frame.cam_from_submap},
          .path_px = path_px_,
          .sharpness = frame.image.sharpness};
}

std::optional<RuminationWindow> WindowSampler::on_tracked(const FrameEvent& frame) {
  std::optional<RuminationWindow> ended;
  if (open_ && !open_->is_lost() && frame.submap_id != open_->submap_after)
    ended = close(fmt::format("tracking went over to submap {}", frame.submap_id));
  if (frame.submap_id != submap_) {
    approach_.clear();
    tracked_since_us_ = frame.utime_us;
  }
  submap_ = frame.submap_id;
  if (open_ && open_->is_lost()) resume(frame);
  const GapFrame measured_frame = measured(frame);
  approach_.add(measured_frame.sample, frame.has_image);
  approach_.keep_newest(options_.window_length + kMayBeWithdrawn, options_.shared_keyframes + kMayBeWithdrawn);
  if (frame.has_image) last_tracked_ = measured_frame.sample;
  known_submaps_.insert(frame.submap_id);

  if (!open_) return ended;
  add_to_departure(measured_frame, frame.has_image);
  const bool connects = open_->submap_before != kNoSubmap && open_->submap_before != open_->submap_after;
  if (open_->gap_frames == 0 && !connects)
    forget_window();
  else if (is_complete())
    ended = close("");
  return ended;
}

void WindowSampler::resume(const FrameEvent& frame) {
  open_->submap_after = frame.submap_id;
  open_->resumed_utime_us = frame.utime_us;
  resumed_in_known_ = known_submaps_.contains(frame.submap_id);
  std::sort(late_poses_.begin(), late_poses_.end(),
            [](const LatePose& a, const LatePose& b) { return a.frame.sample.utime_us < b.frame.sample.utime_us; });
  for (const LatePose& late : late_poses_) {
    // Its submap has not been heard of again, or frames after it have no pose yet: it lies in the gap.
    const bool in_gap = !untracked_.empty() && late.frame.sample.utime_us < *untracked_.rbegin();
    if (in_gap || late.frame.sample.submap_id != frame.submap_id) {
      if (late.has_image) gap_.merge({late.frame});
      continue;
    }
    --open_->gap_frames;
    open_->resumed_utime_us = std::min(open_->resumed_utime_us, late.frame.sample.utime_us);
    approach_.add(late.frame.sample, late.has_image);
    add_to_departure(late.frame, late.has_image);
  }
  late_poses_.clear();
  tracked_since_us_ = open_->resumed_utime_us;
}

void WindowSampler::add_to_departure(const GapFrame& frame, bool has_image) {
  ++frames_since_resume_;
  departure_.add(frame.sample, has_image);
  if (has_image) since_resume_.add(frame);
}

bool WindowSampler::on_late_pose(const FrameEvent& frame) {
  if (!open_ || frame.submap_id == kNoSubmap || untracked_.erase(frame.utime_us) == 0) return false;
  const std::optional<GapFrame> sampled = gap_.take(frame.utime_us);
  GapFrame late = sampled.value_or(GapFrame{});
  late.sample = {frame.utime_us, frame.is_keyframe, frame.submap_id, frame.cam_from_submap};
  if (open_->is_lost()) {
    late_poses_.push_back({late, sampled.has_value()});
  } else {  // after the frame that it was to precede: too late to be a sample of the departure
    --open_->gap_frames;
    open_->resumed_utime_us = std::min(open_->resumed_utime_us, frame.utime_us);
  }
  open_->gap = gap_.samples();
  return true;
}

bool WindowSampler::on_withdrawn(int64_t utime_us) {
  if (submap_ != kNoSubmap && utime_us >= tracked_since_us_) {  // found again in the very image that was lost
    if (open_) {
      extend_window();
    } else {
      begin_window(utime_us);
      before_until_us_ = last_utime_us_ + 1;
    }
    leave_submap();
  }
  if (!open_ || utime_us < before_since_us_ || untracked_.contains(utime_us)) return false;
  std::optional<GapFrame> withdrawn = gap_.take(utime_us);
  if (!withdrawn && utime_us < before_until_us_) withdrawn = take_from_approach(utime_us);
  if (withdrawn) {
    withdrawn->sample = {.utime_us = utime_us};
    gap_.merge({*withdrawn});
  }
  untracked_.insert(utime_us);
  open_->gap = gap_.samples();
  return true;
}

// Nothing if the frame is no sample; it is part of the gap all the same.
std::optional<GapFrame> WindowSampler::take_from_approach(int64_t utime_us) {
  ++open_->gap_frames;
  open_->lost_utime_us = std::min(open_->lost_utime_us, utime_us);
  const auto newer = std::count_if(before_.samples().begin(), before_.samples().end(),
                                   [&](const Sample& s) { return s.utime_us >= utime_us; });
  if (!before_.take(utime_us)) return std::nullopt;
  list_approach();
  // Nobody has looked how its picture moved, nor how sharp it is: nothing speaks against it.
  return GapFrame{.sample = {},
                  .path_px = -kGapMotionPx * static_cast<double>(newer),
                  .sharpness = std::numeric_limits<double>::infinity()};
}

bool WindowSampler::has_enough() const {
  return departure_.keyframes() >= options_.departure_min_keyframes ||
         (resumed_in_known_ && static_cast<int>(departure_.samples().size()) >= options_.window_length);
}

bool WindowSampler::is_complete() const {
  const int samples = static_cast<int>(departure_.samples().size());
  const int keyframes = departure_.keyframes();
  return keyframes >= std::max(options_.departure_min_keyframes, options_.shared_keyframes) ||
         samples >= kMaxDeparture || (open_->submap_after == open_->submap_before && samples >= options_.window_length);
}

std::optional<RuminationWindow> WindowSampler::on_untracked(const FrameEvent& frame) {
  std::optional<RuminationWindow> ended;
  if (open_ && !open_->is_lost()) {
    if (has_enough())
      ended = close("");
    else
      extend_window();
  }
  if (!open_) begin_window(frame.utime_us);
  leave_submap();
  ++open_->gap_frames;
  untracked_.insert(frame.utime_us);
  if (untracked_.size() > kMaxUntracked) untracked_.erase(untracked_.begin());
  const GapFrame measured_frame = measured(frame);
  if (frame.has_image) gap_.add(measured_frame);
  return ended;
}

void WindowSampler::leave_submap() {
  submap_ = kNoSubmap;
  approach_.clear();
  last_tracked_.reset();
}

void WindowSampler::begin_window(int64_t utime_us) {
  open_.emplace();
  open_->id = last_id_ + 1;
  open_->session = session_;
  open_->stream = stream_;
  open_->submap_before = submap_;
  open_->lost_utime_us = before_since_us_ = before_until_us_ = utime_us;
  if (submap_ == kNoSubmap) return;
  // The last tracked frame is the nearest to the gap and ties it to the submap.
  if (last_tracked_) approach_.add_last(*last_tracked_);
  before_ = approach_;
  before_since_us_ = tracked_since_us_;
  list_approach();
}

void WindowSampler::list_approach() {
  StrideSampler newest = before_;
  newest.keep_newest(options_.window_length, options_.shared_keyframes);
  open_->approach = list(newest);
}

void WindowSampler::extend_window() {
  gap_.merge(since_resume_.frames());
  open_->gap_frames += frames_since_resume_;
  open_->submap_after = kNoSubmap;
  open_->resumed_utime_us = 0;
  since_resume_.clear();
  departure_.clear();
  frames_since_resume_ = 0;
}

bool WindowSampler::thin_gap() {
  if (!open_ || !(gap_.halve() || since_resume_.halve())) return false;
  open_->gap = gap_.samples();
  return true;
}

std::optional<RuminationWindow> WindowSampler::close(const std::string& reason) {
  for (const LatePose& late : late_poses_)  // of a submap that was never heard of again
    if (late.has_image) gap_.merge({late.frame});
  open_->gap = gap_.samples();
  open_->departure = list(departure_);
  RuminationWindow window = std::move(*open_);
  window.reason = reason;
  last_id_ = window.id;
  forget_window();
  return window;
}

void WindowSampler::forget_window() {
  open_.reset();
  before_.clear();
  gap_.clear();
  untracked_.clear();
  late_poses_.clear();
  departure_.clear();
  since_resume_.clear();
  frames_since_resume_ = 0;
  resumed_in_known_ = false;
  path_px_ = 0;
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
  if (!open_) return utimes;
  add(before_.samples());
  add(gap_.samples());
  add(departure_.samples());
  add(since_resume_.samples());
  for (const LatePose& late : late_poses_) utimes.insert(late.frame.sample.utime_us);
  return utimes;
}

}  // namespace rumi::ruminator
