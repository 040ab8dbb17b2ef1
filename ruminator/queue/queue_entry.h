// SPDX-License-Identifier: BSD-3-Clause
// A window in the queue: where it lies, and how far it is.
//
//   state               what happens                            next state
//   Waiting             its turn comes                          Building
//   Building            a back submap is built                  Built
//                       the machine fails                       Waiting, until it is tried again
//                       it is cancelled, or the queue finishes  LeftForNextStart if it is in the spool, else removed
//                       the window cannot be rebuilt            removed
//   Built               nothing else is being sent              Sent
//   Sent                map_server has stored it                removed
//                       map_server refuses it                   Built, or LeftForNextStart if the queue finishes
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
  std::optional<Spool::Claim> claim;  // set while this process works on it
};
struct InMemory {
  std::shared_ptr<const WindowJob> job;  // null as soon as it is rebuilt
  std::string work_folder;               // set while it is rebuilt
};

struct Waiting {
  int64_t until_us = 0;  // it is not rebuilt before this time on the bus's clock
};
struct Building {
  BuildProgress progress = {};
};
struct Built {
  std::vector<uint8_t> submap = {};  // on the wire; empty: it is in the spool
  int64_t until_us = 0;              // it is not sent before this time
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
  double build_s = 0;  // time that all tries took
  std::string result;  // summary of the back submap, for the log
  std::string note;    // announced as the reason
  int64_t announced_us = 0;
  std::optional<int64_t> resumed_us;  // when tracking resumed, on the bus's clock, which goes on without images

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
  // Null if the window is in the spool.
  InMemory* memory() { return std::get_if<InMemory>(&place); }
  const InMemory* memory() const { return std::get_if<InMemory>(&place); }
  // Null if the window is in memory.
  InSpool* spooled() { return std::get_if<InSpool>(&place); }
  bool is_claimed() const;            // it is in the spool, and this process works on it
  bool is_due(int64_t now_us) const;  // it is Waiting or Built, and its time has come
  int64_t image_bytes() const;        // size of the images of a job in memory
  bool holds_submap() const;          // a back submap is in memory
  int8_t window_state() const;        // window_t::QUEUED, ...
};

}  // namespace rumi::ruminator
