// SPDX-License-Identifier: BSD-3-Clause
// A value that copies share until one of them changes it. Copying takes constant time and no memory, so that one thread
// can read a copy of a large map while another goes on changing the original.
#pragma once

#include <atomic>
#include <utility>

namespace rumi {

// Different copies may be used by different threads at once; one copy may not.
template <class T>
class CopyOnWrite {
 public:
  CopyOnWrite() = default;  // holds nothing
  CopyOnWrite(const CopyOnWrite& other) : block_(other.block_) {
    if (block_) block_->owners.fetch_add(1, std::memory_order_relaxed);
  }
  CopyOnWrite(CopyOnWrite&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
  CopyOnWrite& operator=(CopyOnWrite other) noexcept {
    std::swap(block_, other.block_);
    return *this;
  }
  ~CopyOnWrite() { reset(); }

  explicit operator bool() const { return block_ != nullptr; }
  // The pointer is valid until this copy is written to or destroyed.
  const T* operator->() const { return &block_->value; }
  const T& operator*() const { return block_->value; }

  // Returns the value for changes, which no other copy sees. Makes a value if there is none. A pointer to it is valid
  // until this copy is copied and written to again, or is destroyed.
  T& write() {
    if (!block_)
      block_ = new Block;
    else if (block_->owners.load(std::memory_order_acquire) != 1)
      *this = CopyOnWrite(new Block(block_->value));
    return block_->value;
  }
  void reset() {
    if (Block* block = std::exchange(block_, nullptr); block && block->owners.fetch_sub(1) == 1) delete block;
  }

 private:
  struct Block {
    Block() = default;
    explicit Block(const T& v) : value(v) {}
    std::atomic<int> owners = 1;
    T value;
  };
  explicit CopyOnWrite(Block* block) : block_(block) {}
  Block* block_ = nullptr;
};

}  // namespace rumi
