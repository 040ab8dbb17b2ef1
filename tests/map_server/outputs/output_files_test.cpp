// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/output_files.h"
#include "map_server/outputs/frames_file.h"
#include "map_server/outputs/ply_file.h"
#include "map_server/outputs/trajectory_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <iterator>
#include <sstream>

#include "map_server/outputs/colmap_export.h"
#include "tests/map_server/place_map.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::map_server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_submap;
using testing::read_file;
using testing::TemporaryFolder;
using testing::update_atlas;

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

// One submap with three frames on one keyframe at (1, 2, 3) that looks along -z. Only the second frame has known
// standard deviations.
Submap small_submap(int32_t id) {
  Submap s = make_submap({7, id}, 5, 1, 1'700'000'000'000'042);
  Keyframe& keyframe = s.keyframes.begin()->second;
  const Eigen::Quaterniond half_turn(0, 0, 1, 0);
  keyframe.cam_from_submap = SE3(half_turn, Eigen::Vector3d(1, 2, 3)).inverse();
  s.frames.erase_from(std::next(s.frames.begin(), 3)->first);
  s.frames.change_all([](FramePose* frame) {
    frame->cam_from_keyframe = SE3();
    frame->sigmas = frame->utime_us == 1'700'000'000'033'375 ? PoseSigmas{0.5F, 0.0125F, 0.02F} : PoseSigmas();
  });
  return s;
}

TEST(Writers, SecondsAreExact) {
  EXPECT_EQ(seconds_text(0), "0.000000");
  EXPECT_EQ(seconds_text(1'700'000'000'000'042), "1700000000.000042");
  EXPECT_EQ(seconds_text(-1), "-0.000001");
  EXPECT_EQ(seconds_text(std::numeric_limits<int64_t>::max()), "9223372036854.775807");
  EXPECT_EQ(seconds_text(std::numeric_limits<int64_t>::min()), "-9223372036854.775808");
}

TEST(Writers, TrajectoryIsMapFromCam) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, small_submap(1));
  ASSERT_EQ(write_trajectory_tum(atlas, folder / "t.txt").error_text(), "");
  const std::string pose = " 1.000000000 2.000000000 3.000000000 0.000000000 1.000000000 0.000000000 0.000000000";
  EXPECT_THAT(lines(read_file(folder / "t.txt")),
              ElementsAre("1700000000.000042" + pose, "1700000000.033375" + pose, "1700000000.066708" + pose));
}

TEST(Writers, TrajectoryIsInTheMapsGauge) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, small_submap(1));
  Placement placement;
  placement.map_from_submap[0] = Sim3(2, Eigen::Quaterniond::Identity(), Eigen::Vector3d(10, 0, 0));
  testing::place_map(&atlas, {{{7, 1}, placement}});
  ASSERT_EQ(write_trajectory_tum(atlas, folder / "t.txt").error_text(), "");
  EXPECT_EQ(lines(read_file(folder / "t.txt"))[0],
            "1700000000.000042 12.000000000 4.000000000 6.000000000 0.000000000 1.000000000 0.000000000 0.000000000");
}

