// SPDX-License-Identifier: BSD-3-Clause
// The ids that were removed from a submap, for updates of its copies. Only the latest removals are kept, because in a
// place that is seen for hours landmarks come and go without end. A copy that is older than these is sent the whole
// submap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rumi {

class Removals {
 public:
  static constexpr size_t kMost = 32768;  // removals that are kept; with one more, the older half is forgotten

  // `revision` must not be lower than in the call before.
  void add(int id, int64_t revision);
  // Forgets the removals of all revisions up to and including `revision`.
  void forget(int64_t revision);
  // Returns the ids removed after `revision`, ascending, each once; nullopt if some of them may have been forgotten.
  std::optional<std::vector<int>> since(int64_t revision) const;

 private:
  struct Removal {
    int64_t revision;
    int id;
  };
  std::vector<Removal> in_order_;
  int64_t forgotten_revision_ = 0;  // removals up to this revision may be missing
};

}  // namespace rumi
