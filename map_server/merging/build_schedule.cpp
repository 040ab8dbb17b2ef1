// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/build_schedule.h"

#include <algorithm>
#include <cmath>

#include "base/text/time_units.h"

namespace rumi::map_server {
namespace {

constexpr double kAdjustmentSPerView = 0.25;  // least adjustment period for each image of the map, s
constexpr double kSettledPeriods = 4;         // if the map hardly grows, the adjustment waits this many periods
constexpr double kSettledShare = 0.05;        // largest change of the number of keyframes of a map that hardly grows

}  // namespace

// Looks only at the numbers of submaps and keyframes: in a known place keyframes are corrected and replaced all the
// time, but the map stays the same.
bool BuildSchedule::is_settled(const BuildSize& size) const {
  const double before = static_cast<double>(adjusted_.keyframes);
  return size.submaps == adjusted_.submaps &&
         std::abs(static_cast<double>(size.keyframes) - before) <= kSettledShare * before;
}

std::optional<BuildScope> BuildSchedule::due(const BuildNeeds& needs, int64_t now_us) const {
  const bool interval_is_over = is_due(now_us, last_begin_us_, to_us(interval_s_));
  if (needs.untried) return hurry_ || interval_is_over ? needs.untried : std::nullopt;
  if (hurry_ && (needs.has_news || changed_)) return BuildScope::kAll;
  if (changed_) {
    const bool settled = is_settled(needs.size);
    const double period_s =
        std::max(adjustment_interval_s_, kAdjustmentSPerView * views_) * (settled ? kSettledPeriods : 1);
    // Searching for common points pays only if they are kept, but each adjustment of a growing map discards them.
    if (is_due(now_us, last_adjustment_us_, to_us(period_s))) return settled ? BuildScope::kAll : BuildScope::kOnTheWay;
  }
  return needs.has_news && interval_is_over ? std::optional(BuildScope::kWeld) : std::nullopt;
}

void BuildSchedule::begun(BuildScope scope, int64_t now_us) {
  last_begin_us_ = now_us;
  began_in_a_hurry_ = hurry_;
  if (scope == BuildScope::kAll) hurry_ = false;  // a later hurry() is about submaps that this build does not have
  // The first adjustment is due one period after the first build.
  if (scope != BuildScope::kWeld || last_adjustment_us_ == kNever_us) last_adjustment_us_ = now_us;
}

void BuildSchedule::built(BuildScope scope, int members, int views, const BuildSize& size) {
  changed_ = scope != BuildScope::kAll && members > 0;
  views_ = std::max(views_, views);
  if (scope != BuildScope::kWeld) adjusted_ = size;
}

void BuildSchedule::broke_off(bool something_was_new) {
  changed_ = changed_ && something_was_new;  // otherwise the same build would throw for ever
  hurry_ = hurry_ || began_in_a_hurry_;
}

}  // namespace rumi::map_server
