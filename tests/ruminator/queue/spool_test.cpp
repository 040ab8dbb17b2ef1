// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/spool.h"

#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "tests/ruminator/test_jobs.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::small_job;
using ::testing::UnorderedElementsAre;

constexpr int64_t kMegabyte = 1'000'000;

class SpoolTest : public ::testing::Test {
 protected:
  std::unique_ptr<Spool> open(int64_t failed_bytes = kMegabyte) {
    return Spool::open(folder_ / "spool", failed_bytes).value();
  }
  static Spool::Added add(Spool& spool, int32_t id) { return spool.add(small_job(id)).value(); }
  std::vector<std::string> files(const std::string& in = "spool") const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / in)) names.push_back(entry.path().filename().string());
    return names;
  }
  void touch(const std::string& name, const std::string& text = "") {
    testing::write_file(folder_ / ("spool/" + name), text);
  }

  testing::TemporaryFolder folder_;
};

TEST_F(SpoolTest, AJobGoesFromStateToState) {
  const auto spool = open();
  const JobName name{7, 1};
  EXPECT_EQ(add(*spool, 1), Spool::Added::kAdded);
  EXPECT_THAT(spool->waiting(), ElementsAre(name));
  EXPECT_EQ(spool->last_id(7), 1);
  EXPECT_EQ(spool->last_id(8), 0);
  EXPECT_TRUE(read_window_job(spool->window_file(name)).has_value());
  {
    const auto claim = spool->claim(name);
    ASSERT_TRUE(claim);
    EXPECT_EQ(spool->begin_try(name), 1);
    fs::create_directory(spool->work_folder(name));
    const std::vector<uint8_t> submap{1, 2, 3};
    EXPECT_TRUE(spool->store_submap(name, submap));
    EXPECT_THAT(files(), UnorderedElementsAre("7-1.id", "7-1.submap", "failed"));
    EXPECT_THAT(spool->waiting(), IsEmpty());
    EXPECT_THAT(spool->built(), ElementsAre(name));
    EXPECT_EQ(spool->read_submap(name).value(), submap);
    EXPECT_TRUE(spool->complete(name));
    EXPECT_THAT(spool->read_submap(name).error_text(), HasSubstr("7-1.submap: cannot be read (No such file"));
  }
  EXPECT_THAT(files(), UnorderedElementsAre("7-1.id", "failed"));
  EXPECT_EQ(spool->last_id(7), 1) << "a restarted ruminator must not use the id again";
  EXPECT_EQ(add(*spool, 1), Spool::Added::kKnown);
  EXPECT_THAT(spool->waiting(), IsEmpty());
}

TEST_F(SpoolTest, OnlyOneWorksOnAJob) {
  const auto one = open(), other = open();
  add(*one, 1);
  add(*one, 2);
  EXPECT_EQ(add(*other, 2), Spool::Added::kKnown);
  auto claim = one->claim({7, 1});
  ASSERT_TRUE(claim);
  EXPECT_FALSE(other->claim({7, 1}));
  EXPECT_TRUE(other->claim({7, 2}));
  claim.reset();
  EXPECT_TRUE(other->claim({7, 1}));
}

TEST_F(SpoolTest, TheClaimOfAKilledProcessIsNoClaim) {
  const auto spool = open();
  add(*spool, 1);
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto theirs = Spool::open(folder_ / "spool", kMegabyte).value();
    const auto claim = theirs->claim({7, 1});
    theirs->begin_try({7, 1});
    if (write(ready[1], claim ? "y" : "n", 1) != 1) _exit(1);
    pause();
  }
  char got = 0;
  ASSERT_EQ(read(ready[0], &got, 1), 1);
  EXPECT_EQ(got, 'y');
  EXPECT_FALSE(spool->claim({7, 1}));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(spool->claim({7, 1}));
  EXPECT_EQ(spool->begin_try({7, 1}), 2) << "the try that was killed counts";
  spool->forget_try({7, 1});
  EXPECT_EQ(spool->begin_try({7, 1}), 2);
}

