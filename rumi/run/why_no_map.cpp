// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/why_no_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

constexpr int kLooks = 8;
constexpr double kFlat = 3;     // grey values: an image with a smaller standard deviation shows nothing
constexpr double kBlurred = 1;  // grey values: an image with a smaller standard deviation of its Laplacian is blurred
constexpr double kDark = 16, kBright = 239;  // mean grey values of an image that is black or white

struct Look {
  double mean = 0, deviation = 0, detail = 0;
};

std::vector<Look> look_at(camera_driver::ImageSource& source) {
  std::vector<Look> looks;
  const int64_t step = std::max<int64_t>(1, source.total() / kLooks);
  for (int64_t i = 0; const std::optional<image_t> image = source.next(); ++i) {
    const cv::Mat grey = i % step == 0 ? decode_grey(*image).value_or(cv::Mat()) : cv::Mat();
    if (grey.empty()) continue;
    cv::Scalar mean, deviation, of_detail, detail;
    cv::meanStdDev(grey, mean, deviation);
    cv::Mat edges;
    cv::Laplacian(grey, edges, CV_16S);
    cv::meanStdDev(edges, of_detail, detail);
    looks.push_back({mean[0], deviation[0], detail[0]});
  }
  return looks;
}

}  // namespace

std::string why_no_map(const std::string& recording, const camera_driver::CameraOptions& options) {
  const std::string nothing = "no image has a pose: ";
  const camera_driver::OpenedSource opened = camera_driver::open_recording(recording, options);
  if (!opened) return nothing + opened.error_text();
  const Camera& camera = (*opened)->camera();
  if (const std::string few = camera_driver::too_few_pixels(camera.width, camera.height); !few.empty())
    return nothing + few;
  constexpr int64_t kLeastImages = 3;
  if (const int64_t images = (*opened)->total(); images > 0 && images < kLeastImages)
    return fmt::format("{}{} {}: a map needs at least {}, from different places", nothing, images,
                       images == 1 ? "image" : "images", kLeastImages);
  const std::vector<Look> looks = look_at(**opened);
  if (looks.empty()) return nothing + "none can be decoded";
  const auto of_all = [&looks](double Look::*member) {
    std::vector<double> values;
    values.reserve(looks.size());
    for (const Look& look : looks) values.push_back(look.*member);
    return median(&values);
  };
  const double mean = of_all(&Look::mean), deviation = of_all(&Look::deviation), detail = of_all(&Look::detail);
  if (deviation < kFlat) {
    const char* look = mean < kDark     ? "black: is the lens covered, or the exposure too short?"
                       : mean > kBright ? "white: is the exposure too long?"
                                        : "of one grey: is something before the lens?";
    return fmt::format("{}the images are {} (mean {:.0f}, standard deviation {:.1f})", nothing, look, mean, deviation);
  }
  if (detail < kBlurred) return fmt::format("{}the images show nothing sharp: is the lens out of focus?", nothing);
  return nothing +
         "a map begins where the camera moves sideways by some hundredths of the distance of what it sees; a camera "
         "that "
         "stands or only turns, or a calibration of another camera, gives none";
}

}  // namespace rumi::tool
