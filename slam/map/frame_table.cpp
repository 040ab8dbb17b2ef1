// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/frame_table.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rumi {
namespace {

constexpr size_t kMostInBlock = 128;

bool is_before(const FramePose& frame, int64_t utime_us) { return frame.utime_us < utime_us; }

size_t position(const std::vector<FramePose>& frames, int64_t utime_us) {
  return std::lower_bound(frames.begin(), frames.end(), utime_us, is_before) - frames.begin();
}

}  // namespace

FrameTable::const_iterator& FrameTable::const_iterator::operator++() {
  if (++at_ == table_->blocks_[block_].frames->size()) {
    ++block_;
    at_ = 0;
  }
  return *this;
}

FrameTable::const_iterator& FrameTable::const_iterator::operator--() {
  if (at_ == 0) at_ = table_->blocks_[--block_].frames->size();
  --at_;
  return *this;
}

size_t FrameTable::block_of(int64_t utime_us) const {
  const auto after = std::upper_bound(blocks_.begin(), blocks_.end(), utime_us, [](int64_t utime, const Block& block) {
    return utime < block.frames->front().utime_us;
  });
  return after == blocks_.begin() ? 0 : after - blocks_.begin() - 1;
}

FrameTable::const_iterator FrameTable::lower_bound(int64_t utime_us) const {
  if (blocks_.empty()) return end();
  const size_t block = block_of(utime_us), at = position(*blocks_[block].frames, utime_us);
  return at < blocks_[block].frames->size() ? const_iterator(this, block, at) : const_iterator(this, block + 1, 0);
}

const FramePose* FrameTable::get(int64_t utime_us) const {
  const const_iterator found = lower_bound(utime_us);
  return found != end() && found->first == utime_us ? &found->second : nullptr;
}

const FramePose& FrameTable::at(int64_t utime_us) const {
  const FramePose* frame = get(utime_us);
  if (!frame) throw std::out_of_range("no frame of time " + std::to_string(utime_us));
  return *frame;
}

void FrameTable::set(const FramePose& frame) {
  if (blocks_.empty() || blocks_.back().frames->back().utime_us < frame.utime_us) return append(frame);
  const size_t b = block_of(frame.utime_us), at = position(*blocks_[b].frames, frame.utime_us);
  const bool is_new = at == blocks_[b].frames->size() || (*blocks_[b].frames)[at].utime_us != frame.utime_us;
  if (is_new && blocks_[b].frames->size() >= kMostInBlock) {
    split(b);
    return set(frame);
  }
  Block& block = blocks_[b];
  block.revision = std::max(block.revision, frame.revision);
  std::vector<FramePose>& frames = block.frames.write();
  if (is_new)
    frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(at), frame);
  else
    frames[at] = frame;
  size_ += is_new ? 1 : 0;
}

void FrameTable::append(const FramePose& frame) {
  if (blocks_.empty() || blocks_.back().frames->size() >= kMostInBlock) blocks_.emplace_back();
  Block& block = blocks_.back();
  block.revision = std::max(block.revision, frame.revision);
  block.frames.write().push_back(frame);
  ++size_;
}

// Moves the later half of the block into a block of its own.
void FrameTable::split(size_t block) {
  std::vector<FramePose>& frames = blocks_[block].frames.write();
  const auto middle = frames.begin() + static_cast<std::ptrdiff_t>(frames.size() / 2);
  Block later{.revision = blocks_[block].revision, .frames = {}};
  later.frames.write().assign(middle, frames.end());
  frames.erase(middle, frames.end());
  blocks_.insert(blocks_.begin() + static_cast<std::ptrdiff_t>(block) + 1, std::move(later));
}

void FrameTable::erase_from(int64_t utime_us) {
  while (!blocks_.empty() && blocks_.back().frames->front().utime_us >= utime_us) {
    size_ -= blocks_.back().frames->size();
    blocks_.pop_back();
  }
  if (blocks_.empty() || blocks_.back().frames->back().utime_us < utime_us) return;
  std::vector<FramePose>& frames = blocks_.back().frames.write();
  const size_t at = position(frames, utime_us);
  size_ -= frames.size() - at;
  frames.resize(at);
}

}  // namespace rumi
