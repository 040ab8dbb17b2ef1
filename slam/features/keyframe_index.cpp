// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/keyframe_index.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace rumi {

KeyframeIndex::KeyframeIndex() : chains_(kTables << kBits) {
  std::mt19937 rng(20231);  // fixed, so that the index is the same everywhere
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

void KeyframeIndex::add(int64_t keyframe, std::span<const Descriptor> descriptors) {
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
      insert(number, &chains_[chain_of(t, entry.words.back())]);
    }
}

void KeyframeIndex::insert(uint32_t entry, Chain* chain) {
  const uint32_t at = chain->count % kPerBlock;
  if (chain->count > 0 && blocks_[chain->first].entries[(chain->count - 1) % kPerBlock] == entry)
    return;  // the keyframe has this word twice
  if (at == 0) chain->first = make_block(chain->first);
  blocks_[chain->first].entries[at] = entry;
  ++chain->count;
}

// Puts the last entry of the chain in the place of the erased one.
void KeyframeIndex::erase(uint32_t entry, Chain* chain) {
  uint32_t in_block = (chain->count + kPerBlock - 1) % kPerBlock + 1;  // entries in the first block; all other blocks
                                                                       // are full
  uint32_t left = chain->count;
  for (uint32_t b = chain->first; left > 0; left -= in_block, in_block = kPerBlock, b = blocks_[b].next)
    for (uint32_t i = 0; i < in_block; ++i) {
      if (blocks_[b].entries[i] != entry) continue;
      Block& first = blocks_[chain->first];
      blocks_[b].entries[i] = first.entries[--chain->count % kPerBlock];
      if (chain->count % kPerBlock == 0) {
        const uint32_t emptied = std::exchange(chain->first, first.next);
        first.next = std::exchange(free_block_, emptied);
      }
      return;
    }
}

uint32_t KeyframeIndex::make_block(uint32_t next) {
  uint32_t made = free_block_;
  if (made == kNoBlock) {
    made = static_cast<uint32_t>(blocks_.size());
    blocks_.emplace_back();
  } else {
    free_block_ = blocks_[made].next;
  }
  blocks_[made].next = next;
  return made;
}

void KeyframeIndex::remove(int64_t keyframe) {
  const auto it = number_of_.find(keyframe);
  if (it == number_of_.end()) return;
  const uint32_t number = it->second;
  Entry& entry = entries_[number];
  const size_t descriptors = entry.words.size() / kTables;
  for (size_t i = 0; i < entry.words.size(); ++i)
    erase(number, &chains_[chain_of(static_cast<int>(i / descriptors), entry.words[i])]);
  entry = {};
  free_entries_.push_back(number);
  number_of_.erase(it);
}

std::vector<KeyframeIndex::Candidate> KeyframeIndex::query(std::span<const Descriptor> descriptors,
                                                           size_t count) const {
  std::vector<double> votes(entries_.size(), 0);
  const double all = static_cast<double>(size()) + 1;
  for (int t = 0; t < kTables; ++t)
    for (const Descriptor& d : descriptors) {
      const Chain& chain = chains_[chain_of(t, hash(d, t))];
      if (chain.count == 0 || chain.count > kCommon) continue;
      // A word that most keyframes have says little about which one it is (inverse document frequency).
      const double weight = std::log(all / chain.count);
      uint32_t in_block = (chain.count - 1) % kPerBlock + 1, left = chain.count;
      for (uint32_t b = chain.first; left > 0; left -= in_block, in_block = kPerBlock, b = blocks_[b].next)
        for (uint32_t i = 0; i < in_block; ++i) votes[blocks_[b].entries[i]] += weight;
    }
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < votes.size(); ++i) {
    if (votes[i] == 0) continue;
    const size_t own = entries_[i].words.size() / kTables;
    const double norm = std::sqrt(static_cast<double>(own) * static_cast<double>(descriptors.size()));
    candidates.push_back({entries_[i].keyframe, votes[i] / norm});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
  });
  if (candidates.size() > count) candidates.resize(count);
  return candidates;
}

}  // namespace rumi
