// SPDX-License-Identifier: BSD-3-Clause
// The map of a running system and the history of tracking, for the page: the viewer's copies of the submaps as JSON and
// as blobs.
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

  // watched: somebody looks at the page. Otherwise map_server is not asked for submaps, and nothing new is made.
  void tick(int64_t now_us, bool watched);

  // Returns the map as of the last tick with a change, at most once a second: "up", "camera", "submaps" (each with a
  // version, which rises when its blob changes), "merges".
  const std::string& map() const { return map_; }
  // Returns the history of tracking: "first" (seconds since the epoch), "end", "tracked": [from, to, state, submap],
  // "placed": [from, to, submap], "lost": [from, to], ... All other times are in seconds since "first"; a submap is its
  // index in map().
  const std::string& timeline() const { return timeline_; }
  // Returns the last frame: "state" and "submap", and if it has a pose, "at" and "turn" (map_from_cam). Empty before
  // the first frame.
  nlohmann::ordered_json pose() const;
  // Returns the blob (see submap_blob.h) of the submap that has this name in map(); null if there is no such submap.
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
