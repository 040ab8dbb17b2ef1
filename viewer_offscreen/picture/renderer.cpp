// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/renderer.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "viewer_offscreen/canvas/text.h"
#include "viewer_offscreen/picture/camera_inset.h"
#include "viewer_offscreen/picture/legend.h"
#include "viewer_offscreen/picture/timeline_strip.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr size_t kMaxApart = 4;                         // submaps that are shown apart from the map, at most
constexpr int64_t kFirstDate_us = 946'684'800'000'000;  // 2000-01-01: earlier times do not count from 1970, so no date
                                                        // is shown
const TextStyle kTitle{15, {20, 20, 24}, true}, kNote{8.5, {120, 120, 128}}, kLabel{8.5, {70, 70, 78}};

const char* name_of(ViewKind kind) {
  switch (kind) {
    case ViewKind::kTop:
      return "from above";
    case ViewKind::kSide:
      return "from the side";
    case ViewKind::kFollow:
      return "behind the camera";
    default:
      return "oblique";
  }
}

MapViewStyle style_of(const Layout::View& view) {
  const bool follow = view.kind == ViewKind::kFollow;
  return {view.kind, view.is_main ? 2.6 : 1.8, view.is_main || follow ? 1.5 : 1.0,
          (view.is_main && view.kind == ViewKind::kOblique) || follow, 0};
}

// Draws a scale bar of the given length at the lower right of the panel.
void draw_scale_bar(PlotCanvas& canvas, const cv::Rect& panel, double length_px) {
  const cv::Point2d b(panel.x + panel.width - 12, panel.y + panel.height - 12), a = b - cv::Point2d(length_px, 0);
  canvas.line(a, b, 1.6, {kCameraColor});
  for (const cv::Point2d& end : {a, b})
    canvas.line(end - cv::Point2d(0, 4), end + cv::Point2d(0, 4), 1.6, {kCameraColor});
}

std::string length_words(const Scene& scene, double length) {
  if (!scene.metres_per_unit) return fmt::format("{:g} units", length);
  return fmt::format("{:g} units, {:.2g} m", length, length * *scene.metres_per_unit);
}

std::string time_words(const Scene& scene) {
  if (scene.timeline.in_map.empty()) return "no map yet";
  std::string words = format_time(1e-6 * static_cast<double>(scene.timeline.end_us - scene.first_us)) + " of images";
  if (scene.last_us >= kFirstDate_us)
    words +=
        fmt::format(", until {:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(static_cast<time_t>(scene.last_us / 1'000'000)));
  return words + "; lengths in the map's own arbitrary unit";
}

cv::Rect apart_panel(const cv::Rect& main, size_t i) {
  return {main.x + 8 + static_cast<int>(i) * 157, main.y + main.height - 118, 149, 110};
}

struct DrawnView {
  Layout::View view;
  MapViews::Drawn drawn;
  double bar_px() const { return drawn.scale.value_or(0) * drawn.grid; }
};

void draw_view_words(cv::Mat& large, const Scene& scene, const DrawnView& shown) {
  const cv::Rect& panel = shown.view.panel;
  draw_label(large, {panel.x + 10.0, panel.y + 18.0}, name_of(shown.view.kind), kLabel);
  if (shown.bar_px() <= 0) return;
  const std::string words = length_words(scene, shown.drawn.grid);
  draw_label(large, {panel.x + panel.width - 10 - text_width(words, kLabel), panel.y + panel.height - 22.0}, words,
             kLabel);
}

std::vector<const SubmapView*> submaps_apart(const Scene& scene) {
  std::vector<const SubmapView*> apart;
  for (const SubmapView& s : scene.submaps)
    if (!s.placed && !s.trajectory.empty()) apart.push_back(&s);
  std::stable_sort(apart.begin(), apart.end(),
                   [](const SubmapView* a, const SubmapView* b) { return a->frames > b->frames; });
  if (apart.size() > kMaxApart) apart.resize(kMaxApart);
  return apart;
}

}  // namespace

Renderer::Renderer() : canvas_(kPictureWidth, kPictureHeight) {}

cv::Mat Renderer::draw(const Scene& scene, std::optional<ViewKind> only) {
  std::vector<const SubmapView*> placed;
  for (const SubmapView& s : scene.submaps)
    if (s.placed) placed.push_back(&s);
  const std::vector<const SubmapView*> apart = submaps_apart(scene);
  const bool with_camera = !scene.camera_view.image.empty();
  const Layout layout = only ? layout_one(*only, with_camera) : layout_all(with_camera);
  const cv::Rect main = layout.views.front().panel;

  canvas_.clear(kPaperColor);
  MapViews views(canvas_, scene);
  std::vector<DrawnView> drawn;
  for (const Layout::View& view : layout.views) {
    drawn.push_back({view, views.draw(placed, view.panel, style_of(view))});
    if (drawn.back().bar_px() > 0) draw_scale_bar(canvas_, view.panel, drawn.back().bar_px());
  }
  for (size_t i = 0; i < apart.size(); ++i)
    views.draw({apart[i]}, apart_panel(main, i), {ViewKind::kTop, 1.6, 1, false, 20});
  const Legend legend(scene, layout.legend);
  legend.draw_samples(canvas_);
  const TimelineStrip strip(scene, layout.strip);
  strip.draw_shapes(canvas_);

  cv::Mat large = canvas_.read();
  draw_text(large, {18, 37}, fit_text(scene.title, 560, kTitle), kTitle);
  const std::string times = time_words(scene);
  draw_text(large, {1262 - text_width(times, kNote), 37}, times, kNote);
  for (const DrawnView& view : drawn) draw_view_words(large, scene, view);
  for (size_t i = 0; i < apart.size(); ++i)
    draw_text(large, {apart_panel(main, i).x + 7.0, apart_panel(main, i).y + 15.0},
              fmt::format("submap {}, own scale", apart[i]->key.id), kNote);
  if (with_camera) {
    const cv::Rect area = inset_area(scene.camera_view, layout.camera);
    draw_inset(large, scene.camera_view, area, submap_color(SubmapKind::kFront, 1));
    draw_text(large, {layout.camera.x + 2.0, area.y + area.height + 15.0},
              fit_text(scene.camera_view.caption, layout.camera.width - 2, kNote), kNote);
  }
  legend.draw_words(large);
  strip.draw_words(large);
  cv::Mat picture;
  cv::resize(large, picture, {kPictureWidth, kPictureHeight}, 0, 0, cv::INTER_AREA);
  return picture;
}

}  // namespace rumi::viewer_offscreen
