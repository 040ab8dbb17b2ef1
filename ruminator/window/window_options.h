// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::ruminator {

// How the frames of a rumination window are chosen (paper, section IV.B).
struct WindowOptions {
  int stride = 5;                   // frames from one sample to the next while tracked (paper: inter), at most
  double max_turn_deg = 5;          // the same as an angle: at a low frame rate a stride may leave nothing in common
  int window_length = 15;           // samples before the loss (paper: len); keyframes beyond it see shared_keyframes
  int shared_keyframes = 10;        // wanted on each side; a merge is the more accurate the more there are, up to that
  int departure_min_keyframes = 8;  // of the new submap (paper: Th_S3); lost again with fewer, it died young
  int departure_max_samples = 40;   // complete the window anyway, for a camera that stands still
  int gap_max_frames = 120;         // samples of the gap; beyond it they are thinned
  int gap_dense_frames = 120;       // samples of the gap that are kept whatever the motion: a small window costs little
  double gap_motion_px = 12;        // set point of the motion between samples of a thinned gap
  double gap_min_motion_px = 1.5;   // beyond, frames that moved less since the last sample add nothing
  double gap_max_step = 3;          // set points that dropping a blurred frame may leave between its neighbours
  double min_sharpness = 0.5;       // of the neighbours' median; frames below it are the first to be thinned out
};

}  // namespace rumi::ruminator
