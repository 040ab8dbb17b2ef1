// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/window_job.h"

#include <fmt/format.h>

#include <cstdio>
#include <set>

#include "base/files/whole_file.h"
#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/pose.h"
#include "bus/wire/why_undecodable.h"
#include "lcmtypes/rumi/window_job_t.hpp"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {
namespace {

window_job_t make_manifest(const WindowJob& job) {
  window_job_t manifest;
  std::set<int64_t> with_image;
  for (const image_t& image : job.images) with_image.insert(image.utime);
  for (const Sample& sample : job.window.samples()) {
    manifest.samples.push_back({sample.utime_us, sample.is_keyframe ? int8_t{1} : int8_t{0},
                                with_image.contains(sample.utime_us) ? int8_t{1} : int8_t{0}, sample.submap_id,
                                to_wire(sample.cam_from_submap)});
  }
  manifest.nsamples = static_cast<int32_t>(manifest.samples.size());
  manifest.utime = manifest.samples.empty() ? 0 : manifest.samples.back().utime;
  manifest.window = to_message(job.window, manifest.utime, window_t::QUEUED);
  manifest.calibration = camera_to_yaml(job.camera);
  return manifest;
}

// What is wrong with the numbers, or an empty string.
std::string check_header(const window_job_t& m) {
  const window_t& w = m.window;
  if (w.window_id < 1) return fmt::format("window_id {}: must be 1 or more", w.window_id);
  if (w.session < 0) return fmt::format("session {}: must not be negative", w.session);
  if (!plausible_utime(w.lost_utime)) return fmt::format("lost_utime {}: no time", w.lost_utime);
  if (!plausible_utime(w.resumed_utime)) return fmt::format("resumed_utime {}: no time", w.resumed_utime);
  if (w.gap_frames < 0) return fmt::format("gap_frames {}: must not be negative", w.gap_frames);
  const size_t listed = w.approach_utime.size() + w.gap_utime.size() + w.departure_utime.size();
  if (m.samples.size() != listed)
    return fmt::format("nsamples {}: approach, gap and departure list {} frames", m.samples.size(), listed);
  if (m.samples.empty()) return "nsamples 0: a window without frames";
  return "";
}

// Fills *samples from manifest.samples[first], ... which must be the frames `utimes`.
std::string read_part(const window_job_t& m, const std::vector<int64_t>& utimes, size_t first,
                      std::vector<Sample>* samples) {
  for (size_t i = 0; i < utimes.size(); ++i) {
    const size_t index = first + i;
    const window_sample_t& s = m.samples[index];
    const auto wrong = [&](const std::string& what) { return fmt::format("samples[{}].{}", index, what); };
    if (!plausible_utime(s.utime)) return wrong(fmt::format("utime {}: no time", s.utime));
    if (s.utime != utimes[i]) return wrong(fmt::format("utime {}: the window lists {} here", s.utime, utimes[i]));
    if (index > 0 && s.utime <= m.samples[index - 1].utime)
      return wrong(fmt::format("utime {}: not later than the one before it, {}", s.utime, m.samples[index - 1].utime));
    Sample& sample = samples->emplace_back();
    sample.utime_us = s.utime;
    sample.is_keyframe = s.is_keyframe != 0;
    sample.submap_id = s.submap_id;
    if (s.submap_id == kNoSubmap) continue;
    const std::optional<SE3> pose = from_wire(s.cam_from_submap);
    if (!pose) return wrong("cam_from_submap: no pose (not finite, or the quaternion is not of unit length)");
    sample.cam_from_submap = *pose;
  }
  return "";
}

std::string read_manifest(const window_job_t& m, WindowJob* job) {
  if (std::string error = check_header(m); !error.empty()) return error;
  const window_t& w = m.window;
  RuminationWindow& window = job->window;
  window.id = w.window_id;
  window.session = w.session;
  window.stream = w.stream;
  window.submap_before = w.submap_before;
  window.submap_after = w.submap_after;
  window.lost_utime_us = w.lost_utime;
  window.resumed_utime_us = w.resumed_utime;
  window.gap_frames = w.gap_frames;
  window.reason = w.reason;
  std::string error = read_part(m, w.approach_utime, 0, &window.approach);
  if (error.empty()) error = read_part(m, w.gap_utime, w.approach_utime.size(), &window.gap);
  if (error.empty())
    error = read_part(m, w.departure_utime, w.approach_utime.size() + w.gap_utime.size(), &window.departure);
  if (!error.empty()) return error;
  const Result<Calibration> calibration = parse_calibration(m.calibration, "calibration");
  if (calibration) job->camera = calibration->camera;
  return calibration.error_text();
}

// Takes the images one by one and finds what does not fit the manifest.
class ImageChecker {
 public:
  ImageChecker(const window_job_t& manifest, const Camera& camera) : camera_(camera) {
    for (const window_sample_t& sample : manifest.samples)
      if (sample.has_image) missing_.insert(sample.utime);
    expected_ = missing_.size();
  }

