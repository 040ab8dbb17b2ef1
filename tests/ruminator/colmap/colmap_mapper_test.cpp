// SPDX-License-Identifier: BSD-3-Clause
// COLMAP itself, from our database to its model, and a script in its place that fails in every way.
#include "ruminator/colmap/colmap_mapper.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <vector>

#include "ruminator/colmap/colmap_database.h"
#include "slam/geometry/alignment.h"
#include "tests/ruminator/test_model.h"
#include "tests/slam/synthetic_scene.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::TemporaryFolder;
using testing::TestModel;
using Kind = MapperOutcome::Kind;

const std::atomic<bool> kNever = false;

// A camera on a curve before a cloud; every landmark it sees is a keypoint.
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
    for (int b = 0; b < a; ++b) {  // the later image first: the database has to turn them round
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
  return outcome.kind == Kind::kNotStarted && outcome.failure.find("not found in PATH") != std::string::npos;
}

MapperCommand command_for(const TemporaryFolder& folder, const std::string& output) {
  MapperCommand command;
  command.database = folder / "database.db";
  command.output_folder = folder / output;
  command.log_file = folder / "log";
  command.time_limit_s = 600;
  return command;
}

TEST(ColmapMapper, RebuildsASceneFromOurDatabase) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(10, 400, 0.5);
  ASSERT_EQ(write_colmap_database(folder / "database.db", test_camera(), scene.images, scene.pairs), "");
  MapperCommand command = command_for(folder, "models");
  command.keypoint_counts = keypoint_counts(scene);
  std::vector<int> registered;
  command.progress = [&](int images) { registered.push_back(images); };
  ColmapMapper mapper("colmap");
  const MapperOutcome outcome = mapper.run(command, {}, kNever);
  if (is_missing(outcome)) GTEST_SKIP() << "SKIPPED: " << outcome.failure;
  ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.failure;
  ASSERT_EQ(outcome.models.size(), 1U);
  EXPECT_THAT(registered, ElementsAre(2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_GT(outcome.cpu_s, 0);
  EXPECT_NE(mapper.version(), "");
  const SparseModel& model = outcome.models[0];
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

  // Every track is of one landmark: images and keypoints are ours.
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

// The images of the model keep their poses; one that was not in it joins them.
TEST(ColmapMapper, ExtendsAModel) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(8, 300, 0.5);
  std::vector<ImagePair> pairs_of_seven;
  for (const ImagePair& pair : scene.pairs)
    if (pair.first < 7) pairs_of_seven.push_back(pair);
  const std::string file = folder / "database.db";
  ASSERT_EQ(write_colmap_database(file, test_camera(), scene.images, pairs_of_seven), "");
  MapperCommand command = command_for(folder, "seven");
  command.keypoint_counts = keypoint_counts(scene);
  MapperSettings settings;
  settings.min_model_size = 3;
  ColmapMapper mapper("colmap");
  const MapperOutcome seven = mapper.run(command, settings, kNever);
  if (is_missing(seven)) GTEST_SKIP() << "SKIPPED: " << seven.failure;
  ASSERT_EQ(seven.kind, Kind::kModels) << seven.failure;
  ASSERT_EQ(seven.models[0].cam_from_world.size(), 7U);

  ASSERT_EQ(write_colmap_database(file, test_camera(), scene.images, scene.pairs), "");
  command.output_folder = folder / "eight";
  command.input_model = seven.folders[0];
  command.fix_existing_images = true;
  const MapperOutcome eight = mapper.run(command, settings, kNever);
  ASSERT_EQ(eight.kind, Kind::kModels) << eight.failure;
  ASSERT_EQ(eight.models.size(), 1U);
  ASSERT_EQ(eight.models[0].cam_from_world.size(), 8U);
  for (const auto& [image, pose] : seven.models[0].cam_from_world)
    EXPECT_LT((eight.models[0].cam_from_world.at(image).center() - pose.center()).norm(), 1e-9) << image;
}

TEST(ColmapMapper, IsRepeatableToTheBit) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(10, 400, 0.5);
  ColmapMapper mapper("colmap");
  for (const char* name : {"first", "second"}) {
    ASSERT_EQ(write_colmap_database(folder / "database.db", test_camera(), scene.images, scene.pairs), "");
    MapperCommand command = command_for(folder, name);
    command.keypoint_counts = keypoint_counts(scene);
    const MapperOutcome outcome = mapper.run(command, {}, kNever);
    if (is_missing(outcome)) GTEST_SKIP() << "SKIPPED: " << outcome.failure;
    ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.failure;
  }
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"})
    EXPECT_EQ(testing::read_file(folder / "first/0/" + name), testing::read_file(folder / "second/0/" + name)) << name;
}

