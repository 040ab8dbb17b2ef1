// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/window_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "slam/map/tracking_state.h"

namespace rumi::ruminator {
namespace {

// Only this many of the newest frames without a pose may still get one. Messages about older ones are ignored and
// counted.
constexpr size_t kMaxUntracked = 1000;
static_assert(kMaxUntracked >= kMostRetoldFrames);
// front_tracker may still withdraw the poses of this many samples before a loss: one per stride, and some keyframes.
constexpr int kMayBeWithdrawn = kMostRetoldFrames / 3;
// At this many samples after resuming the window is complete in any case, because a camera that stands still makes no
// keyframes.
constexpr int kMaxDeparture = 40;

std::vector<Sample> list(const StrideSampler& sampler) { return {sampler.samples().begin(), sampler.samples().end()}; }

Sample sample_of(const FrameEvent& frame) {
  return {frame.utime_us, frame.is_keyframe, frame.submap_id, frame.cam_from_submap};
}

}  // namespace

WindowSampler::WindowSampler(const WindowOptions& options) : options_(options), approach_(options.stride) {}

std::optional<RuminationWindow> WindowSampler::process(const FrameEvent& frame) {
  if (!has_begun_ || frame.session != session_) {
    std::optional<RuminationWindow> ended = finish("front_tracker was started again");
    start_session(frame);
    process(frame);  // the first frame of a session may open a window, but cannot end one
    return ended;
  }
  if (is_late(frame)) {
    ignored_ += !(frame.submap_id == kNoSubmap ? on_withdrawn(frame.utime_us) : on_late_pose(frame));
    return std::nullopt;
  }
  last_utime_us_ = frame.utime_us;
  std::optional<RuminationWindow> ended = frame.submap_id == kNoSubmap ? on_untracked(frame) : on_tracked(frame);
  if (open_) list_samples();
  return ended;
}

void WindowSampler::start_session(const FrameEvent& first) {
  session_ = first.session;
  stream_ = first.stream;
  has_begun_ = true;
  last_utime_us_ = std::numeric_limits<int64_t>::min();
  known_submaps_.clear();
  leave_submap();
}

GapFrame WindowSampler::measured(const FrameEvent& frame) {
  if (frame.has_image) open_->path_px += frame.image.motion_px.value_or(kGapMotionPx);
  return {.sample = sample_of(frame), .path_px = open_->path_px, .sharpness = frame.image.sharpness};
}

std::optional<RuminationWindow> WindowSampler::on_tracked(const FrameEvent& frame) {
  std::optional<RuminationWindow> ended;
  if (submap_ != kNoSubmap && !known_submaps_.contains(frame.submap_id)) go_on_in(frame.submap_id);
  if (departure() && frame.submap_id != open_->window.submap_after)
    ended = close(fmt::format("tracking went over to submap {}", frame.submap_id));
  if (frame.submap_id != submap_) {
    approach_.clear();
    tracked_since_us_ = frame.utime_us;
  }
  submap_ = frame.submap_id;
  if (lost()) resume(frame);
  note_tracked(frame);
  Departure* const now = departure();
  if (!now) return ended;
  now->add(measured(frame), frame.has_image);
  const RuminationWindow& window = open_->window;
  const bool connects = window.submap_before != kNoSubmap && window.submap_before != window.submap_after;
  if (window.gap_frames == 0 && !connects)
    open_.reset();
  else if (is_complete(*now))
    ended = close("");
  return ended;
}

void WindowSampler::note_tracked(const FrameEvent& frame) {
  approach_.add(sample_of(frame), frame.has_image);
  approach_.keep_newest(options_.window_length + kMayBeWithdrawn, options_.shared_keyframes + kMayBeWithdrawn);
  if (frame.has_image) last_tracked_ = sample_of(frame);
  known_submaps_.insert(frame.submap_id);
}

void WindowSampler::go_on_in(int32_t submap_id) {
  approach_.rename(submap_, submap_id);
  if (last_tracked_) last_tracked_->submap_id = submap_id;
  if (Departure* const now = departure()) {
    now->samples.rename(submap_, submap_id);
    now->all.rename(submap_, submap_id);
    open_->window.submap_after = submap_id;
  }
  submap_ = submap_id;
}

void WindowSampler::resume(const FrameEvent& frame) {
  RuminationWindow& window = open_->window;
  window.submap_after = frame.submap_id;
  window.resumed_utime_us = frame.utime_us;
  std::vector<LatePose> late_poses = std::move(lost()->late_poses);
  std::sort(late_poses.begin(), late_poses.end(),
            [](const LatePose& a, const LatePose& b) { return a.frame.sample.utime_us < b.frame.sample.utime_us; });
  Departure resumed{.samples = StrideSampler(options_.stride),
                    .all = GapThinner(options_.gap_max_frames),
                    .in_known_submap = known_submaps_.contains(frame.submap_id)};
  for (const LatePose& late : late_poses) {
    // The frame belongs to the gap if its submap is not the one that is tracked now, or if later frames have no pose.
    const bool in_gap = !open_->untracked.empty() && late.frame.sample.utime_us < *open_->untracked.rbegin();
    if (in_gap || late.frame.sample.submap_id != frame.submap_id) {
      if (late.has_image) open_->gap.merge({late.frame});
      continue;
    }
    --window.gap_frames;
    window.resumed_utime_us = std::min(window.resumed_utime_us, late.frame.sample.utime_us);
    approach_.add(late.frame.sample, late.has_image);
    resumed.add(late.frame, late.has_image);
  }
  tracked_since_us_ = window.resumed_utime_us;
  open_->part = std::move(resumed);
}

void WindowSampler::Departure::add(const GapFrame& frame, bool has_image) {
  ++frames;
  samples.add(frame.sample, has_image);
  if (has_image) all.add(frame);
}

bool WindowSampler::on_late_pose(const FrameEvent& frame) {
  if (!open_ || frame.submap_id == kNoSubmap || open_->untracked.erase(frame.utime_us) == 0) return false;
  RuminationWindow& window = open_->window;
  const std::optional<GapFrame> sampled = open_->gap.take(frame.utime_us);
  GapFrame late = sampled.value_or(GapFrame{});
  late.sample = sample_of(frame);
  if (Gap* const gap = lost()) {
    gap->late_poses.push_back({late, sampled.has_value()});
  } else {  // too late to be a sample: the departure has later frames already
    --window.gap_frames;
    window.resumed_utime_us = std::min(window.resumed_utime_us, frame.utime_us);
  }
  list_samples();
  return true;
}

bool WindowSampler::on_withdrawn(int64_t utime_us) {
  // Tests whether the withdrawn pose is of the submap tracked now: then the loss was in the very image in which
  // tracking resumed.
  if (submap_ != kNoSubmap && utime_us >= tracked_since_us_) {
    if (open_) {
      extend_window();
    } else {
      begin_window(utime_us);
      open_->before_until_us = last_utime_us_ + 1;
    }
    leave_submap();
  }
  if (!open_ || utime_us < open_->before_since_us || open_->untracked.contains(utime_us)) return false;
  std::optional<GapFrame> withdrawn = open_->gap.take(utime_us);
  if (!withdrawn && utime_us < open_->before_until_us) withdrawn = take_from_approach(utime_us);
  if (withdrawn) {
    withdrawn->sample = {.utime_us = utime_us};
    open_->gap.merge({*withdrawn});
  }
  open_->untracked.insert(utime_us);
  list_samples();
  return true;
}

// Returns nullopt if the frame is not a sample. It counts as a frame of the gap all the same.
std::optional<GapFrame> WindowSampler::take_from_approach(int64_t utime_us) {
  ++open_->window.gap_frames;
  open_->window.lost_utime_us = std::min(open_->window.lost_utime_us, utime_us);
  const auto& samples = open_->before.samples();
  const auto newer =
      std::count_if(samples.begin(), samples.end(), [&](const Sample& s) { return s.utime_us >= utime_us; });
  if (!open_->before.take(utime_us)) return std::nullopt;
  list_approach();
  // Its motion and sharpness were not measured, so it counts as sharp.
  return GapFrame{.sample = {},
                  .path_px = -kGapMotionPx * static_cast<double>(newer),
                  .sharpness = std::numeric_limits<double>::infinity()};
}

bool WindowSampler::has_enough(const Departure& departure) const {
  return departure.samples.keyframes() >= options_.departure_min_keyframes ||
         (departure.in_known_submap && static_cast<int>(departure.samples.samples().size()) >= options_.window_length);
}

bool WindowSampler::is_complete(const Departure& departure) const {
  const int samples = static_cast<int>(departure.samples.samples().size());
  const bool is_back = open_->window.submap_after == open_->window.submap_before;
  return departure.samples.keyframes() >= std::max(options_.departure_min_keyframes, options_.shared_keyframes) ||
         samples >= kMaxDeparture || (is_back && samples >= options_.window_length);
}

std::optional<RuminationWindow> WindowSampler::on_untracked(const FrameEvent& frame) {
  std::optional<RuminationWindow> ended;
  if (const Departure* const now = departure()) {
    if (has_enough(*now))
      ended = close("");
    else
      extend_window();
  }
  if (!open_) begin_window(frame.utime_us);
  leave_submap();
  ++open_->window.gap_frames;
  open_->untracked.insert(frame.utime_us);
  if (open_->untracked.size() > kMaxUntracked) open_->untracked.erase(open_->untracked.begin());
  const GapFrame measured_frame = measured(frame);
  if (frame.has_image) open_->gap.add(measured_frame);
  return ended;
}

void WindowSampler::leave_submap() {
  submap_ = kNoSubmap;
  approach_.clear();
  last_tracked_.reset();
}

void WindowSampler::begin_window(int64_t utime_us) {
  RuminationWindow window;
  window.id = last_id_ + 1;
  window.session = session_;
  window.stream = stream_;
  window.submap_before = submap_;
  window.lost_utime_us = utime_us;
  open_ = Collecting{.window = std::move(window),
                     .before = StrideSampler(options_.stride),
                     .before_since_us = utime_us,
                     .before_until_us = utime_us,
                     .gap = GapThinner(options_.gap_max_frames),
                     .untracked = {},
                     .part = Gap()};
  if (submap_ == kNoSubmap) return;
  // The last tracked frame is nearest to the gap and connects it with the submap.
  if (last_tracked_) approach_.add_last(*last_tracked_);
  open_->before = approach_;
  open_->before_since_us = tracked_since_us_;
  list_approach();
}

void WindowSampler::list_approach() {
  StrideSampler newest = open_->before;
  newest.keep_newest(options_.window_length, options_.shared_keyframes);
  open_->window.approach = list(newest);
}

void WindowSampler::list_samples() {
  open_->window.gap = open_->gap.samples();
  open_->window.departure = departure() ? list(departure()->samples) : std::vector<Sample>();
}

void WindowSampler::extend_window() {
  const auto& young = std::get<Departure>(open_->part);
  open_->gap.merge(young.all.frames());
  open_->window.gap_frames += young.frames;
  open_->window.submap_after = kNoSubmap;
  open_->window.resumed_utime_us = 0;
  open_->part = Gap();
}

bool WindowSampler::thin_gap() {
  if (!open_ || !(open_->gap.halve() || (departure() && departure()->all.halve()))) return false;
  list_samples();
  return true;
}

std::optional<RuminationWindow> WindowSampler::close(const std::string& reason) {
  if (const Gap* const gap = lost())
    for (const LatePose& late : gap->late_poses)  // poses in submaps that were not tracked again
      if (late.has_image) open_->gap.merge({late.frame});
  list_samples();
  RuminationWindow window = std::move(open_->window);
  window.reason = reason;
  last_id_ = window.id;
  open_.reset();
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
  if (!open_) return utimes;
  add(open_->before.samples());
  add(open_->gap.samples());
  if (const Gap* const gap = lost())
    for (const LatePose& late : gap->late_poses) utimes.insert(late.frame.sample.utime_us);
  if (const auto* const departure = std::get_if<Departure>(&open_->part)) {
    add(departure->samples.samples());
    add(departure->all.samples());
  }
  return utimes;
}

}  // namespace rumi::ruminator
