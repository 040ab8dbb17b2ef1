// SPDX-License-Identifier: BSD-3-Clause
// Chooses the submaps of a build by their revisions. When a build throws, the submaps that were new in it are in doubt.
// Those that make a build throw even alone are left out until they change. If there are none, halves of the new submaps
// are tried, together with those that are known to build, until no build throws any more.
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

  // Chooses the submaps of the next build from `all`. As long as unfinished() returns a scope, call it with that scope
  // and the same `all`.
  Revisions choose(const Revisions& all, Scope scope, int64_t now_us);
  // The submaps chosen last that are not known to build.
  const std::set<SubmapKey>& fresh() const { return new_; }
  // Notes that the build of what was chosen last went well.
  void built();
  // Notes that this build threw. `failing`: its new submaps that make a build throw even alone. Returns false if
  // nothing was new in it.
  bool broke_off(const std::set<SubmapKey>& failing, int64_t now_us);
  // The scope of the build that must try the next half of the submaps in doubt; nothing if there is none to try.
  std::optional<Scope> unfinished() const;
  // True if no build is needed because of this revision: one was made with it, or it is left out.
  bool is_done(SubmapKey key, int64_t revision, int64_t now_us) const;
  bool is_left_out(SubmapKey key, int64_t revision, int64_t now_us) const;
  // Notes that a build replaced the submap by this revision, which is therefore known to build.
  void replaced(SubmapKey key, int64_t revision);
  std::set<SubmapKey> left_out() const;

 private:
  struct Doubt {
    int64_t revision = 0;  // the one with which the build threw
    int64_t since_us = 0;
  };
  Revisions& good(Scope scope) { return good_[static_cast<size_t>(scope)]; }

  std::array<Revisions, 3> good_;  // by scope: what the last build that went well was made of
  std::map<SubmapKey, Doubt> doubts_;
  std::vector<std::set<SubmapKey>> untried_;  // the last one is next
  Scope scope_ = Scope::kWeld;                // the scope of the build chosen last
  Revisions chosen_;
  std::set<SubmapKey> new_;  // those of chosen_ that are not known to build
};

}  // namespace rumi::map_server
