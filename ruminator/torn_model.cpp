// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/torn_model.h"

#include <algorithm>
#include <map>

#include "ruminator/window_matches.h"
#include "slam/map/submap.h"

namespace rumi {
namespace {

bool is_contradicted(const ImageLink& link, const TearOptions& options) {
  return link.severed > options.max_severed * (link.severed + link.shared);
}

bool is_torn(const ImageLink& link, const TearOptions& options) {
  return link.severed >= options.min_matches && is_contradicted(link, options);
}

bool is_sound(const ImageLink& link, const TearOptions& options) {
  return link.shared >= options.min_matches && !is_contradicted(link, options);
}

}  // namespace

std::vector<ImageLink> model_links(const std::vector<ColmapPair>& pairs, const ColmapModel& model) {
  std::map<std::pair<int, int>, int> point_of;  // (image, keypoint)
  for (size_t p = 0; p < model.points.size(); ++p)
    for (const auto& observation : model.points[p].track) point_of[observation] = static_cast<int>(p);
  const auto point = [&point_of](int image, int keypoint) {
    const auto found = point_of.find({image, keypoint});
    return found == point_of.end() ? kNone : found->second;
  };
  std::vector<ImageLink> links;
  for (const ColmapPair& pair : pairs) {
    if (!model.cam_from_world.contains(pair.first) || !model.cam_from_world.contains(pair.second)) continue;
    ImageLink link{pair.first, pair.second};
    for (const auto& [a, b] : pair.matches) {
      const int point_a = point(pair.first, a), point_b = point(pair.second, b);
      link.shared += point_a != kNone && point_a == point_b;
      link.severed += point_a != point_b;
    }
    links.push_back(link);
  }
  return links;
}

std::set<int> torn_off(const std::vector<ImageLink>& links, const TearOptions& options, const ColmapModel& model) {
  if (model.cam_from_world.empty()) return {};
  std::vector<ColmapPair> sound;
  for (const ImageLink& link : links)
    if (is_sound(link, options)) sound.push_back({link.first, link.second, {}});
  // Images without a pose are parts of their own, of one image, without links.
  const std::vector<int> part = connected_images(model.cam_from_world.rbegin()->first + 1, sound, 0);
  std::set<int> torn_parts;
  for (const ImageLink& link : links)
    if (is_torn(link, options) && part[link.first] != part[link.second])
      torn_parts.insert({part[link.first], part[link.second]});
  torn_parts.erase(0);
  std::set<int> images;
  for (const auto& [image, pose] : model.cam_from_world)
    if (torn_parts.contains(part[image])) images.insert(image);
  return images;
}

}  // namespace rumi
