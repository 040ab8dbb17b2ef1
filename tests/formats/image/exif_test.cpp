// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/exif.h"

#include <gtest/gtest.h>

#include <string>

namespace rumi {
namespace {

using namespace std::string_literals;

int orientation(const std::string& jpeg) {
  return exif_orientation({reinterpret_cast<const uint8_t*>(jpeg.data()), jpeg.size()});
}

const std::string kLittle = "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0"s;
const std::string kBig = "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0"s;

std::string jpeg_with(const std::string& exif) {
  const std::string jfif =
      "\xFF\xE0\0\x04"
      "ab"s;
  return "\xFF\xD8"s + jfif + "\xFF\xE1\0"s + static_cast<char>(exif.size() + 2) + exif + "\xFF\xDA\0\x02"s;
}

TEST(Exif, SaysHowTheCameraWasHeld) {
  EXPECT_EQ(orientation(jpeg_with(kLittle)), 6);
  EXPECT_EQ(orientation(jpeg_with(kBig)), 3);
}

TEST(Exif, IsNotThereOrDamaged) {
  EXPECT_EQ(orientation(""), 1);
  EXPECT_EQ(orientation("\xFF\xD8\xFF\xDA\0\x02"s), 1);
  EXPECT_EQ(orientation(jpeg_with("other"s)), 1);
  const std::string whole = jpeg_with(kLittle);
  const size_t end = whole.find(kLittle) + kLittle.size();
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_EQ(orientation(whole.substr(0, size)), size < end ? 1 : 6) << size;
  std::string far = kLittle;
  far.replace(10, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_EQ(orientation(jpeg_with(far)), 1);
}

}  // namespace
}  // namespace rumi
