// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/recorded_source.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "base/log.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "camera_driver/source/encode_as.h"
#include "camera_driver/source/stream_name.h"

namespace rumi::camera_driver {
namespace {

int64_t count_wanted(const std::vector<int64_t>& utimes, const CameraOptions& options) {
  FrameSelector selector(options);
  int64_t count = 0;
  for (const int64_t utime_us : utimes) {
    const FrameSelector::Verdict verdict = selector.judge(utime_us);
    if (verdict == FrameSelector::Verdict::kEnd) break;
    count += verdict == FrameSelector::Verdict::kTake ? 1 : 0;
  }
  return count;
}

}  // namespace

RecordedSource::RecordedSource(std::string name, std::unique_ptr<FrameReader> reader,
                               const CameraFileResult& calibration, const CameraOptions& options)
    : name_(std::move(name)),
      calibration_(camera_to_yaml(calibration.camera)),
      reader_(std::move(reader)),
      calibration_file_(calibration),
      camera_(calibration.camera),
      options_(options),
      selector_(options) {
  const std::vector<int64_t> utimes = reader_->utimes();
  if (!utimes.empty() && !options_.loop) total_ = count_wanted(utimes, options_);
}

// By the times and the first image, whichever part is played. With times of our own it is another stream.
void RecordedSource::name_stream() {
  StreamName name;
  name.add(std::llround(options_.rate_hz * 1e6));
  for (const int64_t utime_us : reader_->utimes()) name.add(utime_us);
  std::error_code is_folder;  // of a file, whose times are not known before it has been read, its size
  if (const auto bytes = std::filesystem::file_size(name_, is_folder); !is_folder)
    name.add(static_cast<int64_t>(bytes));
  std::string ignored;
  if (const std::optional<FrameStamp> first = reader_->advance()) {
    name.add(first->utime_us);
    if (const std::optional<image_t> image = reader_->load(false, &ignored)) name.add(image->data);
  }
  reader_->rewind();
  stream_ = name.number();
}

std::string RecordedSource::start() {
  name_stream();
  starting_ = true;
  ahead_ = fetch();
  starting_ = false;
  have_ahead_ = true;
  if (ahead_ && skipped_.wrong_size == 0) return {};
  if (!first_problem_.empty()) return first_problem_;
  return fmt::format("{}: no image between start {} s and its end; lower --start", name_, options_.start_s);
}

std::optional<image_t> RecordedSource::next() {
  if (!have_ahead_) return fetch();
  have_ahead_ = false;
  return std::move(ahead_);
}

std::optional<image_t> RecordedSource::fetch() {
  while (const std::optional<FrameStamp> stamp = next_wanted()) {
    // Before loading: an unreadable image leaves a gap, it does not shift the others' times.
    const int64_t utime_us = new_time(stamp->utime_us);
    std::optional<image_t> image = load_checked(*stamp);
    if (!image && starting_ && skipped_.wrong_size > 0) return std::nullopt;
    if (!image) continue;
    image->utime = utime_us;
    ++handed_out_in_pass_;
    // What an earlier process noted in a log, such as when it was published, is not true of this one. What it is an
    // image of is.
    const int64_t in_log = options_.rate_hz > 0 ? kNoStream : stream_of(*image);
    image->metadata.clear();
    set_stream(in_log == kNoStream ? stream_ : in_log, &*image);
    set_metadata(&*image, kCalibrationKey, calibration_);
    return image;
  }
  report_end();
  return std::nullopt;
}

// The next frame that is wanted, in this pass or the next one.
std::optional<FrameStamp> RecordedSource::next_wanted() {
  using Verdict = FrameSelector::Verdict;
  while (true) {
    const std::optional<FrameStamp> stamp = reader_->advance();
    const Verdict verdict = stamp ? selector_.judge(stamp->utime_us) : Verdict::kEnd;
    if (verdict == Verdict::kTake) return stamp;
    if (verdict == Verdict::kDuplicate)
      skip(&SkippedFrames::duplicate, stamp->where + ": has the same time as the image before; left out");
    if (verdict == Verdict::kOutOfOrder)
      skip(&SkippedFrames::out_of_order, stamp->where + ": its time is before that of the image before; left out");
    if (verdict == Verdict::kEnd && !begin_next_pass()) return std::nullopt;
  }
}

bool RecordedSource::begin_next_pass() {
  const Malformed malformed = reader_->malformed();
  if (pass_ == 0 && malformed.count > 0) {
    skip(&SkippedFrames::malformed, malformed.first);
    skipped_.malformed = malformed.count;
  }
  // Another pass would give nothing either, for ever.
  if (!options_.loop || handed_out_in_pass_ == 0) return false;
  const int64_t span_us = pass_last_us_ - pass_first_us_;
  const double nominal_hz = camera_.fps > 0 ? camera_.fps : 30;
  const int64_t period_us = taken_in_pass_ > 1 ? span_us / (taken_in_pass_ - 1) : std::llround(1e6 / nominal_hz);
  offset_us_ += span_us + period_us;
  taken_in_pass_ = handed_out_in_pass_ = 0;
  ++pass_;
  selector_.rewind();
  reader_->rewind();
  return true;
}

int64_t RecordedSource::new_time(int64_t recorded_us) {
  if (taken_ == 0) origin_us_ = recorded_us;
  if (taken_in_pass_++ == 0) pass_first_us_ = recorded_us;
  pass_last_us_ = recorded_us;
  const int64_t index = taken_++;
  if (options_.rate_hz > 0) return origin_us_ + std::llround(static_cast<double>(index) * 1e6 / options_.rate_hz);
  return recorded_us + offset_us_;
}

std::optional<image_t> RecordedSource::load_checked(const FrameStamp& stamp) {
  const bool colour = options_.encoding == "rgb" || options_.encoding == "jpeg";
  std::string error;
  std::optional<image_t> image = reader_->load(colour, &error);
  if (!image) {
    skip(&SkippedFrames::unreadable, error + "; left out");
    return std::nullopt;
  }
  if (image->width != camera_.width || image->height != camera_.height) {
    skip(&SkippedFrames::wrong_size,
         fmt::format("{}: the image is {} x {} pixels but the calibration is for {} x {}; {}", stamp.where,
                     image->width, image->height, camera_.width, camera_.height,
                     advice_on_size(calibration_file_, image->width, image->height)));
    return std::nullopt;
  }
  image = encode_as(std::move(*image), options_, &error);
  if (!image) skip(&SkippedFrames::unreadable, fmt::format("{}: {}; left out", stamp.where, error));
  return image;
}

// Counts in the first pass only: in a loop the same frames would be counted again and again.
void RecordedSource::skip(int64_t SkippedFrames::*reason, const std::string& message) {
  if (pass_ > 0) return;
  const bool refused = starting_ && reason == &SkippedFrames::wrong_size;  // said by whoever asked to start
  if (first_problem_.empty() || refused) first_problem_ = message;
  if (++(skipped_.*reason) == 1 && !refused) log_warning("{}", message);
}

void RecordedSource::report_end() {
  if (!reported_ && skipped_.total() > 0) log_warning("{}: left out in all: {}", name_, skipped_.to_string());
  reported_ = true;
}

}  // namespace rumi::camera_driver
