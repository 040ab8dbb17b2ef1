// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/build_run.h"

#include <algorithm>
#include <utility>

#include "base/running/failures.h"
#include "base/this_process/cpu_clock.h"

namespace rumi::map_server {

BuildRun::BuildRun(const MapBuilderOptions& options, const std::atomic<bool>* cancel)
    : options_(options), finder_(options.links), builder_(options) {
  input_.cancel = cancel;
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
  input_.preferred = atlas.present();
  take_over_places(atlas);
  left_in_map_.clear();
  for (const auto& [key, owner] : atlas.submaps()) {
    const bool is_placed = owner.in_map && owner.placement.revision > 0;
    if (is_placed && !submaps_.contains(key)) left_in_map_.insert(key);
    if (!is_placed || !submaps_.contains(key))
      input_.placed.erase(key);
    else if (Placement& place = input_.placed[key]; place.revision != owner.placement.revision)
      place = owner.placement;
    if (!owner.is_kept() || !submaps_.contains(key))
      input_.kept.erase(key);
    else if (Placement& place = input_.kept[key]; place.revision != owner.placement.revision)
      place = owner.placement;
  }
  return std::exchange(to_be_placed_, {});
}

// The atlas has the last result by now, under a revision of its own. Nobody else places.
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
    Atlas::check_numbers(built.placements, built.unmoved);
  } catch (...) {
    blamed_ = find_those_to_blame();
    throw;
  }
  result_ = {.placements = std::move(built.placements),
             .unmoved = std::move(built.unmoved),
             .culled = std::move(built.culled),
             .same = {},
             .links = built.graph.links(),
             .report = built.report,
             .scope = input_.scope,
             .cpu_s = thread_cpu_s() - start_s};
  next_graph_ = std::move(built.graph);
  note_what_is_the_same();
  to_be_placed_ = result_.placements;
}

void BuildRun::note_what_is_the_same() {
  for (const auto& [key, placement] : result_.placements)
    for (const auto* where : {&input_.placed, &input_.kept})
      if (const auto before = where->find(key); before != where->end() && same_place(before->second, placement))
        result_.same.insert(key);
}

// Most likely something is wrong with one submap: then it is not to be built with by itself either.
std::set<SubmapKey> BuildRun::find_those_to_blame() const {
  std::set<SubmapKey> found;
  for (const SubmapKey& key : fresh_) {
    const BuildInput alone{
        .submaps = {{key, submaps_.at(key).get()}}, .scope = BuildScope::kOnTheWay, .cancel = input_.cancel};
    const std::string reason = thrown_by([&] { builder_.build(LinkFinder(options_.links).find({}, alone), alone); });
    if (!reason.empty()) found.insert(key);
  }
  return found;
}

std::string BuildRun::take_over(const Atlas& atlas) {
  keep_what_was_left_out();
  std::string reason = thrown_by([&] {
    atlas.check_links(result_.links);
    atlas.check_here(result_.placements, result_.unmoved);
  });
  if (!reason.empty()) return reason;
  std::swap(graph_, next_graph_);  // the one before is freed in the building thread
  for (const auto& [key, submap] : result_.culled) submaps_[key] = submap;
  return {};
}

// In the map as it is. What was built elsewhere does not take its place: nobody knows how large it would be with all of
// its submaps.
void BuildRun::keep_what_was_left_out() {
  if (left_in_map_.empty() || result_.placements.empty()) return;
  const auto is_placed = [this](const auto& item) { return input_.placed.contains(item.first); };
  if (std::any_of(result_.placements.begin(), result_.placements.end(), is_placed)) {
    result_.unmoved.insert(left_in_map_.begin(), left_in_map_.end());
  } else {
    result_.placements.clear();
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
