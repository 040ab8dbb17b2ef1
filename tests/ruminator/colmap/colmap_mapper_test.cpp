// SPDX-License-Identifier: BSD-3-Clause
// Runs the real COLMAP, from our database to its model.
#include "ruminator/colmap/colmap_mapper.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <stdexcept>
#include <vector>

#include "ruminator/colmap/colmap_database.h"
#include "ruminator/colmap/write_model.h"
#include "slam/geometry/alignment.h"
#include "tests/ruminator/colmap/mapper_command.h"
#include "tests/slam/synthetic_scene.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using testing::TemporaryFolder;
using Kind = MapperOutcome::Kind;
using testing::command_for;
using testing::kNever;

// Cameras on a curve in front of a cloud of landmarks. Each landmark that a camera sees is a keypoint.
struct Scene {
  std::vector<SE3> cam_from_world;
  std::vector<WindowImage> images;
  std::vector<ImagePair> pairs;
  std::vector<std::vector<int>> landmark_of_keypoint;
};

Scene make_scene(int cameras, int landmarks, double noise_px) {
  Scene s;
  SyntheticScene synthetic(1);
  const Camera camera = test_camera();
  const std::vector<Eigen::Vector3d> cloud = synthetic.cloud(landmarks);
  for (int i = 0; i < cameras; ++i) {
    const double u = i - 0.5 * (cameras - 1);
    s.cam_from_world.push_back(SyntheticScene::pose(0.15 * u, 0.02 * u * u, 0.05 * u, -0.03 * u, 0.01 * u));
    WindowImage& image = s.images.emplace_back();
    image.name = std::to_string(i);
    s.landmark_of_keypoint.emplace_back();
    for (int l = 0; l < landmarks; ++l) {
      const Eigen::Vector3d p = s.cam_from_world.back() * cloud[static_cast<size_t>(l)];
      if (p.z() <= 0) continue;
      const Eigen::Vector2d pixel = camera.project_undistorted(p) + synthetic.noise(noise_px);
      if (!camera.contains(pixel)) continue;
      image.keypoints.push_back(pixel.cast<float>());
      s.landmark_of_keypoint.back().push_back(l);
    }
  }
  for (int a = 0; a < cameras; ++a)
    for (int b = 0; b < a; ++b) {  // the later image comes first, so that the database has to swap them
      ImagePair& pair = s.pairs.emplace_back();
      pair.first = a, pair.second = b;
      const auto& la = s.landmark_of_keypoint[static_cast<size_t>(a)];
      const auto& lb = s.landmark_of_keypoint[static_cast<size_t>(b)];
      for (size_t i = 0, j = 0; i < la.size() && j < lb.size();) {
        if (la[i] == lb[j])
          pair.matches.emplace_back(i++, j++);
        else if (la[i] < lb[j])
          ++i;
        else
          ++j;
      }
    }
  return s;
}

std::vector<int> keypoint_counts(const Scene& s) {
  std::vector<int> counts;
  for (const WindowImage& image : s.images) counts.push_back(static_cast<int>(image.keypoints.size()));
  return counts;
}

bool is_missing(const MapperOutcome& outcome) {
  return outcome.kind == Kind::kNotStarted &&
         outcome.models.error_text().find("not found in PATH") != std::string::npos;
}

