// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_merger.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>

#include "base/cpu_clock.h"
#include "base/due.h"
#include "base/log.h"
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

MapMerger::MapMerger(const MergeOptions& options)
    : options_(options),
      finder_(options.builder.links),
      builder_(options.builder),
      worker_(options.thread, options.nice) {
  input_.cancel = &cancel_;
}

MapMerger::~MapMerger() { cancel_ = true; }

void MapMerger::fix(std::set<SubmapKey> all, const std::set<SubmapKey>& in_map) {
  fixed_ = std::move(all);
  input_.fixed = graph_.built.submaps = in_map;
}

bool MapMerger::has_news(const Atlas& atlas) const {
  if (!options_.enabled) return false;
  return std::any_of(atlas.submaps().begin(), atlas.submaps().end(), [this](const auto& item) {
    return !fixed_.contains(item.first) && !suspects_.is_done(item.first, item.second.submap.revision, now_us_);
  });
}

// In a place that is known, keyframes are corrected and replaced all the time, and the map stays what it was.
bool MapMerger::is_settled(const Atlas& atlas) const {
  size_t submaps = 0, keyframes = 0;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (fixed_.contains(key) || suspects_.is_left_out(key, owner.submap.revision, now_us_)) continue;
    ++submaps;
    keyframes += owner.submap.keyframes.size();
  }
  const double change = std::abs(static_cast<double>(keyframes) - static_cast<double>(adjusted_keyframes_));
  return submaps == adjusted_submaps_ && change <= kSettledShare * static_cast<double>(adjusted_keyframes_);
}

void MapMerger::note_adjusted() {
  adjusted_submaps_ = adjusted_keyframes_ = 0;
  for (const auto& [key, submap] : chosen_) {
    if (fixed_.contains(key)) continue;
    ++adjusted_submaps_;
    adjusted_keyframes_ += submap->keyframes.size();
  }
}

std::optional<BuildScope> MapMerger::due(int64_t now_us, const Atlas& atlas) const {
  if (const auto scope = suspects_.unfinished()) {
    const bool now = hurry_ || is_due(now_us, last_begin_us_, to_us(options_.interval_s));
    return now ? scope : std::nullopt;
  }
  const bool has = has_news(atlas);
  if (hurry_ && (has || wants_adjustment_)) return BuildScope::kAll;
  if (wants_adjustment_) {
    const bool settled = is_settled(atlas);
    const double period_s =
        std::max(options_.adjustment_interval_s, kAdjustmentSPerView * views_) * (settled ? kSettledPeriods : 1);
    // Where points are found besides is worth its price when they stay: each adjustment on the way throws it away.
    if (is_due(now_us, last_adjustment_us_, to_us(period_s))) return settled ? BuildScope::kAll : BuildScope::kOnTheWay;
  }
  if (has && is_due(now_us, last_begin_us_, to_us(options_.interval_s))) return BuildScope::kWeld;
  return std::nullopt;
}

std::optional<MergeResult> MapMerger::tick(int64_t now_us, const Atlas& atlas) {
  now_us_ = now_us;
  if (running_) return worker_.pending() == 0 ? end(atlas) : std::nullopt;
  const auto scope = due(now_us, atlas);
  if (!scope) {
    hurry_ = hurry_ && !idle(atlas);
    return std::nullopt;
  }
  begin(*scope, now_us, atlas);
  return options_.thread ? std::nullopt : end(atlas);
}

// Only what has changed. Those that are tried by halves stay as they were.
void MapMerger::copy_submaps(const Atlas& atlas) {
  if (suspects_.unfinished()) return;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (fixed_.contains(key) && !owner.in_map) continue;
    std::shared_ptr<const Submap>& copy = copies_[key];
    if (!copy || copy->revision != owner.submap.revision) copy = std::make_shared<const Submap>(owner.submap);
  }
}

void MapMerger::choose(BuildScope scope) {
  Suspects::Revisions revisions;
  for (const auto& [key, copy] : copies_)
    if (!fixed_.contains(key)) revisions[key] = copy->revision;
  revisions = suspects_.choose(revisions, scope, now_us_);
  chosen_.clear();
  for (const auto& [key, copy] : copies_)
    if (fixed_.contains(key) || revisions.contains(key)) chosen_[key] = copy;
  input_.scope = scope;
  input_.submaps.clear();
  for (const auto& [key, copy] : chosen_) input_.submaps[key] = copy.get();
}

void MapMerger::note_places(const Atlas& atlas) {
  left_in_map_.clear();
  for (const auto& [key, owner] : atlas.submaps()) {
    const bool is_placed = owner.in_map && owner.placement.revision > 0;
    if (is_placed && !chosen_.contains(key)) left_in_map_.insert(key);
    if (!is_placed || !chosen_.contains(key))
      input_.placed.erase(key);
    else if (Placement& place = input_.placed[key]; place.revision != owner.placement.revision)
      place = owner.placement;
    if (!owner.is_kept() || !chosen_.contains(key))
      input_.kept.erase(key);
    else if (Placement& place = input_.kept[key]; place.revision != owner.placement.revision)
      place = owner.placement;
  }
}

