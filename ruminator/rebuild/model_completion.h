// SPDX-License-Identifier: BSD-3-Clause
// Completes a model, in the same way for every candidate, so that they can be compared. It triangulates points from the
// tracks, adjusts everything with the calibrated camera, repairs slips of the scale, grows anew what is torn off, tries
// once more the images that were left out, and ties sides of unrelated scale by front_tracker's poses. What then does
// not belong together is left out.
#pragma once

#include <string>
#include <vector>

#include "ruminator/model/model_joining.h"
#include "ruminator/rebuild/window_model.h"

namespace rumi::ruminator {

class ModelCompletion {
 public:
  // Both arguments must outlive this.
  ModelCompletion(const WindowModelInput& input, const BuildOptions& options);

  // Returns a candidate with model, origin, quality and broken_off set, not yet judged.
  WindowModel complete(SparseModel model, std::string origin) const;
  // Joins every two models that have enough points in common to make a larger one.
  std::vector<SparseModel> joined(const std::vector<SparseModel>& models) const;

 private:
  ModelQuality settle(SparseModel* model) const;
  ModelQuality adjust(SparseModel* model) const;
  void repair_slips(ModelQuality* quality, SparseModel* model) const;
  bool regrow_torn(SparseModel* model) const;
  void complete_images(SparseModel* model) const;
  std::set<int> known_to_front() const;
  void drop_unrelated(WindowModel* candidate) const;
  void trim_new_ends(WindowModel* candidate) const;
  std::optional<ScaleCut> front_break(const std::vector<ScaleCut>& cuts, const SparseModel& model) const;
  bool tie_to_front(const ScaleCut& cut, WindowModel* candidate) const;
  std::vector<ScaleCut> scale_cuts(const SparseModel& model) const;
  std::set<int> torn(const SparseModel& model) const;

  const WindowModelInput& in_;
  const BuildOptions& o_;
  std::vector<Track> tracks_;
};

}  // namespace rumi::ruminator
