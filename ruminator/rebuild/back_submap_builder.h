// SPDX-License-Identifier: BSD-3-Clause
// Rebuilds the frames of a window (paper, section IV.B). Keypoints and verified matches are Rumi's, the incremental
// mapping is COLMAP's. Several attempts are compared, and false solutions are refused.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "ruminator/model/front_agreement.h"
#include "ruminator/rebuild/build_options.h"
#include "ruminator/window/window_job.h"
#include "slam/map/submap.h"

namespace rumi::ruminator {

enum class BuildStage { kExtracting, kMatching, kMapping };

struct BuildProgress {
  BuildStage stage = BuildStage::kExtracting;
  double fraction = 0;      // finished share of the stage, 0 to 1
  double remaining_s = -1;  // estimated time to the end of the build; negative: unknown
};

struct BuildResult {
  // A closed submap of kind BACK, with the key (window.session, -window.id), at revision 1; or an Error with the
  // reason, a sentence for users.
  Result<Submap> submap = Error{"rebuilding gave nothing, and no reason"};
  bool cancelled = false;  // stopped on request: the job is worth another try
  bool retryable = false;  // the machine is to blame, not the window (no COLMAP, full disk, killed from outside, ...)

  int approach = 0, gap = 0, departure = 0;  // samples of each part that have a pose
  std::string warning;                       // a problem that did not prevent the submap, such as missing COLMAP
  std::string origin;                        // how the model was found
  std::vector<FrontAgreement> agreement;
  double error_px = 0;           // RMS reprojection error of the model
  int models_tried = 0;          // attempts to make a model
  double wall_s = 0, cpu_s = 0;  // time of this process and of COLMAP
};

// Rebuilds a window. Creates `work_folder` for COLMAP's files and log, and removes it unless the build fails.
// Deterministic for given job and options (one thread). If `cancel` becomes true, the build and its child processes end
// within a second.
BuildResult build_back_submap(const WindowJob& job, const BuildOptions& options, const std::string& work_folder,
                              const std::function<void(const BuildProgress&)>& progress,
                              const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
