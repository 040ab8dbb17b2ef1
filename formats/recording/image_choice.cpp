// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/image_choice.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>

namespace rumi {
namespace {

constexpr char kNumber = '*';   // stands for digits in the form of a name
constexpr double kAlike = 0.5;  // share of the smaller kind's numbers; two kinds with more in common count alike

constexpr int kRankOfNoCamera = -2;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

using Numbers = std::vector<std::string>;

struct Name {
  std::string form;    // "left_*.png"
  Numbers numbers;     // "001"
  std::string camera;  // number of the camera, if the name has one
};

// The names of one form.
struct Kind {
  std::string form;
  std::vector<size_t> images;
  std::set<Numbers> numbers;
  int rank = 0;
  std::string camera;
};

// Returns the words in a name, in lower case, without its ending.
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

// Ranks how likely images are those of the camera that is to be tracked, by the words in their names: 1 for a first
// camera, -1 for a second one, kRankOfNoCamera for depth and the like, else 0.
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
    if (is_one_of(kNoCamera) || word.starts_with("depth") || word.starts_with("dispar")) return kRankOfNoCamera;
    if (is_one_of(kSecond)) rank = -1;
    if (is_one_of(kFirst)) rank = 1;
  }
  return rank;
}

// True if the form ends in a word for a camera, so that a short number behind it is the camera's number: "cam0_001.png"
// and "001_cam0.png" are of camera 0. Such a number belongs to the form, unless it is the only one.
bool names_a_camera(const std::string& form) {
  const size_t end = form.ends_with('_') || form.ends_with('-') ? form.size() - 1 : form.size();
  size_t begin = end;
  while (begin > 0 && is_letter(form[begin - 1])) --begin;
  std::string word = form.substr(begin, end - begin);
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word == "cam" || word == "camera" || word == "image" || word == "sensor";
}

Name take_apart(const std::string& name) {
  Name parts;
  for (size_t i = 0; i < name.size();) {
    size_t end = i;
    while (end < name.size() && is_digit(name[end])) ++end;
    const bool is_only = parts.form.find(kNumber) == std::string::npos &&
                         std::none_of(name.begin() + static_cast<std::ptrdiff_t>(end), name.end(), is_digit);
    if (end == i) {
      parts.form += name[i] == kNumber ? '?' : name[i];  // as a pattern, '?' fits the '*' of the name
      ++i;
      continue;
    }
    if (!is_only && end - i <= 2 && names_a_camera(parts.form)) {
      parts.camera = name.substr(i, end - i);
      parts.form += parts.camera;
    } else {
      parts.form += kNumber;
      parts.numbers.push_back(name.substr(i, end - i));
    }
    i = end;
  }
  return parts;
}

std::vector<Kind> kinds_of(const std::vector<Name>& names) {
  std::vector<Kind> kinds;
  std::map<std::string, size_t> index;
  for (size_t i = 0; i < names.size(); ++i) {
    const auto& [form, numbers, camera] = names[i];
    const auto [at, is_new] = index.emplace(form, kinds.size());
    if (is_new) kinds.push_back({form, {}, {}, rank_of(form), camera});
    kinds[at->second].images.push_back(i);
    kinds[at->second].numbers.insert(numbers);
  }
  return kinds;
}

// Splits names such as "1_001.png" and "2_001.png", which have no word, by a number of one digit. It must have few
// values, and the same other numbers beside each. Returns the values with the images of each; empty if the names are
// not like this.
std::map<std::string, std::vector<size_t>> split_by_a_digit(const Kind& kind, const std::vector<Name>& names,
                                                            size_t place) {
  constexpr size_t kMostCameras = 4, kLeastImages = 10;
  std::map<std::string, std::vector<size_t>> images;
  std::map<std::string, std::set<Numbers>> others;
  for (const size_t i : kind.images) {
    Numbers numbers = names[i].numbers;
    const std::string value = numbers.at(place);
    if (value.size() != 1) return {};
    numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(place));
    images[value].push_back(i);
    others[value].insert(numbers);
    if (images.size() > kMostCameras) return {};
  }
  const auto& first = others.begin()->second;
  const bool alike =
      std::all_of(others.begin(), others.end(), [&](const auto& other) { return other.second == first; });
  if (images.size() < 2 || first.size() < kLeastImages || !alike) return {};
  return images;
}

// Returns the form of the names that have `value` as the number at `place`.
std::string form_with(const std::string& form, size_t place, const std::string& value) {
  size_t at = form.find(kNumber);
  for (size_t i = 0; i < place; ++i) at = form.find(kNumber, at + 1);
  return form.substr(0, at) + value + form.substr(at + 1);
}

std::vector<Kind> split_by_digits(const std::vector<Kind>& kinds, const std::vector<Name>& names) {
  std::vector<Kind> split;
  for (const Kind& kind : kinds) {
    const auto places = static_cast<size_t>(std::count(kind.form.begin(), kind.form.end(), kNumber));
    std::map<std::string, std::vector<size_t>> cameras;
    size_t place = 0;
    for (; places > 1 && place < places && cameras.empty(); ++place) cameras = split_by_a_digit(kind, names, place);
    if (cameras.empty()) split.push_back(kind);
    for (const auto& [camera, images] : cameras)
      split.push_back({form_with(kind.form, place - 1, camera), images, kind.numbers, kind.rank, camera});
  }
  return split;
}

bool has_number(const Kind& kind) { return kind.form.find(kNumber) != std::string::npos; }

// True if the two kinds have mostly the same numbers (left_001, right_001). A kind of one image never counts alike: its
// number tells nothing.
bool count_alike(const Kind& a, const Kind& b) {
  if (a.images.size() < 2 || b.images.size() < 2 || !has_number(a) || !has_number(b)) return false;
  const Kind& small = a.numbers.size() < b.numbers.size() ? a : b;
  const Kind& large = a.numbers.size() < b.numbers.size() ? b : a;
  size_t common = 0;
  for (const Numbers& numbers : small.numbers) common += large.numbers.contains(numbers) ? 1 : 0;
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
  const bool are_sides = kind.rank == -1 && main.rank == 1;
  if (are_sides || kind.camera != main.camera) return false;
  return (kind.rank < -1) == (main.rank < -1) && !count_alike(kind, main);
}

Result<ImageChoice> choose_by_pattern(const std::vector<std::string>& names, const std::string& pattern) {
  ImageChoice choice;
  for (size_t i = 0; i < names.size(); ++i) {
    const std::string last = names[i].substr(names[i].rfind('/') + 1);
    if (fnmatch(pattern.c_str(), names[i].c_str(), 0) == 0 || fnmatch(pattern.c_str(), last.c_str(), 0) == 0)
      choice.kept.push_back(i);
  }
  if (choice.kept.empty())
    return Error{fmt::format("camera_driver.files is '{}', which fits no image; one is '{}'", pattern, names.front())};
  return choice;
}

}  // namespace

bool is_no_camera(const std::string& name) { return rank_of(name) == kRankOfNoCamera; }

Result<ImageChoice> choose_images(const std::vector<std::string>& names, const std::string& pattern) {
  if (names.empty()) return ImageChoice();
  if (!pattern.empty()) return choose_by_pattern(names, pattern);
  std::vector<Name> parts;
  parts.reserve(names.size());
  for (const std::string& name : names) parts.push_back(take_apart(name));
  const std::vector<Kind> kinds = split_by_digits(kinds_of(parts), parts);
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

}  // namespace rumi
