// SPDX-License-Identifier: BSD-3-Clause
// A frame as a camera's driver delivers it. Byte 0 chooses the format and whether colour is wanted, bytes 1 to 3 are
// width, height and stride, and the frame follows.
#include "camera_driver/v4l2/pixel_format.h"
#include "fuzz/good_messages.h"

namespace rumi::fuzz {
namespace {

using namespace camera_driver;

constexpr size_t kHeaderBytes = 4;

void run(View input) {
  if (input.size() < kHeaderBytes) return;
  const std::vector<PixelFormat>& formats = pixel_formats();
  const PixelFormat& format = formats[(input[0] >> 1) % formats.size()];
  const RawImage raw{.data = input.subspan(kHeaderBytes), .width = input[1], .height = input[2], .stride = input[3]};
  // The frame may be refused; the code must only not crash.
  if (format.layout == PixelLayout::kJpeg)
    (void)jpeg_image(raw);
  else
    (void)to_pixels(format, raw, input[0] % 2 != 0);
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (size_t i = 0; i < pixel_formats().size(); ++i) {
    Bytes& bytes = all.emplace_back(Bytes{static_cast<uint8_t>(2 * i + 1), 8, 6, 24});
    bytes.resize(bytes.size() + 24 * 6, 77);
  }
  Bytes& jpeg = all.emplace_back(Bytes{static_cast<uint8_t>(2 * (pixel_formats().size() - 1)), kWidth, kHeight, 0});
  const image_t image = good_jpeg(1);
  jpeg.insert(jpeg.end(), image.data.begin(), image.data.end());
  return all;
}

const Registered registered({"pixel_format", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