  std::string take(const image_t& image) {
    if (!missing_.erase(image.utime))
      return fmt::format("image {}: the manifest lists no image of this time, or it is here twice", image.utime);
    if (image.utime <= last_utime_)
      return fmt::format("image {}: not later than the one before it, {}", image.utime, last_utime_);
    last_utime_ = image.utime;
    if (image.width != camera_.width || image.height != camera_.height)
      return fmt::format("image {}: is {}x{}, the calibration is for {}x{}", image.utime, image.width, image.height,
                         camera_.width, camera_.height);
    return "";
  }

  std::string check_complete() const {
    if (missing_.empty()) return "";
    return fmt::format("{} of {} images are missing, the first is {}", missing_.size(), expected_, *missing_.begin());
  }

 private:
  const Camera& camera_;
  std::set<int64_t> missing_;
  size_t expected_ = 0;
  int64_t last_utime_ = -1;
};

std::string read_images(LogReader& log, const window_job_t& manifest, WindowJobFile* result) {
  ImageChecker checker(manifest, result->job.camera);
  while (const std::optional<LogEvent> event = log.next()) {
    if (event->channel != channels::kCamera)
      return fmt::format("an event on {}: after the manifest come images on {} only", event->channel,
                         channels::kCamera);
    image_t image;
    if (!Bus::decode(event->data, &image))
      return fmt::format("image {}: {}", event->utime_us, why_undecodable<image_t>(event->data));
    if (std::string error = checker.take(image); !error.empty()) return error;
    if (check_image(image))
      result->job.images.push_back(std::move(image));
    else
      ++result->broken_images;
  }
  return log.error().empty() ? checker.check_complete() : "";
}

WindowJobFile read(const std::string& file, bool with_images) {
  WindowJobFile result;
  LogReader log(file);
  if (log.error().empty() && log.size_bytes() > kMaxWindowBytes) {
    result.error = fmt::format("{}: has {} bytes, a window has at most {}; it is something else, or move it elsewhere",
                               file, log.size_bytes(), kMaxWindowBytes);
    return result;
  }
  const std::optional<LogEvent> first = log.next();
  window_job_t manifest;
  std::string error;
  if (!first)
    error = log.error().empty() ? "is empty" : "";
  else if (first->channel != kWindowJobChannel)
    error = fmt::format("is no window: begins with an event on {}, not {}", first->channel, kWindowJobChannel);
  else if (!Bus::decode(first->data, &manifest))
    error = fmt::format("its manifest cannot be read: {}", why_undecodable<window_job_t>(first->data));
  else
    error = read_manifest(manifest, &result.job);
  if (first && error.empty() && with_images) error = read_images(log, manifest, &result);
  if (!error.empty())
    result.error = fmt::format("{}: {}", file, error);
  else
    result.error = log.error();
  return result;
}

std::string check_job(const window_job_t& manifest, const WindowJob& job) {
  WindowJob as_read;
  if (std::string error = read_manifest(manifest, &as_read); !error.empty()) return error;
  ImageChecker checker(manifest, as_read.camera);
  int64_t bytes = 0;
  for (const image_t& image : job.images) {
    if (std::string error = checker.take(image); !error.empty()) return error;
    bytes += image.getEncodedSize();
  }
  if (bytes > kMaxWindowBytes) return fmt::format("its images have {} bytes, {} are allowed", bytes, kMaxWindowBytes);
  return checker.check_complete();
}

}  // namespace

std::string check_window_job(const WindowJob& job) { return check_job(make_manifest(job), job); }

WindowJobFile read_window_job(const std::string& file) { return read(file, true); }
WindowJobFile read_window_manifest(const std::string& file) { return read(file, false); }

std::string write_window_job(const std::string& file, const WindowJob& job) {
  const window_job_t manifest = make_manifest(job);
  if (std::string error = check_job(manifest, job); !error.empty())
    return fmt::format("{}: not written, {}", file, error);
  const std::string temporary = temporary_name(file);
  LogWriter log(temporary);
  bool ok = log.write(manifest.utime, kWindowJobChannel, encode_message(manifest));
  for (const image_t& image : job.images) ok = ok && log.write(image.utime, channels::kCamera, encode_message(image));
  if (!log.close() || !ok) {
    std::remove(temporary.c_str());
    // The name that people know.
    const std::string& error = log.error();
    return error.starts_with(temporary) ? file + error.substr(temporary.size()) : error;
  }
  return commit_file(temporary, file).error_text();
}

}  // namespace rumi::ruminator
