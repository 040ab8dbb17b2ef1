// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/read_model.h"

#include <gmock/gmock.h>

#include <array>
#include <cstring>
#include <limits>
#include <map>

#include "tests/ruminator/test_model.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using testing::TemporaryFolder;
using testing::TestModel;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A model with images 1 and 3 of three.
TestModel small_model() {
  TestModel m;
  m.images = {{3, {so3_exp({0.1, -0.2, 0.3}), Eigen::Vector3d(1, 2, 3)}, 2}, {1, SE3(), 3}};
  m.points = {{9, {4, 5, 6}, {{1, 2}, {3, 0}}}, {2, {-1, 0, 8}, {{3, 1}, {1, 0}}}};
  return m;
}
const std::vector<int> kKeypointCounts = {3, 5, 2};

class ColmapModelFileTest : public ::testing::Test {
 protected:
  Result<SparseModel> read(const std::string& cameras, const std::string& images, const std::string& points,
                           const std::vector<int>& counts = kKeypointCounts) {
    put("cameras.bin", cameras);
    put("images.bin", images);
    put("points3D.bin", points);
    return read_colmap_model(folder.path().string(), counts);
  }
  Result<SparseModel> read(const TestModel& m, const std::vector<int>& counts = kKeypointCounts) {
    return read(m.cameras_bin(), m.images_bin(), m.points_bin(), counts);
  }
  std::string error(const TestModel& m) { return read(m).error_text(); }

  const TemporaryFolder folder;

 private:
  // Writes the file anew, because overwriting it would have to wait for the disk (ext4).
  void put(const std::string& name, const std::string& bytes) {
    const auto [kept, is_new] = written_.try_emplace(name, bytes);
    if (!is_new && kept->second == bytes) return;
    kept->second = bytes;
    std::filesystem::remove(folder / name);
    testing::write_file(folder / name, bytes);
  }
  std::map<std::string, std::string> written_;
};

