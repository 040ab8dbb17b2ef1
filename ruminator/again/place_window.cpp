// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/again/place_window.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace rumi::ruminator {
namespace {

constexpr double kIslandShare = 0.7;  // of the window's images, at most; the rest are the map's
constexpr size_t kLookAlike = 4;      // images of the map that each image of an island asks for
constexpr size_t kLeastOfMap = 24;    // and that they ask for together: a small window has no witness

// Grows a tree of images: the next one is always the image outside that looks most like one inside (Prim).
class Growth {
 public:
  Growth(const std::vector<WindowCandidate>& candidates, const Similarity& similarity)
      : candidates_(candidates), similarity_(similarity), nearest_(candidates.size(), kFar) {}

  void take(size_t image) {
    taken_.insert(image);
    for (size_t i = 0; i < candidates_.size(); ++i) nearest_[i] = std::max(nearest_[i], similarity_(image, i));
  }
  // Takes an image of the island `only`, or of any if it is kInMap. False if there is none.
  bool grow(int only) {
    size_t best = candidates_.size();
    for (size_t i = 0; i < candidates_.size(); ++i) {
      const int island = candidates_[i].island;
      const bool may = island != WindowCandidate::kInMap && (only == WindowCandidate::kInMap || island == only);
      if (may && !taken_.contains(i) && (best == candidates_.size() || nearest_[i] > nearest_[best])) best = i;
    }
    if (best == candidates_.size()) return false;
    take(best);
    return true;
  }
  const std::set<size_t>& taken() const { return taken_; }

 private:
  static constexpr double kFar = -std::numeric_limits<double>::infinity();
  const std::vector<WindowCandidate>& candidates_;
  const Similarity& similarity_;
  std::vector<double> nearest_;  // the greatest similarity to an image that is taken
  std::set<size_t> taken_;
};

// Returns images of the map, the one that `images` ask for most first. Each image asks for those that look most like
// it, and for the map's nearest one before and behind it in time.
std::vector<size_t> wanted_of_map(const std::vector<WindowCandidate>& candidates, const std::set<size_t>& images,
                                  const Similarity& similarity) {
  std::vector<size_t> map;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].island == WindowCandidate::kInMap) map.push_back(i);
  const size_t each = std::max(kLookAlike, kLeastOfMap / std::max<size_t>(1, images.size()));
  std::map<size_t, double> wanted;
  for (const size_t image : images) {
    std::vector<std::pair<double, size_t>> ranked;
    ranked.reserve(map.size());
    for (const size_t m : map) ranked.emplace_back(-similarity(image, m), m);
    std::sort(ranked.begin(), ranked.end());
    for (size_t k = 0; k < std::min(each, ranked.size()); ++k)
      wanted[ranked[k].second] += -ranked[k].first / static_cast<double>(k + 1);
    const auto behind = std::lower_bound(map.begin(), map.end(), image);
    if (behind != map.end()) wanted[*behind] += similarity(image, *behind);
    if (behind != map.begin()) wanted[*std::prev(behind)] += similarity(image, *std::prev(behind));
  }
  std::vector<size_t> order;
  order.reserve(wanted.size());
  for (const auto& [m, value] : wanted) order.push_back(m);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return wanted.at(a) > wanted.at(b); });
  return order;
}

}  // namespace

PlaceWindow choose_place_window(const std::vector<WindowCandidate>& candidates, int seed, const Similarity& similarity,
                                int max_images) {
  const auto first = std::find_if(candidates.begin(), candidates.end(),
                                  [seed](const WindowCandidate& candidate) { return candidate.island == seed; });
  if (seed == WindowCandidate::kInMap || first == candidates.end()) return {};
  const auto most = static_cast<size_t>(max_images), of_islands = static_cast<size_t>(kIslandShare * max_images);
  Growth growth(candidates, similarity);
  growth.take(static_cast<size_t>(first - candidates.begin()));
  while (growth.taken().size() < of_islands && growth.grow(seed)) continue;
  while (growth.taken().size() < of_islands && growth.grow(WindowCandidate::kInMap)) continue;

  std::set<size_t> chosen = growth.taken();
  PlaceWindow window;
  for (const size_t i : chosen) window.islands.insert(candidates[i].island);
  for (const size_t m : wanted_of_map(candidates, growth.taken(), similarity))
    if (chosen.size() < most) chosen.insert(m);
  for (const size_t i : chosen) window.candidates.push_back(candidates[i]);
  return window;
}

}  // namespace rumi::ruminator
