// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace rumi {

// The connected groups of the elements 0, 1, 2, ... The lowest element of a group represents it.
class UnionFind {
 public:
  explicit UnionFind(size_t elements = 0) : parent_(elements) { std::iota(parent_.begin(), parent_.end(), size_t{0}); }

  // Adds an element as a group of its own, and returns it.
  size_t add() {
    parent_.push_back(parent_.size());
    return parent_.back();
  }
  size_t find(size_t element) {
    while (parent_[element] != element) element = parent_[element] = parent_[parent_[element]];
    return element;
  }
  void unite(size_t a, size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<size_t> parent_;
};

}  // namespace rumi
