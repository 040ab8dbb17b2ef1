// SPDX-License-Identifier: BSD-3-Clause
// Keeps copies of all submaps of the atlas, as they lie in the map. Follows RUMI_MAP_STATUS, and requests from
// map_server what is missing or has changed.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/process/newest_sender.h"
#include "bus/transfer/chunked_transfer.h"
#include "bus/wire/map_overview.h"
#include "lcmtypes/rumi/track_t.hpp"
#include "slam/map/submap.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

class SubmapCopies {
 public:
  struct Copy {
    Submap submap;
    int64_t placement_revision = 0;  // placement of this copy; 0: it is in its own gauge
    submap_summary_t summary;        // what map_server reported on it last
    int64_t taken = 0;               // number of updates that came in
    int32_t request_id = 0;          // the request that is not answered yet; 0: none
    int64_t asked_us = 0, asked_placement_revision = 0;
    // A submap that was not moved in the map has the map's gauge already, so only its new elements have to be sent.
    int64_t wanted_placement_revision() const { return summary.in_map ? summary.placement_revision : 0; }
    bool up_to_date() const {
      return submap.revision >= summary.revision && placement_revision == wanted_placement_revision();
    }
    // True if it is in the map and this copy has the map's gauge, though perhaps an older placement.
    bool can_be_shown_in_map() const {
      return summary.in_map && (placement_revision == 0) == (summary.placement_revision == 0);
    }
  };

  // `requester` is a name that no other process has. `changed` is called when there is something new to show.
  SubmapCopies(Bus& bus, const std::string& requester, std::function<void()> changed);

  // Returns false, and ignores the status, if it is much older than the newest one: then it comes from another
  // map_server.
  bool take(const map_status_t& status);
  void tick(int64_t now_us) { receiver_.tick(now_us); }
  // Requests what is missing or has changed. A placed submap is always sent whole, so it is requested only
  // `whole_pause_us` after the last request.
  void request_missing(int64_t now_us, int64_t whole_pause_us);
  // True if the copies of all submaps that map_server has reported are up to date.
  bool complete() const;

  const std::map<SubmapKey, Copy>& by_key() const { return copies_; }
  const MapOverview& overview() const { return map_; }
  // Returns the submaps and links for make_scene().
  MapPicture picture() const;
  // Returns the camera's pose in the map for a tracked frame; nullopt if its submap is not in the map.
  std::optional<SE3> map_from_cam(const track_t& track) const;

 private:
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload);
  bool is_time_to_ask(const Copy& copy, int64_t now_us, int64_t whole_pause_us) const;

  Bus& bus_;
  std::string requester_;
  std::function<void()> changed_;
  NewestSender map_states_{"RUMI_MAP_STATUS", kLateUs};
  ChunkReceiver receiver_;
  MapOverview map_;
  std::map<SubmapKey, Copy> copies_;
  int32_t last_request_ = 0;
};

}  // namespace rumi::viewer_offscreen
