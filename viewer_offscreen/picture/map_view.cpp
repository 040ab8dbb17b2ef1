// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/map_view.h"

#include <algorithm>
#include <cmath>

#include "viewer_offscreen/canvas/palette.h"
#include "viewer_offscreen/scene/projection.h"

namespace rumi::viewer_offscreen {
namespace {

using Eigen::Vector3d;
using Submaps = std::vector<const SubmapView*>;

constexpr double kLeastLoss_px = 12;  // length of a loss's line; a shorter one has no room for rings at its ends
// Elements are thinned evenly, so that no more than this are drawn.
constexpr size_t kMaxFrusta = 150;                         // frusta of keyframes
constexpr double kLandmarkRoom = 4, kCovisibleRoom = 150;  // pixels of the panel per element

cv::Vec3b color_of(const SubmapView& submap) { return submap_color(submap.kind, submap.color); }

// Draws lines in space, and cuts off what is behind the viewer.
class Pen {
 public:
  Pen(PlotCanvas& canvas, const Projection& project) : canvas_(canvas), project_(project) {}

  void line(Vector3d a, Vector3d b, double width, const Ink& ink) {
    if (project_.clip(&a, &b)) canvas_.line(project_(a), project_(b), width, ink);
  }
  template <class Draw>
  void segment(Vector3d a, Vector3d b, Draw draw) {
    if (project_.clip(&a, &b)) draw(project_(a), project_(b));
  }
  void frustum(const Scene& scene, const SE3& map_from_cam, double size, double width, const Ink& ink, double fill) {
    const double w = scene.camera_half_width * size, h = w / scene.camera_aspect;
    const Vector3d apex = map_from_cam.translation;
    const Vector3d corner[] = {map_from_cam * Vector3d(-w, -h, size), map_from_cam * Vector3d(w, -h, size),
                               map_from_cam * Vector3d(w, h, size), map_from_cam * Vector3d(-w, h, size)};
    for (int i = 0; i < 4; ++i) {
      Vector3d a = apex, b = corner[i];
      const bool whole = project_.clip(&a, &b) && a == apex && b == corner[i];
      if (fill > 0 && whole)
        canvas_.triangle(project_(apex), project_(b), project_(corner[(i + 1) % 4]), {ink.rgb, fill});
      line(apex, corner[i], width, ink);
      line(corner[i], corner[(i + 1) % 4], width, ink);
    }
  }

