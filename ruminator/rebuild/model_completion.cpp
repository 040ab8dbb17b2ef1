// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/model_completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rumi::ruminator {
namespace {

constexpr int kRepairs = 3;  // most slips of the scale that are repaired in one model
// For regrowing a torn model: least parallax of the points that connect an image to the rest, and how many images are
// added between two adjustments.
constexpr double kRegrowParallaxDeg = 0.5;
constexpr int kRegrowImages = 3;

// Returns the part of the model on one side of the cut.
SparseModel side_of(const SparseModel& model, const ScaleCut& cut, bool after) {
  SparseModel side = model;
  std::set<int> others;
  for (const auto& [image, pose] : model.cam_from_world)
    if ((image > cut.image) != after) others.insert(image);
  remove_images(others, &side);
  return side;
}

}  // namespace

ModelCompletion::ModelCompletion(const WindowModelInput& input, const BuildOptions& options)
    : in_(input), o_(options), tracks_(join_tracks(input.images, input.pairs)) {}

WindowModel ModelCompletion::complete(SparseModel model, std::string origin) const {
  WindowModel candidate;
  ModelQuality quality = settle(&model);
  repair_slips(&quality, &model);
  if (regrow_torn(&model)) origin += ", torn and regrown";
  complete_images(&model);
  candidate.model = std::move(model);
  candidate.quality = adjust(&candidate.model);
  candidate.origin = std::move(origin);
  drop_unrelated(&candidate);
  if (candidate.broken_off > 0) trim_new_ends(&candidate);
  if (candidate.broken_off > 0) candidate.origin += fmt::format(", {} unrelated images left out", candidate.broken_off);
  return candidate;
}

WindowModel ModelCompletion::reduced(WindowModel candidate, const std::set<int>& kept) const {
  std::set<int> off;
  for (const auto& [image, pose] : candidate.model.cam_from_world)
    if (!kept.contains(image)) off.insert(image);
  if (off.empty()) return candidate;
  remove_images(off, &candidate.model);
  candidate.broken_off += static_cast<int>(off.size());
  candidate.quality = adjust(&candidate.model);
  candidate.origin += fmt::format(", {} images left out that no other model places there", off.size());
  return candidate;
}

std::vector<SparseModel> ModelCompletion::joined(const std::vector<SparseModel>& models) const {
  std::vector<SparseModel> joined;
  for (size_t a = 0; a < models.size(); ++a) {
    for (size_t b = a + 1; b < models.size(); ++b) {
      const auto a_from_b = align_models(in_.camera, in_.images, tracks_, models[a], models[b]);
      if (!a_from_b) continue;
      SparseModel both = join_models(*a_from_b, models[a], models[b]);
      const size_t images = both.cam_from_world.size();
      if (images > models[a].cam_from_world.size() && images > models[b].cam_from_world.size())
        joined.push_back(std::move(both));
    }
  }
  return joined;
}

// Triangulates the points and adjusts the model twice, first with a larger limit for errors.
ModelQuality ModelCompletion::settle(SparseModel* model) const {
  ModelRefinementOptions rough = o_.refinement;
  rough.max_error_px = 4 * o_.refinement.max_error_px;
  triangulate_tracks(in_.camera, in_.images, tracks_, rough, model);
  adjust_model(in_.camera, in_.images, rough, model);
  triangulate_tracks(in_.camera, in_.images, tracks_, o_.refinement, model);
  return adjust(model);
}

ModelQuality ModelCompletion::adjust(SparseModel* model) const {
  return adjust_model(in_.camera, in_.images, o_.refinement, model);
}

void ModelCompletion::repair_slips(ModelQuality* quality, SparseModel* model) const {
  std::optional<ScaleCut> slip = find_slip(scale_cuts(*model), o_.scale_max_change);
  for (int i = 0; slip && i < kRepairs; ++i) {
    SparseModel repaired = *model;
    repair_scale(*slip, &repaired);
    const ModelQuality after = settle(&repaired);
    const std::optional<ScaleCut> left = find_slip(scale_cuts(repaired), o_.scale_max_change);
    // The repair is right if the model still fits about as well as before and the slip is gone.
    const bool fits = after.observations > 0.98 * quality->observations && after.rmse_px < 1.05 * quality->rmse_px;
    if (!fits || (left && std::abs(left->log_ratio) > 0.5 * std::abs(slip->log_ratio))) return;
    *quality = after;
    *model = std::move(repaired);
    slip = left;
  }
}

// Keeps the largest part of a torn model and adds the images of the other parts again, a few at a time, by the points
// that they share with it, so that these points determine their scale. Returns false if the model is not torn.
bool ModelCompletion::regrow_torn(SparseModel* model) const {
  const std::set<int> off = torn(*model);
  if (off.empty()) return false;
  remove_images(off, model);
  ModelRefinementOptions growth = o_.refinement;
  growth.min_parallax_deg = kRegrowParallaxDeg;
  const auto renew = [&] {
    triangulate_tracks(in_.camera, in_.images, tracks_, growth, model);
    adjust_model(in_.camera, in_.images, growth, model);
  };
  renew();
  // Stops when the model no longer grows: an image that each adjustment removes would be added again for ever.
  for (size_t most = 0; model->cam_from_world.size() > most;) {
    most = model->cam_from_world.size();
    if (resect_missing_images(in_.camera, in_.images, in_.pairs, growth, model, kRegrowImages) > 0) renew();
  }
  settle(model);
  return true;
}

