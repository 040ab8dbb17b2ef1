// SPDX-License-Identifier: BSD-3-Clause
// Builds the map when that is due: in a thread of its own (live) or at once (replay), from copies of the submaps, so
// that the atlas may change meanwhile. The result of a build that throws is discarded: map and links stay unchanged,
// and the next build leaves out the submaps in doubt. BuildSchedule decides when to build, Suspects from which submaps,
// and BuildRun owns all data that the building thread uses. The states:
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

// When and in which thread the map is built.
struct MergeOptions {
  MapBuilderOptions builder;
  bool enabled = true;                // false: the map is the largest submap, a front one if there is one
  bool thread = true;                 // false: builds at once, as in a replay
  double interval_s = 2;              // least time from one build to the next, s
  double adjustment_interval_s = 20;  // least time from one adjustment of the whole map to the next, s
  double final_s = 10;  // a build in a hurry (the last, or before a snapshot) adjusts for so long at most, s
  int nice = 10;        // nice value of the thread
};

class MapMerger {
 public:
  explicit MapMerger(const MergeOptions& options);
  ~MapMerger();  // gives up the running build

  // Sets the fixed submaps (see BuildInput::fixed) before the first tick(). Those that are not in the map stay out of
  // it.
  void fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map);
  // Begins a build if one is due, and returns the result of one that is done.
  std::optional<MergeResult> tick(int64_t now_us, const Atlas& atlas);
  // Makes builds due at once, until an adjustment of the whole map has begun with everything known now.
  void hurry() { schedule_.hurry(); }
  bool hurried() const { return schedule_.is_in_a_hurry() || suspects_.unfinished(); }
  // True if there is nothing left to build and no build is running.
  bool idle(const Atlas& atlas) const { return !is_building_ && schedule_.is_at_rest(needs_of(atlas)); }
  bool running() const { return is_building_; }
  // Frees placements in the building thread, because freeing takes long.
  void free(std::vector<Placement> placements);
  // Builds that threw.
  const Failures& refused() const { return refused_; }
  // True if the last build threw, or if because of a failed build submaps must still be tried or are left out.
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
  std::atomic<bool> cancel_ = false, enough_ = false;  // see BuildInput
  SubmapCopies copies_;                                // all submaps, at their revisions when the last build began
  Suspects suspects_;
  BuildSchedule schedule_;
  BuildRun run_;  // belongs to the worker while is_building_
  bool is_building_ = false;
  bool is_in_a_hurry_ = false;  // whether the build began in a hurry
  int64_t begun_us_ = 0;
  bool last_broke_off_ = false;
  Failures refused_{"a build of the map"};
  int64_t now_us_ = 0;
  Worker worker_;  // the last member: its thread ends before the others are destroyed
};

}  // namespace rumi::map_server
