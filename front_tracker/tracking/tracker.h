// SPDX-License-Identifier: BSD-3-Clause
// The front process without its messages: it takes images, gives a state and a pose for each, and makes submaps.
//
// If the pose of an image is found, the next state is TRACKING (see find_pose):
//
//   state            what is tried, in this order                next state if no pose is found
//   NOT_INITIALIZED  back submaps; two views begin a submap      NOT_INITIALIZED
//   TRACKING         patches; corners; relocalization            RECENTLY_LOST
//   RECENTLY_LOST    relocalization                              RECENTLY_LOST for recently_lost_s, then LOST
//   LOST             relocalization; then as NOT_INITIALIZED     LOST
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/running/worker.h"
#include "front_tracker/frame/front_submap.h"
#include "front_tracker/initialization/initializer.h"
#include "front_tracker/mapping/mapper.h"
#include "front_tracker/masking/joint_mask.h"
#include "front_tracker/masking/still_parts.h"
#include "front_tracker/patches/patch_templates.h"
#include "front_tracker/relocalization/back_submaps.h"
#include "front_tracker/relocalization/relocalizer.h"
#include "front_tracker/tracking/found_pose.h"
#include "front_tracker/tracking/keyframe_policy.h"
#include "front_tracker/tracking/loss.h"
#include "front_tracker/tracking/loss_history.h"
#include "front_tracker/tracking/motion_model.h"
#include "front_tracker/tracking/past_poses.h"
#include "front_tracker/tracking/pose_by_corners.h"
#include "front_tracker/tracking/pose_by_patches.h"
#include "front_tracker/tracking/track_result.h"
#include "front_tracker/tracking/tracker_options.h"

namespace rumi::front_tracker {

class Tracker {
 public:
  // The camera is that of the images given to process(). `session` goes into the submaps' keys, `stream` is that of the
  // images.
  Tracker(const Camera& camera, const TrackerOptions& options, int64_t session, int64_t stream = 0);

  // Takes images of 8-bit grey and of the camera's size in order of time, and what is known of what they show. Returns
  // nothing for an image that is not newer than the last one.
  std::optional<TrackResult> process(int64_t utime_us, const cv::Mat& grey, const ImageMask& mask = {});

  // Earlier frames that got poses when the last image began a submap or was relocalized, in order of time.
  const std::vector<TrackResult>& posed_afterwards() const { return posed_afterwards_; }

  // Earlier frames whose poses turned out to be wrong when the last image was relocalized, in order of time. They are
  // in no submap any more.
  const std::vector<int64_t>& withdrawn() const { return withdrawn_; }

  // Adds a back submap of this session for relocalization where no front submap helps. If the camera is found in it,
  // tracking goes on in a new front submap that begins as a copy of it, with the same unit and images. Returns why the
  // back submap was refused, or an empty string.
  std::string add_back_submap(Submap submap) { return back_submaps_.add(std::move(submap)); }
  void remove_back_submap(int id) { back_submaps_.remove(id); }
  const BackSubmaps& back_submaps() const { return back_submaps_; }

  // Of an image that is the last one once more: while the camera is tracked, where it should be by now. Else nothing.
  std::optional<TrackResult> predict(int64_t utime_us);

  // What has turned out never to move in the images, besides what the given masks leave out.
  const ImageMask& still_mask() const { return still_parts_.mask(); }

  // All submaps, oldest first; the pointers stay valid. Hold the mutex while looking at them.
  const std::vector<std::unique_ptr<FrontSubmap>>& submaps() const { return submaps_; }
  std::mutex& mutex() { return map_mutex_; }
  void wait_for_mapping() { mapping_.wait_until_idle(); }
  // Counts the keyframes whose mapping threw since the last call. Tracking goes on without their new landmarks.
  Worker::Broken take_broken_mapping() { return mapping_.take_broken(); }
  // Call it when no more images come: it logs a loss that is still open.
  void end();
  const Camera& camera() const { return camera_; }
  int64_t session() const { return session_; }
  int64_t stream() const { return stream_; }

 private:
  using Images = std::shared_ptr<const ImagePyramid>;

  Images prepare(int64_t utime_us, const cv::Mat& grey, const ImageMask& mask);
  void forget_still_landmarks();

  // Looks for the pose of an image. accept() makes it the start for the next image.
  bool pose_without_corners(int64_t utime_us, const Images& images, TrackResult* result);
  void pose_with_corners(int64_t utime_us, const Images& images, TrackResult* result);
  Frame find_corners(int64_t utime_us, const Images& images);
  bool find_pose(FoundPose* pose);
  bool track(FoundPose* pose);
  void lose(const FoundPose& pose);
  void accept(FoundPose pose, TrackResult* result);
  bool add_to_submap(FoundPose* pose);

  // Finding the camera again.
  bool relocalize_where_it_was(FoundPose* pose);
  bool relocalize_anywhere(FoundPose* pose);
  bool relocalize(size_t submap_index, int keyframe_id, FoundPose* pose);
  bool go_on_in_back_submap(FoundPose* pose);
  void go_on_in(size_t submap_index, FoundPose* pose);
  void withdraw_slip(Frame* found);

  // Beginning a submap.
  void wait_to_begin(const Frame& frame);
  bool begin_submap(FoundPose* pose);
  FrontSubmap& open_submap(Submap known);
  void activate(size_t submap_index);  // tracking goes on in this submap
  void add_to_index_and_map(const Keyframe& keyframe);

  FrontSubmap& active() { return *submaps_[active_]; }

  Camera camera_;
  TrackerOptions options_;
  int64_t session_, stream_;

  // What is looked at, and how a pose is found.
  StillParts still_parts_;
  JointMask mask_;
  OrbExtractor extractor_;
  PoseByPatches by_patches_;
  PoseByCorners by_corners_;
  PastPoses past_poses_;
  Initializer initializer_;
  Relocalizer relocalizer_;
  BackSubmaps back_submaps_;

  // The submaps.
  std::mutex map_mutex_;
  std::vector<std::unique_ptr<FrontSubmap>> submaps_;
  size_t active_ = 0;  // index into submaps_, while TRACKING or RECENTLY_LOST
  KeyframePolicy keyframe_policy_;
  Mapper mapper_;
  std::vector<int> to_map_;  // keyframes of the active submap for the mapper; it gets them after the lock is released

  // Where tracking stands, in the active submap.
  TrackingState state_ = TrackingState::kNotInitialized;
  MotionModel motion_;
  LossHistory history_;
  PatchTemplates templates_;  // of the last frames
  LossReport loss_;
  int64_t first_utime_us_ = 0, last_utime_us_ = INT64_MIN;

  // Of the last image.
  std::vector<TrackResult> posed_afterwards_;
  std::vector<int64_t> withdrawn_;

  Worker mapping_;  // last: its thread ends first
};

}  // namespace rumi::front_tracker
