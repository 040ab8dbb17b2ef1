// SPDX-License-Identifier: BSD-3-Clause
// When the map is built, and where: in a thread of its own (live) or at once (replay), of copies of the submaps, so
// that the atlas goes on changing meanwhile. A build that throws is refused: map and links stay as they are, and the
// next build goes without what is in doubt.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "base/due.h"
#include "base/failures.h"
#include "base/worker.h"
#include "map_server/atlas/atlas.h"
#include "map_server/merging/build_input.h"
#include "map_server/merging/link_finder.h"
#include "map_server/merging/map_builder.h"
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

struct MergeResult {
  Placements placements;        // empty: the map stays as it is
  std::set<SubmapKey> unmoved;  // form it too, among them what is in doubt and was in it
  CulledSubmaps culled;         // take the place of these; placed like that
  std::set<SubmapKey> same;     // of the placements, those that are as they were
  std::vector<Link> links;
  MapBuildReport report;
  BuildScope scope = BuildScope::kWeld;
  double cpu_s = 0;
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
  void hurry() { hurry_ = true; }
  bool hurried() const { return hurry_ || suspects_.unfinished(); }
  // Nothing is left to do, and nothing under way.
  bool idle(const Atlas& atlas) const {
    return !running_ && !wants_adjustment_ && !suspects_.unfinished() && !has_news(atlas);
  }
  bool running() const { return running_; }
  // Frees them where the map is built: that takes long.
  void free(std::vector<Placement> placements);
  // Builds that threw.
  const Failures& refused() const { return refused_; }
  // The last build threw, or submaps are still to be tried or left out because one did.
  bool in_doubt() const { return last_broke_off_ || suspects_.unfinished() || !suspects_.left_out().empty(); }
  std::set<SubmapKey> left_out() const { return suspects_.left_out(); }

 private:
  using Copies = std::map<SubmapKey, std::shared_ptr<const Submap>>;
  bool has_news(const Atlas& atlas) const;
  bool is_settled(const Atlas& atlas) const;
  void note_adjusted();
  std::optional<BuildScope> due(int64_t now_us, const Atlas& atlas) const;
  void begin(BuildScope scope, int64_t now_us, const Atlas& atlas);
  void copy_submaps(const Atlas& atlas);
  void choose(BuildScope scope);
  void take_over_places(const Atlas& atlas);
  void note_places(const Atlas& atlas);
  void run();
  std::set<SubmapKey> find_those_to_blame() const;
  std::optional<MergeResult> end(const Atlas& atlas);
  void keep_what_was_left_out();
  void give_up(const std::string& reason);

  MergeOptions options_;
  std::atomic<bool> cancel_ = false;
  LinkFinder finder_;
  const MapBuilder builder_;
  LinkGraph graph_;  // of the last build that was taken over
  std::set<SubmapKey> fixed_;
  // Of the submaps, and of where they lay, when the last build began.
  Copies copies_, chosen_;           // all, and those it is made of
  BuildInput input_;                 // what was chosen, and where that lay
  LinkGraph next_graph_;             // that the build made of graph_; else the one before graph_
  Placements to_be_placed_;          // copies of the last result, made where it was
  std::set<SubmapKey> left_in_map_;  // not chosen
  Suspects suspects_;
  std::set<SubmapKey> to_blame_;  // that the last build threw
  Failures refused_{"a build of the map"};
  bool last_broke_off_ = false;
  int64_t now_us_ = 0;
  bool running_ = false, hurry_ = false, hurried_ = false;  // hurried_: the last build was
  bool wants_adjustment_ = false;  // something changed since all of the whole map was adjusted (BuildScope::kAll)
  int64_t last_begin_us_ = kNever_us, last_adjustment_us_ = kNever_us;
  size_t adjusted_submaps_ = 0, adjusted_keyframes_ = 0;  // that there were when the whole map was adjusted last
  int views_ = 0;                                         // of the map as it was built last
  MergeResult result_;
  Worker worker_;  // last: its thread ends first
};

}  // namespace rumi::map_server
