// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/mask_picture.h"

#include <opencv2/imgproc.hpp>

#include "bus/wire/image_masks.h"

namespace rumi::tool {
namespace {

constexpr double kTint = 0.6;
const cv::Scalar kRed(40, 40, 220);

}  // namespace

cv::Mat draw_mask(const std::string& png, const cv::Mat& image) {
  const cv::Mat world = decode_mask(png).value_or(cv::Mat());
  if (world.empty()) return {};
  cv::Mat picture, red;
  if (image.empty())
    cv::cvtColor(world, picture, cv::COLOR_GRAY2BGR);
  else
    cv::resize(image, picture, world.size(), 0, 0, cv::INTER_AREA);
  red.create(picture.size(), CV_8UC3);
  red = kRed;
  cv::addWeighted(picture, 1 - kTint, red, kTint, 0, red);
  red.copyTo(picture, world == 0);
  return picture;
}

}  // namespace rumi::tool