 private:
  PlotCanvas& canvas_;
  const Projection& project_;
};

void draw_grid(Pen& pen, const PrincipalPlane& plane, double step) {
  const double half = std::ceil(1.6 * plane.extent / step) * step;
  const auto at = [&](double a, double b) -> Vector3d {
    return plane.center + plane.axes * Vector3d(a, b, plane.floor);
  };
  for (double k = -half; k <= half + step / 2; k += step) {
    const double alpha = 1 - 0.75 * std::abs(k) / half;  // the grid has no border, so it fades outwards
    for (const double sign : {-1.0, 1.0}) {
      for (int piece = 0; piece < 6; ++piece) {
        const double from = sign * half * piece / 6, to = sign * half * (piece + 1) / 6;
        const Ink ink{kGridColor, alpha * (1 - piece / 6.0)};
        pen.line(at(k, from), at(k, to), 1, ink);
        pen.line(at(from, k), at(to, k), 1, ink);
      }
    }
  }
}

// Calls piece(a, b, after_loss) for the parts of a path. Parts shorter than `least` are joined to the next ones.
template <class Piece>
void each_piece(const SubmapView& submap, double least, Piece piece) {
  if (submap.trajectory.empty()) return;
  Vector3d last = submap.trajectory.front().position;
  for (size_t i = 1; i < submap.trajectory.size(); ++i) {
    const TrajectoryPoint& p = submap.trajectory[i];
    const bool end = i + 1 == submap.trajectory.size() || submap.trajectory[i + 1].after_loss;
    if (!p.after_loss && !end && (p.position - last).squaredNorm() < least * least) continue;
    piece(last, p.position, p.after_loss);
    last = p.position;
  }
}

void draw_shadow(Pen& pen, const PrincipalPlane& plane, const SubmapView& submap, double least, double width) {
  const Vector3d normal = plane.axes.col(2);
  const auto on_floor = [&](const Vector3d& p) -> Vector3d {
    return p + (plane.floor - (p - plane.center).dot(normal)) * normal;
  };
  each_piece(submap, least, [&](const Vector3d& a, const Vector3d& b, bool after_loss) {
    if (!after_loss) pen.line(on_floor(a), on_floor(b), width, {kShadowColor, 0.8});
  });
}

void draw_covisible(Pen& pen, const SubmapView& submap, size_t step) {
  for (size_t i = 0; i < submap.covisible.size(); i += step) {
    const auto [a, b] = submap.covisible[i];
    pen.line(submap.keyframe_poses[a].map_from_cam.translation, submap.keyframe_poses[b].map_from_cam.translation, 0.7,
             {color_of(submap), 0.13});
  }
}

void draw_path(PlotCanvas& canvas, Pen& pen, const SubmapView& submap, double least, double width) {
  const Ink ink{color_of(submap)}, core{kPanelColor};
  const auto lines = [&](double line_width, const Ink& line_ink) {
    each_piece(submap, least, [&](const Vector3d& a, const Vector3d& b, bool after_loss) {
      if (after_loss) return;
      pen.segment(a, b, [&](cv::Point2d from, cv::Point2d to) {
        canvas.line(from, to, line_width, line_ink);
        if (line_width > 2) canvas.disc(to, line_width / 2, line_ink);  // rounds the joint
      });
    });
  };
  const bool is_back = submap.kind == SubmapKind::kBack;
  lines(is_back ? 1.5 * width : width, ink);
  if (is_back) lines(0.5 * width, core);
  each_piece(submap, least, [&](const Vector3d& a, const Vector3d& b, bool after_loss) {
    if (after_loss) pen.segment(a, b, [&](cv::Point2d from, cv::Point2d to) { draw_lost_line(canvas, from, to); });
  });
}

// Draws a dashed line from each placed submap to the next in time, because the path between them is not known.
void draw_gaps(PlotCanvas& canvas, Pen& pen, const Submaps& placed) {
  std::vector<const SubmapView*> by_time;
  for (const SubmapView* s : placed)
    if (!s->trajectory.empty()) by_time.push_back(s);
  std::sort(by_time.begin(), by_time.end(), [](const SubmapView* a, const SubmapView* b) {
    return a->trajectory.front().utime_us < b->trajectory.front().utime_us;
  });
  const TrajectoryPoint* latest = nullptr;
  for (const SubmapView* s : by_time) {
    const TrajectoryPoint& first = s->trajectory.front();
    if (latest && first.utime_us > latest->utime_us)
      pen.segment(latest->position, first.position,
                  [&](cv::Point2d a, cv::Point2d b) { draw_lost_line(canvas, a, b); });
    if (!latest || s->trajectory.back().utime_us > latest->utime_us) latest = &s->trajectory.back();
  }
}

// Returns n such that every n-th of `all` elements makes about `most` elements, or fewer.
size_t thinned(size_t all, double most) { return static_cast<size_t>(static_cast<double>(all) / (most + 1)) + 1; }

Projection project_for(ViewKind kind, const PrincipalPlane& plane, const SE3& camera, const cv::Rect& area,
                       const Submaps& shown) {
  if (kind == ViewKind::kFollow) return Projection::follow(plane, camera, area);
  if (kind == ViewKind::kTop) return Projection::parallel(plane, 0, M_PI / 2, area, shown);
  if (kind == ViewKind::kSide) return Projection::parallel(plane, 0, 0, area, shown);
  return Projection::parallel(plane, -0.55, 0.62, area, shown);
}

struct Totals {
  size_t landmarks = 0, pairs = 0, keyframes = 0;
};

Totals count(const Submaps& shown) {
  Totals totals;
  for (const SubmapView* s : shown) {
    totals.landmarks += s->landmarks.size();
    totals.pairs += s->covisible.size();
    totals.keyframes += s->keyframe_poses.size();
  }
  return totals;
}

void draw_truth(Pen& pen, const Scene& scene) {
  for (size_t i = 1; i < scene.truth.size(); ++i) pen.line(scene.truth[i - 1], scene.truth[i], 1.2, {kTruthColor, 0.8});
}

void draw_frusta(Pen& pen, const Scene& scene, const Submaps& shown, size_t step, double length) {
  for (const SubmapView* s : shown)
    for (size_t i = 0; i < s->keyframe_poses.size(); i += step)
      pen.frustum(scene, s->keyframe_poses[i].map_from_cam, length, 0.8, {color_of(*s), 0.6}, 0.04);
}

void draw_merges(PlotCanvas& canvas, Pen& pen, const Scene& scene) {
  for (const MergeView& merge : scene.merges)
    pen.segment(merge.at_a, merge.at_b,
                [&](cv::Point2d a, cv::Point2d b) { draw_merge(canvas, a, b, merge.same_images); });
}

}  // namespace

void draw_panel(PlotCanvas& canvas, const cv::Rect& r) {
  const cv::Point2d a(r.x, r.y), b(r.x + r.width, r.y), c(r.x + r.width, r.y + r.height), d(r.x, r.y + r.height);
  canvas.rectangle(r, {kPanelColor});
  for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, d}, {d, a}}) canvas.line(from, to, 1, {kFrameColor});
}

