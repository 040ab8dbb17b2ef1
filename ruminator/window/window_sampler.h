// SPDX-License-Identifier: BSD-3-Clause
// Which frames belong to a rumination window: S = S1 + S2 + S3 of the paper, section IV.B and Fig. 4. Pure logic:
// frames in, windows out.
//
//   S1, approach    while tracked: the last `window_length` samples (every keyframe, and a frame per stride or turn of
//                   the camera, see stride_sampler.h), the keyframes before them up to `shared_keyframes`, and the very
//                   last frame
//   S2, gap         the frames from the loss until tracking resumes, thinned by image motion (gap_thinner.h)
//   S3, departure   after resuming: samples as in S1, until `shared_keyframes` keyframes of the new submap are there
//
// Choices that the paper leaves open:
// - A window opens with the first untracked frame, also before the first submap (then there is no approach).
// - front_tracker gives poses to earlier frames when it begins a submap or finds the camera again, and tells of them
//   again. These are not gap but departure, if all frames after them have poses too. A window of which no gap is left
//   goes on if it connects two submaps; else there is nothing to rebuild, and it is as if it had never opened.
// - front_tracker withdraws poses where it is found again at a place that contradicts the frames before the loss, and
//   tells of these again, without a pose. They are gap: the window's, or of one that opens with them.
// - A new submap that is lost again with fewer than departure_min_keyframes died young: its frames count as gap (but
//   keep the young submap's id, pose and keyframe flag), and the loss extends the same window. So losses a moment apart
//   are one window. Lost with more, but before shared_keyframes, the window is complete, and the loss opens another:
//   waiting for more keyframes costs no submap its life.
// - A submap that had been left and is tracked again (relocalization) may need no new keyframes: it is lost too soon
//   with fewer than window_length samples. If it is the one before the loss, nothing needs to be connected, and so many
//   samples complete the window.
// - A camera that stands still makes no keyframes: kMaxDeparture samples complete the window.
// - What is open when the input ends, or front_tracker starts again, ends as it is, with a reason.
//
//   phase      what comes                                        next phase
//   watching   a frame without a pose                            gap: a window opens
//              poses of the submap that is tracked withdrawn     gap: a window opens with them
//   gap        a frame without a pose                            gap
//              a frame with a pose                               departure
//                that leaves no gap, and connects no two submaps   watching: the window never opened
//   departure  a frame of the same submap                        departure; with enough samples: complete, watching
//              a frame of another submap                         watching: the window ends
//              a frame without a pose, where few were tracked    gap: the same window
//                ... and where enough were                       gap: complete, and another window opens
//              poses since it began withdrawn                    gap: the same window
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

// What became of a frame.
struct FrameEvent {
  int64_t utime_us = 0;
  int64_t session = 0;
  int64_t stream = 0;
  int32_t submap_id = kNoSubmap;  // that it has a pose in
  SE3 cam_from_submap = {};
  bool is_keyframe = false;
  bool has_image = true;  // without it the frame changes the state but is no sample
  ImageMeasure image = {};
};

class WindowSampler {
 public:
  explicit WindowSampler(const WindowOptions& options);

  // Takes the next frame, in order of time. One that is not later than the last is ignored and counted, unless it is a
  // frame of the gap that has a pose now, or one that has none any more. Returns the window that this frame completed
  // or ended, if any.
  std::optional<RuminationWindow> process(const FrameEvent& frame);
  // The input has ended: the open window, if any.
  std::optional<RuminationWindow> finish(const std::string& reason);

  enum class Phase { kWatching, kGap, kDeparture };
  Phase phase() const { return !open_ ? Phase::kWatching : lost() ? Phase::kGap : Phase::kDeparture; }
  // The window that is collecting now, or null.
  const RuminationWindow* open() const { return open_ ? &open_->window : nullptr; }
  // Is it certain that the open window will end as one? A start may yet get all its poses.
  bool is_settled() const { return open_ && (open_->window.submap_before != kNoSubmap || !lost()); }
  // Would the motion of this frame's image make a difference?
  bool wants_measure(const FrameEvent& frame) const {
    return !is_late(frame) && (open_ || frame.submap_id == kNoSubmap);
  }
  // It belongs to the past: it is a repetition, or got or lost its pose afterwards.
  bool is_late(const FrameEvent& frame) const {
    return has_begun_ && frame.session == session_ && frame.utime_us <= last_utime_us_;
  }
  // Frames whose images must be kept: for the open window, or for one that may open.
  std::set<int64_t> retained() const;
  // Halves the gap of the open window, and the density of what follows; false if there is nothing to halve.
  bool thin_gap();
  int64_t ignored() const { return ignored_; }
  // The next window's id will be higher: an earlier process made windows of this session.
  void continue_after(int32_t id) { last_id_ = std::max(last_id_, id); }
  // The id of a window that is chosen elsewhere.
  int32_t take_id() { return ++last_id_; }

 private:
  struct LatePose {
    GapFrame frame;
    bool has_image = false;
  };
  struct Gap {
    std::vector<LatePose> late_poses;  // since the loss, in order of arrival
  };
  struct Departure {
    StrideSampler samples;
    GapThinner all;  // every frame: gap, should the submap die young
    int frames = 0;
    bool in_known_submap = false;  // one that had been left
    void add(const GapFrame& frame, bool has_image);
  };
  struct Collecting {
    RuminationWindow window;
    StrideSampler before;         // the approach, and what was before it
    int64_t before_since_us = 0;  // tracked without a break since then ...
    int64_t before_until_us = 0;  // ... and until before this
    GapThinner gap;
    std::set<int64_t> untracked;  // the newest frames of the gap that have no pose, thinned out or not
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
  void leave_submap();
  void begin_window(int64_t utime_us);
  void list_approach();
  void list_samples();  // of gap and departure
  void resume(const FrameEvent& frame);
  void extend_window();                               // lost again too soon
  bool has_enough(const Departure& departure) const;  // not to have died young
  bool is_complete(const Departure& departure) const;
  std::optional<RuminationWindow> close(const std::string& reason);
  void start_session(const FrameEvent& first);
  GapFrame measured(const FrameEvent& frame);  // of the open window

  WindowOptions options_;
  int64_t session_ = 0, stream_ = 0;
  int64_t last_utime_us_ = 0;
  bool has_begun_ = false;
  int32_t submap_ = kNoSubmap;       // that the last frame was tracked in
  std::set<int32_t> known_submaps_;  // of this session
  int64_t tracked_since_us_ = 0;     // without a break, in submap_
  StrideSampler approach_;           // of submap_
  std::optional<Sample> last_tracked_;
  std::optional<Collecting> open_;
  int32_t last_id_ = 0;  // of the windows that ended
  int64_t ignored_ = 0;
};

}  // namespace rumi::ruminator
