// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_images.h"

#include <gtest/gtest.h>

#include "bus/wire/image_codec.h"
#include "bus/wire/working_image.h"
#include "tests/ruminator/test_jobs.h"

namespace rumi::ruminator {
namespace {

using testing::small_job;

TEST(WindowImages, EachImageIsDecodedOnceWhenItIsAskedFor) {
  const WindowJob job = small_job();
  WindowImages images(job, job.camera, 100);
  EXPECT_EQ(images.size(), job.images.size());
  EXPECT_EQ(images.decoded(), 0);
  const SiftFeatures* const first = images.features(3);
  ASSERT_TRUE(first);
  for (size_t i = 0; i < images.size(); ++i) images.features(i);
  EXPECT_EQ(images.features(3), first);
  EXPECT_EQ(images.decoded(), static_cast<int>(job.images.size()));
}

TEST(WindowImages, TheOrderOfTheQuestionsChangesNothing) {
  const WindowJob job = small_job();
  WindowImages forth(job, job.camera, 100), back(job, job.camera, 100);
  for (size_t i = 0; i < job.images.size(); ++i) {
    forth.features(i);
    back.features(job.images.size() - 1 - i);
  }
  const UsableImages a = forth.take(), b = back.take();
  EXPECT_EQ(a.utimes_us, b.utimes_us);
  ASSERT_EQ(a.features.size(), job.images.size());
  for (size_t i = 0; i < a.features.size(); ++i) {
    EXPECT_EQ(a.features[i].undistorted, b.features[i].undistorted);
    EXPECT_EQ(a.features[i].descriptors, b.features[i].descriptors);
    EXPECT_EQ(a.colmap[i].keypoints, a.features[i].undistorted);
    EXPECT_EQ(a.seen[i].utime_us, job.images[i].utime);
  }
}

TEST(WindowImages, ABrokenImageIsLeftOut) {
  WindowJob job = small_job();
  job.images[2].data.assign(10, 0);
  job.images[2].size = 10;
  WindowImages images(job, job.camera, 100);
  for (size_t i = 0; i < images.size(); ++i) EXPECT_EQ(images.features(i) == nullptr, i == 2) << i;
  EXPECT_EQ(images.take().seen.size(), job.images.size() - 1);
}

TEST(WindowImages, NoKeypointsWhereAMaskLeavesSomethingOut) {
  WindowJob job = small_job();
  cv::Mat world(120, 160, CV_8U, cv::Scalar(255));
  world.colRange(0, 80) = 0;
  for (image_t& image : job.images) set_metadata(&image, kMaskKey, encode_mask(world));
  WindowImages images(job, job.camera, 300);
  const SiftFeatures* const features = images.features(0);
  ASSERT_TRUE(features);
  EXPECT_GT(features->size(), 20U);
  for (const Eigen::Vector2f& pixel : features->undistorted) EXPECT_GE(pixel.x(), 79);
}

TEST(WindowImages, LargeImagesAreMadeSmaller) {
  const WindowJob job = small_job();
  const Camera working = working_camera(job.camera, 80);
  WindowImages images(job, working, 100);
  images.features(0);
  const UsableImages usable = images.take();
  ASSERT_EQ(usable.seen.size(), 1U);
  EXPECT_EQ(usable.seen[0].grey.size(), cv::Size(80, 60));
}

}  // namespace
}  // namespace rumi::ruminator
