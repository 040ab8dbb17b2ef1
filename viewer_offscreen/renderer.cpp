// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "viewer_offscreen/legend.h"
#include "viewer_offscreen/projection.h"
#include "viewer_offscreen/text.h"

namespace rumi {
namespace {

using Eigen::Vector3d;

const cv::Vec3b kPaper{246, 246, 243}, kPanel{255, 255, 255}, kFrame{214, 214, 210}, kGridColor{226, 228, 232},
    kShadow{205, 207, 212}, kCameraColor{25, 25, 30};
constexpr size_t kMaxLandmarks = 250'000;  // points drawn per view; more are thinned evenly
constexpr int kMaxKeyframeFrusta = 36;     // per submap
constexpr size_t kMaxApart = 4;            // submaps shown apart from the map

const cv::Rect kObliquePanel(20, 62, 836, 638), kTopPanel(874, 62, 386, 318), kLegendPanel(878, 396, 380, 304);

using Views = std::vector<const SubmapView*>;

void panel_frame(PlotCanvas& canvas, const cv::Rect& r) {
  const cv::Point2d a(r.x, r.y), b(r.x + r.width, r.y), c(r.x + r.width, r.y + r.height), d(r.x, r.y + r.height);
  canvas.triangle(a, b, c, {kPanel});
  canvas.triangle(a, c, d, {kPanel});
  for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, d}, {d, a}}) canvas.line(from, to, 1, {kFrame});
}

void draw_grid(PlotCanvas& canvas, const PrincipalPlane& plane, double step, const Projection& project) {
  const double half = std::ceil(1.6 * plane.extent / step) * step;
  const auto at = [&](double a, double b) { return project(plane.center + plane.axes * Vector3d(a, b, plane.floor)); };
  for (double k = -half; k <= half + step / 2; k += step) {
    const double alpha = 1 - 0.75 * std::abs(k) / half;  // it fades outwards: it has no border of its own
    for (const double sign : {-1.0, 1.0}) {
      for (int piece = 0; piece < 6; ++piece) {
        const double from = sign * half * piece / 6, to = sign * half * (piece + 1) / 6;
        const Ink ink{kGridColor, alpha * (1 - piece / 6.0)};
        canvas.line(at(k, from), at(k, to), 1, ink);
        canvas.line(at(from, k), at(to, k), 1, ink);
      }
    }
  }
}

void draw_landmarks(PlotCanvas& canvas, const SubmapView& submap, const cv::Vec3b& color, const Projection& project,
                    size_t step, double radius) {
  cv::Vec3b tint;
  for (int c = 0; c < 3; ++c) tint[c] = cv::saturate_cast<uchar>(0.72 * color[c] + 0.28 * 120);
  for (size_t i = 0; i < submap.landmarks.size(); i += step)
    canvas.disc(project(submap.landmarks[i]), radius, {tint, 0.34});
}

// Calls line(a, b, after_loss) for the trajectory's pieces, those of less than a pixel or so joined.
template <class Line>
void each_piece(const SubmapView& submap, const std::function<cv::Point2d(const Vector3d&)>& project, Line line) {
  if (submap.trajectory.empty()) return;
  cv::Point2d last = project(submap.trajectory.front().position);
  for (size_t i = 1; i < submap.trajectory.size(); ++i) {
    const TrajectoryPoint& p = submap.trajectory[i];
    const cv::Point2d next = project(p.position);
    const bool end = i + 1 == submap.trajectory.size() || submap.trajectory[i + 1].after_loss;
    if (!p.after_loss && !end && std::hypot(next.x - last.x, next.y - last.y) < 1) continue;
    line(last, next, p.after_loss);
    last = next;
  }
}

void draw_lost(PlotCanvas& canvas, cv::Point2d a, cv::Point2d b) {
  canvas.dashed(a, b, 2, 5, {kLostColor});
  for (const cv::Point2d& at : {a, b}) {
    canvas.disc(at, 3.6, {kLostColor});
    canvas.disc(at, 2, {kPanel});
  }
}

