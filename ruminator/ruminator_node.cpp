// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/ruminator_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core/utility.hpp>
#include <utility>
#include <vector>

#include "base/running/due.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "bus/wire/pose.h"
#include "bus/wire/tracking_state.h"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {
namespace {

constexpr int64_t kAnnouncePeriodUs = 1'000'000;
constexpr int64_t kMatchWaitUs = 500'000;  // how long the tracking state of a frame waits for its image
constexpr size_t kMaxPending = 256;        // most states that wait for their images
constexpr int kMaxUnsettled = 128;         // most images that wait for their states: front_tracker may be down
constexpr int kJpegQuality = 95;           // JPEG quality of kept images that came uncompressed

ImageId image_of(const track_t& track) { return {track.utime, track.stream}; }

// Returns the calibration in the images' metadata; an Error if there is none, or more than one.
Result<Camera> camera_of(const std::vector<image_t>& images) {
  const std::string text(metadata(images.front(), kCalibrationKey));
  if (text.empty()) return Error{"its images carry no calibration: name the camera's with ruminator.camera_file"};
  const auto is_foreign = [&](const image_t& image) {
    const std::string_view own = metadata(image, kCalibrationKey);
    return !own.empty() && own != text;
  };
  if (std::any_of(images.begin(), images.end(), is_foreign))
    return Error{"its images are of more than one camera, by the calibrations that they carry"};
  const Result<Calibration> parsed = parse_calibration(text, "calibration of the image");
  if (!parsed) return parsed.error();
  return parsed->camera;
}

}  // namespace

RuminatorNode::RuminatorNode(Bus& bus, const RuminatorOptions& options, RuminatorHooks hooks,
                             const std::optional<Camera>& camera)
    : bus_(bus),
      options_(options),
      hooks_(std::move(hooks)),
      given_camera_(camera),
      sampler_(options.window),
      ring_(options.ring_mb * kBytesPerMb, kJpegQuality),
      queue_(bus, options, hooks_.builder, hooks_.on_built) {
  cv::setNumThreads(1);  // the images are small; more threads would take CPU time from front_tracker
  bus.subscribe<image_t>(channels::kCamera, {.capacity = 64, .drop = DropPolicy::kDropOldest},
                         [this](const image_t& image) { on_image(image); });
  bus.subscribe<track_t>(channels::kTrack, {.capacity = 256, .drop = DropPolicy::kDropOldest},
                         [this](const track_t& track) { on_track(track); });
  bus.subscribe<mask_t>(channels::kMask, {.capacity = 4, .drop = DropPolicy::kDropOldest},
                        [this](const mask_t& mask) { on_mask(mask); });
}

void RuminatorNode::on_image(const image_t& image) {
  const StageClock clock("ruminator.sample");
  make_room(image);
  ring_.add(image);
  ring_.limit_unsettled(kMaxUnsettled);
  process_pending(bus_.now_us(), false);
}

void RuminatorNode::on_track(const track_t& track) {
  const StageClock clock("ruminator.sample");
  const bool has_bad_pose = track.submap_id != kNoSubmap && !from_wire(track.cam_from_submap);
  if (!state_from_wire(track.state) || has_bad_pose) {
    ++rejected_;
    return;
  }
  if (!sessions_.take(track.session, bus_.now_us())) return;
  pending_.push_back({track, bus_.now_us()});
  process_pending(bus_.now_us(), false);
}

void RuminatorNode::on_mask(const mask_t& mask) { rejected_ += masks_.take(mask) ? 0 : 1; }

// Processes the states in their order. A frame's image and its state may arrive in either order, and either may be
// lost. So a state without its image waits a while, unless the frame was processed before: then it brings a late pose.
void RuminatorNode::process_pending(int64_t now_us, bool all) {
  while (!pending_.empty()) {
    const PendingTrack& next = pending_.front();
    const bool has_waited = is_due(now_us, next.arrived_us, kMatchWaitUs);
    const bool must_wait = !all && !has_waited && pending_.size() <= kMaxPending;
    if (must_wait && !ring_.find(image_of(next.track)) && !sampler_.is_late(event(next.track))) return;
    const track_t track = next.track;
    pending_.pop_front();
    process(track);
  }
}

FrameEvent RuminatorNode::event(const track_t& track) const {
  return {.utime_us = track.utime,
          .session = track.session,
          .stream = track.stream,
          .submap_id = track.submap_id,
          .cam_from_submap = from_wire(track.cam_from_submap).value_or(SE3()),
          .is_keyframe = track.is_keyframe != 0,
          .has_image = ring_.find(image_of(track)) != nullptr};
}

