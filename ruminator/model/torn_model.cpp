// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/torn_model.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "slam/map/submap.h"

namespace rumi::ruminator {
namespace {

constexpr int kMinMatches = 15;  // least matches between two images, or parts, for a verdict
// Parts are torn only if their severed share is above this multiple of the whole model's, which is due to noise.
constexpr double kMaxSeveredRatio = 2.5;

bool is_contradicted(const PairAgreement& agreement, double max_severed) {
  return agreement.severed > max_severed * (agreement.severed + agreement.shared);
}

bool is_torn(const PairAgreement& agreement, double max_severed) {
  return agreement.severed >= kMinMatches && is_contradicted(agreement, max_severed);
}

bool is_sound(const PairAgreement& agreement, double max_severed) {
  return agreement.shared >= kMinMatches && !is_contradicted(agreement, max_severed);
}

// Returns the severed share of all matches that have points.
double severed_part(const std::vector<PairAgreement>& agreements) {
  double severed = 0, shared = 0;
  for (const PairAgreement& agreement : agreements) {
    severed += agreement.severed;
    shared += agreement.shared;
  }
  return severed > 0 ? severed / (severed + shared) : 0;
}

// Sums up the agreements of all pairs between two parts.
PairAgreement between(int part_a, int part_b, const std::vector<int>& part,
                      const std::vector<PairAgreement>& agreements) {
  PairAgreement all{part_a, part_b};
  for (const PairAgreement& agreement : agreements) {
    if (std::minmax(part[agreement.first], part[agreement.second]) != std::minmax(part_a, part_b)) continue;
    all.shared += agreement.shared;
    all.severed += agreement.severed;
  }
  return all;
}

// Returns for each image, up to the last image of the model, the lowest image of its part.
std::vector<int> sound_parts(std::vector<PairAgreement> agreements, double max_severed, const SparseModel& model) {
  std::stable_sort(agreements.begin(), agreements.end(),
                   [](const PairAgreement& a, const PairAgreement& b) { return a.shared > b.shared; });
  std::vector<int> part(model.cam_from_world.rbegin()->first + 1);
  std::iota(part.begin(), part.end(), 0);
  for (bool more = true; more;) {
    more = false;
    for (const PairAgreement& agreement : agreements) {
      const auto [a, b] = std::minmax({part[agreement.first], part[agreement.second]});
      if (a == b || !is_sound(agreement, max_severed) || is_torn(between(a, b, part, agreements), max_severed))
        continue;
      std::replace(part.begin(), part.end(), b, a);
      more = true;
    }
  }
  return part;
}

}  // namespace

std::vector<PairAgreement> pair_agreements(const std::vector<ImagePair>& pairs, const SparseModel& model) {
  std::map<std::pair<int, int>, int> point_of;  // index of the point, by (image, keypoint)
  for (size_t p = 0; p < model.points.size(); ++p)
    for (const auto& observation : model.points[p].track) point_of[observation] = static_cast<int>(p);
  const auto point = [&point_of](int image, int keypoint) {
    const auto found = point_of.find({image, keypoint});
    return found == point_of.end() ? kNone : found->second;
  };
  std::vector<PairAgreement> agreements;
  for (const ImagePair& pair : pairs) {
    if (!model.cam_from_world.contains(pair.first) || !model.cam_from_world.contains(pair.second)) continue;
    PairAgreement agreement{pair.first, pair.second};
    for (const auto& [a, b] : pair.matches) {
      const int point_a = point(pair.first, a), point_b = point(pair.second, b);
      agreement.shared += point_a != kNone && point_a == point_b;
      agreement.severed += point_a != point_b;
    }
    agreements.push_back(agreement);
  }
  return agreements;
}

std::set<int> torn_off(const std::vector<PairAgreement>& agreements, double max_severed, const SparseModel& model) {
  if (model.cam_from_world.empty()) return {};
  max_severed = std::max(max_severed, kMaxSeveredRatio * severed_part(agreements));
  const std::vector<int> part = sound_parts(agreements, max_severed, model);
  std::map<int, int> size;
  for (const auto& [image, pose] : model.cam_from_world) ++size[part[image]];
  const int largest = std::max_element(size.begin(), size.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
  std::set<int> torn_parts;
  for (const PairAgreement& agreement : agreements) {
    const int a = part[agreement.first], b = part[agreement.second];
    if (a != b && is_torn(between(a, b, part, agreements), max_severed)) torn_parts.insert({a, b});
  }
  torn_parts.erase(largest);
  std::set<int> images;
  for (const auto& [image, pose] : model.cam_from_world)
    if (torn_parts.contains(part[image])) images.insert(image);
  return images;
}

}  // namespace rumi::ruminator
