// SPDX-License-Identifier: BSD-3-Clause
// Keeps copies of all submaps of the atlas, as they lie in the map: it follows RUMI_MAP_STATUS and requests from
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
    int64_t placement_revision = 0;  // of our copy; 0: the copy is in its own gauge
    submap_summary_t summary;        // what map_server said of it last
    int64_t taken = 0;               // the number of updates that came in
    int32_t request_id = 0;          // the request that is under way; 0: none
    int64_t asked_us = 0, asked_placement_revision = 0;
    // A submap that nobody has placed has the map's gauge already, so only its new elements have to be sent.
    int64_t wanted_placement_revision() const { return summary.in_map ? summary.placement_revision : 0; }
    bool up_to_date() const {
      return submap.revision >= summary.revision && placement_revision == wanted_placement_revision();
    }
    // True if it is in the map and our copy has the map's gauge, though perhaps an older placement.
    bool can_be_shown_in_map() const {
      return summary.in_map && (placement_revision == 0) == (summary.placement_revision == 0);
    }
  };

  // `requester`: a name that no other process has. `changed` is called when there is something new to show.
  SubmapCopies(Bus& bus, const std::string& requester, std::function<void()> changed);

  // Returns false, and ignores the status, if it is of another, older map_server.
  bool take(const map_status_t& status);
  void tick(int64_t now_us) { receiver_.tick(now_us); }
  // `whole_pause_us`: a placed submap is sent whole, so it is requested no more often than that.
  void request_missing(int64_t now_us, int64_t whole_pause_us);
  // True if no submap of the last status is missing.
  bool complete() const;

  const std::map<SubmapKey, Copy>& by_key() const { return copies_; }
  const MapOverview& overview() const { return map_; }
  // The submaps and links of the input of make_scene().
  MapPicture picture() const;
  // The camera's pose in the map for a tracked frame, if its submap is part of the map.
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
