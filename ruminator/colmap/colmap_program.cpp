// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/colmap_program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <optional>

#include "base/files/temporary_folder.h"
#include "base/running/failures.h"
#include "base/running/log.h"
#include "ruminator/colmap/colmap_dialect.h"
#include "ruminator/colmap/colmap_environment.h"

namespace rumi::ruminator {
namespace {

using Outcome = ChildResult::Outcome;

constexpr double kHelpTimeLimitS = 60;      // enough for a busy machine, or one that loads COLMAP from a slow disk
constexpr size_t kLongestHelp = 8'000'000;  // bytes of help that are read, at most
constexpr size_t kComplaintLength = 300;
constexpr const char* kWithout =
    "windows are rebuilt without it, by Rumi's own models alone: some get fewer poses, or none";

// Returns the option names in lines such as "  --Mapper.num_threads arg (=-1)".
OptionNames options_in_help(std::string_view help) {
  OptionNames names;
  for (size_t at = help.find("--"); at != std::string_view::npos; at = help.find("--", at + 2)) {
    const std::string_view rest = help.substr(at + 2);
    const auto part_of_name = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.';
    };
    const auto end = std::find_if_not(rest.begin(), rest.end(), part_of_name);
    if (end != rest.begin()) names.emplace(rest.begin(), end);
  }
  return names;
}

// Returns "3.8" for "COLMAP 3.8 -- Structure-from-Motion ...", and an empty string if there is no version.
std::string version_in_help(std::string_view help) {
  constexpr std::string_view kName = "COLMAP ";
  const size_t at = help.find(kName);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = help.substr(at + kName.size());
  return std::string(rest.substr(0, rest.find_first_of(" \n\r\t")));
}

std::string version_or_unknown(const std::string& version) {
  return version.empty() ? std::string("of unknown version") : version;
}

std::string why_it_failed(const std::string& name, const ChildResult& help) {
  const std::string said = complaint(help.last_output);
  if (help.outcome == Outcome::kNotStarted) return help.error;
  if (help.outcome == Outcome::kTimedOut)
    return fmt::format("{} does not answer `{} mapper -h` ({}): does it open a window, or wait for something?", name,
                       name, help.describe());
  return fmt::format("{} {}{}{}", name, help.describe(), said.empty() ? "" : ": ", said);
}

}  // namespace

ColmapProgram::~ColmapProgram() {
  end_ = true;
  if (thread_.joinable()) thread_.join();
}

void ColmapProgram::begin_asking() {
  thread_ = std::thread([this] { ask(0, end_); });
}

ChildResult ColmapProgram::ask(int nice, const std::atomic<bool>& cancel) {
  const std::scoped_lock asking(asking_);
  ChildResult known;
  known.outcome = Outcome::kExited;
  if (!options().empty()) return known;
  if (!is_given_up()) return question(nice, cancel);
  known.exit_code = 1;
  known.last_output = problem();
  return known;
}

ChildResult ColmapProgram::question(int nice, const std::atomic<bool>& cancel) {
  ChildCommand command;
  command.arguments = {name_, "mapper", "-h"};
  command.environment = colmap_environment();
  // COLMAP 4.x leaves a log in TMPDIR whenever it is asked for help, whatever the options are. So it gets a TMPDIR that
  // is removed afterwards. If none can be made, the log remains.
  std::optional<TemporaryFolder> tmpdir;
  if (thrown_by([&] { tmpdir.emplace(std::filesystem::temp_directory_path(), "rumi-colmap-"); }).empty())
    command.environment.push_back("TMPDIR=" + tmpdir->path());
  command.time_limit_s = kHelpTimeLimitS;
  command.idle_limit_s = idle_limit_s_;
  command.nice = nice;
  std::string text;
  command.on_output = [&text](std::string_view part) {
    text.append(part.substr(0, kLongestHelp - std::min(kLongestHelp, text.size())));
  };
  ChildResult help = run_child(command, cancel);
  if (help.outcome == Outcome::kCancelled) return help;
  if (help.ok()) refuse_useless(text, &help);
  judge(help, text);
  return help;
}

// Turns the result of a program that ended well but lacks options that we need into a failure.
void ColmapProgram::refuse_useless(const std::string& text, ChildResult* help) const {
  const OptionNames known = options_in_help(text);
  const std::vector<std::string> missing = missing_options(known);
  if (missing.empty()) return;
  help->outcome = Outcome::kNotStarted;
  if (!known.contains("database_path"))
    help->error = fmt::format("{}: does not know COLMAP's command mapper: {}", name_, complaint(help->last_output));
  else
    help->error =
        fmt::format("{}: the mapper of this COLMAP ({}) has no option {}; COLMAP 3.8 to 4.2 has what is needed", name_,
                    version_or_unknown(version_in_help(text)), fmt::join(missing, ", nor "));
}

void ColmapProgram::judge(const ChildResult& help, const std::string& text) {
  if (help.outcome == Outcome::kTimedOut) return give_up(why_it_failed(name_, help));
  if (!help.ok()) return tell(why_it_failed(name_, help));
  const std::scoped_lock lock(mutex_);
  options_ = options_in_help(text);
  version_ = version_in_help(text);
  problem_.clear();
  if (const std::vector<std::string> left_out = options_left_out(options_); !left_out.empty())
    log_debug("{}: the mapper of this COLMAP ({}) has no option {}: left out", name_, version_or_unknown(version_),
              fmt::join(left_out, ", nor "));
}

// Logs the problem now, because problem() may be read much later.
void ColmapProgram::tell(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  // Logs only the first text: later ones may differ by a process number or the time only.
  const bool is_news = problem_.empty();
  problem_ = fmt::format("COLMAP: {}; {}", why, kWithout);
  if (is_news) log_warning("{}", problem_);
}

void ColmapProgram::give_up(const std::string& why) {
  tell(why);
  const std::scoped_lock lock(mutex_);
  options_.clear();
  given_up_ = true;
}

bool ColmapProgram::is_given_up() const {
  const std::scoped_lock lock(mutex_);
  return given_up_;
}

OptionNames ColmapProgram::options() const {
  const std::scoped_lock lock(mutex_);
  return options_;
}

std::string ColmapProgram::version() const {
  const std::scoped_lock lock(mutex_);
  return version_;
}

std::string ColmapProgram::problem() const {
  const std::scoped_lock lock(mutex_);
  return problem_;
}

std::string complaint(std::string_view output) {
  std::string last, error;
  for (size_t begin = 0; begin < output.size();) {
    const size_t end = std::min(output.find('\n', begin), output.size());
    std::string line(output.substr(begin, std::min(end - begin, kComplaintLength)));
    begin = end + 1;
    std::replace_if(
        line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    if (line.find_first_not_of(' ') == std::string::npos) continue;
    line.erase(0, line.find_first_not_of(' '));
    last = line;
    if (contains_any_case(line, "error") || contains_any_case(line, "check failed")) error = line;
  }
  return error.empty() ? last : error;
}

bool tells_of_gpu(std::string_view output) {
  constexpr std::array kWords = {"cuda", "cublas", "cusolver", "nvidia", "no gpu", "sift_gpu", "siftgpu", "opengl"};
  const std::string line = complaint(output);
  return std::any_of(kWords.begin(), kWords.end(), [&](const char* word) { return contains_any_case(line, word); });
}

}  // namespace rumi::ruminator
