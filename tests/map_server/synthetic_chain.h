// SPDX-License-Identifier: BSD-3-Clause
// Front, back, front, back, front: three quarters of a walk round a room, so that its end sees no place again. The back
// submaps cover the gaps between the front submaps.
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
  static constexpr int kImages = 150;  // each image is a frame of at least one submap

  Chain();

  const Submap& submap(SubmapKey key) const { return made_.at(key).submap; }
  // Returns a submap of the same images with wrong poses and landmarks.
  Submap spoiled(SubmapKey key) const;
  // Returns the error of all frames of the placed submaps, in metres. The atlas may have earlier revisions of them.
  PathError error(const Atlas& atlas) const;

 private:
  SubmapRecipe recipe(SubmapKey key) const;

  World world_;
  std::vector<Image> images_;
  std::map<SubmapKey, SyntheticSubmap> made_;
};

// A submap when it had only its first keyframes (revision 1), and as it is now (revision 2).
struct Growth {
  Submap early, late;
};
Growth grow(const Submap& submap, int early_keyframes);

// Makes a submap with which every build throws: landmarks are observed by a keyframe that does not exist.
void break_submap(Submap* submap);

// Applies the submap to the atlas, like an update from its maker.
void put(const Submap& submap, Atlas* atlas);

}  // namespace rumi::testing
