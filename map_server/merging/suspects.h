// SPDX-License-Identifier: BSD-3-Clause
// Which submaps a build of the map is made of. When one breaks off, what was new in it is in doubt. Those to blame are
// left out until they change; where nobody knows which, all are tried by halves, with what is known to build, until
// nothing breaks off any more. Knows no submaps, only their revisions.
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

  // Of `all`, what the next build is made of. Ask for what unfinished() says, with the same `all`, as long as it does.
  Revisions choose(const Revisions& all, Scope scope, int64_t now_us);
  // Of what was chosen last, what was not known to build.
  const std::set<SubmapKey>& fresh() const { return new_; }
  // What was chosen last was built.
  void built();
  // It broke off. `to_blame`: of what is new in it, what breaks off by itself. False: nothing is new in it.
  bool broke_off(const std::set<SubmapKey>& to_blame, int64_t now_us);
  // A part of what was in doubt is still to be tried by such a build.
  std::optional<Scope> unfinished() const;
  // Nobody needs to look at this revision: it was built with, or is left out.
  bool is_done(SubmapKey key, int64_t revision, int64_t now_us) const;
  bool is_left_out(SubmapKey key, int64_t revision, int64_t now_us) const;
  // A build made this revision of it.
  void replaced(SubmapKey key, int64_t revision);
  std::set<SubmapKey> left_out() const;

 private:
  struct Doubt {
    int64_t revision = 0;  // that it broke off with
    int64_t since_us = 0;
  };
  Revisions& good(Scope scope) { return good_[static_cast<size_t>(scope)]; }

  std::array<Revisions, 3> good_;  // by scope: of the last build that went well
  std::map<SubmapKey, Doubt> doubts_;
  std::vector<std::set<SubmapKey>> untried_;  // the last one is next
  Scope scope_ = Scope::kWeld;                // of what was chosen last
  Revisions chosen_;
  std::set<SubmapKey> new_;  // of these, not known to build
};

}  // namespace rumi::map_server
