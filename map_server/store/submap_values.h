// SPDX-License-Identifier: BSD-3-Clause
// Checked values that the tables of placements and links have in common.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <stdexcept>

#include "map_server/store/blob.h"
#include "map_server/store/submap_reader.h"

namespace rumi::map_server {

inline Sim3 checked_similarity(std::span<const uint8_t> blob) {
  const Sim3 similarity = similarity_from_numbers(array_from_blob<SimilarityNumbers>(blob));
  if (!similarity.is_finite() || similarity.scale <= 0) throw std::runtime_error("a similarity is none");
  return similarity;
}

inline SubmapKey key_of(int64_t row, const SubmapsByRow& keys) {
  const auto key = keys.find(row);
  if (key == keys.end()) throw std::runtime_error(fmt::format("submap {} is placed or linked but missing", row));
  return key->second;
}

}  // namespace rumi::map_server
