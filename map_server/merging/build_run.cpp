// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/build_run.h"

#include <algorithm>
#include <utility>

#include "base/or_throw.h"
#include "base/running/failures.h"
#include "base/this_process/cpu_clock.h"

namespace rumi::map_server {

BuildRun::BuildRun(const MapBuilderOptions& options, const std::atomic<bool>* cancel, const std::atomic<bool>* enough)
    : options_(options), finder_(options.links), builder_(options) {
  input_.cancel = cancel;
  input_.enough = enough;
}

void BuildRun::fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map) {
  fixed_ = std::move(all);
  input_.fixed = graph_.built.submaps = in_map;
}

void BuildRun::set_submaps(SubmapCopies submaps, BuildScope scope, std::set<SubmapKey> fresh) {
  submaps_ = std::move(submaps);
  fresh_ = std::move(fresh);
  input_.scope = scope;
  input_.submaps.clear();
  for (const auto& [key, copy] : submaps_) input_.submaps[key] = copy.get();
}

Placements BuildRun::set_places(const Atlas& atlas) {
  input_.present = atlas.present();
  take_over_places(atlas);
  left_out_in_map_.clear();
  for (const auto& [key, owner] : atlas.submaps()) {
    const bool is_placed = owner.in_map && owner.placement.revision > 0;
    if (is_placed && !submaps_.contains(key)) left_out_in_map_.insert(key);
    if (!is_placed || !submaps_.contains(key))
      input_.placed.erase(key);
    else if (Placement& place = input_.placed[key]; place.revision != owner.placement.revision)
      place = owner.placement;
    if (!owner.is_beside() || !submaps_.contains(key))
      input_.beside.erase(key);
    else if (Placement& place = input_.beside[key]; place.revision != owner.placement.revision)
      place = owner.placement;
  }
  return std::exchange(to_be_placed_, {});
}

// Adopts the placements of the last result, with the revisions that the atlas has given them. Nobody else places these
// submaps until the next build is accepted.
void BuildRun::take_over_places(const Atlas& atlas) {
  for (auto& [key, placement] : to_be_placed_) {
    const AtlasSubmap* owner = atlas.find(key);
    if (!owner || !owner->in_map) continue;
    placement.revision = owner->placement.revision;
    std::swap(input_.placed[key], placement);
  }
}

void BuildRun::run() {
  const double start_s = thread_cpu_s();
  BuiltMap built;
  try {
    built = builder_.build(finder_.find(graph_, input_), input_);
    result_.map = or_throw(PlacedMap::make(std::move(built.placements), std::move(built.unmoved)));
  } catch (...) {
    failing_ = find_failing();
    throw;
  }
  result_.map.note_same(find_same(result_.map.placements()));
  result_.culled = std::move(built.culled);
  result_.links = built.graph.links();
  result_.report = built.report;
  result_.scope = input_.scope;
  result_.cpu_s = thread_cpu_s() - start_s;
  next_graph_ = std::move(built.graph);
  to_be_placed_ = result_.map.placements();
}

std::set<SubmapKey> BuildRun::find_same(const Placements& placements) const {
  std::set<SubmapKey> same;
  for (const auto& [key, placement] : placements)
    for (const auto* where : {&input_.placed, &input_.beside})
      if (const auto before = where->find(key); before != where->end() && same_place(before->second, placement))
        same.insert(key);
  return same;
}

// Returns the new submaps with which a build fails even if it has no other submap: most likely one of them is broken.
std::set<SubmapKey> BuildRun::find_failing() const {
  std::set<SubmapKey> found;
  for (const SubmapKey& key : fresh_) {
    const BuildInput alone{
        .submaps = {{key, submaps_.at(key).get()}}, .scope = BuildScope::kOnTheWay, .cancel = input_.cancel};
    const std::string reason = thrown_by([&] { builder_.build(LinkFinder(options_.links).find({}, alone), alone); });
    if (!reason.empty()) found.insert(key);
  }
  return found;
}

Result<> BuildRun::take_over(const Atlas& atlas) {
  keep_left_out();
  if (const Result<> fits = atlas.check(result_.map, result_.links); !fits) return fits;
  std::swap(graph_, next_graph_);  // the next run() frees the old graph
  for (const auto& [key, submap] : result_.culled) submaps_[key] = submap;
  return {};
}

// Submaps left out of the build keep their place in the map. If no submap of the served map is in the built one, the
// built map is discarded: with the left-out submaps the served map might have been the larger one.
void BuildRun::keep_left_out() {
  const Placements& placements = result_.map.placements();
  if (left_out_in_map_.empty() || placements.empty()) return;
  const auto is_placed = [this](const auto& item) { return input_.placed.contains(item.first); };
  if (std::any_of(placements.begin(), placements.end(), is_placed)) {
    result_.map.add_unmoved(left_out_in_map_);
  } else {
    result_.map = {};
    result_.culled.clear();
    to_be_placed_.clear();
  }
}

BuildSize BuildRun::size() const {
  BuildSize size;
  for (const auto& [key, submap] : submaps_) {
    if (fixed_.contains(key)) continue;
    ++size.submaps;
    size.keyframes += submap->keyframes.size();
  }
  return size;
}

void BuildRun::end(bool gives_up) {
  if (gives_up) {
    result_ = {};
    to_be_placed_.clear();
  }
  input_.submaps.clear();
  submaps_.clear();
}

}  // namespace rumi::map_server
