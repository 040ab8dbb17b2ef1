// SPDX-License-Identifier: BSD-3-Clause
// Rebuilds the frames of a window with COLMAP (paper, section IV.B): keypoints and verified matches are ours, the
// incremental mapping is COLMAP's, several attempts are compared and false solutions refused.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

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
  std::optional<Submap> submap;  // kind BACK, key (window.session, -window.id), closed, revision 1
  std::string failure;           // why there is none; a sentence for a person
  bool cancelled = false;        // asked to stop: the job is worth another try
  bool retryable = false;        // the machine failed, not the window: no COLMAP, disk full, killed from outside

  // Frames registered of those sampled.
  int approach = 0, gap = 0, departure = 0;
  std::string warning;  // of what went wrong on the way and was not needed, e.g. no COLMAP
  std::string origin;   // how the model was found
  std::vector<FrontAgreement> agreement;
  double error_px = 0;           // RMS reprojection error
  int models_tried = 0;          // mapper runs
  double wall_s = 0, cpu_s = 0;  // ours and COLMAP's
};

// `work_folder` is made, used for COLMAP's files and log, and removed unless the build fails. Deterministic for a job
// and options (one thread). `cancel` ends it within a second, children included.
BuildResult build_back_submap(const WindowJob& job, const BuildOptions& options, const std::string& work_folder,
                              const std::function<void(const BuildProgress&)>& progress,
                              const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
