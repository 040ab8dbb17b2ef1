// SPDX-License-Identifier: BSD-3-Clause
// Decides which frames belong to a rumination window: S = S1 + S2 + S3 in the paper, section IV.B and Fig. 4. It takes
// frames and returns windows, and does nothing else.
//
//   S1, approach    while tracked: the last `window_length` samples (every keyframe, and a frame per stride or turn of
//                   the camera, see stride_sampler.h), earlier keyframes up to `shared_keyframes` keyframes in all, and
//                   the last tracked frame
//   S2, gap         the frames from the loss until tracking resumes, thinned by image motion (gap_thinner.h)
//   S3, departure   after tracking resumed: samples as in S1, until the new submap has `shared_keyframes` keyframes
//
// Choices that the paper leaves open:
// - A window opens with the first untracked frame, even before the first submap (then it has no approach).
// - Late poses (front_tracker begins a submap or relocalizes) turn frames of the gap into departure if all later frames
//   have poses too. If no gap is left, the window goes on only if it connects two submaps.
// - Withdrawn poses (relocalization contradicts the frames before the loss) turn tracked frames into gap.
// - If the new submap has fewer than departure_min_keyframes keyframes at the next loss, it died young: its frames
//   become gap (and keep submap id, pose and keyframe flag), and the window goes on. Otherwise the window is complete,
//   and another one opens.
// - A known submap that is tracked again may need no new keyframes. So it has not died young either if it has
//   window_length samples; if it is the submap before the loss, these complete the window.
// - A camera that stands still makes no keyframes: kMaxDeparture samples complete the window in any case.
// - At the end of the input or of the session, the open window ends unfinished, with a reason.
//
//   phase      what comes                                        next phase
//   watching   a frame without a pose                            gap: a window opens
//              withdrawn poses of the submap tracked now         gap: a window opens with them
//   gap        a frame without a pose                            gap
//              a frame with a pose                               departure
//                ... that leaves no gap and connects no submaps  watching: the window is dropped
//                ... that has enough samples, with late poses    complete, watching
//   departure  a frame of the same submap                        departure; with enough samples: complete, watching
//              a frame of another known submap                   watching: the window ends
//              a frame without a pose, if the submap died young  gap: the same window
//                ... otherwise                                   gap: complete, and another window opens
//              withdrawn poses of the submap tracked now         gap: the same window
//   any        a frame of a new submap, right after one with   the same: it goes on from the last one, in whose unit
//              a pose                                          and frame of reference its samples are
//   any        another session, the end                          watching: the window ends
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "ruminator/window/gap_thinner.h"
#include "ruminator/window/image_motion.h"
#include "ruminator/window/rumination_window.h"
#include "ruminator/window/stride_sampler.h"
#include "ruminator/window/window_options.h"

namespace rumi::ruminator {

// A frame and its tracking state.
struct FrameEvent {
  int64_t utime_us = 0;
  int64_t session = 0;
  int64_t stream = 0;
  int32_t submap_id = kNoSubmap;  // submap in which the frame has a pose
  SE3 cam_from_submap = {};
  bool is_keyframe = false;
  bool has_image = true;  // a frame without an image changes the phase, but is never a sample
  ImageMeasure image = {};
};

class WindowSampler {
 public:
  explicit WindowSampler(const WindowOptions& options);

  // Takes the next frame, in order of time. Ignores and counts a frame that is not later than the last one, unless it
  // is a frame of the gap with a late pose, or a frame whose pose is withdrawn. Returns the window that this frame
  // completed or ended; nullopt if it did neither.
  std::optional<RuminationWindow> process(const FrameEvent& frame);
  // To be called at the end of the input. Returns the open window; nullopt if none is open.
  std::optional<RuminationWindow> finish(const std::string& reason);

