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

uint16_t KeyframeIndex::hash(const Descriptor& d, int table) const {
  uint32_t h = 0;
  for (uint8_t bit : bits_[table]) h = h << 1 | static_cast<uint32_t>(d[bit >> 6] >> (bit & 63) & 1);
  return static_cast<uint16_t>(h);
}

void KeyframeIndex::add(int64_t keyframe, const std::vector<Descriptor>& descriptors) {
  Words& words = words_[keyframe];
  for (int t = 0; t < kTables; ++t)
    for (const Descriptor& d : descriptors) {
      words[t].push_back(hash(d, t));
      std::vector<int64_t>& bucket = buckets_[t][words[t].back()];
      if (bucket.empty() || bucket.back() != keyframe) bucket.push_back(keyframe);
    }
}

void KeyframeIndex::remove(int64_t keyframe) {
  const auto words = words_.find(keyframe);
  if (words == words_.end()) return;
  for (int t = 0; t < kTables; ++t)
    for (uint16_t word : words->second[t]) {
      const auto bucket = buckets_[t].find(word);
      if (bucket == buckets_[t].end()) continue;  // the keyframe had the word twice
      std::erase(bucket->second, keyframe);
      if (bucket->second.empty()) buckets_[t].erase(bucket);
    }
  words_.erase(words);
}

std::vector<KeyframeIndex::Candidate> KeyframeIndex::query(const std::vector<Descriptor>& descriptors,
                                                           size_t count) const {
  std::unordered_map<int64_t, double> votes;
  const double all = static_cast<double>(words_.size()) + 1;
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
    const double norm =
        std::sqrt(static_cast<double>(words_.at(keyframe)[0].size()) * static_cast<double>(descriptors.size()));
    candidates.push_back({keyframe, score / norm});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
  });
  if (candidates.size() > count) candidates.resize(count);
  return candidates;
}

}  // namespace rumi
