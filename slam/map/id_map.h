// SPDX-License-Identifier: BSD-3-Clause
// A map from ids, which are handed out in ascending order, to values. It is used like std::map<int, T>, in order of id
// and with stable addresses, but finds a value in constant time. Values are kept in leaves of 64 ids; the slot of an
// erased id (one pointer) is freed only when its leaf holds no other id. Copies of a map share the leaves that neither
// has changed since: access that is not const counts as a change, and gives the leaf's values new addresses if the leaf
// is shared.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "slam/map/copy_on_write.h"

namespace rumi {

template <typename T>
class IdMap {
 public:
  using key_type = int;
  using mapped_type = T;
  using value_type = std::pair<const int, T>;

  static constexpr int kMaxId = (1 << 28) - 1;  // with ids up to this the index takes 32 MB

  template <bool kConst>
  class Iterator {
   public:
    using iterator_category = std::bidirectional_iterator_tag;
    using value_type = IdMap::value_type;
    using difference_type = std::ptrdiff_t;
    using reference = std::conditional_t<kConst, const value_type&, value_type&>;
    using pointer = std::conditional_t<kConst, const value_type*, value_type*>;

    Iterator() = default;
    // NOLINTNEXTLINE(google-explicit-constructor): as the standard's iterators
    operator Iterator<true>() const { return {map_, id_}; }
    reference operator*() const { return *map_->leaf(id_).values[id_ % kLeaf]; }
    pointer operator->() const { return &**this; }
    Iterator& operator++() {
      id_ = map_->next(id_ + 1);
      return *this;
    }
    Iterator& operator--() {
      id_ = map_->previous(id_);
      return *this;
    }
    Iterator operator++(int) { return std::exchange(*this, std::next(*this)); }
    Iterator operator--(int) { return std::exchange(*this, std::prev(*this)); }
    bool operator==(const Iterator& other) const { return id_ == other.id_; }

   private:
    friend class IdMap;
    using Map = std::conditional_t<kConst, const IdMap, IdMap>;
    Iterator(Map* map, size_t id) : map_(map), id_(id) {}
    Map* map_ = nullptr;
    size_t id_ = 0;
  };
  using iterator = Iterator<false>;
  using const_iterator = Iterator<true>;

  IdMap() = default;
  IdMap(IdMap&& other) noexcept : leaves_(std::move(other.leaves_)), size_(std::exchange(other.size_, 0)) {}
  IdMap(const IdMap& other) = default;
  IdMap& operator=(IdMap&& other) noexcept {
    leaves_ = std::move(other.leaves_);
    other.leaves_.clear();
    size_ = std::exchange(other.size_, 0);
    return *this;
  }
  IdMap& operator=(const IdMap& other) = default;
  ~IdMap() = default;

  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }
  void clear() {
    leaves_.clear();
    size_ = 0;
  }

  iterator begin() { return {this, next(0)}; }
  iterator end() { return {this, end_id()}; }
  const_iterator begin() const { return {this, next(0)}; }
  const_iterator end() const { return {this, end_id()}; }
  auto rbegin() { return std::reverse_iterator(end()); }
  auto rend() { return std::reverse_iterator(begin()); }
  auto rbegin() const { return std::reverse_iterator(end()); }
  auto rend() const { return std::reverse_iterator(begin()); }

  iterator find(int id) { return {this, contains(id) ? static_cast<size_t>(id) : end_id()}; }
  const_iterator find(int id) const { return {this, contains(id) ? static_cast<size_t>(id) : end_id()}; }
  iterator lower_bound(int id) { return {this, next(id < 0 ? 0 : id)}; }
  const_iterator lower_bound(int id) const { return {this, next(id < 0 ? 0 : id)}; }
  bool contains(int id) const {
    const size_t at = static_cast<unsigned>(id) / kLeaf;  // a negative id, as unsigned, lies beyond the last leaf
    return at < leaves_.size() && leaves_[at] && (leaves_[at]->used & bit(id)) != 0;
  }
  // Returns nullptr if there is no such id.
  T* get(int id) { return contains(id) ? &leaf(id).values[id % kLeaf]->second : nullptr; }
  const T* get(int id) const { return contains(id) ? &leaf(id).values[id % kLeaf]->second : nullptr; }
  T& at(int id) { return *found(id, get(id)); }
  const T& at(int id) const { return *found(id, get(id)); }

