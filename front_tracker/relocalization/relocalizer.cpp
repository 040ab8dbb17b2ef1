// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/relocalization/relocalizer.h"

#include <algorithm>
#include <set>

#include "front_tracker/frame/certainty.h"
#include "front_tracker/matching/brute_force_matching.h"
#include "front_tracker/matching/projection_search.h"
#include "slam/optimization/resection.h"

namespace rumi::front_tracker {
namespace {

// A keyframe's number in the index has the submap's index in its upper half and the keyframe's id in its lower half.
constexpr int kSubmapShift = 32;
size_t submap_of(int64_t number) { return static_cast<size_t>(number >> kSubmapShift); }
int64_t number_of(size_t submap_index, int keyframe_id) {
  return static_cast<int64_t>(submap_index) << kSubmapShift | keyframe_id;
}
int keyframe_of(int64_t number) { return static_cast<int>(number & 0xffffffff); }

// Returns the landmarks of the keyframe and of the ten keyframes that share the most landmarks with it.
std::set<int> landmarks_near(const Submap& submap, int keyframe_id) {
  constexpr int kNeighbours = 10;
  std::set<int> near;
  const auto collect = [&](int id) {
    for (int lm : submap.keyframe(id)->landmark_ids)
      if (lm != kNone) near.insert(lm);
  };
  collect(keyframe_id);
  int neighbours = 0;
  for (const auto& [id, shared] : submap.covisible_keyframes(keyframe_id)) {
    if (neighbours++ == kNeighbours) break;
    collect(id);
  }
  return near;
}

}  // namespace

void Relocalizer::add_keyframe(size_t submap_index, const Submap& submap, const Keyframe& keyframe) {
  index_.remove_if(
      [&](int64_t number) { return submap_of(number) == submap_index && !submap.keyframe(keyframe_of(number)); });
  std::vector<Descriptor> descriptors;
  for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i)
    if (keyframe.landmark_ids[i] != kNone) descriptors.push_back(keyframe.features->descriptors[i]);
  index_.add(number_of(submap_index, keyframe.id), descriptors);
}

void Relocalizer::forget_keyframe(size_t submap_index, int keyframe_id) {
  index_.remove(number_of(submap_index, keyframe_id));
}

void Relocalizer::forget_submap(size_t submap_index) {
  index_.remove_if([submap_index](int64_t number) { return submap_of(number) == submap_index; });
}

std::vector<Relocalizer::Candidate> Relocalizer::candidates(const Frame& frame) const {
  std::vector<Candidate> result;
  for (const auto& c : index_.query(frame.features->descriptors, options_.relocalization_candidates))
    result.push_back({submap_of(c.keyframe), keyframe_of(c.keyframe)});
  return result;
}

bool Relocalizer::contradicts(const Submap& submap, int keyframe_id, const Frame& frame) const {
  constexpr int kMinInliers = 15;
  constexpr double kMaxShare = 0.5;  // observations that agree with the frame's pose / those that agree on another
                                     // pose; below it, the two contradict each other
  constexpr double kMaxError = 4.0;  // reprojection error in px at octave 0
  const Keyframe* kf = submap.keyframe(keyframe_id);
  if (!kf) return false;
  const std::vector<PointObservation> observations =
      match_by_brute_force(submap, scales_, *kf->features, kf->landmark_ids, frame, options_.max_distance).observations;
  const auto pose = resect(camera_, observations, {.min_inliers = kMinInliers, .max_error_px = kMaxError});
  if (!pose) return false;
  const auto inliers = std::count(pose->inlier.begin(), pose->inlier.end(), true);
  const auto agree = std::count_if(observations.begin(), observations.end(), [&](const PointObservation& o) {
    const Eigen::Vector3d in_cam = frame.cam_from_submap * o.point;
    return in_cam.z() > 0 && (camera_.project_undistorted(in_cam) - o.pixel).norm() <= kMaxError * o.sigma_px;
  });
  return static_cast<double>(agree) < kMaxShare * static_cast<double>(inliers);
}