void RuminatorNode::process(const track_t& track) {
  FrameEvent frame = event(track);
  if (!sampler_.is_late(frame)) {
    without_image_ += !frame.has_image;
    last_utime_us_ = track.utime;
    queue_.set_frame_time(track.utime);
  }
  if (track.session != session_) {
    session_ = track.session;
    sampler_.continue_after(queue_.last_id(session_));
  }
  if (!sampler_.open()) motion_.reset();
  if (frame.has_image && sampler_.wants_measure(frame)) frame.image = motion_.measure(*ring_.find(image_of(track)));
  const auto phase = [this] { return std::pair(sampler_.open() ? sampler_.open()->id : 0, sampler_.phase()); };
  const auto before = phase();
  const std::optional<RuminationWindow> ended = sampler_.process(frame);
  if (ended) hand_on(*ended, images_of(*ended));
  if (sampler_.is_settled() && phase() != before) announce(*sampler_.open(), window_t::COLLECTING);
  stream_ = track.stream;
  settle(track.utime);
}

bool RuminatorNode::is_needed(const ImageId& image) const {
  return (image.stream == stream_ || image.stream == kNoStream) && retained_.contains(image.utime_us);
}

void RuminatorNode::settle(int64_t utime_us) {
  retained_ = sampler_.retained();
  ring_.settle({utime_us, stream_}, [this](const ImageId& image) { return is_needed(image); });
}

// Thins the gap of the open window before images that still wait for their states have to be dropped.
void RuminatorNode::make_room(const image_t& image) {
  while (!ring_.fits(image) && sampler_.thin_gap()) {
    retained_ = sampler_.retained();
    ring_.sweep([this](const ImageId& id) { return is_needed(id); });
  }
}

std::vector<image_t> RuminatorNode::images_of(const RuminationWindow& window) const {
  std::vector<image_t> images;
  for (const Sample& sample : window.samples())
    if (const image_t* image = ring_.find({sample.utime_us, window.stream})) images.push_back(*image);
  return images;
}

Result<WindowJob> RuminatorNode::make_job(const RuminationWindow& window, std::vector<image_t> images) const {
  WindowJob job;
  job.window = window;
  job.images = std::move(images);
  if (job.images.empty()) return Error{"no image of it was kept"};
  masks_.put_on(&job.images, window.stream);
  const Result<Camera> camera = given_camera_ ? Result<Camera>(*given_camera_) : camera_of(job.images);
  if (!camera) return camera.error();
  job.camera = *camera;
  if (const Result<> checked = check_window_job(job); !checked) return checked.error();
  return job;
}

void RuminatorNode::rebuild_again(std::vector<Sample> gap, std::vector<image_t> images) {
  RuminationWindow window;
  window.id = sampler_.take_id();
  window.session = session_;
  window.stream = stream_;
  window.lost_utime_us = gap.front().utime_us;
  window.resumed_utime_us = gap.back().utime_us;
  window.gap_frames = static_cast<int>(gap.size());
  window.gap = std::move(gap);
  window.by_place = true;
  hand_on(window, std::move(images));
}

void RuminatorNode::hand_on(const RuminationWindow& window, std::vector<image_t> images) {
  Result<WindowJob> job = make_job(window, std::move(images));
  if (!job) return queue_.refuse(window, job.error_text());
  if (hooks_.on_job) hooks_.on_job(*job);
  if (options_.rebuild) return queue_.add(std::move(*job));
  log_info("window {}: {}, not rebuilt: ruminator.rebuild is off", window.id, describe(window));
  announce(window, window_t::QUEUED);
}

void RuminatorNode::announce(const RuminationWindow& window, int8_t state) {
  last_announced_us_ = bus_.now_us();
  window_t message = to_message(window, last_utime_us_, state);
  bus_.publish(channels::kWindow, message);
}

void RuminatorNode::tick(int64_t now_us) {
  process_pending(now_us, false);
  if (sampler_.is_settled() && is_due(now_us, last_announced_us_, kAnnouncePeriodUs))
    announce(*sampler_.open(), window_t::COLLECTING);
  queue_.tick(now_us);
}

void RuminatorNode::end_window() {
  process_pending(bus_.now_us(), true);
  const bool was_lost = sampler_.phase() == WindowSampler::Phase::kGap;
  if (const auto ended = sampler_.finish(was_lost ? "the input ended while tracking was lost" : "the input ended"))
    hand_on(*ended, images_of(*ended));
  settle(last_utime_us_);
}

void RuminatorNode::finish() {
  end_window();
  queue_.finish();
}

// Ends the open window too, so that the next start can rebuild it.
void RuminatorNode::stop() {
  end_window();
  queue_.stop();
}

NodeStatus RuminatorNode::status() {
  NodeStatus status;
  const std::string open = sampler_.open() ? fmt::format("window {} collects", sampler_.open()->id) : "no window open";
  status.detail =
      fmt::format("{}; {}; {} images in {:.1f} MB; {} images dropped, {} broken, {} states without image, {} rejected",
                  open, queue_.detail(), ring_.size(), static_cast<double>(ring_.bytes()) / kBytesPerMb,
                  ring_.dropped(), ring_.broken(), without_image_, rejected_ + sampler_.ignored());
  const std::string problem = hooks_.builder_problem ? hooks_.builder_problem() : "";
  if (!problem.empty()) status.detail = fmt::format("{}; {}", problem, status.detail);
  status.degraded = ring_.dropped() > 0 || queue_.degraded() || !problem.empty();
  status.last_utime_us = last_utime_us_;
  return status;
}

}  // namespace rumi::ruminator
