// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/build_schedule.h"

#include <algorithm>
#include <cmath>

#include "base/text/time_units.h"

namespace rumi::map_server {
namespace {

constexpr double kAdjustmentSPerView = 0.25;  // the adjustment period for each image of the map, at least
constexpr double kSettledPeriods = 4;         // the adjustment of a map that hardly grows waits so many periods
constexpr double kSettledShare = 0.05;        // of the keyframes, more or fewer than at the last adjustment

}  // namespace

// Ignores that keyframes are corrected and replaced all the time: in a known place the map stays what it was.
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
    // Association is worth its price only if its points stay, and each adjustment on the way throws them away.
    if (is_due(now_us, last_adjustment_us_, to_us(period_s))) return settled ? BuildScope::kAll : BuildScope::kOnTheWay;
  }
  return needs.has_news && interval_is_over ? std::optional(BuildScope::kWeld) : std::nullopt;
}

void BuildSchedule::begun(BuildScope scope, int64_t now_us) {
  last_begin_us_ = now_us;
  began_in_a_hurry_ = hurry_;
  if (scope == BuildScope::kAll)
    hurry_ = false;  // a hurry() from now on is about submaps that this build does not have
  // The first adjustment is due one period after the first build.
  if (scope != BuildScope::kWeld || last_adjustment_us_ == kNever_us) last_adjustment_us_ = now_us;
}

void BuildSchedule::built(BuildScope scope, int members, int views, const BuildSize& size) {
  changed_ = scope != BuildScope::kAll && members > 0;
  views_ = std::max(views_, views);
  if (scope != BuildScope::kWeld) adjusted_ = size;
}

void BuildSchedule::broke_off(bool something_was_new) {
  changed_ = changed_ && something_was_new;  // else the same build would throw for ever
  hurry_ = hurry_ || began_in_a_hurry_;
}

}  // namespace rumi::map_server
