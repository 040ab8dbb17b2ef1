// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_merger.h"

#include <malloc.h>

#include <memory>
#include <utility>

#include "base/memory/file_memory.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "base/text/time_units.h"

namespace rumi::map_server {

MapMerger::MapMerger(const MergeOptions& options)
    : options_(options),
      schedule_(options.interval_s, options.adjustment_interval_s),
      run_(options.builder, &cancel_, &enough_),
      worker_(options.thread, options.nice) {}

MapMerger::~MapMerger() { cancel_ = enough_ = true; }

void MapMerger::fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map) { run_.fix(std::move(all), in_map); }

BuildNeeds MapMerger::needs_of(const Atlas& atlas) const {
  BuildNeeds needs{.untried = suspects_.unfinished()};
  for (const auto& [key, owner] : atlas.submaps()) {
    const int64_t revision = owner.submap.revision;
    if (run_.fixed().contains(key)) continue;
    needs.has_news = needs.has_news || (options_.enabled && !suspects_.is_done(key, revision, now_us_));
    if (suspects_.is_left_out(key, revision, now_us_)) continue;
    ++needs.size.submaps;
    needs.size.keyframes += owner.submap.keyframes.size();
  }
  return needs;
}

std::optional<MergeResult> MapMerger::tick(int64_t now_us, const Atlas& atlas) {
  now_us_ = now_us;
  if (is_building_ && schedule_.is_in_a_hurry()) enough_ = true;  // the next build is the last
  if (is_building_ && is_in_a_hurry_ && is_due(now_us, begun_us_, to_us(options_.final_s))) enough_ = true;
  if (is_building_) return worker_.pending() == 0 ? end(atlas) : std::nullopt;
  const BuildNeeds needs = needs_of(atlas);
  const auto scope = schedule_.due(needs, now_us);
  if (!scope) {
    schedule_.rest(needs);
    return std::nullopt;
  }
  begin(*scope, now_us, atlas);
  return options_.thread ? std::nullopt : end(atlas);
}

void MapMerger::begin(BuildScope scope, int64_t now_us, const Atlas& atlas) {
  {
    const StageClock clock("map_server.copy");
    copy_submaps(atlas);
    choose(scope);
    worker_.post([before = std::make_shared<Placements>(run_.set_places(atlas))] {});
  }
  enough_ = false;
  is_in_a_hurry_ = schedule_.is_in_a_hurry();
  begun_us_ = now_us;
  schedule_.begun(scope, now_us);
  is_building_ = true;
  worker_.post([this] { run_.run(); });
}

// Copies only submaps that have changed. While halves of the new submaps are tried, it copies nothing, because all
// tries must use the same revisions.
void MapMerger::copy_submaps(const Atlas& atlas) {
  if (suspects_.unfinished()) return;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (run_.fixed().contains(key) && !owner.in_map) continue;
    std::shared_ptr<const Submap>& copy = copies_[key];
    if (!copy || copy->revision != owner.submap.revision) copy = std::make_shared<const Submap>(owner.submap);
  }
}

void MapMerger::choose(BuildScope scope) {
  Suspects::Revisions revisions;
  for (const auto& [key, copy] : copies_)
    if (!run_.fixed().contains(key)) revisions[key] = copy->revision;
  revisions = suspects_.choose(revisions, scope, now_us_);
  SubmapCopies chosen;
  for (const auto& [key, copy] : copies_)
    if (run_.fixed().contains(key) || revisions.contains(key)) chosen[key] = copy;
  run_.set_submaps(std::move(chosen), scope, suspects_.fresh());
}

std::optional<MergeResult> MapMerger::end(const Atlas& atlas) {
  is_building_ = false;
  std::string reason = worker_.take_broken().reason;
  if (cancel_) return std::nullopt;
  if (reason.empty()) reason = run_.take_over(atlas).error_text();
  last_broke_off_ = !reason.empty();
  if (!last_broke_off_) return accept();
  give_up(reason);
  return std::nullopt;
}

MergeResult MapMerger::accept() {
  MergeResult& result = run_.result();
  suspects_.built();
  for (const auto& [key, submap] : result.culled) {  // so that the culled submap causes no further build
    copies_[key] = submap;
    suspects_.replaced(key, submap->revision);
  }
  schedule_.built(result.scope, result.report.members, result.report.views, run_.size());
  run_.end(false);
  return std::move(result);
}

void MapMerger::give_up(const std::string& reason) {
  run_.end(true);
  refused_.note(reason, now_us_);
  const std::set<SubmapKey> before = left_out();
  schedule_.broke_off(suspects_.broke_off(run_.take_failing(), now_us_));
  if (left_out() != before) log_warning("the map is built without {} until changed", describe(left_out()));
}

void MapMerger::free(std::vector<Placement> placements) {
  worker_.post([placements = std::make_shared<std::vector<Placement>>(std::move(placements))]() mutable {
    placements.reset();
    FileMemory::of_process().let_go();
    malloc_trim(0);  // an adjustment leaves many small free blocks, together as large as all other memory
  });
}

}  // namespace rumi::map_server
