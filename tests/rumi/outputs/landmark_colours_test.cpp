// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/landmark_colours.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "bus/wire/image_stream.h"
#include "camera_driver/open_source.h"
#include "map_server/outputs/ply_file.h"
#include "tests/formats/recording.h"
#include "tests/rumi/small_atlas.h"

namespace rumi::tool {
namespace {

using map_server::Colour;
using testing::TemporaryFolder;

constexpr int kKeyframes = 4, kLandmarks = 20;

// Returns the colour in which a landmark is drawn.
Colour true_colour(int landmark) {
  const auto channel = [landmark](int step) { return static_cast<uint8_t>(40 + landmark * step % 200); };
  return {channel(37), channel(61), channel(97)};
}

// Writes a recording with an image for every keyframe of the submap, `scale` times as large as the submap's images, and
// other images in between. Each landmark is drawn at its keypoint, but landmark 0 is hidden in the second keyframe.
void write_recording(const Submap& submap, const std::filesystem::path& folder, int scale = 1) {
  const Camera& camera = submap.camera;
  std::filesystem::create_directories(folder / "rgb");
  std::string list;
  for (const auto& [id, keyframe] : submap.keyframes) {
    cv::Mat image(camera.height * scale, camera.width * scale, CV_8UC3, cv::Scalar(1, 2, 3));
    const std::string between = fmt::format("rgb/{}.png", 2 * id + 1), name = fmt::format("rgb/{}.png", 2 * id);
    cv::imwrite(folder / between, image);
    for (int i = 0; i < kLandmarks; ++i) {
      const Colour colour = id == 1 && i == 0 ? Colour{255, 0, 255} : true_colour(i);
      const Eigen::Vector2f at = keyframe.features->keypoints[i].pixel * static_cast<float>(scale);
      cv::circle(image, cv::Point(cvRound(at.x()), cvRound(at.y())), 2 * scale,
                 cv::Scalar(colour.blue, colour.green, colour.red), cv::FILLED);
    }
    cv::imwrite(folder / name, image);
    list += fmt::format("{:.6f} {}\n{:.6f} {}\n", 1e-6 * static_cast<double>(keyframe.utime_us), name,
                        1e-6 * static_cast<double>(keyframe.utime_us) + 0.03, between);
  }
  testing::write_file(folder / "rgb.txt", list);
  testing::write_file(
      folder / "calibration.yaml",
      fmt::format("fx: {}\nfy: {}\ncx: {}\ncy: {}\nwidth: {}\nheight: {}\n", camera.fx * scale, camera.fy * scale,
                  camera.cx * scale, camera.cy * scale, camera.width * scale, camera.height * scale));
}

std::unique_ptr<camera_driver::ImageSource> open(const std::filesystem::path& folder) {
  camera_driver::OpenedSource opened = camera_driver::open_recording(folder.string(), {});
  EXPECT_EQ(opened.error_text(), "");
  return std::move(*opened);
}

map_server::Atlas atlas_of(Submap submap, int64_t stream) {
  submap.stream = stream;
  map_server::Atlas atlas;
  atlas.restore_submap({.submap = submap, .in_map = true, .placement = {}});
  return atlas;
}

void expect_true_colours(const SeenColours& seen) {
  EXPECT_EQ(seen.colours.size(), kLandmarks);
  for (const auto& [landmark, colour] : seen.colours) EXPECT_EQ(colour, true_colour(landmark.id)) << landmark.id;
}

TEST(LandmarkColours, AreThoseOfTheImagesWhateverStandsBeforeALandmarkOnce) {
  const TemporaryFolder folder;
  const Submap submap = make_test_submap(kKeyframes, kLandmarks);
  write_recording(submap, folder.path());
  const auto recording = open(folder.path());
  int64_t stream = 0, images = 0;
  for (; const auto image = recording->next(); ++images) stream = stream_of(*image);
  EXPECT_EQ(images, 2 * kKeyframes);

  const SeenColours seen = landmark_colours(atlas_of(submap, stream), *recording);
  EXPECT_EQ(seen.keyframes, 3) << "the first, one in the middle and the last";
  EXPECT_EQ(seen.seen, seen.keyframes);
  expect_true_colours(seen);
}

TEST(LandmarkColours, AreFoundInImagesThatAreLargerThanThoseThatAreTracked) {
  const TemporaryFolder folder;
  const Submap submap = make_test_submap(kKeyframes, kLandmarks);
  write_recording(submap, folder.path(), 2);
  const auto recording = open(folder.path());
  expect_true_colours(landmark_colours(atlas_of(submap, stream_of(*recording->next())), *recording));
}

TEST(LandmarkColours, OfImagesThatNameNoStreamAreFoundByTheTimesAlone) {
  const TemporaryFolder folder;
  const Submap submap = make_test_submap(kKeyframes, kLandmarks);
  write_recording(submap, folder.path());
  expect_true_colours(landmark_colours(atlas_of(submap, submap.key.session), *open(folder.path())));
}

TEST(LandmarkColours, AreNotTakenFromAnotherRecordingOfTheSameTimes) {
  const TemporaryFolder folder;
  const Submap submap = make_test_submap(kKeyframes, kLandmarks);
  write_recording(submap, folder.path());
  const SeenColours seen = landmark_colours(atlas_of(submap, 12345), *open(folder.path()));
  EXPECT_EQ(seen.seen, 0);
  EXPECT_TRUE(seen.colours.empty());
}

TEST(LandmarkColours, AreInTheFilesOfAMap) {
  const TemporaryFolder folder;
  const map_server::Atlas atlas = atlas_of(make_test_submap(kKeyframes, kLandmarks), 7);
  const auto first_colour = [&](const map_server::LandmarkColours& colours) {
    EXPECT_EQ(write_ply(atlas, folder / "map.ply", colours).error_text(), "");
    const std::string text = testing::read_file(folder / "map.ply");
    const char* vertex = text.data() + text.find("end_header\n") + 11;
    const auto byte = [vertex](int i) { return static_cast<uint8_t>(vertex[12 + i]); };
    return Colour{byte(0), byte(1), byte(2)};
  };
  EXPECT_EQ(first_colour({{{{1, 1}, 0}, {9, 8, 7}}}), (Colour{9, 8, 7}));
  EXPECT_EQ(first_colour({{{{1, 1}, 5}, {9, 8, 7}}}), map_server::submap_colour({1, 1})) << "where it is not known";
}

}  // namespace
}  // namespace rumi::tool
