// SPDX-License-Identifier: BSD-3-Clause
// The model of a window: several attempts, each completed and adjusted alike, and the best of them that is credible.
//
// 1. the global model (global_model.h), extended by COLMAP's mapper, whose bundle adjustment is free to change the
//    focal lengths: a false solution bends them;
// 2. if that leaves images out, or is not credible, COLMAP's mapper alone, from several first pairs;
// 3. if all images that front_tracker knows were torn off (torn_model.h), the same with a wider limit for tears.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "ruminator/colmap/colmap_mapper.h"
#include "ruminator/model/front_agreement.h"
#include "ruminator/rebuild/build_options.h"

namespace rumi::ruminator {

struct WindowModel {
  SparseModel model;
  std::string origin;  // "global model, COLMAP", "COLMAP, first pair at 8 degrees", ...
  ModelQuality quality;
  int broken_off = 0;             // images left out because nothing connects them, or their scale, to the others
  bool is_tied_to_front = false;  // front_tracker's poses give the scales of its parts
  // Median difference between the model's relative rotations and those of the pairs' essential matrices.
  double pair_rotation_deg = 0;
  std::vector<FrontAgreement> agreement;
  Result<> credible;  // an Error says why it is not
};

struct WindowModelResult {
  Result<WindowModel> best = Error{"no model found"};
  bool retryable = false, cancelled = false;
  std::string warning;  // a problem that did not prevent a model, such as missing COLMAP
  int attempts = 0;
  double child_cpu_s = 0;
};

struct WindowModelInput {
  const Camera& camera;
  const std::vector<WindowImage>& images;
  const std::vector<int64_t>& utimes_us;  // of the images
  const std::vector<ImagePair>& pairs;
  const std::vector<Sample>& front;  // samples that front_tracker has poses of
};

// Sets agreement, pair_rotation_deg and credible of a candidate whose model and quality are known. `rotations`: see
// relative_rotations.
void judge_model(const WindowModelInput& input, const std::vector<RelativeRotation>& rotations,
                 const BuildOptions& options, WindowModel* candidate);

// Compares the shape of the global model with that of a rival, which COLMAP's mapper began with a pair of images. An
// Error says how they differ. The rival may be larger, but two models that contradict each other cannot both be right,
// and the first pair may be a wrong one.
Result<> compare_shapes(const SparseModel& global, const SparseModel& rival, const std::vector<int64_t>& utimes_us,
                        const BuildOptions& options);

// `work_folder` exists; the database, the models and the log stay in it.
WindowModelResult build_window_model(const WindowModelInput& input, const BuildOptions& options,
                                     const std::string& work_folder,
                                     const std::function<void(double fraction)>& progress,
                                     const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
