// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "viewer_offscreen/draw_map.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

bool is_numbered(const fs::path& file) {
  const std::string stem = file.stem().string();
  return file.extension() == ".png" && stem.size() >= 6 &&
         std::all_of(stem.begin(), stem.end(), [](unsigned char c) { return std::isdigit(c); });
}

}  // namespace

PictureSeries::PictureSeries(std::string folder, double fps) : folder_(std::move(folder)), fps_(fps) {}

std::string PictureSeries::begin(cv::Size size) {
  const fs::path pictures = fs::path(folder_) / "pictures";
  std::error_code error;
  // The folder itself is the user's to make.
  if (!fs::create_directory(pictures, error) && error)
    return fmt::format("{}: cannot be made: {}", pictures.string(), error.message());
  for (fs::directory_iterator it(pictures, error), end; !error && it != end; it.increment(error))
    if (is_numbered(it->path())) fs::remove(it->path(), error);
  if (error) return fmt::format("{}: {}", pictures.string(), error.message());
  begun_ = true;
  const std::string file = (fs::path(folder_) / "trajectory.mp4").string();
  // H.264 plays everywhere but needs an encoder that not every ffmpeg has.
  for (const char* codec : {"avc1", "mp4v"})
    if (!video_.isOpened())
      video_.open(file, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), fps_, size);
  if (!video_.isOpened())
    video_error_ = fmt::format("{}: cannot be written: OpenCV here has no encoder for it; the pictures are in {}", file,
                               pictures.string());
  return {};
}

std::string PictureSeries::add(const cv::Mat& picture) {
  if (!begun_)
    if (std::string error = begin(picture.size()); !error.empty()) return error;
  const std::string name = fmt::format("{:06}.png", size_ + 1);
  if (std::string error = write_png(picture, (fs::path(folder_) / "pictures" / name).string()); !error.empty())
    return error;
  ++size_;
  if (video_.isOpened()) video_.write(picture);
  return video_error_;
}

}  // namespace rumi
