// SPDX-License-Identifier: BSD-3-Clause
// What was removed from a submap, so that a copy elsewhere can be told. Only the latest removals are remembered: in a
// place that is seen for hours landmarks come and go without end. A copy that is older than that is sent everything.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rumi {

class Removals {
 public:
  static constexpr size_t kMost = 32768;  // then the older half is forgotten

  // `revision` must not be below that of the call before.
  void add(int id, int64_t revision);
  // Forgets all that was removed until `revision`.
  void forget(int64_t revision);
  // The ids removed after `revision`, ascending, each once; nothing if some of them have been forgotten.
  std::optional<std::vector<int>> since(int64_t revision) const;

 private:
  struct Removal {
    int64_t revision;
    int id;
  };
  std::vector<Removal> in_order_;
  int64_t forgotten_revision_ = 0;  // removals until here may be missing
};

}  // namespace rumi
