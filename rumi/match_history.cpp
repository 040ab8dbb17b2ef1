// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/match_history.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>

#include "map_server/correspondences.h"
#include "rumi/plot_axes.h"
#include "slam/features/orb_extractor.h"

namespace rumi {
namespace {

bool agrees(const Submap& a, const Submap& b, const SharedKeyframe& shared, const LandmarkMatch& match,
            const Sim3& b_from_a, double max_reprojection_px) {
  const auto error_px = [](const Submap& submap, int keyframe_id, int keypoint, const Eigen::Vector3d& position) {
    const Keyframe& keyframe = *submap.keyframe(keyframe_id);
    const Eigen::Vector3d in_cam = keyframe.cam_from_submap * position;
    if (!(in_cam.z() > 1e-9)) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d pixel = keyframe.features->undistorted[keypoint].cast<double>();
    const double sigma_px = scale_of(keyframe.features->keypoints[keypoint].octave, octave_scales({}));
    return (submap.camera.project_undistorted(in_cam) - pixel).norm() / sigma_px;
  };
  const Eigen::Vector3d in_b = b_from_a * a.landmark(match.a)->position;
  const Eigen::Vector3d in_a = b_from_a.inverse() * b.landmark(match.b)->position;
  return error_px(b, shared.b, match.keypoint_b, in_b) <= max_reprojection_px &&
         error_px(a, shared.a, match.keypoint_a, in_a) <= max_reprojection_px;
}

const Link* link_of(const Atlas& atlas, SubmapKey a, SubmapKey b) {
  const auto& links = atlas.links();
  const auto found = std::find_if(links.begin(), links.end(), [&](const Link& link) {
    return link.kind == Link::Kind::kSameImages && link.a == a && link.b == b;
  });
  return found == links.end() ? nullptr : &*found;
}

std::vector<std::pair<int64_t, int64_t>> untracked_spans(const Atlas& atlas) {
  std::set<int64_t> tracked;
  for (const auto& [key, owner] : atlas.submaps())
    if (owner.submap.kind == SubmapKind::kFront)
      for (const auto& [utime_us, frame] : owner.submap.frames) tracked.insert(utime_us);
  std::vector<std::pair<int64_t, int64_t>> spans;
  bool inside = false;
  for (const auto& [utime_us, record] : atlas.frames()) {
    const bool untracked = !tracked.contains(utime_us);
    if (untracked && !inside) spans.emplace_back(utime_us, utime_us);
    if (untracked) spans.back().second = utime_us;
    inside = untracked;
  }
  return spans;
}

}  // namespace

MatchHistory match_history(const Atlas& atlas, double max_pixel_distance_px, double max_reprojection_px) {
  MatchHistory history;
  if (atlas.frames().empty()) return history;
  history.first_us = atlas.frames().begin()->first;
  history.last_us = atlas.frames().rbegin()->first;
  history.untracked = untracked_spans(atlas);
  const auto& submaps = atlas.submaps();
  for (auto one = submaps.begin(); one != submaps.end(); ++one)
    for (auto other = std::next(one); other != submaps.end(); ++other) {
      const Submap &a = one->second.submap, &b = other->second.submap;
      const Correspondences common = find_correspondences(a, b, max_pixel_distance_px);
      const Link* link = link_of(atlas, a.key, b.key);
      const bool both_front = a.kind == SubmapKind::kFront && b.kind == SubmapKind::kFront;
      auto& images = both_front ? history.front : history.back;
      for (const SharedKeyframe& shared : common.keyframes) images[shared.utime_us];
      for (const LandmarkMatch& match : common.landmarks) {
        const SharedKeyframe& shared = common.keyframes[match.shared];
        ++images[shared.utime_us].matched;
        images[shared.utime_us].verified += link && agrees(a, b, shared, match, link->b_from_a, max_reprojection_px);
      }
    }
  return history;
}

cv::Mat draw_matches(const MatchHistory& history) {
  constexpr int kWidth = 1000, kHeight = 360, kMargin = 60;
  cv::Mat image(kHeight, kWidth, CV_8UC3, kPlotWhite);
  const auto seconds = [&](int64_t utime_us) { return 1e-6 * static_cast<double>(utime_us - history.first_us); };
  const double end_s = std::max(1e-3, seconds(history.last_us));
  int most = 1;
  for (const auto* images : {&history.front, &history.back})
    for (const auto& [utime_us, matches] : *images) most = std::max(most, matches.matched);
  const cv::Rect area(kMargin, kMargin, kWidth - 2 * kMargin, kHeight - 2 * kMargin);
  const double top = 1.1 * most;
  for (const auto& [first_us, last_us] : history.untracked) {
    const double x = area.x + area.width * seconds(first_us) / end_s,
                 to = area.x + area.width * seconds(last_us) / end_s;
    cv::rectangle(image, cv::Rect(cvRound(x), area.y, std::max(1, cvRound(to - x)), area.height), {230, 215, 245},
                  cv::FILLED);
  }
  const PlotAxes axes(image, area, 0, end_s, 0, top, "");
  const auto mark = [&](const std::map<int64_t, ImageMatches>& images, int ImageMatches::*count,
                        const cv::Scalar& colour, int width) {
    for (const auto& [utime_us, matches] : images) {
      const cv::Point at = axes.at(seconds(utime_us), matches.*count);
      cv::line(image, axes.at(seconds(utime_us), 0), at, colour, width);
      cv::circle(image, at, 2 * width, colour, cv::FILLED, cv::LINE_AA);
    }
  };
  mark(history.back, &ImageMatches::matched, kPlotBlue, 3);
  mark(history.back, &ImageMatches::verified, kPlotRed, 1);
  mark(history.front, &ImageMatches::matched, kPlotBlack, 1);
  plot_text(image, "matched features of an image over time (s)", {kMargin, 24});
  plot_text(image, "with back submaps", {kMargin, 46}, kPlotBlue);
  plot_text(image, "of these, geometry agrees", {kMargin + 200, 46}, kPlotRed);
  plot_text(image, "between front submaps alone", {kMargin + 440, 46}, kPlotBlack);
  plot_text(image, "shaded: no front submap has the frame", {kWidth - 340, 24}, {190, 120, 200});
  return image;
}

}  // namespace rumi
