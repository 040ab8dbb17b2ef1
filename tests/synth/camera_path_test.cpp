// SPDX-License-Identifier: BSD-3-Clause
#include "synth/camera_path.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "synth/room.h"
#include "tests/support/temporary_folder.h"

namespace rumi::synth {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  const testing::TemporaryFolder folder;
  return CameraPath::load(folder.write("path.txt", text)).error_text();
}

TEST(CameraPath, ErrorsNameFileLineAndValue) {
  const std::string good = "1 0 0 0 0 0 0 1\n", next = "2 1 0 0 0 0 0 1\n";
  EXPECT_EQ(error_of("# comment\n\n" + good + next), "");
  EXPECT_THAT(error_of(good + "2 1 0 0 0 0 0\n"), AllOf(HasSubstr("path.txt:2"), HasSubstr("2 1 0 0 0 0 0")));
  EXPECT_THAT(error_of(good + "2 nan 0 0 0 0 0 1\n"), HasSubstr("path.txt:2"));
  EXPECT_THAT(error_of(good + "2 0 0 0 0 0 0 0\n"), HasSubstr("path.txt:2"));
  EXPECT_THAT(error_of(next + good), HasSubstr("does not rise"));
  EXPECT_THAT(error_of(good + good), HasSubstr("does not rise"));
  EXPECT_THAT(error_of(good), HasSubstr("fewer than two"));
  EXPECT_THAT(error_of(""), HasSubstr("fewer than two"));
  EXPECT_EQ(CameraPath::load("/nowhere/path.txt").error_text(),
            "/nowhere/path.txt: cannot be opened; give a TUM trajectory file");
}

TEST(CameraPath, PassesThroughItsSamplesAndIsSmooth) {
  const CameraPath path = CameraPath::walk(5, 3);
  const testing::TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 40; ++i) {
    const double t = path.times_s().front() + 0.1 * i;
    const SE3 p = path.at(t);
    text += fmt::format("{:.9f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f}\n", t, p.translation.x(),
                        p.translation.y(), p.translation.z(), p.rotation.x(), p.rotation.y(), p.rotation.z(),
                        p.rotation.w());
  }
  const CameraPath sampled = CameraPath::load(folder.write("p.txt", text)).value();
  for (int i = 0; i < 39; ++i) {
    const double t = path.times_s().front() + 0.1 * i;
    EXPECT_LT((sampled.at(t).translation - path.at(t).translation).norm(), 1e-9);
    EXPECT_LT((sampled.at(t + 0.05).translation - path.at(t + 0.05).translation).norm(), 0.01);
    EXPECT_LT((sampled.at(t + 0.05).inverse() * path.at(t + 0.05)).angle_rad(), 0.02);
  }
}

TEST(CameraPath, WalkIsClosedAndStartsSideways) {
  const CameraPath path = CameraPath::walk(20, 1);
  const double begin = path.times_s().front(), end = path.times_s().back();
  EXPECT_LT((path.at(begin).translation - path.at(end).translation).norm(), 0.05);
  const Eigen::Vector3d moved = path.at(begin).inverse() * path.at(begin + 1.5).translation;
  EXPECT_GT(std::abs(moved.x()), 0.2);
  EXPECT_GT(std::abs(moved.x()), 2 * std::abs(moved.z()));
}

TEST(CameraPath, UpIsTheAxisNearby) {
  EXPECT_LT((CameraPath::walk(20, 1).up() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  const testing::TemporaryFolder folder;
  // In maps of ICL-NUIM, y points down, like the camera's.
  const std::string file = folder.write("icl.txt", "1 0 0 0 0.1 0 0 0.995\n2 0 0 1 0.1 0 0 0.995\n");
  EXPECT_LT((CameraPath::load(file)->up() + Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

// Recordings and figures depend on what a seed renders. Everything random in a room is drawn from one sequence of
// numbers, so a change anywhere moves vertices.
TEST(Room, OfASeedStaysTheSame) {
  const CameraPath path = CameraPath::walk(20, 1);
  const Eigen::Vector3d at = path.at(path.times_s().front() + 7.3).translation;
  EXPECT_LT((at - Eigen::Vector3d(-0.863534974, 0.835341374, 1.377759108)).norm(), 1e-6) << at.transpose();
  const Mesh mesh = build_room(fit_room(path, 1), 1, 60);
  double sum_m = 0;
  for (const Vertex& v : mesh.vertices) sum_m += v.position[0] + v.position[1] + v.position[2];
  EXPECT_EQ(mesh.parts.size(), 184u);
  EXPECT_EQ(mesh.vertices.size(), 29592u);
  EXPECT_NEAR(sum_m, 23526.25, 0.5);
}

// The path of a real recording is tested, too, if it is there.
TEST(Room, HoldsThePathAndKeepsFurnitureAway) {
  const char* dir = std::getenv("RUMI_DATA_DIR");
  std::vector<CameraPath> paths{CameraPath::walk(20, 1), CameraPath::walk(8, 2)};
  if (dir && std::filesystem::exists(std::string(dir) + "/trajectories/fr1_room.txt"))
    paths.push_back(CameraPath::load(std::string(dir) + "/trajectories/fr1_room.txt").value());
  for (const CameraPath& path : paths) {
    const RoomShape shape = fit_room(path, 5);
    const Mesh mesh = build_room(shape, 5, 60);
    ASSERT_GT(mesh.parts.size(), 40u);
    double nearest = 1e9;
    for (const Eigen::Vector3d& p : shape.path) {
      EXPECT_TRUE(((p - shape.low).array() > 0.99).all() && ((shape.high - p).array() > 0.99).all());
      for (const Vertex& v : mesh.vertices)
        nearest = std::min(nearest, (Eigen::Vector3f(v.position).cast<double>() - p).norm());
      // A part of the positions is enough, and faster.
      if (&p - shape.path.data() > 40) break;
    }
    EXPECT_GT(nearest, 0.45);
  }
}

}  // namespace
}  // namespace rumi::synth
