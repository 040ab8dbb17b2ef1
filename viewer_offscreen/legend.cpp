// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/legend.h"

#include <fmt/format.h>

#include <algorithm>

#include "viewer_offscreen/renderer.h"
#include "viewer_offscreen/text.h"

namespace rumi {
namespace {

constexpr double kRow_px = 19, kSample_px = 30;
const TextStyle kWord{9.5}, kStrong{9.5, {20, 20, 24}, true}, kDetail{7.5, {110, 110, 118}};

// 12 345
std::string thousands(int64_t n) {
  if (n < 1000) return fmt::format("{}", n);
  return fmt::format("{} {:03d}", thousands(n / 1000), n % 1000);
}

}  // namespace

Legend::Legend(const Scene& scene, const cv::Rect& panel) : panel_(panel) {
  const size_t room = static_cast<size_t>(panel.height / kRow_px) - 1;
  std::string in_map = fmt::format("{} frames in the map", thousands(scene.frames_in_map));
  if (scene.frames > 0)
    in_map =
        fmt::format("{} of {} frames in the map, {:.1f} %", thousands(scene.frames_in_map), thousands(scene.frames),
                    100.0 * static_cast<double>(scene.frames_in_map) / static_cast<double>(scene.frames));
  rows_.push_back({Sample::kNone, 0, in_map, "", true});
  const size_t lost_rows = scene.lost.empty() ? 0 : 1 + std::min<size_t>(scene.lost.size(), 3);
  add_submaps(scene, room - 1 - lost_rows - (scene.truth.empty() ? 0 : 1));
  if (!scene.truth.empty()) rows_.push_back({Sample::kTruth, 0, "true path", "aligned to the map", false});
  if (!scene.lost.empty()) add_lost(scene, room - rows_.size());
}

void Legend::add_submaps(const Scene& scene, size_t rows_left) {
  const size_t shown = scene.submaps.size() <= rows_left ? scene.submaps.size() : std::max<size_t>(rows_left, 1) - 1;
  for (size_t i = 0; i < shown; ++i) {
    const SubmapView& s = scene.submaps[i];
    const std::string landmarks = thousands(s.landmark_count) + " landmarks";
    const std::string detail =
        s.placed ? fmt::format("{} frames, {} keyframes, {}", thousands(s.frames), thousands(s.keyframes), landmarks)
                 : fmt::format("apart: {} frames, {}", thousands(s.frames), landmarks);
    rows_.push_back({Sample::kSubmap, i, fmt::format("submap {}", s.id), detail, false});
  }
  if (shown < scene.submaps.size())
    rows_.push_back({Sample::kNone, 0, fmt::format("and {} more submaps", scene.submaps.size() - shown), "", false});
}

void Legend::add_lost(const Scene& scene, size_t rows_left) {
  const auto seconds = [&](int64_t utime_us) { return static_cast<double>(utime_us - scene.first_us) * 1e-6; };
  int64_t frames = 0;
  for (const LostSpan& span : scene.lost) frames += span.frames;
  rows_.push_back({Sample::kLost, 0,
                   fmt::format("lost {} time{}", scene.lost.size(), scene.lost.size() == 1 ? "" : "s"),
                   fmt::format("{} frames without a pose", thousands(frames)), false});
  const size_t shown = std::min(scene.lost.size(), rows_left > 0 ? rows_left - 1 : 0);
  for (size_t i = 0; i < shown; ++i) {
    const LostSpan& span = scene.lost[i];
    std::string text = fmt::format("at {:.1f} - {:.1f} s, {} frames", seconds(span.first_us), seconds(span.last_us),
                                   thousands(span.frames));
    if (i + 1 == shown && shown < scene.lost.size()) text += fmt::format(", and {} more", scene.lost.size() - shown);
    rows_.push_back({Sample::kNone, 0, "", text, false});
  }
}

double Legend::baseline(size_t row) const { return panel_.y + 14 + kRow_px * static_cast<double>(row); }

void Legend::draw_samples(PlotCanvas& canvas) const {
  for (size_t i = 0; i < rows_.size(); ++i) {
    const double x = panel_.x, y = baseline(i) - 4.5;
    const cv::Point2d a(x, y), b(x + kSample_px - 8, y);
    if (rows_[i].sample == Sample::kSubmap) canvas.line(a, b, 4, {submap_color(rows_[i].submap)});
    if (rows_[i].sample == Sample::kTruth) canvas.line(a, b, 1.4, {kTruthColor});
    if (rows_[i].sample == Sample::kLost) canvas.dashed(a, b, 2, 4, {kLostColor});
  }
}

void Legend::draw_words(cv::Mat& large) const {
  const double left = panel_.x + kSample_px, right = panel_.x + panel_.width;
  for (size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const TextStyle& style = row.strong ? kStrong : kWord;
    double x = row.sample == Sample::kNone && !row.text.empty() ? panel_.x : left;
    draw_text(large, {x, baseline(i)}, row.text, style);
    if (!row.text.empty()) x += text_width(row.text, style) + 12;
    draw_text(large, {x, baseline(i)}, fit_text(row.detail, right - x, kDetail), kDetail);
  }
}

}  // namespace rumi
