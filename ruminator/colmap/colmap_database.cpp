// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/colmap_database.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <filesystem>
#include <span>
#include <system_error>

#include "base/files/sqlite.h"

namespace rumi::ruminator {
namespace {

static_assert(std::endian::native == std::endian::little, "blobs are written as the numbers lie in memory");

constexpr float kPixelShift = 0.5F;  // COLMAP's pixel coordinates minus ours
constexpr int64_t kCameraId = 1;
constexpr int64_t kPinhole = 1;             // camera model: fx fy cx cy
constexpr int64_t kCalibrated = 2;          // configuration of an image pair: calibrated, with an essential matrix
constexpr int64_t kMaxImages = 2147483647;  // COLMAP's largest number of images, from which it computes pair ids

// The schema that COLMAP 3.8's `colmap database_creator` creates.
constexpr const char* kSchema = R"(
CREATE TABLE cameras (
  camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
  model INTEGER NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL, params BLOB,
  prior_focal_length INTEGER NOT NULL);
CREATE TABLE images (
  image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
  name TEXT NOT NULL UNIQUE, camera_id INTEGER NOT NULL,
  prior_qw REAL, prior_qx REAL, prior_qy REAL, prior_qz REAL, prior_tx REAL, prior_ty REAL, prior_tz REAL,
  CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647),
  FOREIGN KEY(camera_id) REFERENCES cameras(camera_id));
CREATE UNIQUE INDEX index_name ON images(name);
CREATE TABLE keypoints (
  image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB,
  FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE descriptors (
  image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB,
  FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE matches (
  pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB);
CREATE TABLE two_view_geometries (
  pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB,
  config INTEGER NOT NULL, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);
PRAGMA user_version = 3800;
)";

template <class Numbers>
std::span<const uint8_t> bytes_of(const Numbers& numbers) {
  return {reinterpret_cast<const uint8_t*>(numbers.data()), numbers.size() * sizeof(numbers[0])};
}

// Checks the input, because some faults would crash COLMAP and others would make it leave out images silently.
Result<> check(const Camera& camera, const std::vector<WindowImage>& images, const std::vector<ImagePair>& pairs) {
  if (std::string problem = camera.check(); !problem.empty()) return Error{problem};
  if (images.size() >= static_cast<size_t>(kMaxImages))
    return Error{fmt::format("{} images are too many", images.size())};
  for (const WindowImage& image : images)
    for (const Eigen::Vector2f& p : image.keypoints)
      if (!p.allFinite()) return Error{fmt::format("image {}: a keypoint is not finite", image.name)};
  for (const ImagePair& pair : pairs) {
    const auto known = [&](int image) { return image >= 0 && static_cast<size_t>(image) < images.size(); };
    if (!known(pair.first) || !known(pair.second) || pair.first == pair.second)
      return Error{fmt::format("there is no pair of images {} and {}", pair.first, pair.second)};
    const size_t first_count = images[static_cast<size_t>(pair.first)].keypoints.size();
    const size_t second_count = images[static_cast<size_t>(pair.second)].keypoints.size();
    for (const auto& [a, b] : pair.matches)
      if (a < 0 || b < 0 || static_cast<size_t>(a) >= first_count || static_cast<size_t>(b) >= second_count)
        return Error{
            fmt::format("images {} and {}: there is no match of keypoints {} and {}", pair.first, pair.second, a, b)};
  }
  return {};
}

void write_camera(Database& database, const Camera& camera) {
  const std::array<double, 4> params = {camera.fx, camera.fy, camera.cx + kPixelShift, camera.cy + kPixelShift};
  constexpr bool kFocalLengthIsKnown = true;
  Statement(database, "INSERT INTO cameras VALUES (?, ?, ?, ?, ?, ?)")
      .bind(kCameraId, kPinhole, camera.width, camera.height, bytes_of(params), kFocalLengthIsKnown)
      .run();
}

void write_images(Database& database, const std::vector<WindowImage>& images) {
  Statement insert_image(database, "INSERT INTO images (image_id, name, camera_id) VALUES (?, ?, ?)");
  Statement insert_keypoints(database, "INSERT INTO keypoints VALUES (?, ?, 2, ?)");
  std::vector<Eigen::Vector2f> shifted;
  for (size_t i = 0; i < images.size(); ++i) {
    const auto id = static_cast<int64_t>(i) + 1;
    insert_image.bind(id, images[i].name, kCameraId).run();
    shifted = images[i].keypoints;
    for (Eigen::Vector2f& p : shifted) p.array() += kPixelShift;
    insert_keypoints.bind(id, static_cast<int64_t>(shifted.size()), bytes_of(shifted)).run();
  }
}

// Writes the image with the lower id first, both in the pair's id and in the columns of its matches. Leaves the
// relative geometry NULL, because the mapper does not read it.
void write_pairs(Database& database, const std::vector<ImagePair>& pairs) {
  Statement insert(database,
                   "INSERT INTO two_view_geometries (pair_id, rows, cols, data, config) VALUES (?, ?, 2, ?, ?)");
  std::vector<std::array<uint32_t, 2>> rows;
  for (const ImagePair& pair : pairs) {
    const bool swap = pair.first > pair.second;
    const int64_t low = (swap ? pair.second : pair.first) + int64_t{1};
    const int64_t high = (swap ? pair.first : pair.second) + int64_t{1};
    rows.clear();
    rows.reserve(pair.matches.size());
    for (const auto& [a, b] : pair.matches)
      rows.push_back({static_cast<uint32_t>(swap ? b : a), static_cast<uint32_t>(swap ? a : b)});
    insert.bind(kMaxImages * low + high, static_cast<int64_t>(rows.size()), bytes_of(rows), kCalibrated).run();
  }
}

void write(const std::string& file, const Camera& camera, const std::vector<WindowImage>& images,
           const std::vector<ImagePair>& pairs) {
  Database database(file);
  // The file needs no journal, because it is written anew after a crash.
  database.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
  Transaction transaction(database);
  database.execute(kSchema);
  write_camera(database, camera);
  write_images(database, images);
  write_pairs(database, pairs);
  transaction.commit();
}

}  // namespace

Result<> write_colmap_database(const std::string& file, const Camera& camera, const std::vector<WindowImage>& images,
                               const std::vector<ImagePair>& pairs) {
  if (const Result<> input = check(camera, images, pairs); !input) return Error{input.error_text(), file};
  std::error_code error;
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) {
    std::filesystem::remove(file + suffix, error);
    if (error) return Error{error.message(), file + suffix};
  }
  try {
    write(file, camera, images, pairs);
  } catch (const SqliteError& e) {
    std::filesystem::remove(file, error);
    return Error{e.what(), file};
  }
  return {};
}

}  // namespace rumi::ruminator
