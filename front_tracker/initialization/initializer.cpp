// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/initialization/initializer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/running/log.h"
#include "slam/geometry/two_view.h"

namespace rumi::front_tracker {
namespace {

constexpr size_t kMostReferences = 4;
constexpr size_t kReferenceInterval = 10;  // frames from one reference to the next, at most
constexpr double kRenewAt = 0.7;           // share of the newest reference's keypoints that are found, below which
                                           // another reference is due
constexpr double kMinMotion_px = 2;        // median motion beyond a rotation, for a first try: twice a keypoint's noise
constexpr double kMoreMotion = 1.1;        // factor on the motion of the last try from which the next try is worthwhile
constexpr int kMostMisses = 3;             // frames in a row with too few keypoints (blurred ones, for example) after
                                           // which a reference is dropped

}  // namespace

Initializer::Initializer(const Camera& camera, const InitializerOptions& options, const std::vector<double>& scales)
    : camera_(camera), options_(options), scales_(scales) {
  options_.two_view.min_median_parallax_deg = 0;  // max_direction_sigma_rad decides whether the motion is enough
}

void Initializer::clear() {
  frames_.clear();
  references_.clear();
  refusal_.clear();
}

void Initializer::trim() {
  while (static_cast<int>(frames_.size()) > options_.max_frames) {
    frames_.pop_front();
    std::erase_if(references_, [](const Reference& r) { return r.frame == 0; });
    for (Reference& r : references_) --r.frame;
  }
}

void Initializer::buffer(Frame frame) {
  frames_.push_back(std::move(frame));
  follow();
  trim();
  drop_images();
}

// A submap begins with a reference frame, so earlier images are dropped. The later frames are many, so only their full
// images are kept; the pyramid is made again for the few that become keyframes.
void Initializer::drop_images() {
  const size_t oldest = references_.empty() ? frames_.size() : references_.front().frame;
  for (size_t i = 0; i < oldest; ++i) frames_[i].images = nullptr;
  std::shared_ptr<const ImagePyramid>& newest = frames_.back().images;
  if (newest) newest = std::make_shared<const ImagePyramid>(newest->full_image_alone());
}

std::deque<Frame> Initializer::take_frames() {
  std::deque<Frame> frames = std::move(frames_);
  clear();
  return frames;
}

void Initializer::follow() {
  const Frame& now = frames_.back();
  if (!references_.empty()) {
    const FrameMotion motion = estimate_motion(camera_, *frames_[frames_.size() - 2].features, *now.features);
    for (Reference& r : references_) {
      r.tracks.follow(camera_, motion, now);
      r.misses = r.tracks.count() >= options_.min_matches ? 0 : r.misses + 1;
    }
    std::erase_if(references_, [](const Reference& r) { return r.misses >= kMostMisses; });
  }
  const auto due = [&](const Reference& newest) {
    return frames_.size() - 1 - newest.frame >= kReferenceInterval ||
           newest.tracks.count() < kRenewAt * static_cast<double>(newest.tracks.reference().size());
  };
  if (static_cast<int>(now.features->size()) < options_.min_matches) return;
  if (!references_.empty() && !due(references_.back())) return;
  // The oldest reference has seen the most motion, so the second oldest is dropped.
  if (references_.size() == kMostReferences) references_.erase(references_.begin() + 1);
  references_.push_back({frames_.size() - 1, ReferenceTracks(now.features), 0, kMinMotion_px});
}

// Returns the reference since which the image moved most beyond a rotation, of those worth a try. Returns an Error if
// none is.
Result<Initializer::Reference*> Initializer::most_promising() {
  Reference* best = nullptr;
  double most_px = 0;
  bool matched = false;
  for (Reference& r : references_) {
    // At least one frame must lie between the two: it judges the structure.
    if (r.frame + 2 >= frames_.size() || r.misses > 0) continue;
    matched = true;
    most_px = std::max(most_px, r.tracks.motion_px());
    if (r.tracks.motion_px() < r.next_motion_px) continue;
    if (!best || r.tracks.motion_px() > best->tracks.motion_px()) best = &r;
  }
  if (!matched) return Error{"too few matches with any frame before"};
  if (!best) return Error{fmt::format("the image moved by {:.1f} px beyond a rotation: waiting for more", most_px)};
  return best;
}

Result<InitialMap> Initializer::add(Frame frame) {
  buffer(std::move(frame));
  Result<InitialMap> map = begin();
  if (!map) {
    refusal_ = map.error_text();
    return map;
  }
  map->frames.assign(std::make_move_iterator(frames_.begin()), std::make_move_iterator(frames_.end()));
  clear();
  return map;
}

Result<InitialMap> Initializer::begin() {
  const Result<Reference*> reference = most_promising();
  if (!reference) return reference.error();
  return begin_with(*reference);
}

// Returns the structures that fit the pair and the frames between, adjusted, the best one first. Returns an Error if
// none fits.
Result<std::vector<Initializer::Rival>> Initializer::find_rivals(const FollowedFrames& input, const TwoViewResult& pair,
                                                                 const std::vector<int>& keypoints) const {
  std::vector<Rival> rivals;
  Result<> between;
  double best_px = 1e9;
  for (const TwoViewHypothesis& hypothesis : pair.hypotheses) {
    InitialStructure structure(input, hypothesis, keypoints);
    if (Result<> agree = structure.add_views_between(); !agree) {
      between = std::move(agree);
      continue;
    }
    const double error_px = structure.error_px();
    best_px = std::min(best_px, error_px);
    rivals.push_back({std::move(structure), error_px, {}});
  }
  if (rivals.empty()) return between.error();
  // Bundle adjustment halves the error of a right structure at best, so worse rivals are not adjusted.
  constexpr double kHopeless = 2.0;
  std::erase_if(rivals, [&](const Rival& rival) { return rival.error_px > kHopeless * best_px; });
  for (Rival& rival : rivals) {
    rival.holds = rival.structure.adjust();
    rival.error_px = rival.structure.error_px();
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const Rival& a, const Rival& b) { return a.error_px < b.error_px; });
  return rivals;
}

