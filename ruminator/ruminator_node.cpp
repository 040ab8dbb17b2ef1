// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/ruminator_node.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "bus/submap_update.h"

namespace rumi {
namespace {

constexpr int64_t kAnnouncePeriodUs = 1'000'000;
constexpr size_t kMaxPending = 256;  // states that wait for their images
constexpr int kMaxUnsettled = 128;   // images that wait for their states: front_tracker may be down
constexpr int64_t kBytesPerMb = 1'000'000;

std::vector<int64_t> utimes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  for (const Sample& sample : samples) list.push_back(sample.utime_us);
  return list;
}

int32_t keyframes(const std::vector<Sample>& samples) {
  return static_cast<int32_t>(
      std::count_if(samples.begin(), samples.end(), [](const Sample& s) { return s.is_keyframe; }));
}

}  // namespace

window_t to_message(const RuminationWindow& window, int64_t utime_us, int8_t state) {
  window_t message;
  message.utime = utime_us;
  message.session = window.session;
  message.window_id = window.id;
  message.state = state;
  message.reason = window.reason;
  message.submap_before = window.submap_before;
  message.submap_after = window.submap_after;
  message.lost_utime = window.lost_utime_us;
  message.resumed_utime = window.resumed_utime_us;
  message.approach_utime = utimes(window.approach);
  message.napproach = static_cast<int32_t>(message.approach_utime.size());
  message.gap_frames = window.gap_frames;
  message.gap_utime = utimes(window.gap);
  message.ngap = static_cast<int32_t>(message.gap_utime.size());
  message.departure_utime = utimes(window.departure);
  message.ndeparture = static_cast<int32_t>(message.departure_utime.size());
  message.shared_keyframes_before = keyframes(window.approach);
  message.shared_keyframes_after = keyframes(window.departure);
  message.progress = 0;
  message.remaining_s = -1;
  return message;
}

RuminatorNode::RuminatorNode(Bus& bus, const RuminatorOptions& options)
    : bus_(bus),
      options_(options),
      sampler_(options.window),
      ring_(options.ring_mb * kBytesPerMb, options.jpeg_quality) {
  cv::setNumThreads(1);  // the images are small; more would take front_tracker's core
  bus.subscribe<image_t>(channels::kCamera, {.capacity = 64, .drop = DropPolicy::kDropOldest},
                         [this](const image_t& image) { on_image(image); });
  bus.subscribe<track_t>(channels::kTrack, {.capacity = 256, .drop = DropPolicy::kDropOldest},
                         [this](const track_t& track) { on_track(track); });
}

void RuminatorNode::on_image(const image_t& image) {
  make_room(image);
  ring_.add(image);
  ring_.limit_unsettled(kMaxUnsettled);
  process_pending(bus_.now_us(), false);
}

void RuminatorNode::on_track(const track_t& track) {
  const bool has_bad_pose = track.submap_id != kNoSubmap && !from_wire(track.cam_from_submap);
  if (track.state < track_t::NOT_INITIALIZED || track.state > track_t::LOST || has_bad_pose) {
    ++rejected_;
    return;
  }
  pending_.push_back({track, bus_.now_us()});
  process_pending(bus_.now_us(), false);
}

// A frame's image and its state may come in either order, and either may be lost. States are followed in their order;
// one whose image is missing waits a while, unless it was there before: a pose given afterwards.
void RuminatorNode::process_pending(int64_t now_us, bool all) {
  const auto wait_us = static_cast<int64_t>(options_.match_wait_s * 1e6);
  while (!pending_.empty()) {
    const PendingTrack& next = pending_.front();
    const bool has_waited = now_us - next.arrived_us >= wait_us || now_us < next.arrived_us;
    const bool must_wait = !all && !has_waited && pending_.size() <= kMaxPending;
    if (must_wait && !ring_.find(next.track.utime) && !sampler_.is_late(event(next.track))) return;
    const track_t track = next.track;
    pending_.pop_front();
    process(track);
  }
}

FrameEvent RuminatorNode::event(const track_t& track) const {
  return {.utime_us = track.utime,
          .session = track.session,
          .submap_id = track.submap_id,
          .cam_from_submap = from_wire(track.cam_from_submap).value_or(SE3()),
          .is_keyframe = track.is_keyframe != 0,
          .has_image = ring_.find(track.utime) != nullptr};
}

