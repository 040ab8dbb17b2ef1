// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/tracker.h"

#include <fmt/format.h>

#include <cmath>

#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "front_tracker/frame/certainty.h"
#include "front_tracker/tracking/first_map.h"

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
  const Images images = prepare(utime_us, grey, mask);
  TrackResult result;
  result.utime_us = utime_us;
  if (!pose_without_corners(utime_us, images, &result)) pose_with_corners(utime_us, images, &result);
  result.state = state_;
  for (int keyframe : to_map_)
    mapping_.post([this, &submap = active(), keyframe] { mapper_.process(submap, keyframe, map_mutex_); });
  to_map_.clear();
  return result;
}

std::optional<TrackResult> Tracker::predict(int64_t utime_us) {
  constexpr double kUnsure = 0.3;  // of the motion since the last frame
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

bool Tracker::pose_without_corners(int64_t utime_us, const Images& images, TrackResult* result) {
  if (state_ != TrackingState::kTracking || !by_patches_.may_do(motion_, utime_us)) return false;
  const std::scoped_lock lock(map_mutex_);
  motion_.follow_mapping(active().map);
  FoundPose pose = by_patches_.find(active(), motion_, utime_us, images, &templates_);
  if (!pose.found() || history_.scale_drifts(pose.frame, options_.tracking.max_scale_drift)) return false;
  result->keypoints = static_cast<int>(pose.frame.features->size());
  accept(std::move(pose), result);
  return true;
}

void Tracker::pose_with_corners(int64_t utime_us, const Images& images, TrackResult* result) {
  FoundPose pose{.frame = find_corners(utime_us, images)};
  result->keypoints = static_cast<int>(pose.frame.features->size());
  const std::scoped_lock lock(map_mutex_);
  if (find_pose(&pose)) accept(std::move(pose), result);
  loss_.image(utime_us, result->submap_id != kNoSubmap, posed_afterwards_.size(), withdrawn_.size());
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

bool Tracker::find_pose(FoundPose* pose) {
  switch (state_) {
    case TrackingState::kTracking:
      // If relocalization finds the camera in this image, it is not lost. Relocalization searches farther than
      // tracking. It accepts a pose that does not carry the scale on, if it finds enough of the landmarks that should
      // be in view. The motion to such a pose is unknown, so patches and keyframes of fast motion wait.
      if (track(pose) || relocalize_where_it_was(pose) || relocalize_anywhere(pose)) return true;
      lose(*pose);
      wait_to_begin(pose->frame);
      return false;
    case TrackingState::kRecentlyLost:
      if (relocalize_where_it_was(pose)) return true;
      if (loss_.seconds_until(pose->frame.utime_us) <= options_.tracking.recently_lost_s) {
        if (relocalize_anywhere(pose)) return true;
        wait_to_begin(pose->frame);
        return false;
      }
      state_ = TrackingState::kLost;
      [[fallthrough]];
    case TrackingState::kLost:
      return relocalize_anywhere(pose) || begin_submap(pose);
    default:  // NOT_INITIALIZED
      return begin_submap(pose);
  }
}

bool Tracker::track(FoundPose* pose) {
  motion_.follow_mapping(active().map);
  *pose = by_corners_.find(active(), motion_, std::move(pose->frame), &templates_);
  count_sights(*pose, &active().map);
  if (pose->found() && history_.scale_drifts(pose->frame, options_.tracking.max_scale_drift))
    pose->why_not = "the scale is not known any more";
  return pose->found();
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

void Tracker::accept(FoundPose pose, TrackResult* result) {
  state_ = TrackingState::kTracking;
  initializer_.clear();
  result->is_keyframe = add_to_submap(&pose);
  note_pose(active(), pose.frame, result);
  by_patches_.note(pose);
  history_.add(pose.frame);
  if (pose.motion)
    motion_.go_on(std::move(pose.frame));
  else
    motion_.begin_at(std::move(pose.frame));
}

// Adds the frame, as a keyframe if one is due. Returns whether it is a keyframe.
bool Tracker::add_to_submap(FoundPose* pose) {
  constexpr int kMostWaiting = 2;  // keyframes for the mapper
  FrontSubmap& submap = active();
  Frame* frame = &pose->frame;
  if (submap.map.frame(frame->utime_us)) return true;  // it began the submap
  const Keyframe* reference = submap.map.keyframe(frame->reference_keyframe);
  frame->cam_from_keyframe = frame->cam_from_submap * reference->cam_from_submap.inverse();
  const bool is_keyframe =
      mapping_.pending() <= kMostWaiting && keyframe_policy_.is_due(submap.map, *frame, pose->motion.value_or(0));
  if (is_keyframe) {
    const Keyframe& kf = submap.add_keyframe(frame);
    note_certainty(kf.id, frame->certainty, &submap);
    submap.keep_images(options_.mapping.keyframe_images);
    keyframe_policy_.note_keyframe(frame->utime_us);
    add_to_index_and_map(kf);
  }
  submap.add_frame(*frame);
  return is_keyframe;
}

bool Tracker::relocalize_where_it_was(FoundPose* pose) {
  return relocalize(active_, motion_.last().reference_keyframe, pose);
}

bool Tracker::relocalize_anywhere(FoundPose* pose) {
  for (const Relocalizer::Candidate& c : relocalizer_.candidates(pose->frame))
    if (relocalize(c.submap_index, c.keyframe_id, pose)) return true;
  return false;
}

bool Tracker::relocalize(size_t submap_index, int keyframe_id, FoundPose* pose) {
  const StageClock clock("front_tracker.find_again");
  if (!relocalizer_.relocalize(submaps_[submap_index]->map, keyframe_id, &pose->frame)) return false;
  go_on_in(submap_index, pose);
  return true;
}

// This begins a submap, too: one that has all keyframes and landmarks of the back submap.
bool Tracker::go_on_in_back_submap(FoundPose* pose) {
  std::optional<Submap> back = back_submaps_.relocalize(&pose->frame);
  if (!back) return false;
  const int back_id = back->key.id;
  const FrontSubmap& submap = open_submap(std::move(*back));
  const size_t index = submaps_.size() - 1;
  for (const auto& [id, kf] : submap.map.keyframes) relocalizer_.add_keyframe(index, submap.map, kf);
  go_on_in(index, pose);
  loss_.set_outcome(
      fmt::format("found again in back submap {}: submap {} goes on from it", back_id, submap.map.key.id));
  return true;
}

void Tracker::go_on_in(size_t submap_index, FoundPose* pose) {
  activate(submap_index);
  *pose = {.frame = std::move(pose->frame)};
  withdraw_slip(&pose->frame);
  posed_afterwards_ =
      results_afterwards(active(), past_poses_.track_back(pose->frame, initializer_.take_frames(), &active()));
  if (state_ == TrackingState::kLost) keyframe_policy_.note_found_again(pose->frame.utime_us);
  loss_.set_outcome(fmt::format("found again in submap {}", active().map.key.id));
  if (!loss_.is_open())
    log_debug("found by another look in submap {} at {} with {} matches", active().map.key.id, pose->frame.utime_us,
              pose->frame.matches());
}

void Tracker::withdraw_slip(Frame* found) {
  withdrawn_ = history_.withdraw_slip(relocalizer_, *found, &active());
  if (withdrawn_.empty()) return;
  templates_.clear();
  for (int& id : found->landmark_ids)
    if (id != kNone && !active().map.landmark(id)) id = kNone;
  log_line(loss_.is_open() ? LogLevel::kDebug : LogLevel::kInfo,  // otherwise the message about the loss says it
           fmt::format("submap {} is torn: {} frames from {} on have no pose any more", active().map.key.id,
                       withdrawn_.size(), withdrawn_.front()));
}

void Tracker::wait_to_begin(const Frame& frame) {
  const StageClock clock("front_tracker.begin_submap");
  initializer_.buffer(frame);
}

bool Tracker::begin_submap(FoundPose* pose) {
  const StageClock clock("front_tracker.begin_submap");
  if (go_on_in_back_submap(pose)) return true;
  auto initial = initializer_.add(pose->frame);
  if (!initial) {
    log_debug("no new submap at {}: {}", pose->frame.utime_us, initializer_.refusal());
    return false;
  }
  FrontSubmap& submap = open_submap({});
  activate(submaps_.size() - 1);
  std::vector<Frame> frames = add_first_map(std::move(*initial), extractor_, past_poses_, &submap);
  pose->frame = std::move(frames.back());
  frames.pop_back();
  posed_afterwards_ = results_afterwards(submap, frames);
  keyframe_policy_.note_keyframe(pose->frame.utime_us);
  for (const auto& [id, kf] : submap.map.keyframes) add_to_index_and_map(kf);
  loss_.set_outcome(fmt::format("submap {} begins", submap.map.key.id));
  if (!loss_.is_open())
    log_info("submap {} begins at {:.2f} s: {} images have a pose in it, {} landmarks", submap.map.key.id,
             1e-6 * static_cast<double>(pose->frame.utime_us - first_utime_us_), submap.map.frames.size(),
             submap.map.landmarks.size());
  return true;
}

FrontSubmap& Tracker::open_submap(Submap known) {
  const SubmapKey key{session_, static_cast<int32_t>(submaps_.size()) + 1};
  known.camera = camera_;
  known.pyramid = options_.orb.pyramid;
  known.stream = stream_;
  return *submaps_.emplace_back(std::make_unique<FrontSubmap>(std::move(known), key));
}

void Tracker::activate(size_t submap_index) {
  if (submap_index == active_) return;
  history_.clear();
  templates_.clear();
  active().keep_images(0);
  active_ = submap_index;
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
