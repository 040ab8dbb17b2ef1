// SPDX-License-Identifier: BSD-3-Clause
// Front, back, front, back, front: three quarters of a round of a room, so that nothing is seen again at the end. The
// back submaps cover what the front lost.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"
#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;

class Chain {
 public:
  static constexpr int64_t kSession = 7;
  static constexpr SubmapKey kFront1{kSession, 1}, kFront2{kSession, 2}, kFront3{kSession, 3}, kBack1{kSession, -1},
      kBack2{kSession, -2};
  static constexpr int kImages = 150;  // every one is a frame of a submap at least

  Chain();

  const Submap& submap(SubmapKey key) const { return made_.at(key).submap; }
  // The same images, but nothing in it is where it should be.
  Submap spoiled(SubmapKey key) const;
  // Of all frames of the placed submaps, which may be those of an earlier revision. In metres.
  PathError error(const Atlas& atlas) const;

 private:
  SubmapRecipe recipe(SubmapKey key) const;

  World world_;
  std::vector<Image> images_;
  std::map<SubmapKey, SyntheticSubmap> made_;
};

// The submap as it was when only its first keyframes were there (revision 1), and as it is now (revision 2).
struct Growth {
  Submap early, late;
};
Growth grow(const Submap& submap, int early_keyframes);

// What nobody can build a map with: landmarks are seen by a keyframe that is not there.
void break_submap(Submap* submap);

// As an update from its maker would.
void put(const Submap& submap, Atlas* atlas);

}  // namespace rumi::testing
