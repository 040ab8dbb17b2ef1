// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/run_picture.h"

#include <fmt/format.h>

#include <atomic>
#include <filesystem>

#include "base/child/run_child.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

// Even the map of an hour is drawn in seconds. The limits only end a program that hangs.
constexpr double kTimeLimitS = 300, kIdleLimitS = 15;

// Returns the last line of the program's output, without the name of the program.
std::string last_line(const std::string& output) {
  const size_t end = output.find_last_not_of('\n');
  if (end == std::string::npos) return {};
  const size_t before = output.rfind('\n', end);
  const size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::string line = output.substr(begin, end + 1 - begin);
  const std::string name = "rumi view: ";
  return line.starts_with(name) ? line.substr(name.size()) : line;
}

}  // namespace

Result<> draw_run_picture(const std::string& folder, const std::string& program) {
  const std::string map = fs::absolute(fs::path(folder) / "map.db").string();
  const std::string picture = fs::absolute(fs::path(folder) / "trajectory.png").string();
  std::error_code ignored;
  fs::remove(picture, ignored);  // a picture of an earlier run would be taken for this one's
  ChildCommand command;
  command.arguments = {program, "view", map, "-o", picture, "--title", "Rumi"};
  command.time_limit_s = kTimeLimitS;
  command.idle_limit_s = kIdleLimitS;
  const std::atomic<bool> never = false;
  const ChildResult drawn = run_child(command, never);
  if (drawn.ok()) return {};
  fs::remove(picture + ".part", ignored);
  const std::string said = drawn.outcome == ChildResult::Outcome::kExited ? last_line(drawn.last_output) : "";
  return Error{said.empty() ? fmt::format("drawing it {}", drawn.describe()) : said,
               fmt::format("there is no picture {}", (fs::path(folder) / "trajectory.png").string())};
}

}  // namespace rumi::tool