void draw_path_line(PlotCanvas& canvas, cv::Point2d a, cv::Point2d b, double width, const SubmapView& submap) {
  const bool is_back = submap.kind == SubmapKind::kBack;
  canvas.line(a, b, is_back ? 1.5 * width : width, {color_of(submap)});
  if (is_back) canvas.line(a, b, 0.5 * width, {kPanelColor});
}

void draw_lost_line(PlotCanvas& canvas, cv::Point2d a, cv::Point2d b) {
  canvas.dashed(a, b, 2, 5, {kLostColor});
  if (std::hypot(b.x - a.x, b.y - a.y) < kLeastLoss_px) return;
  for (const cv::Point2d& at : {a, b}) {
    canvas.disc(at, 3.6, {kLostColor});
    canvas.disc(at, 2, {kPanelColor});
  }
}

void draw_merge(PlotCanvas& canvas, cv::Point2d a, cv::Point2d b, bool same_images) {
  canvas.line(a, b, 1.2, {kMergeColor, 0.9});
  for (const cv::Point2d& at : {a, b}) {
    if (same_images) {
      canvas.disc(at, 3.2, {kMergeColor});
      canvas.disc(at, 1.8, {kPanelColor});
      continue;
    }
    const double r = 3.8;
    canvas.triangle(at + cv::Point2d(0, -r), at + cv::Point2d(r, 0), at + cv::Point2d(-r, 0), {kMergeColor});
    canvas.triangle(at + cv::Point2d(0, r), at + cv::Point2d(r, 0), at + cv::Point2d(-r, 0), {kMergeColor});
  }
}

MapViews::MapViews(PlotCanvas& canvas, const Scene& scene) : canvas_(canvas), scene_(scene) {
  std::vector<Eigen::Vector3f> landmarks;
  for (const SubmapView& submap : scene.submaps) {
    first_landmark_.push_back(landmarks.size());
    landmarks.insert(landmarks.end(), submap.landmarks.begin(), submap.landmarks.end());
  }
  first_landmark_.push_back(landmarks.size());
  canvas.set_points(landmarks);
}

void MapViews::draw_landmarks(const Submaps& shown, const Projection& project, size_t step, double size_px) {
  for (const SubmapView* s : shown) {
    const cv::Vec3b color = color_of(*s);
    cv::Vec3b tint;
    for (int c = 0; c < 3; ++c) tint[c] = cv::saturate_cast<uchar>(0.85 * color[c] + 0.15 * 120);
    const size_t index = static_cast<size_t>(s - scene_.submaps.data());
    canvas_.points(first_landmark_[index], s->landmarks.size(), step, project, size_px, {tint, 0.45});
  }
}

MapViews::Drawn MapViews::draw(const Submaps& shown, const cv::Rect& panel, const MapViewStyle& style) {
  draw_panel(canvas_, panel);
  const bool whole_map = !shown.empty() && shown.front()->placed;
  if (shown.empty() || (style.kind == ViewKind::kFollow && !scene_.camera)) return {};
  canvas_.clip({panel.x + 1, panel.y + 1, panel.width - 2, panel.height - 2});
  const PrincipalPlane plane = principal_plane(shown);
  const cv::Rect area(panel.x, panel.y + style.label_px, panel.width, panel.height - style.label_px);
  const Projection project = project_for(style.kind, plane, scene_.camera.value_or(SE3()), area, shown);
  Pen pen(canvas_, project);
  const double step = round_length(plane.extent / 7);
  const double least = project.scale() ? 1.5 / *project.scale() : 0.002 * plane.extent;
  draw_grid(pen, plane, step);

  const Totals totals = count(shown);
  draw_landmarks(shown, project, thinned(totals.landmarks, panel.area() / kLandmarkRoom), style.landmark_px);
  if (whole_map && style.keyframes)
    for (const SubmapView* s : shown) draw_shadow(pen, plane, *s, least, style.line_px);
  for (const SubmapView* s : shown) draw_covisible(pen, *s, thinned(totals.pairs, panel.area() / kCovisibleRoom));
  if (whole_map) {
    draw_truth(pen, scene_);
    draw_gaps(canvas_, pen, shown);
  }
  if (style.keyframes) draw_frusta(pen, scene_, shown, thinned(totals.keyframes, kMaxFrusta), 0.022 * plane.extent);
  for (const SubmapKind kind : {SubmapKind::kBack, SubmapKind::kFront})  // front submaps lie over back submaps
    for (const SubmapView* s : shown)
      if (s->kind == kind) draw_path(canvas_, pen, *s, least, style.line_px);
  if (whole_map) {
    draw_merges(canvas_, pen, scene_);
    if (scene_.camera) pen.frustum(scene_, *scene_.camera, 0.06 * plane.extent, 1.6, {kCameraColor}, 0.12);
  }
  canvas_.unclip();
  return {step, project.scale()};
}

}  // namespace rumi::viewer_offscreen
