// SPDX-License-Identifier: BSD-3-Clause
// A window in the queue: where its data are, and its state.
//
//   state      what happens                               next state
//   Waiting    its turn comes                             Building
//              another process works on it                removed
//   Building   a back submap is built                     Built
//              the machine fails                          Waiting, until it is tried again
//              it is cancelled, or the machine fails and  LeftForNextStart if it is in the spool, else removed
//              nothing is tried again (finish(), stop())
//              the window cannot be rebuilt               removed
//   Built      nothing else is being sent                 Sent
//   Sent       map_server has stored it                   removed
//              map_server refuses it                      Built, or LeftForNextStart after finish()
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "ruminator/queue/spool.h"
#include "ruminator/rebuild/back_submap_builder.h"
#include "ruminator/window/rumination_window.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

struct InSpool {
  std::optional<Spool::Claim> claim;  // set while this process works on the window
};
struct InMemory {
  std::shared_ptr<const WindowJob> job;  // null once it is rebuilt
  std::string work_folder;               // folder of the latest try
};

struct Waiting {
  int64_t until_us = 0;  // earliest time to rebuild the window, on the bus's clock
};
struct Building {
  BuildProgress progress = {};
};
struct Built {
  std::vector<uint8_t> submap = {};  // encoded message; empty if it is in the spool
  int64_t until_us = 0;              // earliest time to send it, on the bus's clock
};
struct Sent {
  Built built;
};
struct LeftForNextStart {
  bool is_built = false;
};

int8_t window_state(BuildStage stage);  // window_t::EXTRACTING, ...

struct QueueEntry {
  JobName name;
  RuminationWindow window;
  std::variant<InSpool, InMemory> place;
  std::variant<Waiting, Building, Built, Sent, LeftForNextStart> state;
  int tries = 0;
  double build_s = 0;  // wall time of all tries
  std::string result;  // summary of the back submap, for the log
  std::string note;    // reason, as announced with the state
  int64_t announced_us = 0;
  std::optional<int64_t> resumed_us;  // when tracking resumed, on the bus's clock, which also runs without images

  template <class State>
  bool is() const {
    return std::holds_alternative<State>(state);
  }
  template <class State>
  State* as() {
    return std::get_if<State>(&state);
  }
  template <class State>
  const State* as() const {
    return std::get_if<State>(&state);
  }
  // Returns null if the window is in the spool.
  InMemory* memory() { return std::get_if<InMemory>(&place); }
  const InMemory* memory() const { return std::get_if<InMemory>(&place); }
  // Returns null if the window is in memory.
  InSpool* spooled() { return std::get_if<InSpool>(&place); }
  bool is_claimed() const;            // the window is in the spool, and this process works on it
  bool is_due(int64_t now_us) const;  // the window is Waiting or Built, and its time has come
  int64_t image_bytes() const;        // size of the job's images if it is in memory; otherwise 0
  bool holds_submap() const;          // an encoded back submap is in memory
  int8_t window_state() const;        // window_t::QUEUED, ...
};

}  // namespace rumi::ruminator
