// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/again/image_similarity.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace rumi::ruminator {
namespace {

// A long wall of random discs.
cv::Mat wall(int seed) {
  cv::Mat wall(360, 2400, CV_8U, cv::Scalar(128));
  cv::RNG rng(seed);
  for (int i = 0; i < 1500; ++i)
    cv::circle(wall, {rng.uniform(0, wall.cols), rng.uniform(0, wall.rows)}, rng.uniform(3, 18),
               cv::Scalar(rng.uniform(0, 256)), cv::FILLED);
  cv::GaussianBlur(wall, wall, {}, 1);
  return wall;
}

Camera camera() {
  Camera camera;
  camera.width = 480, camera.height = 360;
  camera.fx = camera.fy = 400, camera.cx = 240, camera.cy = 180;
  return camera;
}

ImageSimilarity index_of_walk() {
  ImageSimilarity index;
  const cv::Mat wall = rumi::ruminator::wall(3);
  for (int x = 0; x + 480 <= wall.cols; x += 120) EXPECT_TRUE(index.add(wall(cv::Rect(x, 0, 480, 360)), camera(), {}));
  index.build();
  return index;
}

TEST(ImageSimilarity, NeighboursLookAlikeMoreThanStrangers) {
  const ImageSimilarity index = index_of_walk();
  ASSERT_EQ(index.size(), 17u);
  for (size_t i = 0; i + 1 < index.size(); ++i) {
    EXPECT_NEAR(index.similarity(i, i), 1, 1e-4);
    for (size_t j = 0; j < index.size(); ++j) {
      if (j > i + 5 || j + 5 < i) EXPECT_GT(index.similarity(i, i + 1), index.similarity(i, j) + 0.1) << i << " " << j;
    }
  }
}

TEST(ImageSimilarity, IsTheSameWheneverItIsBuilt) {
  const ImageSimilarity first = index_of_walk(), second = index_of_walk();
  for (size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first.similarity(0, i), second.similarity(0, i));
}

TEST(ImageSimilarity, DoesNotTakeImagesThatShowNothing) {
  ImageSimilarity index;
  EXPECT_FALSE(index.add(cv::Mat(360, 480, CV_8U, cv::Scalar(90)), camera(), {}));
  EXPECT_EQ(index.size(), 0u);
  index.build();
}

}  // namespace
}  // namespace rumi::ruminator
