// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/live_status.h"

#include <gmock/gmock.h>

#include "bus/transport/memory_bus.h"

namespace rumi::tool {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class LiveStatusTest : public testing::Test {
 protected:
  template <class T>
  void send(int64_t now_us, const char* channel, const T& message) {
    bus_.set_now_us(now_us);
    bus_.publish(channel, message);
    bus_.dispatch();
  }
  static process_status_t process(int64_t utime_us, int64_t in, double cpu_s) {
    process_status_t status{};
    status.utime = utime_us;
    status.process = "front_tracker";
    status.pid = 7;
    status.state = process_status_t::RUNNING;
    status.started_utime = 1'000'000;
    status.messages_in = in;
    status.messages_out = 2 * in;
    status.channels = {{"CAMERA", in, 4, 1, 3}, {"OTHER", 0, 1, 0, 0}};
    status.nchannels = 2;
    status.cpu_s = cpu_s;
    status.rss_bytes = 50'000'000;
    return status;
  }
  static track_t track(int64_t sequence, float latency_ms, int8_t state = track_t::TRACKING) {
    track_t track{};
    track.session = 5;
    track.sequence = sequence;
    track.state = state;
    track.submap_id = 2;
    track.inliers = 150;
    track.keypoints = 1000;
    track.latency_ms = latency_ms;
    return track;
  }
  MemoryBus bus_;
  LiveStatus status_{bus_};
};

TEST_F(LiveStatusTest, SaysNothingOfWhatWasNotHeard) {
  const auto json = status_.to_json();
  EXPECT_TRUE(json["processes"].empty());
  EXPECT_FALSE(json.contains("tracking"));
  EXPECT_FALSE(json.contains("map"));
  EXPECT_FALSE(json.contains("windows"));
  EXPECT_THAT(status_.to_text(), HasSubstr("process"));
}

// Before it starts anything, `rumi up` sends a status to ask which processes are there.
TEST_F(LiveStatusTest, WhoOnlyAsksIsNoProcess) {
  process_status_t status = process(10'000'000, 0, 0);
  status.process = "rumi";
  status.state = process_status_t::STARTING;
  send(10'000'000, channels::kStatus, status);
  EXPECT_TRUE(status_.to_json()["processes"].empty());
}

TEST_F(LiveStatusTest, RatesAreDifferencesOfOneRun) {
  send(10'000'000, channels::kStatus, process(10'000'000, 300, 5.0));
  auto json = status_.to_json()["processes"]["front_tracker"];
  EXPECT_EQ(json["in_hz"], 0.0);  // a rate needs two statuses
  send(12'000'000, channels::kStatus, process(12'000'000, 360, 6.0));
  json = status_.to_json()["processes"]["front_tracker"];
  EXPECT_EQ(json["in_hz"], 30.0);
  EXPECT_EQ(json["out_hz"], 60.0);
  EXPECT_EQ(json["cpu_percent"], 50.0);
  EXPECT_EQ(json["memory_mb"], 50.0);
  EXPECT_EQ(json["dropped"], 5);
  EXPECT_EQ(json["undecodable"], 1);
  EXPECT_EQ(json["waiting"], 3);
  EXPECT_EQ(json["running_s"], 11.0);
  EXPECT_EQ(json["state"], "running");
  process_status_t restarted = process(13'000'000, 2, 0.1);
  restarted.pid = 8;
  send(13'000'000, channels::kStatus, restarted);
  EXPECT_EQ(status_.to_json()["processes"]["front_tracker"]["in_hz"], 0.0);
  bus_.set_now_us(17'000'000);
  EXPECT_EQ(status_.to_json()["processes"]["front_tracker"]["state"], "silent");
}

// A process also tells its status when it is asked and when it ends, and messages that waited on the bus come all at
// once.
TEST_F(LiveStatusTest, NoRateIsMadeOfAMoment) {
  send(10'000'000, channels::kStatus, process(10'000'000, 300, 5.0));
  send(12'000'000, channels::kStatus, process(12'000'000, 360, 6.0));
  send(12'010'000, channels::kStatus, process(12'010'000, 363, 6.0));
  EXPECT_NEAR(status_.to_json()["processes"]["front_tracker"]["in_hz"].get<double>(), 30, 2);
  for (int i = 0; i < 20; ++i) send(13'000'000 + i, channels::kTrack, track(i, 1));
  EXPECT_EQ(status_.to_json()["tracking"]["rate_hz"], 0.0) << "not known yet";
}

TEST_F(LiveStatusTest, CpuTimeAFrameByStageOfAllThatWasHeard) {
  process_status_t status = process(10'000'000, 300, 5.0);
  status.stages = {{"corners", 2.0}};
  status.nstages = 1;
  send(10'000'000, channels::kStatus, status);
  auto json = status_.to_json()["processes"]["front_tracker"];
  EXPECT_TRUE(json["cpu_ms_per_frame"].is_null());
  EXPECT_TRUE(json["cpu_ms_per_frame_by_stage"].empty());
  for (int i = 0; i < 20; ++i) send(10'000'001 + i, channels::kTrack, track(i, 1));
  status.cpu_s = 5.2;
  status.stages = {{"corners", 2.05}, {"track", 0.1}};
  status.nstages = 2;
  send(11'000'000, channels::kStatus, status);
  json = status_.to_json()["processes"]["front_tracker"];
  EXPECT_EQ(json["cpu_ms_per_frame"], 10.0);
  EXPECT_EQ(json["cpu_ms_per_frame_by_stage"]["corners"], 2.5);
  EXPECT_EQ(json["cpu_ms_per_frame_by_stage"]["track"], 5.0);
  EXPECT_THAT(status_.to_text(), HasSubstr("\n  CPU ms/frame: track 5.0, corners 2.5\n"));
  status.pid = 8;  // the process was restarted
  send(12'000'000, channels::kStatus, status);
  EXPECT_TRUE(status_.to_json()["processes"]["front_tracker"]["cpu_ms_per_frame"].is_null());
}

TEST_F(LiveStatusTest, ADegradedProcessSaysWhy) {
  process_status_t status = process(10'000'000, 1, 1);
  status.state = process_status_t::DEGRADED;
  status.detail = "no images now: the camera is gone";
  send(10'000'000, channels::kStatus, status);
  EXPECT_THAT(status_.to_text(), AllOf(HasSubstr("degraded"), HasSubstr("the camera is gone")));
  status.state = 99;
  send(10'000'000, channels::kStatus, status);
  EXPECT_THAT(status_.to_text(), HasSubstr("unknown"));
}

TEST_F(LiveStatusTest, TrackingOfTheLatestSeconds) {
  send(1'000'000, channels::kTrack, track(0, 900, track_t::LOST));  // too old to count
  for (int i = 0; i <= 40; ++i)
    if (i != 7) send(10'000'000 + i * 100'000, channels::kTrack, track(100 + i, static_cast<float>(i)));
  send(14'000'000, channels::kTrack, track(120, 5000));  // this frame is told again, with its pose
  const auto json = status_.to_json()["tracking"];
  EXPECT_EQ(json["state"], "TRACKING");
  EXPECT_EQ(json["tracked_percent"], 100.0);
  EXPECT_EQ(json["rate_hz"], 9.8);  // 39 frames in 4 s after the first one
  EXPECT_EQ(json["latency_p50_ms"], 20.0);
  EXPECT_EQ(json["latency_p95_ms"], 38.0);
  EXPECT_EQ(json["lost_by_bus"], 1);
  EXPECT_EQ(json["frames"], 141);
  EXPECT_THAT(status_.to_text(), HasSubstr("TRACKING, submap 2, 150 landmarks agree with the pose"));
}

// Impossible numbers from the network are not used.
TEST_F(LiveStatusTest, ImpossibleNumbersAreLeftOut) {
  process_status_t status = process(1'000'000, 5, 1);
  status.started_utime = INT64_MIN;
  send(1, channels::kStatus, status);
  status = process(1'000'000, INT64_MAX, 1);
  send(2, channels::kStatus, status);
  EXPECT_TRUE(status_.to_json()["processes"].empty());
  send(3, channels::kTrack, track(INT64_MAX, 5));
  EXPECT_FALSE(status_.to_json().contains("tracking"));
  for (int i = 0; i < 40; ++i) send(4, channels::kTrack, track(i, std::nanf("")));
  EXPECT_EQ(status_.to_json()["tracking"]["latency_p50_ms"], 0);
}

TEST_F(LiveStatusTest, MapAndWindows) {
  map_status_t map{};
  map.frames = 100;
  map.frames_in_map = 90;
  map.merging = true;
  map.front_submaps = 2;
  map.back_submaps = 1;
  map.submaps_in_map = 2;
  map.landmarks = 1500;
  map.links_in_all = 2;
  map.links_accepted = 1;
  map.nsubmaps = map.nlinks = 0;  // the counts are of the whole map, not only of this page
  send(1, channels::kMapStatus, map);
  window_t window{};
  window.window_id = 4;
  window.state = window_t::MAPPING;
  window.napproach = window.gap_frames = 0;
  window.ngap = 2;
  window.gap_utime = {1, 2};
  send(2, channels::kWindow, window);
  window.state = window_t::FAILED;
  window.reason = "too few images";
  send(3, channels::kWindow, window);
  const auto json = status_.to_json();
  EXPECT_EQ(json["map"]["front_submaps"], 2);
  EXPECT_EQ(json["map"]["back_submaps"], 1);
  EXPECT_EQ(json["map"]["submaps_in_map"], 2);
  EXPECT_EQ(json["map"]["landmarks"], 1500);
  EXPECT_EQ(json["map"]["links_refused"], 1);
  ASSERT_EQ(json["windows"].size(), 1u);
  EXPECT_EQ(json["windows"][0]["state"], "failed");
  EXPECT_EQ(json["windows"][0]["images"], 2);
  EXPECT_THAT(status_.to_text(), AllOf(HasSubstr("90 of 100 frames"), HasSubstr("merging"),
                                       HasSubstr("window 4  failed, 2 images: too few images")));
}

}  // namespace
}  // namespace rumi::tool