TEST(Writers, FramesTableTellsStateSubmapAndMap) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, small_submap(1));
  update_atlas(&atlas, make_submap({7, 2}, 3, 1, 1'800'000'000'000'000));  // has 4 frames, so it is the served map
  const int64_t t = 1'700'000'000'000'042;
  atlas.record_frame({t - 1}, {.session = 7, .state = TrackingState::kNotInitialized});
  atlas.record_frame({t}, {.session = 7, .state = TrackingState::kNotInitialized});  // gets its pose later
  atlas.record_frame({t + 33'333}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 1});
  atlas.record_frame({t + 40'000}, {.session = 7, .state = TrackingState::kRecentlyLost});
  atlas.record_frame({t + 50'000}, {.session = 7, .state = TrackingState::kLost});
  atlas.record_frame({1'800'000'000'000'000}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 2});
  ASSERT_EQ(write_frames_csv(atlas, folder / "frames.csv").error_text(), "");
  const auto table = lines(read_file(folder / "frames.csv"));
  ASSERT_EQ(table.size(), 1 + 3 + 3 + 4);
  EXPECT_EQ(table[0], "utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma,session");
  EXPECT_EQ(table[1], "1700000000000041,NOT_INITIALIZED,0,0,,,,7");
  EXPECT_EQ(table[2], "1700000000000042,NOT_INITIALIZED,1,0,,,,7");
  EXPECT_EQ(table[3], "1700000000033375,TRACKING,1,0,0.5,0.0125,0.02,7");
  EXPECT_EQ(table[4], "1700000000040042,RECENTLY_LOST,0,0,,,,7");
  EXPECT_EQ(table[5], "1700000000050042,LOST,0,0,,,,7");
  EXPECT_EQ(table[6], "1700000000066708,UNKNOWN,1,0,,,,7");  // its RUMI_TRACK message was lost
  EXPECT_EQ(table[7], "1800000000000000,TRACKING,2,1,,,,7");
}

TEST(Writers, DeviationsAreInTheUnitOfTheMap) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, small_submap(1));
  Placement placement;
  placement.map_from_submap[0] = Sim3(4, Eigen::Quaterniond::Identity(), Eigen::Vector3d(10, 0, 0));
  testing::place_map(&atlas, {{{7, 1}, placement}});
  ASSERT_EQ(write_frames_csv(atlas, folder / "frames.csv").error_text(), "");
  EXPECT_EQ(lines(read_file(folder / "frames.csv"))[2], "1700000000033375,UNKNOWN,1,1,2,0.0125,0.02,7");
}

TEST(Writers, PlyHoldsLandmarksAndCamerasOfTheServedMap) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 3, 6));
  update_atlas(&atlas, small_submap(2));
  ASSERT_EQ(write_ply(atlas, folder / "map.ply").error_text(), "");
  const std::string text = read_file(folder / "map.ply");
  const Submap& served = atlas.find({7, 1})->submap;
  const size_t vertices = served.landmarks.size() + served.frames.size();
  EXPECT_THAT(text, HasSubstr("element vertex " + std::to_string(vertices) + "\n"));
  const size_t body = text.find("end_header\n") + 11;
  EXPECT_EQ(text.size() - body, vertices * 15);
  float x = 0;
  std::memcpy(&x, text.data() + body, 4);
  EXPECT_EQ(x, static_cast<float>(served.landmarks.begin()->second.position.x()));
}

TEST(Writers, PlyHoldsAFusedLandmarkOnce) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 3, 2));
  update_atlas(&atlas, make_submap({7, -1}, 4, 2));
  std::map<SubmapKey, Placement> placements{{{7, 1}, {}}, {{7, -1}, {}}};
  const auto& front = atlas.find({7, 1})->submap.landmarks;
  const auto& back = atlas.find({7, -1})->submap.landmarks;
  for (int id = 20; id < 23; ++id) placements[{7, 1}].fused[id] = {{7, -1}, id};
  ASSERT_TRUE(front.contains(20) && front.contains(22) && back.contains(20) && back.contains(22));
  testing::place_map(&atlas, placements);
  ASSERT_EQ(write_ply(atlas, folder / "map.ply").error_text(), "");
  EXPECT_THAT(read_file(folder / "map.ply"),
              HasSubstr("comment " + std::to_string(front.size() + back.size() - 3) + " landmarks, then 8 camera"));
}

TEST(Writers, OutputFolderHasTheAgreedNamesAndNoLeftovers) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 5));
  update_atlas(&atlas, make_submap({7, 2}, 2, 2, 9'000'000));
  update_atlas(&atlas, make_submap({7, -1}, 3, 2, 12'000'000));
  update_atlas(&atlas, make_submap({8, 1}, 4, 2, 15'000'000));  // a submap of another run
  const std::string out = folder / "out";
  std::filesystem::create_directories(out + "/submaps");
  testing::write_file(out + "/submaps/009.txt", "from an earlier run");
  testing::write_file(out + "/submaps/notes.txt", "the user's");
  ASSERT_THAT(write_outputs(atlas, out), IsEmpty());
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out))
    if (entry.is_regular_file()) names.insert(std::filesystem::relative(entry.path(), out).string());
  EXPECT_EQ(names,
            (std::set<std::string>{"trajectory.txt", "frames.csv", "map.ply", "submaps/001.txt", "submaps/s7-001.txt",
                                   "submaps/s7-002.txt", "submaps/s7-b001.txt", "submaps/notes.txt"}));
  EXPECT_EQ(lines(read_file(out + "/submaps/s7-002.txt")).size(), 8);
  EXPECT_EQ(lines(read_file(out + "/trajectory.txt")).size(), 20);
}

