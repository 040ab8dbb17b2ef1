// SPDX-License-Identifier: BSD-3-Clause
// Names of images, one per line: which of them one camera took, when they were taken, and in which order they are
// played. Byte 0 chooses whether the first line is a pattern that selects images.
#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "base/text/natural_order.h"
#include "camera_driver/recording/frame_order.h"
#include "formats/recording/image_choice.h"
#include "formats/times/file_name_times.h"
#include "formats/times/time_unit.h"
#include "fuzz/target.h"

namespace rumi::fuzz {
namespace {

using namespace camera_driver;

std::vector<int64_t> times_of(const std::vector<std::string>& names) {
  const FileNameTimes found = times_in_names(names);
  if (found.times.size() != names.size()) throw std::logic_error("not a time for each name");
  const ChosenUnit chosen = choose_time_unit(found.times, found.usual);
  std::vector<int64_t> utimes;
  for (const std::string& time : found.times)
    if (const std::optional<int64_t> utime_us = parse_time_us(time, chosen.unit)) utimes.push_back(*utime_us);
  return utimes;
}

void check(const FrameOrder& order, size_t count) {
  std::vector<int> seen(count);
  for (size_t i = 0; i < order.frames.size(); ++i) {
    const OrderedFrame& frame = order.frames[i];
    ++seen.at(frame.frame);
    if (i == 0) continue;
    const OrderedFrame& last = order.frames[i - 1];
    if (frame.elapsed_us <= last.elapsed_us) throw std::logic_error("what has elapsed does not rise");
    if (frame.part == last.part && frame.utime_us <= last.utime_us) throw std::logic_error("the times do not rise");
  }
  for (const size_t frame : order.duplicates) ++seen.at(frame);
  for (const size_t frame : order.wrong_times) ++seen.at(frame);
  const bool is_each_there_once = std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; });
  if (!is_each_there_once) throw std::logic_error("a frame is lost, or there twice");
}

void run(View input) {
  if (input.empty()) return;
  std::istringstream in(to_text(input.subspan(1)));
  std::string pattern;
  if ((input[0] & 1) != 0) std::getline(in, pattern);
  std::vector<std::string> names;
  for (std::string line; std::getline(in, line);) names.push_back(line);
  std::sort(names.begin(), names.end(), natural_less);
  const ImageChoice choice = choose_images(names, pattern).value_or(ImageChoice());
  std::vector<std::string> kept;
  for (const size_t i : choice.kept) kept.push_back(names.at(i));
  const std::vector<int64_t> utimes = times_of(kept);
  if (const Result<FrameOrder> order = order_frames(utimes)) check(*order, utimes.size());
}

std::vector<Bytes> seeds() {
  const std::vector<std::pair<std::string, std::string>> forms = {{"", "1403636579%763555584.png"},
                                                                  {"", "130503110%.175304.jpg"},
                                                                  {"", "2026-03-02_10-15-%00.250.jpg"},
                                                                  {"", "10-15-%05.5.png"},
                                                                  {"", "left_%001.png"},
                                                                  {"", "%001_cam0.png"},
                                                                  {"", "1_%001.png"},
                                                                  {"", "frame-%000.depth.png"},
                                                                  {"", "IMG_20260302_1015%12345.jpg"},
                                                                  {"left*\n", "left_%001.png"},
                                                                  {"*/[a-c]?.png\n", "in/a%1.png"},
                                                                  {"", "a*%1b2.png"}};
  std::vector<Bytes> all;
  for (const auto& [pattern, form] : forms) {
    std::string text(1, pattern.empty() ? '\0' : '\1');
    text += pattern;
    for (char digit = '0'; digit <= '9'; ++digit) {
      text += form + "\n";
      std::replace(text.begin(), text.end(), '%', digit);
    }
    all.push_back(to_bytes(text));
  }
  const std::string pair = "left_1.png\nright_1.png\nleft_2.png\nright_2.png\n1700000009.500.png\n1700000001.600.png\n";
  all.push_back(to_bytes(std::string(1, '\0') + pair));
  return all;
}

const Registered registered({"image_names", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
