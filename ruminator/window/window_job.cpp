// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/window_job.h"

#include <fmt/format.h>

#include <cstdio>
#include <set>
#include <utility>

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

// Checks the numbers of the manifest that are not about one frame.
Result<> check_header(const window_job_t& m) {
  const window_t& w = m.window;
  if (w.window_id < 1) return Error{fmt::format("window_id {}: must be 1 or more", w.window_id)};
  if (w.session < 0) return Error{fmt::format("session {}: must not be negative", w.session)};
  if (!plausible_utime(w.lost_utime)) return Error{fmt::format("lost_utime {}: no time", w.lost_utime)};
  if (!plausible_utime(w.resumed_utime)) return Error{fmt::format("resumed_utime {}: no time", w.resumed_utime)};
  if (w.gap_frames < 0) return Error{fmt::format("gap_frames {}: must not be negative", w.gap_frames)};
  const size_t listed = w.approach_utime.size() + w.gap_utime.size() + w.departure_utime.size();
  if (m.samples.size() != listed)
    return Error{fmt::format("nsamples {}: approach, gap and departure list {} frames", m.samples.size(), listed)};
  if (m.samples.empty()) return Error{"nsamples 0: a window without frames"};
  return {};
}

// Reads manifest.samples[index], whose time must be `utime`.
Result<Sample> read_sample(const window_job_t& m, size_t index, int64_t utime) {
  const window_sample_t& s = m.samples[index];
  const auto wrong = [&](const std::string& what) { return Error{fmt::format("samples[{}].{}", index, what)}; };
  if (!plausible_utime(s.utime)) return wrong(fmt::format("utime {}: no time", s.utime));
  if (s.utime != utime) return wrong(fmt::format("utime {}: the window lists {} here", s.utime, utime));
  if (index > 0 && s.utime <= m.samples[index - 1].utime)
    return wrong(fmt::format("utime {}: not later than the one before it, {}", s.utime, m.samples[index - 1].utime));
  Sample sample;
  sample.utime_us = s.utime;
  sample.is_keyframe = s.is_keyframe != 0;
  sample.submap_id = s.submap_id;
  if (s.submap_id == kNoSubmap) return sample;
  const std::optional<SE3> pose = from_wire(s.cam_from_submap);
  if (!pose) return wrong("cam_from_submap: no pose (not finite, or the quaternion is not of unit length)");
  sample.cam_from_submap = *pose;
  return sample;
}

Result<RuminationWindow> read_window(const window_job_t& m) {
  const window_t& w = m.window;
  RuminationWindow window;
  window.id = w.window_id;
  window.session = w.session;
  window.stream = w.stream;
  window.submap_before = w.submap_before;
  window.submap_after = w.submap_after;
  window.lost_utime_us = w.lost_utime;
  window.resumed_utime_us = w.resumed_utime;
  window.gap_frames = w.gap_frames;
  window.by_place = w.by_place != 0;
  window.reason = w.reason;
  size_t index = 0;
  for (const auto& [utimes, samples] :
       {std::pair(&w.approach_utime, &window.approach), std::pair(&w.gap_utime, &window.gap),
        std::pair(&w.departure_utime, &window.departure)}) {
    for (const int64_t utime : *utimes) {
      const Result<Sample> sample = read_sample(m, index++, utime);
      if (!sample) return sample.error();
      samples->push_back(*sample);
    }
  }
  return window;
}

// Returns the job without its images.
Result<WindowJob> read_manifest(const window_job_t& m) {
  if (const Result<> header = check_header(m); !header) return header.error();
  Result<RuminationWindow> window = read_window(m);
  if (!window) return window.error();
  const Result<Calibration> calibration = parse_calibration(m.calibration, "calibration");
  if (!calibration) return calibration.error();
  return WindowJob{std::move(*window), calibration->camera, {}};
}

// Checks the images one after another against the manifest.
class ImageChecker {
 public:
  ImageChecker(const window_job_t& manifest, const Camera& camera) : camera_(camera) {
    for (const window_sample_t& sample : manifest.samples)
      if (sample.has_image) missing_.insert(sample.utime);
    expected_ = missing_.size();
  }

  Result<> take(const image_t& image) {
    if (!missing_.erase(image.utime))
      return Error{fmt::format("image {}: the manifest lists no image of this time, or it is here twice", image.utime)};
    if (image.utime <= last_utime_)
      return Error{fmt::format("image {}: not later than the one before it, {}", image.utime, last_utime_)};
    last_utime_ = image.utime;
    if (image.width != camera_.width || image.height != camera_.height)
      return Error{fmt::format("image {}: is {}x{}, the calibration is for {}x{}", image.utime, image.width,
                               image.height, camera_.width, camera_.height)};
    return {};
  }

