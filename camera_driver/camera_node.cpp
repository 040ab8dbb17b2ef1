// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/camera_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/or_throw.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "formats/times/timestamps.h"

namespace rumi::camera_driver {
namespace {

constexpr int kMaxPerTick = 8;                // images; few, so that a request to stop is heard while catching up
constexpr int64_t kProgressUs = 10'000'000;   // from one progress line to the next
constexpr int64_t kDegradedLateUs = 500'000;  // images later than this make the process DEGRADED

}  // namespace

CameraNode::CameraNode(Bus& bus, std::unique_ptr<ImageSource> source, const CameraOptions& options)
    : bus_(bus), source_(std::move(source)), options_(options) {
  if (source_->live()) return;
  ahead_ = source_->next();
  if (ahead_) first_utime_us_ = ahead_->utime;
}

CameraNode::CameraNode(Bus& bus, const std::string& input, const CameraOptions& options)
    : CameraNode(bus, or_throw(open_image_source(input, options)), options) {}

// Returns when the image ahead is to be published. Precondition: ahead_ and started_us_ are set.
int64_t CameraNode::due_us() const {
  const auto since_first_us = static_cast<double>(ahead_->utime - first_utime_us_);
  return *started_us_ + static_cast<int64_t>(since_first_us / options_.speed);
}

int64_t CameraNode::next_tick_us(int64_t now_us) const {
  if (source_->live()) return now_us;  // tick() waits for the camera
  const int64_t usual = Node::next_tick_us(now_us);
  return live_ && ahead_ && started_us_ ? std::min(usual, due_us()) : usual;
}

bool CameraNode::done() const { return source_->live() ? source_->live()->ended : !ahead_; }

std::vector<std::string> CameraNode::complaints() const {
  if (source_->live()) return {};
  if (done()) return source_->skipped().complaints(published_);
  if (!is_finished_ || options_.loop) return {};
  return {fmt::format("{} ended after {}{} images, as somebody asked it to: the others were not played",
                      source_->name(), published_,
                      source_->total() < 0 ? "" : fmt::format(" of {}", source_->total()))};
}

void CameraNode::start(int64_t now_us) {
  started_us_ = progress_us_ = now_us;
  if (source_->live()) return;
  log_info("{}: {} images of {} x {} pixels", source_->name(),
           source_->total() < 0 ? "any number of" : std::to_string(source_->total()), source_->camera().width,
           source_->camera().height);
}

void CameraNode::tick(int64_t now_us) {
  if (!live_ || done()) return;
  if (!started_us_) start(now_us);
  if (source_->live()) {
    ahead_ = source_->next();
    if (ahead_ && published_ == 0) first_utime_us_ = ahead_->utime;
    if (ahead_) publish(bus_.now_us());
    ahead_.reset();
    return report_progress(bus_.now_us());
  }
  for (int i = 0; i < kMaxPerTick && ahead_ && due_us() <= now_us; ++i) {
    publish(now_us);
    fetch();
    now_us = bus_.now_us();
  }
  late_us_ = ahead_ ? std::max<int64_t>(0, now_us - due_us()) : 0;
  report_progress(now_us);
}

void CameraNode::publish(int64_t now_us) {
  recorded_us_ = ahead_->utime;
  // The times rise strictly even if the clock is set back.
  if (options_.live_stamps) ahead_->utime = published_ == 0 ? now_us : std::max(now_us, last_utime_us_ + 1);
  set_metadata(&*ahead_, kPublishedKey, std::to_string(now_us));
  put_on_bus();
}

void CameraNode::put_on_bus() {
  last_utime_us_ = ahead_->utime;
  ++published_;
  if (!bus_.publish(channels::kCamera, *ahead_) && !publish_failed_) {
    publish_failed_ = true;
    log_error("an image could not be published ({} bytes)", ahead_->size);
  }
}

// Called when the times of a recording go back: its images then follow the earlier ones at the usual step.
void CameraNode::pace_anew() {
  const auto since_first_us = static_cast<double>(recorded_us_ - first_utime_us_);
  *started_us_ += static_cast<int64_t>((since_first_us + kUsualPeriodUs) / options_.speed);
  first_utime_us_ = ahead_->utime;
}

void CameraNode::fetch() {
  const StageClock clock("camera_driver.load");
  const auto begin = std::chrono::steady_clock::now();
  ahead_ = source_->next();
  if (ahead_ && started_us_ && ahead_->utime <= recorded_us_) pace_anew();
  load_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  ++loads_;
}

void CameraNode::report_progress(int64_t now_us) {
  const int64_t elapsed_us = now_us - progress_us_;
  if (elapsed_us < kProgressUs && !done()) return;
  const auto since_s = 1e-6 * static_cast<double>(elapsed_us + 1);
  const double rate_hz = static_cast<double>(published_ - progress_count_) / since_s;
  std::string text = detail();
  if (elapsed_us >= kProgressUs) text += fmt::format(", {:.1f} Hz", rate_hz);
  if (done())
    text += ": the end";
  else if (source_->total() >= published_ && rate_hz > 0)
    text += fmt::format(", about {:.0f} s left", static_cast<double>(source_->total() - published_) / rate_hz);
  log_info("{}", text);
  progress_us_ = now_us;
  progress_count_ = published_;
}

std::string CameraNode::detail() const {
  const std::string total = source_->total() < 0 ? "" : fmt::format(" of {}", source_->total());
  std::string text = fmt::format("{}{} images, {:.1f} s", published_, total,
                                 static_cast<double>(std::max<int64_t>(0, recorded_us_ - first_utime_us_)) * 1e-6);
  const LiveState* camera = source_->live();
  if (camera && camera->rate_hz > 0) text += fmt::format(" at {:.1f} Hz", camera->rate_hz);
  if (const std::string skipped = source_->skipped().to_string(); !skipped.empty()) text += "; left out: " + skipped;
  if (camera && !camera->problem.empty()) text += "; no images now: " + camera->problem;
  if (publish_failed_) text += "; some could not be published";
  if (late_us_ > kDegradedLateUs)
    text += fmt::format("; {:.1f} s behind the pace", static_cast<double>(late_us_) * 1e-6);
  return text;
}

NodeStatus CameraNode::status() {
  NodeStatus status;
  status.detail = detail();
  const bool no_images = source_->live() && !source_->live()->problem.empty();
  status.degraded = publish_failed_ || late_us_ > kDegradedLateUs || no_images;
  status.last_utime_us = last_utime_us_;
  status.processing_ms = loads_ > 0 ? load_ms_ / static_cast<double>(loads_) : 0;
  load_ms_ = 0;
  loads_ = 0;
  return status;
}

std::optional<int64_t> CameraNode::next_utime_us() {
  live_ = false;
  if (!ahead_) return std::nullopt;
  return ahead_->utime;
}

void CameraNode::publish_next() {
  live_ = false;
  if (!ahead_) return;
  recorded_us_ = ahead_->utime;
  put_on_bus();
  fetch();
}

}  // namespace rumi::camera_driver
