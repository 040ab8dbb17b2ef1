// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/web_node.h"

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <random>

#include "bus/transport/memory_bus.h"
#include "bus/wire/jpeg_decoder.h"
#include "rumi/web/submap_blob.h"
#include "tests/rumi/web/false_system.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string kPage = RUMI_SOURCE_DIR "/rumi/web/page";

class WebNodeTest : public ::testing::Test {
 protected:
  WebNodeTest() { bus_.set_now_us(20'000'000); }
  void publish_all() {
    system_.publish_tracks();
    system_.publish_map();
    system_.publish_statuses();
    system_.publish_window();
  }
  void run(double seconds, bool watched = true) {
    for (int i = 0; i < seconds * 50; ++i) {
      bus_.set_now_us(bus_.now_us() + 20'000);
      bus_.dispatch();
      system_.tick();
      node_.tick(bus_.now_us(), watched);
    }
    bus_.dispatch();
  }
  Json told(const std::string& event) { return told_.contains(event) ? Json::parse(told_.at(event).back()) : Json(); }
  size_t times(const std::string& event) { return told_[event].size(); }
  HttpAnswer get(const std::string& path) { return node_.answer(path); }

  MemoryBus bus_;
  FalseSystem system_{bus_};
  std::map<std::string, std::vector<std::string>> told_;
  WebNode node_{bus_, PageFiles(kPage), "udpm://here",
                [this](const std::string& event, const std::string& data) { told_[event].push_back(data); }};
};

TEST_F(WebNodeTest, NothingIsAskedOrToldWhileNobodyLooks) {
  publish_all();
  const int64_t published = bus_.published();
  run(5, /*watched=*/false);
  EXPECT_EQ(bus_.published(), published);
  EXPECT_TRUE(told_.empty());
  run(3);
  EXPECT_EQ(system_.take_requests().size(), 3u);
  EXPECT_EQ(told("map")["submaps"].size(), 3u);
}

TEST_F(WebNodeTest, TheMapAsItIs) {
  publish_all();
  run(3);
  const Json submaps = told("map")["submaps"];
  ASSERT_EQ(submaps.size(), 3u);
  EXPECT_EQ(submaps[0]["name"], "1_-1");
  EXPECT_EQ(submaps[0]["kind"], "back");
  EXPECT_EQ(submaps[0]["color"], "#d55e00");
  EXPECT_EQ(submaps[1]["kind"], "front");
  EXPECT_EQ(submaps[1]["color"], "#0072b2");
  EXPECT_EQ(submaps[2]["color"], "#009e73");
  EXPECT_EQ(submaps[1]["landmarks"], 3000);
  EXPECT_EQ(submaps[2]["closed"], false);
  EXPECT_EQ(told("map")["merges"].size(), 2u);
  EXPECT_GT(std::abs(told("map")["up"][2].get<double>()), 0.9) << "the path is flat";
}

template <class T>
T number_at(const std::string& blob, size_t offset) {
  T value;
  std::memcpy(&value, blob.data() + offset, sizeof(value));
  return value;
}

TEST_F(WebNodeTest, ASubmapInBytes) {
  publish_all();
  run(3);
  const HttpAnswer answer = get("/submap/1_1");
  ASSERT_EQ(answer.status, 200);
  const std::string& blob = *answer.body;
  const Submap& submap = system_.submap(1);
  EXPECT_EQ(blob.substr(0, 4), "RSM1");
  ASSERT_EQ(number_at<uint32_t>(blob, 4), 150u);    // number of poses
  ASSERT_EQ(number_at<uint32_t>(blob, 8), 15u);     // number of keyframes
  ASSERT_EQ(number_at<uint32_t>(blob, 12), 3000u);  // number of landmarks
  const size_t path = 32 + 8 * 150, keyframes = path + 12 * 150, landmarks = keyframes + 28 * 15;
  EXPECT_EQ(blob.size(), landmarks + 12 * 3000 + 8 * number_at<uint32_t>(blob, 16));
  EXPECT_DOUBLE_EQ(number_at<double>(blob, 32 + 8), 1.033333);
  const Eigen::Vector3d second = submap.cam_from_submap(submap.frames.at(1'033'333)).center();
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(number_at<float>(blob, path + 12 + 4 * i), second[static_cast<int>(i)], 1e-6);
    EXPECT_NEAR(number_at<float>(blob, landmarks + 4 * i), submap.landmark(0)->position[static_cast<int>(i)], 1e-6);
  }
}

