// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/why_no_map.h"

#include <gmock/gmock.h>

#include "tests/formats/recording.h"

namespace rumi::tool {
namespace {

using namespace testing;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(WhyNoMap, AFewImagesAreTooFew) {
  TemporaryFolder folder;
  write_tum(folder.path(), 3);
  folder.write("calibration.yaml", "fx: 90\nfy: 90\ncx: 64\ncy: 48\nwidth: 128\nheight: 96\n");
  for (int i = 0; i < 3; ++i) cv::imwrite(folder / fmt::format("rgb/{}.png", i), picture(i, 128, 96));
  camera_driver::CameraOptions options;
  EXPECT_THAT(why_no_map(folder.path(), options), Not(HasSubstr("at least")));
  options.duration_s = 0.15;
  EXPECT_THAT(why_no_map(folder.path(), options), HasSubstr("2 images: a map needs at least 3, from different places"));
  options.duration_s = 0.05;
  EXPECT_THAT(why_no_map(folder.path(), options), HasSubstr("1 image: a map needs at least 3"));
}

}  // namespace
}  // namespace rumi::tool
