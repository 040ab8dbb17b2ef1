// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/draw_map.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <png.h>

#include "base/this_process/account_limits.h"
#include "viewer_offscreen/picture/renderer.h"

namespace rumi::viewer_offscreen {

cv::Mat draw_map(const MapPicture& picture, std::optional<ViewKind> only) {
  return Renderer().draw(make_scene(picture), only);
}

std::vector<uint8_t> encode_png(const cv::Mat& picture) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(picture.cols);
  png.height = static_cast<png_uint_32>(picture.rows);
  png.format = PNG_FORMAT_BGR;
  png.flags = PNG_IMAGE_FLAG_FAST;  // drawn again and again, and hardly larger
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<uint8_t> bytes(size);
  const int stride = static_cast<int>(picture.step[0]);
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, picture.data, stride, nullptr))
    throw std::runtime_error(std::string("a picture cannot be encoded: ") + png.message);
  bytes.resize(size);
  return bytes;
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
