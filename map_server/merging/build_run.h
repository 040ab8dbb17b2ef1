// SPDX-License-Identifier: BSD-3-Clause
// Builds one map after another, and owns all data of a build. The building thread calls only run(); until run()
// returns, no other thread may call anything here. A build passes these states, in this order:
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
  PlacedMap map;         // without placements if the map stays unchanged
  CulledSubmaps culled;  // submaps after culling, which replace those of the same keys and keep their placement
  std::vector<Link> links;
  MapBuildReport report;
  BuildScope scope = BuildScope::kWeld;
  double cpu_s = 0;
};

using SubmapCopies = std::map<SubmapKey, std::shared_ptr<const Submap>>;

class BuildRun {
 public:
  // `cancel`, `enough`: see BuildInput.
  BuildRun(const MapBuilderOptions& options, const std::atomic<bool>* cancel, const std::atomic<bool>* enough);

  // `all`: see BuildInput::fixed; `in_map`: those that are in the map. Call it before the first build.
  void fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map);
  const std::set<SubmapKey>& fixed() const { return fixed_; }

  // 1. Sets the input of the next build. `fresh`: submaps that no accepted build has had in this revision.
  void set_submaps(SubmapCopies submaps, BuildScope scope, std::set<SubmapKey> fresh);
  // 2. Sets where these submaps lie in the atlas. Returns placements that are no longer needed, which the caller may
  // free in another thread because that takes long.
  Placements set_places(const Atlas& atlas);
  // 3. Builds, in the building thread. Throws any exception of a step; then take_failing() returns the submaps that
  // fail alone.
  void run();
  // 4. Takes the built map over. An Error if it does not fit what is in the atlas now.
  Result<> take_over(const Atlas& atlas);
  // Returns the result, which may be moved away after take_over().
  MergeResult& result() { return result_; }
  BuildSize size() const;  // submaps and keyframes of the build, after culling, fixed ones apart
  // 5. Releases the input of the build and, if `gives_up`, its result.
  void end(bool gives_up);
  // Returns the submaps that were new in the last build and with which a build throws even alone.
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
  LinkGraph graph_;       // graph of the last build that was taken over
  LinkGraph next_graph_;  // graph of the running build; after take_over() the previous one, until run() frees it
  SubmapCopies submaps_;
  std::set<SubmapKey> fresh_;
  BuildInput input_;
  std::set<SubmapKey> left_out_in_map_;  // submaps of the map that this build leaves out
  Placements to_be_placed_;              // copy of the result's placements, made by run() because copying takes long
  std::set<SubmapKey> failing_;
  MergeResult result_;
};

}  // namespace rumi::map_server
