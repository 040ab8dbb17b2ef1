// SPDX-License-Identifier: BSD-3-Clause
// Runs the programs as a user does, and reads their outputs.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/temporary_folder.h"

namespace rumi::tool {

using testing::read_file;
using testing::TemporaryFolder;

struct Outcome {
  int exit_code = -1;
  std::string output;  // stdout and stderr
};

// Runs a shell command, in which $RUMI is the folder of the executables.
inline Outcome shell(const std::string& command) {
  setenv("RUMI", RUMI_BIN_DIR, 1);
  Outcome outcome;
  std::FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
  char buffer[4096];
  for (size_t n; (n = fread(buffer, 1, sizeof(buffer), pipe)) > 0;) outcome.output.append(buffer, n);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

inline nlohmann::json read_json_file(const std::filesystem::path& file) {
  return nlohmann::json::parse(read_file(file), nullptr, /*allow_exceptions=*/false);
}

inline nlohmann::json evaluate(const std::filesystem::path& out, const std::filesystem::path& truth) {
  const Outcome outcome =
      shell("$RUMI/rumi evaluate '" + out.string() + "' --groundtruth '" + truth.string() + "' --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  return nlohmann::json::parse(outcome.output, nullptr, /*allow_exceptions=*/false);
}

// Renders a sequence of a room with its truth. Returns the folder of the sequence.
inline std::filesystem::path render(const TemporaryFolder& work, const std::string& flags) {
  const std::filesystem::path sequence = work.path() / "sequence";
  const Outcome outcome = shell("$RUMI/rumi synth -q -o '" + sequence.string() + "' " + flags);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  return sequence;
}

}  // namespace rumi::tool
