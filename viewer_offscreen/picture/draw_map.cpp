// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/draw_map.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "base/this_process/account_limits.h"
#include "viewer_offscreen/picture/renderer.h"

namespace rumi::viewer_offscreen {

cv::Mat draw_map(const MapPicture& picture, std::optional<ViewKind> only) {
  return Renderer().draw(make_scene(picture), only);
}

std::vector<uint8_t> encode_png(const cv::Mat& picture) {
  std::vector<uint8_t> png;
  cv::imencode(".png", picture, png);
  return png;
}

Result<> write_png(const cv::Mat& picture, const std::string& file) {
  const std::vector<uint8_t> png = encode_png(picture);
  const std::string unfinished = file + ".part";
  std::ofstream out(unfinished, std::ios::binary);
  out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  out.close();
  if (!out || std::rename(unfinished.c_str(), file.c_str()) != 0) {
    const std::string reason = write_error_text(errno);
    std::remove(unfinished.c_str());
    return Error{.what = "cannot be written: " + reason, .where = file};
  }
  return {};
}

}  // namespace rumi::viewer_offscreen
