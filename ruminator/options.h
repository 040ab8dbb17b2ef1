// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/command_line/options.h"
#include "ruminator/queue/rebuild_queue.h"
#include "ruminator/window/window_options.h"

namespace rumi::ruminator {

struct RuminatorOptions : RebuildQueueOptions {
  WindowOptions window;
  std::string camera_file;  // calibration to use in place of the images'; empty: none
  int again_images = 1000;  // most images of all windows by place; 0: there are none
};

inline void describe(OptionTable& table, RuminatorOptions& o) {
  describe(table, o.build);
  WindowOptions& w = o.window;
  table.group("window");
  table.add("ruminator.stride", &w.stride, "frames", "from one sample to the next while tracked, at most (inter)", 1,
            1000);
  table.add("ruminator.window_length", &w.window_length, "frames", "samples kept from before a loss (len)", 1, 1000);
  table.add("ruminator.shared_keyframes", &w.shared_keyframes, "keyframes",
            "of front_tracker wanted among the samples before and after", 0, 1000);
  table.add("ruminator.departure_min_keyframes", &w.departure_min_keyframes, "keyframes",
            "of the new submap (Th_S3); lost again with fewer, its frames are gap", 1, 1000);
  table.add("ruminator.gap_max_frames", &w.gap_max_frames, "frames",
            "samples of the gap, the first ones whatever the motion; beyond it they are thinned", 2, 100000);
  table.group("queue");
  table.add("ruminator.ring_mb", &o.ring_mb, "MB", "images kept in memory", 1, 100000);
  table.add("ruminator.max_queued_windows", &o.max_queued_windows, "", "complete windows that wait for rebuilding", 1,
            1000);
  table.add("ruminator.camera_file", &o.camera_file, "calibration; empty: the one that comes with the images");
  table.add("ruminator.rebuild", &o.rebuild, "rebuild the windows; false: only announce them");
  table.add("ruminator.again_images", &o.again_images, "images",
            "rebuilt again at the end of a replay, at most, because the map lacks them or they look like what it lacks "
            "(about 1 s of CPU time each); 0: none",
            0, 1000000);
  table.add("ruminator.spool", &o.spool,
            "folder where windows wait, and are found again after a restart; empty: in memory (replay always)");
  table.add("ruminator.failed_mb", &o.failed_mb, "MB", "windows that could not be rebuilt are kept up to this size", 0,
            1000000);
  table.add("ruminator.build_tries", &o.build_tries, "", "of a window, where the machine and not the window fails", 1,
            1000);
  table.add("ruminator.retry_s", &o.retry_s, "s", "to the next try of rebuilding, or of sending to map_server", 0.1,
            86400);
  table.for_users({"ruminator.colmap", "ruminator.camera_file", "ruminator.rebuild", "ruminator.again_images",
                   "ruminator.spool", "ruminator.ring_mb", "ruminator.failed_mb"});
}

}  // namespace rumi::ruminator