TEST_F(WebNodeTest, OnlyWhatChangedHasANewVersion) {
  publish_all();
  run(3);
  const Json before = told("map")["submaps"];
  const size_t maps = times("map");
  run(3);
  EXPECT_EQ(times("map"), maps) << "told again, although nothing is new";
  system_.grow(2);
  system_.publish_map();
  run(3);
  const Json after = told("map")["submaps"];
  EXPECT_EQ(before[0]["version"], after[0]["version"]);
  EXPECT_EQ(before[1]["version"], after[1]["version"]);
  EXPECT_LT(before[2]["version"], after[2]["version"]);
  EXPECT_EQ(number_at<uint32_t>(*get("/submap/1_2").body, 12), 2001u);
}

TEST_F(WebNodeTest, TrackingOverTime) {
  publish_all();
  run(3);
  const Json timeline = told("timeline");
  EXPECT_EQ(timeline["frames"], 360);
  EXPECT_EQ(timeline["in_map"], 360);
  EXPECT_EQ(timeline["filled"], 60) << "by the back submap alone";
  ASSERT_EQ(timeline["tracked"].size(), 3u);
  EXPECT_EQ(timeline["tracked"][0][2], int{track_t::TRACKING});
  EXPECT_EQ(timeline["tracked"][0][3], 1) << "the submap in told(map)";
  EXPECT_EQ(timeline["tracked"][1][2], int{track_t::LOST});
  EXPECT_NEAR(timeline["tracked"][1][0].get<double>(), 5, 0.05);
  EXPECT_TRUE(timeline["lost"].empty()) << "all have a pose now";
  EXPECT_EQ(told("pose")["state"], "TRACKING");
  system_.publish_loss();
  run(2);
  EXPECT_EQ(told("pose")["state"], "LOST");
  EXPECT_FALSE(told("pose").contains("at"));
  EXPECT_EQ(told("timeline")["lost"].size(), 1u);
}

TEST_F(WebNodeTest, TheCameraIsWhereItsSubmapLies) {
  publish_all();
  run(3);
  const Submap& submap = system_.submap(2);
  const Eigen::Vector3d last = submap.cam_from_submap(submap.frames.rbegin()->second).center();
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(told("pose")["at"][static_cast<size_t>(i)].get<double>(), last[i], 1e-6);
}

TEST_F(WebNodeTest, ProcessesOnceASecond) {
  publish_all();
  run(1);
  const size_t before = times("status");
  run(10);
  EXPECT_NEAR(static_cast<double>(times("status") - before), 10, 1);
  EXPECT_EQ(told("status")["bus"], "udpm://here");
  EXPECT_EQ(told("status")["live"]["processes"].size(), 5u);
  EXPECT_EQ(told("status")["live"]["processes"]["map_server"]["state"], "silent") << "for ten seconds";
  EXPECT_EQ(told("status")["live"]["windows"][0]["state"], "published");
}

TEST_F(WebNodeTest, WhoBeginsToLookIsToldEverything) {
  publish_all();
  system_.publish_image();
  run(3);
  told_.clear();
  run(1, /*watched=*/false);
  EXPECT_TRUE(told_.empty());
  run(0.1);
  for (const char* event : {"map", "timeline", "pose", "status"}) EXPECT_EQ(times(event), 1u) << event;
}

