// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/camera_info.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace rumi {

std::string camera_info_text(const RosCameraInfo& info, bool is_rectified) {
  nlohmann::json out = {
      {"width", info.width},
      {"height", info.height},
      {"distortion_model", info.distortion_model},
      {"d", info.d},
      {"k", info.k},
      {"r", info.r},
      {"p", info.p},
      {"binning_x", info.binning_x},
      {"binning_y", info.binning_y},
      {"roi",
       {{"x_offset", info.roi_x}, {"y_offset", info.roi_y}, {"width", info.roi_width}, {"height", info.roi_height}}}};
  if (is_rectified) {
    const std::array<double, 12>& p = info.p;
    out["k"] = {p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]};
    out["distortion_model"] = "plumb_bob";
    out["d"] = {0, 0, 0, 0, 0};
  }
  return out.dump(-1, ' ', /*ensure_ascii=*/true, nlohmann::json::error_handler_t::replace);
}

bool is_calibrated(const RosCameraInfo& info, bool is_rectified) {
  const auto is_given = [](double value) { return value != 0; };
  return is_rectified ? std::any_of(info.p.begin(), info.p.end(), is_given)
                      : std::any_of(info.k.begin(), info.k.end(), is_given);
}

bool is_nominal_kinect(const RosCameraInfo& info) {
  static constexpr std::array<double, 9> kNominal = {525, 0, 319.5, 0, 525, 239.5, 0, 0, 1};
  return info.k == kNominal;
}

bool is_rectified_topic(const std::string& topic) { return topic.find("image_rect") != std::string::npos; }

}  // namespace rumi
