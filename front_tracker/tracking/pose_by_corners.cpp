// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/pose_by_corners.h"

#include <fmt/format.h>

#include <algorithm>

#include "front_tracker/frame/certainty.h"
#include "front_tracker/matching/brute_force_matching.h"
#include "front_tracker/matching/epipolar_matches.h"
#include "front_tracker/matching/projection_search.h"
#include "front_tracker/patches/align_keypoints.h"
#include "front_tracker/patches/patch_search.h"
#include "front_tracker/tracking/local_map.h"
#include "slam/optimization/resection.h"

namespace rumi::front_tracker {
namespace {

constexpr double kWidth_px = 640;  // width of the images for which radii are given

int refine(const FrontSubmap& submap, Frame* frame, Weights weights = Weights::kEqual,
           const std::vector<EpipolarView>& views = {}) {
  return refine_pose(submap.map.camera, submap.map, submap.octave_scales, frame, weights, views);
}

// If more than a few matches contradict the pose of the majority, something moves by itself, and the majority may be
// wrong. Then each part of the image gets the same weight.
int refine_by_most_or_by_area(const FrontSubmap& submap, Frame* frame) {
  constexpr double kUncontested = 0.9;  // share of the matches that agree with the pose
  const SE3 initial = frame->cam_from_submap;
  const std::vector<int> matched = frame->landmark_ids;
  const int all = frame->matches();
  const int agreeing = refine(submap, frame);
  if (agreeing >= kUncontested * all) return agreeing;
  frame->cam_from_submap = initial;
  frame->landmark_ids = matched;
  return refine(submap, frame, Weights::kByArea);
}

// Returns the epipolar matches of the frame with the last one, and with the newest keyframe if that is nearby.
std::vector<EpipolarView> views_of(const FrontSubmap& submap, const Frame& last, const Frame& frame) {
  const Submap& map = submap.map;
  std::vector<EpipolarView> views = {match_epipolar(map.camera, submap.octave_scales,
                                                    {last.features, last.landmark_ids, last.cam_from_submap}, frame)};
  const Keyframe& newest = map.keyframes.rbegin()->second;
  const auto nearby = map.covisible_keyframes(frame.reference_keyframe);
  const bool is_here = newest.id == frame.reference_keyframe ||  // otherwise the camera was found again elsewhere
                       std::any_of(nearby.begin(), nearby.end(), [&](const auto& kf) { return kf.first == newest.id; });
  if (is_here && newest.utime_us != last.utime_us)
    views.push_back(match_epipolar(map.camera, submap.octave_scales,
                                   {newest.features, newest.landmark_ids, newest.cam_from_submap}, frame));
  return views;
}

// True if most epipolar matches agree with the pose. In blurred images they contradict each other and are no support.
bool agree(const Submap& map, const SE3& cam_from_submap, const std::vector<EpipolarView>& views) {
  constexpr double kAgree = 0.8;  // share of the matches that must agree
  size_t agree = 0, all = 0;
  for (const EpipolarView& view : views) {
    all += view.matches.size();
    agree += count_agreeing(map.camera, cam_from_submap, view);
  }
  return static_cast<double>(agree) >= kAgree * static_cast<double>(all);
}

}  // namespace

FoundPose PoseByCorners::find(const FrontSubmap& submap, const MotionModel& motion, Frame frame,
                              PatchTemplates* templates) const {
  const Place place{submap, motion, templates};
  FoundPose pose{.frame = std::move(frame), .why_not = "too few landmarks agree"};
  pose.frame.cam_from_submap = motion.predict(pose.frame.utime_us);
  pose.frame.reference_keyframe = motion.last().reference_keyframe;
  if (!match_last_frame(place, &pose.frame) && !match_regardless_of_place(place, &pose.frame)) return pose;
  if (match_local_map(place, &pose) < kFewestLandmarks) return pose;
  pose.why_not = doubt(place, &pose.frame);
  if (pose.found()) pose.motion = motion.image_motion(submap.map, pose.frame);
  return pose;
}

bool PoseByCorners::match_last_frame(const Place& place, Frame* frame) const {
  const Submap& map = place.submap.map;
  std::vector<const Landmark*> landmarks;
  for (int id : place.motion.last().landmark_ids)
    if (const Landmark* lm = id == kNone ? nullptr : map.landmark(id)) landmarks.push_back(lm);
  const double radius_px = options_.search_radius_px * map.camera.width / kWidth_px;
  const SE3 predicted = frame->cam_from_submap;
  for (const double widen : {1.0, 2.5}) {
    constexpr int kWorthwhile = 20;  // number of matches
    frame->clear_matches();
    frame->cam_from_submap = predicted;
    const ProjectionSearch search{
        .radius_px = widen * radius_px, .max_distance = options_.max_distance, .max_ratio = options_.max_ratio};
    if (search_by_projection(map.camera, landmarks, search, place.submap.octave_scales, frame) < kWorthwhile) continue;
    if (refine(place.submap, frame) >= options_.min_first_inliers) return true;
  }
  return false;
}

// Compares descriptors without regard to place, for when the motion model fails (a fast turn, dropped frames). Returns
// false if no pose is found.
bool PoseByCorners::match_regardless_of_place(const Place& place, Frame* frame) const {
  frame->clear_matches();
  const Submap& map = place.submap.map;
  const Frame& last = place.motion.last();
  const LandmarkMatches matches = match_by_brute_force(map, place.submap.octave_scales, *last.features,
                                                       last.landmark_ids, *frame, options_.max_distance);
  const auto pose = resect(map.camera, matches.observations,
                           {.min_inliers = options_.min_first_inliers, .max_error_px = 4.0, .iterations = 300});
  if (!pose) return false;
  frame->cam_from_submap = pose->cam_from_submap;
  take_inliers(matches, pose->inlier, frame);
  return true;
}

// Matches the landmarks nearby and refines the pose with them. Returns the number of inliers.
int PoseByCorners::match_local_map(const Place& place, FoundPose* pose) const {
  const FrontSubmap& submap = place.submap;
  Frame* frame = &pose->frame;
  for (int id : frame->landmark_ids)
    if (id != kNone) pose->visible.push_back(id);
  const LocalMap local = local_map(submap.map, *frame, options_.local_keyframes);
  frame->reference_keyframe = local.reference_keyframe;
  const ProjectionSearch search{.radius_px = options_.local_radius_px * submap.map.camera.width / kWidth_px,
                                .max_distance = options_.max_distance,
                                .max_ratio = options_.max_ratio};
  search_by_projection(submap.map.camera, local.landmarks, search, submap.octave_scales, frame, &pose->visible);
  int inliers = refine_by_most_or_by_area(submap, frame);
  if (inliers >= kFewestLandmarks && align_keypoints(submap, frame, place.templates))
    inliers = refine_by_most_or_by_area(submap, frame);
  if (inliers < options_.patch_inliers && patches_may_help(place, *frame, inliers) &&
      search_by_patch(submap, pose->visible, options_.patch_inliers, frame, place.templates) > 0)
    inliers = refine_by_most_or_by_area(submap, frame);
  return inliers;
}

// True if landmarks should be looked for by patches. In fast motion the detector finds other corners; in a blurred or
// dark image, or on a blank wall, it finds few. Even a pose from few inliers then tells where to look.
bool PoseByCorners::patches_may_help(const Place& place, const Frame& frame, int inliers) const {
  if (frame.corners == Corners::kFew) return inliers >= options_.min_first_inliers;
  return inliers >= kFewestLandmarks && place.motion.is_known() &&
         place.motion.image_motion(place.submap.map, frame) > options_.patch_motion;
}

// Returns why the pose is not certain enough, even with support by epipolar matches; empty if it is certain enough.
std::string PoseByCorners::doubt(const Place& place, Frame* frame) const {
  frame->certainty = certainty_of(place.submap.map, place.submap.octave_scales, *frame);
  frame->is_believable = frame->certainty.image_px <= options_.uncertain_px;
  if (frame->is_believable) return {};
  const int inliers = support_by_epipolar_matches(place, frame);
  if (inliers >= kFewestLandmarks && frame->certainty.image_px <= options_.lost_px()) return {};
  return fmt::format("{} landmarks leave the pose uncertain by {:.1f} px of the image", inliers,
                     frame->certainty.image_px);
}

// Refines the pose with epipolar matches, because a few landmarks in a corner of the image leave the rotation uncertain
// by degrees. Returns the number of inliers.
int PoseByCorners::support_by_epipolar_matches(const Place& place, Frame* frame) const {
  const FrontSubmap& submap = place.submap;
  const std::vector<EpipolarView> views = views_of(submap, place.motion.last(), *frame);
  Frame supported = *frame;
  const int inliers = refine(submap, &supported, Weights::kEqual, views);
  if (inliers < kFewestLandmarks || !agree(submap.map, supported.cam_from_submap, views)) return frame->matches();
  supported.certainty = certainty_of(submap.map, submap.octave_scales, supported, views);
  supported.is_believable = true;
  *frame = std::move(supported);
  return inliers;
}

}  // namespace rumi::front_tracker
