// SPDX-License-Identifier: BSD-3-Clause
// An image file of a recording. Byte 0 chooses whether its colour is wanted.
#include <opencv2/imgcodecs.hpp>

#include "formats/image/image_file.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"

namespace rumi::fuzz {
namespace {

void run(View input) {
  if (input.empty()) return;
  // The image may be refused; the code must only not crash.
  (void)load_image_file(scratch().write("image", input.subspan(1)), input[0] % 2 != 0, [] { return GreyRange(); });
}

std::vector<Bytes> seeds() {
  const cv::Mat colour(6, 8, CV_8UC3, cv::Scalar(10, 200, 30));
  std::vector<Bytes> all;
  for (const char* ending : {".png", ".jpg", ".bmp", ".tiff", ".pgm", ".ppm", ".webp"}) {
    Bytes& bytes = all.emplace_back();
    cv::imencode(ending, std::string(ending) == ".pgm" ? cv::Mat(6, 8, CV_8UC1, cv::Scalar(9)) : colour, bytes);
    bytes.insert(bytes.begin(), 1);
  }
  return all;
}

const Registered registered({"image_file", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
