// SPDX-License-Identifier: BSD-3-Clause
// A fake COLMAP fails in many ways.
#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <thread>
#include <vector>

#include "tests/ruminator/colmap/fake_colmap.h"
#include "tests/ruminator/colmap/mapper_command.h"
#include "tests/ruminator/test_model.h"
#include "tests/support/patience.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using testing::TestModel;
using Kind = MapperOutcome::Kind;
using testing::command_for;
using testing::kNever;

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
  MapperOutcome run(const std::string& body, const std::atomic<bool>& cancel = kNever) {
    const std::string program = testing::write_fake_colmap(here, testing::help_text(testing::kDebian12), body);
    return ColmapMapper(program).run(command, settings, cancel);
  }

  const TemporaryFolder here, work;  // `work` may be on a small disk
  MapperCommand command;
  MapperSettings settings;
};

TEST_F(FakeColmapTest, OneModelIsReturned) {
  const MapperOutcome outcome = run("cp -r $here/model $out/0");
  ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.models.error_text();
  ASSERT_EQ(outcome.models->size(), 1U);
  EXPECT_EQ(outcome.models->at(0).cam_from_world.size(), 3U);
  EXPECT_EQ(outcome.models.error_text(), "");
}

TEST_F(FakeColmapTest, TwoModelsAreReturned) {
  const MapperOutcome outcome = run("cp -r $here/model $out/0; cp -r $here/model $out/1");
  ASSERT_EQ(outcome.kind, Kind::kModels) << outcome.models.error_text();
  EXPECT_EQ(outcome.models->size(), 2U);
}

TEST_F(FakeColmapTest, ProgressIsReadFromWhatItSays) {
  std::vector<int> registered;
  command.progress = [&](int images) { registered.push_back(images); };
  run("printf 'Registering image #'; printf '7 (3)\\nRegistering image #8 (num_reg_frames=4)\\n'\n"
      "echo 'Registering image #'; echo 'Registering image #1 (99999999999999999999)'; echo '(5)'");
  EXPECT_THAT(registered, ElementsAre(2, 4));
}

TEST_F(FakeColmapTest, AMissingProgramIsToldAndWorthAnotherTry) {
  const MapperOutcome outcome = ColmapMapper("rumi-no-such-colmap").run(command, settings, kNever);
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("rumi-no-such-colmap: not found in PATH"));
  EXPECT_TRUE(outcome.retryable());
}

TEST_F(FakeColmapTest, AProgramThatIsNotColmapIsTold) {
  const MapperOutcome outcome = ColmapMapper("echo").run(command, settings, kNever);
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("echo: does not know COLMAP's command mapper"));
}

TEST_F(FakeColmapTest, WhatWantsAGpuIsToldOnceAndNotTriedAgain) {
  run("true");  // writes the fake program
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
  for (const char* words :
       {"ERROR: failed to create sparse model", "E20261128 sfm.cc:310] Failed to create any sparse model"}) {
    std::filesystem::remove_all(command.output_folder);
    const MapperOutcome outcome = run("echo '" + std::string(words) + "' >&2; exit 1");
    EXPECT_EQ(outcome.kind, Kind::kNoModel) << words;
    EXPECT_FALSE(outcome.retryable());
    EXPECT_THAT(outcome.models.error_text(), HasSubstr("found no model"));
  }
}

TEST_F(FakeColmapTest, NothingLeftIsNoModel) { EXPECT_EQ(run("exit 0").kind, Kind::kNoModel); }

TEST_F(FakeColmapTest, AnotherErrorIsRepeated) {
  const MapperOutcome outcome = run("echo fine; echo 'ERROR: Failed to parse options.' >&2; echo; exit 1");
  EXPECT_EQ(outcome.kind, Kind::kFailed);
  EXPECT_FALSE(outcome.retryable());
  EXPECT_EQ(outcome.models.error_text(), "COLMAP's mapper: ended with exit code 1: ERROR: Failed to parse options.");
}