// Session 8 has frames at the same times as session 7. Only those of sessions later than `after` are written.
TEST(Writers, TellOfTheFramesOfLaterSessionsOnly) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 5));
  Submap again = make_submap({8, 1}, 2, 2);
  again.stream = 8;
  update_atlas(&atlas, again);
  testing::place_map(&atlas, {{{7, 1}, {}}, {{8, 1}, {}}});
  const std::string out = folder / "out";
  ASSERT_THAT(write_outputs(atlas, out), IsEmpty());
  const size_t all = lines(read_file(out + "/trajectory.txt")).size();
  EXPECT_EQ(all, 20u + 8u);
  ASSERT_THAT(write_outputs(atlas, out, 7), IsEmpty());
  EXPECT_EQ(lines(read_file(out + "/trajectory.txt")).size(), 8u);
  EXPECT_EQ(lines(read_file(out + "/frames.csv")).size(), 1u + 8u);
  EXPECT_THAT(read_file(out + "/frames.csv"), HasSubstr(",8\n"));
  EXPECT_FALSE(std::filesystem::exists(out + "/submaps/s7-001.txt"));
}

TEST(Writers, EmptyAtlasGivesEmptyFiles) {
  const TemporaryFolder folder;
  ASSERT_THAT(write_outputs(Atlas(), folder / "out"), IsEmpty());
  EXPECT_EQ(read_file(folder / "out/trajectory.txt"), "");
  EXPECT_EQ(read_file(folder / "out/frames.csv"),
            "utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma,session\n");
  EXPECT_THAT(read_file(folder / "out/map.ply"), HasSubstr("element vertex 0\n"));
}

std::vector<std::string> files_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Writers, WhatCannotBeWrittenIsNamed) {
  const TemporaryFolder folder;
  testing::write_file(folder / "file", "");
  EXPECT_THAT(write_outputs(Atlas(), folder / "file"), ElementsAre(HasSubstr("file")));
  EXPECT_THAT(write_trajectory_tum(Atlas(), folder / "absent/t.txt").error_text(), HasSubstr("absent/t.txt"));
  std::filesystem::create_directory(folder / "t.txt");
  EXPECT_THAT(write_trajectory_tum(Atlas(), folder / "t.txt").error_text(), HasSubstr("t.txt"));
  EXPECT_EQ(files_in(folder.path()), (std::vector<std::string>{"file", "t.txt"})) << "nothing half written is left";
}

TEST(Writers, FullDiskKeepsTheOldFile) {
  const TemporaryFolder folder;
  const int result = testing::run_on_small_disk(folder.path().string(), 64'000, [&] {
    testing::write_file(folder / "map.ply", "old");
    Atlas atlas;
    update_atlas(&atlas, make_submap({7, 1}, 1, 400));
    const std::string problem = write_ply(atlas, folder / "map.ply").error_text();
    if (problem.find("map.ply: No space left") == std::string::npos) return 1;
    if (files_in(folder.path()) != std::vector<std::string>{"map.ply"}) return 2;
    return read_file(folder / "map.ply") == "old" ? 0 : 3;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

// A wall of points in front of cameras that move along x, observed without noise.
Submap wall_submap(const Camera& camera) {
  Submap s;
  s.key = {7, 1};
  s.camera = camera;
  s.revision = 1;
  for (int id = 0; id < 40; ++id) {
    Landmark& landmark = s.landmarks[id];
    landmark.id = id;
    landmark.position = {0.2 * (id % 8) - 0.7, 0.2 * (id / 8) - 0.4, 3 + 0.1 * (id % 3)};
    landmark.revision = 1;
  }
  for (int id = 0; id < 4; ++id) {
    Keyframe& keyframe = s.keyframes[id];
    keyframe = {.id = id,
                .utime_us = 1'000'000 * (id + 1),
                .cam_from_submap = {},
                .features = {},
                .landmark_ids = {},
                .revision = 1,
                .created_revision = 1};
    keyframe.cam_from_submap = SE3(so3_exp({0, 0.02 * id, 0}), Eigen::Vector3d(-0.1 * id, 0, 0));
    auto features = std::make_shared<Features>();
    for (const auto& [landmark, l] : s.landmarks)
      features->keypoints.push_back({camera.project(keyframe.cam_from_submap * l.position)->cast<float>(), 0, 0});
    features->descriptors.resize(features->keypoints.size());
    keyframe.features = features;
    keyframe.landmark_ids.assign(40, kNone);
    s.frames.set({keyframe.utime_us, id, SE3(), 1});
  }
  for (int keyframe = 0; keyframe < 4; ++keyframe)
    for (int landmark = 0; landmark < 40; ++landmark) s.add_observation(landmark, keyframe, landmark);
  Landmark& unseen = s.landmarks[99];  // no keyframe observes it
  unseen.id = 99;
  unseen.revision = 1;
  return s;
}

TEST(ColmapModel, TextFollowsItsConventions) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, wall_submap(testing::test_camera()));
  ASSERT_EQ(write_colmap_text(atlas, folder / "model").error_text(), "");
  const auto cameras = lines(read_file(folder / "model/cameras.txt"));
  EXPECT_THAT(cameras[1], ::testing::StartsWith("1 OPENCV 640 480 525.25 524.75 320 240 "));
  const auto images = lines(read_file(folder / "model/images.txt"));
  ASSERT_EQ(images.size(), 1 + 2 * 4);
  EXPECT_EQ(images[1], "1 1 0 0 0 0 0 0 1 1.000000.jpg");
  // The first point is at (-0.7, -0.4, 3): its pixel must be ours plus 0.5, as COLMAP counts from the corner of the
  // first pixel.
  std::istringstream points(images[2]);
  double x = 0, y = 0;
  points >> x >> y;
  const Eigen::Vector2d pixel = *testing::test_camera().project({-0.7, -0.4, 3});
  EXPECT_NEAR(x, pixel.x() + 0.5, 1e-4);
  EXPECT_NEAR(y, pixel.y() + 0.5, 1e-4);
  const auto cloud = lines(read_file(folder / "model/points3D.txt"));
  EXPECT_EQ(cloud.size(), 1 + 40);  // the unseen landmark is left out
}

