// SPDX-License-Identifier: BSD-3-Clause
// The map of a running system, and tracking over time, for the page: the viewer's copies of the submaps, as JSON and as
// blobs.
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

  // watched: somebody looks at the page; else map_server is not asked for submaps and no blobs are made.
  void tick(int64_t now_us, bool watched);

  // The map as it was at the last change that was looked at (at most a second ago): "up", "camera", "submaps" (each
  // with a version, which rises when its blob changes), "merges".
  const std::string& map() const { return map_; }
  // "first" and "end" (seconds), "tracked": [from, to, state, submap], "placed": [from, to, submap], "lost": [from,
  // to]; times in seconds since "first", submaps by their place in map().
  const std::string& timeline() const { return timeline_; }
  // The last frame that was tracked or not: "state", "at", "turn" (map_from_cam; missing where it has no pose).
  nlohmann::ordered_json pose() const;
  // The blob (see submap_blob.h) of the submap that map() names so; null if there is no such submap.
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