// Returns false for most hopeless keyframes: matches a sample of their landmarks, at a fraction of the work. In the
// kidnap tests, at least 14 % of the sample matched where the camera was found again, mostly 20 to 60 %; elsewhere 2 %,
// and at most 9 %.
bool Relocalizer::is_worth_comparing(const Submap& submap, const Keyframe& keyframe, const Frame& frame) const {
  constexpr size_t kSample = 150, kLeast = 5;
  std::vector<size_t> known;
  for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i)
    if (keyframe.landmark_ids[i] != kNone) known.push_back(i);
  if (known.size() <= kSample) return true;
  std::vector<int> sample(keyframe.landmark_ids.size(), kNone);
  for (size_t i = 0; i < kSample; ++i) {
    const size_t keypoint = known[i * known.size() / kSample];
    sample[keypoint] = keyframe.landmark_ids[keypoint];
  }
  return match_by_brute_force(submap, scales_, *keyframe.features, sample, frame, options_.max_distance).pairs.size() >=
         kLeast;
}

std::optional<Frame> Relocalizer::relocalize(const Submap& submap, int keyframe_id, const Frame& frame) const {
  const Keyframe* kf = submap.keyframe(keyframe_id);
  if (!kf) return std::nullopt;  // it has been culled
  if (!is_worth_comparing(submap, *kf, frame)) return std::nullopt;
  const LandmarkMatches matches =
      match_by_brute_force(submap, scales_, *kf->features, kf->landmark_ids, frame, options_.max_distance);
  const auto pose = resect(camera_, matches.observations);
  if (!pose) return std::nullopt;
  Frame found = frame;
  found.clear_matches();
  found.cam_from_submap = pose->cam_from_submap;
  take_inliers(matches, pose->inlier, &found);
  const std::optional<size_t> in_view = match_neighbourhood(submap, keyframe_id, &found);
  if (!in_view || !is_proven(submap, *in_view, &found)) return std::nullopt;
  found.reference_keyframe = keyframe_id;
  return found;
}

// Matches the frame to more landmarks of the keyframe's neighbourhood, and refines its pose with them. Returns how many
// of the neighbourhood's landmarks should be in view; nullopt if no pose explains the matches.
std::optional<size_t> Relocalizer::match_neighbourhood(const Submap& submap, int keyframe_id, Frame* found) const {
  const std::set<int> near = landmarks_near(submap, keyframe_id);
  size_t in_view = 0;
  for (const double radius : {2.0 * options_.local_radius_px, options_.local_radius_px}) {
    std::set<int> matched(found->landmark_ids.begin(), found->landmark_ids.end());
    matched.erase(kNone);
    std::vector<const Landmark*> landmarks;
    for (int id : near)
      if (!matched.contains(id)) landmarks.push_back(submap.landmark(id));
    std::vector<int> visible;
    search_by_projection(camera_, landmarks, {.radius_px = radius, .max_distance = options_.max_distance}, scales_,
                         found, &visible);
    in_view = matched.size() + visible.size();
    if (refine_pose(camera_, submap, scales_, found) == 0) return std::nullopt;
  }
  return in_view;
}

// True if the pose is proven. A few dozen landmarks may agree by chance or at the rim of the image, so a large share of
// those that should be in view must be found. If the camera is elsewhere, most of them are not recognized.
bool Relocalizer::is_proven(const Submap& submap, size_t in_view, Frame* found) const {
  const int inliers = found->matches();
  if (inliers < options_.relocalization_min_inliers) return false;
  found->certainty = certainty_of(submap, scales_, *found);
  const bool sure = found->certainty.image_px <= options_.lost_px();
  const double min_ratio = sure ? options_.relocalization_min_ratio / 3 : options_.relocalization_min_ratio;
  return inliers >= min_ratio * static_cast<double>(in_view);
}

}  // namespace rumi::front_tracker
