// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/colmap_database.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <cstring>
#include <limits>

#include "base/child/run_child.h"
#include "base/files/sqlite.h"
#include "tests/slam/synthetic_scene.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TemporaryFolder;

template <class T>
std::vector<T> numbers(std::span<const uint8_t> blob) {
  std::vector<T> values(blob.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), blob.data(), values.size() * sizeof(T));
  return values;
}

template <class T>
std::vector<T> blob_of(const std::string& file, const std::string& sql) {
  Database database(file);
  Statement select(database, sql);
  return select.step() ? numbers<T>(select.blob(0)) : std::vector<T>{};
}

int64_t integer_of(const std::string& file, const std::string& sql) { return Database(file).integer(sql); }

std::vector<WindowImage> three_images() {
  return {{"a", {{0, 0}, {10.25F, 20.5F}, {639, 479}}}, {"b", {{1, 2}, {3, 4}}}, {"c", {}}};
}

TEST(ColmapDatabase, KeypointsAndTheCameraAreShiftedByHalfAPixel) {
  const TemporaryFolder folder;
  const std::string file = folder / "database.db";
  ASSERT_EQ(write_colmap_database(file, test_camera(), three_images(), {}).error_text(), "");
  EXPECT_THAT(blob_of<float>(file, "SELECT data FROM keypoints WHERE image_id = 1"),
              ElementsAre(0.5F, 0.5F, 10.75F, 21.0F, 639.5F, 479.5F));
  EXPECT_THAT(blob_of<double>(file, "SELECT params FROM cameras"), ElementsAre(525, 520, 320, 240));
  EXPECT_EQ(integer_of(file, "SELECT model FROM cameras"), 1);
  EXPECT_EQ(integer_of(file, "SELECT width FROM cameras"), 640);
  EXPECT_EQ(integer_of(file, "SELECT height FROM cameras"), 480);
  EXPECT_EQ(integer_of(file, "SELECT prior_focal_length FROM cameras"), 1);
  EXPECT_EQ(integer_of(file, "SELECT COUNT(*) FROM images"), 3);
  EXPECT_EQ(integer_of(file, "SELECT image_id FROM images WHERE name = 'b'"), 2);
  EXPECT_EQ(integer_of(file, "SELECT rows FROM keypoints WHERE image_id = 3"), 0);
}

TEST(ColmapDatabase, TheImageOfTheLowerIdComesFirst) {
  const TemporaryFolder folder;
  const std::string file = folder / "database.db";
  ASSERT_EQ(
      write_colmap_database(file, test_camera(), three_images(), {{1, 0, {{1, 2}, {0, 1}}}, {2, 1, {}}}).error_text(),
      "");
  const int64_t low_first = 2147483647LL * 1 + 2;
  EXPECT_EQ(integer_of(file, "SELECT MIN(pair_id) FROM two_view_geometries"), low_first);
  EXPECT_EQ(integer_of(file, "SELECT MAX(pair_id) FROM two_view_geometries"), 2147483647LL * 2 + 3);
  const std::string of_pair = " FROM two_view_geometries WHERE pair_id = " + std::to_string(low_first);
  EXPECT_THAT(blob_of<uint32_t>(file, "SELECT data" + of_pair), ElementsAre(2, 1, 1, 0));
  EXPECT_EQ(integer_of(file, "SELECT rows" + of_pair), 2);
  EXPECT_EQ(integer_of(file, "SELECT cols" + of_pair), 2);
  EXPECT_EQ(integer_of(file, "SELECT config" + of_pair), 2);
  EXPECT_EQ(integer_of(file, "SELECT F IS NULL AND E IS NULL AND H IS NULL AND qvec IS NULL" + of_pair), 1);
}

// Returns all tables with their columns, and the indices, to compare them with those that COLMAP creates.
std::string layout(const std::string& file) {
  Database database(file);
  std::string all = std::to_string(database.integer("PRAGMA user_version"));
  Statement tables(database, "SELECT name FROM sqlite_master WHERE type IN ('table', 'index') ORDER BY name");
  while (tables.step()) {
    const auto blob = tables.blob(0);
    const std::string name(blob.begin(), blob.end());
    all += "\n" + name + ":";
    Statement columns(
        database,
        "SELECT name || ' ' || type || ' ' || \"notnull\" || ' ' || pk FROM pragma_table_info('" + name + "')");
    while (columns.step()) {
      const auto column = columns.blob(0);
      all += " " + std::string(column.begin(), column.end()) + ",";
    }
  }
  return all;
}

