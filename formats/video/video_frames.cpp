// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "bus/wire/image_codec.h"
#include "formats/recording/foreign_recording.h"
#include "formats/recording/frame_reader.h"
#include "formats/video/video_choice.h"
#include "formats/video/video_decoder.h"
#include "formats/video/video_times.h"

namespace rumi {
namespace {

class VideoReader : public FrameReader {
 public:
  VideoReader(std::string file, std::optional<GreyRange> range, const std::vector<cv::Size>& wanted)
      : file_(std::move(file)),
        choice_(choose_video_stream(file_, wanted)),
        times_(read_video_times(file_, choice_.stream)),
        range_(range) {
    if (times_.utimes.empty()) return;
    begin();
    // Some files tell only in their pictures that they are interlaced.
    if (go_to(0) && decoder_->is_interlaced()) choice_.is_interlaced = true;
  }
  bool opened() const { return decoder_ != nullptr; }

  const std::vector<int64_t>& utimes() const override { return times_.utimes; }
  std::string why_no_times() const override { return times_.has_times ? "" : "the images of the video have no times"; }
  std::string where(size_t frame) const override { return fmt::format("{}: frame {}", file_, frame); }
  Result<image_t> load(size_t frame, bool colour) override {
    if (const Result<> decoded = go_to(frame); !decoded) return decoded.error();
    if (decoder_->is_damaged()) return Error{"is damaged (FFmpeg had to guess a part of it)", where(frame)};
    cv::Mat pixels = decoder_->pixels(colour);
    if (pixels.empty()) return Error{"its pixels are of a kind that cannot be converted", where(frame)};
    if (pixels.depth() == CV_16U) pixels = to_8_bit(pixels, range());
    return pixels.channels() == 1 ? make_grey_image(0, pixels) : make_rgb_image(0, pixels);
  }
  bool loads_any_frame_alone() const override { return false; }
  // Counts missing images only if the file ends early: some recorders leave out images that repeat the one before, and
  // still count them in the header.
  int64_t missing_at_end() const override {
    return are_fewer() && times_.ends_early ? times_.promised - times_.stored : 0;
  }
  std::vector<std::string> notes() const override {
    std::vector<std::string> notes = choice_.notes;
    if (choice_.is_interlaced)
      notes.push_back(
          "is interlaced: each image is of two moments, in turn row by row; `ffmpeg -i FILE -vf bwdif OTHER` makes "
          "images of one");
    if (are_fewer())
      notes.push_back(fmt::format("ends after {} of {}{} images that its header promises: the file {} cut off",
                                  times_.stored, times_.is_promise_by_length ? "about " : "", times_.promised,
                                  times_.ends_early ? "is" : "may be"));
    return notes;
  }

 private:
  bool are_fewer() const {
    constexpr double kTolerable = 0.95, kTolerableOfLength = 0.99;
    const double least = times_.is_promise_by_length ? kTolerableOfLength : kTolerable;
    return static_cast<double>(times_.stored) < least * static_cast<double>(times_.promised) - 1;
  }
  void begin() {
    decoder_ = VideoDecoder::open(file_, choice_.stream);
    is_at_.reset();
    next_ = 0;
  }

  // Decodes up to this frame. An Error if it cannot be decoded.
  Result<> go_to(size_t frame) {
    if (is_at_ && *is_at_ > frame && frame < begin_of_gap_) begin();
    while (decoder_ && (!is_at_ || *is_at_ < frame)) {
      if (!decoder_->next())
        return Error{fmt::format("it ends after {} of {} images: is it cut off?", next_, times_.utimes.size()), file_};
      begin_of_gap_ = next_;
      is_at_ = number_of_picture();
      next_ = *is_at_ + 1;
    }
    if (is_at_ != frame) return Error{"could not be decoded", where(frame)};
    return {};
  }

  // Returns the number of the picture that the decoder has now, by its time: pictures before it may be missing. Without
  // times, pictures are counted.
  size_t number_of_picture() const {
    const std::optional<int64_t> stamp = decoder_->stamp();
    const auto from = times_.stamps.begin() + static_cast<std::ptrdiff_t>(std::min(next_, times_.stamps.size()));
    const auto at = stamp ? std::find(from, times_.stamps.end(), *stamp) : times_.stamps.end();
    return at == times_.stamps.end() ? next_ : static_cast<size_t>(at - times_.stamps.begin());
  }

  GreyRange range() {
    if (range_) return *range_;
    GreyHistogram histogram;
    const size_t step = std::max<size_t>(1, times_.utimes.size() / GreyHistogram::kMostImages);
    const std::unique_ptr<VideoDecoder> decoder = VideoDecoder::open(file_, choice_.stream);
    for (size_t i = 0; decoder && decoder->next(); ++i)
      if (i % step == 0) histogram.add(decoder->pixels(/*colour=*/false));
    range_ = histogram.range();
    tell_grey_range(file_, *range_);
    return *range_;
  }

  std::string file_;
  VideoChoice choice_;
  VideoTimes times_;
  std::optional<GreyRange> range_;
  std::unique_ptr<VideoDecoder> decoder_;
  std::optional<size_t> is_at_;  // the picture that the decoder has
  size_t begin_of_gap_ = 0;      // frames from this one to is_at_ could not be decoded
  size_t next_ = 0;
};

}  // namespace

OpenedReader open_video(const std::filesystem::path& file, std::optional<GreyRange> grey_range,
                        const std::vector<cv::Size>& wanted) {
  auto reader = std::make_unique<VideoReader>(file.string(), grey_range, wanted);
  if (const std::string why = reader->opened() ? "" : why_no_video(file); !why.empty())
    return Error{why, file.string()};
  if (!reader->opened())
    return Error{"is neither an lcm log, a ROS bag nor a video that can be decoded", file.string(),
                 "give a dataset folder, an image folder, a video, an lcm log or a ROS bag"};
  return OpenedReader(std::move(reader));
}

}  // namespace rumi
