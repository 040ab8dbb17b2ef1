// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::ruminator {

// How the frames of a rumination window are chosen (paper, section IV.B).
struct WindowOptions {
  int stride = 5;                   // from one sample to the next while tracked (paper: inter), at most
  int window_length = 15;           // samples before the loss (paper: len); keyframes beyond it see shared_keyframes
  int shared_keyframes = 10;        // wanted on each side; a merge is the more accurate the more there are, up to that
  int departure_min_keyframes = 8;  // of the new submap (paper: Th_S3); lost again with fewer, it died young
  int gap_max_frames = 120;         // samples of the gap, whatever the motion; beyond it they are thinned
};

// Set point of the motion between samples of a thinned gap.
constexpr double kGapMotionPx = 12;

}  // namespace rumi::ruminator
