// SPDX-License-Identifier: BSD-3-Clause
// Runs replays of a rendered recording.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "tests/rumi/commands/end_to_end.h"

namespace rumi::tool {

namespace fs = std::filesystem;

class ReplayTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new TemporaryFolder;
    sequence_ = render(*work_, "--seconds 8");
  }
  static void TearDownTestSuite() { delete work_; }

  static Outcome replay(const fs::path& input, const fs::path& out, const std::string& flags = "") {
    return replay_aloud(input, out, "-q " + flags);
  }
  static Outcome replay_aloud(const fs::path& input, const fs::path& out, const std::string& flags = "") {
    return shell("$RUMI/rumi replay '" + input.string() + "' -o '" + out.string() + "' " + flags);
  }
  // Returns all files below a folder, except run.json, which contains run times.
  static std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string name = fs::relative(entry.path(), folder).string();
      if (entry.is_regular_file() && name != "run.json") files[name] = read_file(entry.path());
    }
    return files;
  }
  // Returns windows.csv without its last two columns, which are run times.
  static std::string without_times(const std::string& csv) {
    std::istringstream lines(csv);
    std::string rest;
    for (std::string line; std::getline(lines, line); rest += line + "\n")
      for (int i = 0; i < 2; ++i) line.resize(std::min(line.size(), line.rfind(',')));
    return rest;
  }
  static void expect_same(const fs::path& a, const fs::path& b) {
    auto first = contents(a), second = contents(b);
    for (auto* files : {&first, &second}) (*files)["windows.csv"] = without_times((*files)["windows.csv"]);
    ASSERT_EQ(first.size(), second.size());
    for (const auto& [name, bytes] : first) {
      ASSERT_TRUE(second.count(name)) << name;
      EXPECT_TRUE(bytes == second.at(name)) << name << " differs";
    }
    auto run_a = read_json_file(a / "run.json"), run_b = read_json_file(b / "run.json");
    for (const char* varying :
         {"cpu_ms_per_frame", "cpu_ms_per_frame_by_stage", "cpu_s", "wall_s", "peak_rss_mb", "load"}) {
      EXPECT_TRUE(run_a.contains(varying)) << varying;
      run_a.erase(varying), run_b.erase(varying);
    }
    EXPECT_EQ(run_a, run_b);
  }
  static inline TemporaryFolder* work_ = nullptr;
  static inline fs::path sequence_;
};

}  // namespace rumi::tool
