// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/working_image.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"

namespace rumi {
namespace {

using ::testing::HasSubstr;

Camera camera_of(int width, int height) {
  Camera c;
  c.width = width, c.height = height;
  c.fx = 0.8 * width, c.fy = 0.82 * width, c.cx = 0.49 * width, c.cy = 0.51 * height;
  c.k1 = -0.1;
  return c;
}

TEST(WorkingImage, ASmallCameraStaysWhatItIs) {
  for (const int max_side : {0, 640, 960}) {
    const Camera working = working_camera(camera_of(640, 480), max_side);
    EXPECT_EQ(working.width, 640);
    EXPECT_EQ(working.fx, camera_of(640, 480).fx);
  }
  EXPECT_EQ(working_camera(camera_of(4000, 3000), 0).width, 4000) << "0: no limit";
}

TEST(WorkingImage, TheLongerSideCounts) {
  const Camera wide = working_camera(camera_of(1920, 1080), 960), tall = working_camera(camera_of(1080, 1920), 960);
  EXPECT_EQ(wide.width, 960);
  EXPECT_EQ(wide.height, 540);
  EXPECT_EQ(tall.width, 540);
  EXPECT_EQ(tall.height, 960);
}

// The full camera sees a blob along some ray: along the same ray the working camera must see it in the smaller image.
TEST(WorkingImage, CameraAndImageGoTogether) {
  struct Case {
    int width, height, max_side;
  };
  for (const Case& c : {Case{1920, 1080, 960}, {1280, 720, 960}, {1241, 376, 960}, {2560, 1920, 640}}) {
    SCOPED_TRACE(std::to_string(c.width) + "x" + std::to_string(c.height));
    const Camera camera = camera_of(c.width, c.height), working = working_camera(camera, c.max_side);
    const cv::Point at(c.width / 5, c.height - 40);
    cv::Mat picture(c.height, c.width, CV_8U, cv::Scalar(0));
    cv::circle(picture, at, 12, cv::Scalar(255), cv::FILLED, cv::LINE_AA);
    for (const image_t& message : {make_grey_image(1, picture), make_jpeg_image(1, picture, 98)}) {
      const cv::Mat seen = decode_working_image(message, camera, working).value();
      ASSERT_EQ(seen.size(), cv::Size(working.width, working.height));
      cv::Mat blob;
      cv::threshold(seen, blob, 30, 255, cv::THRESH_TOZERO);
      const cv::Moments m = cv::moments(blob);
      const Eigen::Vector2d pixel(m.m10 / m.m00, m.m01 / m.m00);
      const Eigen::Vector3d ray = camera.unproject({static_cast<double>(at.x), static_cast<double>(at.y)});
      EXPECT_LT((*working.project(ray) - pixel).norm(), 0.05);
    }
  }
}

TEST(WorkingImage, TellsWhatIsWrong) {
  const Camera camera = camera_of(1280, 720), working = working_camera(camera, 640);
  const image_t other = make_grey_image(1, cv::Mat::zeros(480, 640, CV_8U));
  const std::string error = decode_working_image(other, camera, working).error_text();
  EXPECT_THAT(error, HasSubstr("640x480"));
  EXPECT_THAT(error, HasSubstr("1280x720"));
  image_t cut = make_jpeg_image(1, cv::Mat::zeros(720, 1280, CV_8U));
  cut.data.resize(cut.data.size() / 2);
  cut.size = static_cast<int32_t>(cut.data.size());
  EXPECT_FALSE(decode_working_image(cut, camera, working));
}

}  // namespace
}  // namespace rumi
