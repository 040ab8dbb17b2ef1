// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/bag_poses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "formats/bag/bag_topics.h"
#include "formats/bag/ros_messages.h"

namespace rumi {
namespace {

using Edge = std::vector<RosTransform>;  // transforms of one child frame, in order of time
using Edges = std::map<std::string, Edge>;

std::string frame_of_images(BagFile& bag, const BagTopic& topic) {
  std::vector<uint8_t> message;
  for (const BagEntry& entry : topic.messages)
    if (read_message(bag, topic.kind, entry.place, &message)) return frame_of(message, topic.kind.encoding);
  return {};
}

Edges edges_of(BagFile& bag, const std::vector<BagTopic>& topics) {
  Edges edges;
  std::vector<uint8_t> message;
  for (const BagTopic& topic : topics)
    for (const BagEntry& entry : topic.messages) {
      std::vector<RosTransform> transforms;
      if (read_message(bag, topic.kind, entry.place, &message)) parse(message, topic.kind.encoding, &transforms);
      for (RosTransform& transform : transforms) edges[transform.child].push_back(std::move(transform));
    }
  for (auto& [child, edge] : edges)
    std::stable_sort(edge.begin(), edge.end(),
                     [](const RosTransform& a, const RosTransform& b) { return a.stamp_ns < b.stamp_ns; });
  return edges;
}

bool is_moving(const Edge& edge) {
  constexpr double kStill = 1e-6;  // metres, and radians
  const SE3 first = edge.front().parent_from_child.inverse();
  return std::any_of(edge.begin(), edge.end(), [&](const RosTransform& transform) {
    const SE3 change = first * transform.parent_from_child;
    return change.translation.norm() > kStill || change.angle_rad() > kStill;
  });
}

// Returns the edges from the camera's frame up to the root. If they are no chain, returns none and says why in *error.
std::vector<const Edge*> chain_of(const Edges& edges, const std::string& camera, std::string* error) {
  std::vector<const Edge*> chain;
  for (auto edge = edges.find(camera); edge != edges.end(); edge = edges.find(chain.back()->front().parent)) {
    const std::string& parent = edge->second.front().parent;
    const bool is_one = std::all_of(edge->second.begin(), edge->second.end(),
                                    [&](const RosTransform& transform) { return transform.parent == parent; });
    if (!is_one || chain.size() > edges.size()) {
      *error = fmt::format("its frame '{}' lies now in one, now in another", edge->first);
      return {};
    }
    chain.push_back(&edge->second);
  }
  if (chain.empty())
    *error =
        fmt::format("the frame of its images ('{}') is none of its transforms: the path is not the camera's", camera);
  return chain;
}

// Returns the only edge of the chain that changes in time. If none or several do, returns nullptr and says why in
// *error: several would have to be interpolated.
const Edge* moving_one(const std::vector<const Edge*>& chain, std::string* error) {
  std::vector<std::string> moving;
  const Edge* found = nullptr;
  for (const Edge* edge : chain)
    if (is_moving(*edge)) {
      found = edge;
      moving.push_back(edge->front().child);
    }
  if (moving.size() == 1) return found;
  *error = moving.empty() ? "by its transforms the camera does not move"
                          : fmt::format("its camera's path is made of several that move (of the frames {})",
                                        fmt::join(moving, ", "));
  return nullptr;
}

void add_poses(const std::vector<const Edge*>& chain, const Edge* moving, std::vector<BagPoses::Pose>* poses) {
  for (const RosTransform& step : *moving) {
    SE3 map_from_cam;
    for (const Edge* edge : chain)
      map_from_cam = (edge == moving ? step : edge->front()).parent_from_child * map_from_cam;
    constexpr int64_t kPerMicrosecond = 1000;
    const int64_t utime_us = (step.stamp_ns + kPerMicrosecond / 2) / kPerMicrosecond;
    if (poses->empty() || poses->back().utime_us < utime_us) poses->push_back({utime_us, map_from_cam});
  }
}

}  // namespace

BagPoses poses_in_bag(const std::filesystem::path& path, const std::string& channel) {
  BagPoses result;
  const std::unique_ptr<BagFile> bag = open_bag_file(path.string());
  const BagTopics topics = read_topics(*bag);
  const auto refuse = [&](const std::string& why) {
    result.error = fmt::format("{}: {}", path.string(), why);
    return result;
  };
  if (!bag->refusal().empty()) return refuse(bag->refusal());
  result.has_transforms = !topics.transforms.empty();
  if (!result.has_transforms) return refuse("has no poses of the camera: no transforms of frames (/tf)");
  const Result<ChosenTopic> chosen = choose_topic(topics, channel);
  if (!chosen) return refuse(chosen.error_text());
  const Edges edges = edges_of(*bag, topics.transforms);
  std::string why;
  const std::vector<const Edge*> chain = chain_of(edges, frame_of_images(*bag, *chosen->topic), &why);
  const Edge* moving = chain.empty() ? nullptr : moving_one(chain, &why);
  if (!moving) return refuse(why);
  add_poses(chain, moving, &result.poses);
  result.note = fmt::format("{}: the camera's poses are those of its frame '{}' in '{}' (/tf)", path.string(),
                            chain.front()->front().child, chain.back()->front().parent);
  return result;
}

}  // namespace rumi
