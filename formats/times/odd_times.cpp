// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/odd_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "formats/times/timestamps.h"
#include "slam/numeric/steps.h"

namespace rumi {
namespace {

constexpr int64_t kWrap = int64_t{1} << 32;
constexpr int64_t kHalf = kWrap / 2;

// Returns the sum of the deviations of the steps between times from their median; nullopt if a time is no number of
// seconds.
std::optional<int64_t> unevenness_us(const std::vector<std::string>& times) {
  std::vector<int64_t> sorted;
  for (const std::string& time : times) {
    const std::optional<int64_t> utime_us = parse_time_us(time, TimeUnit::kSeconds);
    if (!utime_us) return std::nullopt;
    sorted.push_back(*utime_us);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<int64_t> all = steps(sorted);
  const int64_t usual = median(&all);
  int64_t sum = 0;
  for (const int64_t step : all) sum += std::abs(step - usual);
  return sum;
}

// Reads whole numbers of 32 bits; nullopt if a text is anything else (empty, too), or if there are fewer than four.
std::optional<std::vector<int64_t>> numbers_of_32_bits(const std::vector<std::string>& times) {
  constexpr size_t kLeast = 4;
  std::vector<int64_t> numbers;
  for (const std::string& time : times) {
    const bool is_whole = !time.empty() && time.size() <= 10 && time.find_first_not_of("0123456789") == time.npos;
    if (!is_whole) return std::nullopt;
    numbers.push_back(std::stoll(time));
    if (numbers.back() >= kWrap) return std::nullopt;
  }
  if (numbers.size() < kLeast) return std::nullopt;
  return numbers;
}

// True if the steps are those of a camera: at most 2000 images a second, at least one in 10 s.
bool are_microseconds(std::vector<int64_t> numbers) {
  constexpr int64_t kShortestUs = 500, kLongestUs = 10'000'000;
  std::sort(numbers.begin(), numbers.end());
  std::vector<int64_t> all = steps(numbers);
  const int64_t usual = median(&all);
  return usual >= kShortestUs && usual <= kLongestUs;
}

std::string take(const std::vector<int64_t>& numbers, std::vector<std::string>* times) {
  for (size_t i = 0; i < numbers.size(); ++i) (*times)[i] = std::to_string(numbers[i]);
  return "its times begin again at 2^32, as those of a counter of 32 bits do: they are continued, as microseconds";
}

}  // namespace

std::string give_decimals_their_zeros(std::vector<std::string>* times) {
  constexpr size_t kLeast = 4;
  constexpr int64_t kMuchMoreEven = 4;
  size_t shortest = SIZE_MAX, longest = 0;
  for (const std::string& time : *times) {
    const size_t point = time.find('.');
    if (point == std::string::npos || time.find_first_not_of("0123456789.") != std::string::npos) return {};
    shortest = std::min(shortest, time.size() - point - 1);
    longest = std::max(longest, time.size() - point - 1);
  }
  const bool may_be = times->size() >= kLeast && shortest < longest && (longest == 3 || longest == 6 || longest == 9);
  if (!may_be) return {};
  std::vector<std::string> counts = *times;
  for (std::string& time : counts) {
    const size_t point = time.find('.');
    time.insert(point + 1, longest - (time.size() - point - 1), '0');
  }
  const std::optional<int64_t> as_decimals = unevenness_us(*times), as_counts = unevenness_us(counts);
  if (!as_decimals || !as_counts || *as_counts * kMuchMoreEven > *as_decimals) return {};
  *times = std::move(counts);
  return "the decimals of its times are of unequal length: they are read as counts without leading zeros (.33333 as "
         ".033333), with which the times are even";
}

std::string continue_32_bits(std::vector<std::string>* times) {
  std::optional<std::vector<int64_t>> numbers = numbers_of_32_bits(*times);
  if (!numbers) return {};
  int64_t added = 0, last = numbers->front();
  for (int64_t& number : *numbers) {
    if (last - number > kHalf) added += kWrap;
    last = number;
    number += added;
  }
  return added > 0 && are_microseconds(*numbers) ? take(*numbers, times) : "";
}

std::string continue_sorted_32_bits(std::vector<std::string>* times) {
  std::optional<std::vector<int64_t>> numbers = numbers_of_32_bits(*times);
  if (!numbers) return {};
  std::vector<int64_t> sorted = *numbers;
  std::sort(sorted.begin(), sorted.end());
  const auto gap = std::adjacent_find(sorted.begin(), sorted.end(), [](int64_t a, int64_t b) { return b - a > kHalf; });
  // A single number far from all others is an error, and does not mean that the counter began again.
  if (gap == sorted.end() || sorted.end() - gap < 3 || gap == sorted.begin()) return {};
  for (int64_t& number : *numbers) number += number <= *gap ? kWrap : 0;
  return are_microseconds(*numbers) ? take(*numbers, times) : "";
}

std::string why_negative(const std::vector<int64_t>& utimes_us) {
  constexpr ptrdiff_t kFew = 4;
  const auto is_negative = [](int64_t utime_us) { return utime_us < 0; };
  const auto count = std::count_if(utimes_us.begin(), utimes_us.end(), is_negative);
  if (count == 0 || (count <= kFew && count < static_cast<ptrdiff_t>(utimes_us.size()))) return {};
  const int64_t first = *std::find_if(utimes_us.begin(), utimes_us.end(), is_negative);
  return fmt::format("{} of its {} images have negative times (the first {:.6f} s)", count, utimes_us.size(),
                     static_cast<double>(first) * 1e-6);
}

}  // namespace rumi
