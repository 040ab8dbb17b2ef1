// SPDX-License-Identifier: BSD-3-Clause
// Opens recordings for tests: returns their images, or why they cannot be played.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "bus/wire/image_stream.h"
#include "camera_driver/open_source.h"
#include "camera_driver/source/image_source.h"
#include "tests/formats/recording.h"

namespace rumi::testing {
using namespace rumi::camera_driver;

inline std::vector<int64_t> times(ImageSource& source, size_t most = 1000) {
  std::vector<int64_t> all;
  while (all.size() < most) {
    const std::optional<image_t> image = source.next();
    if (!image) break;
    all.push_back(image->utime);
  }
  return all;
}

inline std::vector<int64_t> times(const fs::path& input, const CameraOptions& options = {}, size_t most = 1000) {
  const OpenedSource opened = open_image_source(input.string(), options);
  EXPECT_EQ(opened.error_text(), "");
  return opened.has_value() ? times(**opened, most) : std::vector<int64_t>();
}

inline std::string error_of(const fs::path& input, const CameraOptions& options = {}) {
  const OpenedSource opened = open_image_source(input.string(), options);
  EXPECT_FALSE(opened.has_value());
  return opened.error_text();
}

inline int64_t stream_of(const fs::path& input, const CameraOptions& options = {}) {
  const OpenedSource opened = open_image_source(input.string(), options);
  EXPECT_EQ(opened.error_text(), "");
  const std::optional<image_t> image = (*opened)->next();
  const int64_t stream = rumi::stream_of(*image);
  while (const std::optional<image_t> later = (*opened)->next()) EXPECT_EQ(rumi::stream_of(*later), stream);
  return stream;
}

}  // namespace rumi::testing