void draw_trajectory(PlotCanvas& canvas, const SubmapView& submap, const cv::Vec3b& color, const Projection& project,
                     double width) {
  each_piece(submap, project, [&](cv::Point2d a, cv::Point2d b, bool after_loss) {
    if (after_loss) return;
    canvas.line(a, b, width, {color});
    canvas.disc(b, width / 2, {color});
  });
  each_piece(submap, project, [&](cv::Point2d a, cv::Point2d b, bool after_loss) {
    if (after_loss) draw_lost(canvas, a, b);
  });
}

// Between one placed submap and the next in time nothing is known: a dashed line.
void draw_links(PlotCanvas& canvas, const Views& placed, const Projection& project) {
  std::vector<std::pair<const TrajectoryPoint*, const TrajectoryPoint*>> ends;
  for (const SubmapView* s : placed)
    if (!s->trajectory.empty()) ends.emplace_back(&s->trajectory.front(), &s->trajectory.back());
  std::sort(ends.begin(), ends.end(),
            [](const auto& a, const auto& b) { return a.first->utime_us < b.first->utime_us; });
  for (size_t i = 1; i < ends.size(); ++i)
    if (ends[i].first->utime_us > ends[i - 1].second->utime_us)
      draw_lost(canvas, project(ends[i - 1].second->position), project(ends[i].first->position));
}

void draw_frustum(PlotCanvas& canvas, const Scene& scene, const SE3& map_from_cam, double size,
                  const Projection& project, double width, const Ink& ink, double fill) {
  const double w = scene.camera_half_width * size, h = w / scene.camera_aspect;
  const cv::Point2d apex = project(map_from_cam.translation);
  const cv::Point2d corner[] = {
      project(map_from_cam * Vector3d(-w, -h, size)), project(map_from_cam * Vector3d(w, -h, size)),
      project(map_from_cam * Vector3d(w, h, size)), project(map_from_cam * Vector3d(-w, h, size))};
  for (int i = 0; i < 4; ++i) {
    if (fill > 0) canvas.triangle(apex, corner[i], corner[(i + 1) % 4], {ink.rgb, fill});
    canvas.line(apex, corner[i], width, ink);
    canvas.line(corner[i], corner[(i + 1) % 4], width, ink);
  }
}

void draw_keyframes(PlotCanvas& canvas, const Scene& scene, const SubmapView& submap, const cv::Vec3b& color,
                    double size, const Projection& project) {
  const size_t step = submap.keyframe_poses.size() / kMaxKeyframeFrusta + 1;
  for (size_t i = 0; i < submap.keyframe_poses.size(); i += step)
    draw_frustum(canvas, scene, submap.keyframe_poses[i], size, project, 0.9, {color, 0.75}, 0.05);
}

struct PanelStyle {
  double azimuth_rad, elevation_rad;
  double line_px, landmark_px;
  bool frusta;
  int label_px;  // kept free at the top
};

// One view of some submaps that share a frame. Returns the length of the grid's cells.
double draw_view(PlotCanvas& canvas, const Scene& scene, const Views& shown, const cv::Rect& panel,
                 const PanelStyle& style) {
  panel_frame(canvas, panel);
  if (shown.empty()) return 0;
  canvas.clip({panel.x + 1, panel.y + 1, panel.width - 2, panel.height - 2});
  const PrincipalPlane plane = principal_plane(shown);
  const cv::Rect below_label(panel.x, panel.y + style.label_px, panel.width, panel.height - style.label_px);
  const Projection project(plane, style.azimuth_rad, style.elevation_rad, below_label, shown);
  const double step = round_length(plane.extent / 7);
  draw_grid(canvas, plane, step, project);

  size_t landmarks = 0;
  for (const SubmapView* s : shown) landmarks += s->landmarks.size();
  const auto color = [&](const SubmapView* s) { return submap_color(static_cast<size_t>(s - scene.submaps.data())); };
  for (const SubmapView* s : shown)
    draw_landmarks(canvas, *s, color(s), project, landmarks / kMaxLandmarks + 1, style.landmark_px);
  const bool whole_map = shown.front()->placed;
  if (whole_map && style.frusta) {
    const auto on_floor = [&](const Vector3d& p) {
      const Vector3d normal = plane.axes.col(2);
      return project(p + (plane.floor - (p - plane.center).dot(normal)) * normal);
    };
    for (const SubmapView* s : shown)
      each_piece(*s, on_floor, [&](cv::Point2d a, cv::Point2d b, bool after_loss) {
        if (!after_loss) canvas.line(a, b, style.line_px, {kShadow, 0.8});
      });
  }
  if (whole_map) {
    for (size_t i = 1; i < scene.truth.size(); ++i)
      canvas.line(project(scene.truth[i - 1]), project(scene.truth[i]), 1.2, {kTruthColor, 0.8});
    draw_links(canvas, shown, project);
  }
  if (style.frusta)
    for (const SubmapView* s : shown) draw_keyframes(canvas, scene, *s, color(s), 0.025 * plane.extent, project);
  for (const SubmapView* s : shown) draw_trajectory(canvas, *s, color(s), project, style.line_px);
  if (whole_map && scene.camera)
    draw_frustum(canvas, scene, *scene.camera, 0.07 * plane.extent, project, 1.6, {kCameraColor}, 0.12);
  canvas.clip({0, 0, kPictureWidth, kPictureHeight});
  return step;
}

