// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bus/options.h"
#include "ruminator/build_options.h"

namespace rumi {

// How the frames of a rumination window are chosen (paper, section IV.B).
struct WindowOptions {
  int stride = 5;                   // frames from one sample to the next while tracked (paper: inter)
  int window_length = 10;           // samples before the loss (paper: len)
  int departure_min_keyframes = 8;  // keyframes of the new submap that end the window (paper: Th_S3)
  int departure_max_samples = 40;   // or this many samples, for a camera that stands still
  int gap_max_frames = 300;         // more are thinned to every 2nd, 4th, ...
};

struct RuminatorOptions {
  WindowOptions window;
  BuildOptions build;
  int ring_mb = 256;            // images kept in memory
  int jpeg_quality = 95;        // of kept images that came uncompressed
  int max_queued_windows = 16;  // complete windows that wait; beyond it the oldest is dropped
  double match_wait_s = 0.5;    // how long the state of a frame waits for its image
};

inline void describe(OptionTable& table, RuminatorOptions& o) {
  describe(table, o.build);
  WindowOptions& w = o.window;
  table.add("ruminator.stride", &w.stride, "frames", "from one sample to the next while tracked (inter)", 1, 1000);
  table.add("ruminator.window_length", &w.window_length, "frames", "samples kept from before a loss (len)", 1, 1000);
  table.add("ruminator.departure_min_keyframes", &w.departure_min_keyframes, "keyframes",
            "of the new submap, then the window is complete (Th_S3)", 1, 1000);
  table.add("ruminator.departure_max_samples", &w.departure_max_samples, "frames",
            "samples after resuming that complete the window anyway", 1, 10000);
  table.add("ruminator.gap_max_frames", &w.gap_max_frames, "frames", "samples of the gap; beyond it they are thinned",
            2, 100000);
  table.add("ruminator.ring_mb", &o.ring_mb, "MB", "images kept in memory", 1, 100000);
  table.add("ruminator.jpeg_quality", &o.jpeg_quality, "", "of kept images that came uncompressed", 1, 100);
  table.add("ruminator.max_queued_windows", &o.max_queued_windows, "", "complete windows that wait for rebuilding", 1,
            1000);
  table.add("ruminator.match_wait_s", &o.match_wait_s, "s", "how long the state of a frame waits for its image", 0, 60);
}

}  // namespace rumi