// Removes images whose position is not determined, adds images that were left out, and triangulates all points.
void ModelCompletion::complete_images(SparseModel* model) const {
  remove_loose_images(o_.refinement, model);
  if (resect_missing_images(in_.camera, in_.images, in_.pairs, o_.refinement, model) > 0) adjust(model);
  triangulate_tracks(in_.camera, in_.images, tracks_, o_.refinement, model);
  adjust(model);
  remove_loose_images(o_.refinement, model);
  trim_open_ends(known_to_front(), o_.refinement, model);
}

std::set<int> ModelCompletion::known_to_front() const {
  std::set<int> known;
  for (const Sample& sample : in_.front)
    if (const std::optional<int> image = in_.image_of(sample)) known.insert(*image);
  return known;
}

// Leaves out images whose relation to the others nothing determines. Where only the scale between two sides is unknown,
// joins them by front_tracker's poses, or else keeps the larger side.
void ModelCompletion::drop_unrelated(WindowModel* candidate) const {
  SparseModel& model = candidate->model;
  if (const int strays = remove_strays(&model); strays > 0) {
    candidate->broken_off += strays;
    candidate->quality = adjust(&model);
  }
  if (const std::set<int> off = torn(model); !off.empty()) {
    remove_images(off, &model);
    candidate->broken_off += static_cast<int>(off.size());
    candidate->quality = adjust(&model);
  }
  std::set<int> tied;  // the last images before cuts whose sides are joined
  while (true) {
    std::vector<ScaleCut> cuts = scale_cuts(model);
    std::erase_if(cuts, [&tied](const ScaleCut& cut) { return tied.contains(cut.image); });
    auto cut = find_break(cuts);
    if (!cut && !candidate->is_tied_to_front) cut = front_break(cuts, model);
    if (!cut) return;
    if (tie_to_front(*cut, candidate)) {
      tied.insert(cut->image);
      continue;
    }
    if (!cut->is_break) return;
    candidate->broken_off += keep_larger_side(*cut, &model);
    candidate->quality = adjust(&model);
  }
}

// Trims the ends again, because images from the middle may have become ends.
void ModelCompletion::trim_new_ends(WindowModel* candidate) const {
  const int trimmed = trim_open_ends(known_to_front(), o_.refinement, &candidate->model);
  if (trimmed == 0) return;
  candidate->broken_off += trimmed;
  candidate->quality = adjust(&candidate->model);
}

// Returns the weakest cut whose sides each agree with the same front submap, but not with the same scale. Ignores cuts
// crossed by many points: there it is the front submap whose scale has slipped.
std::optional<ScaleCut> ModelCompletion::front_break(const std::vector<ScaleCut>& cuts,
                                                     const SparseModel& model) const {
  SparseModel poses;
  poses.cam_from_world = model.cam_from_world;
  std::optional<ScaleCut> weakest;
  for (const ScaleCut& cut : cuts) {
    if (is_certain(cut)) continue;
    const auto tie = front_tie(in_.front, in_.utimes_us, side_of(poses, cut, false), side_of(poses, cut, true));
    if (!tie || std::abs(std::log(tie->scale)) < std::log1p(o_.scale_max_change)) continue;
    if (!weakest || std::pair(cut.points, cut.tracks) < std::pair(weakest->points, weakest->tracks)) weakest = cut;
  }
  return weakest;
}

// Places each side of the cut where front_tracker has it. Does not adjust the two together, because the points between
// them determine the scale less well than front_tracker's poses do.
bool ModelCompletion::tie_to_front(const ScaleCut& cut, WindowModel* candidate) const {
  SparseModel before = side_of(candidate->model, cut, false), after = side_of(candidate->model, cut, true);
  const auto tie_of = [&] { return front_tie(in_.front, in_.utimes_us, before, after); };
  const auto known = tie_of();
  if (!known) return false;
  // The sides of this cut may have been joined already with those of an earlier one.
  if (candidate->is_tied_to_front && std::abs(std::log(known->scale)) < std::log1p(o_.scale_max_change)) return true;
  adjust(&before);
  adjust(&after);
  const auto before_from_after = tie_of();
  if (!before_from_after) return false;
  SparseModel joined = join_models(*before_from_after, before, after);
  triangulate_tracks(in_.camera, in_.images, tracks_, o_.refinement, &joined);
  WindowModel tied = *candidate;
  tied.quality = model_quality(in_.camera, in_.images, joined);
  tied.model = std::move(joined);
  tied.is_tied_to_front = true;
  if (!candidate->is_tied_to_front) tied.origin += ", two sides joined by front poses";
  *candidate = std::move(tied);
  return true;
}

std::vector<ScaleCut> ModelCompletion::scale_cuts(const SparseModel& model) const {
  return check_scale(in_.camera, in_.images, tracks_, model);
}

std::set<int> ModelCompletion::torn(const SparseModel& model) const {
  return torn_off(pair_agreements(in_.pairs, model), o_.tear_max_severed, model);
}

}  // namespace rumi::ruminator
