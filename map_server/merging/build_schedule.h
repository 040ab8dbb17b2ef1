// SPDX-License-Identifier: BSD-3-Clause
// Says when which build of the map is due. Pure logic: it is told what there is to do and what became of each build.
// The first line of this table that holds counts:
//
//   what there is                                          what is due                      when
//   a part of what is in doubt was not tried yet           a build of the scope it asks for  each interval_s; in a
//   hurry: now in a hurry: news, or a change since the last kAll      kAll                              now a change
//   since the last kAll, and little grows         kAll                              after four adjustment periods a
//   change since the last kAll                           kOnTheWay                         after an adjustment period
//   news                                                   kWeld                             each interval_s
//
// The adjustment period is adjustment_interval_s, or a quarter of a second for each image of the map if that is longer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/running/due.h"
#include "map_server/merging/build_input.h"

namespace rumi::map_server {

// Of the submaps that may be built with.
struct BuildSize {
  size_t submaps = 0, keyframes = 0;
};

struct BuildNeeds {
  std::optional<BuildScope> untried;  // a build of this scope tries a part of what is in doubt
  bool has_news = false;              // a submap changed since it was built with
  BuildSize size = {};
};

class BuildSchedule {
 public:
  BuildSchedule(double interval_s, double adjustment_interval_s)
      : interval_s_(interval_s), adjustment_interval_s_(adjustment_interval_s) {}

  std::optional<BuildScope> due(const BuildNeeds& needs, int64_t now_us) const;
  // Everything that is known now and left to do is due at once, until a build of scope kAll has begun with it.
  void hurry() { hurry_ = true; }
  bool is_in_a_hurry() const { return hurry_; }
  // Nothing is left to do.
  bool is_at_rest(const BuildNeeds& needs) const { return !needs.untried && !needs.has_news && !changed_; }

  // Tell it of every build: that it began, and then one of the two that follow.
  void begun(BuildScope scope, int64_t now_us);
  // `members`, `views`: those of the map that was built; `size`: that of what it was built of.
  void built(BuildScope scope, int members, int views, const BuildSize& size);
  void broke_off(bool something_was_new);
  // Nothing is due, and nothing is under way.
  void rest(const BuildNeeds& needs) { hurry_ = hurry_ && !is_at_rest(needs); }

 private:
  bool is_settled(const BuildSize& size) const;

  double interval_s_, adjustment_interval_s_;
  bool hurry_ = false;
  bool began_in_a_hurry_ = false;  // the last build
  bool changed_ = false;           // the map, since the last build of scope kAll
  int64_t last_begin_us_ = kNever_us, last_adjustment_us_ = kNever_us;
  BuildSize adjusted_;  // that of the last adjustment
  int views_ = 0;       // the most that a built map had
};

}  // namespace rumi::map_server
