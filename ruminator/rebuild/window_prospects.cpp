// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_prospects.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "ruminator/matching/sift_matching.h"
#include "ruminator/matching/window_matches.h"
#include "ruminator/rebuild/first_look.h"
#include "ruminator/rebuild/proof_of_depth.h"

namespace rumi::ruminator {
namespace {

enum class Part { kApproach, kGap, kDeparture };

std::map<int64_t, Part> parts(const RuminationWindow& window) {
  std::map<int64_t, Part> part_of;
  for (const Sample& sample : window.approach) part_of[sample.utime_us] = Part::kApproach;
  for (const Sample& sample : window.gap) part_of[sample.utime_us] = Part::kGap;
  for (const Sample& sample : window.departure) part_of[sample.utime_us] = Part::kDeparture;
  return part_of;
}

}  // namespace

Result<> WindowProspects::at_first_look(WindowImages& images) const {
  if (Result<> gap = look_at_gap(job_, images); !gap) return gap;
  return look_at_motion(camera_, images, cancel_);
}

Result<> WindowProspects::of_matches(const UsableImages& images, const std::vector<ImagePair>& pairs) const {
  const int count = static_cast<int>(images.features.size());
  const std::vector<int> group = connected_images(count, pairs, kMinInliers);
  if (std::count(group.begin(), group.end(), 0) < 3)
    return Error{fmt::format("of {} images no three have enough in common", count)};
  const bool has_moved = std::any_of(pairs.begin(), pairs.end(), [&](const ImagePair& pair) {
    return parallax_px(camera_, images.features, pair) >= options_.min_parallax_px;
  });
  if (!has_moved) return Error{fmt::format("the camera turned or stood still: no parallax between {} images", count)};
  if (Result<> connected = connects_gap(images, group); !connected) return connected;
  std::set<int> all;
  for (int i = 0; i < count; ++i) all.insert(all.end(), i);
  return prove_depth(camera_, images.features, pairs, all, cancel_);
}

// Returns an Error unless one group of connected images contains images of the gap and tracked images. `group`: by
// image.
Result<> WindowProspects::connects_gap(const UsableImages& images, const std::vector<int>& group) const {
  const auto part_of = parts(job_.window);
  std::map<int, std::map<Part, int>> in_group;
  int in_gap = 0;
  for (size_t i = 0; i < group.size(); ++i) {
    const auto part = part_of.find(images.utimes_us[i]);
    if (part == part_of.end()) continue;
    ++in_group[group[i]][part->second];
    in_gap += part->second == Part::kGap;
  }
  const bool has_tracked = !job_.window.approach.empty() || !job_.window.departure.empty();
  const bool is_tied = std::any_of(in_group.begin(), in_group.end(), [has_tracked](auto& entry) {
    auto& n = entry.second;
    if (!has_tracked) return n[Part::kGap] >= 3;
    const bool is_tracked = n[Part::kApproach] + n[Part::kDeparture] > 0;
    return is_tracked && is_useful(n[Part::kApproach], n[Part::kGap], n[Part::kDeparture]);
  });
  if (is_tied) return {};
  return Error{fmt::format("none of the {} images of the gap has enough in common with the images around it", in_gap)};
}

Result<> WindowProspects::of_model(const UsableImages& images, const std::vector<ImagePair>& pairs,
                                   const SparseModel& model) const {
  std::set<int> in_model;
  for (const auto& [image, pose] : model.cam_from_world) in_model.insert(image);
  return prove_depth(camera_, images.features, pairs, in_model, cancel_);
}

bool is_useful(int approach, int gap, int departure) {
  constexpr int kBridgehead = 3;  // least frames on either side: enough to align a submap with
  return gap > 0 || (approach >= kBridgehead && departure >= kBridgehead);
}

}  // namespace rumi::ruminator
