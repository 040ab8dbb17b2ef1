// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/file_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <set>

#include "base/natural_order.h"
#include "camera_driver/source/timestamps.h"

namespace rumi::camera_driver {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// Control characters of a binary file must not reach the terminal.
std::string printable(const std::string& text) {
  std::string out = text.substr(0, 60);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return out;
}

// Takes a line without comment apart; returns what is wrong with it, or an empty string.
using LineParser = std::function<std::string(const std::string& line, FileList::Entry* entry)>;

FileList read_list(const fs::path& file, const std::string& expected, const LineParser& parse) {
  FileList list;
  list.source = file;
  std::ifstream stream(file);
  if (!stream) {
    list.error = fmt::format("{}: cannot be read; check that it exists and its permissions", file.string());
    return list;
  }
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string content = trimmed(line);
    if (content.empty() || content[0] == '#') continue;
    FileList::Entry entry;
    entry.line = number;
    const std::string problem = parse(content, &entry);
    if (problem.empty()) {
      list.entries.push_back(std::move(entry));
    } else if (list.malformed.count++ == 0) {
      list.malformed.first = fmt::format("{}:{}: {}", file.string(), number, problem);
    }
  }
  if (list.entries.empty()) {
    list.error = list.malformed.count > 0
                     ? fmt::format("{}; expected lines '{}'", list.malformed.first, expected)
                     : fmt::format("{}: names no image; expected lines '{}'", file.string(), expected);
  }
  return list;
}

bool is_image_name(const fs::path& file) {
  static const std::set<std::string> kExtensions = {".jpg",  ".jpeg", ".png", ".bmp", ".tif",
                                                    ".tiff", ".pgm",  ".ppm", ".webp"};
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return kExtensions.contains(extension) && !file.filename().string().starts_with('.');
}

// The time that a file's name gives, if it looks like one: a small whole number is an index, no time.
std::optional<int64_t> time_from_name(const fs::path& file) {
  constexpr size_t kNanosecondDigits = 18;  // any time since 1973
  constexpr size_t kDecimals = 3;
  const std::string stem = file.stem().string();
  const size_t point = stem.find('.');
  const bool only_digits = std::all_of(stem.begin(), stem.end(), [](char c) { return is_digit(c) || c == '.'; });
  if (!only_digits) return std::nullopt;
  if (point == std::string::npos) return stem.size() >= kNanosecondDigits ? parse_nanoseconds_us(stem) : std::nullopt;
  return stem.size() - point > kDecimals ? parse_seconds_us(stem) : std::nullopt;
}

class FileListReader : public FrameReader {
 public:
  explicit FileListReader(FileList list) : list_(std::move(list)) {}

  std::optional<FrameStamp> advance() override {
    if (next_ == list_.entries.size()) return std::nullopt;
    const FileList::Entry& entry = list_.entries[next_++];
    if (entry.line == 0) return FrameStamp{entry.utime_us, entry.file.string()};
    return FrameStamp{entry.utime_us, fmt::format("{}:{}", list_.source.string(), entry.line)};
  }
  std::optional<image_t> load(bool colour, std::string* error) override {
    const fs::path& file = list_.entries[next_ - 1].file;
    std::optional<image_t> image = load_image_file(file, colour, error);
    if (!image) *error = file.string() + ": " + *error;
    return image;
  }
  void rewind() override { next_ = 0; }
  std::vector<int64_t> utimes() const override {
    std::vector<int64_t> all;
    for (const FileList::Entry& entry : list_.entries) all.push_back(entry.utime_us);
    return all;
  }
  Malformed malformed() const override { return list_.malformed; }

 private:
  FileList list_;
  size_t next_ = 0;
};

}  // namespace

FileList read_tum_list(const fs::path& rgb_txt) {
  const fs::path folder = rgb_txt.parent_path();
  return read_list(rgb_txt, "seconds path/of/image.png", [&folder](const std::string& line, FileList::Entry* entry) {
    const size_t space = line.find_first_of(" \t");
    const std::string time = line.substr(0, space);
    const std::optional<int64_t> utime_us = parse_seconds_us(time);
    if (!utime_us) return fmt::format("time is '{}': must be decimal seconds", printable(time));
    if (space == std::string::npos) return std::string("no file name after the time");
    entry->utime_us = *utime_us;
    entry->file = folder / trimmed(line.substr(space));
    return std::string();
  });
}

FileList read_euroc_list(const fs::path& data_csv) {
  const fs::path folder = data_csv.parent_path() / "data";
  return read_list(data_csv, "nanoseconds,name.png", [&folder](const std::string& line, FileList::Entry* entry) {
    const size_t comma = line.find(',');
    const std::string time = trimmed(line.substr(0, comma));
    const std::optional<int64_t> utime_us = parse_nanoseconds_us(time);
    if (!utime_us) return fmt::format("time is '{}': must be whole nanoseconds", printable(time));
    const std::string name = comma == std::string::npos ? "" : trimmed(line.substr(comma + 1));
    if (name.empty()) return std::string("no file name after the time");
    entry->utime_us = *utime_us;
    entry->file = folder / name;
    return std::string();
  });
}

FileList list_image_folder(const fs::path& folder, double rate_hz) {
  FileList list;
  list.source = folder;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code))
    if (is_image_name(it->path())) list.entries.push_back({0, it->path(), 0});
  if (code) list.error = fmt::format("{}: cannot be read: {}", folder.string(), code.message());
  if (list.entries.empty()) return list;
  std::sort(list.entries.begin(), list.entries.end(), [](const FileList::Entry& a, const FileList::Entry& b) {
    return natural_less(a.file.filename().string(), b.file.filename().string());
  });

  bool timed = true;
  for (FileList::Entry& entry : list.entries) {
    const std::optional<int64_t> time = time_from_name(entry.file);
    timed = timed && time.has_value();
    entry.utime_us = time.value_or(0);
  }
  if (timed) return list;
  if (!(rate_hz > 0)) {
    list.error =
        fmt::format("{}: the names of the images give no times ('{}'); give --rate HZ, or fps in the calibration",
                    folder.string(), list.entries.front().file.filename().string());
    return list;
  }
  for (size_t i = 0; i < list.entries.size(); ++i)
    list.entries[i].utime_us = std::llround(static_cast<double>(i) * 1e6 / rate_hz);
  return list;
}

std::unique_ptr<FrameReader> make_file_list_reader(FileList list) {
  return std::make_unique<FileListReader>(std::move(list));
}

}  // namespace rumi::camera_driver
