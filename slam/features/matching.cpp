// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace rumi {
namespace {

std::vector<int> all_if_empty(const std::vector<int>& selection, size_t size) {
  if (!selection.empty()) return selection;
  std::vector<int> all(size);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

std::vector<Match> match_features(const Features& first, const std::vector<int>& first_selection,
                                  const Features& second, const std::vector<int>& second_selection,
                                  const MatchOptions& options) {
  const std::vector<int> rows = all_if_empty(first_selection, first.size());
  const std::vector<int> columns = all_if_empty(second_selection, second.size());
  // A descriptor that is farther away is neither a match nor a second best that could refuse one.
  const double refusing = options.max_ratio > 0 ? options.max_distance / options.max_ratio : 256;
  const int farthest = std::max(options.max_distance, static_cast<int>(std::min(256.0, std::ceil(refusing))));
  std::vector<Descriptor> column_descriptors;
  column_descriptors.reserve(columns.size());
  for (int column : columns) column_descriptors.push_back(second.descriptors[column]);
  std::vector<BestMatch> best_row(rows.size()), best_column(columns.size());
  for (size_t r = 0; r < rows.size(); ++r) {
    const Descriptor d = first.descriptors[rows[r]];
    for (size_t c = 0; c < columns.size(); ++c) {
      const int distance = hamming_distance(d, column_descriptors[c]);
      if (distance > farthest) continue;
      best_row[r].offer(distance, static_cast<int>(c));
      best_column[c].offer(distance, static_cast<int>(r));
    }
  }
  std::vector<Match> matches;
  for (size_t r = 0; r < rows.size(); ++r) {
    const BestMatch& b = best_row[r];
    if (b.index == kNone || b.distance > options.max_distance) continue;
    if (b.distance > options.max_ratio * b.second_distance) continue;
    if (best_column[b.index].index != static_cast<int>(r)) continue;
    matches.push_back({rows[r], columns[b.index], b.distance});
  }
  if (options.check_rotation) keep_consistent_rotations(first, second, &matches);
  return matches;
}

void keep_consistent_rotations(const Features& first, const Features& second, std::vector<Match>* matches) {
  constexpr int kBins = 30;
  std::array<int, kBins> histogram{};
  const auto bin = [&](const Match& m) {
    double turn = (second.keypoints[m.second].angle_rad - first.keypoints[m.first].angle_rad) / (2 * M_PI);
    turn -= std::floor(turn);
    return std::min(static_cast<int>(turn * kBins), kBins - 1);
  };
  for (const Match& m : *matches) ++histogram[bin(m)];
  std::array<int, kBins> order;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return histogram[a] > histogram[b]; });
  std::erase_if(*matches, [&](const Match& m) {
    const int b = bin(m);
    if (b == order[0]) return false;
    // The second and third bin count only if they hold a fair share: then the border of a bin may have cut one peak in
    // two.
    for (int i = 1; i < 3; ++i)
      if (b == order[i] && 10 * histogram[b] >= histogram[order[0]]) return false;
    return true;
  });
}

}  // namespace rumi
