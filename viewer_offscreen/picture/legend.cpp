// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/legend.h"

#include <fmt/format.h>

#include <algorithm>

#include "viewer_offscreen/canvas/palette.h"
#include "viewer_offscreen/canvas/text.h"
#include "viewer_offscreen/picture/map_view.h"
#include "viewer_offscreen/picture/timeline_strip.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr double kRow_px = 18, kSample_px = 30;
const TextStyle kWord{8.5}, kStrong{8.8, {20, 20, 24}, true}, kDetail{7.5, {110, 110, 118}};

// Returns the number with a space before each three digits: "12 345".
std::string thousands(int64_t n) {
  if (n < 1000) return fmt::format("{}", n);
  return fmt::format("{} {:03d}", thousands(n / 1000), n % 1000);
}

std::string plural(int64_t n, const char* what) {
  return fmt::format("{} {}{}", thousands(n), what, n == 1 ? "" : "s");
}

}  // namespace

Legend::Legend(const Scene& scene, const cv::Rect& panel) : panel_(panel) {
  const size_t room = static_cast<size_t>(std::max(0.0, (panel.height - 14) / kRow_px)) + 1;
  std::string in_map = plural(scene.frames_in_map, "frame") + " in the map";
  if (scene.frames > 0)
    in_map =
        fmt::format("{} of {} frames in the map, {:.1f} %", thousands(scene.frames_in_map), thousands(scene.frames),
                    100.0 * static_cast<double>(scene.frames_in_map) / static_cast<double>(scene.frames));
  rows_.push_back({Sample::kNone, nullptr, in_map, "", true});
  std::vector<Row> top;
  top.swap(rows_);
  add_joints(scene);
  add_lost(scene);
  std::vector<Row> bottom;
  bottom.swap(rows_);
  rows_ = top;
  const size_t taken = rows_.size() + bottom.size();
  add_submaps(scene, room > taken ? room - taken : 1);
  rows_.insert(rows_.end(), bottom.begin(), bottom.end());
}

void Legend::add_submaps(const Scene& scene, size_t rows_left) {
  std::vector<const SubmapView*> order;
  for (const SubmapView& submap : scene.submaps) order.push_back(&submap);
  std::stable_sort(order.begin(), order.end(), [](const SubmapView* a, const SubmapView* b) {
    return std::pair(a->kind, a->color) < std::pair(b->kind, b->color);
  });
  const size_t shown = order.size() <= rows_left ? order.size() : std::max<size_t>(rows_left, 1) - 1;
  for (size_t i = 0; i < shown; ++i) {
    const SubmapView& s = *order[i];
    const std::string detail = fmt::format("{}{}, {}", s.placed ? "" : "apart: ", plural(s.frames, "frame"),
                                           plural(s.landmark_count, "landmark"));
    const std::string name = fmt::format("{} {}", s.kind == SubmapKind::kBack ? "back" : "front", std::abs(s.key.id));
    rows_.push_back({Sample::kSubmap, &s, name, detail, false});
  }
  if (shown < order.size())
    rows_.push_back(
        {Sample::kNone, nullptr, "", fmt::format("and {}", plural(order.size() - shown, "more submap")), false});
}

void Legend::add_joints(const Scene& scene) {
  const auto same =
      std::count_if(scene.merges.begin(), scene.merges.end(), [](const auto& m) { return m.same_images; });
  const auto place = static_cast<int64_t>(scene.merges.size()) - same;
  if (same > 0)
    rows_.push_back({Sample::kSameImages, nullptr, "joined", plural(same, "time") + " by images of both", false});
  if (place > 0)
    rows_.push_back({Sample::kSamePlace, nullptr, "joined", plural(place, "time") + " by a place seen twice", false});
  if (scene.refused_links > 0)
    rows_.push_back({Sample::kNone, nullptr, "", plural(scene.refused_links, "join") + " refused", false});
  const bool covisible =
      std::any_of(scene.submaps.begin(), scene.submaps.end(), [](const SubmapView& s) { return !s.covisible.empty(); });
  if (covisible) rows_.push_back({Sample::kCovisible, nullptr, "covisible", "keyframes that share landmarks", false});
}

void Legend::add_lost(const Scene& scene) {
  if (!scene.truth.empty()) rows_.push_back({Sample::kTruth, nullptr, "true path", "aligned to the map", false});
  if (scene.lost.empty()) return;
  int64_t frames = 0;
  for (const LostSpan& span : scene.lost) frames += span.frames;
  const std::string where =
      scene.lost.size() == 1
          ? "at " + format_time(1e-6 * static_cast<double>(scene.lost.front().first_us - scene.first_us))
          : "in " + plural(static_cast<int64_t>(scene.lost.size()), "place");
  rows_.push_back({Sample::kLost, nullptr, "no pose", plural(frames, "frame") + " " + where, false});
}

double Legend::baseline(size_t row) const { return panel_.y + 12 + kRow_px * static_cast<double>(row); }

void Legend::draw_samples(PlotCanvas& canvas) const {
  for (size_t i = 0; i < rows_.size(); ++i) {
    const double x = panel_.x, y = baseline(i) - 4.5;
    const cv::Point2d a(x, y), b(x + kSample_px - 8, y);
    const Sample sample = rows_[i].sample;
    if (sample == Sample::kSubmap) draw_path_line(canvas, a, b, 3.6, *rows_[i].submap);
    if (sample == Sample::kTruth) canvas.line(a, b, 1.4, {kTruthColor});
    if (sample == Sample::kLost) canvas.dashed(a, b, 2, 4, {kLostColor});
    if (sample == Sample::kSameImages || sample == Sample::kSamePlace)
      draw_merge(canvas, a + cv::Point2d(4, 0), b - cv::Point2d(4, 0), sample == Sample::kSameImages);
    if (sample == Sample::kCovisible)
      for (const double dy : {-2.5, 0.0, 2.5})
        canvas.line(a + cv::Point2d(0, dy), b + cv::Point2d(0, -dy), 0.7, {submap_color(SubmapKind::kFront, 0), 0.4});
  }
}

void Legend::draw_words(cv::Mat& large) const {
  const double left = panel_.x + kSample_px, right = panel_.x + panel_.width;
  for (size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const TextStyle& style = row.strong ? kStrong : kWord;
    double x = row.strong ? panel_.x : left;
    draw_text(large, {x, baseline(i)}, row.text, style);
    if (!row.text.empty()) x += text_width(row.text, style) + 10;
    if (row.detail.empty()) continue;
    draw_text(large, {x, baseline(i)}, fit_text(row.detail, right - x, kDetail), kDetail);
  }
}

}  // namespace rumi::viewer_offscreen
