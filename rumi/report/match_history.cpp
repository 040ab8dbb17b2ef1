// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/match_history.h"

#include <algorithm>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <set>

#include "map_server/alignment/correspondences.h"
#include "map_server/places/place_consensus.h"
#include "rumi/report/plot_axes.h"

namespace rumi::tool {
namespace {

// Returns the equation for a landmark that both submaps have in the same keyframe; it scores the match.
map_server::PlaceEquation equation_of(const Submap& a, const Submap& b, const map_server::SharedKeyframe& shared,
                                      const map_server::LandmarkMatch& match) {
  const Keyframe &in_a = *a.keyframe(shared.a), &in_b = *b.keyframe(shared.b);
  return {.point_a = a.landmark(match.a)->position,
          .point_b = b.landmark(match.b)->position,
          .cam_from_a = in_a.cam_from_submap,
          .cam_from_b = in_b.cam_from_submap,
          .pixel_a = in_a.features->undistorted[match.keypoint_a].cast<double>(),
          .pixel_b = in_b.features->undistorted[match.keypoint_b].cast<double>(),
          .sigma_a_px = a.pyramid.scale(in_a.features->keypoints[match.keypoint_a].octave),
          .sigma_b_px = b.pyramid.scale(in_b.features->keypoints[match.keypoint_b].octave)};
}

const map_server::Link* link_of(const map_server::Atlas& atlas, SubmapKey a, SubmapKey b) {
  const auto& links = atlas.links();
  const auto found = std::find_if(links.begin(), links.end(), [&](const map_server::Link& link) {
    return link.kind == map_server::Link::Kind::kSameImages && link.a == a && link.b == b;
  });
  return found == links.end() ? nullptr : &*found;
}

std::vector<std::pair<int64_t, int64_t>> untracked_spans(const map_server::Atlas& atlas) {
  std::set<ImageId> tracked;
  for (const auto& [key, owner] : atlas.submaps())
    if (owner.submap.kind == SubmapKind::kFront)
      for (const auto& [utime_us, frame] : owner.submap.frames) tracked.insert({utime_us, owner.submap.stream});
  std::vector<std::pair<int64_t, int64_t>> spans;
  bool inside = false;
  for (const auto& [image, record] : atlas.frames()) {
    const bool untracked = !tracked.contains(image);
    if (untracked && !inside) spans.emplace_back(image.utime_us, image.utime_us);
    if (untracked) spans.back().second = image.utime_us;
    inside = untracked;
  }
  return spans;
}

}  // namespace

MatchHistory match_history(const map_server::Atlas& atlas, double max_reprojection_px) {
  MatchHistory history;
  if (atlas.frames().empty()) return history;
  history.first_us = atlas.frames().begin()->first.utime_us;
  history.last_us = atlas.frames().rbegin()->first.utime_us;
  history.untracked = untracked_spans(atlas);
  const auto& submaps = atlas.submaps();
  for (auto one = submaps.begin(); one != submaps.end(); ++one)
    for (auto other = std::next(one); other != submaps.end(); ++other) {
      const Submap &a = one->second.submap, &b = other->second.submap;
      const map_server::Correspondences common = map_server::find_correspondences(a, b);
      const map_server::Link* link = link_of(atlas, a.key, b.key);
      const Sim3 a_from_b = link ? link->b_from_a.inverse() : Sim3();
      const bool both_front = a.kind == SubmapKind::kFront && b.kind == SubmapKind::kFront;
      auto& images = both_front ? history.front : history.back;
      for (const map_server::SharedKeyframe& shared : common.keyframes) images[shared.utime_us];
      for (const map_server::LandmarkMatch& match : common.landmarks) {
        const map_server::SharedKeyframe& shared = common.keyframes[match.shared];
        ++images[shared.utime_us].matched;
        images[shared.utime_us].verified +=
            link && reprojection_error_px(equation_of(a, b, shared, match), a.camera, b.camera, link->b_from_a,
                                          a_from_b) <= max_reprojection_px;
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

}  // namespace rumi::tool
