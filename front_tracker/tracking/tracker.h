// SPDX-License-Identifier: BSD-3-Clause
// The front process without its messages: takes images, gives a state and a pose for each, and makes submaps.
//
// If the pose of an image is found, the next state is TRACKING (see pose_with_corners):
//
//   state            what is tried, in this order                next state if no pose is found
//   NOT_INITIALIZED  back submaps; two views begin a submap      NOT_INITIALIZED
//   TRACKING         patches; corners; relocalization            RECENTLY_LOST
//   RECENTLY_LOST    relocalization                              RECENTLY_LOST for recently_lost_s, then LOST
//   LOST             relocalization; then as NOT_INITIALIZED     LOST
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/result.h"
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
#include "front_tracker/tracking/motion_model.h"
#include "front_tracker/tracking/past_poses.h"
#include "front_tracker/tracking/pose_by_corners.h"
#include "front_tracker/tracking/pose_by_patches.h"
#include "front_tracker/tracking/support_history.h"
#include "front_tracker/tracking/track_result.h"
#include "front_tracker/tracking/tracker_options.h"

namespace rumi::front_tracker {

class Tracker {
 public:
  // `camera` takes the images that process() gets, `stream` is their stream, and `session` goes into the submaps' keys.
  Tracker(const Camera& camera, const TrackerOptions& options, int64_t session, int64_t stream = 0);

  // Takes the images in order of time: 8-bit grey, of the camera's size, and a mask of the pixels that show the world.
  // Returns nullopt for an image that is not newer than the last one.
  std::optional<TrackResult> process(int64_t utime_us, const cv::Mat& grey, const ImageMask& mask = {});

  // Returns the earlier frames that got poses because the last image began a submap or was relocalized, in order of
  // time.
  const std::vector<TrackResult>& posed_afterwards() const { return posed_afterwards_; }

  // Returns the times of earlier frames whose poses turned out to be wrong when the last image was relocalized, in
  // order. These frames are no longer in any submap.
  const std::vector<int64_t>& withdrawn() const { return withdrawn_; }

  // Adds a back submap of this session, for relocalization where no front submap helps. If the camera is found in it,
  // tracking goes on in a new front submap that begins as a copy of it, with the same unit and images. Returns an Error
  // if the back submap is refused.
  Result<> add_back_submap(Submap submap) { return back_submaps_.add(std::move(submap)); }
  void remove_back_submap(int id) { back_submaps_.remove(id); }
  const BackSubmaps& back_submaps() const { return back_submaps_; }

  // To be called for an image that repeats the last one. Returns the pose that the camera should have by now, or
  // nullopt if the camera is not tracked.
  std::optional<TrackResult> predict(int64_t utime_us);

  // Returns a mask that leaves out pixels that never move. Pixels that a given mask leaves out are not examined.
  const ImageMask& still_mask() const { return still_parts_.mask(); }

  // Calls visit(FrontSubmap&) for all submaps, oldest first. Mapping cannot change them meanwhile.
  template <class Visit>
  void visit_submaps(Visit visit) {
    const std::scoped_lock lock(map_mutex_);
    for (const auto& submap : submaps_) visit(*submap);
  }
  // Returns all submaps, oldest first; the pointers stay valid. Mapping may change a submap at any time: call
  // wait_for_mapping() before reading one.
  const std::vector<std::unique_ptr<FrontSubmap>>& submaps() const { return submaps_; }
  void wait_for_mapping() { mapping_.wait_until_idle(); }
  // Returns the front submap in which tracking went on in this submap, in the same unit and frame of reference;
  // kNoSubmap if it began otherwise.
  int continued_from(int submap_id) const;
  // Returns how many keyframes' mapping threw since the last call, and why. Tracking goes on without their new
  // landmarks.
  Worker::Broken take_broken_mapping() { return mapping_.take_broken(); }
  // To be called when no more images come. Logs a loss that is still open.
  void end();
  const Camera& camera() const { return camera_; }
  int64_t session() const { return session_; }
  int64_t stream() const { return stream_; }

