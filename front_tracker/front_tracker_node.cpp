// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/front_tracker_node.h"

#include <fmt/format.h>

#include <deque>
#include <iterator>
#include <opencv2/core/utility.hpp>
#include <utility>

#include "base/memory/file_memory.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "base/this_process/cpu_clock.h"
#include "base/this_process/process_name.h"
#include "bus/wire/image_stream.h"
#include "bus/wire/pose.h"
#include "bus/wire/working_image.h"
#include "lcmtypes/rumi/map_pose_t.hpp"
#include "slam/features/lens_mask.h"

namespace rumi::front_tracker {
namespace {

// The images that may wait: two seconds at 30 Hz. Beginning a submap takes up to a second, because its buffered frames
// get their poses then. Tracking needs a third of the camera's period per image and catches up afterwards.
constexpr QueueOptions kImageQueue{60, DropPolicy::kDropOldest};
constexpr int64_t kLetGoPeriod_us = 10'000'000;  // of giving back the RAM of keyframes that are not in use
constexpr int64_t kSilenceUs = 10'000'000;       // time without any image after which the user is told

using Kind = RefusedImages::Kind;

// True if more than one image in a hundred was dropped.
bool dropped_many(const ChannelCounts& images) { return images.dropped * 100 > images.received; }

}  // namespace

FrontTrackerNode::FrontTrackerNode(Bus& bus, const FrontTrackerOptions& options, const std::optional<Camera>& camera)
    : bus_(bus),
      options_(options),
      gate_(camera),
      publisher_(bus, unique_process_name("front_tracker"), options.publish_interval_s),
      tracks_(bus),
      mask_publisher_(bus) {
  if (const int most = options.tracking.back_keyframes; most > 0) {
    const auto take = [this](Submap submap) -> Result<> {
      if (!tracker_) return {};
      return tracker_->add_back_submap(std::move(submap));
    };
    const auto forget = [this](int id) {
      if (tracker_) tracker_->remove_back_submap(id);
    };
    back_submaps_.emplace(bus, unique_process_name("front_tracker"), most,
                          BackSubmapFetcher::Handlers{.take = take, .forget = forget});
  }
  cv::setNumThreads(1);  // more would take the core that COLMAP uses, and runs would differ
  silent_since_us_ = bus.now_us();
  bus.subscribe_raw(channels::kCamera, kImageQueue, [this](std::span<const uint8_t> data) { return on_message(data); });
  bus.subscribe<map_status_t>(channels::kMapStatus, {4}, [this](const map_status_t& status) { on_map_status(status); });
}

bool FrontTrackerNode::on_message(std::span<const uint8_t> data) {
  ArrivedImage arrived;
  const image_t& image = arrived.image;
  if (!Bus::decode(data, &arrived.image)) {
    gate_.refuse(Kind::kNoImage, "it is no message of the type image_t, or broken");
    return false;
  }
  if (!plausible_utime(image.utime)) {
    gate_.refuse(Kind::kNoTime, fmt::format("its utime is {}{}: it must be microseconds since 1970", image.utime,
                                            image.utime < 0 ? "" : ", as nanoseconds would be"));
    return false;
  }
  arrived.arrived_us = bus_.now_us();
  on_image(std::move(arrived));
  return true;
}

void FrontTrackerNode::on_image(ArrivedImage arrived) {
  if (finishing_) return;
  std::deque<ArrivedImage> next;
  next.push_back(std::move(arrived));
  while (!next.empty()) {
    const ArrivedImage image = std::move(next.front());
    next.pop_front();
    SessionGate::Decision decision = gate_.judge(image);
    if (!decision.why_session_ends.empty()) {
      log_warning("{}: a new session begins with the first of them", decision.why_session_ends);
      retire_session();
    }
    next.insert(next.begin(), std::make_move_iterator(decision.next.begin()),
                std::make_move_iterator(decision.next.end()));
    if (decision.what == SessionGate::Decision::What::kTrack) track(image, *decision.camera);
  }
}

void FrontTrackerNode::track(const ArrivedImage& arrived, const Camera& camera) {
  const cv::Mat grey = decode(arrived.image, camera);
  if (grey.empty()) return;
  if (!tracker_) begin_session(camera, arrived.image);
  gate_.take(arrived);
  const double before_s = thread_cpu_s();
  const auto result = pose_of(arrived.image, grey);
  if (result) publish(arrived.image, *result, 1e3 * (thread_cpu_s() - before_s));
}

cv::Mat FrontTrackerNode::decode(const image_t& image, const Camera& camera) {
  const StageClock clock("front_tracker.decode");
  const Camera working = tracker_ ? tracker_->camera() : working_camera(camera, options_.max_image_side);
  Result<cv::Mat> grey = decode_working_image(image, camera, working);
  if (!grey) gate_.refuse(Kind::kDamaged, grey.error_text());
  return grey.value_or(cv::Mat());
}

void FrontTrackerNode::begin_session(const Camera& camera, const image_t& image) {
  session_ = std::max(bus_.now_us(), session_ + 1);
  const int64_t stream = stream_of(image);
  session_stream_ = stream != kNoStream ? stream : session_;
  gate_.begin_session(camera, image, session_stream_);
  tracks_.begin_session(session_, session_stream_);
  repeated_.begin_session();
  if (back_submaps_) back_submaps_->begin_session(session_);
  const Camera working = working_camera(camera, options_.max_image_side);
  masks_ = MaskReader(lens_mask(working));
  tracker_ = std::make_unique<Tracker>(working, options_, session_, session_stream_);
}

void FrontTrackerNode::retire_session() {
  if (!tracker_) return;
  tracker_->wait_for_mapping();
  note_broken_mapping();
  tracker_->end();
  publisher_.publish(*tracker_, bus_.now_us(), true);
  retired_.push_back(std::move(tracker_));
}

void FrontTrackerNode::note_broken_mapping() {
  if (!tracker_) return;
  const Worker::Broken broken = tracker_->take_broken_mapping();
  broken_mapping_.note(broken.reason, bus_.now_us(), broken.count);
}

const ImageMask& FrontTrackerNode::mask_of(const image_t& image, const cv::Size& size) {
  const ImageMask& mask = masks_.read(image, size);
  if (!masks_.problem().empty() && !std::exchange(told_of_mask_, true))
    log_warning("{}: the image is used as if it had none (further images like it are not said)", masks_.problem());
  return mask;
}

std::optional<TrackResult> FrontTrackerNode::pose_of(const image_t& image, const cv::Mat& grey) {
  const RepeatedImages::Kind kind = repeated_.take(image.utime, grey);
  if (kind == RepeatedImages::Kind::kNew || state_ != TrackingState::kTracking)
    return tracker_->process(image.utime, grey, mask_of(image, grey.size()));
  if (kind == RepeatedImages::Kind::kStill) return std::nullopt;
  return tracker_->predict(image.utime);
}

void FrontTrackerNode::publish(const image_t& image, const TrackResult& result, double cpu_ms) {
  cpu_ms_ += cpu_ms;
  ++cpu_count_;
  state_ = result.state;
  tracks_.publish_posed_afterwards(tracker_->posed_afterwards());
  tracks_.publish_withdrawn(tracker_->withdrawn());
  tracks_.publish(image, result, cpu_ms);
  has_posed_ = has_posed_ || result.submap_id != kNoSubmap;
  publish_in_map(result);
  mask_publisher_.publish(*tracker_, image.utime, bus_.now_us());
  publisher_.publish(*tracker_, bus_.now_us(), false);
}

void FrontTrackerNode::publish_in_map(const TrackResult& r) {
  auto place = places_.find({session_, r.submap_id});
  // Until map_server has placed a submap that goes on from another one, it lies where that one does.
  for (int id = r.submap_id; place == places_.end() && id != kNoSubmap;) {
    id = tracker_->continued_from(id);
    place = places_.find({session_, id});
  }
  if (place == places_.end()) return;
  const Sim3& map_from_submap = place->second.map_from_submap;
  const SE3 map_from_cam = map_from_submap.transform_camera(r.cam_from_submap).inverse();
  bus_.publish(channels::kCameraToMap, to_wire(r.utime_us, map_from_cam));
  map_pose_t pose;
  pose.utime = r.utime_us;
  pose.stream = session_stream_;
  pose.session = session_;
  pose.submap_id = r.submap_id;
  pose.placement_revision = place->second.revision;
  pose.map_revision = map_.map_revision();
  pose.map_from_cam = to_wire(map_from_cam);
  put_sigmas(scaled(r.sigmas, map_from_submap.scale), &pose);
  bus_.publish(channels::kMapPose, pose);
}

void FrontTrackerNode::on_map_status(const map_status_t& status) {
  if (!map_states_.take(status.utime, bus_.now_us())) return;
  map_.take(status);
  places_.clear();
  for (const auto& [key, summary] : map_.submaps()) {
    const auto map_from_submap = from_wire(summary.map_from_submap);
    if (summary.in_map && map_from_submap) places_[key] = {*map_from_submap, summary.placement_revision};
  }
  if (back_submaps_ && tracker_) back_submaps_->on_map(map_);
}

void FrontTrackerNode::tick(int64_t now_us) {
  tell_of_silence(now_us);
  note_broken_mapping();
  publisher_.tick(now_us);
  if (back_submaps_) back_submaps_->tick(now_us);
  if (is_due(now_us, let_go_us_, kLetGoPeriod_us)) {
    let_go_us_ = now_us;
    FileMemory::of_process().let_go();
  }
  std::erase_if(retired_, [&](const std::unique_ptr<Tracker>& tracker) {
    if (publisher_.complete(*tracker)) return true;
    publisher_.publish(*tracker, now_us, true);
    return false;
  });
}

ChannelCounts FrontTrackerNode::images() const {
  for (const ChannelCounts& counts : bus_.counts())
    if (counts.channel == channels::kCamera) return counts;
  return {};
}

// Without this message a user who named the wrong channel, or whose camera's program has ended, would wait for ever.
void FrontTrackerNode::tell_of_silence(int64_t now_us) {
  if (!silent_since_us_) return;
  if (images().received > 0) silent_since_us_.reset();
  if (!silent_since_us_ || !is_due(now_us, *silent_since_us_, kSilenceUs)) return;
  silent_since_us_.reset();
  log_warning("no image has come for {} s: is the camera's program running, on this channel (--channel)?",
              kSilenceUs / 1'000'000);
}

std::vector<std::string> FrontTrackerNode::complaints() const {
  const ChannelCounts counts = images();
  std::vector<std::string> sentences = refused().complaints(counts.received);
  if (dropped_many(counts))
    sentences.push_back(fmt::format(
        "{} of {} images were dropped: they came faster than they could be tracked; smaller ones take less time "
        "(image.max_image_side)",
        counts.dropped, counts.received));
  if (repeated_.still() * 100 > counts.received)
    sentences.push_back(
        fmt::format("of {} images {}: the camera or the recorder stood still", counts.received, repeated_.text()));
  if (const int64_t used = counts.received - refused().total(); used > 0 && !has_posed_)
    sentences.push_back(fmt::format(
        "none of {} images got a pose: a map begins where the camera moves sideways, past things with corners", used));
  return sentences;
}

void FrontTrackerNode::finish() {
  if (!finishing_) gate_.give_up_waiting();
  finishing_ = true;
  retire_session();
}

std::string FrontTrackerNode::waits_for() const {
  if (retired_.empty()) return {};
  const std::string& failure = publisher_.failure();
  return fmt::format("map_server has not taken the last of the submaps{}{}", failure.empty() ? "" : ": ", failure);
}

NodeStatus FrontTrackerNode::status() {
  NodeStatus s;
  s.last_utime_us = std::max<int64_t>(gate_.last_us(), 0);
  s.processing_ms = cpu_count_ ? cpu_ms_ / cpu_count_ : 0;
  cpu_ms_ = 0;
  cpu_count_ = 0;
  s.detail = fmt::format("{}, {} submaps", to_string(state_), tracker_ ? tracker_->submaps().size() : 0);
  if (tracker_ && tracker_->back_submaps().submaps() > 0)
    s.detail += fmt::format(", {} back submaps to relocalize in", tracker_->back_submaps().submaps());
  if (back_submaps_ && back_submaps_->refused() > 0)
    s.detail += fmt::format(", {} back submaps refused: {}", back_submaps_->refused(), back_submaps_->problem());
  s.detail += refused().text();
  s.refused_images = std::max<int64_t>(0, refused().total() - images().undecodable);
  s.degraded = gate_.take_news_of_refused();
  if (repeated_.still() > 0) s.detail += ", " + repeated_.text();
  if (broken_mapping_.count() > 0) {
    s.detail += ", " + broken_mapping_.text();
    s.degraded |= broken_mapping_.take_news();
  }
  if (!publisher_.failure().empty()) {
    s.detail += ", map_server: " + publisher_.failure();
    s.degraded = true;
  }
  if (!gate_.problem().empty()) {
    s.detail += ", last image: " + gate_.problem();
    s.degraded = true;
  }
  return s;
}

}  // namespace rumi::front_tracker