TEST_F(ColmapModelFileTest, WhatWasWrittenIsRead) {
  const Result<SparseModel> model = read(small_model());
  ASSERT_TRUE(model) << model.error_text();
  EXPECT_EQ(model->fx, 500);
  EXPECT_EQ(model->fy, 510);
  ASSERT_EQ(model->cam_from_world.size(), 2U);
  const SE3& pose = model->cam_from_world.at(2);
  EXPECT_LT((pose.translation - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((so3_log(pose.rotation) - Eigen::Vector3d(0.1, -0.2, 0.3)).norm(), 1e-12);
  ASSERT_EQ(model->points.size(), 2U);
  EXPECT_EQ(model->points[0].position, Eigen::Vector3d(-1, 0, 8));  // in order of COLMAP's ids
  EXPECT_THAT(model->points[0].track, ElementsAre(Pair(2, 1), Pair(0, 0)));
  EXPECT_EQ(model->points[1].position, Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(model->points[1].track, ElementsAre(Pair(0, 2), Pair(2, 0)));
}

TEST_F(ColmapModelFileTest, OneFocalLengthHoldsForBothAxes) {
  TestModel m = small_model();
  m.camera_model = 2;  // SIMPLE_RADIAL
  const Result<SparseModel> model = read(m);
  ASSERT_TRUE(model) << model.error_text();
  EXPECT_EQ(model->fx, 500);
  EXPECT_EQ(model->fy, 500);
}

TEST_F(ColmapModelFileTest, AModelWithoutImagesIsEmpty) {
  const Result<SparseModel> model = read(TestModel());
  ASSERT_TRUE(model) << model.error_text();
  EXPECT_THAT(model->cam_from_world, IsEmpty());
  EXPECT_THAT(model->points, IsEmpty());
}

TEST_F(ColmapModelFileTest, MissingFilesAreNamed) {
  EXPECT_THAT(read_colmap_model(folder / "nothing", kKeypointCounts).error_text(),
              HasSubstr("nothing/cameras.bin: No such file"));
  ASSERT_TRUE(read(small_model()));
  std::filesystem::remove(folder / "points3D.bin");
  EXPECT_THAT(read_colmap_model(folder.path().string(), kKeypointCounts).error_text(),
              HasSubstr("points3D.bin: No such"));
  std::filesystem::create_directory(folder / "points3D.bin");
  EXPECT_THAT(read_colmap_model(folder.path().string(), kKeypointCounts).error_text(), HasSubstr("points3D.bin: "));
}

TEST_F(ColmapModelFileTest, FilesCutAnywhereAreRefused) {
  const TestModel m = small_model();
  const std::string cameras = m.cameras_bin(), images = m.images_bin(), points = m.points_bin();
  for (size_t n = 0; n < cameras.size(); ++n) EXPECT_FALSE(read(cameras.substr(0, n), images, points).has_value()) << n;
  for (size_t n = 0; n < images.size(); ++n) EXPECT_FALSE(read(cameras, images.substr(0, n), points).has_value()) << n;
  for (size_t n = 0; n < points.size(); ++n) {
    const Result<SparseModel> model = read(cameras, images, points.substr(0, n));
    EXPECT_THAT(model.error_text(), HasSubstr("points3D.bin")) << n;
  }
  EXPECT_THAT(read(cameras + '\0', images, points).error_text(), HasSubstr("1 bytes too many"));
  EXPECT_THAT(read(cameras, images + '\0', points).error_text(), HasSubstr("1 bytes too many"));
  EXPECT_THAT(read(cameras, images, points + '\0').error_text(), HasSubstr("1 bytes too many"));
}

// Whatever the files contain, the result is an Error, or a model whose numbers and indices are valid.
TEST_F(ColmapModelFileTest, NoByteCanBreakThePromise) {
  const TestModel m = small_model();
  const std::array<std::string, 3> files = {m.cameras_bin(), m.images_bin(), m.points_bin()};
  int refused = 0;
  for (size_t which = 0; which < files.size(); ++which)
    for (size_t n = 0; n < files[which].size(); ++n)
      for (const char value : {'\x00', '\x7f', '\xf0', '\xff'}) {
        std::array<std::string, 3> changed = files;
        changed[which][n] = value;
        const Result<SparseModel> model = read(changed[0], changed[1], changed[2]);
        if (!model) {
          ++refused;
          continue;
        }
        for (const auto& [image, pose] : model->cam_from_world) {
          EXPECT_TRUE(image >= 0 && image < 3);
          EXPECT_TRUE(pose.is_finite());
        }
        for (const SparseModel::Point& point : model->points) {
          EXPECT_TRUE(point.position.allFinite());
          for (const auto& [image, keypoint] : point.track) {
            ASSERT_TRUE(model->cam_from_world.contains(image));
            EXPECT_TRUE(keypoint >= 0 && keypoint < kKeypointCounts[static_cast<size_t>(image)]);
          }
        }
      }
  EXPECT_GT(refused, 100);
}

TEST_F(ColmapModelFileTest, CountsThatCannotBeAreRefused) {
  const TestModel m = small_model();
  for (const uint64_t count : {uint64_t{1} << 63, ~uint64_t{0}, uint64_t{1} << 32, uint64_t{1000}}) {
    const auto with_count = [&](std::string bytes, size_t position) {
      std::memcpy(bytes.data() + position, &count, sizeof(count));
      return bytes;
    };
    EXPECT_FALSE(read(with_count(m.cameras_bin(), 0), m.images_bin(), m.points_bin()).has_value()) << count;
    EXPECT_FALSE(read(m.cameras_bin(), with_count(m.images_bin(), 0), m.points_bin()).has_value()) << count;
    EXPECT_FALSE(read(m.cameras_bin(), with_count(m.images_bin(), 8 + 4 + 56 + 4 + 6), m.points_bin()).has_value())
        << count;
    EXPECT_FALSE(read(m.cameras_bin(), m.images_bin(), with_count(m.points_bin(), 0)).has_value()) << count;
    EXPECT_FALSE(read(m.cameras_bin(), m.images_bin(), with_count(m.points_bin(), 8 + 8 + 24 + 3 + 8)).has_value())
        << count;
  }
}

TEST_F(ColmapModelFileTest, NumbersThatCannotBeAreRefused) {
  TestModel m = small_model();
  m.points[1].position.y() = kNan;
  EXPECT_THAT(error(m), HasSubstr("points3D.bin: a number is not finite"));
  m = small_model();
  m.images[0].cam_from_world.translation.x() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(error(m), HasSubstr("images.bin: a number is not finite"));
  m = small_model();
  m.images[0].cam_from_world.rotation.coeffs().setZero();
  EXPECT_THAT(error(m), HasSubstr("rotation"));
  for (const double focal : {0.0, -500.0, kNan}) {
    m = small_model();
    m.parameters[1] = focal;
    EXPECT_THAT(error(m), HasSubstr("cameras.bin")) << focal;
  }
  for (const int32_t camera_model : {-1, 11}) {
    m = small_model();
    m.camera_model = camera_model;
    EXPECT_THAT(error(m), HasSubstr("camera model"));
  }
}

TEST_F(ColmapModelFileTest, UnknownImagesAndKeypointsAreRefused) {
  for (const uint32_t id : {0U, 4U, ~0U}) {
    TestModel m = small_model();
    m.images[0].id = id;
    EXPECT_THAT(error(m), HasSubstr("images.bin: image ")) << id;
    m = small_model();
    m.points[0].track[0].first = id;
    EXPECT_THAT(error(m), HasSubstr("points3D.bin: image ")) << id;
  }
  TestModel m = small_model();
  m.images[0].id = 1;
  EXPECT_FALSE(read(m, {2, 2, 2}).has_value());
  EXPECT_THAT(read(m, {3, 3, 3}).error_text(), HasSubstr("keypoints instead of"));
  m.images[0].keypoints = 3;
  EXPECT_THAT(read(m, {3, 3, 3}).error_text(), HasSubstr("image 1 is there twice"));

  m = small_model();
  m.points[0].track[0].first = 2;
  EXPECT_THAT(error(m), HasSubstr("image 2 is not registered"));
  for (const uint32_t keypoint : {3U, ~0U}) {
    m = small_model();
    m.points[0].track[0].second = keypoint;
    EXPECT_THAT(error(m), HasSubstr("of 3 in image 1")) << keypoint;
  }
  m = small_model();
  m.points[1].track[1] = m.points[0].track[0];
  EXPECT_THAT(error(m), HasSubstr("keypoint 2 of image 1 sees two points"));
  m = small_model();
  m.points[1].id = m.points[0].id;
  EXPECT_THAT(error(m), HasSubstr("point 9 is there twice"));
}

TEST_F(ColmapModelFileTest, FoldersAreCountedFromZero) {
  EXPECT_THAT(colmap_model_folders(folder / "nothing"), IsEmpty());
  for (const char* name : {"0", "1", "3", "x"}) std::filesystem::create_directory(folder / name);
  testing::write_file(folder / "2", "not a folder");
  EXPECT_THAT(colmap_model_folders(folder.path().string()), ElementsAre(folder / "0", folder / "1"));
}

}  // namespace
}  // namespace rumi::ruminator