// The tracked images have half the width and height of their files.
TEST(ColmapModel, AFileIsNamedAndMeasuredInItsOwnPixels) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, wall_submap(testing::test_camera()));
  ImageFiles files;
  for (const ImageId& image : colmap_images(atlas))
    if (image.utime_us == 1'000'000) files[image] = {"left/one.png", 1280, 960};
  ASSERT_EQ(files.size(), 1u);
  ASSERT_EQ(write_colmap_text(atlas, folder / "model", {}, files).error_text(), "");
  const auto cameras = lines(read_file(folder / "model/cameras.txt"));
  EXPECT_THAT(cameras[1], ::testing::StartsWith("1 OPENCV 1280 960 1050.5 1049.5 640 480 "));
  EXPECT_THAT(cameras[2], ::testing::StartsWith("2 OPENCV 640 480 525.25 524.75 320 240 "));
  const auto images = lines(read_file(folder / "model/images.txt"));
  EXPECT_EQ(images[1], "1 1 0 0 0 0 0 0 1 left/one.png");
  std::istringstream points(images[2]);
  double x = 0, y = 0;
  points >> x >> y;
  const Eigen::Vector2d pixel = *testing::test_camera().project({-0.7, -0.4, 3});
  EXPECT_NEAR(x, 2 * (pixel.x() + 0.5), 1e-4);
  EXPECT_NEAR(y, 2 * (pixel.y() + 0.5), 1e-4);

  files.begin()->second.name = "my image.png";
  EXPECT_THAT(write_colmap_text(atlas, folder / "model", {}, files).error_text(),
              HasSubstr("give --format colmap-bin"));
  EXPECT_EQ(write_colmap_binary(atlas, folder / "model", {}, files).error_text(), "");
}

TEST(ColmapModel, LensDecidesTheModel) {
  Camera with_k3 = testing::test_camera();
  with_k3.k3 = 0.01;
  Camera fisheye = testing::test_camera();
  fisheye.model = Camera::Model::kKannalaBrandt;
  fisheye.p1 = fisheye.p2 = 0;
  fisheye.k3 = 0.003, fisheye.k4 = -0.001;
  const std::pair<Camera, std::string> cases[] = {{with_k3, "1 FULL_OPENCV 640 480 "},
                                                  {fisheye, "1 OPENCV_FISHEYE 640 480 "}};
  for (const auto& [camera, start] : cases) {
    const TemporaryFolder folder;
    Atlas atlas;
    update_atlas(&atlas, wall_submap(camera));
    ASSERT_EQ(write_colmap_text(atlas, folder / "model").error_text(), "");
    EXPECT_THAT(lines(read_file(folder / "model/cameras.txt"))[1], ::testing::StartsWith(start));
  }
}

