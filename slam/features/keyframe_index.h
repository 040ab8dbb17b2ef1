// SPDX-License-Identifier: BSD-3-Clause
// Which keyframes look like this image? Locality-sensitive hashing of binary descriptors (Indyk and Motwani, STOC 1998:
// bit sampling for the Hamming distance): incremental, no vocabulary, no training.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <vector>

#include "slam/features/descriptor.h"

namespace rumi {

class KeyframeIndex {
 public:
  KeyframeIndex();
  // `keyframe` is any number the caller chooses; what was there under it is replaced.
  void add(int64_t keyframe, const std::vector<Descriptor>& descriptors);
  void remove(int64_t keyframe);
  // Removes all for which gone(keyframe) is true.
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
    double score = 0;  // weighted votes, relative to the number of descriptors on either side
  };
  // The best candidates first, at most `count`. Ties are broken by number: deterministic.
  std::vector<Candidate> query(const std::vector<Descriptor>& descriptors, size_t count) const;

 private:
  static constexpr int kTables = 6;
  static constexpr int kBits = 16;
  static constexpr uint32_t kEnd = std::numeric_limits<uint32_t>::max();  // of a chain
  struct Entry {
    int64_t keyframe = 0;
    std::vector<uint16_t> words;  // hashes of its descriptors, table after table
  };
  // That an entry has a word; in the chain of all entries that have it.
  struct Posting {
    uint32_t entry = 0;
    uint32_t next = kEnd;
  };
  uint16_t hash(const Descriptor& d, int table) const;
  static size_t head_of(int table, uint16_t word) { return (static_cast<size_t>(table) << kBits) + word; }
  uint32_t make_posting(Posting posting);

  std::array<std::array<uint8_t, kBits>, kTables> bits_;  // sampled positions
  std::vector<uint32_t> heads_;                           // the first posting of a word, by head_of()
  std::deque<Posting> postings_;                          // those that are free are a chain too
  uint32_t free_posting_ = kEnd;
  std::vector<Entry> entries_;
  std::vector<uint32_t> free_entries_;
  std::map<int64_t, uint32_t> number_of_;  // index into entries_, by keyframe
};

}  // namespace rumi
