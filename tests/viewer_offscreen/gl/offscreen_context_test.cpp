// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/gl/offscreen_context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <string>

#include "tests/viewer_offscreen/test_map.h"
#include "viewer_offscreen/picture/draw_map.h"
#include "viewer_offscreen/picture/renderer.h"

namespace rumi::viewer_offscreen {
namespace {

class OpenGlTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const char* before = getenv("RUMI_OPENGL")) before_ = before;
  }
  void TearDown() override {
    if (before_.empty())
      unsetenv("RUMI_OPENGL");
    else
      setenv("RUMI_OPENGL", before_.c_str(), 1);
  }
  std::string before_;
};

std::string trouble(const char* platform) {
  setenv("RUMI_OPENGL", platform, 1);
  try {
    const OffscreenContext context(16, 16, 4);
    return context.platform() == platform ? "" : "it is " + context.platform();
  } catch (const std::runtime_error& e) {
    return e.what();
  }
}

TEST_F(OpenGlTest, AnUnknownPlatformIsRefused) {
  EXPECT_THAT(trouble("vulkan"), testing::AllOf(testing::HasSubstr("RUMI_OPENGL"), testing::HasSubstr("vulkan"),
                                                testing::HasSubstr("osmesa or egl")));
}

TEST_F(OpenGlTest, OsmesaAndEglDrawTheSame) {
  for (const char* platform : {"osmesa", "egl"})
    if (const std::string reason = trouble(platform); !reason.empty()) GTEST_SKIP() << platform << ": " << reason;
  const Submap submap = make_test_submap(1, 0, 8, test_circle, 3000);
  const MapPicture picture{.submaps = {{&submap, true}}, .frames = test_frames(0, 9)};
  setenv("RUMI_OPENGL", "osmesa", 1);
  const cv::Mat osmesa = draw_map(picture);
  setenv("RUMI_OPENGL", "egl", 1);
  const cv::Mat egl = draw_map(picture);
  EXPECT_LT(cv::norm(osmesa, egl, cv::NORM_L1) / static_cast<double>(osmesa.total() * 3), 0.1);
  EXPECT_GT(cv::norm(osmesa, draw_map({}), cv::NORM_L1) / static_cast<double>(osmesa.total() * 3), 1);
}

TEST_F(OpenGlTest, TheyTakeTurnsInOneProcess) {
  for (const char* platform : {"osmesa", "egl"})
    if (const std::string reason = trouble(platform); !reason.empty()) GTEST_SKIP() << platform << ": " << reason;
  const Submap submap = make_test_submap(1, 0, 8, test_circle, 300);
  const Scene scene = make_scene({.submaps = {{&submap, true}}});
  setenv("RUMI_OPENGL", "osmesa", 1);
  Renderer first;
  setenv("RUMI_OPENGL", "egl", 1);
  Renderer second;
  const cv::Mat a = first.draw(scene), b = second.draw(scene), again = first.draw(scene);
  EXPECT_EQ(cv::norm(a, again, cv::NORM_INF), 0);
  EXPECT_LT(cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total() * 3), 0.1);
}

}  // namespace
}  // namespace rumi::viewer_offscreen