  // Returns the present element, and false, if the id exists. Throws std::out_of_range if it is negative or above
  // kMaxId.
  template <typename... Values>
  std::pair<iterator, bool> emplace(int id, Values&&... values) {
    if (id < 0 || id > kMaxId)
      throw std::out_of_range("id " + std::to_string(id) + " is not one of 0 to " + std::to_string(kMaxId));
    const bool is_new = !contains(id);
    if (is_new) {
      if (leaves_.size() <= static_cast<size_t>(id) / kLeaf) leaves_.resize(id / kLeaf + 1);
      Leaf& leaf = leaves_[id / kLeaf].write();
      leaf.values[id % kLeaf] = std::make_unique<value_type>(std::piecewise_construct, std::forward_as_tuple(id),
                                                             std::forward_as_tuple(std::forward<Values>(values)...));
      leaf.used |= bit(id);
      ++size_;
    }
    return {iterator(this, id), is_new};
  }
  T& operator[](int id) { return emplace(id).first->second; }

  size_t erase(int id) {
    if (!contains(id)) return 0;
    Leaf& without = leaf(id);
    without.values[id % kLeaf].reset();
    without.used &= ~bit(id);
    if (without.used == 0) leaves_[id / kLeaf].reset();
    --size_;
    return 1;
  }
  iterator erase(const_iterator at) {
    erase(at->first);
    return {this, next(at.id_)};
  }

 private:
  static constexpr int kLeaf = 64;  // ids of a leaf, each with a bit of Leaf::used
  struct Leaf {
    Leaf() = default;
    Leaf(const Leaf& other) : used(other.used) {
      for (int i = 0; i < kLeaf; ++i)
        if (other.values[i]) values[i] = std::make_unique<value_type>(*other.values[i]);
    }
    uint64_t used = 0;
    std::array<std::unique_ptr<value_type>, kLeaf> values;
  };

  Leaf& leaf(size_t id) { return leaves_[id / kLeaf].write(); }
  const Leaf& leaf(size_t id) const { return *leaves_[id / kLeaf]; }

  static uint64_t bit(size_t id) { return uint64_t{1} << id % kLeaf; }
  static auto* found(int id, auto* value) {
    if (!value) throw std::out_of_range("no id " + std::to_string(id));
    return value;
  }
  size_t end_id() const { return kLeaf * leaves_.size(); }
  // Returns the first used id that is not below `id`, or end_id().
  size_t next(size_t id) const {
    if (id >= end_id()) return end_id();
    const auto& leaf = leaves_[id / kLeaf];
    if (const uint64_t rest = leaf ? leaf->used & ~(bit(id) - 1) : 0; rest != 0)
      return id / kLeaf * kLeaf + std::countr_zero(rest);
    for (size_t l = id / kLeaf + 1; l < leaves_.size(); ++l)
      if (leaves_[l]) return l * kLeaf + std::countr_zero(leaves_[l]->used);
    return end_id();
  }
  // Returns the last used id below `id`. There must be one.
  size_t previous(size_t id) const {
    if (id % kLeaf != 0)
      if (const uint64_t rest = leaves_[id / kLeaf] ? leaves_[id / kLeaf]->used & (bit(id) - 1) : 0; rest != 0)
        return id / kLeaf * kLeaf + std::bit_width(rest) - 1;
    size_t l = id / kLeaf - 1;
    while (!leaves_[l]) --l;
    return l * kLeaf + std::bit_width(leaves_[l]->used) - 1;
  }

  std::vector<CopyOnWrite<Leaf>> leaves_;
  size_t size_ = 0;
};

}  // namespace rumi
