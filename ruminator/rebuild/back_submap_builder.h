// SPDX-License-Identifier: BSD-3-Clause
// Rebuilds the frames of a window with COLMAP (paper, section IV.B): keypoints and verified matches are ours, the
// incremental mapping is COLMAP's, several attempts are compared and false solutions refused.
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
  double fraction = 0;      // 0..1 within the stage
  double remaining_s = -1;  // estimate to the end of the build; negative: unknown
};

struct BuildResult {
  // Kind BACK, key (window.session, -window.id), closed, revision 1. An Error says why there is none, in a sentence for
  // a person.
  Result<Submap> submap = Error{"rebuilding gave nothing, and no reason"};
  bool cancelled = false;  // asked to stop: the job is worth another try
  bool retryable = false;  // the machine failed, not the window: no COLMAP, disk full, killed from outside

  int approach = 0, gap = 0, departure = 0;  // frames registered, of those sampled
  std::string warning;                       // a problem that did not prevent a submap, such as missing COLMAP
  std::string origin;                        // how the model was found
  std::vector<FrontAgreement> agreement;
  double error_px = 0;           // RMS reprojection error
  int models_tried = 0;          // mapper runs
  double wall_s = 0, cpu_s = 0;  // our time and COLMAP's
};

// Creates `work_folder`, keeps COLMAP's files and log there, and removes it unless the build fails. Deterministic for a
// job and options (one thread). `cancel` ends the build within a second, child processes included.
BuildResult build_back_submap(const WindowJob& job, const BuildOptions& options, const std::string& work_folder,
                              const std::function<void(const BuildProgress&)>& progress,
                              const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