void RuminatorNode::process(const track_t& track) {
  FrameEvent frame = event(track);
  if (!sampler_.is_late(frame)) {
    without_image_ += !frame.has_image;
    last_utime_us_ = track.utime;
  }
  if (!sampler_.open()) motion_.reset();
  if (frame.has_image && sampler_.wants_measure(frame)) frame.image = motion_.measure(*ring_.find(track.utime));
  const auto phase = [this] {
    return sampler_.open() ? std::pair(sampler_.open()->id, sampler_.open()->is_lost()) : std::pair(0, false);
  };
  const auto before = phase();
  std::optional<RuminationWindow> ended = sampler_.process(frame);
  if (ended) enqueue(std::move(*ended));
  if (sampler_.is_settled() && phase() != before) announce(*sampler_.open(), window_t::COLLECTING);
  settle(track.utime);
}

void RuminatorNode::settle(int64_t utime_us) {
  retained_ = sampler_.retained();
  ring_.settle(utime_us, [this](int64_t utime) { return is_needed(utime); });
}

bool RuminatorNode::is_needed(int64_t utime_us) const {
  return retained_.contains(utime_us) || queued_utimes_.contains(utime_us);
}

void RuminatorNode::note_queued_utimes() {
  queued_utimes_.clear();
  for (const RuminationWindow& window : queued_)
    for (const auto* part : {&window.approach, &window.gap, &window.departure})
      for (const Sample& sample : *part) queued_utimes_.insert(sample.utime_us);
}

// The newest loss matters most: what waited longest goes first, then the open window gets thinner.
void RuminatorNode::make_room(const image_t& image) {
  while (!ring_.fits(image)) {
    if (!queued_.empty())
      drop_oldest_window();
    else if (!sampler_.thin_gap())
      return;
    retained_ = sampler_.retained();
    ring_.sweep([this](int64_t utime) { return is_needed(utime); });
  }
}

void RuminatorNode::drop_oldest_window() {
  spdlog::warn("window {} is dropped before it was rebuilt: {} wait, {} MB of images", queued_.front().id,
               queued_.size(), ring_.bytes() / kBytesPerMb);
  queued_.front().reason = "dropped for want of memory before it was rebuilt";
  announce(queued_.front(), window_t::FAILED);
  queued_.pop_front();
  note_queued_utimes();
  ++dropped_windows_;
}

void RuminatorNode::enqueue(RuminationWindow window) {
  while (static_cast<int>(queued_.size()) >= options_.max_queued_windows) drop_oldest_window();
  spdlog::info("window {}: {} + {} of {} + {} frames, {} and {} keyframes of submaps {} and {}{}{}", window.id,
               window.approach.size(), window.gap.size(), window.gap_frames, window.departure.size(),
               keyframes(window.approach), keyframes(window.departure), window.submap_before, window.submap_after,
               window.reason.empty() ? "" : ": ", window.reason);
  announce(window, window_t::QUEUED);
  queued_.push_back(std::move(window));
  note_queued_utimes();
}

void RuminatorNode::announce(const RuminationWindow& window, int8_t state) {
  last_announced_us_ = bus_.now_us();
  window_t message = to_message(window, last_utime_us_, state);
  bus_.publish(channels::kWindow, message);
}

void RuminatorNode::tick(int64_t now_us) {
  process_pending(now_us, false);
  const bool is_due = now_us - last_announced_us_ >= kAnnouncePeriodUs || now_us < last_announced_us_;
  if (sampler_.is_settled() && is_due) announce(*sampler_.open(), window_t::COLLECTING);
}

void RuminatorNode::finish() {
  process_pending(bus_.now_us(), true);
  const bool was_lost = sampler_.open() && sampler_.open()->is_lost();
  if (auto ended = sampler_.finish(was_lost ? "the input ended while tracking was lost" : "the input ended"))
    enqueue(std::move(*ended));
  settle(last_utime_us_);
}

NodeStatus RuminatorNode::status() {
  NodeStatus status;
  const std::string open = sampler_.open() ? fmt::format("window {} collects", sampler_.open()->id) : "no window open";
  status.detail = fmt::format(
      "{}; {} queued, {} dropped; {} images in {:.1f} MB; {} images dropped, {} broken, {} states without image, {} "
      "rejected",
      open, queued_.size(), dropped_windows_, ring_.size(), static_cast<double>(ring_.bytes()) / kBytesPerMb,
      ring_.dropped(), ring_.broken(), without_image_, rejected_ + sampler_.ignored());
  status.degraded = ring_.dropped() > 0 || dropped_windows_ > 0;
  status.last_utime_us = last_utime_us_;
  return status;
}

}  // namespace rumi
