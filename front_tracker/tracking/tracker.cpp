// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/tracker.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/log.h"
#include "base/stage_clock.h"
#include "front_tracker/frame/certainty.h"
#include "front_tracker/patches/patch_tracking.h"
#include "slam/map/landmark_view.h"
#include "slam/numeric/median.h"

namespace rumi::front_tracker {
namespace {

// So long after a camera was found it sees from elsewhere what the submap knows, and beside it what it does not know.
constexpr int64_t kFoundAgain_us = 1'000'000;
// How long before a loss a slip may have begun.
constexpr int64_t kMayBeWrong_us = 4'000'000;

}  // namespace

Tracker::Tracker(const Camera& camera, const TrackerOptions& options, int64_t session, int64_t stream)
    : camera_(camera),
      options_(options),
      session_(session),
      stream_(stream),
      extractor_(options.orb),
      scales_(options.orb.pyramid.scales()),
      initializer_(camera, options.initializer, scales_),
      relocalizer_(camera, options.tracking, scales_),
      back_submaps_(camera, options.tracking, options.orb.pyramid),
      mapper_(camera, options.mapping),
      mapping_(options.mapping_thread) {}

std::optional<TrackResult> Tracker::process(int64_t utime_us, const cv::Mat& grey) {
  if (utime_us <= last_utime_us_) return std::nullopt;
  const StageClock clock("front_tracker.track");
  if (last_utime_us_ == INT64_MIN) first_utime_us_ = utime_us;
  last_utime_us_ = utime_us;
  const bool keep = options_.mapping.keyframe_images > 0;
  const auto images = std::make_shared<const ImagePyramid>(extractor_.pyramid(keep ? grey.clone() : grey));
  posed_afterwards_.clear();
  withdrawn_.clear();
  TrackResult result;
  result.utime_us = utime_us;
  if (follow(utime_us, images, &result)) return result;

  const bool tracking = state_ == TrackingState::kTracking;
  Frame frame = find_corners(utime_us, *images, tracking ? options_.orb.keypoints : options_.initializer.keypoints);
  last_corners_us_ = utime_us;
  motion_since_corners_ = 0;
  if (keep) frame.images = images;
  result.keypoints = static_cast<int>(frame.features->size());
  {
    const std::scoped_lock lock(map_mutex_);
    if (tracking && !track(&frame) && !look_again(&frame)) lose(frame);
    const bool found = state_ == TrackingState::kTracking || (!tracking && recover(&frame)) || begin_submap(&frame);
    if (found) accept(std::move(frame), &result);
    result.state = state_;
    follow_loss(result);
  }
  for (const auto& [submap, keyframe] : tasks_)
    mapping_.post([this, submap = submap, keyframe = keyframe] { mapper_.process(*submap, keyframe, map_mutex_); });
  tasks_.clear();
  return result;
}

Frame Tracker::find_corners(int64_t utime_us, const ImagePyramid& images, int keypoints) {
  const StageClock clock("front_tracker.corners");
  Frame frame = make_frame(utime_us, extractor_.extract(images, keypoints), camera_);
  if (static_cast<int>(frame.features->size()) < options_.orb.keypoints / 2) frame.corners = Corners::kFew;
  return frame;
}

// In slow motion, soon after an image with corners: without looking for any. Such an image becomes no keyframe; so
// corners are due, too, once the images without have moved by as much as makes one due. Of images that blur or darken
// the first must become one, for its corners are what the next are matched with, though most patches are found in it:
// hence kLeastFound.
bool Tracker::follow(int64_t utime_us, const std::shared_ptr<const ImagePyramid>& images, TrackResult* result) {
  constexpr double kLeastFound = 0.8;  // of the landmarks that should be in view
  const TrackingOptions& o = options_.tracking;
  const double since_corners_s = 1e-6 * static_cast<double>(utime_us - last_corners_us_);
  if (state_ != TrackingState::kTracking || velocity_dt_us_ == 0 || options_.mapping.keyframe_images == 0 ||
      since_corners_s >= o.corner_interval_s || last_.corners == Corners::kFew)
    return false;
  const std::scoped_lock lock(map_mutex_);
  Frame frame;
  frame.utime_us = utime_us;
  frame.images = images;
  frame.corners = Corners::kNone;
  predict_pose(&frame);
  if (!find_pose_by_patches(active(), last_, &frame, &templates_)) return false;
  const double motion = motion_since_last_frame(frame);
  if (motion > o.patch_motion || motion_since_corners_ + motion > options_.keyframes.max_motion) return false;
  const PatchTracking tracked = track_by_patches(active(), last_, &frame, &templates_);
  if (tracked.inliers < kLeastFound * tracked.in_view) return false;
  frame.certainty = certainty_of(active().map, scales_, frame);
  if (frame.certainty.image_px > o.uncertain_px || drifts(frame)) return false;
  motion_since_corners_ += motion;
  note_motion(frame);
  result->state = state_;
  result->keypoints = static_cast<int>(frame.features->size());
  accept(std::move(frame), result);
  return true;
}

// One rule for tracking and relocalization: what the latter would believe in this very image is not lost. It looks
// farther than tracking does, and believes a pose that does not carry the scale on where much of what should be in view
// is there. No motion is told of such a pose: patches and keyframes of fast motion, which would be built on it, wait.
bool Tracker::look_again(Frame* frame) {
  return relocalize(active_, last_.reference_keyframe, frame) || relocalize_anywhere(frame);
}

void Tracker::lose(const Frame& frame) {
  state_ = TrackingState::kRecentlyLost;
  initializer_.clear();
  const Submap& map = active().map;
  loss_ = Loss{.first_utime_us = first_utime_us_,
               .utime_us = frame.utime_us,
               .submap_id = map.key.id,
               .frames_before = map.frames.size(),
               .why = why_lost_};
}

// One line for a loss, when it is over.
void Tracker::follow_loss(const TrackResult& result) {
  if (!loss_) return;
  if (result.submap_id == kNoSubmap) {
    ++loss_->images;
    return;
  }
  loss_->posed_afterwards = static_cast<int>(posed_afterwards_.size());
  loss_->withdrawn = static_cast<int>(withdrawn_.size());
  log_line(loss_->is_hiccup() ? LogLevel::kDebug : LogLevel::kInfo, describe(*loss_, result.utime_us));
  loss_.reset();
}

void Tracker::end() {
  if (loss_) {
    loss_->outcome = "not found again until the end";
    log_info("{}", describe(*loss_, last_utime_us_));
  } else if (submaps_.empty() && last_utime_us_ != INT64_MIN) {
    log_warning("no submap began; the last try: {}", initializer_.refusal());
  }
}

// Finds the camera again: first where it was last seen, then wherever it looks alike.
bool Tracker::recover(Frame* frame) {
  const StageClock clock("front_tracker.find_again");
  if (submaps_.empty()) return false;
  if (state_ == TrackingState::kRecentlyLost) {
    if (relocalize(active_, last_.reference_keyframe, frame)) return true;
    const double lost_s = 1e-6 * static_cast<double>(frame->utime_us - loss_->utime_us);
    if (lost_s > options_.tracking.recently_lost_s) state_ = TrackingState::kLost;
  }
  return relocalize_anywhere(frame);
}

bool Tracker::relocalize_anywhere(Frame* frame) {
  for (const Relocalizer::Candidate& c : relocalizer_.candidates(*frame))
    if (relocalize(c.submap_index, c.keyframe_id, frame)) return true;
  return false;
}

bool Tracker::relocalize(size_t submap_index, int keyframe_id, Frame* frame) {
  if (!relocalizer_.relocalize(submaps_[submap_index]->map, keyframe_id, frame)) return false;
  go_on_in(submap_index, frame);
  return true;
}

// A beginning, too: of a submap that knows already what rumination found out.
bool Tracker::go_on_in_back_submap(Frame* frame) {
  std::optional<Submap> back = back_submaps_.relocalize(frame);
  if (!back) return false;
  const int back_id = back->key.id;
  const FrontSubmap& submap = open_submap(std::move(*back));
  for (const auto& [id, kf] : submap.map.keyframes) relocalizer_.add_keyframe(submaps_.size() - 1, submap.map, kf);
  go_on_in(submaps_.size() - 1, frame);
  if (loss_)
    loss_->outcome =
        fmt::format("found again in back submap {}: submap {} goes on from it", back_id, submap.map.key.id);
  return true;
}

void Tracker::activate(size_t submap_index) {
  recent_.clear();
  if (submap_index != active_) templates_.clear();
  if (submap_index != active_) active().keep_images(0);
  active_ = submap_index;
}

void Tracker::go_on_in(size_t submap_index, Frame* frame) {
  if (submap_index != active_) activate(submap_index);
  withdraw_torn_end(frame);
  track_back(*frame, initializer_.take_frames());
  if (state_ == TrackingState::kLost) found_us_ = frame->utime_us;
  state_ = TrackingState::kTracking;
  velocity_ = SE3();
  velocity_dt_us_ = 0;
  if (loss_)
    loss_->outcome = fmt::format("found again in submap {}", active().map.key.id);
  else
    log_debug("found by another look in submap {} at {} with {} matches", active().map.key.id, frame->utime_us,
              frame->matches());
}

// Do the newest keyframes before the loss contradict the place where the frame was found?
bool Tracker::is_torn(const Frame& found) const {
  constexpr int kCompared = 3;
  if (recent_.empty()) return false;
  const Submap& map = submaps_[active_]->map;
  auto kf = map.keyframes.rbegin();
  for (int i = 0; i < kCompared && kf != map.keyframes.rend(); ++i, ++kf)
    if (kf->second.utime_us >= recent_.front().utime_us && relocalizer_.contradicts(map, kf->first, found)) return true;
  return false;
}

// A slip begins with the weakest frame, or one just before it that is hardly stronger.
std::deque<Tracker::Support>::const_iterator Tracker::slip_begins() const {
  auto first = std::min_element(recent_.begin(), recent_.end(),
                                [](const Support& a, const Support& b) { return a.inliers < b.inliers; });
  const int weak = 2 * first->inliers;
  while (first != recent_.begin() && std::prev(first)->inliers < weak) --first;
  return first;
}

// Just before a loss tracking may have slipped: then the same things lie at two places of the submap, where they were
// seen long ago and where the last frames put them. What came after the slip is not true.
void Tracker::withdraw_torn_end(Frame* found) {
  if (!is_torn(*found)) return;
  FrontSubmap& submap = active();
  const auto first = slip_begins();
  const int64_t first_us = first->utime_us;
  if (submap.map.keyframe(found->reference_keyframe)->utime_us >= first_us ||
      submap.map.keyframes.begin()->second.utime_us >= first_us)
    return;  // nothing older to hold on to
  for (auto frame = submap.map.frames.lower_bound(first_us); frame != submap.map.frames.end(); ++frame)
    withdrawn_.push_back(frame->first);
  submap.cut_end(first_us);
  recent_.erase(first, recent_.end());
  templates_.clear();
  for (int& id : found->landmark_ids)
    if (id != kNone && !submap.map.landmark(id)) id = kNone;
  log_line(loss_ ? LogLevel::kDebug : LogLevel::kInfo,  // else the loss tells it
           fmt::format("submap {} is torn: {} frames from {} on have no pose any more", submap.map.key.id,
                       withdrawn_.size(), first_us));
}

FrontSubmap& Tracker::open_submap(Submap known) {
  const SubmapKey key{session_, static_cast<int32_t>(submaps_.size()) + 1};
  known.camera = camera_;
  known.pyramid = options_.orb.pyramid;
  known.stream = stream_;
  return *submaps_.emplace_back(std::make_unique<FrontSubmap>(std::move(known), key));
}

bool Tracker::begin_submap(Frame* frame) {
  const StageClock clock("front_tracker.begin_submap");
  if (state_ == TrackingState::kRecentlyLost) {
    initializer_.buffer(*frame);
    return false;
  }
  if (go_on_in_back_submap(frame)) return true;
  auto initial = initializer_.add(*frame);
  if (!initial) {
    log_debug("no new submap at {}: {}", frame->utime_us, initializer_.refusal());
    return false;
  }
  open_submap({});
  activate(submaps_.size() - 1);
  add_initial_map(std::move(*initial), &active());
  *frame = last_;
  state_ = TrackingState::kTracking;
  velocity_ = SE3();
  velocity_dt_us_ = 0;
  if (loss_)
    loss_->outcome = fmt::format("submap {} begins", active().map.key.id);
  else
    log_info("submap {} begins at {:.2f} s: {} images have a pose in it, {} landmarks", active().map.key.id,
             1e-6 * static_cast<double>(frame->utime_us - first_utime_us_), active().map.frames.size(),
             active().map.landmarks.size());
  return true;
}

void Tracker::add_initial_map(InitialMap initial, FrontSubmap* submap) {
  std::vector<bool> posed(initial.frames.size(), false);
  std::vector<InitialMap::View> views = initial.views;
  std::vector<int> keyframe_of_view(views.size(), kNone);
  std::vector<size_t> in_time(views.size());
  for (size_t v = 0; v < views.size(); ++v) in_time[v] = v;
  std::sort(in_time.begin(), in_time.end(), [&](size_t a, size_t b) { return views[a].frame < views[b].frame; });
  for (size_t v : in_time) {
    Frame& frame = initial.frames[views[v].frame];
    frame.clear_matches();
    frame.cam_from_submap = views[v].cam_from_submap;
    posed[views[v].frame] = true;
    if (!views[v].keyframe) continue;
    if (frame.images) frame.images = std::make_shared<const ImagePyramid>(extractor_.pyramid(frame.images->level(0)));
    keyframe_of_view[v] = submap->add_keyframe(&frame).id;
  }
  for (const InitialMap::Point& point : initial.points) {
    const int id = submap->add_landmark(point.position).id;
    for (const auto& [view, keypoint] : point.observations) {
      submap->map.add_observation(id, keyframe_of_view[view], keypoint);
      initial.frames[views[view].frame].landmark_ids[keypoint] = id;
    }
    update_landmark_view(submap->map, submap->map.landmark(id));
  }
  // Views that are no keyframes hang on the nearest one before them.
  int keyframe = kNone;
  for (size_t v : in_time) {
    Frame& frame = initial.frames[views[v].frame];
    if (keyframe_of_view[v] != kNone) keyframe = keyframe_of_view[v];
    frame.reference_keyframe = keyframe;
    frame.cam_from_keyframe = frame.cam_from_submap * submap->map.keyframe(keyframe)->cam_from_submap.inverse();
    frame.certainty =
        keyframe_of_view[v] != kNone ? certainty_of(submap->map, scales_, frame) : certainty_where_it_is(frame);
    record_pose(submap, frame);
  }
  give_poses_afterwards(&initial.frames, &posed);
  for (size_t i = 0; i + 1 < initial.frames.size(); ++i)  // the newest is the one that begins the submap
    if (posed[i]) note_pose_afterwards(initial.frames[i]);
  last_ = initial.frames.back();
  last_keyframe_us_ = last_.utime_us;
  for (const auto& [id, kf] : submap->map.keyframes) {
    relocalizer_.add_keyframe(active_, submap->map, kf);
    tasks_.emplace_back(submap, id);
  }
}

void Tracker::record_pose(FrontSubmap* submap, const Frame& frame) {
  submap->map.frames[frame.utime_us] = {frame.utime_us, frame.reference_keyframe, frame.cam_from_keyframe,
                                        submap->map.stamp(), sigmas_of(*submap, frame)};
}

bool Tracker::needs_keyframe(const Frame& frame) const {
  const FrontSubmap& submap = *submaps_[active_];
  if (mapping_.pending() > 2 || !frame.is_believable || frame.corners == Corners::kNone) return false;
  const Keyframe* reference = submap.map.keyframe(frame.reference_keyframe);
  int established = 0;
  for (int id : reference->landmark_ids) {
    const Landmark* lm = id == kNone ? nullptr : submap.map.landmark(id);
    if (lm && (lm->observations.size() >= 3 || submap.map.keyframes.size() < 4)) ++established;
  }
  const KeyframeOptions& o = options_.keyframes;
  const int inliers = frame.matches();
  // In a fast turn, or at a low frame rate, the next frame may be too late.
  if (inliers < o.urgent_tracked_ratio * established) return true;
  const double since_s = 1e-6 * static_cast<double>(frame.utime_us - last_keyframe_us_);
  if (since_s < o.min_interval_s) return false;
  if (frame.utime_us - found_us_ < kFoundAgain_us) return true;
  // The first of images that blur or darken: its corners are what the next are matched with.
  if (frame.corners == Corners::kFew && static_cast<int>(reference->features->size()) >= options_.orb.keypoints / 2)
    return true;
  if (inliers < o.min_tracked_ratio * established || motion_since_last_frame(frame) > o.max_motion) return true;
  if (inliers < o.min_inliers && since_s >= 3 * o.min_interval_s) return true;
  return since_s >= o.max_interval_s;
}

// Median, of the image's width.
double Tracker::motion_since_last_frame(const Frame& frame) const {
  if (velocity_dt_us_ == 0) return 0;  // the last frame may be of another submap
  const Submap& map = submaps_[active_]->map;
  std::vector<double> motion;
  for (size_t i = 0; i < frame.landmark_ids.size(); ++i) {
    const Landmark* lm = frame.landmark_ids[i] == kNone ? nullptr : map.landmark(frame.landmark_ids[i]);
    const Eigen::Vector3d before = lm ? last_.cam_from_submap * lm->position : Eigen::Vector3d::Zero();
    if (before.z() > 0)
      motion.push_back((camera_.project_undistorted(before) - frame.features->undistorted[i].cast<double>()).norm());
  }
  return motion.empty() ? 0 : median(&motion) / camera_.width;
}

void Tracker::accept(Frame frame, TrackResult* result) {
  FrontSubmap& submap = active();
  state_ = TrackingState::kTracking;
  initializer_.clear();
  const bool already = submap.map.frame(frame.utime_us) != nullptr;  // it began the submap
  result->is_keyframe = already;
  if (!already) {
    const Keyframe* reference = submap.map.keyframe(frame.reference_keyframe);
    frame.cam_from_keyframe = frame.cam_from_submap * reference->cam_from_submap.inverse();
    if (needs_keyframe(frame)) {
      const Keyframe& kf = submap.add_keyframe(&frame);
      note_certainty(kf.id, frame.certainty, &submap);
      submap.keep_images(options_.mapping.keyframe_images);
      relocalizer_.add_keyframe(active_, submap.map, kf);
      tasks_.emplace_back(&submap, kf.id);
      last_keyframe_us_ = frame.utime_us;
      result->is_keyframe = true;
    }
    record_pose(&submap, frame);
  }
  note_pose(submap, frame, result);
  recent_.push_back({frame.utime_us, result->inliers, frame.certainty.log_scale_variance});
  while (frame.utime_us - recent_.front().utime_us > kMayBeWrong_us ||
         static_cast<int>(recent_.size()) > kMostRetoldFrames)
    recent_.pop_front();
  last_ = std::move(frame);
}

void Tracker::note_pose(const FrontSubmap& submap, const Frame& frame, TrackResult* result) const {
  result->submap_id = submap.map.key.id;
  result->submap_revision = submap.map.revision;
  result->reference_keyframe = frame.reference_keyframe;
  result->cam_from_keyframe = frame.cam_from_keyframe;
  result->cam_from_submap = frame.cam_from_submap;
  result->sigmas = submap.map.frame(frame.utime_us)->sigmas;
  result->inliers = frame.matches();
}

void Tracker::note_pose_afterwards(const Frame& frame) {
  TrackResult result;
  result.utime_us = frame.utime_us;
  result.keypoints = static_cast<int>(frame.features->size());
  result.is_keyframe = active().map.keyframe(frame.reference_keyframe)->utime_us == frame.utime_us;
  note_pose(active(), frame, &result);
  posed_afterwards_.push_back(result);
}

}  // namespace rumi::front_tracker
