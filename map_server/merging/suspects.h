// SPDX-License-Identifier: BSD-3-Clause
// Chooses the submaps of a build by their revisions. When a build throws, the submaps that were new in it are in doubt.
// Those with which a build throws even alone are left out until they change, and for at least a minute. If there are
// none, builds with one half of the new submaps and all submaps known to build are tried, until no build throws any
// more.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "map_server/merging/build_input.h"

namespace rumi::map_server {

class Suspects {
 public:
  using Scope = BuildScope;
  using Revisions = std::map<SubmapKey, int64_t>;

  // Chooses the submaps of the next build from `all`. If unfinished() returns a scope, it must be called with that
  // scope, and with the same `all` as before.
  Revisions choose(const Revisions& all, Scope scope, int64_t now_us);
  // The submaps of the last choice that are not known to build.
  const std::set<SubmapKey>& fresh() const { return new_; }
  // Notes that the build of the last choice succeeded.
  void built();
  // Notes that the build of the last choice threw. `failing`: its new submaps with which a build throws even alone.
  // Returns false if no submap was new in that build.
  bool broke_off(const std::set<SubmapKey>& failing, int64_t now_us);
  // Returns the scope of the build that must try the next half of the submaps in doubt; nullopt if none has to be
  // tried.
  std::optional<Scope> unfinished() const;
  // True if this revision needs no build: it was in one already, or it is left out.
  bool is_done(SubmapKey key, int64_t revision, int64_t now_us) const;
  bool is_left_out(SubmapKey key, int64_t revision, int64_t now_us) const;
  // Notes that a build replaced the submap by this revision, which therefore is known to build.
  void replaced(SubmapKey key, int64_t revision);
  std::set<SubmapKey> left_out() const;

 private:
  struct Doubt {
    int64_t revision = 0;  // revision with which the build threw
    int64_t since_us = 0;
  };
  Revisions& good(Scope scope) { return good_[static_cast<size_t>(scope)]; }

  std::array<Revisions, 3> good_;  // by scope: the submaps of the last build that succeeded
  std::map<SubmapKey, Doubt> doubts_;
  std::vector<std::set<SubmapKey>> untried_;  // the last set is tried next
  Scope scope_ = Scope::kWeld;                // scope of the last choice
  Revisions chosen_;
  std::set<SubmapKey> new_;  // submaps in chosen_ that are not known to build
};

}  // namespace rumi::map_server
