// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/torn_model.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "slam/map/submap.h"

namespace rumi::ruminator {
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

// Of all matches that the model has points of.
double severed_part(const std::vector<ImageLink>& links) {
  double severed = 0, shared = 0;
  for (const ImageLink& link : links) {
    severed += link.severed;
    shared += link.shared;
  }
  return severed > 0 ? severed / (severed + shared) : 0;
}

// All that two parts have in common.
ImageLink between(int part_a, int part_b, const std::vector<int>& part, const std::vector<ImageLink>& links) {
  ImageLink all{part_a, part_b};
  for (const ImageLink& link : links) {
    if (std::minmax(part[link.first], part[link.second]) != std::minmax(part_a, part_b)) continue;
    all.shared += link.shared;
    all.severed += link.severed;
  }
  return all;
}

// Of every image up to the last one of the model: the lowest image of its part.
std::vector<int> sound_parts(std::vector<ImageLink> links, const TearOptions& options, const SparseModel& model) {
  std::stable_sort(links.begin(), links.end(),
                   [](const ImageLink& a, const ImageLink& b) { return a.shared > b.shared; });
  std::vector<int> part(model.cam_from_world.rbegin()->first + 1);
  std::iota(part.begin(), part.end(), 0);
  for (bool more = true; more;) {
    more = false;
    for (const ImageLink& link : links) {
      const auto [a, b] = std::minmax({part[link.first], part[link.second]});
      if (a == b || !is_sound(link, options) || is_torn(between(a, b, part, links), options)) continue;
      std::replace(part.begin(), part.end(), b, a);
      more = true;
    }
  }
  return part;
}

}  // namespace

std::vector<ImageLink> model_links(const std::vector<ImagePair>& pairs, const SparseModel& model) {
  std::map<std::pair<int, int>, int> point_of;  // (image, keypoint)
  for (size_t p = 0; p < model.points.size(); ++p)
    for (const auto& observation : model.points[p].track) point_of[observation] = static_cast<int>(p);
  const auto point = [&point_of](int image, int keypoint) {
    const auto found = point_of.find({image, keypoint});
    return found == point_of.end() ? kNone : found->second;
  };
  std::vector<ImageLink> links;
  for (const ImagePair& pair : pairs) {
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

std::set<int> torn_off(const std::vector<ImageLink>& links, const TearOptions& options, const SparseModel& model) {
  if (model.cam_from_world.empty()) return {};
  TearOptions limits = options;
  limits.max_severed = std::max(options.max_severed, options.max_severed_ratio * severed_part(links));
  const std::vector<int> part = sound_parts(links, limits, model);
  std::map<int, int> size;
  for (const auto& [image, pose] : model.cam_from_world) ++size[part[image]];
  const int largest = std::max_element(size.begin(), size.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
  std::set<int> torn_parts;
  for (const ImageLink& link : links) {
    const int a = part[link.first], b = part[link.second];
    if (a != b && is_torn(between(a, b, part, links), limits)) torn_parts.insert({a, b});
  }
  torn_parts.erase(largest);
  std::set<int> images;
  for (const auto& [image, pose] : model.cam_from_world)
    if (torn_parts.contains(part[image])) images.insert(image);
  return images;
}

}  // namespace rumi::ruminator
