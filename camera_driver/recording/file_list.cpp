// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/file_list.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <set>

#include "base/natural_order.h"
#include "bus/transport/log_file.h"
#include "camera_driver/recording/file_name_times.h"
#include "camera_driver/recording/image_choice.h"
#include "camera_driver/recording/odd_times.h"
#include "camera_driver/recording/text_lines.h"
#include "camera_driver/recording/time_unit.h"
#include "camera_driver/recording/times_beside.h"

namespace rumi::camera_driver {
namespace {

namespace fs = std::filesystem;

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// Control characters of a binary file must not reach the terminal.
std::string printable(const std::string& text) {
  std::string out = text.substr(0, 60);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return out;
}

// In whatever unit.
bool is_number(const std::string& text) { return parse_time_us(text, TimeUnit::kNanoseconds).has_value(); }

std::string no_name_after(const std::string& time) {
  if (is_number(time)) return "no file name after the time";
  return fmt::format("time is '{}': must be a number", printable(time));
}

// Longer than any path: no line of a list, whatever the file is.
constexpr size_t kLongestLine = 10'000;

// The names of the columns, without the mark of a comment.
bool is_heading(const std::string& time) {
  return !time.empty() && std::all_of(time.begin(), time.end(), [](unsigned char c) {
    return std::isalpha(c) != 0 || c == '_' || c == '[' || c == ']';
  });
}

// What a line says, not yet understood.
struct Line {
  std::string time, name;  // as they stand there
  int number = 0;
  size_t images = 1;     // that it names
  bool is_first = true;  // of these
  bool has_decimal_comma = false;
};

bool is_image_name(const fs::path& file) {
  static const std::set<std::string> kExtensions = {".jpg",  ".jpeg", ".png", ".bmp", ".tif",
                                                    ".tiff", ".pgm",  ".ppm", ".webp"};
  return kExtensions.contains(lower_extension(file)) && !file.filename().string().starts_with('.');
}

// Around the whole text.
std::string without_quotes(const std::string& text) {
  const bool is_quoted =
      text.size() > 1 && (text[0] == '"' || text[0] == '\'') && text.find(text[0], 1) == text.size() - 1;
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

constexpr const char* kSeparators = " \t,;";

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find_first_of(kSeparators, begin), text.size());
    if (end > begin) words.push_back(without_quotes(text.substr(begin, end - begin)));
  }
  return words;
}

// "1305031102,175304 a.png": the comma is that of a number, as a tool writes it whose language is so set.
void join_decimal_comma(Line* line, char separator) {
  const size_t digits = line->name.find_first_not_of("0123456789");
  const bool may_be = separator == ',' && digits != std::string::npos && digits > 0 &&
                      line->time.find_first_not_of("0123456789") == std::string::npos &&
                      std::string(" \t;").find(line->name[digits]) != std::string::npos;
  if (!may_be) return;
  line->time += '.' + line->name.substr(0, digits);
  line->name = trimmed(line->name.substr(digits + 1));
  line->has_decimal_comma = true;
}

// "left.png right.png", "colour.png 12.5 depth.exr": the first one that is no depth is meant. A name may have spaces,
// too.
void take_first_image(Line* line) {
  const std::vector<std::string> words = words_of(line->name);
  if (words.size() < 2) return;
  const bool is_pair = words.size() == 3 && is_number(words[1]) && (is_image_name(words[0]) || is_image_name(words[2]));
  const auto images = static_cast<size_t>(std::count_if(words.begin(), words.end(), is_image_name));
  const bool are_images = images > 1 && std::all_of(words.begin(), words.end(), [](const std::string& word) {
                            return is_image_name(word) || is_number(word);
                          });
  if (!is_pair && !are_images) return;
  line->images = is_pair ? 2 : images;
  const auto is_of_camera = [](const std::string& word) { return is_image_name(word) && !is_no_camera(word); };
  auto chosen = std::find_if(words.begin(), words.end(), is_of_camera);
  if (chosen == words.end()) chosen = words.begin();
  if (chosen != words.begin() && is_number(*std::prev(chosen))) line->time = *std::prev(chosen);
  line->name = *chosen;
  line->is_first = chosen == words.begin();
}

