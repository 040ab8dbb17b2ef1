// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/file_name_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <ctime>
#include <map>
#include <optional>
#include <regex>

#include "formats/times/odd_times.h"

namespace rumi {
namespace {

constexpr size_t kLongestName = 255;  // characters; for longer ones the regular expressions recurse too deeply

// Returns the part of the name that `form` fits; nullopt if there is none.
std::optional<std::smatch> find(const std::string& name, const std::regex& form) {
  std::smatch match;
  if (name.size() > kLongestName || !std::regex_search(name, match, form)) return std::nullopt;
  return match;
}

struct Zone {
  int64_t seconds = 0;      // local time minus UTC
  bool is_at_once = false;  // the zone follows the second without decimals between
};

// Reads the zone behind the second of a date: "+02:00", "+0200", "-05:00" or ".250+02:00". Other texts, such as "Z",
// are UTC. "-0500" is taken for decimals, which are usual behind this sign.
Zone zone_behind(const std::string& text) {
  static const std::regex form("^([-_.,]?[0-9]{1,9})?([+-])(0[0-9]|1[0-4])(:?)([0-5][0-9])(?:[^0-9]|$)");
  static const std::regex at_once("^([+-])(0[0-9]|1[0-4])(:?)([0-5][0-9])(?:[^0-9]|$)");
  Zone zone;
  std::smatch match;
  zone.is_at_once = std::regex_search(text, match, at_once) && (match[1] == "+" || match[3].length() > 0);
  if (!zone.is_at_once && !std::regex_search(text, match, form)) return zone;
  const size_t sign = zone.is_at_once ? 1 : 2;
  const int64_t seconds = 3600 * std::stoi(match[sign + 1]) + 60 * std::stoi(match[sign + 3]);
  if (match[sign] == "-" && match[sign + 2].length() == 0) return zone;
  zone.seconds = match[sign] == "+" ? seconds : -seconds;
  return zone;
}

std::string date_in(const std::string& name) {
  static const std::regex form(
      "(?:^|[^0-9])((?:19|20)[0-9]{2})([-_.]?)(0[1-9]|1[0-2])\\2(0[1-9]|[12][0-9]|3[01])[-_T. ]?"
      "([01][0-9]|2[0-3])([-_.:h]?)([0-5][0-9])[-_.:m]?([0-5][0-9])(?:[-_.,]?([0-9]{1,9}))?(?:[^0-9]|$)");
  const auto match = find(name, form);
  if (!match) return {};
  const auto number = [&match](size_t group) { return std::stoi((*match)[group].str()); };
  std::tm date{};
  date.tm_year = number(1) - 1900;
  date.tm_mon = number(3) - 1;
  date.tm_mday = number(4);
  date.tm_hour = number(5);
  date.tm_min = number(7);
  date.tm_sec = number(8);
  const time_t seconds = timegm(&date);
  const auto zone = zone_behind(name.substr(static_cast<size_t>(match->position(8) + match->length(8))));
  const int64_t utc = seconds - zone.seconds;
  if (seconds < 0 || utc < 0) return {};
  const std::string decimals = (*match)[9].str();
  return fmt::format("{}.{}", utc, decimals.empty() || zone.is_at_once ? "0" : decimals);
}

// Returns a time of day, in seconds since midnight; empty if the name has none.
std::string clock_in(const std::string& name) {
  static const std::regex form(
      "(?:^|[^0-9])([01]?[0-9]|2[0-3])([-_:h])([0-5][0-9])[-_:m]([0-5][0-9])[.,]([0-9]{1,9})(?:[^0-9]|$)");
  const auto match = find(name, form);
  if (!match) return {};
  const auto number = [&match](size_t group) { return std::stoi((*match)[group].str()); };
  return fmt::format("{}.{}", 3600 * number(1) + 60 * number(3) + number(4), (*match)[5].str());
}

std::string seconds_in(const std::string& name) {
  static const std::regex form("(?:^|[^0-9.])([0-9]+\\.[0-9]{3,}|[0-9]{9,}\\.[0-9]+)(?:[^0-9.]|$)");
  const auto match = find(name, form);
  return match ? (*match)[1].str() : "";
}

std::string whole_number_in(const std::string& name) {
  static const std::regex form("(?:^|[^0-9])([1-9][0-9]{9,18})(?:[^0-9]|$)");
  const auto match = find(name, form);
  return match ? (*match)[1].str() : "";
}

// Returns a number of ten digits, padded with zeros: it may be of a counter of 32 bits, if it begins again at 0.
std::string counter_in(const std::string& name) {
  static const std::regex form("(?:^|[^0-9])([0-9]{10})(?:[^0-9]|$)");
  const auto match = find(name, form);
  return match ? (*match)[1].str() : "";
}

// Returns the unit in which times since 1970 have this many digits.
TimeUnit unit_of_digits(size_t digits) {
  if (digits < 12) return TimeUnit::kSeconds;
  if (digits < 15) return TimeUnit::kMilliseconds;
  return digits < 18 ? TimeUnit::kMicroseconds : TimeUnit::kNanoseconds;
}

// True if the decimals only count the images within each second: 0, 1, 2 ... or 1, 2, 3 ... in each, and at least three
// in one of them.
bool decimals_count(const std::vector<std::string>& times) {
  constexpr size_t kLeast = 3;
  constexpr size_t kMostDigits = 6;
  std::map<std::string, std::vector<std::string>> seconds;
  for (const std::string& time : times) {
    const size_t point = time.find('.');
    if (point == std::string::npos) continue;
    if (time.size() - point - 1 > kMostDigits) return false;
    seconds[time.substr(0, point)].push_back(time.substr(point + 1));
  }
  size_t most = 0;
  for (auto& [second, counts] : seconds) {
    const bool is_cut = &counts == &seconds.begin()->second;  // the first second may be incomplete
    std::sort(counts.begin(), counts.end());
    const int first = std::stoi(counts.front());
    if (first > 1 && !is_cut) return false;
    for (size_t i = 0; i < counts.size(); ++i)
      if (std::stoi(counts[i]) != first + static_cast<int>(i)) return false;
    most = std::max(most, counts.size());
  }
  return most >= kLeast;
}

// Adds a day to the times after midnight, if the recording is shorter than half a day and passes midnight. Returns true
// if it does.
bool pass_midnight(std::vector<std::string>* times) {
  constexpr int64_t kDayUs = 86'400'000'000;
  std::vector<int64_t> sorted;
  for (const std::string& time : *times)
    if (const auto utime_us = parse_time_us(time, TimeUnit::kSeconds)) sorted.push_back(*utime_us);
  std::sort(sorted.begin(), sorted.end());
  const auto gap =
      std::adjacent_find(sorted.begin(), sorted.end(), [](int64_t a, int64_t b) { return b - a > kDayUs / 2; });
  if (gap == sorted.end()) return false;
  for (std::string& time : *times)
    if (const auto utime_us = parse_time_us(time, TimeUnit::kSeconds); utime_us && *utime_us <= *gap)
      time = format_seconds(*utime_us + kDayUs);
  return true;
}

bool is_hexadecimal(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }

// True if decimals have different lengths: sorting such names does not sort the times, as ".0333" comes behind ".1".
bool have_unequal_decimals(const std::vector<std::string>& times) {
  const auto decimals = [](const std::string& time) {
    const size_t point = time.find('.');
    return point == std::string::npos ? 0 : time.size() - point - 1;
  };
  const auto differs = [&](const std::string& a, const std::string& b) {
    return !a.empty() && !b.empty() && decimals(a) != decimals(b);
  };
  return std::adjacent_find(times.begin(), times.end(), differs) != times.end();
}

// Returns the name without its ending, which must not be taken for decimals.
std::string stem_of(const std::string& name) { return name.substr(0, name.rfind('.')); }

}  // namespace

FileNameTimes times_in_names(const std::vector<std::string>& names) {
  FileNameTimes best;
  for (const std::string& name : names) best.times.push_back(counter_in(stem_of(name)));
  best.note = continue_sorted_32_bits(&best.times);
  best.usual = TimeUnit::kMicroseconds;
  best.have_another_order = !best.note.empty();
  if (best.have_another_order) return best;
  best = {};
  size_t most = 0;
  bool are_of_a_day = false;
  for (const auto find_time : {date_in, clock_in, seconds_in, whole_number_in}) {
    FileNameTimes found;
    for (const std::string& name : names) found.times.push_back(find_time(stem_of(name)));
    const auto count = names.size() - static_cast<size_t>(std::count(found.times.begin(), found.times.end(), ""));
    if (count <= most) continue;
    most = count;
    best = std::move(found);
    are_of_a_day = find_time == clock_in;
    const auto first = std::find_if(best.times.begin(), best.times.end(), [](const auto& t) { return !t.empty(); });
    const bool is_whole = first->find('.') == std::string::npos;
    best.usual = is_whole ? unit_of_digits(first->size()) : TimeUnit::kSeconds;
  }
  if (best.times.empty()) best.times.resize(names.size());
  best.count_within_second = decimals_count(best.times);
  if (!best.count_within_second) best.note = give_decimals_their_zeros(&best.times);
  if (are_of_a_day && pass_midnight(&best.times))
    best.note = "the times in the names of its images pass midnight: those after it are of the next day";
  best.have_another_order = !best.note.empty() || have_unequal_decimals(best.times);
  return best;
}

bool are_hexadecimal(const std::vector<std::string>& names) {
  constexpr size_t kLeastNames = 3, kLeastDigits = 3;
  if (names.size() < kLeastNames) return false;
  const std::string first = stem_of(names[0]);
  size_t common = first.size();
  for (const std::string& name : names) {
    const std::string stem = stem_of(name);
    if (stem.size() != first.size()) return false;
    common = std::min<size_t>(common, std::mismatch(first.begin(), first.end(), stem.begin()).first - first.begin());
  }
  while (common > 0 && is_hexadecimal(first[common - 1])) --common;  // digits in common belong to the number
  bool have_letters = false, have_none = false;
  for (const std::string& name : names) {
    const std::string number = stem_of(name).substr(common);
    if (number.size() < kLeastDigits || !std::all_of(number.begin(), number.end(), is_hexadecimal)) return false;
    const bool has_letter = std::any_of(number.begin(), number.end(), [](unsigned char c) { return std::isalpha(c); });
    (has_letter ? have_letters : have_none) = true;
  }
  return have_letters && have_none;
}

}  // namespace rumi
