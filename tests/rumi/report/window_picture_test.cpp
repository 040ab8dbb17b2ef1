// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/window_picture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/jpeg_image.h"
#include "lcmtypes/rumi/track_t.hpp"
#include "rumi/windows/window_scene.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;

constexpr int64_t kBegin = 1'700'000'000'000'000, kPeriod = 100'000;

// Makes a log of 100 frames. They are tracked in submap 1, have no pose from 40 to 59 (from 55 on they got poses
// afterwards), and are then tracked in submap 2. The poses of 38 and 39 were withdrawn.
class WindowPictureTest : public ::testing::Test {
 protected:
  static int64_t utime(int frame) { return kBegin + frame * kPeriod; }
  static window_t make_window(int32_t id) {
    window_t w{};
    w.utime = utime(90);
    w.session = 7;
    w.window_id = id;
    w.state = window_t::QUEUED;
    w.submap_before = 1, w.submap_after = 2;
    w.lost_utime = utime(40), w.resumed_utime = utime(55);
    for (int i = 20; i < 40; i += 5) w.approach_utime.push_back(utime(i));
    for (int i = 40; i < 55; ++i) w.gap_utime.push_back(utime(i));
    for (int i = 55; i < 80; i += 5) w.departure_utime.push_back(utime(i));
    w.napproach = 4, w.ngap = 15, w.ndeparture = 5, w.gap_frames = 15;
    return w;
  }
  static void write_track(LogWriter& log, int frame, int8_t state, int32_t submap) {
    track_t track{};
    track.utime = utime(frame);
    track.session = 7;
    track.state = state;
    track.submap_id = submap;
    track.is_keyframe = submap != 0 && frame % 10 == 0;
    log.write(track.utime, channels::kTrack, encode_message(track));
  }
  std::string write_log(bool with_images, const std::vector<window_t>& windows) {
    const std::string file = (folder_ / "bus.lcm").string();
    LogWriter log(file);
    for (int i = 0; i < 100; ++i) {
      const cv::Mat grey(90, 120, CV_8U, cv::Scalar(2 * i));
      if (with_images) log.write(utime(i), channels::kCamera, encode_message(make_jpeg_image(utime(i), grey)));
      const bool is_tracked = i < 40 || i >= 60;
      const int8_t state = is_tracked ? track_t::TRACKING : i < 50 ? track_t::RECENTLY_LOST : track_t::LOST;
      if (i == 60) {
        for (int late = 55; late < 60; ++late) write_track(log, late, track_t::LOST, 2);
        for (int withdrawn = 38; withdrawn < 40; ++withdrawn) write_track(log, withdrawn, track_t::RECENTLY_LOST, 0);
      }
      write_track(log, i, state, !is_tracked ? 0 : i < 40 ? 1 : 2);
    }
    for (const window_t& w : windows) log.write(w.utime, channels::kWindow, encode_message(w));
    EXPECT_TRUE(log.close());
    return file;
  }
  const testing::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

TEST_F(WindowPictureTest, TheSceneSaysWhatBecameOfEveryFrame) {
  const Result<WindowScene> result = read_window_scene(write_log(true, {make_window(1)}), 0);
  ASSERT_TRUE(result) << result.error_text();
  const WindowScene& scene = *result;
  EXPECT_EQ(scene.begin_us, kBegin);
  EXPECT_EQ(scene.frames.front().utime_us, utime(5));  // 15 frames before the first sample
  EXPECT_EQ(scene.frames.back().utime_us, utime(90));
  const auto frame = [&](int i) { return scene.frames.at(static_cast<size_t>(i - 5)); };
  EXPECT_EQ(frame(25).sampled_as, SampledAs::kApproach);
  EXPECT_EQ(frame(26).sampled_as, SampledAs::kNot);
  EXPECT_EQ(frame(40).sampled_as, SampledAs::kGap);
  EXPECT_EQ(frame(55).sampled_as, SampledAs::kDeparture);
  EXPECT_TRUE(frame(30).is_keyframe);
  EXPECT_FALSE(frame(54).has_pose);
  EXPECT_TRUE(frame(55).has_pose);
  EXPECT_EQ(frame(55).state, track_t::LOST) << "as it was said first";
  EXPECT_EQ(frame(45).state, track_t::RECENTLY_LOST);
  EXPECT_TRUE(frame(37).has_pose);
  EXPECT_FALSE(frame(38).has_pose);
  EXPECT_EQ(frame(38).state, track_t::RECENTLY_LOST);
  for (const SceneFrame& f : scene.frames) EXPECT_FALSE(f.image.empty()) << f.utime_us;
}

TEST_F(WindowPictureTest, ThePictureShowsTheStatesAndNothingElseWhereNothingIs) {
  const Result<WindowScene> result = read_window_scene(write_log(true, {make_window(1)}), 1);
  ASSERT_TRUE(result) << result.error_text();
  const cv::Mat picture = draw_window(*result);
  ASSERT_EQ(picture.type(), CV_8UC3);
  // Finds the strip by its colours: some row has the colours of tracked, recently lost, lost, posed afterwards and
  // tracked frames in this order.
  const auto is = [](const cv::Vec3b& bgr, int r, int g, int b) {
    return std::abs(bgr[2] - r) + std::abs(bgr[1] - g) + std::abs(bgr[0] - b) < 12;
  };
  bool found = false;
  for (int y = 0; y < picture.rows && !found; ++y) {
    std::string order;
    for (int x = 0; x < picture.cols; ++x) {
      const auto& bgr = picture.at<cv::Vec3b>(y, x);
      const char state = is(bgr, 0, 114, 178)    ? 'T'
                         : is(bgr, 230, 159, 0)  ? 'R'
                         : is(bgr, 213, 94, 0)   ? 'L'
                         : is(bgr, 86, 180, 233) ? 'A'
                                                 : ' ';
      if (state != ' ' && (order.empty() || order.back() != state)) order += state;
    }
    found = order == "TRLAT";
  }
  EXPECT_TRUE(found);
}

TEST_F(WindowPictureTest, WindowsAreChosenByNumberOrAsTheFirstTypicalOne) {
  window_t start = make_window(1);
  start.submap_before = 0;
  const std::string file = write_log(false, {start, make_window(2), make_window(3)});
  EXPECT_EQ(read_window_scene(file, 0)->window.window_id, 2);
  EXPECT_EQ(read_window_scene(file, 3)->window.window_id, 3);
  EXPECT_THAT(read_window_scene(file, 4).error_text(), HasSubstr("no window 4; there are 1 2 3"));
}

TEST_F(WindowPictureTest, TheLastAnnouncementCounts) {
  window_t early = make_window(1);
  early.state = window_t::COLLECTING;
  early.gap_utime.resize(3);
  early.ngap = 3;
  early.departure_utime.clear();
  early.ndeparture = 0;
  early.resumed_utime = 0;
  EXPECT_EQ(read_window_scene(write_log(false, {early, make_window(1)}), 1)->window.ngap, 15);
  const Result<WindowScene> lost = read_window_scene(write_log(false, {early}), 1);
  ASSERT_TRUE(lost) << lost.error_text();
  EXPECT_FALSE(draw_window(*lost).empty()) << "still lost, and without images";
}

TEST_F(WindowPictureTest, LogsThatAreNoGoodAreNamed) {
  EXPECT_THAT(read_window_scene((folder_ / "none").string(), 0).error_text(), HasSubstr("none"));
  EXPECT_THAT(read_window_scene(write_log(true, {}), 0).error_text(), HasSubstr("no window is announced"));
  window_t elsewhere = make_window(1);
  elsewhere.session = 8;
  EXPECT_THAT(read_window_scene(write_log(true, {elsewhere}), 0).error_text(), HasSubstr("0 frames"));
  const std::string text = (folder_ / "text").string();
  std::ofstream(text) << "this is no log";
  EXPECT_FALSE(read_window_scene(text, 0).has_value());
}

TEST_F(WindowPictureTest, OddWindowsAreDrawnToo) {
  window_t odd = make_window(1);
  odd.approach_utime = {utime(39)};
  odd.gap_utime.clear(), odd.departure_utime.clear();
  odd.napproach = 1, odd.ngap = 0, odd.ndeparture = 0;
  odd.lost_utime = 5;                    // before everything
  odd.resumed_utime = int64_t{1} << 52;  // after everything
  odd.reason = std::string(3000, 'x');
  Result<WindowScene> result = read_window_scene(write_log(true, {odd}), 1);
  ASSERT_TRUE(result) << result.error_text();
  EXPECT_FALSE(draw_window(*result).empty());
  result->frames.resize(1);
  EXPECT_FALSE(draw_window(*result).empty());
  result->frames[0].image = cv::Mat(1000, 1, CV_8UC3, cv::Scalar::all(9));
  EXPECT_FALSE(draw_window(*result).empty());
}

}  // namespace
}  // namespace rumi::tool
