// SPDX-License-Identifier: BSD-3-Clause
// Finds the keyframes that look like an image. Locality-sensitive hashing of binary descriptors (Indyk and Motwani,
// STOC 1998: bit sampling for the Hamming distance): incremental, no vocabulary, no training.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "slam/features/descriptor.h"

namespace rumi {

class KeyframeIndex {
 public:
  KeyframeIndex();
  // `keyframe` is any number that the caller chooses. An earlier entry with this number is replaced.
  void add(int64_t keyframe, std::span<const Descriptor> descriptors);
  void remove(int64_t keyframe);
  // Removes all keyframes for which gone(keyframe) is true.
  template <class Gone>
  void remove_if(Gone gone) {
    for (auto it = number_of_.begin(); it != number_of_.end();) {
      const int64_t keyframe = (it++)->first;
      if (gone(keyframe)) remove(keyframe);
    }
  }
  size_t size() const { return number_of_.size(); }

  struct Candidate {
    int64_t keyframe = 0;
    double score = 0;  // weighted votes, divided by the geometric mean of the two images' numbers of descriptors
  };
  // Returns the best candidates first, at most `count`. Equal scores are in order of `keyframe`, so it is
  // deterministic.
  std::vector<Candidate> query(std::span<const Descriptor> descriptors, size_t count) const;

 private:
  static constexpr int kTables = 6;
  static constexpr int kBits = 16;
  static constexpr uint32_t kPerBlock = 3;
  // A word that more keyframes have tells little of each of them. It is passed over, so that the time of a query does
  // not grow with the number of keyframes.
  static constexpr uint32_t kCommon = 256;
  static constexpr uint32_t kNoBlock = std::numeric_limits<uint32_t>::max();
  struct Entry {
    int64_t keyframe = 0;
    std::vector<uint16_t> words;  // hashes of its descriptors, table after table
  };
  // Up to kPerBlock entries that have the same word.
  struct Block {
    std::array<uint32_t, kPerBlock> entries;
    uint32_t next;
  };
  struct Chain {
    uint32_t first = kNoBlock;  // all blocks behind the first one are full
    uint32_t count = 0;         // number of entries
  };
  uint16_t hash(const Descriptor& d, int table) const;
  static size_t chain_of(int table, uint16_t word) { return (static_cast<size_t>(table) << kBits) + word; }
  void insert(uint32_t entry, Chain* chain);
  void erase(uint32_t entry, Chain* chain);
  uint32_t make_block(uint32_t next);

  std::array<std::array<uint8_t, kBits>, kTables> bits_;  // descriptor bits that make up a word, by table
  std::vector<Chain> chains_;                             // indexed by chain_of()
  std::deque<Block> blocks_;                              // no vector: half of it would be empty after it has grown
  uint32_t free_block_ = kNoBlock;                        // first of the chain of free blocks
  std::vector<Entry> entries_;
  std::vector<uint32_t> free_entries_;
  std::map<int64_t, uint32_t> number_of_;  // index into entries_, by keyframe
};

}  // namespace rumi
