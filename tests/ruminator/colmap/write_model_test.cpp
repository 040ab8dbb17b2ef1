// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/write_model.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "ruminator/colmap/colmap_mapper.h"
#include "tests/ruminator/test_window.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::TestWindow;

std::vector<int> keypoint_counts(const TestWindow& w) {
  std::vector<int> counts;
  for (const WindowImage& image : w.images) counts.push_back(static_cast<int>(image.keypoints.size()));
  return counts;
}

TEST(ColmapModelWriter, WritesWhatTheReaderReads) {
  const TemporaryFolder folder;
  const TestWindow w = testing::sideways_window(5);
  SparseModel model = testing::true_model(w);
  model.cam_from_world.erase(2);  // so that one id is missing
  for (SparseModel::Point& point : model.points) std::erase_if(point.track, [](const auto& o) { return o.first == 2; });
  std::erase_if(model.points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
  ASSERT_EQ(write_colmap_model(folder.path(), w.camera, w.images, model).error_text(), "");
  const Result<SparseModel> read = read_colmap_model(folder.path(), keypoint_counts(w));
  ASSERT_TRUE(read) << read.error_text();
  EXPECT_EQ((*read).fx, w.camera.fx);
  EXPECT_EQ((*read).fy, w.camera.fy);
  ASSERT_EQ((*read).cam_from_world.size(), 4U);
  for (const auto& [image, pose] : model.cam_from_world) {
    EXPECT_LT(((*read).cam_from_world.at(image) * pose.inverse()).angle_rad(), 1e-9);
    EXPECT_EQ((*read).cam_from_world.at(image).translation, pose.translation);
  }
  ASSERT_EQ((*read).points.size(), model.points.size());
  for (size_t p = 0; p < model.points.size(); ++p) {
    EXPECT_EQ((*read).points[p].position, model.points[p].position);
    EXPECT_EQ((*read).points[p].track, model.points[p].track);
  }
}

TEST(ColmapModelWriter, WritesTheSameBytesTwice) {
  const TemporaryFolder one, two;
  const TestWindow w = testing::sideways_window(3);
  ASSERT_EQ(write_colmap_model(one.path(), w.camera, w.images, testing::true_model(w)).error_text(), "");
  ASSERT_EQ(write_colmap_model(two.path(), w.camera, w.images, testing::true_model(w)).error_text(), "");
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"})
    EXPECT_EQ(testing::read_file(one / name), testing::read_file(two / name)) << name;
}

TEST(ColmapModelWriter, SaysWhatCannotBeWritten) {
  const TestWindow w = testing::sideways_window(2);
  EXPECT_THAT(write_colmap_model("/proc/nothing/here", w.camera, w.images, testing::true_model(w)).error_text(),
              HasSubstr("/proc/nothing/here/cameras.bin"));
  if (std::filesystem::exists("/dev/full")) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("/dev/full", folder / "images.bin");
    EXPECT_THAT(write_colmap_model(folder.path(), w.camera, w.images, testing::true_model(w)).error_text(),
                HasSubstr("images.bin"));
  }
}

// COLMAP itself extends the model: the missing image gets a pose.
TEST(ColmapModelWriter, ColmapAcceptsIt) {
  const TemporaryFolder folder;
  const TestWindow w = testing::sideways_window(7);
  SparseModel model = testing::true_model(w);
  model.cam_from_world.erase(6);
  for (SparseModel::Point& point : model.points) std::erase_if(point.track, [](const auto& o) { return o.first == 6; });
  std::erase_if(model.points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
  ASSERT_EQ(write_colmap_database(folder / "database.db", w.camera, w.images, w.pairs).error_text(), "");
  std::filesystem::create_directory(folder / "seed");
  ASSERT_EQ(write_colmap_model(folder / "seed", w.camera, w.images, model).error_text(), "");
  MapperCommand command;
  command.database = folder / "database.db";
  command.input_model = folder / "seed";
  command.output_folder = folder / "models";
  command.log_file = folder / "log";
  command.keypoint_counts = keypoint_counts(w);
  command.time_limit_s = 600;
  const std::atomic<bool> never = false;
  const MapperOutcome outcome = ColmapMapper("colmap").run(command, {.min_model_size = 3}, never);
  if (outcome.models.error_text().find("not found in PATH") != std::string::npos)
    GTEST_SKIP() << "SKIPPED: " << outcome.models.error_text();
  ASSERT_EQ(outcome.kind, MapperOutcome::Kind::kModels)
      << outcome.models.error_text() << testing::read_file(folder / "log");
  EXPECT_EQ(outcome.models->at(0).cam_from_world.size(), 7U);
  EXPECT_LT(testing::worst_center_error(w, outcome.models->at(0)), 0.02);
}

}  // namespace
}  // namespace rumi::ruminator
