// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/other_calibration.h"

#include <gmock/gmock.h>

namespace rumi::map_server {
namespace {

using ::testing::HasSubstr;

Camera camera(double fx) {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = fx;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

Submap submap(int64_t session, int64_t stream, double fx) {
  Submap submap;
  submap.key = {session, 1};
  submap.stream = stream;
  submap.revision = 1;
  submap.camera = camera(fx);
  return submap;
}

TEST(OtherCalibration, IsNamedByItsFirstQuantity) {
  EXPECT_EQ(difference(camera(525), camera(350)), "fx 525 there, 350 here");
  Camera other = camera(525);
  other.cy = 200;
  EXPECT_EQ(difference(camera(525), other), "cy 240 there, 200 here");
  other = camera(525);
  other.k1 = -0.3;
  EXPECT_EQ(difference(camera(525), other), "another distortion: k1 0 there, -0.3 here");
  other = camera(525);
  other.width = 480;
  EXPECT_EQ(difference(camera(525), other), "640 x 480 pixels there, 480 x 480 here");
  other = camera(525);
  other.model = Camera::Model::kKannalaBrandt;
  EXPECT_EQ(difference(camera(525), other), "another model of the lens");
}

TEST(OtherCalibration, CalibratedOnceMoreOrMadeSmallerItIsTheSame) {
  EXPECT_EQ(difference(camera(525), camera(525)), "");
  EXPECT_EQ(difference(camera(525), camera(522)), "");
  EXPECT_EQ(difference(camera(525), camera(525).resized(320, 240)), "");
  EXPECT_EQ(difference(camera(525), camera(350).resized(320, 240)), "fx 262 there, 175 here");
}

TEST(OtherCalibration, IsLookedForInEarlierSessionsOfTheStream) {
  Atlas atlas;
  const auto put = [&atlas](const Submap& submap) {
    EXPECT_TRUE(atlas.change_submap(submap.key, [&submap](Submap* stored) {
      *stored = submap;
      return Result<>();
    }));
  };
  put(submap(5, 77, 525));
  put(submap(9, 77, 350));
  atlas.note_present(9);
  EXPECT_EQ(other_calibration(atlas, submap(9, 77, 350)), "fx 525 there, 350 here");
  EXPECT_EQ(other_calibration(atlas, submap(9, 78, 350)), "") << "another stream";
  EXPECT_EQ(other_calibration(atlas, submap(9, 77, 525)), "");
  atlas.note_present(5);
  EXPECT_EQ(other_calibration(atlas, submap(9, 77, 350)), "") << "of this run";
}

}  // namespace
}  // namespace rumi::map_server