// "time name": by any separator.
void split_line(const std::string& text, Line* line) {
  const size_t end = text.find_first_of(kSeparators);
  line->time = without_quotes(trimmed(text.substr(0, end)));
  if (end == std::string::npos) return;
  line->name = text.substr(end + 1);
  join_decimal_comma(line, text[end]);
  line->name = without_quotes(trimmed(line->name));
  take_first_image(line);
  std::replace(line->name.begin(), line->name.end(), '\\', '/');  // as Windows writes paths
}

std::vector<std::string> all(const std::vector<Line>& lines, std::string Line::*member) {
  std::vector<std::string> values;
  values.reserve(lines.size());
  for (const Line& line : lines) values.push_back(line.*member);
  return values;
}

// Takes a line without comment apart; returns what is wrong with it, or an empty string.
using LineParser = std::function<std::string(const std::string& text, Line* line)>;

void add_malformed(FileList* list, int line, const std::string& problem) {
  if (list->malformed.count++ == 0)
    list->malformed.first = fmt::format("{}:{}: {}", list->source.string(), line, problem);
}

std::vector<Line> read_lines(FileList* list, const LineParser& parse) {
  std::vector<Line> lines;
  TextLines stream(list->source);
  if (!stream.error().empty()) {
    list->error = fmt::format("{}: {}", list->source.string(), stream.error());
    return lines;
  }
  std::string text;
  for (int number = 1; stream.next(&text); ++number) {
    const std::string content = trimmed(text);
    if (content.empty() || content[0] == '#') continue;
    Line line;
    line.number = number;
    const bool is_too_long = content.size() > kLongestLine;
    const std::string problem = is_too_long ? "is too long for a line of a list" : parse(content, &line);
    if (lines.empty() && list->malformed.count == 0 && is_heading(line.time)) continue;
    if (!problem.empty())
      add_malformed(list, number, problem);
    else
      lines.push_back(std::move(line));
  }
  return lines;
}

// A recorder that writes a line twice means one image.
std::vector<Line> without_repeats(FileList* list, std::vector<Line> lines) {
  std::set<std::pair<std::string, std::string>> known;
  const size_t before = lines.size();
  std::erase_if(lines, [&known](const Line& line) { return !known.emplace(line.time, line.name).second; });
  if (lines.size() < before)
    list->notes.push_back(fmt::format("{} lines say what another one says", before - lines.size()));
  return lines;
}

void tell_of_lines(FileList* list, const std::vector<Line>& lines) {
  const auto most =
      std::max_element(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.images < b.images; });
  if (most == lines.end()) return;
  if (most->images > 1)
    list->notes.push_back(fmt::format("its lines name {} images each: the first one {}is played ('{}')", most->images,
                                      most->is_first ? "" : "that is no depth ", printable(most->name)));
  const auto commas =
      std::count_if(lines.begin(), lines.end(), [](const Line& line) { return line.has_decimal_comma; });
  if (commas > 0) list->notes.push_back(fmt::format("{} of its times have a decimal comma", commas));
}

