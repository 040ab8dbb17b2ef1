// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/window_job.h"

#include <gmock/gmock.h>

#include <limits>
#include <random>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "lcmtypes/rumi/window_job_t.hpp"
#include "tests/ruminator/test_jobs.h"

namespace rumi::ruminator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::small_job;

class WindowJobTest : public ::testing::Test {
 protected:
  std::string file() const { return folder_ / "7-1.window"; }
  void write(const WindowJob& job) { ASSERT_EQ(write_window_job(file(), job).error_text(), ""); }

  struct Events {
    window_job_t manifest;
    std::vector<image_t> images;
  };
  Events events() const {
    Events events;
    LogReader log(file());
    EXPECT_TRUE(Bus::decode(log.next()->data, &events.manifest));
    while (const auto event = log.next()) EXPECT_TRUE(Bus::decode(event->data, &events.images.emplace_back()));
    return events;
  }
  // Writes the file, whatever the events contain, and returns the Error of reading it.
  std::string error_of(const Events& events) {
    {
      LogWriter log(file());
      log.write(1, kWindowJobChannel, encode_message(events.manifest));
      for (const image_t& image : events.images) log.write(image.utime, channels::kCamera, encode_message(image));
    }
    return read_window_job(file()).error_text();
  }
  // Returns the Error for a job with changed manifest or images.
  std::string error_with(const std::function<void(Events&)>& change) {
    write(small_job());
    Events changed = events();
    change(changed);
    return error_of(changed);
  }

  testing::TemporaryFolder folder_;
};

TEST_F(WindowJobTest, ComesBackAsItWas) {
  WindowJob job = small_job(5, 123456789);
  job.window.by_place = true;
  write(job);
  const Result<WindowJobFile> read = read_window_job(file());
  ASSERT_TRUE(read) << read.error_text();
  EXPECT_EQ(read->broken_images, 0);
  const RuminationWindow &a = job.window, &b = read->job.window;
  EXPECT_EQ(std::tie(a.id, a.session, a.submap_before, a.submap_after, a.lost_utime_us, a.resumed_utime_us,
                     a.gap_frames, a.by_place, a.reason),
            std::tie(b.id, b.session, b.submap_before, b.submap_after, b.lost_utime_us, b.resumed_utime_us,
                     b.gap_frames, b.by_place, b.reason));
  const auto expect_same = [](const std::vector<Sample>& x, const std::vector<Sample>& y) {
    ASSERT_EQ(x.size(), y.size());
    for (size_t i = 0; i < x.size(); ++i) {
      EXPECT_EQ(x[i].utime_us, y[i].utime_us);
      EXPECT_EQ(x[i].is_keyframe, y[i].is_keyframe);
      EXPECT_EQ(x[i].submap_id, y[i].submap_id);
      EXPECT_EQ(x[i].cam_from_submap.translation, y[i].cam_from_submap.translation);
      EXPECT_EQ(x[i].cam_from_submap.rotation.coeffs(), y[i].cam_from_submap.rotation.coeffs());
    }
  };
  expect_same(a.approach, b.approach);
  expect_same(a.gap, b.gap);
  expect_same(a.departure, b.departure);
  EXPECT_EQ(job.camera.fx, read->job.camera.fx);
  EXPECT_EQ(job.camera.p2, read->job.camera.p2);
  ASSERT_EQ(job.images.size(), read->job.images.size());
  for (size_t i = 0; i < job.images.size(); ++i)
    EXPECT_EQ(encode_message(job.images[i]), encode_message(read->job.images[i]));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1) << "nothing else remains";

  const Result<WindowJob> manifest = read_window_manifest(file());
  ASSERT_TRUE(manifest) << manifest.error_text();
  EXPECT_EQ(manifest->window.gap.size(), a.gap.size());
  EXPECT_TRUE(manifest->images.empty());
}

TEST_F(WindowJobTest, TheSameJobGivesTheSameFile) {
  write(small_job());
  const std::string first = testing::read_file(file());
  write(small_job());
  EXPECT_EQ(testing::read_file(file()), first);
}

TEST_F(WindowJobTest, SamplesWithoutImageAreNoError) {
  WindowJob job = small_job();
  job.images.erase(job.images.begin() + 4);
  write(job);
  const Result<WindowJobFile> read = read_window_job(file());
  ASSERT_TRUE(read) << read.error_text();
  EXPECT_EQ(read->job.images.size(), 11);
  EXPECT_EQ(read->job.window.gap.size(), 5);
}

