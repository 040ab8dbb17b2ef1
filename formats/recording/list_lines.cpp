// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/list_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "formats/recording/folder_contents.h"
#include "formats/recording/image_choice.h"
#include "formats/recording/text_lines.h"
#include "formats/times/timestamps.h"

namespace rumi {
namespace {

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// True for a time in any unit.
bool is_number(const std::string& text) { return parse_time_us(text, TimeUnit::kNanoseconds).has_value(); }

// Longer than any path: a longer line is malformed.
constexpr size_t kLongestLine = 10'000;

// True if the first field of a line is a word: such a line names the columns, although it is no comment.
bool is_heading(const std::string& time) {
  return !time.empty() && std::all_of(time.begin(), time.end(), [](unsigned char c) {
    return std::isalpha(c) != 0 || c == '_' || c == '[' || c == ']';
  });
}

// Returns the text without quotes around all of it.
std::string without_quotes(const std::string& text) {
  const bool is_quoted =
      text.size() > 1 && (text[0] == '"' || text[0] == '\'') && text.find(text[0], 1) == text.size() - 1;
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find_first_of(kSeparators, begin), text.size());
    if (end > begin) words.push_back(without_quotes(text.substr(begin, end - begin)));
  }
  return words;
}

// Repairs lines such as "1305031102,175304 a.png": some tools write decimal commas, as their language setting says.
void join_decimal_comma(ListLine* line, char separator) {
  const size_t digits = line->name.find_first_not_of("0123456789");
  const bool may_be = separator == ',' && digits != std::string::npos && digits > 0 &&
                      line->time.find_first_not_of("0123456789") == std::string::npos &&
                      std::string(" \t;").find(line->name[digits]) != std::string::npos;
  if (!may_be) return;
  line->time += '.' + line->name.substr(0, digits);
  line->name = trimmed(line->name.substr(digits + 1));
  line->has_decimal_comma = true;
}

// Takes the first image that is no depth from "left.png right.png" or "colour.png 12.5 depth.exr". Names may have
// spaces.
void take_first_image(ListLine* line) {
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

}  // namespace

std::string printable(const std::string& text) {
  std::string out = text.substr(0, 60);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return out;
}

Error no_name_after(const std::string& time) {
  if (is_number(time)) return {"no file name after the time"};
  return {fmt::format("time is '{}': must be a number", printable(time))};
}

void split_line(const std::string& text, ListLine* line) {
  const size_t end = text.find_first_of(kSeparators);
  line->time = without_quotes(trimmed(text.substr(0, end)));
  if (end == std::string::npos) return;
  line->name = text.substr(end + 1);
  join_decimal_comma(line, text[end]);
  line->name = without_quotes(trimmed(line->name));
  take_first_image(line);
  std::replace(line->name.begin(), line->name.end(), '\\', '/');  // as Windows writes paths
}

void add_malformed(FileList* list, int line, const std::string& problem) {
  if (list->malformed.count++ == 0)
    list->malformed.first = fmt::format("{}:{}: {}", list->source.string(), line, problem);
}

Result<std::vector<ListLine>> read_lines(FileList* list, const LineParser& parse) {
  std::vector<ListLine> lines;
  TextLines stream(list->source);
  if (!stream.error().empty()) return Error{stream.error(), list->source.string()};
  std::string text;
  for (int number = 1; stream.next(&text); ++number) {
    const std::string content = trimmed(text);
    if (content.empty() || content[0] == '#') continue;
    ListLine line;
    line.number = number;
    const bool is_too_long = content.size() > kLongestLine;
    const Result<> parsed = is_too_long ? Error{"is too long for a line of a list"} : parse(content, &line);
    if (lines.empty() && list->malformed.count == 0 && is_heading(line.time)) continue;
    if (parsed)
      lines.push_back(std::move(line));
    else
      add_malformed(list, number, parsed.error_text());
  }
  return lines;
}

std::vector<ListLine> without_repeats(FileList* list, std::vector<ListLine> lines) {
  std::set<std::pair<std::string, std::string>> known;
  const size_t before = lines.size();
  std::erase_if(lines, [&known](const ListLine& line) { return !known.emplace(line.time, line.name).second; });
  if (lines.size() < before)
    list->notes.push_back(fmt::format("{} lines say what another one says", before - lines.size()));
  return lines;
}

void tell_of_lines(FileList* list, const std::vector<ListLine>& lines) {
  const auto most = std::max_element(lines.begin(), lines.end(),
                                     [](const ListLine& a, const ListLine& b) { return a.images < b.images; });
  if (most == lines.end()) return;
  if (most->images > 1)
    list->notes.push_back(fmt::format("its lines name {} images each: the first one {}is played ('{}')", most->images,
                                      most->is_first ? "" : "that is no depth ", printable(most->name)));
  const auto commas =
      std::count_if(lines.begin(), lines.end(), [](const ListLine& line) { return line.has_decimal_comma; });
  if (commas > 0) list->notes.push_back(fmt::format("{} of its times have a decimal comma", commas));
}

}  // namespace rumi