TEST_F(SpoolTest, EveryStateThatADeathCanLeaveIsUnderstood) {
  {
    const auto spool = open();
    for (const int id : {1, 2, 3}) add(*spool, id);
    // Window 2: the process died after it stored the submap and before it removed the job. Window 3: it died during a
    // rebuild.
    testing::write_file(folder_ / "spool/7-2.submap", "built");
    fs::create_directory(spool->work_folder({7, 3}));
    touch("7-3.work/database.db", "half");
    touch("7-3.tries", "|");
    // Processes died after they removed the job (4), while they wrote (5), and while they deleted the work folder of a
    // finished job (8); 6 is being written.
    touch("7-4.submap", "built");
    touch("7-5.window.ruminator@somewhere:1.tmp", "half");
    fs::last_write_time(folder_ / "spool/7-5.window.ruminator@somewhere:1.tmp",
                        fs::file_time_type::clock::now() - std::chrono::hours(2));
    touch("7-6.window.ruminator@somewhere:1.tmp", "is being written");
    fs::create_directory(folder_ / "spool/7-8.work");
    touch("7-8.tries", "||");
    // These files are not the spool's.
    touch("notes.txt");
    touch("x-y.window");
    touch("7--1.window");
    touch("99999999999999999999-1.window");
  }
  const auto spool = open();
  EXPECT_THAT(spool->waiting(), ElementsAre(JobName{7, 1}, JobName{7, 3}));
  EXPECT_THAT(spool->built(), ElementsAre(JobName{7, 2}, JobName{7, 4}));
  EXPECT_FALSE(fs::exists(folder_ / "spool/7-5.window.ruminator@somewhere:1.tmp"));
  EXPECT_TRUE(fs::exists(folder_ / "spool/7-6.window.ruminator@somewhere:1.tmp"));
  EXPECT_FALSE(fs::exists(folder_ / "spool/7-8.work"));
  EXPECT_FALSE(fs::exists(folder_ / "spool/7-8.tries"));
  EXPECT_TRUE(fs::exists(folder_ / "spool/notes.txt"));
  ASSERT_TRUE(spool->claim({7, 2}));
  EXPECT_FALSE(fs::exists(spool->window_file({7, 2}))) << "it is built";
  const auto claim = spool->claim({7, 3});
  EXPECT_EQ(spool->begin_try({7, 3}), 2);
  EXPECT_FALSE(fs::exists(spool->work_folder({7, 3}))) << "the half of another";
}

