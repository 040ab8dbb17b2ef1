// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/patches/patch_search.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "front_tracker/matching/projection_search.h"
#include "front_tracker/patches/landmark_patch.h"

namespace rumi::front_tracker {
namespace {

constexpr std::array kOctavesAbove{4, 2, 0};  // octaves above the predicted one, in order of search; each search
                                              // reaches two pixels of its level
constexpr double kTooNear_px = 2;  // pixels of the level; a nearer keypoint of another landmark may be the same corner

// Returns the unmatched landmarks of `visible`, most observed first; equal ones keep the order of `visible`.
std::vector<const Landmark*> most_seen_first(const Submap& map, const std::vector<int>& visible, const Frame& frame) {
  std::unordered_set<int> known(frame.landmark_ids.begin(), frame.landmark_ids.end());
  std::vector<const Landmark*> landmarks;
  for (int id : visible)
    if (const Landmark* lm = map.landmark(id); lm && known.insert(id).second) landmarks.push_back(lm);
  std::stable_sort(landmarks.begin(), landmarks.end(), [](const Landmark* a, const Landmark* b) {
    return a->observations.size() > b->observations.size();
  });
  return landmarks;
}

bool is_taken(const Frame& frame, const Prediction& at, double radius_px) {
  bool taken = false;
  frame.grid.for_each_near(at.pixel, static_cast<float>(radius_px), [&](int i) {
    taken |= frame.landmark_ids[i] != kNone && (frame.features->undistorted[i] - at.pixel).norm() < radius_px;
  });
  return taken;
}

// Searches from coarse to fine. Only the finest level has to agree.
std::optional<Keypoint> find_from_coarse(const FrontSubmap& submap, const Landmark& lm, const ImagedView& view,
                                         const Prediction& at, PatchTemplates* templates) {
  const auto predicted = submap.map.camera.project(view.cam_from_submap * lm.position);
  if (!predicted) return std::nullopt;
  Keypoint place{predicted->cast<float>()};
  std::optional<Keypoint> found;
  for (const int above : kOctavesAbove) {
    place.octave = static_cast<uint8_t>(std::min(at.octave + above, view.images.levels() - 1));
    found = find_patch(submap, lm.position, lm.observations, view, place, templates);
    if (found) place.pixel = found->pixel;
  }
  return found;
}

}  // namespace

int search_by_patch(const FrontSubmap& submap, const std::vector<int>& visible, int wanted, Frame* frame,
                    PatchTemplates* templates) {
  if (!frame->images || submap.images.empty()) return 0;
  const ImagedView view{frame->cam_from_submap, *frame->images};
  auto features = std::make_shared<Features>(*frame->features);
  const int missing = wanted - frame->matches();
  std::vector<int> found_ids;
  for (const Landmark* lm : most_seen_first(submap.map, visible, *frame)) {
    if (static_cast<int>(found_ids.size()) >= missing) break;
    const auto at =
        predict(submap.map.camera, view.cam_from_submap, *lm, submap.octave_scales, ProjectionSearch().min_view_cosine);
    if (!at || is_taken(*frame, *at, kTooNear_px * submap.octave_scales[at->octave])) continue;
    const auto found = find_from_coarse(submap, *lm, view, *at, templates);
    if (!found || !is_inside(view.images, *found)) continue;
    add_keypoint(submap.map, *lm, view.images, *found, features.get());
    found_ids.push_back(lm->id);
  }
  frame->landmark_ids.insert(frame->landmark_ids.end(), found_ids.begin(), found_ids.end());
  frame->features = std::move(features);
  frame->grid = KeypointGrid(frame->features->undistorted, submap.map.camera);
  return static_cast<int>(found_ids.size());
}

}  // namespace rumi::front_tracker