  enum class Phase { kWatching, kGap, kDeparture };
  Phase phase() const { return !open_ ? Phase::kWatching : lost() ? Phase::kGap : Phase::kDeparture; }
  // The window that is being collected, or null.
  const RuminationWindow* open() const { return open_ ? &open_->window : nullptr; }
  // True if the open window is certain to be announced. Before the first submap it is not, because all its frames may
  // still get poses.
  bool is_settled() const { return open_ && (open_->window.submap_before != kNoSubmap || !lost()); }
  // True if the motion of this frame's image is needed.
  bool wants_measure(const FrameEvent& frame) const {
    return !is_late(frame) && (open_ || frame.submap_id == kNoSubmap);
  }
  // True for a frame that is not the newest: it is a repetition, or has a late or withdrawn pose.
  bool is_late(const FrameEvent& frame) const {
    return has_begun_ && frame.session == session_ && frame.utime_us <= last_utime_us_;
  }
  // Returns the times of the frames whose images must be kept, for the open window or for one that may open.
  std::set<int64_t> retained() const;
  // Halves the frames of the open window's gap; if that cannot be done, those kept in case the departure becomes gap.
  // Returns false if neither can be halved.
  bool thin_gap();
  int64_t ignored() const { return ignored_; }
  // Gives the next windows higher ids than `id`, because an earlier process has made windows of this session.
  void continue_after(int32_t id) { last_id_ = std::max(last_id_, id); }
  // The id of a window that is chosen elsewhere.
  int32_t take_id() { return ++last_id_; }

 private:
  struct LatePose {
    GapFrame frame;
    bool has_image = false;
  };
  struct Gap {
    std::vector<LatePose> late_poses;  // late poses since the loss, in order of arrival
  };
  struct Departure {
    StrideSampler samples;
    GapThinner all;  // all frames, which become gap if the submap dies young
    int frames = 0;
    bool in_known_submap = false;  // whether the submap was tracked before in this session
    void add(const GapFrame& frame, bool has_image);
  };
  struct Collecting {
    RuminationWindow window;
    StrideSampler before;         // the approach and earlier samples
    int64_t before_since_us = 0;  // first time of the uninterrupted tracking before the loss
    int64_t before_until_us = 0;  // first time after that tracking
    GapThinner gap;
    std::set<int64_t> untracked;  // newest frames of the gap without a pose, kept as samples or not
    double path_px = 0;           // see GapFrame
    std::variant<Gap, Departure> part;
  };
  Gap* lost() { return open_ ? std::get_if<Gap>(&open_->part) : nullptr; }
  const Gap* lost() const { return open_ ? std::get_if<Gap>(&open_->part) : nullptr; }
  Departure* departure() { return open_ ? std::get_if<Departure>(&open_->part) : nullptr; }

  std::optional<RuminationWindow> on_tracked(const FrameEvent& frame);
  std::optional<RuminationWindow> on_untracked(const FrameEvent& frame);
  bool on_late_pose(const FrameEvent& frame);
  bool on_withdrawn(int64_t utime_us);
  std::optional<GapFrame> take_from_approach(int64_t utime_us);
  void note_tracked(const FrameEvent& frame);
  void go_on_in(int32_t submap_id);  // the submap that goes on from the one tracked now
  void leave_submap();
  void begin_window(int64_t utime_us);
  void list_approach();
  void list_samples();  // sets the samples of gap and departure
  void resume(const FrameEvent& frame);
  void extend_window();                               // turns the departure into gap, because the new submap died young
  bool has_enough(const Departure& departure) const;  // false if the new submap died young
  bool is_complete(const Departure& departure) const;
  std::optional<RuminationWindow> close(const std::string& reason);
  void start_session(const FrameEvent& first);
  GapFrame measured(const FrameEvent& frame);

  WindowOptions options_;
  int64_t session_ = 0, stream_ = 0;
  int64_t last_utime_us_ = 0;
  bool has_begun_ = false;
  int32_t submap_ = kNoSubmap;       // submap of the last frame
  std::set<int32_t> known_submaps_;  // submaps tracked in this session
  int64_t tracked_since_us_ = 0;     // first time of the uninterrupted tracking in submap_
  StrideSampler approach_;           // samples of the frames tracked in submap_
  std::optional<Sample> last_tracked_;
  std::optional<Collecting> open_;
  int32_t last_id_ = 0;  // highest id of the windows that ended
  int64_t ignored_ = 0;
};

}  // namespace rumi::ruminator
