// SPDX-License-Identifier: BSD-3-Clause
// Decides which build of the map is due, and when. It does no work itself: the caller reports what there is to do and
// how each build ended. In this table the first line counts that applies and whose time has come; while there is an
// untried half, only the first line does. T is the adjustment period.
//
//   there is                                            due is                  when
//   an untried half of the submaps in doubt             its scope               each interval_s; in a hurry: now
//   a hurry, and news or a change since the last kAll   kAll                    now
//   a change since the last kAll; the map hardly grows  kAll                    after 4 T
//   a change since the last kAll                        kOnTheWay               after T
//   news                                                kWeld                   each interval_s
//
// T is adjustment_interval_s, or a quarter of a second for each image of the map if that is longer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/running/due.h"
#include "map_server/merging/build_input.h"

namespace rumi::map_server {

// The size of a set of submaps.
struct BuildSize {
  size_t submaps = 0, keyframes = 0;
};

struct BuildNeeds {
  std::optional<BuildScope> untried;  // scope of the build that must try half of the submaps in doubt
  bool has_news = false;              // whether a submap has changed since the last build that had it
  BuildSize size = {};
};

class BuildSchedule {
 public:
  BuildSchedule(double interval_s, double adjustment_interval_s)
      : interval_s_(interval_s), adjustment_interval_s_(adjustment_interval_s) {}

  std::optional<BuildScope> due(const BuildNeeds& needs, int64_t now_us) const;
  // Makes builds due at once, until a build of scope kAll has begun with everything known now.
  void hurry() { hurry_ = true; }
  bool is_in_a_hurry() const { return hurry_; }
  // True if there is nothing left to build.
  bool is_at_rest(const BuildNeeds& needs) const { return !needs.untried && !needs.has_news && !changed_; }

  // The caller reports every build: begun(), and then built() or broke_off().
  void begun(BuildScope scope, int64_t now_us);
  // `members`, `views`: how many submaps and images the built map has; `size`: that of all submaps that went into the
  // build.
  void built(BuildScope scope, int members, int views, const BuildSize& size);
  void broke_off(bool something_was_new);
  // To be called when nothing is due and no build is running.
  void rest(const BuildNeeds& needs) { hurry_ = hurry_ && !is_at_rest(needs); }

 private:
  bool is_settled(const BuildSize& size) const;

  double interval_s_, adjustment_interval_s_;
  bool hurry_ = false;
  bool began_in_a_hurry_ = false;  // whether the last build began in a hurry
  bool changed_ = false;           // whether builds of other scopes made a map since the last kAll
  int64_t last_begin_us_ = kNever_us, last_adjustment_us_ = kNever_us;
  BuildSize adjusted_;  // the size at the last adjustment
  int views_ = 0;       // images of the largest map built so far
};

}  // namespace rumi::map_server
