// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/windows/cut_window.h"

#include <fmt/format.h>

#include <charconv>

#include "bus/wire/image_stream.h"
#include "camera_driver/source/image_source.h"

namespace rumi::tool {
namespace {

// Sums of larger frame numbers might overflow; no recording is so long.
constexpr int64_t kMaxFrame = 1'000'000'000'000;

// Takes a number from the front of *text. False if there is none, or if it is negative or too large.
bool take_number(std::string_view* text, int64_t* number) {
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), *number);
  if (error != std::errc() || *number < 0 || *number > kMaxFrame) return false;
  text->remove_prefix(static_cast<size_t>(end - text->data()));
  return true;
}

bool take(std::string_view* text, std::string_view word) {
  if (!text->starts_with(word)) return false;
  text->remove_prefix(word.size());
  return true;
}

}  // namespace

std::string FrameRange::to_string() const {
  return stride == 1 ? fmt::format("{}..{}", first, last) : fmt::format("{}..{}:{}", first, last, stride);
}

Result<FrameRange> parse_frame_range(const std::string& text) {
  std::string_view rest = text;
  FrameRange read;
  bool ok = take_number(&rest, &read.first) && take(&rest, "..") && take_number(&rest, &read.last);
  if (ok && take(&rest, ":")) ok = take_number(&rest, &read.stride);
  if (!ok || !rest.empty())
    return Error{"must be FIRST..LAST or FIRST..LAST:STRIDE, frames counted from 0, for example 120..180:5", text};
  if (read.last < read.first) return Error{"ends before it begins", text};
  if (read.stride < 1) return Error{"the stride must be 1 or more", text};
  return read;
}

Result<> WindowCut::check() const {
  if (approach && approach->last >= gap.first)
    return Error{fmt::format("the gap {} must begin after the approach {}", gap.to_string(), approach->to_string())};
  if (departure && departure->first <= gap.last)
    return Error{fmt::format("the departure {} must begin after the gap {}", departure->to_string(), gap.to_string())};
  return {};
}

Result<ruminator::WindowJob> cut_window(camera_driver::ImageSource& source, const WindowCut& cut) {
  if (const Result<> usable = cut.check(); !usable) return usable.error();
  ruminator::WindowJob job;
  ruminator::RuminationWindow& window = job.window;
  window.id = 1;
  window.reason = "cut from a recording";
  job.camera = source.camera();
  const int64_t end = (cut.departure ? *cut.departure : cut.gap).last + 1;
  for (int64_t frame = 0; frame < end; ++frame) {
    std::optional<image_t> image = source.next();
    if (!image)
      return Error{fmt::format("has {} frames, the window ends with frame {}", frame, end - 1), source.name()};
    if (frame == cut.gap.first) window.lost_utime_us = image->utime;
    if (cut.departure && frame == cut.departure->first) window.resumed_utime_us = image->utime;
    window.gap_frames += frame >= cut.gap.first && frame <= cut.gap.last;
    std::vector<ruminator::Sample>* part = nullptr;
    if (cut.approach && cut.approach->contains(frame)) part = &window.approach;
    if (cut.gap.contains(frame)) part = &window.gap;
    if (cut.departure && cut.departure->contains(frame)) part = &window.departure;
    if (!part) continue;
    part->push_back({.utime_us = image->utime});
    job.images.push_back(std::move(*image));
  }
  window.session = job.images.front().utime;
  window.stream = stream_of(job.images.front());
  return job;
}

}  // namespace rumi::tool