TEST(ColmapMapper, FindsNoModelInImagesWithoutPairs) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(5, 100, 0.5);
  ASSERT_EQ(write_colmap_database(folder / "database.db", test_camera(), scene.images, {}), "");
  const MapperOutcome outcome = ColmapMapper("colmap").run(command_for(folder, "models"), {}, kNever);
  if (is_missing(outcome)) GTEST_SKIP() << "SKIPPED: " << outcome.failure;
  EXPECT_EQ(outcome.kind, Kind::kNoModel) << outcome.failure;
  EXPECT_FALSE(outcome.retryable());
}

TEST(ColmapMapper, FillsTheDisk) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(10, 400, 0.5);
  ColmapMapper mapper("colmap");
  // Room for the database and a part of the model.
  const int result = testing::run_on_small_disk(folder.path().string(), 350'000, [&] {
    const std::string problem = write_colmap_database(folder / "database.db", test_camera(), scene.images, scene.pairs);
    if (!problem.empty()) throw std::runtime_error(problem);
    MapperCommand command = command_for(folder, "models");
    command.keypoint_counts = keypoint_counts(scene);
    const MapperOutcome outcome = mapper.run(command, {}, kNever);
    std::fprintf(stderr, "%s\n", outcome.failure.c_str());
    if (is_missing(outcome)) return 50;
    return outcome.kind == Kind::kDiskFull ? 0 : 1;
  });
  if (result < 0) GTEST_SKIP() << "SKIPPED: no user namespaces here: cannot mount a small disk";
  if (result == 50) GTEST_SKIP() << "SKIPPED: colmap is missing";
  EXPECT_EQ(result, 0);
}

const char* const kOptionsOf38 =
    "database_path image_path input_path output_path random_seed Mapper.num_threads "
    "Mapper.ba_global_images_ratio Mapper.fix_existing_images Mapper.min_model_size";
const char* const kOptionsOf4 =
    "database_path image_path input_path output_path default_random_seed log_target "
    "Mapper.random_seed Mapper.num_threads Mapper.ba_global_frames_ratio "
    "Mapper.fix_existing_frames Mapper.min_model_size";