// The atlas has them by now, under a revision of its own. Nobody else places.
void MapMerger::take_over_places(const Atlas& atlas) {
  for (auto& [key, placement] : to_be_placed_) {
    const AtlasSubmap* owner = atlas.find(key);
    if (!owner || !owner->in_map) continue;
    placement.revision = owner->placement.revision;
    std::swap(input_.placed[key], placement);
  }
  worker_.post([before = std::make_shared<Placements>(std::move(to_be_placed_))] {});
  to_be_placed_.clear();
}

void MapMerger::free(std::vector<Placement> placements) {
  worker_.post([placements = std::make_shared<std::vector<Placement>>(std::move(placements))]() mutable {
    placements.reset();
    malloc_trim(0);  // an adjustment takes, in small pieces, as much as all else
  });
}

void MapMerger::begin(BuildScope scope, int64_t now_us, const Atlas& atlas) {
  {
    const StageClock clock("map_server.copy");
    copy_submaps(atlas);
    choose(scope);
    take_over_places(atlas);
    note_places(atlas);
  }
  input_.preferred = atlas.present();
  last_begin_us_ = now_us;
  hurried_ = hurry_;
  if (scope != BuildScope::kWeld) last_adjustment_us_ = now_us;
  if (scope == BuildScope::kAll) hurry_ = false;  // who hurries from now on means what is not in this build
  // The first adjustment waits its turn from the first look on.
  if (last_adjustment_us_ == kNever_us) last_adjustment_us_ = now_us;
  running_ = true;
  worker_.post([this] { run(); });
}

void MapMerger::run() {
  const double start_s = thread_cpu_s();
  BuiltMap built;
  try {
    built = builder_.build(finder_.find(graph_, input_), input_);
    Atlas::check_numbers(built.placements, built.unmoved);
  } catch (...) {
    to_blame_ = find_those_to_blame();
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
  for (const auto& [key, placement] : result_.placements)
    for (const auto* where : {&input_.placed, &input_.kept})
      if (const auto before = where->find(key); before != where->end() && same_place(before->second, placement))
        result_.same.insert(key);
  to_be_placed_ = result_.placements;
}

// Most likely something is wrong with one submap: then it is not to be built with by itself either.
std::set<SubmapKey> MapMerger::find_those_to_blame() const {
  std::set<SubmapKey> found;
  for (const SubmapKey& key : suspects_.fresh()) {
    const BuildInput alone{
        .submaps = {{key, chosen_.at(key).get()}}, .scope = BuildScope::kOnTheWay, .cancel = &cancel_};
    const std::string reason =
        thrown_by([&] { builder_.build(LinkFinder(options_.builder.links).find({}, alone), alone); });
    if (!reason.empty()) found.insert(key);
  }
  return found;
}

std::optional<MergeResult> MapMerger::end(const Atlas& atlas) {
  running_ = false;
  std::string reason = worker_.take_broken().reason;
  if (cancel_) return std::nullopt;
  if (reason.empty()) {
    keep_what_was_left_out();
    reason = thrown_by([&] {
      atlas.check_links(result_.links);
      atlas.check_here(result_.placements, result_.unmoved);
    });
  }
  last_broke_off_ = !reason.empty();
  if (last_broke_off_) {
    give_up(reason);
    return std::nullopt;
  }
  std::swap(graph_, next_graph_);  // the one before is freed where the map is built
  suspects_.built();
  wants_adjustment_ = result_.scope != BuildScope::kAll && result_.report.members > 0;
  views_ = std::max(views_, result_.report.views);
  for (const auto& [key, submap] : result_.culled) {  // no news
    copies_[key] = chosen_[key] = submap;
    suspects_.replaced(key, submap->revision);
  }
  if (result_.scope != BuildScope::kWeld) note_adjusted();
  input_.submaps.clear();
  chosen_.clear();
  return std::move(result_);
}

// In the map as it is. What was built elsewhere does not take its place: how large it would be with all of its submaps
// is not known.
void MapMerger::keep_what_was_left_out() {
  const auto is_placed = [this](const auto& item) { return input_.placed.contains(item.first); };
  if (left_in_map_.empty() || result_.placements.empty()) return;
  if (std::any_of(result_.placements.begin(), result_.placements.end(), is_placed)) {
    result_.unmoved.insert(left_in_map_.begin(), left_in_map_.end());
  } else {
    result_.placements.clear();
    result_.culled.clear();
    to_be_placed_.clear();
  }
}

void MapMerger::give_up(const std::string& reason) {
  result_ = {};
  to_be_placed_.clear();
  input_.submaps.clear();
  chosen_.clear();
  refused_.note(reason, now_us_);
  const std::set<SubmapKey> before = left_out();
  const bool some_are_new = suspects_.broke_off(std::exchange(to_blame_, {}), now_us_);
  wants_adjustment_ = wants_adjustment_ && some_are_new;  // until something is
  hurry_ = hurry_ || hurried_;
  if (left_out() != before) log_warning("the map is built without {} until changed", describe(left_out()));
}

}  // namespace rumi::map_server
