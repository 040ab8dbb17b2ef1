// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "front_tracker/frame/certainty.h"
#include "front_tracker/mapping/submap_part.h"
#include "front_tracker/tracking/first_map.h"
#include "front_tracker/tracking/slip.h"

namespace rumi::front_tracker {
namespace {

// Counts how often each landmark should have been in view, and how often it was found. Landmarks that are hardly ever
// found are culled.
void count_sights(const FoundPose& pose, Submap* map) {
  for (int id : pose.visible)
    if (Landmark* lm = map->landmark(id)) ++lm->visible;
  for (int id : pose.frame.landmark_ids)
    if (Landmark* lm = id == kNone ? nullptr : map->landmark(id)) ++lm->found;
}

}  // namespace

Tracker::Tracker(const Camera& camera, const TrackerOptions& options, int64_t session, int64_t stream)
    : camera_(camera),
      options_(options),
      session_(session),
      stream_(stream),
      extractor_(options.orb),
      by_patches_(options.tracking, options.keyframes.max_motion),
      by_corners_(options.tracking),
      past_poses_(options.tracking),
      initializer_(camera, options.initializer, options.orb.pyramid.scales()),
      relocalizer_(camera, options.tracking, options.orb.pyramid.scales()),
      back_submaps_(camera, options.tracking, options.orb.pyramid),
      keyframe_policy_(options.keyframes, options.orb.keypoints),
      mapper_(camera, options.mapping),
      mapping_(options.mapping_thread) {}

std::optional<TrackResult> Tracker::process(int64_t utime_us, const cv::Mat& grey, const ImageMask& mask) {
  if (utime_us <= last_utime_us_) return std::nullopt;
  const StageClock clock("front_tracker.track");
  if (last_utime_us_ == INT64_MIN) first_utime_us_ = utime_us;
  last_utime_us_ = utime_us;
  posed_afterwards_.clear();
  withdrawn_.clear();
  leave_full_submap();
  const Images images = prepare(utime_us, grey, mask);
  TrackResult result = track_image(utime_us, images);
  result.state = state_;
  for (int keyframe : to_map_)
    mapping_.post([this, &submap = active(), keyframe] { mapper_.process(submap, keyframe, map_mutex_); });
  to_map_.clear();
  return result;
}

TrackResult Tracker::track_image(int64_t utime_us, const Images& images) {
  if (state_ == TrackingState::kTracking && by_patches_.may_do(motion_, utime_us)) {
    const std::scoped_lock lock(map_mutex_);
    if (std::optional<FoundPose> pose = pose_without_corners(utime_us, images)) return accept(std::move(*pose));
  }
  Frame frame = find_corners(utime_us, images);
  TrackResult result;
  result.utime_us = utime_us;
  const int keypoints = static_cast<int>(frame.features->size());
  const std::scoped_lock lock(map_mutex_);
  if (std::optional<FoundPose> pose = pose_with_corners(std::move(frame))) result = accept(std::move(*pose));
  result.keypoints = keypoints;
  loss_.image(utime_us, result.submap_id != kNoSubmap, posed_afterwards_.size(), withdrawn_.size());
  return result;
}

std::optional<TrackResult> Tracker::predict(int64_t utime_us) {
  constexpr double kUnsure = 0.3;  // standard deviation of the prediction, as a share of the motion since the last
                                   // frame
  if (utime_us <= last_utime_us_ || state_ != TrackingState::kTracking || !motion_.is_known()) return std::nullopt;
  last_utime_us_ = utime_us;
  posed_afterwards_.clear();
  withdrawn_.clear();
  const std::scoped_lock lock(map_mutex_);
  motion_.follow_mapping(active().map);
  Frame frame = motion_.last();
  frame.utime_us = utime_us;
  frame.cam_from_submap = motion_.predict(utime_us);
  const SE3 moved = frame.cam_from_submap * motion_.last().cam_from_submap.inverse();
  Matrix6d& covariance = frame.certainty.twist_covariance;
  covariance.topLeftCorner<3, 3>().diagonal().array() += std::pow(kUnsure * moved.translation.norm(), 2);
  covariance.bottomRightCorner<3, 3>().diagonal().array() += std::pow(kUnsure * moved.angle_rad(), 2);
  const Keyframe* reference = active().map.keyframe(frame.reference_keyframe);
  frame.cam_from_keyframe = frame.cam_from_submap * reference->cam_from_submap.inverse();
  active().add_frame(frame);
  TrackResult result;
  result.utime_us = utime_us;
  result.state = state_;
  note_pose(active(), frame, &result);
  return result;
}

Tracker::Images Tracker::prepare(int64_t utime_us, const cv::Mat& grey, const ImageMask& mask) {
  if (still_parts_.add(utime_us, grey, mask)) forget_still_landmarks();
  const bool keep = options_.mapping.keyframe_images > 0;
  return std::make_shared<const ImagePyramid>(
      extractor_.pyramid(keep ? grey.clone() : grey, mask_.join(mask, still_parts_.mask())));
}

void Tracker::forget_still_landmarks() {
  const std::scoped_lock lock(map_mutex_);
  size_t forgotten = 0;
  for (const auto& submap : submaps_) forgotten += submap->forget_left_out(still_parts_.mask());
  log_debug("{:.1f} % of the image never moves: {} landmarks in it are forgotten", 100 * still_parts_.mask().left_out(),
            forgotten);
}

std::optional<FoundPose> Tracker::pose_without_corners(int64_t utime_us, const Images& images) {
  motion_.follow_mapping(active().map);
  FoundPose pose = by_patches_.find(active(), motion_, utime_us, images, &templates_);
  if (!pose.found() || support_.scale_drifts(pose.frame, options_.tracking.max_scale_drift)) return std::nullopt;
  return pose;
}

Frame Tracker::find_corners(int64_t utime_us, const Images& images) {
  const StageClock clock("front_tracker.corners");
  const bool tracking = state_ == TrackingState::kTracking;
  const int keypoints = tracking ? options_.orb.keypoints : options_.initializer.keypoints;
  Frame frame = make_frame(utime_us, extractor_.extract(*images, keypoints), camera_);
  if (static_cast<int>(frame.features->size()) < options_.orb.keypoints / 2) frame.corners = Corners::kFew;
  if (options_.mapping.keyframe_images > 0) frame.images = images;
  return frame;
}

std::optional<FoundPose> Tracker::pose_with_corners(Frame frame) {
  switch (state_) {
    case TrackingState::kTracking:
      return track_or_relocalize(std::move(frame));
    case TrackingState::kRecentlyLost: {
      if (std::optional<FoundPose> found = relocalize_where_it_was(frame)) return found;
      if (loss_.seconds_until(frame.utime_us) <= options_.tracking.recently_lost_s) {
        std::optional<FoundPose> found = relocalize_anywhere(frame);
        if (!found) wait_to_begin(frame);
        return found;
      }
      state_ = TrackingState::kLost;
    }
      [[fallthrough]];
    case TrackingState::kLost: {
      std::optional<FoundPose> found = relocalize_anywhere(frame);
      return found ? found : begin_submap(frame);
    }
    default:  // NOT_INITIALIZED
      return begin_submap(frame);
  }
}

// If relocalization finds the camera in the image, it is not lost. Relocalization searches farther than tracking. It
// also accepts a pose that does not carry the scale on, if enough of the landmarks that should be in view are found.
// The motion to such a pose is unknown, so tracking by patches and keyframes for fast motion have to wait.
std::optional<FoundPose> Tracker::track_or_relocalize(Frame frame) {
  FoundPose tracked = track(std::move(frame));
  if (tracked.found()) return tracked;
  std::optional<FoundPose> found = relocalize_where_it_was(tracked.frame);
  if (!found) found = relocalize_anywhere(tracked.frame);
  if (found) return found;
  lose(tracked);
  wait_to_begin(tracked.frame);
  return std::nullopt;
}

FoundPose Tracker::track(Frame frame) {
  motion_.follow_mapping(active().map);
  FoundPose pose = by_corners_.find(active(), motion_, std::move(frame), &templates_);
  count_sights(pose, &active().map);
  if (pose.found() && support_.scale_drifts(pose.frame, options_.tracking.max_scale_drift))
    pose.why_not = "the scale is not known any more";
  return pose;
}

void Tracker::lose(const FoundPose& pose) {
  state_ = TrackingState::kRecentlyLost;
  const Submap& map = active().map;
  loss_.begin({.first_utime_us = first_utime_us_,
               .utime_us = pose.frame.utime_us,
               .submap_id = map.key.id,
               .frames_before = map.frames.size(),
               .why = pose.why_not});
}

TrackResult Tracker::accept(FoundPose pose) {
  state_ = TrackingState::kTracking;
  initializer_.clear();
  const bool began_submap = active().map.frame(pose.frame.utime_us) != nullptr;
  const bool is_keyframe = began_submap || is_keyframe_due(pose);
  if (!began_submap) pose.frame = add_to_submap(std::move(pose.frame), is_keyframe);
  TrackResult result;
  result.utime_us = pose.frame.utime_us;
  result.is_keyframe = is_keyframe;
  result.keypoints = static_cast<int>(pose.frame.features->size());
  note_pose(active(), pose.frame, &result);
  by_patches_.note(pose);
  support_.add(pose.frame);
  if (pose.motion)
    motion_.go_on(std::move(pose.frame));
  else
    motion_.begin_at(std::move(pose.frame));
  return result;
}

bool Tracker::is_keyframe_due(const FoundPose& pose) const {
  constexpr int kMostWaiting = 2;  // keyframes that wait for the mapper
  return mapping_.pending() <= kMostWaiting &&
         keyframe_policy_.is_due(submaps_[active_]->map, pose.frame, pose.motion.value_or(0));
}

Frame Tracker::add_to_submap(Frame frame, bool as_keyframe) {
  FrontSubmap& submap = active();
  const Keyframe* reference = submap.map.keyframe(frame.reference_keyframe);
  frame.cam_from_keyframe = frame.cam_from_submap * reference->cam_from_submap.inverse();
  if (as_keyframe) {
    const Keyframe& kf = submap.add_keyframe(&frame);
    note_certainty(kf.id, frame.certainty, &submap);
    submap.keep_images(options_.mapping.keyframe_images);
    keyframe_policy_.note_keyframe(frame.utime_us);
    add_to_index_and_map(kf);
  }
  submap.add_frame(frame);
  return frame;
}

std::optional<FoundPose> Tracker::relocalize_where_it_was(const Frame& frame) {
  return relocalize(active_, motion_.last().reference_keyframe, frame);
}

std::optional<FoundPose> Tracker::relocalize_anywhere(const Frame& frame) {
  for (const Relocalizer::Candidate& c : relocalizer_.candidates(frame))
    if (std::optional<FoundPose> found = relocalize(c.submap_index, c.keyframe_id, frame)) return found;
  return std::nullopt;
}

std::optional<FoundPose> Tracker::relocalize(size_t submap_index, int keyframe_id, const Frame& frame) {
  const StageClock clock("front_tracker.find_again");
  std::optional<Frame> found = relocalizer_.relocalize(submaps_[submap_index]->map, keyframe_id, frame);
  if (!found) return std::nullopt;
  return go_on_in(submap_index, std::move(*found));
}

// Begins a submap with all keyframes and landmarks of the back submap in which the frame is found.
std::optional<FoundPose> Tracker::go_on_in_back_submap(const Frame& frame) {
  std::optional<BackSubmaps::Found> back = back_submaps_.relocalize(frame);
  if (!back) return std::nullopt;
  const int back_id = back->submap.key.id;
  const FrontSubmap& submap = open_submap(std::move(back->submap));
  const size_t index = submaps_.size() - 1;
  for (const auto& [id, kf] : submap.map.keyframes) relocalizer_.add_keyframe(index, submap.map, kf);
  FoundPose pose = go_on_in(index, std::move(back->frame));
  loss_.set_outcome(
      fmt::format("found again in back submap {}: submap {} goes on from it", back_id, submap.map.key.id));
  return pose;
}

FoundPose Tracker::go_on_in(size_t submap_index, Frame found) {
  activate(submap_index);
  forget_slip(&found);
  posed_afterwards_ =
      results_afterwards(active(), past_poses_.track_back(found, initializer_.take_frames(), &active()));
  if (state_ == TrackingState::kLost) keyframe_policy_.note_found_again(found.utime_us);
  loss_.set_outcome(fmt::format("found again in submap {}", active().map.key.id));
  if (!loss_.is_open())
    log_debug("found by another look in submap {} at {} with {} matches", active().map.key.id, found.utime_us,
              found.matches());
  return {.frame = std::move(found)};
}

void Tracker::forget_slip(Frame* found) {
  withdrawn_ = withdraw_slip(relocalizer_, *found, &support_, &active());
  if (withdrawn_.empty()) return;
  templates_.clear();
  for (int& id : found->landmark_ids)
    if (id != kNone && !active().map.landmark(id)) id = kNone;
  log_line(loss_.is_open() ? LogLevel::kDebug : LogLevel::kInfo,  // if a loss is open, its message says this
           fmt::format("submap {} is torn: {} frames from {} on have no pose any more", active().map.key.id,
                       withdrawn_.size(), withdrawn_.front()));
}

void Tracker::wait_to_begin(const Frame& frame) {
  const StageClock clock("front_tracker.begin_submap");
  initializer_.buffer(frame);
}

std::optional<FoundPose> Tracker::begin_submap(const Frame& frame) {
  const StageClock clock("front_tracker.begin_submap");
  if (std::optional<FoundPose> found = go_on_in_back_submap(frame)) return found;
  Result<InitialMap> initial = initializer_.add(frame);
  if (!initial) {
    log_debug("no new submap at {}: {}", frame.utime_us, initial.error_text());
    return std::nullopt;
  }
  FrontSubmap& submap = open_submap({});
  activate(submaps_.size() - 1);
  std::vector<Frame> frames = add_first_map(std::move(*initial), extractor_, past_poses_, &submap);
  FoundPose pose{.frame = std::move(frames.back())};
  frames.pop_back();
  posed_afterwards_ = results_afterwards(submap, frames);
  keyframe_policy_.note_keyframe(pose.frame.utime_us);
  for (const auto& [id, kf] : submap.map.keyframes) add_to_index_and_map(kf);
  loss_.set_outcome(fmt::format("submap {} begins", submap.map.key.id));
  if (!loss_.is_open())
    log_info("submap {} begins at {:.2f} s: {} images have a pose in it, {} landmarks", submap.map.key.id,
             1e-6 * static_cast<double>(pose.frame.utime_us - first_utime_us_), submap.map.frames.size(),
             submap.map.landmarks.size());
  return pose;
}

FrontSubmap& Tracker::open_submap(Submap known) {
  const SubmapKey key = next_key();
  known.camera = camera_;
  known.pyramid = options_.orb.pyramid;
  known.stream = stream_;
  return *submaps_.emplace_back(std::make_unique<FrontSubmap>(std::move(known), key));
}

void Tracker::leave_full_submap() {
  const int most = options_.mapping.submap_keyframes;
  if (most == 0 || state_ != TrackingState::kTracking || mapping_.pending() > 0) return;
  const std::scoped_lock lock(map_mutex_);
  if (active().map.keyframes.size() <= static_cast<size_t>(most)) return;
  motion_.follow_mapping(active().map);
  const SubmapKey key = next_key();
  // The new one must be far from full, whatever the options are.
  const int around = std::min(options_.mapping.bundle_keyframes + options_.mapping.bundle_fixed_keyframes, most / 2);
  submaps_.push_back(go_on_from(active(), key, motion_.last().utime_us, static_cast<size_t>(around)));
  continued_from_[key.id] = active().map.key.id;
  const size_t full = std::exchange(active_, submaps_.size() - 1);
  submaps_[full]->rest();
  for (const auto& [id, kf] : active().map.keyframes) {
    relocalizer_.forget_keyframe(full, id);
    relocalizer_.add_keyframe(active_, active().map, kf);
  }
  log_debug("submap {} is full: submap {} goes on from it", submaps_[full]->map.key.id, key.id);
}

int Tracker::continued_from(int submap_id) const {
  const auto found = continued_from_.find(submap_id);
  return found == continued_from_.end() ? kNoSubmap : found->second;
}

void Tracker::activate(size_t submap_index) {
  if (submap_index == active_) return;
  support_.clear();
  templates_.clear();
  active().keep_images(0);
  active_ = submap_index;
  active().wake();
}

void Tracker::add_to_index_and_map(const Keyframe& keyframe) {
  relocalizer_.add_keyframe(active_, active().map, keyframe);
  to_map_.push_back(keyframe.id);
}

void Tracker::end() {
  loss_.end(last_utime_us_);
  if (submaps_.empty() && last_utime_us_ != INT64_MIN)
    log_warning("no submap began; the last try: {}", initializer_.refusal());
}

}  // namespace rumi::front_tracker
