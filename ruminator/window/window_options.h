// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::ruminator {

// How the frames of a rumination window are chosen (paper, section IV.B).
struct WindowOptions {
  int stride = 5;                   // frames from one sample to the next while tracked, at most (paper: inter)
  int window_length = 15;           // samples before the loss (paper: len); keyframes beyond it see shared_keyframes
  int shared_keyframes = 10;        // wanted on each side; up to this number, more make a merge more accurate
  int departure_min_keyframes = 8;  // of the new submap (paper: Th_S3); if it is lost again with fewer, it died young
  int gap_max_frames = 120;         // samples of the gap that are kept whatever the motion; beyond it they are thinned
};

// The motion aimed at between samples of a thinned gap.
constexpr double kGapMotionPx = 12;

}  // namespace rumi::ruminator