TEST_F(FakeColmapTest, ACrashIsNotWorthAnotherTry) {
  const MapperOutcome outcome = run("echo 'mapper.cc:7] Check failed: a == b'; kill -ABRT $$");
  EXPECT_EQ(outcome.kind, Kind::kFailed);
  EXPECT_FALSE(outcome.retryable());
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("signal 6"));
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("Check failed: a == b"));
}

TEST_F(FakeColmapTest, WhatIsKilledFromOutsideIsWorthAnotherTry) {
  for (const char* signal : {"KILL", "TERM"}) {
    std::filesystem::remove_all(command.output_folder);
    const MapperOutcome outcome = run(std::string("kill -") + signal + " $$");
    EXPECT_EQ(outcome.kind, Kind::kKilled) << signal;
    EXPECT_TRUE(outcome.retryable());
    EXPECT_THAT(outcome.models.error_text(), HasSubstr("killed by signal"));
  }
}

TEST_F(FakeColmapTest, WhatHangsIsStopped) {
  command.time_limit_s = 0.2;
  const MapperOutcome outcome = run("cp -r $here/model $out/0; sleep 600");
  EXPECT_EQ(outcome.kind, Kind::kTimedOut);
  EXPECT_FALSE(outcome.models);
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("time limit"));
}

TEST_F(FakeColmapTest, ItIsCancelledFromAnotherThread) {
  std::atomic<bool> cancel = false;
  std::jthread other([&] {
    testing::happens([&] { return std::filesystem::exists(here / "started"); });
    cancel = true;
  });
  const MapperOutcome outcome = run("touch $here/started; sleep 600", cancel);
  EXPECT_EQ(outcome.kind, Kind::kCancelled);
  EXPECT_TRUE(outcome.retryable());
}

TEST_F(FakeColmapTest, CorruptOutputIsRefused) {
  const MapperOutcome outcome = run(
      "cp -r $here/model $out/0; cp -r $here/model $out/1; head -c 30 $here/model/points3D.bin > $out/1/points3D.bin");
  EXPECT_EQ(outcome.kind, Kind::kCorrupt);
  EXPECT_FALSE(outcome.models);
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("1/points3D.bin"));
  EXPECT_FALSE(outcome.retryable());
}

TEST_F(FakeColmapTest, AFolderWithOtherModelsIsNotUsed) {
  std::filesystem::create_directories(command.output_folder + "/0");
  const MapperOutcome outcome = run("exit 0");
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("is not empty"));
}

TEST_F(FakeColmapTest, AFolderThatCannotBeMadeIsTold) {
  testing::write_file(work / "file", "not a folder");
  command.output_folder = work / "file/models";
  const MapperOutcome outcome = run("exit 0");
  EXPECT_EQ(outcome.kind, Kind::kNotStarted);
  EXPECT_THAT(outcome.models.error_text(), HasSubstr("file/models: Not a directory"));
}

TEST_F(FakeColmapTest, ItIsToldToLeaveNoLogOfItsOwn) {
  run("echo $GLOG_logtostderr > $here/environment");
  EXPECT_EQ(testing::read_file(here / "environment"), "1\n");
}

TEST_F(FakeColmapTest, TheLogIsKeptButBounded) {
  const MapperOutcome outcome = run("cp -r $here/model $out/0; echo first words; head -c 9000000 /dev/zero");
  EXPECT_EQ(outcome.kind, Kind::kModels) << outcome.models.error_text();
  const std::string log = testing::read_file(command.log_file);
  EXPECT_THAT(log, HasSubstr("first words"));
  EXPECT_LT(log.size(), 2'000'000U);
}

TEST_F(FakeColmapTest, AFullDiskIsToldAndWorthAnotherTry) {
  for (const char* end : {"exit 0", "exit 1", "kill -ABRT $$"}) {
    const int result = testing::run_on_small_disk(work.path().string(), 2'000'000, [&] {
      // COLMAP does not report failed writes either.
      const MapperOutcome outcome =
          run("cp -r $here/model $out/0; head -c 9000000 /dev/zero > $out/0/points3D.bin 2> /dev/null; " +
              std::string(end));
      std::fprintf(stderr, "%s\n", outcome.models.error_text().c_str());
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
