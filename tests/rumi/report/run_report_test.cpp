// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/jpeg_image.h"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/report/html_page.h"
#include "rumi/report/mask_picture.h"
#include "rumi/report/match_history.h"
#include "rumi/report/run_report.h"
#include "rumi/run/process_load.h"
#include "ruminator/window/window_job.h"
#include "tests/rumi/small_atlas.h"
#include "tests/support/count_of.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using testing::count_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

TEST(HtmlPage, Base64IsThatOfTheRfc) {
  const auto encoded = [](const std::string& text) {
    return base64({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

TEST(HtmlPage, TextIsNeverMarkup) {
  HtmlPage page("<b>");
  page.section("a & b", "\"quoted\"");
  page.table({"<i>"}, {{"'x'", "</table>"}});
  const std::string html = page.finish();
  EXPECT_THAT(html, Not(HasSubstr("<b>")));
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;"));
  EXPECT_THAT(html, HasSubstr("a &amp; b"));
  EXPECT_THAT(html, HasSubstr("&lt;/table&gt;"));
}

ruminator::WindowJob test_window() {
  ruminator::WindowJob job;
  job.camera = test_camera();
  ruminator::RuminationWindow& w = job.window;
  w.id = 1;
  w.session = 1;
  w.submap_before = 1;
  w.submap_after = 2;
  w.gap_frames = 2;
  int64_t utime_us = 1'100'000;
  const auto fill = [&](std::vector<ruminator::Sample>* part, int count, int32_t submap) {
    for (int i = 0; i < count; ++i, utime_us += 100'000) {
      part->push_back({.utime_us = utime_us, .is_keyframe = false, .submap_id = submap, .cam_from_submap = SE3()});
      job.images.push_back(make_jpeg_image(utime_us, cv::Mat(480, 640, CV_8U, cv::Scalar(100)), 50));
    }
  };
  fill(&w.approach, 3, 1);
  fill(&w.gap, 2, kNoSubmap);
  fill(&w.departure, 3, 2);
  w.lost_utime_us = w.gap.front().utime_us;
  w.resumed_utime_us = w.departure.front().utime_us;
  return job;
}

void put(const Submap& submap, map_server::Atlas* atlas) {
  EXPECT_TRUE(atlas->change_submap(submap.key, [&](Submap* there) {
    *there = submap;
    return Result<>();
  }));
}

TEST(MatchHistory, CountsWhatTwoSubmapsHaveAtTheSameKeypoints) {
  map_server::Atlas atlas = make_test_atlas();
  EXPECT_TRUE(match_history(atlas, 4).empty());
  Submap back = make_test_submap(3);  // lacks the last of the four keyframes
  back.key = {1, -1};
  back.kind = SubmapKind::kBack;
  for (auto& [id, landmark] : back.landmarks) landmark.position *= 2;  // the back submap has a unit of its own
  for (auto& [id, keyframe] : back.keyframes) keyframe.cam_from_submap.translation *= 2;
  put(back, &atlas);
  const auto link = [](double scale) {
    return map_server::Link{.a = {1, -1},
                            .b = {1, 1},
                            .kind = map_server::Link::Kind::kSameImages,
                            .b_from_a = Sim3(scale, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero())};
  };
  EXPECT_TRUE(atlas.set_links({link(0.5)}));
  MatchHistory history = match_history(atlas, 4);
  EXPECT_TRUE(history.front.empty());
  ASSERT_EQ(history.back.size(), 3u);
  for (const auto& [utime_us, matches] : history.back) {
    EXPECT_EQ(matches.matched, 20) << utime_us;
    EXPECT_EQ(matches.verified, 20) << utime_us;
  }
  using Span = std::pair<int64_t, int64_t>;
  EXPECT_THAT(history.untracked, ::testing::ElementsAre(Span(1'400'000, 1'400'000)));
  EXPECT_EQ(history.first_us, 1'000'000);
  EXPECT_EQ(history.last_us, 1'400'000);
  EXPECT_EQ(draw_matches(history).size(), cv::Size(1000, 360));
  // A wrong link changes nothing in how many features match, but most of them do not agree. (Those of the first camera
  // do, because it is at the origin, where the scale does not matter.)
  EXPECT_TRUE(atlas.set_links({link(1)}));
  history = match_history(atlas, 4);
  EXPECT_EQ(history.back.at(1'200'000).matched, 20);
  EXPECT_LT(history.back.at(1'200'000).verified, 20);
  Submap front = make_test_submap();
  front.key = {1, 2};
  put(front, &atlas);
  history = match_history(atlas, 4);
  EXPECT_EQ(history.front.at(1'300'000).matched, 20);
  EXPECT_EQ(history.front.at(1'300'000).verified, 0) << "no link tells how they lie";
  EXPECT_EQ(history.back.at(1'200'000).matched, 40) << "of two pairs";
}

// Makes the folder of a run with two submaps, one of which is not in the map.
class ReportTest : public ::testing::Test {
 protected:
  ReportTest() {
    Submap other = make_test_submap();
    other.key = {1, 2};
    EXPECT_TRUE(atlas_.change_submap(other.key, [&](Submap* submap) {
      *submap = other;
      return Result<>();
    }));
    EXPECT_TRUE(atlas_.set_links({{.a = {1, 1}, .b = {1, 2}, .landmarks = 7, .doubt = "a <reason> to refuse"}}));
    EXPECT_THAT(write_run_outputs(atlas_, folder_.string()), IsEmpty());
    std::vector<ImageId> images;
    for (const auto& [image, frame] : atlas_.frames()) images.push_back(image);
    EXPECT_EQ(map_server::MapStore::open((folder_ / "map.db").string()).value().save(atlas_, images).error_text(), "");
    write_run({{"finished", true}, {"input", "a <recording>"}, {"cpu_ms_per_frame", {{"front_tracker", 12.5}}}});
    fs::create_directory(folder_ / "windows");
    EXPECT_EQ(ruminator::write_window_job((folder_ / "windows" / "1-1.window").string(), test_window()).error_text(),
              "");
  }
  void write_run(const nlohmann::ordered_json& run) {
    EXPECT_EQ(write_run_json(folder_.string(), run).error_text(), "");
  }

  const testing::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  map_server::Atlas atlas_ = make_test_atlas();
};

TEST_F(ReportTest, IsOneFileWithAllSections) {
  const std::string html = make_report(folder_.string());
  for (const char* section : {"Run", "Map", "Tracking over time", "Windows", "Joins", "Data association", "Load"})
    EXPECT_THAT(html, HasSubstr(std::string("<h2>") + section + "</h2>"));
  EXPECT_THAT(html, Not(HasSubstr("<h2>Error</h2>")));
  EXPECT_THAT(html, HasSubstr("a &lt;recording&gt;"));
  EXPECT_THAT(html, HasSubstr("refused: a &lt;reason&gt; to refuse"));
  EXPECT_THAT(html, HasSubstr("front_tracker"));
  EXPECT_THAT(html, HasSubstr("Window 1: lost at"));
  EXPECT_EQ(count_of(html, "data:image/jpeg"), 8u);
  EXPECT_EQ(count_of(html, "data:image/png"), 5u);
  EXPECT_THAT(html, HasSubstr("<td>between front submaps alone</td><td>4</td><td>80</td><td>80</td>"));
}

// The images of the window name no stream, so they belong to the stream with the number of their session, 1.
TEST_F(ReportTest, DrawsWhatNeverMovesOverAnImageOfTheCamera) {
  EXPECT_THAT(make_report(folder_.string()), Not(HasSubstr("<h2>Masks</h2>")));
  cv::Mat pixels(48, 64, CV_8U, cv::Scalar(255));
  pixels.rowRange(36, 48) = 0;
  for (const int64_t stream : {1, 2})
    atlas_.record_mask(
        stream,
        {.session = 1, .utime_us = 1'000'000, .width = 64, .height = 48, .left_out = 0.25, .png = encode_mask(pixels)});
  ASSERT_EQ(map_server::MapStore::open((folder_ / "map.db").string()).value().save(atlas_, {}).error_text(), "");
  const std::string html = make_report(folder_.string());
  EXPECT_THAT(html, HasSubstr("<h2>Masks</h2>"));
  EXPECT_THAT(html, HasSubstr("25 % of the image of stream 1 never moves"));
  EXPECT_EQ(count_of(html, "data:image/png"), 7u);
}

TEST(MaskPicture, IsTheImageWithWhatIsLeftOutInRed) {
  cv::Mat pixels(48, 64, CV_8U, cv::Scalar(255));
  pixels.rowRange(36, 48) = 0;
  const std::string png = encode_mask(pixels);
  const cv::Mat over = draw_mask(png, cv::Mat(96, 128, CV_8UC3, cv::Scalar(100, 100, 100)));
  ASSERT_EQ(over.size(), cv::Size(64, 48));
  EXPECT_EQ(over.at<cv::Vec3b>(10, 10), cv::Vec3b(100, 100, 100));
  const cv::Vec3b red = over.at<cv::Vec3b>(40, 10);
  EXPECT_GT(red[2], red[0] + 80);
  const cv::Mat alone = draw_mask(png, {});
  EXPECT_EQ(alone.at<cv::Vec3b>(10, 10), cv::Vec3b(255, 255, 255));
  EXPECT_NE(alone.at<cv::Vec3b>(40, 10), cv::Vec3b(255, 255, 255));
  EXPECT_TRUE(draw_mask("no PNG", {}).empty());
}

TEST_F(ReportTest, FetchesNothing) {
  const std::string html = make_report(folder_.string());
  for (const char* from_elsewhere :
       {"http:", "https:", "href", "<script", "<link", "<iframe", "@import", "url(", "src=\"/"})
    EXPECT_THAT(html, Not(HasSubstr(from_elsewhere)));
  EXPECT_EQ(count_of(html, "src="), count_of(html, "src=\"data:image/"));
}

TEST_F(ReportTest, ThePicturesAreWhole) {
  const std::string html = make_report(folder_.string());
  const std::string begin = "data:image/png;base64,";
  const size_t at = html.find(begin) + begin.size();
  const std::string encoded = html.substr(at, html.find('"', at) - at);
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i + 3 < encoded.size(); i += 4) {
    static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint32_t bits = 0;
    for (size_t k = 0; k < 4; ++k) {
      const size_t digit = kDigits.find(encoded[i + k]);
      bits = bits << 6 | (digit == std::string::npos ? 0u : static_cast<uint32_t>(digit));
    }
    for (int k = 2; k >= 0; --k) bytes.push_back(static_cast<uint8_t>(bits >> (8 * k)));
  }
  EXPECT_EQ(cv::imdecode(bytes, cv::IMREAD_COLOR).size(), cv::Size(1280, 720));
}

TEST_F(ReportTest, TellsTheErrorWhereTheTruthIsGiven) {
  std::ofstream truth(folder_ / "truth.txt");
  for (const auto& [image, pose] : atlas_.map_trajectory()) {
    const Eigen::Vector3d p = 3 * pose.translation;
    truth << static_cast<double>(image.utime_us) * 1e-6 << " " << p.x() << " " << p.y() << " " << p.z() << " 0 0 0 1\n";
  }
  truth.close();
  const std::string html = make_report(folder_.string(), {.groundtruth = (folder_ / "truth.txt").string()});
  EXPECT_THAT(html, HasSubstr("<h2>Error</h2>"));
  EXPECT_THAT(html, HasSubstr("ate_rmse_m"));
  EXPECT_EQ(count_of(html, "data:image/png"), 6u);
  EXPECT_THAT([&] { make_report(folder_.string(), {.groundtruth = "/nowhere/truth.txt"}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/truth.txt")));
}

TEST_F(ReportTest, ShowsTheLoadOfALiveRun) {
  const std::string log = (folder_ / "live.lcm").string();
  LogWriter writer(log);
  process_status_t status{};
  for (int i = 0; i < 5; ++i) {
    status.process = "map_server";
    status.pid = i < 3 ? 7 : 8;  // it was restarted
    status.utime = 2'000'000'000 + i * 1'000'000;
    status.cpu_s = i < 3 ? 0.25 * i : 0.5 * i;
    status.rss_bytes = 50'000'000 + i;
    writer.write(status.utime, channels::kStatus, encode_message(status));
    writer.write(status.utime, channels::kStatus, std::vector<uint8_t>{1, 2, 3});
  }
  status.utime += 1000;  // the last status, from the end of the process
  status.cpu_s += 0.1;
  writer.write(status.utime, channels::kStatus, encode_message(status));
  ASSERT_TRUE(writer.close());
  const ProcessLoad load = read_process_load(log).value();
  using Point = std::pair<double, double>;
  EXPECT_THAT(load.cpu_percent.at("map_server"), ::testing::ElementsAre(Point(1, 25), Point(2, 25), Point(4, 50)));
  EXPECT_EQ(load.memory_mb.at("map_server").size(), 6u);
  const std::string html = make_report(folder_.string(), {.log = log});
  EXPECT_EQ(count_of(html, "<svg"), 2u);
  EXPECT_THAT(html, HasSubstr("map_server</text>"));
  EXPECT_THAT(html, Not(HasSubstr("http")));
  const auto refusal = [&](const char* what) { return ThrowsMessage<std::runtime_error>(HasSubstr(what)); };
  EXPECT_THAT([&] { make_report(folder_.string(), {.log = "/nowhere.lcm"}); }, refusal("/nowhere.lcm"));
  const std::string silent = (folder_ / "silent.lcm").string();
  ASSERT_TRUE(LogWriter(silent).close());
  EXPECT_THAT([&] { make_report(folder_.string(), {.log = silent}); }, refusal("no process tells its status"));
}

TEST_F(ReportTest, ShowsTheLoadOfAReplay) {
  write_run(
      {{"finished", true}, {"load", {{"s", {0, 5}}, {"memory_mb", {100, 120}}, {"cpu_s", {{"map_server", {0, 1}}}}}}});
  const std::string html = make_report(folder_.string());
  EXPECT_EQ(count_of(html, "<svg"), 2u);
  EXPECT_THAT(html, HasSubstr("map_server</text>"));
  EXPECT_THAT(html, HasSubstr("replay</text>"));
}

TEST_F(ReportTest, GoesWithoutAMapThatDidNotFitOnTheDisk) {
  fs::remove(folder_ / "map.db");
  write_run({{"finished", true},
             {"counts", {{"frames", 5}, {"frames_in_map", 4}}},
             {"missing", {"cannot write map.db: database or disk is full"}}});
  const std::string page = make_report(folder_.string());
  EXPECT_THAT(page, HasSubstr("Missing: cannot write map.db: database or disk is full"));
  EXPECT_THAT(page, HasSubstr("frames with a pose in the map"));
}

TEST_F(ReportTest, SaysWhatIsWrongWithTheFolder) {
  const auto refusal = [&](const char* what) { return ThrowsMessage<std::runtime_error>(HasSubstr(what)); };
  EXPECT_THAT([&] { make_report("/nowhere"); }, refusal("/nowhere: no such file or folder"));
  EXPECT_THAT([&] { make_report((folder_ / "windows").string()); }, refusal("no run.json of ours"));
  write_run({{"finished", false}});
  EXPECT_THAT([&] { make_report(folder_.string()); }, refusal("was not finished"));
  write_run({{"finished", true}});
  std::ofstream(folder_ / "windows" / "1-1.window") << "garbage";
  EXPECT_THAT(make_report(folder_.string()), HasSubstr("1-1.window"));
  fs::remove(folder_ / "map.db");
  EXPECT_THAT([&] { make_report(folder_.string()); }, refusal("map.db: there is no such file"));
}

}  // namespace
}  // namespace rumi::tool
