// SPDX-License-Identifier: BSD-3-Clause
// The map of a running system and tracking over time, for the page: copies of the submaps as the viewer keeps them, as
// JSON and as blobs.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/running/due.h"
#include "bus/process/newest_sender.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/track_t.hpp"
#include "viewer_offscreen/live/frame_notes.h"
#include "viewer_offscreen/live/submap_copies.h"

namespace rumi::tool {

class LiveMap {
 public:
  explicit LiveMap(Bus& bus);

  // watched: somebody looks; else nothing is asked of map_server, and nothing is made.
  void tick(int64_t now_us, bool watched);

  // What there is to see, as it was at the last change that was looked at (a second ago at most).
  // "up", "camera", "submaps" (each with a version, which rises when its blob is another one), "merges".
  const std::string& map() const { return map_; }
  // "first" and "end" (seconds), "tracked": [from, to, state, submap], "placed": [from, to, submap], "lost": [from,
  // to]; times in seconds since "first", submaps by their place in map().
  const std::string& timeline() const { return timeline_; }
  // The last frame that was tracked or not: "state", "at", "turn" (map_from_cam; missing where it has no pose).
  nlohmann::ordered_json pose() const;
  // Of a submap by the name that map() gives it (see submap_blob.h); nothing: there is none.
  std::shared_ptr<const std::string> blob(const std::string& name) const;

 private:
  struct Shown {
    int64_t taken = -1;
    viewer_offscreen::SubmapView view;  // without its landmarks
    std::shared_ptr<const std::string> blob;
  };
  void on_track(const track_t& track);
  void refresh();
  std::vector<viewer_offscreen::SubmapView> views();

  Bus& bus_;
  NewestSender sessions_{""};
  viewer_offscreen::SubmapCopies copies_;
  viewer_offscreen::FrameNotes frames_;
  std::optional<track_t> latest_;
  std::map<SubmapKey, Shown> shown_;
  std::string map_ = "{}", timeline_ = "{}";
  bool changed_ = true;
  int64_t refreshed_us_ = kNever_us;
};

}  // namespace rumi::tool
