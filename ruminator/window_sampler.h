// SPDX-License-Identifier: BSD-3-Clause
// Which frames belong to a rumination window: S = S1 + S2 + S3 of the paper, section IV.B and Fig. 4. Pure logic:
// frames in, windows out.
//
//   S1, approach    while tracked, every `stride` frames, the last `window_length` of them, and the very last frame
//   S2, gap         every frame from the loss until tracking resumes; beyond gap_max_frames evenly thinned
//   S3, departure   after resuming, every `stride` frames, until the new submap has departure_min_keyframes keyframes
//
// Choices that the paper leaves open:
// - A window opens with the first untracked frame, also before the first submap (then there is no approach).
// - A new submap that is lost again before its window is complete died young: its frames count as gap (samples
//   keep the young submap's id, pose and keyframe flag), and the loss extends the same window. So losses a moment apart
//   are one window.
// - A submap that had been left and is tracked again (relocalization) needs no new keyframes: window_length samples
//   complete the window. Lost before that, the window ends as it is and the new loss opens another: the old submap does
//   connect the two.
// - A camera that stands still makes no keyframes: departure_max_samples complete the window.
// - What is open when the input ends, or front_tracker starts again, ends as it is, with a reason.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ruminator/options.h"
#include "ruminator/rumination_window.h"
#include "ruminator/stride_sampler.h"

namespace rumi {

// What became of a frame.
struct FrameEvent {
  int64_t utime_us = 0;
  int64_t session = 0;
  int32_t submap_id = kNoSubmap;  // that it has a pose in
  SE3 cam_from_submap = {};
  bool is_keyframe = false;
  bool has_image = true;  // without it the frame changes the state but is no sample
};

class WindowSampler {
 public:
  explicit WindowSampler(const WindowOptions& options);

  // Takes the next frame, in order of time; one that is not later than the last is ignored and counted. Returns the
  // window that this frame completed or ended, if any.
  std::optional<RuminationWindow> process(const FrameEvent& frame);
  // The input has ended: the open window, if any.
  std::optional<RuminationWindow> finish(const std::string& reason);

  // The window that is collecting now.
  const std::optional<RuminationWindow>& open() const { return open_; }
  // Frames whose images must be kept: for the open window, or for one that may open.
  std::set<int64_t> retained() const;
  // Halves the gap of the open window, and the density of what follows; false if there is nothing to halve.
  bool thin_gap();
  int64_t ignored() const { return ignored_; }

 private:
  std::optional<RuminationWindow> on_tracked(const FrameEvent& frame);
  std::optional<RuminationWindow> on_untracked(const FrameEvent& frame);
  void begin_window(const FrameEvent& frame);
  void extend_window();  // the new submap died young
  void add_to_gap(const Sample& frame);
  bool is_complete() const;
  std::optional<RuminationWindow> close(const std::string& reason);
  void start_session(int64_t session);

  WindowOptions options_;
  int64_t session_ = 0;
  int64_t last_utime_us_ = 0;
  bool has_begun_ = false;
  int32_t submap_ = kNoSubmap;       // that the last frame was tracked in
  std::set<int32_t> known_submaps_;  // of this session
  StrideSampler approach_;           // of submap_
  std::optional<Sample> last_tracked_;

  std::optional<RuminationWindow> open_;
  StrideSampler departure_;
  std::vector<Sample> since_resume_;  // every frame: gap, should the submap die young
  int keyframes_since_resume_ = 0;
  bool resumed_in_known_ = false;
  int gap_stride_ = 1, gap_phase_ = 0;
  int32_t last_id_ = 0;
  int64_t ignored_ = 0;
};

}  // namespace rumi