// A script that answers `mapper -h` and then does as told; $out is the output folder, $here the test's.
class FakeColmapTest : public ::testing::Test {
 protected:
  FakeColmapTest() : command(command_for(work, "run/models")) {
    std::filesystem::create_directory(work / "run");
    TestModel model;
    for (uint32_t id = 1; id <= 3; ++id) model.images.push_back({id, SE3(), 4});
    model.points = {{1, {1, 2, 3}, {{1, 0}, {2, 0}, {3, 3}}}};
    std::filesystem::create_directory(here / "model");
    testing::write_file(here / "model/cameras.bin", model.cameras_bin());
    testing::write_file(here / "model/images.bin", model.images_bin());
    testing::write_file(here / "model/points3D.bin", model.points_bin());
    command.keypoint_counts = {4, 4, 4};
  }
  MapperOutcome run(const std::string& body, const std::atomic<bool>& cancel = kNever,
                    const std::string& options = kOptionsOf38) {
    const std::string program = here / "colmap";
    testing::write_file(program, "#!/bin/sh\nhere='" + here.path().string() +
                                     "'\n"
                                     "if [ \"$2\" = -h ]; then\n"
                                     "  echo 'COLMAP 3.8 (Commit)'\n"
                                     "  for o in " +
                                     options +
                                     "; do echo \"  --$o arg (=0)\"; done\n"
                                     "  exit\n"
                                     "fi\n"
                                     "echo \"$@\" > \"$here/arguments\"\n"
                                     "while [ $# -gt 0 ]; do [ \"$1\" = --output_path ] && out=$2; shift; done\n" +
                                     body + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return ColmapMapper(program).run(command, settings, cancel);
  }
  std::string arguments() const { return " " + testing::read_file(here / "arguments"); }

  const TemporaryFolder here, work;  // `work` may be a small disk
  MapperCommand command;
  MapperSettings settings;
};

TEST_F(FakeColmapTest, OneModelIsReturned) {
  const MapperOutcome outcome = run("cp -r $here/model $out/0");
  ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.failure;
  ASSERT_EQ(outcome.models.size(), 1U);
  EXPECT_EQ(outcome.models[0].cam_from_world.size(), 3U);
  EXPECT_THAT(outcome.folders, ElementsAre(command.output_folder + "/0"));
  EXPECT_EQ(outcome.failure, "");
}

TEST_F(FakeColmapTest, TwoModelsAreReturned) {
  const MapperOutcome outcome = run("cp -r $here/model $out/0; cp -r $here/model $out/1");
  ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.failure;
  EXPECT_EQ(outcome.models.size(), 2U);
  EXPECT_EQ(outcome.folders.size(), 2U);
}

TEST_F(FakeColmapTest, OptionsHaveTheNamesOf38) {
  settings.random_seed = 7;
  settings.min_model_size = 12;
  run("");
  EXPECT_THAT(arguments(), HasSubstr(" mapper --database_path " + command.database + " "));
  EXPECT_THAT(arguments(), HasSubstr(" --random_seed 7 "));
  EXPECT_THAT(arguments(), HasSubstr(" --Mapper.num_threads 1 "));
  EXPECT_THAT(arguments(), HasSubstr(" --Mapper.min_model_size 12 "));
  EXPECT_THAT(arguments(), HasSubstr(" --Mapper.ba_global_images_ratio 1.4"));
  EXPECT_THAT(arguments(), Not(HasSubstr("input_path")));
  EXPECT_THAT(arguments(), Not(HasSubstr("frames")));
  EXPECT_THAT(arguments(), Not(HasSubstr("log_target")));
}

TEST_F(FakeColmapTest, OptionsHaveTheNamesOf4) {
  settings.random_seed = 7;
  command.input_model = here / "model";
  command.fix_existing_images = true;
  run("", kNever, kOptionsOf4);
  EXPECT_THAT(arguments(), HasSubstr(" --default_random_seed 7 "));
  EXPECT_THAT(arguments(), HasSubstr(" --Mapper.random_seed 7 "));
  EXPECT_THAT(arguments(), HasSubstr(" --log_target stderr "));
  EXPECT_THAT(arguments(), HasSubstr(" --Mapper.ba_global_frames_ratio 1.4"));
  EXPECT_THAT(arguments(), HasSubstr(" --input_path " + command.input_model + " "));
  EXPECT_THAT(arguments(), HasSubstr(" --Mapper.fix_existing_frames 1"));
  EXPECT_THAT(arguments(), Not(HasSubstr(" --random_seed")));
  EXPECT_THAT(arguments(), Not(HasSubstr("images_ratio")));
}

TEST_F(FakeColmapTest, ProgressIsReadFromWhatItSays) {
  std::vector<int> registered;
  command.progress = [&](int images) { registered.push_back(images); };
  run("printf 'Registering image #'; printf '7 (3)\\nRegistering image #8 (num_reg_frames=4)\\n'\n"
      "echo 'Registering image #'; echo 'Registering image #1 (99999999999999999999)'; echo '(5)'");
  EXPECT_THAT(registered, ElementsAre(2, 3));
}

TEST_F(FakeColmapTest, AMissingProgramIsToldAndWorthAnotherTry) {
  const MapperOutcome outcome = ColmapMapper("rumi-no-such-colmap").run(command, settings, kNever);
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.failure, HasSubstr("rumi-no-such-colmap: not found in PATH"));
  EXPECT_TRUE(outcome.retryable());
}

