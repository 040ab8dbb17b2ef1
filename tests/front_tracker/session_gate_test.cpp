// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/session_gate.h"

#include <gmock/gmock.h>

#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"

namespace rumi::front_tracker {
namespace {

using ::testing::HasSubstr;
using What = SessionGate::Decision::What;
using Kind = RefusedImages::Kind;

constexpr int64_t kNow_us = 1'700'000'000'000'000, kPeriod_us = 33'333;

Camera camera_with(double fx) {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = fx;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

// Images come at 30 Hz, with times of a correct clock. The test acts on a decision as FrontTrackerNode does.
class SessionGateTest : public ::testing::Test {
 protected:
  ArrivedImage image(int64_t stream, int64_t behind_us = 0) {
    ArrivedImage arrived;
    arrived.arrived_us = kNow_us + kPeriod_us * come_++;
    arrived.image.utime = arrived.arrived_us - behind_us;
    arrived.image.width = 640;
    arrived.image.height = 480;
    if (stream != kNoStream) set_stream(stream, &arrived.image);
    return arrived;
  }
  What come(const ArrivedImage& arrived) {
    const SessionGate::Decision decision = gate_.judge(arrived);
    if (!decision.why_session_ends.empty()) {
      is_open_ = false;
      ended_ = decision.why_session_ends;
    }
    if (decision.what == What::kTrack) {
      if (!std::exchange(is_open_, true)) {
        ++sessions_;
        gate_.begin_session(*decision.camera, arrived.image, stream_of(arrived.image));
      }
      gate_.take(arrived);
      ++tracked_;
    }
    for (const ArrivedImage& again : decision.next) come(again);
    return decision.what;
  }
  void come_in_a_row(int count, int64_t stream, int64_t behind_us = 0) {
    for (int i = 0; i < count; ++i) EXPECT_EQ(come(image(stream, behind_us)), What::kWaits) << i;
  }

  SessionGate gate_{camera_with(500)};
  int64_t come_ = 0;
  bool is_open_ = false;
  int sessions_ = 0, tracked_ = 0;
  std::string ended_;
};

TEST_F(SessionGateTest, ImagesThatGoOnAreTracked) {
  EXPECT_EQ(come(image(1)), What::kTrack);
  EXPECT_EQ(come(image(1)), What::kTrack);
  EXPECT_EQ(come(image(kNoStream)), What::kTrack) << "it does not name its stream";
  EXPECT_EQ(sessions_, 1);
  EXPECT_EQ(gate_.problem(), "");
}

TEST_F(SessionGateTest, TenOfAnotherStreamBeginASession) {
  come(image(1));
  come_in_a_row(9, 2);
  EXPECT_EQ(gate_.refused().of(Kind::kOtherCamera), 9);
  EXPECT_EQ(come(image(2)), What::kRetake);
  EXPECT_EQ(ended_, "the images are of another camera or recording");
  EXPECT_EQ(sessions_, 2);
  EXPECT_EQ(tracked_, 11) << "those that waited too";
  EXPECT_EQ(gate_.refused().total(), 0);
}

TEST_F(SessionGateTest, ASecondCameraIsRefused) {
  come(image(1));
  for (int i = 0; i < 3; ++i) {
    come_in_a_row(9, 2);
    EXPECT_EQ(come(image(1)), What::kTrack);
  }
  EXPECT_EQ(sessions_, 1);
  EXPECT_EQ(gate_.refused().of(Kind::kOtherCamera), 27);
}

TEST_F(SessionGateTest, TenThatAreOlderBeginASession) {
  constexpr int64_t kHour_us = 3'600'000'000;
  come(image(1));
  come_in_a_row(9, 1, kHour_us);
  EXPECT_EQ(come(image(1, kHour_us)), What::kRetake);
  EXPECT_THAT(ended_, HasSubstr("the camera's time went back by 3599.967 s"));
  EXPECT_EQ(tracked_, 11);
  EXPECT_EQ(sessions_, 2);
}

TEST_F(SessionGateTest, AnImageTwiceIsRefused) {
  ArrivedImage first = image(1);
  come(first);
  first.arrived_us += kPeriod_us;
  EXPECT_EQ(come(first), What::kRefused);
  EXPECT_EQ(gate_.refused().of(Kind::kDoubled), 1);
  EXPECT_THAT(gate_.problem(), HasSubstr("is that of the image before"));
  come(image(1));
  EXPECT_EQ(gate_.problem(), "");
}

TEST_F(SessionGateTest, AnImageOfAnotherSizeIsRefused) {
  ArrivedImage small = image(1);
  small.image.width = 320;
  EXPECT_EQ(come(small), What::kRefused);
  EXPECT_EQ(gate_.problem(), "it is 320x480 but the calibration is for 640x480");
  EXPECT_EQ(gate_.refused().of(Kind::kSize), 1);
  EXPECT_EQ(sessions_, 0);
}

TEST_F(SessionGateTest, TheCalibrationComesWithTheImages) {
  gate_ = SessionGate(std::nullopt);
  EXPECT_EQ(come(image(1)), What::kRefused);
  EXPECT_THAT(gate_.problem(), HasSubstr("it carries no calibration"));
  const auto calibrated = [this](double fx) {
    ArrivedImage arrived = image(1);
    set_metadata(&arrived.image, kCalibrationKey, camera_to_yaml(camera_with(fx)));
    return arrived;
  };
  EXPECT_EQ(come(calibrated(500)), What::kTrack);
  EXPECT_EQ(come(image(1)), What::kTrack) << "it is that of the session";
  EXPECT_EQ(come(calibrated(600)), What::kWaits);
  EXPECT_THAT(gate_.problem(), HasSubstr("fx 600.00, and the session's images as 640 x 480 px with fx 500.00"));
  gate_.give_up_waiting();
  EXPECT_EQ(gate_.refused().of(Kind::kOtherCamera), 1);
}

}  // namespace
}  // namespace rumi::front_tracker
