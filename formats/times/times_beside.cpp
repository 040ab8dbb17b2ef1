// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/times_beside.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <sstream>

#include "formats/times/file_name_times.h"
#include "formats/times/timestamps.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

fs::path find_file(const fs::path& folder) {
  for (const fs::path& place : {folder, folder.parent_path()})
    for (const char* name : {"times.txt", "timestamps.txt", "timestamp.txt", "times.csv", "timestamps.csv"}) {
      std::error_code code;
      if (fs::is_regular_file(place / name, code)) return place / name;
    }
  return {};
}

bool is_time(const std::string& text) { return parse_time_us(text, TimeUnit::kNanoseconds).has_value(); }

Words words_of(std::string line) {
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
  std::istringstream stream(line);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

bool is_heading(const Words& words) {
  return std::none_of(words.begin(), words.end(), [](const std::string& word) {
    return std::any_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  });
}

// Reads lines of words, without comments and headings of columns.
std::vector<Words> read_lines(const fs::path& file) {
  constexpr size_t kLongestLine = 1000, kMostLines = 10'000'000;
  std::vector<Words> lines;
  std::ifstream stream(file);
  for (std::string text; lines.size() < kMostLines && std::getline(stream, text);) {
    if (text.starts_with('#') || text.size() > kLongestLine) continue;
    Words words = words_of(text);
    if (!words.empty() && !(lines.empty() && is_heading(words))) lines.push_back(std::move(words));
  }
  return lines;
}

// Reads dates such as "2011-09-26 13:02:25.964389445".
std::vector<std::string> dates_in(const std::vector<Words>& lines) {
  std::vector<std::string> texts;
  texts.reserve(lines.size());
  for (const Words& words : lines) texts.push_back(fmt::format("{}.x", fmt::join(words, " ")));
  FileNameTimes found = times_in_names(texts);
  return found.times;
}

std::string stem(const std::string& name) { return fs::path(name).stem().string(); }

std::string without_zeros(const std::string& number) {
  return number.substr(std::min(number.find_first_not_of('0'), number.size() - 1));
}

// Returns the number of an image: the last one in its name; the name itself if it has none.
std::string number_of(const std::string& name) {
  const std::string text = stem(name);
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  const auto end = std::find_if(text.rbegin(), text.rend(), is_digit);
  const auto begin = std::find_if_not(end, text.rend(), is_digit);
  return end == text.rend() ? text : without_zeros({begin.base(), end.base()});
}

// Returns the times in the second column, if the first one has the name or the number of each image; else empty.
std::vector<std::string> by_first_column(const std::vector<Words>& lines, const std::vector<std::string>& names) {
  std::map<std::string, std::string> by_name, by_number;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].size() < 2) return {};
    by_name[stem(lines[i][0])] = lines[i][1];
    by_number[number_of(lines[i][0])] = lines[i][1];
  }
  for (const bool is_by_name : {true, false}) {
    const auto& times = is_by_name ? by_name : by_number;
    std::vector<std::string> found;
    for (const std::string& name : names)
      if (const auto at = times.find(is_by_name ? stem(name) : number_of(name)); at != times.end())
        found.push_back(at->second);
    if (found.size() == names.size()) return found;
  }
  return {};
}

}  // namespace

TimesBeside times_beside(const fs::path& folder, const std::vector<std::string>& names) {
  const fs::path file = find_file(folder);
  if (file.empty()) return {};
  const auto refuse = [&file](const std::string& why) {
    return TimesBeside{{}, fmt::format("{} is not used: {}", file.string(), why)};
  };
  const std::vector<Words> lines = read_lines(file);
  if (lines.empty()) return refuse("it has no lines");
  std::vector<std::string> times;
  if (lines.front().size() == 1 && is_time(lines.front()[0]))
    for (const Words& words : lines) times.push_back(words[0]);
  else if (std::vector<std::string> named = by_first_column(lines, names); !named.empty())
    times = std::move(named);
  else
    times = dates_in(lines);
  if (!std::all_of(times.begin(), times.end(), is_time))
    return refuse(fmt::format("not each of its lines is a time, or an image's number and its time"));
  if (times.size() != names.size())
    return refuse(fmt::format("it has {} times, and there are {} images", times.size(), names.size()));
  return {std::move(times), fmt::format("the times of its images are those in {}", file.string())};
}

std::string unused_times_beside(const fs::path& folder) {
  const fs::path file = find_file(folder);
  return file.empty() ? "" : fmt::format("{} is not used: the names of the images are their times", file.string());
}

}  // namespace rumi