TEST_F(WebNodeTest, ImagesAreSmallAndFew) {
  system_.publish_image();
  run(1, /*watched=*/false);
  EXPECT_EQ(get("/camera.jpg").status, 404) << "decoded, although nobody looks";
  run(0.1);
  int different = 0;
  std::shared_ptr<const std::string> last;
  for (int i = 0; i < 60; ++i) {
    system_.publish_image();
    run(1.0 / 30);
    const HttpAnswer answer = get("/camera.jpg");
    ASSERT_EQ(answer.status, 200);
    different += answer.body != std::exchange(last, answer.body);
  }
  EXPECT_GT(different, 4);
  EXPECT_LE(different, 13) << "in 2.4 s";
  EXPECT_GT(times("image"), 4u);
  EXPECT_LE(times("image"), 13u) << "asked for more often than there is a new one";
  const cv::Mat image = decode_jpeg({reinterpret_cast<const uint8_t*>(last->data()), last->size()}, false).value();
  EXPECT_EQ(image.size(), cv::Size(480, 270));
  EXPECT_NEAR(image.at<cv::Vec3b>(100, 100)[0], 200, 5);
}

TEST_F(WebNodeTest, ABrokenImageIsNone) {
  run(0.1);
  image_t image = make_jpeg_image(bus_.now_us(), cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(9)));
  image.data.resize(image.data.size() / 2);
  image.size = static_cast<int32_t>(image.data.size());
  bus_.publish(channels::kCamera, image);
  run(1);
  EXPECT_EQ(get("/camera.jpg").status, 404);
}

TEST_F(WebNodeTest, OnlyWhatThereIs) {
  EXPECT_EQ(get("/").type, "text/html; charset=utf-8");
  EXPECT_THAT(*get("/").body, HasSubstr("<!DOCTYPE html>"));
  EXPECT_TRUE(get("/events").events);
  for (const char* path : {"/index.html", "/../web_node.cpp", "/style.css/..", "//etc/passwd", "/%2e%2e/", "/submap/",
                           "/submap/1_1", "/submap/1_1/", "/submap/../main.js", "/camera.jpg/"})
    EXPECT_EQ(get(path).status, 404) << path;
}

TEST_F(WebNodeTest, EveryFileOfThePageIsServed) {
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kPage)) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(get(name == "index.html" ? "/" : "/" + name).status, 200) << name;
    ++files;
  }
  EXPECT_GT(files, 8u);
}

TEST(PageFiles, WhatIsMissingIsNamed) {
  try {
    PageFiles("/nowhere/at/all");
    FAIL() << "no file, no complaint";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("/nowhere/at/all/index.html: cannot be read"));
  }
}

// Random bytes on any channel, broken messages, and numbers that are not finite do no harm.
TEST_F(WebNodeTest, WhatIsWrongOnTheBusDoesNoHarm) {
  publish_all();
  run(2);
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    static const char* kChannels[] = {channels::kTrack,  channels::kMapStatus, channels::kStatus,
                                      channels::kCamera, channels::kWindow,    channels::kMapChunk};
    std::vector<uint8_t> bytes(random() % 300);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    bus_.publish_raw(kChannels[random() % 6], bytes);
  }
  track_t track{};
  track.utime = int64_t{1} << 52;
  track.session = FalseSystem::kSession;
  track.sequence = INT64_MAX;
  track.state = 77;
  track.submap_id = 2;
  for (double& x : track.cam_from_submap.trans) x = std::nan("");
  bus_.publish(channels::kTrack, track);
  run(2);
  for (const auto& [event, all] : told_)
    for (const std::string& data : all) EXPECT_TRUE(Json::accept(data)) << event << ": " << data;
  EXPECT_EQ(told("map")["submaps"].size(), 3u);
  EXPECT_FALSE(told("pose").contains("at"));
}

}  // namespace
}  // namespace rumi::tool