// Returns an Error if the submap must not begin with this structure.
Result<> Initializer::check(const Rival& best, const std::vector<Rival>& rivals, double direction_rad) const {
  if (direction_rad > options_.max_direction_sigma_rad)
    return Error{fmt::format("the direction of the motion is known to {:.1f} deg only: waiting for more motion",
                             direction_rad * 180 / M_PI)};
  for (const Rival& rival : rivals) {
    if (rival.structure.same_as(best.structure)) continue;
    // A rival whose adjustment failed may still be the true structure if it fits better.
    const double ratio = rival.holds.has_value() ? options_.max_rival_rmse_ratio : 1.0;
    if (best.error_px > ratio * rival.error_px)
      return Error{
          fmt::format("ambiguous: two structures with errors of {:.2f} and {:.2f} px", best.error_px, rival.error_px)};
  }
  return {};
}

Result<InitialMap> Initializer::begin_with(Reference* reference) {
  const ReferenceTracks& tracks = reference->tracks;
  const std::vector<int>& found = tracks.found().back();
  std::vector<Eigen::Vector2f> first, last;
  std::vector<int> keypoints;
  for (size_t i = 0; i < found.size(); ++i) {
    if (found[i] == kNone) continue;
    keypoints.push_back(static_cast<int>(i));
    first.push_back(tracks.reference().undistorted[i]);
    last.push_back(frames_.back().features->undistorted[found[i]]);
  }
  const TwoViewResult pair = reconstruct_two_views(camera_, first, last, options_.two_view);
  const double motion_px = tracks.motion_px();
  reference->next_motion_px = kMoreMotion * motion_px;
  if (!pair.ok()) return Error{pair.refusal};

  const FollowedFrames input{camera_, options_, scales_, frames_, reference->frame, tracks};
  const Result<std::vector<Rival>> rivals = find_rivals(input, pair, keypoints);
  if (!rivals) return rivals.error();
  const auto best =
      std::find_if(rivals->begin(), rivals->end(), [](const Rival& rival) { return rival.holds.has_value(); });
  if (best == rivals->end()) return rivals->front().holds.error();
  const double direction_rad = best->structure.direction_sigma_rad() * best->error_px;
  if (const Result<> sure = check(*best, *rivals, direction_rad); !sure) return sure.error();
  log_debug(
      "begins with {:.1f} px beyond a rotation, {} of {} frames, error {:.2f} px, direction of the motion known to "
      "{:.1f} deg",
      motion_px, frames_.size() - reference->frame, frames_.size(), best->error_px, direction_rad * 180 / M_PI);
  return best->structure.finish();
}

}  // namespace rumi::front_tracker