TEST_F(FakeColmapTest, AProgramThatIsNotColmapIsTold) {
  const MapperOutcome outcome = ColmapMapper("echo").run(command, settings, kNever);
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.failure, HasSubstr("echo: does not know COLMAP's command mapper"));
}

TEST_F(FakeColmapTest, WhatWantsAGpuIsToldOnceAndNotTriedAgain) {
  run("true");  // writes the program
  testing::write_file(here / "colmap",
                      testing::read_file(here / "colmap") +
                          "echo run >> \"$here/runs\"\n"
                          "echo 'F0501 cuda.cc:48] Check failed: cudaGetDeviceCount(&n) == cudaSuccess' "
                          ">&2; exit 134\n");
  const auto program = std::make_shared<ColmapProgram>(here / "colmap");
  for (const char* folder : {"run/first", "run/second"}) {
    command.output_folder = work / folder;
    EXPECT_EQ(ColmapMapper(program).run(command, settings, kNever).kind, Kind::kFailed);
    EXPECT_THAT(program->problem(), HasSubstr("needs a GPU that it cannot use here"));
    EXPECT_THAT(program->problem(), HasSubstr("windows are rebuilt without it"));
  }
  EXPECT_EQ(testing::read_file(here / "runs"), "run\n");
}

TEST_F(FakeColmapTest, NoModelIsTheImagesFault) {
  const MapperOutcome outcome = run("echo 'ERROR: failed to create sparse model' >&2; exit 1");
  EXPECT_EQ(outcome.kind, Kind::kNoModel);
  EXPECT_FALSE(outcome.retryable());
  EXPECT_THAT(outcome.failure, HasSubstr("found no model"));
}

TEST_F(FakeColmapTest, NothingLeftIsNoModel) { EXPECT_EQ(run("exit 0").kind, Kind::kNoModel); }

TEST_F(FakeColmapTest, AnotherErrorIsRepeated) {
  const MapperOutcome outcome = run("echo fine; echo 'ERROR: Failed to parse options.' >&2; echo; exit 1");
  EXPECT_EQ(outcome.kind, Kind::kFailed);
  EXPECT_FALSE(outcome.retryable());
  EXPECT_EQ(outcome.failure, "COLMAP's mapper: ended with exit code 1: ERROR: Failed to parse options.");
}

TEST_F(FakeColmapTest, ACrashIsNotWorthAnotherTry) {
  const MapperOutcome outcome = run("echo 'mapper.cc:7] Check failed: a == b'; kill -ABRT $$");
  EXPECT_EQ(outcome.kind, Kind::kFailed);
  EXPECT_FALSE(outcome.retryable());
  EXPECT_THAT(outcome.failure, HasSubstr("signal 6"));
  EXPECT_THAT(outcome.failure, HasSubstr("Check failed: a == b"));
}

TEST_F(FakeColmapTest, WhatIsKilledFromOutsideIsWorthAnotherTry) {
  for (const char* signal : {"KILL", "TERM"}) {
    std::filesystem::remove_all(command.output_folder);
    const MapperOutcome outcome = run(std::string("kill -") + signal + " $$");
    EXPECT_EQ(outcome.kind, Kind::kKilled) << signal;
    EXPECT_TRUE(outcome.retryable());
    EXPECT_THAT(outcome.failure, HasSubstr("killed by signal"));
  }
}

