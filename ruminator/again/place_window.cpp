// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/again/place_window.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace rumi::ruminator {
namespace {

constexpr double kIslandShare = 0.65;  // of the window's images, the rest are the map's
constexpr size_t kLeastOfIsland = 6;   // images: a submap is joined by several
constexpr size_t kLookAlike = 4;       // images of the map that each image of an island asks for
constexpr size_t kNeighbours = 2;      // images of the map asked for at each end of an island

std::map<int, std::vector<size_t>> by_island(const std::vector<PlaceCandidate>& candidates) {
  std::map<int, std::vector<size_t>> members;
  for (size_t i = 0; i < candidates.size(); ++i) members[candidates[i].island].push_back(i);
  return members;
}

size_t thinned_size(size_t all, size_t stride) {
  return std::min(all, std::max(kLeastOfIsland, (all + stride - 1) / stride));
}

std::vector<size_t> evenly(const std::vector<size_t>& all, size_t count) {
  std::vector<size_t> some;
  for (size_t k = 0; k < count; ++k) some.push_back(all[count > 1 ? k * (all.size() - 1) / (count - 1) : 0]);
  return some;
}

// Images of the map by how much the chosen ones of the islands ask for them.
std::map<size_t, double> wanted_of_map(const std::vector<PlaceCandidate>& candidates, const std::vector<size_t>& map,
                                       const std::vector<std::vector<size_t>>& islands, const Similarity& similarity) {
  std::map<size_t, double> wanted;
  for (const std::vector<size_t>& island : islands) {
    for (const size_t i : island) {
      std::vector<std::pair<double, size_t>> ranked;
      for (const size_t m : map) ranked.emplace_back(-similarity(i, m), m);
      const size_t count = std::min(kLookAlike, ranked.size());
      std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
      for (size_t k = 0; k < count; ++k) wanted[ranked[k].second] += -ranked[k].first / static_cast<double>(k + 1);
    }
    const auto is_before = [&candidates](size_t m, size_t i) {
      return candidates[m].sample.utime_us < candidates[i].sample.utime_us;
    };
    const auto begin = std::lower_bound(map.begin(), map.end(), island.front(), is_before);
    const auto end = std::lower_bound(map.begin(), map.end(), island.back(), is_before);
    for (size_t k = 1; k <= kNeighbours && k <= static_cast<size_t>(begin - map.begin()); ++k)
      wanted[*(begin - static_cast<std::ptrdiff_t>(k))] += 1;
    for (size_t k = 0; k < kNeighbours && k < static_cast<size_t>(map.end() - end); ++k)
      wanted[*(end + static_cast<std::ptrdiff_t>(k))] += 1;
  }
  return wanted;
}

}  // namespace

std::vector<size_t> choose_place_window(const std::vector<PlaceCandidate>& candidates, std::vector<Island> islands,
                                        const Similarity& similarity, int max_images, std::vector<int>* taken) {
  std::map<int, std::vector<size_t>> members = by_island(candidates);
  std::stable_sort(islands.begin(), islands.end(),
                   [](const Island& a, const Island& b) { return a.frames > b.frames; });
  std::erase_if(islands, [&members](const Island& island) { return !members.contains(island.id); });
  const auto room = static_cast<size_t>(kIslandShare * max_images);
  // As dense as there is room; where even the thinnest choice of all islands is too much, the smallest wait.
  const auto size_of_all = [&](size_t stride) {
    size_t sum = 0;
    for (const Island& island : islands) sum += thinned_size(members[island.id].size(), stride);
    return sum;
  };
  constexpr size_t kWidestStride = 8;
  size_t stride = 1;
  while (stride < kWidestStride && size_of_all(stride) > room) ++stride;
  while (islands.size() > 1 && size_of_all(stride) > room) islands.pop_back();

  std::vector<std::vector<size_t>> of_islands;
  std::set<size_t> chosen;
  taken->clear();
  for (const Island& island : islands) {
    const std::vector<size_t>& all = members[island.id];
    of_islands.push_back(evenly(all, std::min(thinned_size(all.size(), stride), room)));
    chosen.insert(of_islands.back().begin(), of_islands.back().end());
    taken->push_back(island.id);
  }
  std::vector<std::pair<double, size_t>> wanted;
  for (const auto& [m, value] : wanted_of_map(candidates, members[PlaceCandidate::kInMap], of_islands, similarity))
    wanted.emplace_back(-value, m);
  std::sort(wanted.begin(), wanted.end());
  for (const auto& [value, m] : wanted)
    if (chosen.size() < static_cast<size_t>(max_images)) chosen.insert(m);
  return {chosen.begin(), chosen.end()};
}

}  // namespace rumi::ruminator