cv::Rect apart_panel(size_t i) {
  return {kObliquePanel.x + 12 + static_cast<int>(i) * 158, kObliquePanel.y + kObliquePanel.height - 122, 150, 110};
}

}  // namespace

cv::Vec3b submap_color(size_t index) {
  static const cv::Vec3b kColors[] = {{0, 114, 178}, {230, 159, 0},   {0, 158, 115},
                                      {213, 94, 0},  {204, 121, 167}, {86, 180, 233}};
  return kColors[index % std::size(kColors)];
}

Renderer::Renderer() : canvas_(kPictureWidth, kPictureHeight) {}

cv::Mat Renderer::draw(const Scene& scene) {
  Views placed, apart;
  for (const SubmapView& s : scene.submaps) (s.placed ? placed : apart).push_back(&s);
  std::stable_sort(apart.begin(), apart.end(),
                   [](const SubmapView* a, const SubmapView* b) { return a->frames > b->frames; });
  if (apart.size() > kMaxApart) apart.resize(kMaxApart);

  canvas_.clear(kPaper);
  canvas_.clip({0, 0, kPictureWidth, kPictureHeight});
  const double step = draw_view(canvas_, scene, placed, kObliquePanel, {-0.55, 0.62, 2.6, 1.0, true, 0});
  draw_view(canvas_, scene, placed, kTopPanel, {0, M_PI / 2, 1.8, 0.7, false, 0});
  for (size_t i = 0; i < apart.size(); ++i)
    draw_view(canvas_, scene, {apart[i]}, apart_panel(i), {0, M_PI / 2, 1.6, 0.6, false, 20});
  const Legend legend(scene, kLegendPanel);
  legend.draw_samples(canvas_);

  cv::Mat large = canvas_.read();
  const TextStyle title{15, {20, 20, 24}, true}, note{8.5, {120, 120, 128}}, label{9, {90, 90, 98}};
  draw_text(large, {22, 40}, fit_text(scene.title, 640, title), title);
  const std::string unit = step > 0 ? fmt::format("grid: {:g} of the map's own arbitrary unit", step) : "no map yet";
  draw_text(large, {1258 - text_width(unit, note), 40}, unit, note);
  draw_text(large, {kObliquePanel.x + 12.0, kObliquePanel.y + 20.0}, "oblique view", label);
  draw_text(large, {kTopPanel.x + 10.0, kTopPanel.y + 18.0}, "from above", label);
  for (size_t i = 0; i < apart.size(); ++i)
    draw_text(large, {apart_panel(i).x + 7.0, apart_panel(i).y + 15.0},
              fmt::format("submap {}, own scale", apart[i]->id), note);
  legend.draw_words(large);
  cv::Mat picture;
  cv::resize(large, picture, {kPictureWidth, kPictureHeight}, 0, 0, cv::INTER_AREA);
  return picture;
}

}  // namespace rumi