  Result<> check_complete() const {
    if (missing_.empty()) return {};
    return Error{
        fmt::format("{} of {} images are missing, the first is {}", missing_.size(), expected_, *missing_.begin())};
  }

 private:
  const Camera& camera_;
  std::set<int64_t> missing_;
  size_t expected_ = 0;
  int64_t last_utime_ = -1;
};

// Adds the images that follow the manifest. Ends without an Error if the log itself is damaged: the caller reports
// that.
Result<> read_images(LogReader& log, const window_job_t& manifest, WindowJobFile* file) {
  ImageChecker checker(manifest, file->job.camera);
  while (const std::optional<LogEvent> event = log.next()) {
    if (event->channel != channels::kCamera)
      return Error{
          fmt::format("an event on {}: after the manifest come images on {} only", event->channel, channels::kCamera)};
    image_t image;
    if (!Bus::decode(event->data, &image))
      return Error{fmt::format("image {}: {}", event->utime_us, why_undecodable<image_t>(event->data))};
    if (Result<> taken = checker.take(image); !taken) return taken;
    if (check_image(image))
      file->job.images.push_back(std::move(image));
    else
      ++file->broken_images;
  }
  return log.error().empty() ? checker.check_complete() : Result<>();
}

// Reads the events of a job's file. Its Errors do not contain the file's name.
Result<WindowJobFile> read_events(LogReader& log, bool with_images) {
  const std::optional<LogEvent> first = log.next();
  if (!first) return Error{"is empty"};
  if (first->channel != kWindowJobChannel)
    return Error{fmt::format("is no window: begins with an event on {}, not {}", first->channel, kWindowJobChannel)};
  window_job_t manifest;
  if (!Bus::decode(first->data, &manifest))
    return Error{fmt::format("its manifest cannot be read: {}", why_undecodable<window_job_t>(first->data))};
  Result<WindowJob> job = read_manifest(manifest);
  if (!job) return job.error();
  WindowJobFile file{std::move(*job)};
  if (!with_images) return file;
  if (const Result<> images = read_images(log, manifest, &file); !images) return images.error();
  return file;
}

Result<WindowJobFile> read(const std::string& file, bool with_images) {
  LogReader log(file);
  if (log.error().empty() && log.size_bytes() > kMaxWindowBytes)
    return Error{fmt::format("has {} bytes, a window has at most {}", log.size_bytes(), kMaxWindowBytes), file,
                 "it is something else, or move it elsewhere"};
  Result<WindowJobFile> read = read_events(log, with_images);
  if (!log.error().empty()) return Error{log.error()};
  if (!read) return Error{read.error_text(), file};
  return read;
}

Result<> check_job(const window_job_t& manifest, const WindowJob& job) {
  const Result<WindowJob> as_read = read_manifest(manifest);
  if (!as_read) return as_read.error();
  ImageChecker checker(manifest, as_read->camera);
  int64_t bytes = 0;
  for (const image_t& image : job.images) {
    if (Result<> taken = checker.take(image); !taken) return taken;
    bytes += image.getEncodedSize();
  }
  if (bytes > kMaxWindowBytes)
    return Error{fmt::format("its images have {} bytes, {} are allowed", bytes, kMaxWindowBytes)};
  return checker.check_complete();
}

}  // namespace

Result<> check_window_job(const WindowJob& job) { return check_job(make_manifest(job), job); }

Result<WindowJobFile> read_window_job(const std::string& file) { return read(file, true); }

Result<WindowJob> read_window_manifest(const std::string& file) {
  Result<WindowJobFile> manifest = read(file, false);
  if (!manifest) return manifest.error();
  return std::move(manifest->job);
}

Result<> write_window_job(const std::string& file, const WindowJob& job) {
  const window_job_t manifest = make_manifest(job);
  if (const Result<> checked = check_job(manifest, job); !checked)
    return Error{fmt::format("not written, {}", checked.error_text()), file};
  const std::string temporary = temporary_name(file);
  LogWriter log(temporary);
  bool ok = log.write(manifest.utime, kWindowJobChannel, encode_message(manifest));
  for (const image_t& image : job.images) ok = ok && log.write(image.utime, channels::kCamera, encode_message(image));
  if (!log.close() || !ok) {
    std::remove(temporary.c_str());
    // Names the file that users know in the error, not the temporary one.
    const std::string& error = log.error();
    return Error{error.starts_with(temporary) ? file + error.substr(temporary.size()) : error};
  }
  return commit_file(temporary, file);
}

}  // namespace rumi::ruminator
