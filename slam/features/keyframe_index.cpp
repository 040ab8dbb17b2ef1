// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/keyframe_index.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace rumi {

KeyframeIndex::KeyframeIndex() {
  std::mt19937 rng(20231);  // fixed: the same index everywhere
  for (auto& table : bits_) {
    std::array<uint8_t, 256> positions;
    for (int i = 0; i < 256; ++i) positions[i] = static_cast<uint8_t>(i);
    for (int i = 0; i < kBits; ++i) {
      std::swap(positions[i], positions[i + rng() % (256 - i)]);
      table[i] = positions[i];
    }
  }
}

uint32_t KeyframeIndex::hash(const Descriptor& d, int table) const {
  uint32_t h = 0;
  for (uint8_t bit : bits_[table]) h = h << 1 | static_cast<uint32_t>(d[bit >> 6] >> (bit & 63) & 1);
  return h;
}

void KeyframeIndex::add(int64_t keyframe, const std::vector<Descriptor>& descriptors) {
  sizes_[keyframe] = descriptors.size();
  for (int t = 0; t < kTables; ++t)
    for (const Descriptor& d : descriptors) {
      std::vector<int64_t>& bucket = buckets_[t][hash(d, t)];
      if (bucket.empty() || bucket.back() != keyframe) bucket.push_back(keyframe);
    }
}

void KeyframeIndex::remove(int64_t keyframe) {
  if (sizes_.erase(keyframe) == 0) return;
  for (auto& table : buckets_)
    for (auto it = table.begin(); it != table.end();) {
      std::erase(it->second, keyframe);
      it = it->second.empty() ? table.erase(it) : std::next(it);
    }
}

std::vector<KeyframeIndex::Candidate> KeyframeIndex::query(const std::vector<Descriptor>& descriptors,
                                                           size_t count) const {
  std::unordered_map<int64_t, double> votes;
  const double all = static_cast<double>(sizes_.size()) + 1;
  for (int t = 0; t < kTables; ++t)
    for (const Descriptor& d : descriptors) {
      const auto bucket = buckets_[t].find(hash(d, t));
      if (bucket == buckets_[t].end()) continue;
      // A word that every keyframe has says nothing (inverse document frequency).
      const double weight = std::log(all / static_cast<double>(bucket->second.size()));
      for (int64_t keyframe : bucket->second) votes[keyframe] += weight;
    }
  std::vector<Candidate> candidates;
  for (const auto& [keyframe, score] : votes) {
    const double norm = std::sqrt(static_cast<double>(sizes_.at(keyframe)) * static_cast<double>(descriptors.size()));
    candidates.push_back({keyframe, score / norm});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
  });
  if (candidates.size() > count) candidates.resize(count);
  return candidates;
}

}  // namespace rumi
