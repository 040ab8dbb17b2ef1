// SPDX-License-Identifier: BSD-3-Clause
// A window in the queue: where it lies, and how far it is.
//
//   state               what happens                        next state
//   Waiting             its turn has come                   Building
//   Building            a back submap                       Built
//                       no back submap, to be tried again   Waiting
//                       called off, or while ending         LeftForNextStart (in the spool), else failed: gone
//                       no back submap                      failed: gone
//   Built               nothing else is being sent          Sent
//   Sent                map_server has it                   gone
//                       map_server refuses it               Built, or LeftForNextStart while ending
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
  std::optional<Spool::Claim> claim;  // while this process works on it
};
struct InMemory {
  std::shared_ptr<const WindowJob> job;  // until it is rebuilt
  std::string work_folder;               // while it is rebuilt
};

struct Waiting {
  int64_t until_us = 0;  // not before, on the bus's clock
};
struct Building {
  BuildProgress progress = {};
};
struct Built {
  std::vector<uint8_t> submap = {};  // empty: it is in the spool
  int64_t until_us = 0;              // not sent before
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
  double build_s = 0;  // that they took
  std::string result;  // what rebuilding gave, for the log
  std::string note;    // announced as the reason
  int64_t announced_us = 0;
  std::optional<int64_t> resumed_us;  // when tracking resumed, on the bus's clock; images may end, this goes on

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
  // Null: it is in the spool, or in memory.
  InMemory* memory() { return std::get_if<InMemory>(&place); }
  const InMemory* memory() const { return std::get_if<InMemory>(&place); }
  InSpool* spooled() { return std::get_if<InSpool>(&place); }
  bool is_claimed() const;            // in the spool, and this process works on it
  bool is_due(int64_t now_us) const;  // Waiting or Built, and its time has come
  int64_t image_bytes() const;        // in memory
  bool holds_submap() const;          // in memory
  int8_t window_state() const;        // window_t::QUEUED, ...
};

}  // namespace rumi::ruminator
