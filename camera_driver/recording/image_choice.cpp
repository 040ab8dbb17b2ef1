// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/image_choice.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>

namespace rumi::camera_driver {
namespace {

constexpr char kNumber = '*';   // stands for digits in the form of a name
constexpr double kAlike = 0.5;  // of the numbers of the smaller kind: counts alike

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

struct Kind {
  std::string form;  // "left_*.png"
  std::vector<size_t> images;
  std::set<std::string> numbers;  // "001"
  int rank = 0;
};

// Words of letters in a name, without its ending.
std::vector<std::string> words_of(const std::string& form) {
  std::vector<std::string> words(1);
  for (const char c : form.substr(0, form.rfind('.'))) {
    if (is_letter(c))
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!words.back().empty())
      words.emplace_back();
  }
  return words;
}

// How much the images are those of a camera that is to be tracked, by their name.
int rank_of(const std::string& form) {
  static constexpr std::array kNoCamera = {"depth",      "disp",   "disparity", "mask",     "masks", "seg",
                                           "semantic",   "labels", "label",     "normal",   "flow",  "conf",
                                           "confidence", "ir",     "infra",     "infrared", "thumb", "thumbnail"};
  static constexpr std::array kSecond = {"right", "r"};
  static constexpr std::array kFirst = {"left", "l", "rgb", "color", "colour"};
  int rank = 0;
  for (const std::string& word : words_of(form)) {
    const auto is_one_of = [&word](const auto& list) {
      return std::find(list.begin(), list.end(), word) != list.end();
    };
    if (is_one_of(kNoCamera) || word.starts_with("depth") || word.starts_with("dispar")) return -2;
    if (is_one_of(kSecond)) rank = -1;
    if (is_one_of(kFirst)) rank = 1;
  }
  return rank;
}

// "cam0_001.png" is of camera 0: the number after such a word is part of the form, unless it is the last one.
bool names_a_camera(const std::string& form) {
  for (const char* word : {"cam", "camera", "image", "sensor", "image_", "cam_", "camera_"})
    if (form.size() >= std::string(word).size() && form.ends_with(word)) {
      const size_t before = form.size() - std::string(word).size();
      if (before == 0 || !is_letter(form[before - 1])) return true;
    }
  return false;
}

Kind kind_of(const std::string& name) {
  Kind kind;
  std::string number;
  for (size_t i = 0; i < name.size();) {
    size_t end = i;
    while (end < name.size() && is_digit(name[end])) ++end;
    const bool is_last = std::none_of(name.begin() + static_cast<std::ptrdiff_t>(end), name.end(), is_digit);
    if (end == i) {
      kind.form += name[i++];
      continue;
    }
    if (!is_last && end - i <= 2 && names_a_camera(kind.form)) {
      kind.form += name.substr(i, end - i);
    } else {
      kind.form += kNumber;
      number += name.substr(i, end - i) + ' ';
    }
    i = end;
  }
  kind.numbers.insert(number);
  kind.rank = rank_of(kind.form);
  return kind;
}

std::vector<Kind> kinds_of(const std::vector<std::string>& names) {
  std::vector<Kind> kinds;
  std::map<std::string, size_t> index;
  for (size_t i = 0; i < names.size(); ++i) {
    Kind kind = kind_of(names[i]);
    const auto [at, is_new] = index.emplace(kind.form, kinds.size());
    if (is_new) kinds.push_back(kind);
    kinds[at->second].images.push_back(i);
    kinds[at->second].numbers.merge(kind.numbers);
  }
  return kinds;
}

bool has_number(const Kind& kind) { return kind.form.find(kNumber) != std::string::npos; }

// A single image of a form says nothing.
bool count_alike(const Kind& a, const Kind& b) {
  if (a.images.size() < 2 || b.images.size() < 2 || !has_number(a) || !has_number(b)) return false;
  const Kind& small = a.numbers.size() < b.numbers.size() ? a : b;
  const Kind& large = a.numbers.size() < b.numbers.size() ? b : a;
  size_t common = 0;
  for (const std::string& number : small.numbers) common += large.numbers.contains(number) ? 1 : 0;
  return static_cast<double>(common) > kAlike * static_cast<double>(small.numbers.size());
}

bool is_preferred(const Kind& a, const Kind& b) {
  if (has_number(a) != has_number(b)) return has_number(a);
  if (a.rank != b.rank) return a.rank > b.rank;
  if (a.images.size() != b.images.size()) return a.images.size() > b.images.size();
  return a.form < b.form;
}

bool goes_with(const Kind& kind, const Kind& main) {
  if (kind.form == main.form) return true;
  if (has_number(main) && !has_number(kind)) return false;
  return (kind.rank < -1) == (main.rank < -1) && !count_alike(kind, main);
}

ImageChoice choose_by_pattern(const std::vector<std::string>& names, const std::string& pattern) {
  ImageChoice choice;
  for (size_t i = 0; i < names.size(); ++i) {
    const std::string last = names[i].substr(names[i].rfind('/') + 1);
    if (fnmatch(pattern.c_str(), names[i].c_str(), 0) == 0 || fnmatch(pattern.c_str(), last.c_str(), 0) == 0)
      choice.kept.push_back(i);
  }
  if (choice.kept.empty())
    choice.error = fmt::format("camera_driver.files is '{}', which fits no image; one is '{}'", pattern, names.front());
  return choice;
}

}  // namespace

ImageChoice choose_images(const std::vector<std::string>& names, const std::string& pattern) {
  if (names.empty()) return {};
  if (!pattern.empty()) return choose_by_pattern(names, pattern);
  const std::vector<Kind> kinds = kinds_of(names);
  const Kind& main = *std::min_element(kinds.begin(), kinds.end(), is_preferred);
  ImageChoice choice;
  std::vector<std::string> others;
  for (const Kind& kind : kinds) {
    if (goes_with(kind, main))
      choice.kept.insert(choice.kept.end(), kind.images.begin(), kind.images.end());
    else
      others.push_back(fmt::format("{} of '{}'", kind.images.size(), kind.form));
  }
  std::sort(choice.kept.begin(), choice.kept.end());
  if (others.empty()) return choice;
  constexpr size_t kMostNamed = 5;
  const size_t more = others.size() - std::min(others.size(), kMostNamed);
  others.resize(others.size() - more);
  choice.note = fmt::format(
      "of its images only the {} of '{}' are played, not {}{}; to choose, give --set camera_driver.files=PATTERN",
      choice.kept.size(), main.form, fmt::join(others, ", "), more > 0 ? fmt::format(" and {} more kinds", more) : "");
  return choice;
}

}  // namespace rumi::camera_driver