// Two submaps of the same images, each with its own gauge: every image and every point is written once.
TEST(ColmapModel, WhatSubmapsHaveInCommonIsThereOnce) {
  const TemporaryFolder folder;
  Atlas atlas;
  const Submap front = wall_submap(testing::test_camera());
  const Sim3 back_from_front(3, so3_exp({0.1, 0.2, 0.3}), {1, 2, 3});
  Placement placement;
  placement.map_from_submap[0] = back_from_front;
  Submap back = place(front, placement);
  back.key.id = -1;
  back.kind = SubmapKind::kBack;
  back.remove_keyframe(0, 1);  // so that only the front submap has this image
  for (int id = 0; id < 10; ++id) back.remove_landmark(id);
  for (const Submap* submap : {&front, static_cast<const Submap*>(&back)})
    EXPECT_TRUE(atlas.change_submap(submap->key, [&](Submap* s) {
      *s = *submap;
      return Result<>();
    }));
  placement.map_from_submap[0] = back_from_front.inverse();
  testing::place_map(&atlas, {{{7, 1}, {}}, {{7, -1}, placement}});
  ASSERT_EQ(write_colmap_text(atlas, folder / "model").error_text(), "");
  const auto images = lines(read_file(folder / "model/images.txt"));
  ASSERT_EQ(images.size(), 1 + 2 * 4);
  for (int i = 0; i < 4; ++i)
    EXPECT_THAT(images[1 + 2 * i], ::testing::EndsWith(" 1 " + std::to_string(i + 1) + ".000000.jpg"));
  const auto cloud = lines(read_file(folder / "model/points3D.txt"));
  ASSERT_EQ(cloud.size(), 1 + 40);
  for (size_t i = 1; i < cloud.size(); ++i) {
    std::istringstream in(cloud[i]);
    std::vector<double> numbers{std::istream_iterator<double>(in), {}};
    EXPECT_EQ(numbers.size(), 8 + 2 * 4) << cloud[i];  // all four images see the point
    EXPECT_LT(numbers[7], 1e-3);                       // the mean error, px
  }
}

// COLMAP itself reads both formats, and finds that the model is exact.
TEST(ColmapModel, ColmapReadsIt) {
  if (std::system("colmap help >/dev/null 2>&1") != 0) GTEST_SKIP() << "colmap is not installed";
  Camera with_k3 = testing::test_camera();
  with_k3.k3 = 0.01;
  for (const Camera& camera : {testing::test_camera(), with_k3}) {
    const TemporaryFolder folder;
    Atlas atlas;
    update_atlas(&atlas, wall_submap(camera));
    ASSERT_EQ(write_colmap_text(atlas, folder / "text").error_text(), "");
    ASSERT_EQ(write_colmap_binary(atlas, folder / "binary").error_text(), "");
    for (const char* form : {"text", "binary"}) {
      const std::string report = folder / (std::string(form) + ".report");
      ASSERT_EQ(std::system(("colmap model_analyzer --path " + (folder / form) + " >" + report + " 2>&1").c_str()), 0)
          << read_file(report);
      EXPECT_THAT(read_file(report), HasSubstr("Registered images: 4")) << form;
      EXPECT_THAT(read_file(report), HasSubstr("Points: 40")) << form;
      EXPECT_THAT(read_file(report), HasSubstr("Observations: 160")) << form;
    }
    // The initial cost of COLMAP's bundle adjustment is that of our numbers: if a convention differed by half a pixel
    // or a lens term, it would not be near 0.
    std::filesystem::create_directory(folder / "adjusted");
    const std::string adjust = "colmap bundle_adjuster --input_path " + (folder / "binary") + " --output_path " +
                               (folder / "adjusted") + " --BundleAdjustment.max_num_iterations 1 >" +
                               (folder / "ba.report") + " 2>&1";
    ASSERT_EQ(std::system(adjust.c_str()), 0) << read_file(folder / "ba.report");
    const std::string report = read_file(folder / "ba.report");
    const size_t at = report.find("Initial cost :");
    ASSERT_NE(at, std::string::npos) << report;
    EXPECT_LT(std::stod(report.substr(at + 14)), 1e-3) << report;
    const std::string convert = "colmap model_converter --input_path " + (folder / "binary") + " --output_path " +
                                (folder / "adjusted") + " --output_type TXT >/dev/null 2>&1";
    ASSERT_EQ(std::system(convert.c_str()), 0);
    EXPECT_EQ(lines(read_file(folder / "adjusted/points3D.txt")).size(), 3 + 40);
  }
}

}  // namespace
}  // namespace rumi::map_server