TEST(ColmapMapper, RebuildsASceneFromOurDatabase) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(10, 400, 0.5);
  ASSERT_EQ(write_colmap_database(folder / "database.db", test_camera(), scene.images, scene.pairs).error_text(), "");
  MapperCommand command = command_for(folder, "models");
  command.keypoint_counts = keypoint_counts(scene);
  std::vector<int> registered;
  command.progress = [&](int images) { registered.push_back(images); };
  ColmapMapper mapper("colmap");
  const MapperOutcome outcome = mapper.run(command, {}, kNever);
  if (is_missing(outcome)) GTEST_SKIP() << "SKIPPED: " << outcome.models.error_text();
  ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.models.error_text();
  ASSERT_EQ(outcome.models->size(), 1U);
  EXPECT_THAT(registered, ElementsAre(2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_GT(outcome.cpu_s, 0);
  EXPECT_NE(mapper.version(), "");
  const SparseModel& model = outcome.models->at(0);
  ASSERT_EQ(model.cam_from_world.size(), scene.images.size());
  EXPECT_EQ(model.fx, test_camera().fx);
  EXPECT_EQ(model.fy, test_camera().fy);

  std::vector<Eigen::Vector3d> found, truth;
  for (const auto& [image, pose] : model.cam_from_world) {
    found.push_back(pose.center());
    truth.push_back(scene.cam_from_world[static_cast<size_t>(image)].center());
  }
  const auto truth_from_found = umeyama(found, truth);
  ASSERT_TRUE(truth_from_found);
  for (size_t i = 0; i < found.size(); ++i) EXPECT_LT((*truth_from_found * found[i] - truth[i]).norm(), 0.02) << i;

  // All observations of a track are of one landmark, so image and keypoint indices are ours.
  EXPECT_GT(model.points.size(), 300U);
  double squared_px = 0;
  int observations = 0;
  for (const SparseModel::Point& point : model.points)
    for (const auto& [image, keypoint] : point.track) {
      const auto& of_keypoint = scene.landmark_of_keypoint[static_cast<size_t>(image)];
      const auto& [first_image, first_keypoint] = point.track[0];
      EXPECT_EQ(of_keypoint[static_cast<size_t>(keypoint)],
                scene.landmark_of_keypoint[static_cast<size_t>(first_image)][static_cast<size_t>(first_keypoint)]);
      const Eigen::Vector3d p = model.cam_from_world.at(image) * point.position;
      const Eigen::Vector2d measured =
          scene.images[static_cast<size_t>(image)].keypoints[static_cast<size_t>(keypoint)].cast<double>();
      squared_px += (test_camera().project_undistorted(p) - measured).squaredNorm();
      ++observations;
    }
  EXPECT_LT(std::sqrt(squared_px / observations), 0.75);  // 0.5 px of noise on each axis
}

// The images of the input model keep their poses, and an image that it lacks is added.
TEST(ColmapMapper, ExtendsAModel) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(8, 300, 0.5);
  std::vector<ImagePair> pairs_of_seven;
  for (const ImagePair& pair : scene.pairs)
    if (pair.first < 7) pairs_of_seven.push_back(pair);
  const std::string file = folder / "database.db";
  ASSERT_EQ(write_colmap_database(file, test_camera(), scene.images, pairs_of_seven).error_text(), "");
  MapperCommand command = command_for(folder, "seven");
  command.keypoint_counts = keypoint_counts(scene);
  MapperSettings settings;
  settings.min_model_size = 3;
  ColmapMapper mapper("colmap");
  const MapperOutcome seven = mapper.run(command, settings, kNever);
  if (is_missing(seven)) GTEST_SKIP() << "SKIPPED: " << seven.models.error_text();
  ASSERT_EQ(seven.kind, Kind::kModels) << seven.models.error_text();
  ASSERT_EQ(seven.models->at(0).cam_from_world.size(), 7U);

  ASSERT_EQ(write_colmap_database(file, test_camera(), scene.images, scene.pairs).error_text(), "");
  // Extends a model as COLMAP writes it (in more files since 3.12), and one as Rumi writes it.
  const std::string ours = folder / "ours";
  std::filesystem::create_directory(ours);
  ASSERT_EQ(write_colmap_model(ours, test_camera(), scene.images, seven.models->at(0)).error_text(), "");
  command.fix_existing_images = true;
  for (const std::string& input : {folder / "seven/0", ours}) {
    command.input_model = input;
    command.output_folder = input + "-eight";
    const MapperOutcome eight = mapper.run(command, settings, kNever);
    ASSERT_EQ(eight.kind, Kind::kModels) << input << ": " << eight.models.error_text();
    ASSERT_EQ(eight.models->size(), 1U);
    ASSERT_EQ(eight.models->at(0).cam_from_world.size(), 8U) << input;
    for (const auto& [image, pose] : seven.models->at(0).cam_from_world)
      EXPECT_LT((eight.models->at(0).cam_from_world.at(image).center() - pose.center()).norm(), 1e-9) << input << image;
  }
}

TEST(ColmapMapper, IsRepeatableToTheBit) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(10, 400, 0.5);
  ColmapMapper mapper("colmap");
  for (const char* name : {"first", "second"}) {
    ASSERT_EQ(write_colmap_database(folder / "database.db", test_camera(), scene.images, scene.pairs).error_text(), "");
    MapperCommand command = command_for(folder, name);
    command.keypoint_counts = keypoint_counts(scene);
    const MapperOutcome outcome = mapper.run(command, {}, kNever);
    if (is_missing(outcome)) GTEST_SKIP() << "SKIPPED: " << outcome.models.error_text();
    ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.models.error_text();
  }
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"})
    EXPECT_EQ(testing::read_file(folder / "first/0/" + name), testing::read_file(folder / "second/0/" + name)) << name;
}

TEST(ColmapMapper, FindsNoModelInImagesWithoutPairs) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(5, 100, 0.5);
  ASSERT_EQ(write_colmap_database(folder / "database.db", test_camera(), scene.images, {}).error_text(), "");
  const MapperOutcome outcome = ColmapMapper("colmap").run(command_for(folder, "models"), {}, kNever);
  if (is_missing(outcome)) GTEST_SKIP() << "SKIPPED: " << outcome.models.error_text();
  EXPECT_EQ(outcome.kind, Kind::kNoModel) << outcome.models.error_text();
  EXPECT_FALSE(outcome.retryable());
}

TEST(ColmapMapper, FillsTheDisk) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(10, 400, 0.5);
  ColmapMapper mapper("colmap");
  // The disk has room for the database and only a part of the model.
  const int result = testing::run_on_small_disk(folder.path().string(), 350'000, [&] {
    const std::string problem =
        write_colmap_database(folder / "database.db", test_camera(), scene.images, scene.pairs).error_text();
    if (!problem.empty()) throw std::runtime_error(problem);
    MapperCommand command = command_for(folder, "models");
    command.keypoint_counts = keypoint_counts(scene);
    const MapperOutcome outcome = mapper.run(command, {}, kNever);
    std::fprintf(stderr, "%s\n", outcome.models.error_text().c_str());
    if (is_missing(outcome)) return 50;
    return outcome.kind == Kind::kDiskFull ? 0 : 1;
  });
  if (result < 0) GTEST_SKIP() << "SKIPPED: no user namespaces here: cannot mount a small disk";
  if (result == 50) GTEST_SKIP() << "SKIPPED: colmap is missing";
  EXPECT_EQ(result, 0);
}

}  // namespace
}  // namespace rumi::ruminator
