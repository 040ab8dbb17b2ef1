// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/file_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "base/text/natural_order.h"
#include "formats/image/tiff_pages.h"
#include "formats/recording/file_kind.h"
#include "formats/recording/folder_contents.h"
#include "formats/recording/image_choice.h"
#include "formats/recording/list_lines.h"
#include "formats/recording/recording_masks.h"
#include "formats/times/file_name_times.h"
#include "formats/times/odd_times.h"
#include "formats/times/time_unit.h"
#include "formats/times/times_beside.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> all(const std::vector<ListLine>& lines, std::string ListLine::*member) {
  std::vector<std::string> values;
  values.reserve(lines.size());
  for (const ListLine& line : lines) values.push_back(line.*member);
  return values;
}

// True for 0, 1, 2 ... and 1, 2, 3 ...
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

// Returns "a.jpg" for "a (1).jpg", "a copy.jpg" or "a - Copy.jpg", as file managers name a second copy; empty for other
// names.
std::string original_name(const fs::path& name) {
  const std::string stem = name.stem().string();
  for (const char* mark : {" (", " - ", " copy", "_copy"})
    if (const size_t at = stem.rfind(mark); at != std::string::npos && at > 0)
      return stem.substr(0, at) + name.extension().string();
  return {};
}

std::vector<ListLine> without_copies(FileList* list, std::vector<ListLine> lines, const fs::path& folder) {
  std::set<std::string> names;
  for (const ListLine& line : lines) names.insert(line.name);
  std::vector<std::string> left_out;
  std::erase_if(lines, [&](const ListLine& line) {
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

// Counts HEIC, raw and similar pictures, except those that lie beside a copy that is read (a.cr2, a.jpg).
void count_pictures_not_read(FileList* list, const std::vector<ListLine>& lines) {
  std::set<std::string> read;
  for (const ListLine& line : lines) read.insert(fs::path(line.name).stem().string());
  std::vector<std::string> names;
  for (const std::string& name : pictures_not_read(list->source))
    if (!read.contains(fs::path(name).stem().string()) && !is_no_camera(name)) names.push_back(name);
  if (lines.empty() || names.empty()) return;
  list->not_read = static_cast<int64_t>(names.size());
  list->notes.push_back(fmt::format(
      "{} of its pictures are of a kind that is not read (such as '{}') and are left out: convert them, as with "
      "`mogrify -format png` of ImageMagick",
      names.size(), printable(names.front())));
}

std::vector<ListLine> without_masks(std::vector<ListLine> lines) {
  std::vector<std::string> names = all(lines, &ListLine::name);
  std::sort(names.begin(), names.end());
  std::erase_if(lines, [&](const ListLine& line) { return is_mask_name(line.name, names); });
  return lines;
}

// Returns the lines of one camera, or all if the names do not tell cameras apart. An Error if no name fits `pattern`.
Result<std::vector<ListLine>> choose(FileList* list, const std::vector<ListLine>& lines, const std::string& pattern) {
  const Result<ImageChoice> choice = choose_images(all(lines, &ListLine::name), pattern);
  if (!choice) return Error{choice.error_text(), list->source.string()};
  if (!choice->note.empty()) list->notes.push_back(choice->note);
  std::vector<ListLine> chosen;
  for (const size_t i : choice->kept) chosen.push_back(lines[i]);
  return chosen;
}

// Sorts the lines by the hexadecimal numbers in their names, and notes that. Precondition: the names have the same
// length (are_hexadecimal()).
void sort_by_hexadecimal(FileList* list, std::vector<ListLine>* lines) {
  const auto lower = [](std::string name) {
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    return name;
  };
  std::sort(lines->begin(), lines->end(),
            [&lower](const ListLine& a, const ListLine& b) { return lower(a.name) < lower(b.name); });
  list->notes.push_back(
      fmt::format("the names of its images are read as hexadecimal numbers ('{}')", printable(lines->back().name)));
}

void sort_by_time(std::vector<ListLine>* lines) {
  std::stable_sort(lines->begin(), lines->end(), [](const ListLine& a, const ListLine& b) {
    constexpr auto kUnit = TimeUnit::kSeconds;
    return parse_time_us(a.time, kUnit).value_or(0) < parse_time_us(b.time, kUnit).value_or(0);
  });
}

// An Error if more times are negative than the few that may be wrong.
Result<> check_for_negative_times(const FileList& list, const std::vector<std::string>& times, TimeUnit usual) {
  std::vector<int64_t> utimes_us;
  for (const std::string& time : times) {
    const bool has_sign = time.starts_with('-');
    utimes_us.push_back(has_sign ? -parse_time_us(time.substr(1), usual).value_or(0) : 0);
  }
  const std::string why = why_negative(utimes_us);
  if (!why.empty()) return Error{why, list.source.string(), "give --rate HZ to make new times"};
  return {};
}

// Turns the lines into entries with times. Lines without a time are malformed if times are needed. An Error if too many
// times are negative.
Result<> understand(FileList* list, const std::vector<ListLine>& lines, const fs::path& folder, TimeUnit usual,
                    bool needs_times) {
  std::vector<std::string> times = all(lines, &ListLine::time);
  if (needs_times)
    if (const Result<> checked = check_for_negative_times(*list, times, usual); !checked) return checked;
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
    const ListLine& line = lines[i];
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
  return {};
}

bool take_times_beside(FileList* list, std::vector<ListLine>* lines, const fs::path& folder) {
  TimesBeside beside = times_beside(folder, all(*lines, &ListLine::name));
  if (!beside.note.empty()) list->notes.push_back(beside.note);
  for (size_t i = 0; i < beside.times.size(); ++i) (*lines)[i].time = std::move(beside.times[i]);
  return !beside.times.empty();
}

Result<FileList> read_list(const fs::path& file, const fs::path& folder, const ListOptions& options, TimeUnit usual,
                           const std::string& expected, const LineParser& parse) {
  FileList list;
  list.source = file;
  Result<std::vector<ListLine>> read = read_lines(&list, parse);
  if (!read) return read.error();
  const std::vector<ListLine> lines = without_repeats(&list, std::move(*read));
  tell_of_lines(&list, lines);
  const Result<std::vector<ListLine>> chosen = choose(&list, lines, options.files);
  if (!chosen) return chosen.error();
  if (const Result<> understood = understand(&list, *chosen, folder, usual, options.needs_times); !understood)
    return understood.error();
  if (!list.entries.empty()) return list;
  const std::string remedy = fmt::format("expected lines '{}'", expected);
  if (list.malformed.count > 0) return Error{list.malformed.first, "", remedy};
  return Error{"names no image", file.string(), remedy};
}

bool is_tiff_name(const std::string& name) {
  const std::string extension = lower_extension(name);
  return extension == ".tif" || extension == ".tiff";
}

// Notes the pages that are not played: each of several files may have several pages, such as colour and depth, and only
// its first page is played.
void count_pages_not_read(FileList* list, const std::vector<ListLine>& lines, const fs::path& folder) {
  int64_t files = 0, pages = 0;
  for (const ListLine& line : lines) {
    const auto more = is_tiff_name(line.name) ? static_cast<int64_t>(pages_of_tiff(folder / line.name).size()) - 1 : 0;
    if (more < 1) continue;
    ++files;
    pages += more;
  }
  if (files == 0) return;
  list->not_read += pages;
  list->notes.push_back(
      fmt::format("{} of its TIFF files have several pages: the first page of each is played, {} further ones are left "
                  "out; split them (`tiffsplit FILE`, or give one such file alone)",
                  files, pages));
}

}  // namespace

Result<FileList> list_pages(const fs::path& tiff) {
  FileList list;
  list.source = tiff;
  for (const int page : pages_of_tiff(tiff)) list.entries.push_back({0, tiff, 0, page});
  list.why_no_times = "the pages of a TIFF file have no times";
  if (list.entries.empty()) return Error{"is no TIFF file, or broken", tiff.string()};
  return list;
}

Result<FileList> read_tum_list(const fs::path& rgb_txt, const ListOptions& options) {
  const auto parse = [&options](const std::string& text, ListLine* line) -> Result<> {
    const bool is_path = text.find_first_of(kSeparators) == std::string::npos && !options.needs_times;
    if (is_path)
      line->name = text;
    else
      split_line(text, line);
    if (line->name.empty()) return no_name_after(line->time);
    return {};
  };
  return read_list(rgb_txt, rgb_txt.parent_path(), options, TimeUnit::kSeconds, "seconds path/of/image.png", parse);
}

Result<FileList> read_euroc_list(const fs::path& data_csv, const ListOptions& options) {
  const auto parse = [](const std::string& text, ListLine* line) -> Result<> {
    split_line(text, line);
    if (line->name.empty()) return no_name_after(line->time);
    return {};
  };
  const fs::path folder = data_csv.parent_path() / "data";
  return read_list(data_csv, folder, options, TimeUnit::kNanoseconds, "nanoseconds,name.png", parse);
}

namespace {

// Lists the images of the folder that are to be played, in their order. An Error if the folder cannot be read, or no
// image fits the pattern.
Result<std::vector<ListLine>> images_in(const fs::path& folder, const ListOptions& options, FileList* list) {
  std::vector<ListLine> lines;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code))
    if (is_image_name(it->path())) lines.push_back({"", it->path().filename().string(), 0});
  if (code) return Error{"cannot be read: " + code.message(), folder.string()};
  lines = without_masks(without_copies(list, lines, folder));
  if (options.files.empty()) count_pictures_not_read(list, lines);
  std::sort(lines.begin(), lines.end(),
            [](const ListLine& a, const ListLine& b) { return natural_less(a.name, b.name); });
  // choose() would take each letter in hexadecimal names for another kind of image.
  if (!options.files.empty() || !are_hexadecimal(all(lines, &ListLine::name)))
    return choose(list, lines, options.files);
  sort_by_hexadecimal(list, &lines);
  return lines;
}

// Lists the pages of the only image of a folder, which is a TIFF file.
Result<FileList> pages_in(const fs::path& folder, const std::string& name, const FileList& list) {
  Result<FileList> pages = list_pages(folder / name);
  if (!pages) return pages;
  pages->source = folder;
  pages->notes = list.notes;
  pages->notes.push_back(fmt::format("the {} pages of '{}' are played", pages->entries.size(), name));
  pages->not_read = list.not_read;
  return pages;
}

bool most_have_times(const FileNameTimes& found) {
  constexpr double kMostHaveTimes = 0.9;
  const auto without = static_cast<double>(std::count(found.times.begin(), found.times.end(), ""));
  return without <= (1 - kMostHaveTimes) * static_cast<double>(found.times.size());
}

}  // namespace

