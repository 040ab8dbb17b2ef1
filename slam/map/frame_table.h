// SPDX-License-Identifier: BSD-3-Clause
// The poses of a submap's frames, by time. It is read like std::map<int64_t, FramePose>, but takes the 96 bytes of a
// pose for each frame and little else. Poses are kept in blocks, which copies share until one of them changes one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "slam/geometry/transform.h"
#include "slam/map/copy_on_write.h"
#include "slam/map/pose_sigmas.h"

namespace rumi {

// cam_from_submap = cam_from_keyframe * keyframe(reference_keyframe).cam_from_submap
struct FramePose {
  FramePose() = default;
  FramePose(int64_t utime, int reference, const SE3& pose, int64_t last_change = 0, const PoseSigmas& known = {})
      : utime_us(utime), revision(last_change), cam_from_keyframe(pose), reference_keyframe(reference), sigmas(known) {}

  int64_t utime_us = 0;
  int64_t revision = 0;
  SE3 cam_from_keyframe;
  int reference_keyframe = -1;
  PoseSigmas sigmas = {};  // those that were known when the frame got its pose
};
static_assert(sizeof(FramePose) <= 96);

class FrameTable {
 public:
  class const_iterator {
   public:
    using iterator_category = std::bidirectional_iterator_tag;
    using value_type = std::pair<int64_t, const FramePose&>;
    using difference_type = std::ptrdiff_t;
    using reference = value_type;
    struct pointer {
      value_type value;
      const value_type* operator->() const { return &value; }
    };

    const_iterator() = default;
    reference operator*() const {
      const FramePose& frame = (*table_->blocks_[block_].frames)[at_];
      return {frame.utime_us, frame};
    }
    pointer operator->() const { return {**this}; }
    const_iterator& operator++();
    const_iterator& operator--();
    bool operator==(const const_iterator& other) const { return block_ == other.block_ && at_ == other.at_; }

   private:
    friend class FrameTable;
    const_iterator(const FrameTable* table, size_t block, size_t at) : table_(table), block_(block), at_(at) {}
    const FrameTable* table_ = nullptr;
    size_t block_ = 0, at_ = 0;
  };

  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }
  const_iterator begin() const { return {this, 0, 0}; }
  const_iterator end() const { return {this, blocks_.size(), 0}; }
  auto rbegin() const { return std::reverse_iterator(end()); }
  auto rend() const { return std::reverse_iterator(begin()); }
  const_iterator lower_bound(int64_t utime_us) const;
  bool contains(int64_t utime_us) const { return get(utime_us) != nullptr; }
  // Returns nullptr if there is no such frame. The pointer is valid until the table changes.
  const FramePose* get(int64_t utime_us) const;
  // Throws std::out_of_range if there is no such frame.
  const FramePose& at(int64_t utime_us) const;
  // Calls visit(frame) for each frame that changed after this revision, in order of time.
  template <class Visit>
  void for_each_after(int64_t revision, Visit visit) const {
    for (const Block& block : blocks_) {
      if (block.revision <= revision) continue;
      for (const FramePose& frame : *block.frames)
        if (frame.revision > revision) visit(frame);
    }
  }

  // Adds the frame, or replaces the one of the same time.
  void set(const FramePose& frame);
  // Lets change(&frame) change each frame, but not its time.
  template <class Change>
  void change_all(Change change) {
    for (Block& block : blocks_)
      for (FramePose& frame : block.frames.write()) {
        change(&frame);
        block.revision = std::max(block.revision, frame.revision);
      }
  }
  // Removes all frames from this time on.
  void erase_from(int64_t utime_us);

 private:
  struct Block {
    int64_t revision = 0;                        // no frame of the block has a higher one
    CopyOnWrite<std::vector<FramePose>> frames;  // ascending, never empty
  };
  size_t block_of(int64_t utime_us) const;  // the block that has the frame, or into which it belongs
  void append(const FramePose& frame);      // later than all others
  void split(size_t block);

  std::vector<Block> blocks_;  // in order of time
  size_t size_ = 0;
};

}  // namespace rumi
