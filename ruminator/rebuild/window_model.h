// SPDX-License-Identifier: BSD-3-Clause
// Builds the model of a window: makes several attempts, completes and adjusts all of them alike, and chooses the best
// credible one.
//
// 1. the global model (global_model.h), as it is and extended by COLMAP's mapper;
// 2. if that leaves images out, or is not credible, COLMAP's mapper alone, from several first pairs;
// 3. if too few of the images that front_tracker knows are left, because they were torn off (torn_model.h): the same
//    attempts with a wider limit for tears, on the models that COLMAP made before.
// A window by place is not cut around one motion, and may have parts that nothing but a mistake connects. A window by
// time of which front_tracker knows little has nothing that could contradict a wrong model. So models of these need a
// witness: of the model that is grown out of the map's poses, the global model and one of COLMAP's, two must agree on
// an image. By place, half of all images end the attempts, because the others come into a further window.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <optional>
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
  enum class Beginning { kMap, kGlobal, kPair };
  Beginning begun = Beginning::kPair;  // with the map's poses, with all images at once, or by COLMAP with a pair
  int broken_off = 0;  // images left out because nothing determines their position or scale relative to the others
  bool is_tied_to_front = false;  // front_tracker's poses determine the scales of its parts
  // Median difference between the model's relative rotations and those of the pairs' essential matrices.
  double pair_rotation_deg = 0;
  std::vector<FrontAgreement> agreement;
  Result<> credible;  // an Error with the reason if the model is not credible
};

struct WindowModelResult {
  Result<WindowModel> best = Error{"no model found"};
  bool retryable = false, cancelled = false;
  std::string warning;  // a problem that did not prevent the model, such as missing COLMAP
  int attempts = 0;
  double child_cpu_s = 0;
};

struct WindowModelInput {
  const Camera& camera;
  const std::vector<WindowImage>& images;
  const std::vector<int64_t>& utimes_us;  // times of the images
  const std::vector<ImagePair>& pairs;
  const std::vector<Sample>& front;  // samples for which front_tracker has poses
  bool by_place = false;             // see RuminationWindow

  // Returns the index of the image of a sample; nullopt if it has none.
  std::optional<int> image_of(const Sample& sample) const {
    const auto found = std::find(utimes_us.begin(), utimes_us.end(), sample.utime_us);
    if (found == utimes_us.end()) return std::nullopt;
    return static_cast<int>(found - utimes_us.begin());
  }

  // True for windows by place, and for those by time of which front_tracker knows less than half of the images.
  bool needs_witness() const { return by_place || 2 * front.size() < images.size(); }
};

// Sets agreement, pair_rotation_deg and credible of a candidate whose model and quality are set already. `rotations`:
// see relative_rotations().
void judge_model(const WindowModelInput& input, const std::vector<RelativeRotation>& rotations,
                 const BuildOptions& options, WindowModel* candidate);

// Compares the shape of the global model with that of a rival, which COLMAP's mapper began with one pair of images.
// Returns an Error if they differ too much: two models that contradict each other cannot both be right, and the rival's
// first pair may be a wrong one. The rival may have more images.
Result<> compare_shapes(const SparseModel& global, const SparseModel& rival, const std::vector<int64_t>& utimes_us,
                        const BuildOptions& options);

// `work_folder` must exist; the database, the models and the log are left in it.
WindowModelResult build_window_model(const WindowModelInput& input, const BuildOptions& options,
                                     const std::string& work_folder,
                                     const std::function<void(double fraction)>& progress,
                                     const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