TEST_F(SpoolTest, FailedJobsAreKeptWithReasonAndLog) {
  const auto spool = open();
  add(*spool, 1);
  const auto claim = spool->claim({7, 1});
  spool->begin_try({7, 1});
  fs::create_directory(spool->work_folder({7, 1}));
  touch("7-1.work/colmap.log", "what COLMAP said\n");
  touch("7-1.work/database.db", std::string(100'000, 'x'));
  EXPECT_THAT(spool->fail({7, 1}, "no model").value_or(""), HasSubstr("failed/7-1.window"));
  EXPECT_THAT(files(), UnorderedElementsAre("7-1.id", "failed"));
  EXPECT_THAT(files("spool/failed"), UnorderedElementsAre("7-1.window", "7-1.txt", "7-1.log"));
  EXPECT_EQ(testing::read_file(folder_ / "spool/failed/7-1.txt"), "no model\n");
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-1.log"), HasSubstr("what COLMAP said"));
  EXPECT_TRUE(read_window_job(folder_ / "spool/failed/7-1.window").has_value());
  // A user moves the job back by hand, so it is tried again.
  fs::rename(folder_ / "spool/failed/7-1.window", folder_ / "spool/7-1.window");
  EXPECT_THAT(spool->waiting(), ElementsAre(JobName{7, 1}));
}

TEST_F(SpoolTest, FailedJobsAreBoundedTheOldestGoFirst) {
  const int64_t one = [&] {
    const auto spool = open();
    add(*spool, 1);
    return static_cast<int64_t>(fs::file_size(spool->window_file({7, 1})));
  }();
  const auto spool = open(2 * one + one / 2);
  for (int id = 1; id <= 5; ++id) {
    if (id > 1) add(*spool, id);
    const auto claim = spool->claim({7, id});
    spool->fail({7, id}, "no model");
    const auto time = fs::file_time_type::clock::now() - std::chrono::minutes(10 - id);
    for (const char* suffix : {".window", ".txt"})
      fs::last_write_time(folder_ / ("spool/failed/7-" + std::to_string(id) + suffix), time);
  }
  EXPECT_THAT(files("spool/failed"), UnorderedElementsAre("7-4.window", "7-4.txt", "7-5.window", "7-5.txt"));
  open(0);
  EXPECT_THAT(files("spool/failed"), IsEmpty());
}

TEST_F(SpoolTest, SmallFailedJobsAreBoundedInNumber) {
  open();
  for (int id = 1; id <= 150; ++id)
    for (const char* suffix : {".window", ".txt"}) {
      const std::string file = "failed/7-" + std::to_string(id) + suffix;
      touch(file);
      fs::last_write_time(folder_ / ("spool/" + file),
                          fs::file_time_type::clock::now() - std::chrono::minutes(200 - id));
    }
  open();
  EXPECT_EQ(files("spool/failed").size(), 2 * 100u);
  EXPECT_FALSE(fs::exists(folder_ / "spool/failed/7-50.window"));
  EXPECT_TRUE(fs::exists(folder_ / "spool/failed/7-51.window"));
}

TEST_F(SpoolTest, IdsAreForgottenWhenThereAreMany) {
  open();
  for (int id = 1; id <= 1200; ++id) touch("5-" + std::to_string(id) + ".id");
  testing::write_file(folder_ / "spool/5-1.window", "waits");
  const auto spool = open();
  EXPECT_EQ(spool->last_id(5), 1200);
  EXPECT_TRUE(fs::exists(folder_ / "spool/5-1.id"));
  EXPECT_FALSE(fs::exists(folder_ / "spool/5-2.id"));
  EXPECT_EQ(files().size(), 1000 + 1 + 1 + 1);
}

TEST_F(SpoolTest, AFolderThatCannotBeUsedIsNamed) {
  testing::write_file(folder_ / "file", "");
  EXPECT_THAT(Spool::open(folder_ / "file", kMegabyte).error_text(), HasSubstr("/file: windows cannot be kept in it"));
  const int result = testing::run_on_small_disk(folder_.path().string(), kMegabyte, [&] {
    fs::create_directories(folder_ / "spool/failed");
    if (mount("tmpfs", folder_.path().c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) != 0) return 1;
    const std::string problem = Spool::open(folder_ / "spool", kMegabyte).error_text();
    if (problem.empty()) return 2;
    return problem.find("spool: windows cannot be kept in it (Read-only") != std::string::npos ? 0 : 3;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

TEST_F(SpoolTest, AFullDiskIsReportedAndSpoilsNothing) {
  const int result = testing::run_on_small_disk(folder_.path().string(), 400'000, [&] {
    const auto spool = Spool::open(folder_ / "spool", kMegabyte).value();
    int id = 1;
    std::string error;
    for (; id < 100 && error.empty(); ++id) error = spool->add(small_job(id)).error_text();
    --id;  // the number of the one that failed
    if (error.find("No space left") == std::string::npos) return 1;
    if (static_cast<int>(spool->waiting().size()) != id - 1) return 2;
    const auto claim = spool->claim({7, 1});
    if (spool->begin_try({7, 1}) < 1) return 3;
    const std::vector<uint8_t> submap(200'000);
    if (spool->store_submap({7, 1}, submap).error_text().find("No space left") == std::string::npos) return 4;
    if (!spool->is_waiting({7, 1})) return 5;
    for (const JobName name : spool->waiting())
      if (!read_window_job(spool->window_file(name)).has_value()) return 6;
    return 0;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

}  // namespace
}  // namespace rumi::ruminator
