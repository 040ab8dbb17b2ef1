// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::ruminator {

// How the frames of a rumination window are selected (paper, section IV.B).
struct WindowOptions {
  int stride = 5;             // most frames from one sample to the next while tracked (paper: inter)
  int window_length = 15;     // samples of the approach (paper: len); more if shared_keyframes needs earlier keyframes
  int shared_keyframes = 10;  // keyframes wanted on each side; up to this number, more make a merge more accurate
  int departure_min_keyframes = 8;  // the new submap died young if it is lost with fewer (paper: Th_S3)
  int gap_max_frames = 120;         // samples of the gap up to which all are kept; beyond it they are thinned by motion
};

// Motion of the picture between samples that a thinned gap should have, px.
constexpr double kGapMotionPx = 12;

}  // namespace rumi::ruminator