 private:
  using Images = std::shared_ptr<const ImagePyramid>;

  Images prepare(int64_t utime_us, const cv::Mat& grey, const ImageMask& mask);
  void forget_still_landmarks();

  // These look for the pose of an image. accept() makes it the start for the next image.
  TrackResult track_image(int64_t utime_us, const Images& images);
  std::optional<FoundPose> pose_without_corners(int64_t utime_us, const Images& images);
  Frame find_corners(int64_t utime_us, const Images& images);
  std::optional<FoundPose> pose_with_corners(Frame frame);
  std::optional<FoundPose> track_or_relocalize(Frame frame);
  FoundPose track(Frame frame);
  void lose(const FoundPose& pose);
  TrackResult accept(FoundPose pose);
  bool is_keyframe_due(const FoundPose& pose) const;
  // Adds the frame to the active submap. Returns it with its pose relative to the reference keyframe.
  Frame add_to_submap(Frame frame, bool as_keyframe);

  // These look for the camera in submaps, and make the submap in which they find it the active one.
  std::optional<FoundPose> relocalize_where_it_was(const Frame& frame);
  std::optional<FoundPose> relocalize_anywhere(const Frame& frame);
  std::optional<FoundPose> relocalize(size_t submap_index, int keyframe_id, const Frame& frame);
  std::optional<FoundPose> go_on_in_back_submap(const Frame& frame);
  FoundPose go_on_in(size_t submap_index, Frame found);
  // Withdraws the poses since a slip. `found` loses its matches with landmarks that only those frames had.
  void forget_slip(Frame* found);

  // These begin a submap.
  void wait_to_begin(const Frame& frame);
  std::optional<FoundPose> begin_submap(const Frame& frame);
  SubmapKey next_key() const { return {session_, static_cast<int32_t>(submaps_.size()) + 1}; }
  FrontSubmap& open_submap(Submap known);
  // If the active submap is full, lets tracking go on in a new one that begins with the keyframes around the camera.
  void leave_full_submap();
  void activate(size_t submap_index);  // lets tracking go on in this submap
  void add_to_index_and_map(const Keyframe& keyframe);

  FrontSubmap& active() { return *submaps_[active_]; }

  Camera camera_;
  TrackerOptions options_;
  int64_t session_, stream_;

  // These find a pose in an image.
  StillParts still_parts_;
  JointMask mask_;
  OrbExtractor extractor_;
  PoseByPatches by_patches_;
  PoseByCorners by_corners_;
  PastPoses past_poses_;
  Initializer initializer_;
  Relocalizer relocalizer_;
  BackSubmaps back_submaps_;

  // The submaps and what adds to them.
  std::mutex map_mutex_;
  std::vector<std::unique_ptr<FrontSubmap>> submaps_;
  std::map<int, int> continued_from_;  // see continued_from()
  size_t active_ = 0;  // index into submaps_ of the submap that is tracked, or while (RECENTLY_)LOST was tracked last;
                       // unused before the first submap
  KeyframePolicy keyframe_policy_;
  Mapper mapper_;
  std::vector<int> to_map_;  // new keyframes of the active submap; the mapper gets them after map_mutex_ is released

  // The state of tracking in the active submap.
  TrackingState state_ = TrackingState::kNotInitialized;
  MotionModel motion_;
  SupportHistory support_;
  PatchTemplates templates_;  // templates of the last frames
  LossReport loss_;
  int64_t first_utime_us_ = 0, last_utime_us_ = INT64_MIN;

  // How the last image changed the poses of earlier frames.
  std::vector<TrackResult> posed_afterwards_;
  std::vector<int64_t> withdrawn_;

  Worker mapping_;  // the last member, so that its thread ends before the others are destroyed
};

}  // namespace rumi::front_tracker
