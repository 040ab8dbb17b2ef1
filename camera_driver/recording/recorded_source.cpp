// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/recorded_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/running/log.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/image_stream.h"
#include "camera_driver/recording/missing_images.h"
#include "camera_driver/source/encode_as.h"
#include "camera_driver/source/frame_selector.h"
#include "camera_driver/source/stream_name.h"

namespace rumi::camera_driver {
namespace {

std::vector<OrderedFrame> select(const std::vector<OrderedFrame>& frames, const CameraOptions& options) {
  using Verdict = FrameSelector::Verdict;
  FrameSelector selector(options);
  std::vector<OrderedFrame> wanted;
  for (const OrderedFrame& frame : frames) {
    const Verdict verdict = selector.judge(frame.elapsed_us);
    if (verdict == Verdict::kEnd) break;
    if (verdict == Verdict::kTake) wanted.push_back(frame);
  }
  return wanted;
}

}  // namespace

RecordedSource::RecordedSource(std::string name, std::unique_ptr<FrameReader> reader, const CameraFile& calibration,
                               const CameraOptions& options)
    : name_(std::move(name)),
      reader_(std::move(reader)),
      calibration_file_(calibration),
      camera_(calibration.camera),
      options_(options) {}

// Decides which frames are played, and in which order. An Error if their times cannot be used and there is no rate.
Result<FrameOrder> RecordedSource::order() const {
  const std::vector<int64_t>& utimes = reader_->utimes();
  const std::string no_times = reader_->why_no_times();
  const double rate_hz = options_.rate_hz > 0 ? options_.rate_hz : camera_.fps;
  if (!no_times.empty() && !(rate_hz > 0)) return Error{no_times, "", "give --rate HZ, or fps in the calibration"};
  if (no_times.empty()) {
    Result<FrameOrder> order = order_frames(utimes);
    const bool is_whole = order && order->frames.size() == utimes.size() && order->frames.back().part == 0;
    if (options_.rate_hz <= 0 || is_whole) return order;
  }
  // If there is a rate, the frames get new times, so the recorded ones may be wrong.
  return frames_at_rate(utimes.size(), rate_hz, utimes.front());
}

Result<> RecordedSource::plan() {
  const Result<FrameOrder> ordered = order();
  if (!ordered) return ordered.error();
  const FrameOrder& all = *ordered;
  frames_ = select(all.frames, options_);
  if (frames_.empty())
    return Error{
        fmt::format("there is no image from second {} on: the recording is {:.1f} s long ({} images); lower --start",
                    options_.start_s, static_cast<double>(all.frames.back().elapsed_us) * 1e-6, all.frames.size())};
  if (const std::string few = too_few_pixels(camera_.width, camera_.height); !few.empty())
    log_warning("{}: {}", name_, few);
  for (const std::string& note : reader_->notes()) log_warning("{}: {}", name_, note);
  if (all.is_sorted)
    log_warning("{}: its images are not stored in the order of their times: they are played in it", name_);
  for (size_t i = 1; i < all.frames.size(); ++i)
    if (all.frames[i].part != all.frames[i - 1].part)
      log_warning("{}: the clock was set back by {:.3f} s: a new session begins", reader_->where(all.frames[i].frame),
                  static_cast<double>(all.frames[i - 1].utime_us - all.frames[i].utime_us) * 1e-6);
  const MissingImages missing = find_missing_images(all.frames);
  if (100 * missing.count > static_cast<int64_t>(all.frames.size()))
    log_info(
        "{}: some {} images are missing between its {}, by their times (one every {:.1f} ms): whoever recorded them "
        "has "
        "lost them",
        name_, missing.count, all.frames.size(), static_cast<double>(missing.period_us) * 1e-3);
  count_left_out(all);
  return {};
}

// Counts only frames within the part that is played.
void RecordedSource::count_left_out(const FrameOrder& order) {
  const auto [first, last] = std::minmax_element(
      frames_.begin(), frames_.end(), [](const OrderedFrame& a, const OrderedFrame& b) { return a.frame < b.frame; });
  const bool is_all = options_.start_s <= 0 && options_.duration_s <= 0;
  const auto is_played = [&, from = first->frame, to = last->frame](size_t frame) {
    return is_all || (frame >= from && frame <= to);
  };
  for (const size_t frame : order.duplicates)
    if (is_played(frame))
      skip(&SkippedFrames::duplicate, reader_->where(frame) + ": has the same time as another image");
  for (const size_t frame : order.wrong_times)
    if (is_played(frame))
      skip(&SkippedFrames::out_of_order,
           fmt::format("{}: its time, {:.6f} s, is far from those of the images around it", reader_->where(frame),
                       static_cast<double>(reader_->utimes()[frame]) * 1e-6));
  skipped_.other_camera = reader_->of_other_cameras();
  if (options_.duration_s <= 0) skipped_.unreadable += reader_->missing_at_end();
  if (const Malformed malformed = reader_->malformed(); malformed.count > 0) {
    skip(&SkippedFrames::malformed, malformed.first);
    skipped_.malformed = malformed.count;
  }
}

// The name of a stream depends on all times and the first image, not on the part that is played. New times (rate_hz)
// make another stream.
void RecordedSource::name_streams() {
  StreamName name;
  name.add(std::llround(options_.rate_hz * 1e6));
  for (const int64_t utime_us : reader_->utimes()) name.add(utime_us);
  if (const Result<image_t> image = reader_->load(0, /*colour=*/false)) name.add(image->data);
  for (int part = 0; part <= frames_.back().part; ++part) {
    if (part > 0) name.add(part);
    streams_.push_back(name.number());
  }
}

Result<> RecordedSource::start() {
  if (const Result<> planned = plan(); !planned) return Error{planned.error_text(), name_};
  name_streams();
  starting_ = true;
  ahead_ = fetch();
  starting_ = false;
  have_ahead_ = true;
  if (skipped_.wrong_size > 0) return Error{first_problem_};
  if (!ahead_)
    return Error{fmt::format("none of its {} images can be used: {}", frames_.size(), first_problem_), name_};
  return {};
}

Result<> RecordedSource::use_masks(const MaskPlaces& places) {
  Result<> found = masks_.find(places, *reader_, {camera_.width, camera_.height});
  if (!masks_.what().empty()) log_info("mask: {}", masks_.what());
  return found;
}

std::optional<image_t> RecordedSource::next() {
  std::optional<image_t> image = have_ahead_ ? std::move(ahead_) : fetch();
  have_ahead_ = false;
  if (image) put_mask(&*image);
  return image;
}

// Adds the frame's mask to the image, unless the image came with one.
void RecordedSource::put_mask(image_t* image) {
  const bool fits = image->width == camera_.width && image->height == camera_.height;
  if (!fits || !metadata(*image, kMaskKey).empty()) return;
  if (const std::string png = masks_.png_of(fetched_); !png.empty()) set_metadata(image, kMaskKey, png);
}

std::optional<image_t> RecordedSource::fetch() {
  while (next_ < frames_.size() || begin_next_pass()) {
    const OrderedFrame& frame = frames_[next_++];
    // This comes before loading, so that an unreadable image leaves a gap and does not shift the times of others.
    const int64_t utime_us = new_time(frame);
    if (only_ && !only_->contains(utime_us)) continue;
    std::optional<image_t> image = load_checked(frame.frame);
    if (!image && starting_ && skipped_.wrong_size > 0) return std::nullopt;
    if (!image) continue;
    image->utime = utime_us;
    ++handed_out_in_pass_;
    // The metadata of a logged image, such as the time of publication, no longer hold. Its stream and its mask do.
    const int64_t in_log = options_.rate_hz > 0 || frame.part > 0 ? kNoStream : stream_of(*image);
    const std::string mask(options_.mask.empty() ? metadata(*image, kMaskKey) : "");
    const CameraFile& camera = *camera_of(*image);  // load_checked() has made sure of a calibration
    image->metadata.clear();
    set_stream(in_log == kNoStream ? streams_[static_cast<size_t>(frame.part)] : in_log, &*image);
    set_metadata(&*image, kCalibrationKey, camera_to_yaml(camera.camera));
    if (!mask.empty()) set_metadata(&*image, kMaskKey, mask);
    fetched_ = frame.frame;
    return image;
  }
  report_end();
  return std::nullopt;
}

bool RecordedSource::begin_next_pass() {
  // If no image was usable, another pass would give none either.
  if (!options_.loop || handed_out_in_pass_ == 0) return false;
  const int64_t span_us = frames_.back().elapsed_us - frames_.front().elapsed_us;
  const double nominal_hz = camera_.fps > 0 ? camera_.fps : 30;
  const auto steps = static_cast<int64_t>(frames_.size()) - 1;
  offset_us_ += span_us + (steps > 0 ? span_us / steps : std::llround(1e6 / nominal_hz));
  handed_out_in_pass_ = 0;
  ++pass_;
  next_ = 0;
  return true;
}

void RecordedSource::play_again(const std::set<int64_t>& utimes_us, Pixels pixels) {
  only_ = utimes_us;
  if (pixels == Pixels::kColour) options_.encoding = "rgb";
  options_.loop = have_ahead_ = false;
  next_ = 0;
  taken_ = offset_us_ = 0;
  ++pass_;
  reported_ = true;
}

std::filesystem::path RecordedSource::image_folder() const {
  std::filesystem::path folder = reader_->file(0).parent_path();
  for (size_t frame = 1; frame < reader_->utimes().size() && !folder.empty(); ++frame) {
    const std::filesystem::path inner = reader_->file(frame).parent_path();
    while (!folder.empty() && inner != folder && inner.lexically_relative(folder).string().starts_with(".."))
      folder = folder.has_relative_path() ? folder.parent_path() : "";
  }
  return folder;
}

int64_t RecordedSource::new_time(const OrderedFrame& frame) {
  const int64_t index = taken_++;
  const OrderedFrame& first = frames_.front();
  if (options_.rate_hz > 0) return first.utime_us + std::llround(static_cast<double>(index) * 1e6 / options_.rate_hz);
  if (!options_.loop) return frame.utime_us;
  return first.utime_us + frame.elapsed_us - first.elapsed_us + offset_us_;
}

std::optional<image_t> RecordedSource::load_checked(size_t frame) {
  const bool colour = options_.encoding == "rgb" || options_.encoding == "jpeg";
  Result<image_t> image = reader_->load(frame, colour);
  const Result<CameraFile>& camera = image ? camera_of(*image) : calibration_file_;
  if (!camera) {
    skip(&SkippedFrames::unreadable, fmt::format("{}: {}", reader_->where(frame), camera.error_text()));
    return std::nullopt;
  }
  tell_of_other_camera(frame, *camera);
  if (!image) {
    skip(&SkippedFrames::unreadable, image.error_text());
    return std::nullopt;
  }
  if (image->width != camera->camera.width || image->height != camera->camera.height) {
    skip(&SkippedFrames::wrong_size,
         fmt::format("{}: the image is {} x {} pixels but the calibration{} is for {} x {}; {}", reader_->where(frame),
                     image->width, image->height, camera->file.empty() ? "" : " " + camera->file, camera->camera.width,
                     camera->camera.height, advice_on_size(*camera, image->width, image->height)));
    return std::nullopt;
  }
  const std::vector<image_metadata_t> metadata = image->metadata;
  image = encode_as(std::move(*image), options_);
  if (!image) {
    skip(&SkippedFrames::unreadable, fmt::format("{}: {}", reader_->where(frame), image.error_text()));
    return std::nullopt;
  }
  image->metadata = metadata;
  image->nmetadata = static_cast<int32_t>(metadata.size());
  return std::move(*image);
}

// Returns the calibration in the image's metadata (of a log or bag); that of the recording if the image has none, or
// the user gave one.
const Result<CameraFile>& RecordedSource::camera_of(const image_t& image) {
  const std::string_view text = options_.camera_file.empty() ? metadata(image, kCalibrationKey) : "";
  if (text.empty()) return calibration_file_;
  const auto known = cameras_.find(text);
  if (known != cameras_.end()) return known->second;
  const std::string yaml(text);
  return cameras_.emplace(yaml, parse_camera(yaml, name_ + " (calibration in its images)")).first->second;
}

void RecordedSource::tell_of_other_camera(size_t frame, const CameraFile& camera) {
  std::string yaml = camera_to_yaml(camera.camera);
  if (pass_ == 0 && !last_calibration_.empty() && last_calibration_ != yaml)
    log_warning("{}: from here on the calibration in the images is another one: a new session begins",
                reader_->where(frame));
  last_calibration_ = std::move(yaml);
}

// Counts in the first pass only, because a loop skips the same frames again.
void RecordedSource::skip(int64_t SkippedFrames::*reason, const std::string& message) {
  if (pass_ > 0) return;
  const bool refused = starting_ && reason == &SkippedFrames::wrong_size;  // reported by the caller of start()
  if (first_problem_.empty() || refused) first_problem_ = message;
  // Messages about a wrong size end with what to do.
  if (++(skipped_.*reason) == 1 && !refused)
    log_warning("{}{}", message, reason == &SkippedFrames::wrong_size ? "" : "; left out");
}

void RecordedSource::report_end() {
  if (!reported_ && skipped_.total() > 0) log_warning("{}: left out in all: {}", name_, skipped_.to_string());
  reported_ = true;
}

}  // namespace rumi::camera_driver
