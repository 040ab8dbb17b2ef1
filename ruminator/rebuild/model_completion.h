// SPDX-License-Identifier: BSD-3-Clause
// Completes a model, in the same way for all candidates, so that they can be compared: triangulates points from the
// tracks, adjusts all with the calibrated camera, repairs slips of the scale, regrows torn parts, tries again to add
// images that were left out, and joins parts of unknown relative scale by front_tracker's poses. Leaves out what
// remains unrelated.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "ruminator/model/model_joining.h"
#include "ruminator/rebuild/window_model.h"

namespace rumi::ruminator {

class ModelCompletion {
 public:
  // Both arguments must outlive this object.
  ModelCompletion(const WindowModelInput& input, const BuildOptions& options);

  // Returns a candidate with model, origin, quality, broken_off and is_tied_to_front set; judge_model() sets the rest.
  WindowModel complete(SparseModel model, std::string origin) const;
  // Returns the candidate with the images `kept` only, adjusted.
  WindowModel reduced(WindowModel candidate, const std::set<int>& kept) const;
  // Joins every two models that have enough points in common. Returns the results that have more images than each of
  // their two models.
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
