// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/v4l2_source.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>

#include "base/running/log.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/image_stream.h"
#include "bus/wire/mask_file.h"
#include "camera_driver/source/encode_as.h"
#include "camera_driver/source/stream_name.h"
#include "camera_driver/v4l2/video_controls.h"
#include "formats/camera/camera_file.h"
#include "formats/recording/mask_option.h"

namespace rumi::camera_driver {
namespace {

constexpr int kWaitMs = 20;  // for an image; short, so that a request to stop is heard
constexpr int64_t kFirstRetryUs = 250'000, kLastRetryUs = 5'000'000;
constexpr int64_t kRateWindowUs = 2'000'000;
constexpr double kSlow = 0.8;  // below this share of the agreed rate a camera is slow
constexpr double kDefaultRateHz = 30;
constexpr int64_t kExposureUnitUs = 100;  // unit of V4L2_CID_EXPOSURE_ABSOLUTE

double wanted_rate(const CameraOptions& options, const Camera& camera) {
  if (options.rate_hz > 0) return options.rate_hz;
  return camera.fps > 0 ? camera.fps : kDefaultRateHz;
}

// Returns the exposure time that was set; 0 if the camera chooses it, or does not tell.
int64_t fixed_exposure_us(const VideoDevice& device) {
  if (read_control(device, V4L2_CID_EXPOSURE_AUTO) != V4L2_EXPOSURE_MANUAL) return 0;
  return read_control(device, V4L2_CID_EXPOSURE_ABSOLUTE).value_or(0) * kExposureUnitUs;
}

Result<image_t> encode(const PixelFormat& format, const RawImage& raw, const CameraOptions& options) {
  if (format.layout == PixelLayout::kJpeg) {
    Result<image_t> jpeg = jpeg_image(raw);
    if (!jpeg) return jpeg;
    return encode_as(std::move(*jpeg), options);
  }
  const bool colour = options.encoding == "rgb" || options.encoding == "jpeg";
  const Result<cv::Mat> pixels = to_pixels(format, raw, colour);
  if (!pixels) return pixels.error();
  return encode_pixels(0, *pixels, options);
}

}  // namespace

V4l2Source::V4l2Source(VideoSystem& system, std::string input, const Camera& camera, const CameraOptions& options)
    : system_(system),
      input_(std::move(input)),
      calibration_(camera.fx > 0 ? camera_to_yaml(camera) : ""),
      camera_(camera),
      options_(options),
      selector_(options) {}

std::string V4l2Source::start() {
  const std::string problem = open();
  if (problem.empty() || !busy_) return problem;
  lose(problem);
  return {};
}

std::string V4l2Source::open_device(std::unique_ptr<VideoDevice>* device) {
  const FoundDevice found = find_camera_device(system_, input_);
  if (!found.error.empty()) return found.error;
  OpenedDevice opened = open_video_device(system_, found.path);
  busy_ = opened.busy;
  if (!opened.error.empty()) return opened.error;
  // Images of another camera must not be tracked with this camera's calibration.
  if (!card_.empty() && opened.identity.card != card_)
    return fmt::format("{}: is another camera now, '{}' instead of '{}'; name cameras as in /dev/v4l/by-id", found.path,
                       opened.identity.card, card_);
  card_ = opened.identity.card;
  *device = std::move(opened.device);
  return {};
}

std::string V4l2Source::open() {
  std::unique_ptr<VideoDevice> device;
  if (std::string problem = open_device(&device); !problem.empty()) return problem;
  const StreamRequest request{camera_.width, camera_.height, wanted_rate(options_, camera_), options_.format};
  OpenedStream opened = open_stream(std::move(device), request);
  busy_ = opened.busy;
  if (!opened.error.empty()) return opened.error;
  stream_ = std::move(opened.stream);
  set_up_controls();
  if (std::string problem = stream_->start(); !problem.empty()) {
    busy_ = stream_->busy();
    stream_.reset();
    return problem;
  }
  last_frame_us_ = system_.now().monotonic_us;
  first_frame_us_.reset();
  last_sequence_.reset();
  locked_ = false;
  rate_count_ = 0;
  const StreamFormat& format = stream_->format();
  log_info("{}: '{}' gives {} {} x {} at {}", stream_->device().path(), card_, format.pixels->option, format.width,
           format.height, format.rate_hz > 0 ? fmt::format("{:.4g} Hz", format.rate_hz) : "a rate it does not tell");
  if (format.rate_hz > 0 && format.rate_hz < kSlow * request.rate_hz)
    log_warning("{}: asked for {:.4g} Hz, the camera gives {:.4g} Hz at this size and format", input_, request.rate_hz,
                format.rate_hz);
  return {};
}

void V4l2Source::set_up_controls() {
  for (const std::string& problem : apply_controls(stream_->device(), options_))
    log_error("{}: camera_driver.{}", input_, problem);
  exposure_us_ = fixed_exposure_us(stream_->device());
  if (options_.focus.empty() && !calibration_.empty() && read_control(stream_->device(), V4L2_CID_FOCUS_AUTO) == 1)
    log_warning("{}: the camera focuses by itself, which makes its calibration wrong; give camera_driver.focus",
                input_);
}

void V4l2Source::set_controls(const CameraControls& controls) {
  static_cast<CameraControls&>(options_) = controls;
  if (!stream_) return;
  set_up_controls();
  locked_ = false;
  log_info("{}: controls set as the options say", input_);
}

void V4l2Source::retry_later() {
  const int64_t now_us = system_.now().monotonic_us;
  retry_delay_us_ = std::clamp(2 * retry_delay_us_, kFirstRetryUs, kLastRetryUs);
  retry_at_us_ = now_us + retry_delay_us_;
}

void V4l2Source::lose(const std::string& why) {
  stream_.reset();
  gone_at_us_ = system_.now().monotonic_us;
  live_.problem = why;
  live_.rate_hz = 0;
  log_error("{}; trying again until it works", why);
  retry_later();
}

// Opens the camera again if it is time for that. Returns true if there is a stream then; else it may have waited a
// little.
bool V4l2Source::reopen() {
  const int64_t now_us = system_.now().monotonic_us;
  if (now_us < retry_at_us_) {
    system_.wait(static_cast<int>(std::min<int64_t>(kWaitMs, (retry_at_us_ - now_us) / 1000 + 1)));
    return false;
  }
  const std::string problem = open();
  if (problem.empty()) return true;
  if (problem != live_.problem) log_error("{}; trying again until it works", problem);
  live_.problem = problem;
  retry_later();
  return false;
}

void V4l2Source::check_stall() {
  const double silent_s = static_cast<double>(system_.now().monotonic_us - last_frame_us_) * 1e-6;
  if (silent_s > options_.stall_s)
    lose(fmt::format("{}: no image for {:.1f} s (a bad cable or hub, or too little USB bandwidth)",
                     stream_->device().path(), silent_s));
}

std::optional<image_t> V4l2Source::next() {
  if (live_.ended || (!stream_ && !reopen())) return std::nullopt;
  StreamFrame frame;
  std::string error;
  const VideoStream::Read read = stream_->read(kWaitMs, &frame, &error);
  if (read == VideoStream::Read::kNothing) check_stall();
  if (read == VideoStream::Read::kFailed) lose(error);
  if (read != VideoStream::Read::kFrame) return std::nullopt;
  note(frame);
  std::optional<image_t> image = accept(frame);
  if (const std::string problem = stream_->release(); !problem.empty()) lose(problem);
  return image;
}

void V4l2Source::note(const StreamFrame& frame) {
  const int64_t now_us = frame.stamps.now.monotonic_us;
  if (!live_.problem.empty())
    log_info("{}: gives images again, after {:.1f} s", stream_->device().path(),
             static_cast<double>(now_us - gone_at_us_) * 1e-6);
  live_.problem.clear();
  retry_delay_us_ = 0;
  last_frame_us_ = now_us;
  if (!first_frame_us_) first_frame_us_ = now_us;
  count_gap(frame.sequence);
  lock_when_warm(now_us);
}

void V4l2Source::count_gap(uint32_t sequence) {
  constexpr uint32_t kBackwards = uint32_t{1} << 31;  // the numbering began again, or the driver has none
  const uint32_t gap = last_sequence_ ? sequence - *last_sequence_ - 1 : 0;
  last_sequence_ = sequence;
  if (gap == 0 || gap >= kBackwards) return;
  if (skipped_.lost == 0)
    log_warning("{}: {} images were lost before they reached us; from now on they are only counted", input_, gap);
  skipped_.lost += gap;
}

void V4l2Source::lock_when_warm(int64_t now_us) {
  const bool warm = options_.lock_auto_s > 0 && now_us - *first_frame_us_ >= std::llround(options_.lock_auto_s * 1e6);
  if (locked_ || !warm) return;
  locked_ = true;
  log_info("{}: {}", input_, lock_automatic(stream_->device()));
  exposure_us_ = fixed_exposure_us(stream_->device());
}

void V4l2Source::measure_rate(int64_t utime_us) {
  if (rate_count_++ == 0) rate_from_us_ = utime_us;
  const int64_t span_us = utime_us - rate_from_us_;
  if (span_us < kRateWindowUs) return;
  live_.rate_hz = static_cast<double>(rate_count_ - 1) * 1e6 / static_cast<double>(span_us);
  rate_from_us_ = utime_us;
  rate_count_ = 1;
  const double agreed_hz = stream_->format().rate_hz;
  if (rate_warned_ || live_.rate_hz >= kSlow * agreed_hz) return;
  rate_warned_ = true;
  log_warning(
      "{}: agreed to {:.4g} Hz but gives {:.1f} Hz; many cameras slow down in the dark: give more light or "
      "camera_driver.exposure",
      input_, agreed_hz, live_.rate_hz);
}

std::optional<image_t> V4l2Source::accept(StreamFrame& frame) {
  using Verdict = FrameSelector::Verdict;
  frame.stamps.exposure_us = exposure_us_;
  const int64_t utime_us = clock_.utime_us(frame.stamps);
  if (const std::optional<int64_t> step_us = clock_.take_step_us())
    log_warning("the system clock was set by {:+.3f} s; times of images {}", static_cast<double>(*step_us) * 1e-6,
                *step_us > 0 ? "follow" : "go on as before: start camera_driver again to follow it");
  if (clock_.replaced() > 0 && !clock_warned_) {
    clock_warned_ = true;
    log_warning("{}: the driver's time stamps are not of the monotonic clock; the time of arrival is used instead",
                input_);
  }
  measure_rate(utime_us);
  if (frame.damaged) {
    skip(&SkippedFrames::unreadable, fmt::format("{}: an image is damaged, says the driver", input_));
    return std::nullopt;
  }
  const Verdict verdict = selector_.judge(utime_us);
  if (verdict == Verdict::kDuplicate)
    skip(&SkippedFrames::duplicate, input_ + ": an image has the time of the one before");
  if (verdict == Verdict::kOutOfOrder)
    skip(&SkippedFrames::out_of_order, input_ + ": the time of an image is before that of the one before");
  live_.ended = verdict == Verdict::kEnd;
  if (verdict != Verdict::kTake) return std::nullopt;

  Result<image_t> image = encode(*stream_->format().pixels, frame.image, options_);
  if (!image) {
    skip(&SkippedFrames::unreadable, fmt::format("{}: an image {}", input_, image.error_text()));
    return std::nullopt;
  }
  image->utime = utime_us;
  StreamName stream;  // the same stream after a restart of this process: the clock goes on, too
  stream.add(input_);
  stream.add(card_);
  set_stream(stream.number(), &*image);
  if (!calibration_.empty()) set_metadata(&*image, kCalibrationKey, calibration_);
  if (!mask_.empty()) set_metadata(&*image, kMaskKey, mask_);
  return std::move(*image);
}

void V4l2Source::skip(int64_t SkippedFrames::*reason, const std::string& message) {
  if (++(skipped_.*reason) == 1) log_warning("{}; left out, and from now on only counted", message);
}

namespace {

// Returns the PNG of the user's mask, else of the one that the calibration names; empty if there is neither. An Error
// if the mask cannot be used.
Result<std::string> read_mask(const CameraOptions& options, const CameraFile& calibration) {
  const std::string& file = options.mask.empty() ? calibration.mask : options.mask;
  if (file.empty() || file == kNoMask) return std::string();
  const Result<cv::Mat> mask = read_camera_mask(file, {calibration.camera.width, calibration.camera.height});
  if (!mask) return mask.error();
  log_info("mask: {}: {:.1f} % of each image is left out", file, 100 * share_left_out(*mask));
  return encode_mask(*mask);
}

// Returns the calibration that the user gives (an Error if it cannot be read); without one, a camera of the wanted size
// without a focal length.
Result<CameraFile> camera_file_of(const CameraOptions& options) {
  constexpr int kDefaultWidth = 640, kDefaultHeight = 480;
  if (!options.camera_file.empty()) return read_camera_file(options.camera_file);
  CameraFile none;
  none.camera.width = options.width > 0 ? options.width : kDefaultWidth;
  none.camera.height = options.height > 0 ? options.height : kDefaultHeight;
  return none;
}

}  // namespace

OpenedSource open_camera(VideoSystem& system, const std::string& input, const CameraOptions& options) {
  if (options.loop) return Error{"loop is true: a camera has no end to begin again from", input};
  if (options.speed != 1) return Error{fmt::format("speed is {}: a camera has its own", options.speed), input};
  Result<CameraFile> file = camera_file_of(options);
  if (!file) return file.error();
  // A side that is not given is the calibration's.
  const int width = options.width > 0 ? options.width : file->camera.width;
  const int height = options.height > 0 ? options.height : file->camera.height;
  choose_size(width, height, &*file);
  log_notes(*file);
  const Camera& camera = file->camera;
  if (width != camera.width || height != camera.height)
    return Error{fmt::format("width x height is {} x {} but the calibration {} is for {} x {}; {}", width, height,
                             options.camera_file, camera.width, camera.height, advice_on_size(*file, width, height)),
                 input};
  const Result<std::string> mask = read_mask(options, *file);
  if (!mask) return mask.error();
  auto source = std::make_unique<V4l2Source>(system, input, camera, options);
  source->use_mask(*mask);
  if (const std::string problem = source->start(); !problem.empty()) return Error{problem};
  if (options.camera_file.empty())
    log_warning("{}: no calibration (--camera FILE): images can be recorded and looked at, but not tracked", input);
  return OpenedSource(std::move(source));
}

}  // namespace rumi::camera_driver
