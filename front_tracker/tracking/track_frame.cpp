// SPDX-License-Identifier: BSD-3-Clause
// The part of Tracker that finds a frame's pose: short-term association with the last frame, then mid-term association
// with the landmarks nearby (equation 5 of the paper).
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "front_tracker/frame/certainty.h"
#include "front_tracker/matching/brute_force_matching.h"
#include "front_tracker/matching/epipolar_matches.h"
#include "front_tracker/matching/projection_search.h"
#include "front_tracker/patches/align_keypoints.h"
#include "front_tracker/patches/patch_search.h"
#include "front_tracker/tracking/tracker.h"
#include "slam/map/landmark_view.h"
#include "slam/optimization/resection.h"

namespace rumi::front_tracker {
namespace {

constexpr int kFewest = 10;     // landmarks that make a pose
constexpr double kAgree = 0.8;  // share of what is matched with earlier frames, that agrees with a believable pose

std::vector<const Landmark*> all_landmarks(const Submap& map) {
  std::vector<const Landmark*> landmarks;
  landmarks.reserve(map.landmarks.size());
  for (const auto& [id, lm] : map.landmarks) landmarks.push_back(&lm);
  return landmarks;
}

}  // namespace

// Also brings the last frame to where mapping has moved its keyframe since.
void Tracker::predict_pose(Frame* frame) {
  const Keyframe* reference = active().map.keyframe(last_.reference_keyframe);
  if (!reference) {
    // Culled since: its frames hang on another keyframe now.
    const FramePose* pose = active().map.frame(last_.utime_us);
    last_.reference_keyframe = pose->reference_keyframe;
    last_.cam_from_keyframe = pose->cam_from_keyframe;
    reference = active().map.keyframe(last_.reference_keyframe);
  }
  last_.cam_from_submap = last_.cam_from_keyframe * reference->cam_from_submap;
  const int64_t dt_us = frame->utime_us - last_.utime_us;
  SE3 motion = velocity_;
  if (velocity_dt_us_ > 0 && dt_us != velocity_dt_us_) {
    const double ratio = std::min(3.0, static_cast<double>(dt_us) / static_cast<double>(velocity_dt_us_));
    motion = SE3::exp(ratio * velocity_.log());
  }
  frame->cam_from_submap = motion * last_.cam_from_submap;
  frame->reference_keyframe = last_.reference_keyframe;
}

void Tracker::note_motion(const Frame& frame) {
  velocity_ = frame.cam_from_submap * last_.cam_from_submap.inverse();
  velocity_dt_us_ = frame.utime_us - last_.utime_us;
}

bool Tracker::track(Frame* frame) {
  predict_pose(frame);
  why_lost_ = "too few landmarks agree";
  if (!match_last_frame(frame) && !match_regardless_of_place(frame)) return false;
  if (!match_local_map(frame)) return false;
  note_motion(*frame);
  return true;
}

bool Tracker::match_last_frame(Frame* frame) {
  std::vector<const Landmark*> landmarks;
  for (int id : last_.landmark_ids)
    if (const Landmark* lm = id == kNone ? nullptr : active().map.landmark(id)) landmarks.push_back(lm);
  const double radius = options_.tracking.search_radius_px * camera_.width / 640.0;
  const SE3 predicted = frame->cam_from_submap;
  for (const double widen : {1.0, 2.5}) {
    frame->clear_matches();
    frame->cam_from_submap = predicted;
    ProjectionSearch search{.radius_px = widen * radius, .max_distance = options_.tracking.max_distance};
    search.max_ratio = options_.tracking.max_ratio;
    if (search_by_projection(camera_, landmarks, search, scales_, frame) < 20) continue;
    if (refine_pose(camera_, active().map, scales_, frame) >= options_.tracking.min_first_inliers) return true;
  }
  return false;
}

// The motion model failed (a fast turn, dropped frames): compare descriptors, wherever they are.
bool Tracker::match_regardless_of_place(Frame* frame) {
  frame->clear_matches();
  const LandmarkMatches matches = match_by_brute_force(active().map, scales_, *last_.features, last_.landmark_ids,
                                                       *frame, options_.tracking.max_distance);
  const auto pose = resect(camera_, matches.observations, {options_.tracking.min_first_inliers, 4.0, 300});
  if (!pose) return false;
  frame->cam_from_submap = pose->cam_from_submap;
  take_inliers(matches, pose->inlier, frame);
  return true;
}

// Landmarks of the keyframes that share most with the frame, and of their neighbours. Sets the reference keyframe.
std::vector<const Landmark*> Tracker::local_landmarks(Frame* frame) {
  const Submap& map = active().map;
  std::map<int, int> votes;
  std::set<int> matched;
  for (int id : frame->landmark_ids) {
    const Landmark* lm = id == kNone ? nullptr : map.landmark(id);
    if (!lm) continue;
    matched.insert(id);
    for (const Observation& o : lm->observations) ++votes[o.keyframe_id];
  }
  std::vector<std::pair<int, int>> ranked(votes.begin(), votes.end());
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  if (!ranked.empty()) frame->reference_keyframe = ranked.front().first;
  const size_t wanted = options_.tracking.local_keyframes;
  if (ranked.size() > wanted) ranked.resize(wanted);
  std::set<int> keyframes;
  for (const auto& [id, count] : ranked) keyframes.insert(id);
  if (keyframes.size() < wanted && !ranked.empty())
    for (const auto& [id, shared] : map.covisible_keyframes(ranked.front().first)) {
      if (keyframes.size() >= wanted) break;
      keyframes.insert(id);
    }
  // Neighbours share most of their landmarks: mark them, rather than sort them all.
  std::vector<bool> known(map.landmarks.empty() ? 0 : map.landmarks.rbegin()->first + 1, false);
  for (int id : matched) known[id] = true;
  std::vector<int> ids;
  for (int id : keyframes)
    for (int lm : map.keyframe(id)->landmark_ids) {
      if (lm == kNone || known[lm]) continue;
      known[lm] = true;
      ids.push_back(lm);
    }
  std::sort(ids.begin(), ids.end());
  std::vector<const Landmark*> landmarks;
  landmarks.reserve(ids.size());
  for (int id : ids) landmarks.push_back(map.landmark(id));
  return landmarks;
}

// In fast motion the detector finds other corners, in a blurred or dark image or of a blank wall it finds few: then
// less than what tracking takes tells where to look.
bool Tracker::patches_may_help(const Frame& frame, int inliers) const {
  const TrackingOptions& o = options_.tracking;
  if (frame.corners == Corners::kFew) return inliers >= o.min_first_inliers;
  return inliers >= kFewest && motion_since_last_frame(frame) > o.patch_motion;
}

bool Tracker::match_local_map(Frame* frame) {
  std::vector<int> visible;
  ProjectionSearch search{.radius_px = options_.tracking.local_radius_px * camera_.width / 640.0,
                          .max_distance = options_.tracking.max_distance,
                          .max_ratio = options_.tracking.max_ratio};
  for (int id : frame->landmark_ids)
    if (id != kNone) visible.push_back(id);
  search_by_projection(camera_, local_landmarks(frame), search, scales_, frame, &visible);
  int inliers = refine_pose(camera_, active().map, scales_, frame);
  if (inliers >= kFewest && align_keypoints(active(), frame, &templates_))
    inliers = refine_pose(camera_, active().map, scales_, frame);
  if (inliers < options_.tracking.patch_inliers && patches_may_help(*frame, inliers) &&
      search_by_patch(active(), visible, options_.tracking.patch_inliers, frame, &templates_) > 0)
    inliers = refine_pose(camera_, active().map, scales_, frame);
  const bool found = inliers >= kFewest && is_certain(frame, &inliers);
  for (int id : visible)
    if (Landmark* lm = active().map.landmark(id)) ++lm->visible;
  for (int id : frame->landmark_ids)
    if (Landmark* lm = id == kNone ? nullptr : active().map.landmark(id)) ++lm->found;
  if (!found) return false;
  if (!drifts(*frame)) return true;
  why_lost_ = "the scale is not known any more";
  return false;
}

// A few landmarks in a corner of the image leave the rotation uncertain by degrees. Returns the number of inliers.
int Tracker::support_by_epipolar_matches(Frame* frame) {
  const Submap& map = active().map;
  std::vector<EpipolarView> views = {
      match_epipolar(camera_, scales_, {last_.features, last_.landmark_ids, last_.cam_from_submap}, *frame)};
  const Keyframe& newest = map.keyframes.rbegin()->second;
  const auto nearby = map.covisible_keyframes(frame->reference_keyframe);
  const bool is_here = newest.id == frame->reference_keyframe ||  // else the camera was found again elsewhere
                       std::any_of(nearby.begin(), nearby.end(), [&](const auto& kf) { return kf.first == newest.id; });
  if (is_here && newest.utime_us != last_.utime_us)
    views.push_back(
        match_epipolar(camera_, scales_, {newest.features, newest.landmark_ids, newest.cam_from_submap}, *frame));
  Frame supported = *frame;
  const int inliers = refine_pose(camera_, map, scales_, &supported, views);
  size_t agree = 0, all = 0;
  for (const EpipolarView& view : views) {
    all += view.matches.size();
    agree += count_agreeing(camera_, supported.cam_from_submap, view);
  }
  // What contradicts itself, in blurred images, is no support.
  if (inliers < kFewest || static_cast<double>(agree) < kAgree * static_cast<double>(all)) return frame->matches();
  supported.certainty = certainty_of(map, scales_, supported, views);
  supported.is_believable = true;
  *frame = std::move(supported);
  return inliers;
}

// Is the pose known well enough to go on with, by the landmarks that agree or with support? `inliers` of them are left.
bool Tracker::is_certain(Frame* frame, int* inliers) {
  const TrackingOptions& o = options_.tracking;
  frame->certainty = certainty_of(active().map, scales_, *frame);
  frame->is_believable = frame->certainty.image_px <= o.uncertain_px;
  if (frame->is_believable) return true;
  *inliers = support_by_epipolar_matches(frame);
  if (*inliers >= kFewest && frame->certainty.image_px <= o.lost_px()) return true;
  why_lost_ = fmt::format("{} landmarks leave the pose uncertain by {:.1f} px of the image", *inliers,
                          frame->certainty.image_px);
  return false;
}

// Is the scale lost faster than that would be worth anything?
bool Tracker::drifts(const Frame& frame) const {
  constexpr int64_t kOver_us = 1'000'000;
  if (recent_.empty()) return false;
  const auto then = std::find_if(recent_.begin(), recent_.end(),
                                 [&](const Support& s) { return frame.utime_us - s.utime_us <= kOver_us; });
  const double before = then == recent_.end() ? recent_.back().log_scale_variance : then->log_scale_variance;
  return frame.certainty.log_scale_variance - before > std::pow(options_.tracking.max_scale_drift, 2);
}

// Of a frame of the past, from where its neighbour in time was.
bool Tracker::pose_from_neighbour(const Frame& neighbour, const std::vector<const Landmark*>& landmarks,
                                  double max_image_px, Frame* frame) {
  const ProjectionSearch search{.radius_px = options_.tracking.search_radius_px * camera_.width / 640.0,
                                .max_distance = options_.tracking.max_distance};
  frame->clear_matches();
  frame->cam_from_submap = neighbour.cam_from_submap;
  search_by_projection(camera_, landmarks, search, scales_, frame);
  const Submap& map = active().map;
  if (refine_pose(camera_, map, scales_, frame) < kFewest) return false;
  frame->certainty = certainty_of(map, scales_, *frame);
  if (frame->certainty.image_px > max_image_px) return false;
  frame->reference_keyframe = neighbour.reference_keyframe;
  frame->cam_from_keyframe =
      frame->cam_from_submap * map.keyframe(frame->reference_keyframe)->cam_from_submap.inverse();
  return true;
}

// Of a frame whose pose does not come from what it is matched to. Nothing is known where little is found.
PoseCertainty Tracker::certainty_where_it_is(const Frame& posed) {
  Frame matched = posed;
  if (!pose_from_neighbour(posed, all_landmarks(active().map), options_.tracking.lost_px(), &matched)) return {};
  return matched.certainty;
}

// Frames that were buffered before the submap stood: each is tracked from its nearest neighbour that has a pose.
void Tracker::give_poses_afterwards(std::vector<Frame>* frames, std::vector<bool>* posed) {
  const std::vector<const Landmark*> landmarks = all_landmarks(active().map);
  const auto try_frame = [&](size_t from, size_t to) {
    if (!pose_from_neighbour((*frames)[from], landmarks, options_.tracking.uncertain_px, &(*frames)[to])) return;
    (*posed)[to] = true;
    record_pose(&active(), (*frames)[to]);
  };
  for (size_t i = frames->size(); i-- > 1;)
    if ((*posed)[i] && !(*posed)[i - 1]) try_frame(i, i - 1);
  for (size_t i = 1; i < frames->size(); ++i)
    if ((*posed)[i - 1] && !(*posed)[i]) try_frame(i - 1, i);
}

// Frames before one that was found again, the latest first, as far back as each can be tracked from the one after it.
void Tracker::track_back(const Frame& found, std::deque<Frame> frames) {
  constexpr size_t kMost = 60;  // the camera does not wait
  Frame next = found;
  for (size_t i = 0; i < kMost && !frames.empty(); ++i) {
    std::vector<const Landmark*> landmarks = local_landmarks(&next);
    for (int id : next.landmark_ids)
      if (id != kNone) landmarks.push_back(active().map.landmark(id));
    Frame frame = std::move(frames.back());
    frames.pop_back();
    if (!pose_from_neighbour(next, landmarks, options_.tracking.lost_px(), &frame)) break;
    record_pose(&active(), frame);
    note_pose_afterwards(frame);
    next = std::move(frame);
  }
  std::reverse(posed_afterwards_.begin(), posed_afterwards_.end());
}

}  // namespace rumi::front_tracker
