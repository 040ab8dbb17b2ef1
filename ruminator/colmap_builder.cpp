// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap_builder.h"

namespace rumi::ruminator {

Builder colmap_builder(const BuildOptions& options) {
  return [options](const WindowJob& job, const std::string& work_folder,
                   const std::function<void(const BuildProgress&)>& progress, const std::atomic<bool>& cancel) {
    return build_back_submap(job, options, work_folder, progress, cancel);
  };
}

}  // namespace rumi::ruminator
