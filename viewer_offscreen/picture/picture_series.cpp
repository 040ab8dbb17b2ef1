// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/picture_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>

#include "base/running/log.h"
#include "viewer_offscreen/picture/draw_map.h"

namespace rumi::viewer_offscreen {
namespace {

namespace fs = std::filesystem;

// Returns the number of a picture of a series; nullopt for other files.
std::optional<int64_t> number_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  const char* end = stem.data() + stem.size();
  int64_t number = 0;
  const auto [rest, error] = std::from_chars(stem.data(), end, number);
  if (file.extension() != ".png" || stem.size() < 6 || error != std::errc() || rest != end || number < 1) return {};
  return number;
}

}  // namespace

PictureSeries::PictureSeries(std::string folder, double fps, bool goes_on)
    : pictures_(fs::path(folder) / "pictures"),
      video_file_(fs::path(folder) / "trajectory.mp4"),
      unfinished_(fs::path(pictures_) / "unfinished"),
      fps_(fps),
      goes_on_(goes_on) {}

Result<> PictureSeries::take_over_or_remove() {
  std::error_code error;
  const bool take_over = goes_on_ && fs::exists(unfinished_, error);
  size_ = 0;
  for (fs::directory_iterator it(pictures_, error), end; !error && it != end; it.increment(error)) {
    const std::optional<int64_t> number = number_of(it->path());
    if (number && take_over) size_ = std::max(size_, *number);
    if (number && !take_over) fs::remove(it->path(), error);
  }
  if (error) return Error{.what = error.message(), .where = pictures_};
  if (size_ > 0) log_info("{}: going on after {} pictures of a series that was not ended", pictures_, size_);
  return {};
}

Result<> PictureSeries::begin(cv::Size size) {
  std::error_code error;
  // Does not make FOLDER: that is for the user to do.
  if (!fs::create_directory(pictures_, error) && error)
    return Error{.what = "cannot be made: " + error.message(), .where = pictures_};
  if (const Result<> cleared = take_over_or_remove(); !cleared) return cleared;
  if (!std::ofstream(unfinished_)) return Error{.what = "cannot be written", .where = unfinished_};
  begun_ = true;
  // H.264 plays everywhere but needs an encoder that not every ffmpeg has.
  for (const char* codec : {"avc1", "mp4v"})
    if (!video_.isOpened())
      video_.open(video_file_, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), fps_,
                  size);
  if (!video_.isOpened())
    video_is_open_ = Error{.what = "cannot be written: OpenCV here has no encoder for it",
                           .where = video_file_,
                           .remedy = "the pictures are in " + pictures_};
  return {};
}

Result<> PictureSeries::add(const cv::Mat& picture) {
  if (!begun_)
    if (const Result<> begun = begin(picture.size()); !begun) return begun;
  const std::string name = fmt::format("{:06}.png", size_ + 1);
  if (const Result<> written = write_png(picture, fs::path(pictures_) / name); !written) return written;
  ++size_;
  if (video_.isOpened()) video_.write(picture);
  return video_is_open_;
}

void PictureSeries::finish() {
  video_.release();
  std::error_code ignored;
  if (begun_) fs::remove(unfinished_, ignored);
}

}  // namespace rumi::viewer_offscreen
