// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_merger.h"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "base/cpu_clock.h"
#include "base/due.h"
#include "base/stage_clock.h"

namespace rumi::map_server {
namespace {

int64_t to_us(double seconds) { return std::llround(1e6 * seconds); }

// From one adjustment of the whole map to the next, at least, for each image of it.
constexpr double kAdjustmentSPerView = 0.25;
// An adjustment of a map that is much as it was at the last one waits so many times as long.
constexpr double kSettledPeriods = 4;
constexpr double kSettledShare = 0.05;  // of the keyframes, more or fewer

}  // namespace

MapMerger::MapMerger(const MergeOptions& options) : options_(options), builder_(options.builder, &cancel_) {}

MapMerger::~MapMerger() {
  cancel_ = true;
  if (thread_.joinable()) thread_.join();
}

void MapMerger::fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map) {
  fixed_ = std::move(all);
  builder_.fix(in_map);
}

bool MapMerger::has_news(const Atlas& atlas) const {
  if (!options_.enabled) return false;
  return std::any_of(atlas.submaps().begin(), atlas.submaps().end(), [this](const auto& item) {
    if (fixed_.contains(item.first)) return false;
    const auto copy = copies_.find(item.first);
    return copy == copies_.end() || copy->second->revision != item.second.submap.revision;
  });
}

// In a place that is known, keyframes are corrected and replaced all the time, and the map stays what it was.
bool MapMerger::is_settled(const Atlas& atlas) const {
  size_t submaps = 0, keyframes = 0;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (fixed_.contains(key)) continue;
    ++submaps;
    keyframes += owner.submap.keyframes.size();
  }
  const double change = std::abs(static_cast<double>(keyframes) - static_cast<double>(adjusted_keyframes_));
  return submaps == adjusted_submaps_ && change <= kSettledShare * static_cast<double>(adjusted_keyframes_);
}

void MapMerger::note_adjusted() {
  adjusted_submaps_ = adjusted_keyframes_ = 0;
  for (const auto& [key, submap] : copies_) {
    if (fixed_.contains(key)) continue;
    ++adjusted_submaps_;
    adjusted_keyframes_ += submap->keyframes.size();
  }
}

std::optional<MapBuilder::Scope> MapMerger::due(int64_t now_us, const Atlas& atlas) const {
  const bool has = has_news(atlas);
  if (hurry_ && (has || wants_adjustment_)) return MapBuilder::Scope::kAll;
  if (wants_adjustment_) {
    const bool settled = is_settled(atlas);
    const double period_s =
        std::max(options_.adjustment_interval_s, kAdjustmentSPerView * views_) * (settled ? kSettledPeriods : 1);
    // Where points are found besides is worth its price when they stay: each adjustment on the way throws it away.
    if (is_due(now_us, last_adjustment_us_, to_us(period_s)))
      return settled ? MapBuilder::Scope::kAll : MapBuilder::Scope::kOnTheWay;
  }
  if (has && is_due(now_us, last_begin_us_, to_us(options_.interval_s))) return MapBuilder::Scope::kWeld;
  return std::nullopt;
}

std::optional<MergeResult> MapMerger::tick(int64_t now_us, const Atlas& atlas) {
  if (running_) return done_ ? end() : std::nullopt;
  const auto scope = due(now_us, atlas);
  if (!scope) {
    hurry_ = hurry_ && !idle(atlas);
    return std::nullopt;
  }
  begin(*scope, now_us, atlas);
  return options_.thread ? std::nullopt : end();
}

// Only what has changed.
void MapMerger::copy(const Atlas& atlas) {
  const StageClock clock("map_server.copy");
  for (const auto& [key, owner] : atlas.submaps()) {
    if (fixed_.contains(key) && !owner.in_map) continue;
    std::shared_ptr<const Submap>& copy = copies_[key];
    if (!copy || copy->revision != owner.submap.revision) copy = std::make_shared<const Submap>(owner.submap);
    if (!owner.in_map || owner.placement.revision == 0)
      placed_.erase(key);
    else if (Placement& place = placed_[key]; place.revision != owner.placement.revision)
      place = owner.placement;
  }
}

void MapMerger::begin(MapBuilder::Scope scope, int64_t now_us, const Atlas& atlas) {
  copy(atlas);
  last_begin_us_ = now_us;
  if (scope != MapBuilder::Scope::kWeld) last_adjustment_us_ = now_us;
  if (scope == MapBuilder::Scope::kAll) hurry_ = false;  // who hurries from now on means what is not in this build
  // The first adjustment waits its turn from the first look on.
  if (last_adjustment_us_ == kNever_us) last_adjustment_us_ = now_us;
  running_ = true;
  done_ = false;
  if (!options_.thread) return run(scope);
  thread_ = std::thread([this, scope] {
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), options_.nice);
    run(scope);
  });
}

void MapMerger::run(MapBuilder::Scope scope) {
  const double start_s = thread_cpu_s();
  MapBuilder::Submaps submaps;
  for (const auto& [key, copy] : copies_) submaps[key] = copy.get();
  builder_.find_links(submaps);
  BuiltMap built = builder_.build(submaps, placed_, scope);
  result_ = {.placements = std::move(built.placements),
             .unmoved = std::move(built.unmoved),
             .culled = std::move(built.culled),
             .links = builder_.links(),
             .report = built.report,
             .scope = scope,
             .cpu_s = thread_cpu_s() - start_s};
  done_ = true;
}

std::optional<MergeResult> MapMerger::end() {
  if (thread_.joinable()) thread_.join();
  running_ = false;
  if (cancel_) return std::nullopt;
  wants_adjustment_ = result_.scope != MapBuilder::Scope::kAll && result_.report.members > 0;
  views_ = std::max(views_, result_.report.views);
  for (const auto& [key, submap] : result_.culled) copies_[key] = submap;  // no news
  if (result_.scope != MapBuilder::Scope::kWeld) note_adjusted();
  malloc_trim(0);  // an adjustment takes, in small pieces, as much as all else
  return std::move(result_);
}

}  // namespace rumi::map_server
