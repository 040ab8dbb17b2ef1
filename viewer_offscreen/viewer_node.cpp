// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/viewer_node.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "base/running/due.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "base/this_process/process_name.h"
#include "bus/wire/jpeg_image.h"
#include "bus/wire/pose.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "viewer_offscreen/picture/draw_in_child.h"
#include "viewer_offscreen/picture/draw_map.h"
#include "viewer_offscreen/picture/layout.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr int64_t kFetchUs = 1'000'000;  // time that a due picture waits for updates, at most
constexpr int64_t kFinishTimeoutUs = 3'000'000;
constexpr int kImagesWhileDrawing = 16;  // images that wait, half a second at 30 Hz: a keyframe may be among them
constexpr double kVideoFps = 10;

}  // namespace

ViewerNode::ViewerNode(Bus& bus, const ViewerOptions& options)
    : bus_(bus),
      options_(options),
      name_(unique_process_name("viewer_offscreen")),
      copies_(bus, name_, [this] { changed_ = true; }) {
  if (options.series && options.output.empty())
    throw std::runtime_error("viewer_offscreen.series needs a folder to write into: viewer_offscreen.output is empty");
  if (options.series) series_.emplace(options.output, kVideoFps, options.series_goes_on);
  if (options.camera)
    bus.subscribe<image_t>(channels::kCamera, {.capacity = kImagesWhileDrawing, .drop = DropPolicy::kDropOldest},
                           [this](const image_t& image) { images_.add(image); });
  bus.subscribe<track_t>(channels::kTrack, {.capacity = 256, .drop = DropPolicy::kDropOldest},
                         [this](const track_t& track) { on_track(track); });
  bus.subscribe<map_status_t>(channels::kMapStatus, {.capacity = 4, .drop = DropPolicy::kDropOldest},
                              [this](const map_status_t& status) { on_map_status(status); });
}

void ViewerNode::on_track(const track_t& track) {
  if (!sessions_.take(track.session, bus_.now_us())) return;
  frames_.take(track);
  images_.add(track);
  last_utime_us_ = std::max(last_utime_us_, track.utime);
  changed_ = true;
  if (track.state == track_t::TRACKING && from_wire(track.cam_from_submap))
    live_ = track;
  else
    live_.reset();
}

void ViewerNode::on_map_status(const map_status_t& status) {
  if (copies_.take(status) && phase_ == Phase::kFinishing) since_finish_.take(status);
}

// A placed submap is sent whole, so it is requested no more often than it is drawn.
void ViewerNode::request_missing(int64_t now_us) {
  const bool is_running = phase_ == Phase::kRunning;
  copies_.request_missing(now_us, is_running ? static_cast<int64_t>(options_.interval_s * 1e6) : 0);
}

void ViewerNode::tick(int64_t now_us) {
  copies_.tick(now_us);
  if (phase_ == Phase::kFinished) return;
  if (phase_ == Phase::kFinishing) {
    request_missing(now_us);
    if ((since_finish_.complete() && copies_.complete()) || now_us - finish_us_ >= kFinishTimeoutUs) {
      draw();
      if (series_) series_->finish();
      phase_ = Phase::kFinished;
    }
    return;
  }
  if (last_draw_us_ == 0) last_draw_us_ = now_us;
  const int64_t interval_us = std::llround(options_.interval_s * 1e6);
  if (!changed_ || !is_due(now_us, last_draw_us_, interval_us)) return;
  // However often a submap changes between two pictures, it is requested only once for each picture.
  request_missing(now_us);
  if (!copies_.complete() && !is_due(now_us, last_draw_us_, interval_us + kFetchUs)) return;
  draw();
  last_draw_us_ = now_us;
}

void ViewerNode::finish() {
  if (phase_ != Phase::kRunning) return;
  phase_ = Phase::kFinishing;
  finish_us_ = bus_.now_us();
  map_request_t request{};
  request.utime = finish_us_;
  request.requester = name_;
  request.what = map_request_t::STATUS;
  bus_.publish(channels::kMapRequest, request);
}

MapPicture ViewerNode::picture() const {
  MapPicture picture = copies_.picture();
  if (live_) picture.camera = copies_.map_from_cam(*live_);
  picture.frames = frames_.by_time();
  const int64_t first_us = picture.frames.empty() ? last_utime_us_ : picture.frames.front().utime_us;
  picture.camera_view = images_.view(first_us, [&](SubmapKey key) {
    const auto copy = copies_.by_key().find(key);
    return copy == copies_.by_key().end() ? nullptr : &copy->second.submap;
  });
  return picture;
}

// To set OpenGL up takes as long as to draw four pictures. Whoever draws often keeps it.
Result<cv::Mat> ViewerNode::draw_picture() {
  constexpr double kOften_s = 15;
  if (!series_ && options_.interval_s >= kOften_s)
    return draw_in_child({kPictureWidth, kPictureHeight}, [this] { return draw_map(picture()); });
  if (!renderer_) renderer_.emplace();
  return renderer_->draw(make_scene(picture()));
}

void ViewerNode::draw() {
  const StageClock clock("viewer_offscreen.draw");
  const auto start = std::chrono::steady_clock::now();
  changed_ = false;
  try {
    const Result<cv::Mat> image = draw_picture();
    if (image) {
      ++pictures_;
      bus_.publish(channels::kViewerImage, make_jpeg_image(last_utime_us_, *image));
    }
    report((image ? write(*image) : Result<>(image.error())).error_text());
  } catch (const std::exception& e) {  // no OpenGL, or no memory: the process must go on
    report(e.what());
  }
  malloc_trim(0);  // the picture, and the scene that it was made from, leave many free pieces of memory
  draw_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Result<> ViewerNode::write(const cv::Mat& image) {
  if (options_.output.empty()) return {};
  Result<> written = write_png(image, (std::filesystem::path(options_.output) / "trajectory.png").string());
  return series_ && written ? series_->add(image) : written;
}

// Logs a problem when it begins and when it is over, not at every picture.
void ViewerNode::report(const std::string& trouble) {
  if (trouble != trouble_) {
    if (trouble.empty())
      log_info("pictures can be written again");
    else
      log_error("{}", trouble);
  }
  trouble_ = trouble;
}

NodeStatus ViewerNode::status() {
  NodeStatus status;
  int current = 0;
  for (const auto& [key, copy] : copies_.by_key()) current += copy.up_to_date();
  status.detail = trouble_.empty() ? fmt::format("{} pictures, {} of {} submaps up to date", pictures_, current,
                                                 copies_.by_key().size())
                                   : trouble_;
  status.degraded = !trouble_.empty();
  status.last_utime_us = last_utime_us_;
  status.processing_ms = draw_ms_;
  draw_ms_ = 0;
  return status;
}

}  // namespace rumi::viewer_offscreen
