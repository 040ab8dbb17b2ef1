// SPDX-License-Identifier: BSD-3-Clause
// A running system at a glance, from the messages that it sends anyway.
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
  // Listens from now on; the bus must be dispatched.
  explicit LiveStatus(Bus& bus);

  // "processes": by name, "tracking", "map", "windows". A part is missing if nothing was heard of it. Rates are those
  // of the latest seconds; CPU time per frame is over everything heard.
  nlohmann::ordered_json to_json() const;
  // As to_json(), for a person, in lines of at most 100 characters except for the words of processes.
  std::string to_text() const;

 private:
  struct Process {
    NewestSender states{"", kLateUs};
    process_status_t latest;
    std::optional<process_status_t> before;
    // The first message of this run of the process: its status, and the frames tracked so far.
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
  std::deque<Heard> tracks_;  // of the latest seconds
  int64_t frames_ = 0;        // heard in all
  std::optional<map_status_t> map_;
  std::map<std::pair<int64_t, int32_t>, window_t> windows_;  // by session and id
};

}  // namespace rumi::tool
