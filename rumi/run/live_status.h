// SPDX-License-Identifier: BSD-3-Clause
// The state of a running system, from the messages that its processes send anyway.
#pragma once

#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "bus/process/newest_sender.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/map_status_t.hpp"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "lcmtypes/rumi/window_t.hpp"

namespace rumi::tool {

class LiveStatus {
 public:
  // Begins to listen. The bus must be dispatched.
  explicit LiveStatus(Bus& bus);

  // Returns "processes" (by name), "tracking", "map" and "windows". A part is missing if no message on it was heard.
  // Rates are those of the last seconds; CPU time per frame is over everything heard.
  nlohmann::ordered_json to_json() const;
  // Returns the content of to_json() for a person. Lines have at most 100 characters, except for what processes say.
  std::string to_text() const;

 private:
  struct Process {
    NewestSender states{"", kLateUs};
    process_status_t latest;
    std::optional<process_status_t> before;
    // The first status of this run of the process, and how many frames had been tracked by then.
    process_status_t first;
    int64_t frames_at_first = 0, frames_at_latest = 0;
    int64_t frames() const { return frames_at_latest - frames_at_first; }
  };
  void on_status(const process_status_t& status);
  void on_track(const track_t& track);
  nlohmann::ordered_json process_json(const Process& process) const;
  nlohmann::ordered_json stages_json(const Process& process) const;
  nlohmann::ordered_json tracking_json() const;
  nlohmann::ordered_json map_json() const;
  nlohmann::ordered_json windows_json() const;

  Bus& bus_;
  NewestSender sessions_{""}, map_states_{"", kLateUs};
  std::map<std::string, Process> processes_;
  struct Heard {
    int64_t at_us = 0;
    track_t track;
  };
  std::deque<Heard> tracks_;  // tracks of the last seconds
  int64_t frames_ = 0;        // number of frames heard of
  std::optional<map_status_t> map_;
  std::map<std::pair<int64_t, int32_t>, window_t> windows_;  // by session and id
};

}  // namespace rumi::tool
