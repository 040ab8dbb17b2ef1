// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/recording_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text/natural_order.h"
#include "base/text/number_text.h"
#include "bus/transport/log_file.h"
#include "formats/recording/file_kind.h"
#include "formats/recording/folder_contents.h"
#include "formats/recording/list_lines.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

// Longest gap and overlap between the parts of a recording. A recorder that splits files loses less than kLongestGapUs;
// one that is started again has mostly paused for longer.
constexpr int64_t kLongestGapUs = 60'000'000, kMostOverlapUs = 1'000'000;

bool goes_on(int64_t last_us, int64_t first_us) {
  return first_us >= last_us - kMostOverlapUs && first_us <= last_us + kLongestGapUs;
}

// Makes "walk_#.bag" of "walk_12.bag".
std::string form_of(const fs::path& file) {
  std::string form;
  for (const char c : file.filename().string()) {
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit)
      form += c;
    else if (!form.ends_with('#'))
      form += '#';
  }
  return form;
}

// Returns the numbers in a name, as they are written.
std::vector<std::string> numbers_in(const std::string& name) {
  std::vector<std::string> numbers;
  bool is_in_number = false;
  for (const char c : name) {
    const bool is_digit = c >= '0' && c <= '9';
    if (is_digit && !is_in_number) numbers.emplace_back();
    if (is_digit) numbers.back() += c;
    is_in_number = is_digit;
  }
  return numbers;
}

// True for walk_1.mp4 after walk_0.mp4: one number is larger by one, and the rest is the same.
bool has_next_number(const std::string& name, const std::string& other) {
  if (form_of(name) != form_of(other)) return false;
  const std::vector<std::string> before = numbers_in(name), after = numbers_in(other);
  int changed = 0, next = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i] == after[i]) continue;
    const auto from = parse_number<int64_t>(before[i]), to = parse_number<int64_t>(after[i]);
    ++changed;
    next += from && to && *to == *from + 1 ? 1 : 0;
  }
  return changed == 1 && next == 1;
}

// True for lcm logs and bags, not for videos.
bool has_messages(const fs::path& file) {
  static const std::set<std::string> kOfBags = {".bag", ".mcap", ".db3"};
  return kOfBags.contains(lower_extension(file)) || is_lcm_log(file.string());
}

bool has_images_or_list(const fs::path& folder) {
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code))
    if (is_image_name(it->path()) || it->path().filename() == "rgb.txt" || it->path().filename() == "data.csv")
      return true;
  return false;
}

}  // namespace

std::vector<fs::path> parts_in(const fs::path& folder) {
  std::vector<fs::path> files = recording_files(folder);
  const bool are_parts = files.size() > 1 && has_messages(files.front()) && !has_images_or_list(folder) &&
                         std::all_of(files.begin(), files.end(), [&files](const fs::path& file) {
                           return form_of(file) == form_of(files.front());
                         });
  return are_parts ? files : std::vector<fs::path>();
}

std::string why_not_one_recording(const std::vector<PartTimes>& parts) {
  for (size_t i = 1; i < parts.size(); ++i) {
    const PartTimes &before = parts[i - 1], &part = parts[i];
    if (goes_on(before.last_us, part.first_us)) continue;
    return fmt::format(
        "its files are no parts of one recording: {} was begun {:.1f} s {} the end of {}; give one of the files",
        printable(part.name), std::abs(static_cast<double>(part.first_us - before.last_us)) * 1e-6,
        part.first_us < before.last_us ? "before" : "after", printable(before.name));
  }
  return {};
}

std::string note_on_next_part(const fs::path& file, int64_t last_us, const FirstRecorded& first_recorded_us) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::vector<fs::path> files = recording_files(folder);
  const auto at = std::find(files.begin(), files.end(), folder / file.filename());
  if (at == files.end()) return {};
  // The previous file counts, too: `lcm-logger --rotate` gives the newest file the number 0.
  for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}}) {
    const bool is_there = step < 0 ? at != files.begin() : std::next(at) != files.end();
    if (!is_there || form_of(*(at + step)) != form_of(file)) continue;
    const std::optional<int64_t> first_us = first_recorded_us(*(at + step));
    if (first_us && goes_on(last_us, *first_us))
      return fmt::format("{} beside it goes on where it ends, and is not played: give their folder to play both",
                         printable((at + step)->filename().string()));
  }
  return {};
}

std::string note_on_next_video(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (const fs::path& other : recording_files(folder))
    if (has_next_number(file.filename().string(), other.filename().string()))
      return fmt::format(
          "if {0} beside it goes on where it ends, join them first: `ffmpeg -f concat -safe 0 -i LIST -c copy OTHER`, "
          "where LIST has a line `file NAME` for each",
          printable(other.filename().string()));
  return {};
}

std::optional<int64_t> first_recorded_in_log(const fs::path& file) {
  const std::optional<LogEvent> event = LogReader(file.string()).next_head(0);
  return event ? std::optional(event->utime_us) : std::nullopt;
}

}  // namespace rumi
