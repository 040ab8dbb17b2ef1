// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/post_culling.h"

#include <algorithm>
#include <cstdlib>

namespace rumi::map_server {
namespace {

using RefKey = std::pair<SubmapKey, int>;
RefKey key_of(const KeyframeRef& ref) { return {ref.submap, ref.id}; }

class Finder {
 public:
  Finder(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps, const CommonImages& common,
         const PostCullingOptions& options)
      : o_(options), model_(model), submaps_(submaps), common_(common), gone_(model.views.size(), 0) {
    for (const KeyframeJoint& joint : common.doubled) {
      doubles_[key_of(joint.a)].push_back(key_of(joint.b));
      doubles_[key_of(joint.b)].push_back(key_of(joint.a));
    }
  }

  KeyframeSets run() {
    for (size_t v = 0; v < model_.views.size(); ++v)
      for (const KeyframeRef& ref : model_.views[v].keyframes)
        if (may_go(ref) && (is_doubled(ref) || is_redundant(static_cast<int>(v)))) {
          redundant_[ref.submap].insert(ref.id);
          gone_[v] = model_.views[v].keyframes.size() == 1;
        }
    return std::move(redundant_);
  }

 private:
  static bool contains(const KeyframeSets& sets, const RefKey& ref) {
    const auto set = sets.find(ref.first);
    return set != sets.end() && set->second.contains(ref.second);
  }

  bool may_go(const KeyframeRef& ref) const {
    const Submap& submap = *submaps_.at(ref.submap).submap;
    return submap.kind == SubmapKind::kBack && submap.closed && !contains(common_.needed, key_of(ref));
  }

  // True if another keyframe of the same image is kept.
  bool is_doubled(const KeyframeRef& ref) const {
    const auto doubles = doubles_.find(key_of(ref));
    return doubles != doubles_.end() &&
           std::any_of(doubles->second.begin(), doubles->second.end(), [this](const RefKey& other) {
             return submaps_.contains(other.first) && !contains(redundant_, other);
           });
  }

  bool is_redundant(int v) const {
    const MapModel::View& view = model_.views[v];
    if (view.keyframes.size() != 1) return false;
    int total = 0, redundant = 0;
    for (size_t i = 0; i < view.points.size(); ++i) {
      if (view.points[i] == kNone) continue;
      ++total;
      redundant +=
          others_that_see(model_.points[view.points[i]], v, view.features->keypoints[i].octave) >= o_.observers;
    }
    return redundant > o_.redundant_share * total;
  }

  int others_that_see(const MapModel::Point& point, int view, int octave) const {
    return static_cast<int>(
        std::count_if(point.observations.begin(), point.observations.end(), [&](const MapModel::Observation& o) {
          return o.view != view && !gone_[o.view] &&
                 model_.views[o.view].features->keypoints[o.keypoint].octave <= octave + 1;
        }));
  }

  const PostCullingOptions& o_;
  const MapModel& model_;
  const std::map<SubmapKey, PlacedSubmap>& submaps_;
  const CommonImages& common_;
  std::vector<char> gone_;  // views whose keyframes are all removed
  std::map<RefKey, std::vector<RefKey>> doubles_;
  KeyframeSets redundant_;
};

// Returns the keyframe nearest in time that is kept; null if there is none.
const Keyframe* nearest_that_stays(const Submap& submap, int64_t utime_us, const std::set<int>& leaving) {
  const Keyframe* nearest = nullptr;
  for (const auto& [id, keyframe] : submap.keyframes)
    if (!leaving.contains(id) &&
        (!nearest || std::abs(keyframe.utime_us - utime_us) < std::abs(nearest->utime_us - utime_us)))
      nearest = &keyframe;
  return nearest;
}

}  // namespace

KeyframeSets find_redundant(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps,
                            const CommonImages& common, const PostCullingOptions& options) {
  return Finder(model, submaps, common, options).run();
}

Submap without_keyframes(const Submap& submap, const Placement& placement, const std::set<int>& keyframes) {
  Submap left = submap;
  left.hand_out();
  std::set<int> seen_less;
  for (int id : keyframes) {
    const Keyframe& keyframe = *left.keyframe(id);
    const Keyframe* heir = nearest_that_stays(submap, keyframe.utime_us, keyframes);
    if (!heir) return submap;
    for (int landmark : keyframe.landmark_ids)
      if (landmark != kNone) seen_less.insert(landmark);
    left.remove_keyframe(id, heir->id);
  }
  for (const auto& [utime_us, before] : submap.frames) {
    FramePose frame = left.frames.at(utime_us);
    if (frame.reference_keyframe == before.reference_keyframe) continue;
    const Keyframe& heir = *left.keyframe(frame.reference_keyframe);
    frame.cam_from_keyframe = placement.cam_from_map(submap, before) * placement.cam_from_map(heir).inverse();
    frame.cam_from_keyframe.translation /= placement.at(heir.utime_us).scale;
    left.set_frame(frame);
  }
  for (int id : seen_less)
    if (left.landmark(id)->observations.size() < 2) left.remove_landmark(id);
  return left;
}

}  // namespace rumi::map_server