// 0, 1, 2 ... or 1, 2, 3 ...
bool count_images(const std::vector<std::string>& times) {
  constexpr size_t kLeast = 10;
  if (times.size() < kLeast || (times[0] != "0" && times[0] != "1")) return false;
  const size_t first = times[0] == "0" ? 0 : 1;
  for (size_t i = 0; i < times.size(); ++i)
    if (times[i] != std::to_string(first + i)) return false;
  return true;
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// "a (1).jpg", "a copy.jpg", "a - Copy.jpg" beside "a.jpg", with the same in it: what a file manager makes of a second
// copy. Empty if the name is not such a one.
std::string original_name(const fs::path& name) {
  const std::string stem = name.stem().string();
  for (const char* mark : {" (", " - ", " copy", "_copy"})
    if (const size_t at = stem.rfind(mark); at != std::string::npos && at > 0)
      return stem.substr(0, at) + name.extension().string();
  return {};
}

std::vector<Line> without_copies(FileList* list, std::vector<Line> lines, const fs::path& folder) {
  std::set<std::string> names;
  for (const Line& line : lines) names.insert(line.name);
  std::vector<std::string> left_out;
  std::erase_if(lines, [&](const Line& line) {
    const std::string original = original_name(line.name);
    if (!names.contains(original)) return false;
    std::error_code code;
    const fs::path first = folder / original, second = folder / line.name;
    if (fs::file_size(first, code) != fs::file_size(second, code) || content_of(first) != content_of(second))
      return false;
    left_out.push_back(line.name);
    return true;
  });
  if (!left_out.empty())
    list->notes.push_back(
        fmt::format("{} copies of other images are left out (such as '{}')", left_out.size(), printable(left_out[0])));
  return lines;
}

// Those of one camera, all if that is not to be told.
std::vector<Line> choose(FileList* list, const std::vector<Line>& lines, const std::string& pattern) {
  const ImageChoice choice = choose_images(all(lines, &Line::name), pattern);
  if (!choice.error.empty()) list->error = fmt::format("{}: {}", list->source.string(), choice.error);
  if (!choice.note.empty()) list->notes.push_back(choice.note);
  std::vector<Line> chosen;
  for (const size_t i : choice.kept) chosen.push_back(lines[i]);
  return chosen;
}

// All are of one length.
void sort_by_hexadecimal(FileList* list, std::vector<Line>* lines) {
  const auto lower = [](std::string name) {
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    return name;
  };
  std::sort(lines->begin(), lines->end(),
            [&lower](const Line& a, const Line& b) { return lower(a.name) < lower(b.name); });
  list->notes.push_back(
      fmt::format("the names of its images are read as hexadecimal numbers ('{}')", printable(lines->back().name)));
}

void sort_by_time(std::vector<Line>* lines) {
  std::stable_sort(lines->begin(), lines->end(), [](const Line& a, const Line& b) {
    constexpr auto kUnit = TimeUnit::kSeconds;
    return parse_time_us(a.time, kUnit).value_or(0) < parse_time_us(b.time, kUnit).value_or(0);
  });
}

// Fills in the entries.
void understand(FileList* list, const std::vector<Line>& lines, const fs::path& folder, TimeUnit usual,
                bool needs_times) {
  std::vector<std::string> times = all(lines, &Line::time);
  bool is_counter = false;
  for (const auto& mend : {give_decimals_their_zeros, continue_32_bits}) {
    std::string note = mend(&times);
    if (note.empty()) continue;
    list->notes.push_back(std::move(note));
    is_counter = mend == continue_32_bits;
  }
  if (is_counter) usual = TimeUnit::kMicroseconds;
  if (count_images(times)) list->why_no_times = "its times only count the images";
  const ChosenUnit chosen = choose_time_unit(times, list->why_no_times.empty() ? usual : TimeUnit::kSeconds);
  if (!chosen.note.empty()) list->notes.push_back(chosen.note);
  for (size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    const std::optional<int64_t> utime_us = parse_time_us(times[i], chosen.unit);
    if (!utime_us && !needs_times) list->why_no_times = "its times are not all numbers";
    if (utime_us || !needs_times)
      list->entries.push_back({utime_us.value_or(0), folder / line.name, line.number});
    else
      add_malformed(list, line.number,
                    line.time.empty() ? line.name + ": its name gives no time"
                                      : fmt::format("time is '{}': must be a number of {} that is not negative",
                                                    printable(line.time), name_of(chosen.unit)));
  }
}

bool take_times_beside(FileList* list, std::vector<Line>* lines, const fs::path& folder) {
  TimesBeside beside = times_beside(folder, all(*lines, &Line::name));
  if (!beside.note.empty()) list->notes.push_back(beside.note);
  for (size_t i = 0; i < beside.times.size(); ++i) (*lines)[i].time = std::move(beside.times[i]);
  return !beside.times.empty();
}

bool needs_times(const CameraOptions& options) { return options.rate_hz <= 0; }

FileList read_list(const fs::path& file, const fs::path& folder, const CameraOptions& options, TimeUnit usual,
                   const std::string& expected, const LineParser& parse) {
  FileList list;
  list.source = file;
  std::vector<Line> lines = without_repeats(&list, read_lines(&list, parse));
  tell_of_lines(&list, lines);
  lines = choose(&list, lines, options.files);
  understand(&list, lines, folder, usual, needs_times(options));
  if (list.entries.empty() && list.error.empty()) {
    list.error = list.malformed.count > 0
                     ? fmt::format("{}; expected lines '{}'", list.malformed.first, expected)
                     : fmt::format("{}: names no image; expected lines '{}'", file.string(), expected);
  }
  return list;
}

}  // namespace

