// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_stream.h"

#include <gtest/gtest.h>

#include "bus/wire/image_codec.h"

namespace rumi {
namespace {

TEST(ImageStream, IsWhatWasSet) {
  image_t image;
  image.nmetadata = 0;
  EXPECT_EQ(stream_of(image), kNoStream);
  for (const int64_t stream : {int64_t{1}, int64_t{42}, INT64_MAX}) {
    set_stream(stream, &image);
    EXPECT_EQ(stream_of(image), stream);
  }
  EXPECT_EQ(image.nmetadata, 1);
}

TEST(ImageStream, WhatIsNoNumberNamesNone) {
  image_t image;
  image.nmetadata = 0;
  for (const char* text : {"", "0", "-5", "front camera", "12 ", "0x10", "9223372036854775808"}) {
    set_metadata(&image, kStreamKey, text);
    EXPECT_EQ(stream_of(image), kNoStream) << text;
  }
}

}  // namespace
}  // namespace rumi
