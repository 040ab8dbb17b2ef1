// SPDX-License-Identifier: BSD-3-Clause
// Builds one map after another, and owns all that a build touches. The building thread calls run() and nothing else;
// until run() is over nobody calls anything else here. A build passes these states, in the order of the calls:
//
//   state      call                          who calls it
//   chosen     set_submaps(), set_places()   the node's thread
//   built      run()                         the building thread; or it throws, and the build ends with end(true)
//   accepted   take_over(), result()         the node's thread; or there is an Error, and it ends with end(true)
//   ended      end(false)                    the node's thread
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
  PlacedMap map;         // without placements: the map stays as it is
  CulledSubmaps culled;  // they replace the submaps of the same keys, and are placed like them
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

  // See BuildInput::fixed; `in_map`: the fixed submaps that are in the map. Call it before the first build.
  void fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map);
  const std::set<SubmapKey>& fixed() const { return fixed_; }

  // 1. Sets what the next build is made of; `fresh`: the submaps that no accepted build had in this revision.
  void set_submaps(SubmapCopies submaps, BuildScope scope, std::set<SubmapKey> fresh);
  // 2. Sets where these submaps lie in the atlas. Returns placements that nobody needs any more: freeing them takes
  // long.
  Placements set_places(const Atlas& atlas);
  // 3. Builds, in the building thread. Throws what a step throws; then take_failing() says which submaps fail alone.
  void run();
  // 4. Takes the built map over. An Error if it does not fit what is in the atlas now.
  Result<> take_over(const Atlas& atlas);
  // After take_over() the result may be moved away.
  MergeResult& result() { return result_; }
  BuildSize size() const;  // the submaps and keyframes that the map was built of, after culling
  // 5. Lets go of what the build was made of; `gives_up`: of the result, too.
  void end(bool gives_up);
  // Submaps that were new in the last build and make a build throw even when it has nothing else.
  std::set<SubmapKey> take_failing() { return std::exchange(failing_, {}); }

 private:
  void take_over_places(const Atlas& atlas);
  std::set<SubmapKey> find_same(const Placements& placements) const;
  std::set<SubmapKey> find_failing() const;
  void keep_left_out();

  MapBuilderOptions options_;
  LinkFinder finder_;
  const MapBuilder builder_;
  std::set<SubmapKey> fixed_;
  LinkGraph graph_;       // the graph of the last build that was taken over
  LinkGraph next_graph_;  // while a build runs: its graph; afterwards: the previous graph, kept until run() frees it
  SubmapCopies submaps_;
  std::set<SubmapKey> fresh_;
  BuildInput input_;
  std::set<SubmapKey> left_out_in_map_;  // submaps of the map that this build goes without
  Placements to_be_placed_;              // copy of the result's placements, made by run() because copying takes long
  std::set<SubmapKey> failing_;
  MergeResult result_;
};

}  // namespace rumi::map_server
