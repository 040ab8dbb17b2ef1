// SPDX-License-Identifier: BSD-3-Clause
// Builds the map when it is due: in a thread of its own (live) or at once (replay), from copies of the submaps, so that
// the atlas may change meanwhile. A build that throws is refused: map and links stay as they are, and the next build
// goes without the submaps in doubt. BuildSchedule says when a build is due, Suspects of which submaps, and BuildRun
// owns all that the building thread touches. The states:
//
//   is_building_   worker        what tick() does
//   false          idle          begins a build if one is due
//   true           at work       nothing
//   true           idle again    accepts the result, or gives it up
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

// Says when and where the map is built.
struct MergeOptions {
  MapBuilderOptions builder;
  bool enabled = true;                // false: the map is the largest submap, a front one if there is any
  bool thread = true;                 // false: at once, as replay does
  double interval_s = 2;              // between two looks at what is new
  double adjustment_interval_s = 20;  // between two adjustments of the whole map, at least
  int nice = 10;                      // of the thread
};

class MapMerger {
 public:
  explicit MapMerger(const MergeOptions& options);
  ~MapMerger();  // gives up the build that is under way

  // See BuildInput::fixed. Fixed submaps that are not in the map stay out of it. Call it before the first tick().
  void fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map);
  // Begins a build if one is due, and returns the result of one that is done.
  std::optional<MergeResult> tick(int64_t now_us, const Atlas& atlas);
  // Makes builds due at once, until an adjustment of the whole map has begun with everything that is known now.
  void hurry() { schedule_.hurry(); }
  bool hurried() const { return schedule_.is_in_a_hurry() || suspects_.unfinished(); }
  // True if nothing is left to do and no build is under way.
  bool idle(const Atlas& atlas) const { return !is_building_ && schedule_.is_at_rest(needs_of(atlas)); }
  bool running() const { return is_building_; }
  // Frees placements in the building thread, because freeing takes long.
  void free(std::vector<Placement> placements);
  // The builds that threw.
  const Failures& refused() const { return refused_; }
  // True if the last build threw, or if submaps must still be tried or are left out because a build did.
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