TEST(ColmapDatabase, TheLayoutIsColmaps) {
  const TemporaryFolder folder;
  const std::string theirs = folder / "theirs.db", ours = folder / "ours.db";
  ChildCommand create;
  create.arguments = {"colmap", "database_creator", "--database_path", theirs};
  create.environment = {"QT_QPA_PLATFORM=offscreen"};
  const std::atomic<bool> never = false;
  const ChildResult result = run_child(create, never);
  if (result.outcome == ChildResult::Outcome::kNotStarted) GTEST_SKIP() << "SKIPPED: " << result.describe();
  ASSERT_TRUE(result.ok()) << result.describe();
  if (integer_of(theirs, "PRAGMA user_version") != 3800) GTEST_SKIP() << "SKIPPED: this COLMAP is not 3.8";
  ASSERT_EQ(write_colmap_database(ours, test_camera(), three_images(), {}).error_text(), "");
  EXPECT_EQ(layout(ours), layout(theirs));
}

TEST(ColmapDatabase, ItReplacesWhatIsThere) {
  const TemporaryFolder folder;
  const std::string file = folder / "database.db";
  testing::write_file(file, "not a database");
  testing::write_file(file + "-wal", "nor its log");
  ASSERT_EQ(write_colmap_database(file, test_camera(), three_images(), {}).error_text(), "");
  const std::string first = testing::read_file(file);
  ASSERT_EQ(write_colmap_database(file, test_camera(), three_images(), {}).error_text(), "");
  EXPECT_EQ(testing::read_file(file), first);
  EXPECT_FALSE(std::filesystem::exists(file + "-wal"));
}

TEST(ColmapDatabase, NoImagesAreNoProblem) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_colmap_database(folder / "database.db", test_camera(), {}, {}).error_text(), "");
}

TEST(ColmapDatabase, WrongInputIsRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "database.db";
  const auto problem = [&](const std::vector<WindowImage>& images, const std::vector<ImagePair>& pairs) {
    const std::string text = write_colmap_database(file, test_camera(), images, pairs).error_text();
    EXPECT_THAT(text, StartsWith(file));
    EXPECT_FALSE(std::filesystem::exists(file));
    return text;
  };
  EXPECT_THAT(problem(three_images(), {{0, 3, {}}}), HasSubstr("no pair of images 0 and 3"));
  EXPECT_THAT(problem(three_images(), {{-1, 1, {}}}), HasSubstr("no pair"));
  EXPECT_THAT(problem(three_images(), {{1, 1, {}}}), HasSubstr("no pair"));
  EXPECT_THAT(problem(three_images(), {{0, 1, {{2, 2}}}}), HasSubstr("no match of keypoints 2 and 2"));
  EXPECT_THAT(problem(three_images(), {{0, 1, {{-1, 0}}}}), HasSubstr("no match"));
  EXPECT_THAT(problem({{"a", {{0, std::numeric_limits<float>::quiet_NaN()}}}}, {}), HasSubstr("not finite"));
  EXPECT_THAT(problem({{"a", {}}, {"a", {}}}, {}), HasSubstr("UNIQUE"));
  EXPECT_THAT(problem(three_images(), {{0, 1, {}}, {1, 0, {}}}), HasSubstr("UNIQUE"));
  EXPECT_THAT(write_colmap_database(file, Camera(), three_images(), {}).error_text(), HasSubstr("width"));
}

TEST(ColmapDatabase, AFolderThatIsNotThereIsReported) {
  const TemporaryFolder folder;
  EXPECT_THAT(write_colmap_database(folder / "no/database.db", test_camera(), three_images(), {}).error_text(),
              HasSubstr("no/database.db: unable to open"));
  EXPECT_THAT(write_colmap_database("/proc/database.db", test_camera(), three_images(), {}).error_text(),
              HasSubstr("/proc/database.db: "));
}

TEST(ColmapDatabase, AFullDiskIsReported) {
  const TemporaryFolder folder;
  const int result = testing::run_on_small_disk(folder.path().string(), 100'000, [&] {
    std::vector<WindowImage> images(100, {"", std::vector<Eigen::Vector2f>(1000, {1, 2})});
    for (size_t i = 0; i < images.size(); ++i) images[i].name = std::to_string(i);
    const std::string problem = write_colmap_database(folder / "database.db", test_camera(), images, {}).error_text();
    if (problem.find("full") == std::string::npos) return 1;
    return std::filesystem::exists(folder / "database.db") ? 2 : 0;
  });
  if (result < 0) GTEST_SKIP() << "SKIPPED: no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

}  // namespace
}  // namespace rumi::ruminator