TEST_F(WindowJobTest, EveryTruncationIsAnError) {
  write(small_job());
  const std::string bytes = testing::read_file(file());
  for (size_t size = 0; size < bytes.size(); size += 1 + size / 50) {
    testing::write_file(file(), bytes.substr(0, size));
    EXPECT_THAT(read_window_job(file()).error_text(), HasSubstr("7-1.window")) << size;
  }
  // A file that ends exactly between two events is incomplete, too.
  EXPECT_THAT(error_with([](Events& e) { e.images.pop_back(); }),
              AllOf(HasSubstr("7-1.window"), HasSubstr("1 of 12 images are missing, the first is")));
}

TEST_F(WindowJobTest, NoDamageIsSurvivedInSilenceOrCrashes) {
  write(small_job());
  const std::string bytes = testing::read_file(file());
  std::mt19937 random(1);
  int refused = 0;
  constexpr int kTrials = 3000;
  for (int i = 0; i < kTrials; ++i) {
    std::string damaged = bytes;
    // Every second trial damages only the beginning, where the manifest is.
    const size_t range = i % 2 == 0 ? 2000 : damaged.size();
    for (int k = 0; k < 3; ++k) damaged[random() % range] = static_cast<char>(random());
    testing::write_file(file(), damaged);
    const Result<WindowJobFile> read = read_window_job(file());
    refused += !read;
    if (read) {
      EXPECT_LE(read->job.images.size(), 12u);
    }
  }
  EXPECT_GT(refused, kTrials / 4);
}

TEST_F(WindowJobTest, WhatIsNoWindowIsNamed) {
  EXPECT_THAT(read_window_job(file()).error_text(), AllOf(HasSubstr("7-1.window"), HasSubstr("No such file")));
  testing::write_file(file(), "");
  EXPECT_THAT(read_window_job(file()).error_text(), HasSubstr("is empty"));
  testing::write_file(file(), "this is text, and more than the header of an event");
  EXPECT_THAT(read_window_job(file()).error_text(), HasSubstr("not an lcm log"));
  LogWriter(file()).write(1, "CAMERA", encode_message(small_job().images[0]));
  EXPECT_THAT(read_window_job(file()).error_text(), HasSubstr("is no window: begins with an event on CAMERA"));
  LogWriter(file()).write(1, kWindowJobChannel, encode_message(small_job().images[0]));
  EXPECT_THAT(read_window_job(file()).error_text(), HasSubstr("its manifest cannot be read: it is no window_job_t"));
  EXPECT_THAT(read_window_job(folder_.path().string()).error_text(), HasSubstr("is not a file"));
}

TEST_F(WindowJobTest, AnotherVersionIsToldFromDamage) {
  write(small_job());
  std::vector<uint8_t> manifest = encode_message(events().manifest);
  const auto error_of_bytes = [&](const std::vector<uint8_t>& bytes) {
    LogWriter(file()).write(1, kWindowJobChannel, bytes);
    return read_window_job(file()).error_text();
  };
  std::vector<uint8_t> older = manifest;
  older[0] ^= 0xff;
  EXPECT_THAT(error_of_bytes(older),
              AllOf(HasSubstr("7-1.window"), HasSubstr("no window_job_t of this version"),
                    HasSubstr("its fingerprint is 0x9d89e149b63ce14b, this program reads 0x6289e149b63ce14b")));
  manifest.pop_back();
  EXPECT_THAT(error_of_bytes(manifest), HasSubstr("it is a damaged window_job_t"));
}

TEST_F(WindowJobTest, WhatIsLargerThanAnyWindowIsNotRead) {
  write(small_job());
  std::filesystem::resize_file(file(), static_cast<uintmax_t>(kMaxWindowBytes) + 1);
  EXPECT_THAT(read_window_job(file()).error_text(), AllOf(HasSubstr("7-1.window"), HasSubstr("has 2147483649 bytes")));
  EXPECT_THAT(read_window_manifest(file()).error_text(), HasSubstr("has 2147483649 bytes"));
}

