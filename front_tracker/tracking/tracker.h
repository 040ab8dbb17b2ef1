// SPDX-License-Identifier: BSD-3-Clause
// The front process without its messages: images in, a state and a pose for each, an atlas of submaps.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/worker.h"
#include "front_tracker/frame/front_submap.h"
#include "front_tracker/initialization/initializer.h"
#include "front_tracker/mapping/mapper.h"
#include "front_tracker/patches/patch_templates.h"
#include "front_tracker/relocalization/back_submaps.h"
#include "front_tracker/relocalization/relocalizer.h"
#include "front_tracker/tracking/loss.h"
#include "front_tracker/tracking/tracker_options.h"
#include "slam/map/tracking_state.h"

namespace rumi::front_tracker {

struct TrackResult {
  int64_t utime_us = 0;
  TrackingState state = TrackingState::kNotInitialized;
  int submap_id = kNoSubmap;  // kNoSubmap: no pose
  int64_t submap_revision = 0;
  int reference_keyframe = kNone;
  SE3 cam_from_keyframe, cam_from_submap;
  PoseSigmas sigmas;
  bool is_keyframe = false;
  int keypoints = 0, inliers = 0;
};

class Tracker {
 public:
  // The camera is that of the images given to process(). `session` goes into the submaps' keys, `stream` is that of the
  // images.
  Tracker(const Camera& camera, const TrackerOptions& options, int64_t session, int64_t stream = 0);

  // Images in order of time; one that is not newer than the last is refused (nothing). 8-bit grey, of the camera's
  // size.
  std::optional<TrackResult> process(int64_t utime_us, const cv::Mat& grey);

  // Earlier frames that got their poses because the last image began a submap or was found again, in order of time;
  // else empty.
  const std::vector<TrackResult>& posed_afterwards() const { return posed_afterwards_; }

  // Earlier frames whose poses turned out to be wrong when the last image was found again, in order of time; else
  // empty. No submap has them any more.
  const std::vector<int64_t>& withdrawn() const { return withdrawn_; }

  // A back submap of this session, to relocalize in where front submaps do not tell. Found in it, tracking goes on in a
  // new front submap that begins as a copy of it: same unit, same images. Returns why it was refused, or an empty
  // string.
  std::string add_back_submap(Submap submap) { return back_submaps_.add(std::move(submap)); }
  void remove_back_submap(int id) { back_submaps_.remove(id); }
  const BackSubmaps& back_submaps() const { return back_submaps_; }

  // All submaps, oldest first; the pointers stay valid. Hold the mutex while looking at them.
  const std::vector<std::unique_ptr<FrontSubmap>>& submaps() const { return submaps_; }
  std::mutex& mutex() { return map_mutex_; }
  void wait_for_mapping() { mapping_.wait_until_idle(); }
  // Keyframes whose mapping broke off since the last call: tracking goes on without what it would have found.
  Worker::Broken take_broken_mapping() { return mapping_.take_broken(); }
  // No more images come: says what is lost still.
  void end();
  const Camera& camera() const { return camera_; }

 private:
  // A keyframe that the mapper has to be told of, once the map's mutex is free.
  using MappingTask = std::pair<FrontSubmap*, int>;
  struct Support {
    int64_t utime_us = 0;
    int inliers = 0;
    double log_scale_variance = 0;  // see PoseCertainty
  };

  Frame find_corners(int64_t utime_us, const ImagePyramid& images, int keypoints);
  bool follow(int64_t utime_us, const std::shared_ptr<const ImagePyramid>& images, TrackResult* result);
  bool track(Frame* frame);
  bool look_again(Frame* frame);
  void predict_pose(Frame* frame);
  void note_motion(const Frame& frame);
  bool match_last_frame(Frame* frame);
  bool match_regardless_of_place(Frame* frame);
  bool patches_may_help(const Frame& frame, int inliers) const;
  bool match_local_map(Frame* frame);
  int support_by_epipolar_matches(Frame* frame);
  bool relocalize(size_t submap_index, int keyframe_id, Frame* frame);
  bool relocalize_anywhere(Frame* frame);
  bool is_certain(Frame* frame, int* inliers);
  bool drifts(const Frame& frame) const;
  std::vector<const Landmark*> local_landmarks(Frame* frame);
  bool needs_keyframe(const Frame& frame) const;
  double motion_since_last_frame(const Frame& frame) const;
  bool recover(Frame* frame);
  bool go_on_in_back_submap(Frame* frame);
  void activate(size_t submap_index);  // it is the one that is tracked from now on
  void go_on_in(size_t submap_index, Frame* frame);
  bool is_torn(const Frame& found) const;
  std::deque<Support>::const_iterator slip_begins() const;
  void withdraw_torn_end(Frame* found);
  FrontSubmap& open_submap(Submap known);
  bool begin_submap(Frame* frame);
  void add_initial_map(InitialMap map, FrontSubmap* submap);
  bool pose_from_neighbour(const Frame& neighbour, const std::vector<const Landmark*>& landmarks, double max_image_px,
                           Frame* frame);
  PoseCertainty certainty_where_it_is(const Frame& posed);
  void give_poses_afterwards(std::vector<Frame>* frames, std::vector<bool>* posed);
  void track_back(const Frame& found, std::deque<Frame> frames);
  void lose(const Frame& frame);
  void follow_loss(const TrackResult& result);
  void accept(Frame frame, TrackResult* result);
  void record_pose(FrontSubmap* submap, const Frame& frame);
  void note_pose(const FrontSubmap& submap, const Frame& frame, TrackResult* result) const;
  void note_pose_afterwards(const Frame& frame);
  FrontSubmap& active() { return *submaps_[active_]; }

  Camera camera_;
  TrackerOptions options_;
  int64_t session_, stream_;
  OrbExtractor extractor_;
  std::vector<double> scales_;
  Initializer initializer_;
  Relocalizer relocalizer_;
  BackSubmaps back_submaps_;
  PatchTemplates templates_;  // of the last frame
  Mapper mapper_;
  std::mutex map_mutex_;
  std::vector<std::unique_ptr<FrontSubmap>> submaps_;
  std::vector<MappingTask> tasks_;
  std::vector<TrackResult> posed_afterwards_;
  std::vector<int64_t> withdrawn_;

  std::string why_lost_;  // the last frame that was not tracked

  TrackingState state_ = TrackingState::kNotInitialized;
  size_t active_ = 0;           // index into submaps_, while TRACKING or RECENTLY_LOST
  std::deque<Support> recent_;  // frames tracked in the active submap, that may yet turn out to be wrong
  Frame last_;                  // last tracked frame
  SE3 velocity_;                // this_cam_from_last_cam
  int64_t velocity_dt_us_ = 0;
  int64_t first_utime_us_ = 0;
  int64_t last_utime_us_ = INT64_MIN;
  std::optional<Loss> loss_;          // while it is not over
  int64_t found_us_ = INT64_MIN / 2;  // when it was last found again after it was LOST
  int64_t last_keyframe_us_ = 0;
  int64_t last_corners_us_ = 0;      // of the last image that corners were looked for in
  double motion_since_corners_ = 0;  // of the images since then, of their width
  Worker mapping_;                   // last: its thread ends first
};

}  // namespace rumi::front_tracker