Result<FileList> list_image_folder(const fs::path& folder, const ListOptions& options) {
  FileList list;
  list.source = folder;
  Result<std::vector<ListLine>> images = images_in(folder, options, &list);
  if (!images) return images.error();
  std::vector<ListLine>& lines = *images;
  if (lines.empty()) return list;
  if (lines.size() == 1 && is_tiff_name(lines[0].name) && pages_of_tiff(folder / lines[0].name).size() > 1)
    return pages_in(folder, lines[0].name, list);
  count_pages_not_read(&list, lines, folder);

  const std::vector<std::string> names = all(lines, &ListLine::name);
  const FileNameTimes found = times_in_names(names);
  if (most_have_times(found)) {
    for (size_t i = 0; i < lines.size(); ++i) lines[i].time = found.times[i];
    if (!found.note.empty()) list.notes.push_back(found.note);
    if (found.have_another_order) sort_by_time(&lines);
    const Result<> understood = understand(&list, lines, folder, found.usual, options.needs_times);
    if (!understood) return understood.error();
    if (found.count_within_second)
      list.why_no_times = fmt::format("the names of the images count those of each second ('{}')", names.front());
    if (std::string unused = unused_times_beside(folder); !unused.empty()) list.notes.push_back(std::move(unused));
    return list;
  }
  if (options.needs_times && take_times_beside(&list, &lines, folder)) {
    const Result<> understood = understand(&list, lines, folder, TimeUnit::kSeconds, /*needs_times=*/true);
    if (!understood) return understood.error();
    return list;
  }
  for (const ListLine& line : lines) list.entries.push_back({0, folder / line.name, 0});
  list.why_no_times = fmt::format("the names of the images give no times ('{}')", names.front());
  return list;
}

bool has_images(const fs::path& folder) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) return false;
  const Result<FileList> list = list_image_folder(folder, {.files = "", .needs_times = false});
  return list && !list->entries.empty();
}

}  // namespace rumi
