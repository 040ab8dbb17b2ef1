// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/refused_images.h"

#include <fmt/format.h>

#include "base/running/log.h"

namespace rumi::front_tracker {
namespace {

using Kind = RefusedImages::Kind;

struct Words {
  const char* name;
  const char* what;    // put behind "75 of 150 images refused: "
  const char* remedy;  // put behind "; "
};

Words words_of(Kind kind) {
  switch (kind) {
    case Kind::kNoImage:
      return {"no image", "no messages of the type image_t, or broken",
              "is the channel another's (--channel)? Look at who publishes on it"};
    case Kind::kNoTime:
      return {"time", "without a time that can be used", "look at the program that gives them their times"};
    case Kind::kOlder:
      return {"out of order", "out of order, older than the one before",
              "publish them in the order in which they were taken"};
    case Kind::kDoubled:
      return {"doubled", "doubled, of the time of the one before", "publish each of them once"};
    case Kind::kAhead:
      return {"far ahead", "of a time far ahead of those around them", "look at the clock that gives them their times"};
    case Kind::kOtherCamera:
      return {"another camera", "of another camera or stream on the same channel",
              "give each camera a channel of its own (--channel)"};
    case Kind::kCalibration:
      return {"calibration", "without a calibration that can be read",
              "give the camera's with --camera FILE (front_tracker, rumi up)"};
    case Kind::kSize:
      return {"size", "not of the calibration's size", "images of another size need a calibration of that size"};
    case Kind::kDamaged:
      return {"damaged", "damaged, or of a format that is not read", "look at what encodes and sends them"};
  }
  return {"", "", ""};
}

}  // namespace

void RefusedImages::add(Kind kind, const std::string& problem) {
  count(kind);
  tell(kind, problem);
}

void RefusedImages::tell(Kind kind, const std::string& problem) {
  news_ = true;
  if (told_.emplace(kind, problem).second)
    log_warning("image not used: {} (further images like it are only counted)", problem);
}

int64_t RefusedImages::of(Kind kind) const {
  const auto count = counts_.find(kind);
  return count == counts_.end() ? 0 : count->second;
}

int64_t RefusedImages::total() const {
  int64_t total = 0;
  for (const auto& [kind, count] : counts_) total += count;
  return total;
}

std::string RefusedImages::text() const {
  std::string text;
  for (const auto& [kind, count] : counts_)
    if (count > 0) text += fmt::format(", {} images refused: {}", count, words_of(kind).name);
  return text;
}

std::vector<std::string> RefusedImages::complaints(int64_t all) const {
  std::vector<std::string> sentences;
  for (const auto& [kind, count] : counts_) {
    if (count * 100 <= all) continue;
    const Words words = words_of(kind);
    const auto told = told_.find(kind);
    const std::string first = told == told_.end() ? "" : fmt::format(" (the first: {})", told->second);
    sentences.push_back(fmt::format("{} of {} images refused: {}{}; {}", count, all, words.what, first, words.remedy));
  }
  return sentences;
}

}  // namespace rumi::front_tracker
