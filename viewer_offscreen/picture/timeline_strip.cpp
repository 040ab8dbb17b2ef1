// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/timeline_strip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lcmtypes/rumi/track_t.hpp"
#include "viewer_offscreen/canvas/palette.h"
#include "viewer_offscreen/canvas/text.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr double kLabelWidth = 86, kLaneHeight = 13, kLaneStep = 19, kFirstLane = 20, kSample = 16;
constexpr double kLeast_px = 1;  // width of a loss, at least, however short it is
constexpr int kTicks = 12;
const char* const kTracked = "tracked, in the colour of the submap";
const TextStyle kWord{8, {90, 90, 98}}, kTick{7.5, {110, 110, 118}};

struct Entry {
  const char* words;
  cv::Vec3b color;
  double height;  // share of the lane's height
};
const Entry kEntries[] = {{"recently lost", kRecentlyLostColor, 0.6},
                          {"lost", kLostColor, 0.35},
                          {"not initialized", kNotInitializedColor, 0.2}};
const Entry& entry_of(int8_t state) {
  return kEntries[state == track_t::RECENTLY_LOST ? 0 : state == track_t::LOST ? 1 : 2];
}

void draw_bar(PlotCanvas& canvas, const cv::Rect2d& lane, double share, const cv::Vec3b& color) {
  const double height = lane.height * share;
  canvas.rectangle({lane.x, lane.y + lane.height - height, lane.width, height}, {color});
}

// Draws a bar with a white core, like a back submap's line, for frames that only a back submap has in the map.
void draw_filled(PlotCanvas& canvas, const cv::Rect2d& lane, const cv::Vec3b& color) {
  draw_bar(canvas, lane, 1, color);
  canvas.rectangle({lane.x, lane.y + lane.height * 0.38, lane.width, lane.height * 0.24}, {kPanelColor});
}

double entry_width(const std::string& words) { return kSample + 6 + text_width(words, kWord) + 16; }

}  // namespace

TimelineStrip::TimelineStrip(const Scene& scene, const cv::Rect& area) : scene_(scene), area_(area) {}

double TimelineStrip::seconds() const {
  return std::max(1e-6, 1e-6 * static_cast<double>(scene_.timeline.end_us - scene_.first_us));
}

double TimelineStrip::x_of(int64_t utime_us) const {
  const double share = 1e-6 * static_cast<double>(utime_us - scene_.first_us) / seconds();
  return area_.x + kLabelWidth + (area_.width - kLabelWidth) * std::clamp(share, 0.0, 1.0);
}

void TimelineStrip::draw_span(PlotCanvas& canvas, double top, const TimelineSpan& span, bool is_map) const {
  const double left = x_of(span.first_us);
  const cv::Rect2d lane(left, top, std::max(kLeast_px, x_of(span.last_us) - left), kLaneHeight);
  if (span.submap < 0) {
    const Entry& entry = entry_of(span.state);
    if (!is_map) draw_bar(canvas, lane, entry.height, entry.color);
    return;
  }
  const SubmapView& submap = scene_.submaps[static_cast<size_t>(span.submap)];
  const cv::Vec3b color = submap_color(submap.kind, submap.color);
  if (submap.kind == SubmapKind::kBack)
    draw_filled(canvas, lane, color);
  else
    draw_bar(canvas, lane, 1, color);
}

void TimelineStrip::draw_lane(PlotCanvas& canvas, double top, const std::vector<TimelineSpan>& spans,
                              bool is_map) const {
  canvas.rectangle({x_of(scene_.first_us), top, area_.width - kLabelWidth, kLaneHeight}, {kPanelColor});
  for (const bool with_submap : {true, false})  // losses come last, so that even one of less than a pixel is seen
    for (const TimelineSpan& span : spans)
      if ((span.submap >= 0) == with_submap) draw_span(canvas, top, span, is_map);
}

void TimelineStrip::draw_shapes(PlotCanvas& canvas) const {
  if (scene_.timeline.in_map.empty()) return;
  draw_lane(canvas, area_.y + kFirstLane, scene_.timeline.tracked, false);
  draw_lane(canvas, area_.y + kFirstLane + kLaneStep, scene_.timeline.in_map, true);
  const double bottom = area_.y + kFirstLane + kLaneStep + kLaneHeight, step = round_time_step(seconds(), kTicks);
  for (double t = 0; t <= seconds(); t += step) {
    const double x = x_of(scene_.first_us + static_cast<int64_t>(t * 1e6));
    canvas.line({x, bottom + 2}, {x, bottom + 6}, 1, {kNotInitializedColor});
  }
  const double y = area_.y + 1.0;
  double x = area_.x + kLabelWidth;
  draw_bar(canvas, {x, y, kSample, kLaneHeight}, 1, submap_color(SubmapKind::kFront, 0));
  x += entry_width(kTracked);
  for (const Entry& entry : kEntries) {
    draw_bar(canvas, {x, y, kSample, kLaneHeight}, entry.height, entry.color);
    x += entry_width(entry.words);
  }
  draw_filled(canvas, {x, y, kSample, kLaneHeight}, submap_color(SubmapKind::kBack, 0));
}

void TimelineStrip::draw_words(cv::Mat& large) const {
  if (scene_.timeline.in_map.empty()) return;
  const double left = area_.x + kLabelWidth, base = area_.y + 12;
  double x = left;
  const auto entry = [&](const std::string& words) {
    draw_text(large, {x + kSample + 6, base}, words, kWord);
    x += entry_width(words);
  };
  entry(kTracked);
  for (const Entry& each : kEntries) entry(each.words);
  entry(
      fmt::format("only by a back submap, {} frame{}", scene_.timeline.filled, scene_.timeline.filled == 1 ? "" : "s"));
  draw_text(large, {double(area_.x), area_.y + kFirstLane + 10.5}, "as it came", kWord);
  draw_text(large, {double(area_.x), area_.y + kFirstLane + kLaneStep + 10.5}, "in the map", kWord);
  const double step = round_time_step(seconds(), kTicks), y = area_.y + kFirstLane + kLaneStep + kLaneHeight + 17;
  for (double t = 0; t <= seconds(); t += step) {
    const std::string label = format_time(t);
    const double width = text_width(label, kTick), at = x_of(scene_.first_us + static_cast<int64_t>(t * 1e6));
    draw_text(large, {std::min(at - width / 2, area_.x + area_.width - width), y}, label, kTick);
  }
}

std::string format_time(double seconds) {
  if (seconds < 60) return fmt::format("{:g} s", std::round(seconds * 10) / 10);
  const int64_t s = std::llround(seconds);
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

double round_time_step(double duration_s, int most) {
  double step = 0.1;
  for (const double next : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0}) {
    if (duration_s / step <= most) return step;
    step = next;
  }
  while (duration_s / step > most) step = step < 3600 ? 3600 : 2 * step;
  return step;
}

}  // namespace rumi::viewer_offscreen