TEST_F(FakeColmapTest, WhatHangsIsStopped) {
  command.time_limit_s = 0.2;
  const MapperOutcome outcome = run("cp -r $here/model $out/0; sleep 600");
  EXPECT_EQ(outcome.kind, Kind::kTimedOut);
  EXPECT_THAT(outcome.models, IsEmpty());
  EXPECT_THAT(outcome.failure, HasSubstr("time limit"));
}

TEST_F(FakeColmapTest, ItIsCancelledFromAnotherThread) {
  std::atomic<bool> cancel = false, ended = false;
  std::thread other([&] {
    while (!ended && !std::filesystem::exists(here / "started"))
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    cancel = true;
  });
  const MapperOutcome outcome = run("touch $here/started; sleep 600", cancel);
  ended = true;
  other.join();
  EXPECT_EQ(outcome.kind, Kind::kCancelled);
  EXPECT_TRUE(outcome.retryable());
}

TEST_F(FakeColmapTest, CorruptOutputIsRefused) {
  const MapperOutcome outcome = run(
      "cp -r $here/model $out/0; cp -r $here/model $out/1; head -c 30 $here/model/points3D.bin > $out/1/points3D.bin");
  EXPECT_EQ(outcome.kind, Kind::kCorrupt);
  EXPECT_THAT(outcome.models, IsEmpty());
  EXPECT_THAT(outcome.failure, HasSubstr("1/points3D.bin"));
  EXPECT_FALSE(outcome.retryable());
}

TEST_F(FakeColmapTest, AFolderWithOtherModelsIsNotUsed) {
  std::filesystem::create_directories(command.output_folder + "/0");
  const MapperOutcome outcome = run("exit 0");
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.failure, HasSubstr("is not empty"));
}

TEST_F(FakeColmapTest, AFolderThatCannotBeMadeIsTold) {
  testing::write_file(work / "file", "not a folder");
  command.output_folder = work / "file/models";
  const MapperOutcome outcome = run("exit 0");
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.failure, HasSubstr("file/models: Not a directory"));
}

TEST_F(FakeColmapTest, ItIsToldToLeaveNoLogOfItsOwn) {
  run("echo $GLOG_logtostderr > $here/environment");
  EXPECT_EQ(testing::read_file(here / "environment"), "1\n");
}

TEST_F(FakeColmapTest, TheLogIsKeptButBounded) {
  const MapperOutcome outcome = run("cp -r $here/model $out/0; echo first words; head -c 9000000 /dev/zero");
  EXPECT_EQ(outcome.kind, Kind::kModels) << outcome.failure;
  const std::string log = testing::read_file(command.log_file);
  EXPECT_THAT(log, HasSubstr("first words"));
  EXPECT_LT(log.size(), 2'000'000U);
}

TEST_F(FakeColmapTest, AFullDiskIsToldAndWorthAnotherTry) {
  for (const char* end : {"exit 0", "exit 1", "kill -ABRT $$"}) {
    const int result = testing::run_on_small_disk(work.path().string(), 2'000'000, [&] {
      // As COLMAP does: nothing is said of it.
      const MapperOutcome outcome =
          run("cp -r $here/model $out/0; head -c 9000000 /dev/zero > $out/0/points3D.bin 2> /dev/null; " +
              std::string(end));
      std::fprintf(stderr, "%s\n", outcome.failure.c_str());
      return outcome.kind == Kind::kDiskFull && outcome.retryable() ? 0 : 1;
    });
    if (result < 0) GTEST_SKIP() << "SKIPPED: no user namespaces here: cannot mount a small disk";
    EXPECT_EQ(result, 0) << end;
  }
}

TEST_F(FakeColmapTest, WhatItSaysOfAFullDiskIsBelieved) {
  const MapperOutcome outcome = run("echo 'E: database or disk is full'; exit 1");
  EXPECT_EQ(outcome.kind, Kind::kDiskFull);
}

}  // namespace
}  // namespace rumi::ruminator
