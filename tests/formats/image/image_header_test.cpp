// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/image_header.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "formats/image/image_file.h"
#include "tests/formats/recording.h"

namespace rumi {
namespace {

using namespace testing;
using ::testing::HasSubstr;

std::vector<uint8_t> encoded(const std::string& ending, bool colour) {
  std::vector<uint8_t> bytes;
  cv::imencode(ending, picture(1, 30, 20, colour), bytes);
  return bytes;
}

TEST(ImageHeader, TellsTheSizeOfEveryFormat) {
  for (const std::string ending : {".png", ".bmp", ".tiff", ".pgm", ".ppm", ".webp"}) {
    const std::vector<uint8_t> bytes = encoded(ending, ending != ".pgm");
    const std::optional<HeaderSize> size = size_in_header(bytes);
    ASSERT_TRUE(size) << ending;
    EXPECT_EQ(size->width, 30) << ending;
    EXPECT_EQ(size->height, 20) << ending;
    for (size_t i = 0; i < std::min<size_t>(bytes.size(), 40); ++i) size_in_header({bytes.data(), i});
  }
  const std::string comment = "P5 # 7 7\n 30\n20 255\n";
  EXPECT_EQ(size_in_header({reinterpret_cast<const uint8_t*>(comment.data()), comment.size()})->width, 30);
  EXPECT_FALSE(size_in_header(encoded(".jpg", true)));
}

// libtiff looks for a width of 64 bits elsewhere in the file, where it may have any value.
TEST(ImageHeader, ATiffWithASizeOfAnotherTypeIsRefused) {
  std::vector<uint8_t> tiff = encoded(".tiff", true);
  const uint8_t width[] = {0, 1, 3, 0};  // its tag and type
  const auto at = std::search(tiff.begin(), tiff.end(), std::begin(width), std::end(width));
  ASSERT_NE(at, tiff.end());
  ASSERT_TRUE(size_in_header(tiff));
  at[2] = 16;
  EXPECT_FALSE(size_in_header(tiff));
}

// OpenCV would allocate memory for it before it finds that there are no pixels.
TEST(ImageHeader, AnImageOfGigabytesIsRefusedByItsHeader) {
  const TemporaryFolder folder;
  write_file(folder.path() / "a.ppm", "P6\n32000 32000\n255\n" + std::string(900, 'x'));
  EXPECT_THAT(load_image_file(folder.path() / "a.ppm", true, [] { return GreyRange(); }).error_text(),
              HasSubstr("32000 x 32000"));
}

}  // namespace
}  // namespace rumi
