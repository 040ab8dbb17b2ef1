// SPDX-License-Identifier: BSD-3-Clause
// Decides whether a window can be rebuilt at all. This is asked three times, each time with what is known by then, so
// that little time is wasted on a hopeless window. Each answer is an Error with the reason, a sentence for users, or no
// Error if the rebuild shall go on.
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
  // `camera`: the working camera. All arguments must outlive this object.
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

// True if one model with this many frames of each part is useful: it has poses for the gap, or bridges it.
bool is_useful(int approach, int gap, int departure);

}  // namespace rumi::ruminator
