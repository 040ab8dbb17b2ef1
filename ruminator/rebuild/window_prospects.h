// SPDX-License-Identifier: BSD-3-Clause
// Can this window be rebuilt at all? The question is asked three times, each time with what is known by then, so that
// little time is spent on a hopeless window. Each answer is an Error with the reason, a sentence for a person, or no
// Error: go on.
//
//   at_first_look   a few images: does a long gap show anything (first_look.h), and does the camera move?
//   of_matches      all matches: do they connect the gap with the images around it, and do they show depth?
//   of_model        the finished model: do its own images prove depth (proof_of_depth.h)?
#pragma once

#include <atomic>
#include <vector>

#include "base/result.h"
#include "ruminator/model/sparse_model.h"
#include "ruminator/rebuild/build_options.h"
#include "ruminator/rebuild/window_images.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

class WindowProspects {
 public:
  // `camera`: the working camera. All arguments must outlive this.
  WindowProspects(const WindowJob& job, const Camera& camera, const BuildOptions& options,
                  const std::atomic<bool>& cancel)
      : job_(job), camera_(camera), options_(options), cancel_(cancel) {}

  Result<> at_first_look(WindowImages& images) const;
  // `pairs`: verified matches between the images.
  Result<> of_matches(const UsableImages& images, const std::vector<ImagePair>& pairs) const;
  Result<> of_model(const UsableImages& images, const std::vector<ImagePair>& pairs, const SparseModel& model) const;

 private:
  Result<> connects_gap(const UsableImages& images, const std::vector<int>& group) const;

  const WindowJob& job_;
  const Camera& camera_;
  const BuildOptions& options_;
  const std::atomic<bool>& cancel_;
};

// True if one model with so many frames of each part serves a purpose: poses for the gap, or a bridge over it.
bool is_useful(int approach, int gap, int departure);

}  // namespace rumi::ruminator
