// SPDX-License-Identifier: BSD-3-Clause
// Which keyframes look like this image? Locality-sensitive hashing of binary descriptors (Indyk and Motwani, STOC 1998:
// bit sampling for the Hamming distance): incremental, no vocabulary, no training.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "slam/features/descriptor.h"

namespace rumi {

class KeyframeIndex {
 public:
  KeyframeIndex();
  // `keyframe` is any number the caller chooses, once.
  void add(int64_t keyframe, const std::vector<Descriptor>& descriptors);
  void remove(int64_t keyframe);
  // Removes all for which gone(keyframe) is true.
  template <class Gone>
  void remove_if(Gone gone) {
    for (auto it = words_.begin(); it != words_.end();) {
      const int64_t keyframe = (it++)->first;
      if (gone(keyframe)) remove(keyframe);
    }
  }
  size_t size() const { return words_.size(); }

  struct Candidate {
    int64_t keyframe = 0;
    double score = 0;  // weighted votes, relative to the number of descriptors on either side
  };
  // The best candidates first, at most `count`. Ties are broken by number: deterministic.
  std::vector<Candidate> query(const std::vector<Descriptor>& descriptors, size_t count) const;

 private:
  static constexpr int kTables = 6;
  static constexpr int kBits = 16;
  uint16_t hash(const Descriptor& d, int table) const;
  std::array<std::array<uint8_t, kBits>, kTables> bits_;  // sampled positions
  std::array<std::unordered_map<uint16_t, std::vector<int64_t>>, kTables> buckets_;
  using Words = std::array<std::vector<uint16_t>, kTables>;  // hashes of the descriptors
  std::map<int64_t, Words> words_;                           // by keyframe
};

}  // namespace rumi
