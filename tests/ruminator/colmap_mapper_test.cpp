// SPDX-License-Identifier: BSD-3-Clause
// COLMAP itself, from our database to its model.
#include <gmock/gmock.h>

#include <atomic>
#include <vector>

#include "ruminator/child_process.h"
#include "ruminator/colmap_database.h"
#include "ruminator/colmap_model.h"
#include "slam/geometry/alignment.h"
#include "tests/slam/synthetic_scene.h"
#include "tests/temporary_folder.h"

namespace rumi {
namespace {

using testing::TemporaryFolder;

// A camera on a curve before a cloud; every landmark it sees is a keypoint.
struct Scene {
  std::vector<SE3> cam_from_world;
  std::vector<ColmapImage> images;
  std::vector<ColmapPair> pairs;
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
    ColmapImage& image = s.images.emplace_back();
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
    for (int b = 0; b < a; ++b) {  // the later image first: the database has to turn them round
      ColmapPair& pair = s.pairs.emplace_back();
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
  for (const ColmapImage& image : s.images) counts.push_back(static_cast<int>(image.keypoints.size()));
  return counts;
}

TEST(ColmapMapper, RebuildsASceneFromOurDatabase) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(10, 400, 0.5);
  ASSERT_EQ(write_colmap_database(folder / "database.db", test_camera(), scene.images, scene.pairs), "");
  std::filesystem::create_directory(folder / "models");
  ChildCommand command;
  command.arguments = {"colmap",          "mapper",
                       "--database_path", folder / "database.db",
                       "--image_path",    folder.path().string(),
                       "--output_path",   folder / "models"};
  for (const char* option :
       {"ba_refine_focal_length=0", "ba_refine_extra_params=0", "ba_refine_principal_point=0", "extract_colors=0",
        "min_num_matches=15", "abs_pose_min_num_inliers=15", "init_min_tri_angle=4", "multiple_models=1",
        "min_model_size=5", "max_num_models=3", "num_threads=1"})
    command.arguments.push_back(std::string("--Mapper.") + option);
  command.environment = {"QT_QPA_PLATFORM=offscreen"};
  command.log_file = folder / "log";
  const std::atomic<bool> never = false;
  const ChildResult result = run_child(command, never);
  if (result.outcome == ChildResult::Outcome::kNotStarted) GTEST_SKIP() << "SKIPPED: " << result.describe();
  ASSERT_TRUE(result.ok()) << result.describe() << "\n" << result.last_output;

  const std::vector<std::string> folders = colmap_model_folders(folder / "models");
  ASSERT_EQ(folders.size(), 1U);
  const ColmapModelFile file = read_colmap_model(folders[0], keypoint_counts(scene));
  ASSERT_TRUE(file.ok()) << file.error;
  ASSERT_EQ(file.model.cam_from_world.size(), scene.images.size());
  EXPECT_EQ(file.model.fx, test_camera().fx);
  EXPECT_EQ(file.model.fy, test_camera().fy);

  std::vector<Eigen::Vector3d> found, truth;
  for (const auto& [image, pose] : file.model.cam_from_world) {
    found.push_back(pose.center());
    truth.push_back(scene.cam_from_world[static_cast<size_t>(image)].center());
  }
  const auto truth_from_found = umeyama(found, truth);
  ASSERT_TRUE(truth_from_found);
  for (size_t i = 0; i < found.size(); ++i) EXPECT_LT((*truth_from_found * found[i] - truth[i]).norm(), 0.02) << i;

  // Every track is of one landmark: images and keypoints are ours.
  EXPECT_GT(file.model.points.size(), 300U);
  double squared_px = 0;
  int observations = 0;
  for (const ColmapModel::Point& point : file.model.points)
    for (const auto& [image, keypoint] : point.track) {
      const auto& of_keypoint = scene.landmark_of_keypoint[static_cast<size_t>(image)];
      const auto& [first_image, first_keypoint] = point.track[0];
      EXPECT_EQ(of_keypoint[static_cast<size_t>(keypoint)],
                scene.landmark_of_keypoint[static_cast<size_t>(first_image)][static_cast<size_t>(first_keypoint)]);
      const Eigen::Vector3d p = file.model.cam_from_world.at(image) * point.position;
      const Eigen::Vector2d measured =
          scene.images[static_cast<size_t>(image)].keypoints[static_cast<size_t>(keypoint)].cast<double>();
      squared_px += (test_camera().project_undistorted(p) - measured).squaredNorm();
      ++observations;
    }
  EXPECT_LT(std::sqrt(squared_px / observations), 0.75);  // 0.5 px of noise on each axis
}

}  // namespace
}  // namespace rumi
