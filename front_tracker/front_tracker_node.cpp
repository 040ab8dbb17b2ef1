// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/front_tracker_node.h"

#include <fmt/format.h>

#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <utility>

#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "base/this_process/cpu_clock.h"
#include "base/this_process/process_name.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "bus/wire/pose.h"
#include "bus/wire/working_image.h"
#include "lcmtypes/rumi/map_pose_t.hpp"
#include "slam/features/lens_mask.h"

namespace rumi::front_tracker {
namespace {

// Images waiting while one is worked on: two seconds at 30 Hz. Beginning a submap takes up to a second (its buffered
// frames get their poses then), and tracking, at a third of the camera's period, catches up afterwards.
constexpr QueueOptions kImageQueue{60, DropPolicy::kDropOldest};
// So many images in a row of another calibration or stream, or older than what was seen: the camera was changed, or a
// recording started again. With ours between them they are a second camera's, or a hiccup.
constexpr size_t kImagesOfNewSession = 10;

constexpr int64_t kSilenceUs = 10'000'000;  // without an image from the start, that somebody should know of

using Kind = RefusedImages::Kind;

// More than every hundredth.
bool dropped_many(const ChannelCounts& images) { return images.dropped * 100 > images.received; }

}  // namespace

FrontTrackerNode::FrontTrackerNode(Bus& bus, const FrontTrackerOptions& options, const std::optional<Camera>& camera)
    : bus_(bus),
      given_camera_(camera),
      options_(options),
      publisher_(bus, unique_process_name("front_tracker"), options.publish_interval_s),
      tracks_(bus),
      mask_publisher_(bus) {
  if (const int most = options.tracking.back_keyframes; most > 0) {
    const auto take = [this](Submap submap) { return tracker_ ? tracker_->add_back_submap(std::move(submap)) : ""; };
    const auto forget = [this](int id) {
      if (tracker_) tracker_->remove_back_submap(id);
    };
    back_submaps_.emplace(bus, unique_process_name("front_tracker"), most,
                          BackSubmapFetcher::Handlers{.take = take, .forget = forget});
  }
  cv::setNumThreads(1);  // more would take COLMAP's core, and make runs differ
  silent_since_us_ = bus.now_us();
  bus.subscribe_raw(channels::kCamera, kImageQueue, [this](std::span<const uint8_t> data) { return on_message(data); });
  bus.subscribe<map_status_t>(channels::kMapStatus, {4}, [this](const map_status_t& status) { on_map_status(status); });
}

void FrontTrackerNode::refuse(Kind kind, const std::string& problem) {
  problem_ = problem;
  refused_.add(kind, problem);
}

bool FrontTrackerNode::on_message(std::span<const uint8_t> data) {
  image_t image;
  if (!Bus::decode(data, &image)) {
    refuse(Kind::kNoImage, "it is no message of the type image_t, or broken");
    return false;
  }
  if (!plausible_utime(image.utime)) {
    refuse(Kind::kNoTime, fmt::format("its utime is {}{}: it must be microseconds since 1970", image.utime,
                                      image.utime < 0 ? "" : ", as nanoseconds would be"));
    return false;
  }
  on_image(image, bus_.now_us());
  return true;
}

std::optional<Camera> FrontTrackerNode::camera_of(const image_t& image, int64_t arrived_us) {
  if (given_camera_) return given_camera_;
  const std::string text(metadata(image, kCalibrationKey));
  if (tracker_ && (text.empty() || text == session_calibration_)) return image_camera_;
  if (text.empty()) {
    refuse(Kind::kCalibration,
           "it carries no calibration: give the camera's with --camera FILE (front_tracker, rumi up)");
    return std::nullopt;
  }
  const Result<Calibration> parsed = parse_calibration(text, "calibration of the image");
  if (!parsed) {
    refuse(Kind::kCalibration, parsed.error_text());
    return std::nullopt;
  }
  if (!tracker_) return parsed->camera;
  const Camera& other = parsed->camera;
  wait_as_foreign(
      image, arrived_us,
      fmt::format("it is calibrated as {} x {} px with fx {:.2f}, and the session's images as {} x {} "
                  "px with fx {:.2f}",
                  other.width, other.height, other.fx, image_camera_.width, image_camera_.height, image_camera_.fx));
  return std::nullopt;
}

void FrontTrackerNode::wait(Kind kind, const image_t& image, int64_t arrived_us, const std::string& problem) {
  if (waiting_kind_ != kind) give_up_waiting();
  waiting_kind_ = kind;
  problem_ = waiting_problem_ = problem;
  waiting_.push_back({image, arrived_us});
  refused_.count(kind);
}

void FrontTrackerNode::give_up_waiting() {
  if (!waiting_.empty()) refused_.tell(waiting_kind_, waiting_problem_);
  waiting_.clear();
}

void FrontTrackerNode::take_waiting() {
  refused_.take_back(waiting_kind_, static_cast<int64_t>(waiting_.size()));
  for (const Waiting& first : std::exchange(waiting_, {})) on_image(first.image, first.arrived_us);
}

void FrontTrackerNode::wait_as_foreign(const image_t& image, int64_t arrived_us, const std::string& problem) {
  times_.forget_row();
  wait(Kind::kOtherCamera, image, arrived_us,
       problem + ": if two cameras publish on this channel, give one of them another (--channel)");
  if (waiting_.size() < kImagesOfNewSession) return;
  end_session("the images are of another camera or recording");
  times_.begin_session();
  take_waiting();
}

void FrontTrackerNode::wait_for_times(const image_t& image, int64_t arrived_us) {
  const int64_t last_us = times_.last_us();
  const std::string no_time = times_.what_is_wrong() + ": utime must be microseconds since 1970";
  // One that begins a row has nothing to do with those that wait, and tells what is wrong with them.
  if (times_.row() == 1) {
    if (waiting_kind_ == Kind::kNoTime) waiting_problem_ = no_time;
    give_up_waiting();
  }
  if (times_.are_none() || times_.doubt() == ImageTimes::Doubt::kNoTime)
    wait(Kind::kNoTime, image, arrived_us, no_time);
  else if (times_.doubt() == ImageTimes::Doubt::kAhead)
    wait(Kind::kAhead, image, arrived_us,
         fmt::format("its utime {} is {:.3f} s after the last, and the next ones are not", image.utime,
                     1e-6 * static_cast<double>(image.utime - last_us)));
  else
    wait(Kind::kOlder, image, arrived_us, fmt::format("its utime {} is older than the last, {}", image.utime, last_us));
}

void FrontTrackerNode::end_session(const std::string& reason) {
  if (tracker_) log_warning("{}: a new session begins with the first of them", reason);
  retire_session();
}

// Those that wait are taken in here where it is sure what they are, with this one behind them.
bool FrontTrackerNode::has_usable_time(const image_t& image, int64_t arrived_us) {
  const int64_t last_us = times_.last_us();
  const bool is_checked = !metadata(image, kPublishedKey).empty();
  switch (times_.judge(image.utime, arrived_us, is_checked)) {
    case ImageTimes::Verdict::kNext:
      return true;
    case ImageTimes::Verdict::kDoubled:
      refuse(Kind::kDoubled, fmt::format("its utime {} is that of the image before", image.utime));
      return false;
    case ImageTimes::Verdict::kWaits:
      wait_for_times(image, arrived_us);
      return false;
    case ImageTimes::Verdict::kBegins:
      if (tracker_)
        end_session(fmt::format("the camera's time went back by {:.3f} s",
                                1e-6 * static_cast<double>(last_us - waiting_.front().image.utime)));
      break;
    case ImageTimes::Verdict::kGoesOn:
      break;
  }
  take_waiting();
  on_image(image, arrived_us);
  return false;
}

bool FrontTrackerNode::is_of_another_stream(const image_t& image) const {
  const int64_t stream = stream_of(image);
  return tracker_ && stream != kNoStream && stream != session_stream_;
}

void FrontTrackerNode::begin_session(const Camera& camera, const image_t& image) {
  image_camera_ = camera;
  session_calibration_ = metadata(image, kCalibrationKey);
  session_ = std::max(bus_.now_us(), session_ + 1);
  session_stream_ = stream_of(image) != kNoStream ? stream_of(image) : session_;
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

cv::Mat FrontTrackerNode::usable_image(const image_t& image, int64_t arrived_us) {
  const StageClock clock("front_tracker.decode");
  if (is_of_another_stream(image)) {
    wait_as_foreign(image, arrived_us,
                    fmt::format("it is of stream {}, and the session's images are of stream {}", stream_of(image),
                                session_stream_));
    return {};
  }
  if (!has_usable_time(image, arrived_us)) return {};
  const std::optional<Camera> camera = camera_of(image, arrived_us);
  if (!camera) return {};
  times_.forget_row();
  give_up_waiting();
  if (image.width != camera->width || image.height != camera->height) {
    refuse(Kind::kSize, fmt::format("it is {}x{} but the calibration is for {}x{}", image.width, image.height,
                                    camera->width, camera->height));
    return {};
  }
  Result<cv::Mat> grey = decode_working_image(image, *camera, working_camera(*camera, options_.max_image_side));
  if (!grey)
    refuse(Kind::kDamaged, grey.error_text());
  else if (!tracker_)
    begin_session(*camera, image);
  return grey.value_or(cv::Mat());
}

const ImageMask& FrontTrackerNode::mask_of(const image_t& image, const cv::Size& size) {
  const ImageMask& mask = masks_.read(image, size);
  if (!masks_.problem().empty() && !std::exchange(told_of_mask_, true))
    log_warning("{}: the image is used as if it had none (further images like it are not said)", masks_.problem());
  return mask;
}

std::optional<TrackResult> FrontTrackerNode::take(const image_t& image, const cv::Mat& grey) {
  const RepeatedImages::Kind kind = repeated_.take(image.utime, grey);
  if (kind == RepeatedImages::Kind::kNew || state_ != TrackingState::kTracking)
    return tracker_->process(image.utime, grey, mask_of(image, grey.size()));
  if (kind == RepeatedImages::Kind::kStill) return std::nullopt;
  return tracker_->predict(image.utime);
}

void FrontTrackerNode::on_image(const image_t& image, int64_t arrived_us) {
  if (finishing_) return;
  const cv::Mat grey = usable_image(image, arrived_us);
  if (grey.empty()) return;
  problem_.clear();
  times_.take(image.utime, arrived_us);
  const double before_s = thread_cpu_s();
  const auto result = take(image, grey);
  if (!result) return;
  const double cpu_ms = 1e3 * (thread_cpu_s() - before_s);
  cpu_ms_ += cpu_ms;
  ++cpu_count_;
  state_ = result->state;
  tracks_.publish_posed_afterwards(tracker_->posed_afterwards());
  tracks_.publish_withdrawn(tracker_->withdrawn());
  tracks_.publish(image, *result, cpu_ms);
  has_posed_ = has_posed_ || result->submap_id != kNoSubmap;
  publish_in_map(*result);
  mask_publisher_.publish(*tracker_, image.utime, bus_.now_us());
  publisher_.publish(*tracker_, bus_.now_us(), false);
}

void FrontTrackerNode::publish_in_map(const TrackResult& r) {
  const auto place = places_.find({session_, r.submap_id});
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

// A user who named another channel, or whose camera's program has ended, would wait for ever.
void FrontTrackerNode::tell_of_silence(int64_t now_us) {
  if (silent_since_us_ == 0) return;
  if (images().received > 0) silent_since_us_ = 0;
  if (silent_since_us_ == 0 || now_us - silent_since_us_ < kSilenceUs) return;
  silent_since_us_ = 0;
  log_warning("no image has come for {} s: is the camera's program running, on this channel (--channel)?",
              kSilenceUs / 1'000'000);
}

std::vector<std::string> FrontTrackerNode::complaints() const {
  const ChannelCounts counts = images();
  std::vector<std::string> sentences = refused_.complaints(counts.received);
  if (dropped_many(counts))
    sentences.push_back(fmt::format(
        "{} of {} images were dropped: they came faster than they could be tracked; smaller ones take less time "
        "(image.max_image_side)",
        counts.dropped, counts.received));
  if (repeated_.still() * 100 > counts.received)
    sentences.push_back(
        fmt::format("of {} images {}: the camera or the recorder stood still", counts.received, repeated_.text()));
  if (const int64_t used = counts.received - refused_.total(); used > 0 && !has_posed_)
    sentences.push_back(fmt::format(
        "none of {} images got a pose: a map begins where the camera moves sideways, past things with corners", used));
  return sentences;
}

void FrontTrackerNode::finish() {
  if (!finishing_) give_up_waiting();
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
  s.last_utime_us = std::max<int64_t>(times_.last_us(), 0);
  s.processing_ms = cpu_count_ ? cpu_ms_ / cpu_count_ : 0;
  cpu_ms_ = 0;
  cpu_count_ = 0;
  s.detail = fmt::format("{}, {} submaps", to_string(state_), tracker_ ? tracker_->submaps().size() : 0);
  if (tracker_ && tracker_->back_submaps().submaps() > 0)
    s.detail += fmt::format(", {} back submaps to relocalize in", tracker_->back_submaps().submaps());
  if (back_submaps_ && back_submaps_->refused() > 0)
    s.detail += fmt::format(", {} back submaps refused: {}", back_submaps_->refused(), back_submaps_->problem());
  s.detail += refused_.text();
  s.refused_images = std::max<int64_t>(0, refused_.total() - images().undecodable);
  s.degraded = refused_.take_news();
  if (repeated_.still() > 0) s.detail += ", " + repeated_.text();
  if (broken_mapping_.count() > 0) {
    s.detail += ", " + broken_mapping_.text();
    s.degraded |= broken_mapping_.take_news();
  }
  if (!publisher_.failure().empty()) {
    s.detail += ", map_server: " + publisher_.failure();
    s.degraded = true;
  }
  if (!problem_.empty()) {
    s.detail += ", last image: " + problem_;
    s.degraded = true;
  }
  return s;
}

}  // namespace rumi::front_tracker
