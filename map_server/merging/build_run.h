// SPDX-License-Identifier: BSD-3-Clause
// One build of the map after another, and all that it touches. run() belongs to the building thread; while it is under
// way nobody calls anything else.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "map_server/atlas/atlas.h"
#include "map_server/merging/build_input.h"
#include "map_server/merging/build_schedule.h"
#include "map_server/merging/link_finder.h"
#include "map_server/merging/map_builder.h"

namespace rumi::map_server {

struct MergeResult {
  Placements placements;        // empty: the map stays as it is
  std::set<SubmapKey> unmoved;  // these form it too, among them what is in doubt and was in it
  CulledSubmaps culled;         // these take the place of the submaps of the same keys, and are placed like them
  std::set<SubmapKey> same;     // those of the placements that are as they were
  std::vector<Link> links;
  MapBuildReport report;
  BuildScope scope = BuildScope::kWeld;
  double cpu_s = 0;
};

using SubmapCopies = std::map<SubmapKey, std::shared_ptr<const Submap>>;

class BuildRun {
 public:
  // `cancel` becomes true when a build that is under way shall return soon.
  BuildRun(const MapBuilderOptions& options, const std::atomic<bool>* cancel);

  // See BuildInput::fixed; `in_map`: those of them that the map has. Before the first build.
  void fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map);
  const std::set<SubmapKey>& fixed() const { return fixed_; }

  // 1. What the next build is made of; `fresh`: what of it was never built with.
  void set_submaps(SubmapCopies submaps, BuildScope scope, std::set<SubmapKey> fresh);
  // 2. Where that lies in the atlas. Returns placements that nobody needs any more: freeing them takes long.
  Placements set_places(const Atlas& atlas);
  // 3. Builds. Throws what a step throws; then blamed() are those that break off by themselves.
  void run();
  // 4. Takes the built map over, or, with the reason, gives it up because it does not fit what is in the atlas now.
  std::string take_over(const Atlas& atlas);
  // Then the result may be moved away.
  MergeResult& result() { return result_; }
  BuildSize size() const;  // of what the map was built of, as it was culled
  // 5. Lets go of what the build was made of; `gives_up`: of the result, too.
  void end(bool gives_up);
  std::set<SubmapKey> take_blamed() { return std::exchange(blamed_, {}); }

 private:
  void take_over_places(const Atlas& atlas);
  void note_what_is_the_same();
  std::set<SubmapKey> find_those_to_blame() const;
  void keep_what_was_left_out();

  MapBuilderOptions options_;
  LinkFinder finder_;
  const MapBuilder builder_;
  std::set<SubmapKey> fixed_;
  LinkGraph graph_;       // that of the last build that was taken over
  LinkGraph next_graph_;  // what the build made of graph_; later the one before graph_
  SubmapCopies submaps_;
  std::set<SubmapKey> fresh_;
  BuildInput input_;
  std::set<SubmapKey> left_in_map_;  // the build goes without them
  Placements to_be_placed_;          // copies of the result's placements, made in the building thread
  std::set<SubmapKey> blamed_;
  MergeResult result_;
};

}  // namespace rumi::map_server
