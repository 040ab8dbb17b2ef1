// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/keyframe_index.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace rumi {

KeyframeIndex::KeyframeIndex() : heads_(kTables << kBits, kEnd) {
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
  remove(keyframe);
  uint32_t number = static_cast<uint32_t>(entries_.size());
  if (free_entries_.empty()) {
    entries_.emplace_back();
  } else {
    number = free_entries_.back();
    free_entries_.pop_back();
  }
  number_of_[keyframe] = number;
  Entry& entry = entries_[number];
  entry.keyframe = keyframe;
  entry.words.reserve(kTables * descriptors.size());
  for (int t = 0; t < kTables; ++t)
    for (const Descriptor& d : descriptors) {
      entry.words.push_back(hash(d, t));
      uint32_t& first = heads_[head_of(t, entry.words.back())];
      if (first == kEnd || postings_[first].entry != number) first = make_posting({number, first});
    }
}

uint32_t KeyframeIndex::make_posting(Posting posting) {
  if (free_posting_ == kEnd) {
    postings_.push_back(posting);
    return static_cast<uint32_t>(postings_.size() - 1);
  }
  const uint32_t made = free_posting_;
  free_posting_ = std::exchange(postings_[made], posting).next;
  return made;
}

void KeyframeIndex::remove(int64_t keyframe) {
  const auto it = number_of_.find(keyframe);
  if (it == number_of_.end()) return;
  const uint32_t number = it->second;
  Entry& entry = entries_[number];
  const size_t descriptors = entry.words.size() / kTables;
  for (size_t i = 0; i < entry.words.size(); ++i) {
    uint32_t* at = &heads_[head_of(static_cast<int>(i / descriptors), entry.words[i])];
    while (*at != kEnd && postings_[*at].entry != number) at = &postings_[*at].next;
    if (*at == kEnd) continue;  // the keyframe had the word twice
    const uint32_t posting = *at;
    *at = postings_[posting].next;
    postings_[posting].next = std::exchange(free_posting_, posting);
  }
  entry = {};
  free_entries_.push_back(number);
  number_of_.erase(it);
}

std::vector<KeyframeIndex::Candidate> KeyframeIndex::query(const std::vector<Descriptor>& descriptors,
                                                           size_t count) const {
  std::vector<double> votes(entries_.size(), 0);
  const double all = static_cast<double>(size()) + 1;
  for (int t = 0; t < kTables; ++t)
    for (const Descriptor& d : descriptors) {
      const uint32_t first = heads_[head_of(t, hash(d, t))];
      if (first == kEnd) continue;
      int keyframes = 0;
      for (uint32_t p = first; p != kEnd; p = postings_[p].next) ++keyframes;
      // A word that every keyframe has says nothing (inverse document frequency).
      const double weight = std::log(all / keyframes);
      for (uint32_t p = first; p != kEnd; p = postings_[p].next) votes[postings_[p].entry] += weight;
    }
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < votes.size(); ++i) {
    if (votes[i] == 0) continue;
    const auto own = static_cast<double>(entries_[i].words.size() / kTables);
    candidates.push_back({entries_[i].keyframe, votes[i] / std::sqrt(own * static_cast<double>(descriptors.size()))});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
  });
  if (candidates.size() > count) candidates.resize(count);
  return candidates;
}

}  // namespace rumi