FileList read_tum_list(const fs::path& rgb_txt, const CameraOptions& options) {
  const auto parse = [&options](const std::string& text, Line* line) -> std::string {
    const bool is_path = text.find_first_of(kSeparators) == std::string::npos && !needs_times(options);
    if (is_path)
      line->name = text;
    else
      split_line(text, line);
    return line->name.empty() ? no_name_after(line->time) : "";
  };
  return read_list(rgb_txt, rgb_txt.parent_path(), options, TimeUnit::kSeconds, "seconds path/of/image.png", parse);
}

FileList read_euroc_list(const fs::path& data_csv, const CameraOptions& options) {
  const auto parse = [](const std::string& text, Line* line) -> std::string {
    split_line(text, line);
    return line->name.empty() ? no_name_after(line->time) : "";
  };
  const fs::path folder = data_csv.parent_path() / "data";
  return read_list(data_csv, folder, options, TimeUnit::kNanoseconds, "nanoseconds,name.png", parse);
}

std::string other_files(const fs::path& folder) {
  std::map<std::string, int> count;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    std::error_code ignored;
    const bool is_hidden = it->path().filename().string().starts_with('.');
    if (!is_hidden && !is_image_name(it->path()) && it->is_regular_file(ignored)) ++count[lower_extension(it->path())];
  }
  constexpr size_t kMostNamed = 6;
  std::vector<std::string> parts;
  for (const auto& [extension, files] : count)
    if (parts.size() < kMostNamed)
      parts.push_back(fmt::format("{} {}", files, extension.empty() ? "without an ending" : printable(extension)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string recordings_in(const fs::path& folder) {
  static const std::set<std::string> kExtensions = {".mp4",  ".mov",    ".mkv", ".avi",  ".webm", ".m4v",   ".mpg",
                                                    ".mpeg", ".ts",     ".mts", ".m2ts", ".wmv",  ".flv",   ".3gp",
                                                    ".h264", ".h265",   ".264", ".265",  ".ivf",  ".mjpeg", ".lcm",
                                                    ".log",  ".lcmlog", ".bag", ".db3",  ".mcap"};
  std::vector<std::string> names;
  std::error_code code, ignored;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    const bool is_log = lower_extension(it->path()) != ".log" || is_lcm_log(it->path().string());
    if (kExtensions.contains(lower_extension(it->path())) && it->is_regular_file(ignored) && is_log)
      names.push_back(printable(it->path().filename().string()));
  }
  std::sort(names.begin(), names.end());
  constexpr size_t kMostNamed = 4;
  const size_t more = names.size() - std::min(names.size(), kMostNamed);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

FileList list_image_folder(const fs::path& folder, const CameraOptions& options) {
  FileList list;
  list.source = folder;
  std::vector<Line> lines;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code))
    if (is_image_name(it->path())) lines.push_back({"", it->path().filename().string(), 0});
  if (code) list.error = fmt::format("{}: cannot be read: {}", folder.string(), code.message());
  lines = without_copies(&list, lines, folder);
  std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return natural_less(a.name, b.name); });
  if (options.files.empty() && are_hexadecimal(all(lines, &Line::name)))
    sort_by_hexadecimal(&list, &lines);  // each letter would be a kind of its own
  else
    lines = choose(&list, lines, options.files);
  if (!list.error.empty() || lines.empty()) return list;

  constexpr double kMostHaveTimes = 0.9;
  const std::vector<std::string> names = all(lines, &Line::name);
  const FileNameTimes found = times_in_names(names);
  const auto without = static_cast<double>(std::count(found.times.begin(), found.times.end(), ""));
  if (without <= (1 - kMostHaveTimes) * static_cast<double>(names.size())) {
    for (size_t i = 0; i < lines.size(); ++i) lines[i].time = found.times[i];
    if (!found.note.empty()) list.notes.push_back(found.note);
    if (found.have_another_order) sort_by_time(&lines);
    understand(&list, lines, folder, found.usual, needs_times(options));
    if (found.count_within_second)
      list.why_no_times = fmt::format("the names of the images count those of each second ('{}')", names.front());
    if (std::string unused = unused_times_beside(folder); !unused.empty()) list.notes.push_back(std::move(unused));
    return list;
  }
  if (needs_times(options) && take_times_beside(&list, &lines, folder)) {
    understand(&list, lines, folder, TimeUnit::kSeconds, /*needs_times=*/true);
    return list;
  }
  for (const Line& line : lines) list.entries.push_back({0, folder / line.name, 0});
  list.why_no_times = fmt::format("the names of the images give no times ('{}')", names.front());
  return list;
}

}  // namespace rumi::camera_driver