TEST_F(WindowJobTest, WrongNumbersAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto manifest_error = [&](const std::function<void(window_job_t&)>& change) {
    return error_with([&](Events& e) { change(e.manifest); });
  };
  EXPECT_EQ(error_with([](Events&) {}), "");
  EXPECT_THAT(manifest_error([&](auto& m) { m.samples[2].cam_from_submap.trans[1] = nan; }),
              HasSubstr("samples[2].cam_from_submap"));
  EXPECT_THAT(manifest_error([&](auto& m) { m.samples[10].cam_from_submap.quat[0] = 3; }),
              HasSubstr("samples[10].cam_from_submap"));
  EXPECT_EQ(manifest_error([&](auto& m) { m.samples[5].cam_from_submap.trans[1] = nan; }), "") << "tracked in none";
  EXPECT_THAT(manifest_error([](auto& m) { m.window.window_id = 0; }), HasSubstr("window_id 0"));
  EXPECT_THAT(manifest_error([](auto& m) { m.window.gap_frames = -2; }), HasSubstr("gap_frames -2"));
  EXPECT_THAT(manifest_error([](auto& m) { m.window.session = -4; }), HasSubstr("session -4"));
  EXPECT_THAT(manifest_error([](auto& m) { m.window.lost_utime = -1; }), HasSubstr("lost_utime -1"));
  EXPECT_THAT(manifest_error([](auto& m) { m.window.resumed_utime = INT64_MAX; }), HasSubstr("resumed_utime 9223"));
  EXPECT_THAT(manifest_error([](auto& m) { m.samples[3].utime = 17; }), HasSubstr("samples[3].utime 17"));
  EXPECT_THAT(manifest_error([](auto& m) { m.samples[3].utime = m.window.approach_utime[3] = -17; }),
              HasSubstr("samples[3].utime -17: no time"));
  EXPECT_THAT(manifest_error([](auto& m) { m.samples[6].utime = m.window.gap_utime[2] = m.samples[5].utime; }),
              HasSubstr("samples[6].utime"));
  EXPECT_THAT(manifest_error([](auto& m) {
                m.samples.pop_back();
                --m.nsamples;
              }),
              HasSubstr("nsamples 11: approach, gap and departure list 12 frames"));
  EXPECT_THAT(manifest_error([](auto& m) {
                const window_t empty{};
                m.samples.clear();
                m.nsamples = 0;
                m.window.approach_utime = m.window.gap_utime = m.window.departure_utime = {};
                m.window.napproach = m.window.ngap = m.window.ndeparture = 0;
              }),
              HasSubstr("without frames"));
  EXPECT_THAT(manifest_error([](auto& m) { m.calibration = "fx: nonsense"; }), HasSubstr("calibration"));
}

TEST_F(WindowJobTest, ImagesThatDoNotBelongAreNamed) {
  EXPECT_THAT(error_with([](Events& e) { e.images.push_back(e.images[3]); }), HasSubstr("twice"));
  EXPECT_THAT(error_with([](Events& e) { e.images[2].utime = 5; }), HasSubstr("image 5"));
  EXPECT_THAT(error_with([](Events& e) { std::swap(e.images[2], e.images[3]); }), HasSubstr("not later than"));
  EXPECT_THAT(error_with([](Events& e) { e.images[2].width = 320; }),
              HasSubstr("is 320x120, the calibration is for 160x120"));
  write(small_job());
  const Events good = events();
  {
    LogWriter log(file());
    log.write(1, kWindowJobChannel, encode_message(good.manifest));
    log.write(2, "RUMI_TRACK", {});
  }
  EXPECT_THAT(read_window_job(file()).error_text(), HasSubstr("an event on RUMI_TRACK"));
}

TEST_F(WindowJobTest, BrokenImagesAreLeftOutAndCounted) {
  write(small_job());
  Events changed = events();
  changed.images[3].data.assign(100, 7);  // not a JPEG
  changed.images[3].size = 100;
  ASSERT_EQ(error_of(changed), "");
  const Result<WindowJobFile> read = read_window_job(file());
  EXPECT_EQ(read->broken_images, 1);
  EXPECT_EQ(read->job.images.size(), 11);
}

TEST_F(WindowJobTest, WhatCouldNotBeReadIsNotWritten) {
  WindowJob job = small_job();
  job.images[1].height = 7;
  EXPECT_THAT(write_window_job(file(), job).error_text(), AllOf(HasSubstr("not written"), HasSubstr("is 160x7")));
  job = small_job();
  job.camera.fx = 0;
  EXPECT_THAT(write_window_job(file(), job).error_text(), HasSubstr("fx"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(WindowJobTest, AFullDiskLeavesNothing) {
  const int result = testing::run_on_small_disk(folder_.path().string(), 40'000, [&] {
    const std::string error = write_window_job(file(), small_job()).error_text();
    if (error.find("No space left") == std::string::npos) {
      std::fprintf(stderr, "%s\n", error.c_str());
      return 1;
    }
    return std::filesystem::is_empty(folder_.path()) ? 0 : 2;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

}  // namespace
}  // namespace rumi::ruminator
