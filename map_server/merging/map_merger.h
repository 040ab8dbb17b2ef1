// SPDX-License-Identifier: BSD-3-Clause
// When the map is built, and where: in a thread of its own (live) or at once (replay), of copies of the submaps, so
// that the atlas goes on changing meanwhile. A build that throws is refused: map and links stay as they are, and the
// next build goes without what is in doubt.
#pragma once

#include <atomic>
#include <optional>
#include <set>
#include <vector>

#include "base/running/failures.h"
#include "base/running/worker.h"
#include "map_server/atlas/atlas.h"
#include "map_server/merging/build_run.h"
#include "map_server/merging/build_schedule.h"
#include "map_server/merging/suspects.h"

namespace rumi::map_server {

// When the map is built.
struct MergeOptions {
  MapBuilderOptions builder;
  bool enabled = true;                // false: the map is the largest submap, a front one if there is any
  bool thread = true;                 // false: at once, as replay does
  double interval_s = 2;              // from one look at what is new to the next
  double adjustment_interval_s = 20;  // from one adjustment of the whole map to the next, at least
  int nice = 10;                      // of the thread
};

class MapMerger {
 public:
  explicit MapMerger(const MergeOptions& options);
  ~MapMerger();  // gives up what is under way

  // See BuildInput::fixed. What is fixed and not in the map stays out of it. Before the first tick().
  void fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map);
  // Begins what is due and returns what is done.
  std::optional<MergeResult> tick(int64_t now_us, const Atlas& atlas);
  // Everything that is known now and left to do is due at once, until an adjustment of the whole map has begun with it.
  void hurry() { schedule_.hurry(); }
  bool hurried() const { return schedule_.is_in_a_hurry() || suspects_.unfinished(); }
  // Nothing is left to do, and nothing under way.
  bool idle(const Atlas& atlas) const { return !is_building_ && schedule_.is_at_rest(needs_of(atlas)); }
  bool running() const { return is_building_; }
  // Frees them where the map is built: that takes long.
  void free(std::vector<Placement> placements);
  // Builds that threw.
  const Failures& refused() const { return refused_; }
  // The last build threw, or submaps are still to be tried or left out because one did.
  bool in_doubt() const { return last_broke_off_ || suspects_.unfinished() || !suspects_.left_out().empty(); }
  std::set<SubmapKey> left_out() const { return suspects_.left_out(); }

 private:
  BuildNeeds needs_of(const Atlas& atlas) const;
  void begin(BuildScope scope, int64_t now_us, const Atlas& atlas);
  void copy_submaps(const Atlas& atlas);
  void choose(BuildScope scope);
  std::optional<MergeResult> end(const Atlas& atlas);
  MergeResult accept();
  void give_up(const std::string& reason);

  MergeOptions options_;
  std::atomic<bool> cancel_ = false;
  SubmapCopies copies_;  // all submaps as they were when the last build began
  Suspects suspects_;
  BuildSchedule schedule_;
  BuildRun run_;  // belongs to the worker while is_building_
  bool is_building_ = false;
  bool last_broke_off_ = false;
  Failures refused_{"a build of the map"};
  int64_t now_us_ = 0;
  Worker worker_;  // last: its thread ends first
};

}  // namespace rumi::map_server
