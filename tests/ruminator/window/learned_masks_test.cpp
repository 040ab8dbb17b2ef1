// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/learned_masks.h"

#include <gtest/gtest.h>

#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"

namespace rumi::ruminator {
namespace {

// Returns a mask that masks the left `black` columns.
cv::Mat columns(int black, int width = 64, int height = 48) {
  cv::Mat world(height, width, CV_8U, cv::Scalar(255));
  world.colRange(0, black) = 0;
  return world;
}

mask_t message(const cv::Mat& world, int64_t stream = 5, int64_t utime_us = 100, int64_t session = 1) {
  mask_t mask{};
  mask.utime = utime_us;
  mask.stream = stream;
  mask.session = session;
  mask.width = world.cols, mask.height = world.rows;
  const std::string png = encode_mask(world);
  mask.png.assign(png.begin(), png.end());
  mask.size = static_cast<int32_t>(png.size());
  return mask;
}

image_t image(const cv::Mat& own_mask = {}, int width = 64, int height = 48) {
  image_t made = make_grey_image(1, cv::Mat(height, width, CV_8U, cv::Scalar(9)));
  if (!own_mask.empty()) set_metadata(&made, kMaskKey, encode_mask(own_mask));
  return made;
}

// Counts the columns that the image's mask masks.
int black_columns(const LearnedMasks& masks, const image_t& of, int64_t stream = 5) {
  std::vector<image_t> images = {of};
  masks.put_on(&images, stream);
  const std::string png(metadata(images[0], kMaskKey));
  if (png.empty()) return 0;
  const cv::Mat world = decode_mask(png).value();
  EXPECT_EQ(world.size(), cv::Size(images[0].width, images[0].height));
  return cv::countNonZero(world.row(0) == 0);
}

TEST(LearnedMasks, GoOnImagesOfTheirStreamOnly) {
  LearnedMasks masks;
  EXPECT_TRUE(masks.take(message(columns(9))));
  EXPECT_EQ(black_columns(masks, image()), 9);
  EXPECT_EQ(black_columns(masks, image(), 6), 0);
}

TEST(LearnedMasks, BlackStaysBlackInALargerImage) {
  LearnedMasks masks;
  EXPECT_TRUE(masks.take(message(columns(7, 32, 24))));
  const int black = black_columns(masks, image());
  EXPECT_GE(black, 14);
  EXPECT_LE(black, 15);
}

TEST(LearnedMasks, AreJoinedWithTheImagesOwn) {
  LearnedMasks masks;
  EXPECT_TRUE(masks.take(message(columns(9))));
  EXPECT_EQ(black_columns(masks, image(columns(4))), 9);
  EXPECT_EQ(black_columns(masks, image(columns(20))), 20);
  std::vector<image_t> images = {image(), image(columns(20)), image(), image({}, 32, 24)};
  masks.put_on(&images, 5);
  EXPECT_EQ(metadata(images[0], kMaskKey), metadata(images[2], kMaskKey));
  EXPECT_NE(metadata(images[0], kMaskKey), metadata(images[1], kMaskKey));
  EXPECT_EQ(size_of_mask(metadata(images[3], kMaskKey)), cv::Size(32, 24));
}

TEST(LearnedMasks, TheNewestCountsAndMayBeEmpty) {
  LearnedMasks masks;
  EXPECT_TRUE(masks.take(message(columns(9), 5, 200)));
  EXPECT_TRUE(masks.take(message(columns(3), 5, 100))) << "late";
  EXPECT_EQ(black_columns(masks, image()), 9);
  EXPECT_TRUE(masks.take(message(columns(4), 5, 50, 2))) << "of the next session";
  EXPECT_EQ(black_columns(masks, image()), 4);
  mask_t nothing = message(columns(0), 5, 300, 2);
  nothing.png.clear();
  nothing.size = 0;
  EXPECT_TRUE(masks.take(nothing));
  EXPECT_EQ(black_columns(masks, image()), 0);
  EXPECT_EQ(black_columns(masks, image(columns(6))), 6) << "its own stays";
}

TEST(LearnedMasks, WhatCannotBeUsedIsRefusedAndChangesNothing) {
  LearnedMasks masks;
  const mask_t good = message(columns(9));
  EXPECT_TRUE(masks.take(good));
  const auto is_refused = [&](auto&& spoil) {
    mask_t bad = message(columns(12), 5, 900, 9);
    spoil(&bad);
    EXPECT_EQ(black_columns(masks, image()), 9);
    return !masks.take(bad);
  };
  EXPECT_TRUE(is_refused([](mask_t* m) { m->stream = 0; }));
  EXPECT_TRUE(is_refused([](mask_t* m) { m->session = 0; }));
  EXPECT_TRUE(is_refused([](mask_t* m) { m->utime = -1; }));
  EXPECT_TRUE(is_refused([](mask_t* m) { m->width = 63; })) << "not that of the PNG";
  EXPECT_TRUE(is_refused([](mask_t* m) { m->height = 0; }));
  EXPECT_TRUE(is_refused([](mask_t* m) { m->width = 1 << 20; }));
  EXPECT_TRUE(is_refused([](mask_t* m) { m->png.resize(40); }));
  EXPECT_TRUE(is_refused([](mask_t* m) { m->png.assign(100, 0); }));
  EXPECT_EQ(black_columns(masks, image()), 9);
}

TEST(LearnedMasks, OfManyStreamsTheNewestAreKept) {
  LearnedMasks masks;
  for (int64_t stream = 1; stream <= 100; ++stream) EXPECT_TRUE(masks.take(message(columns(9), stream, 1, stream)));
  EXPECT_LE(masks.streams(), 8U);
  EXPECT_EQ(black_columns(masks, image(), 100), 9);
  EXPECT_EQ(black_columns(masks, image(), 1), 0);
}

// A hostile mask: its only black pixel disappears when it is reduced to a small image.
TEST(LearnedMasks, OneThatIsLostInASmallImageIsNone) {
  LearnedMasks masks;
  cv::Mat world(2048, 2048, CV_8U, cv::Scalar(255));
  world.at<uchar>(1000, 1000) = 0;
  EXPECT_TRUE(masks.take(message(world)));
  EXPECT_EQ(black_columns(masks, image({}, 20, 20)), 0);
}

}  // namespace
}  // namespace rumi::ruminator
