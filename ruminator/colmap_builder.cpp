// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap_builder.h"

#include "ruminator/colmap/colmap_program.h"

namespace rumi::ruminator {

ColmapBuilder colmap_builder(const BuildOptions& options) {
  BuildOptions with_program = options;
  with_program.colmap_program = std::make_shared<ColmapProgram>(options.colmap);
  with_program.colmap_program->begin_asking();
  const Builder builder = [with_program](const WindowJob& job, const std::string& work_folder,
                                         const std::function<void(const BuildProgress&)>& progress,
                                         const std::atomic<bool>& cancel) {
    return build_back_submap(job, with_program, work_folder, progress, cancel);
  };
  return {builder, [program = with_program.colmap_program] { return program->problem(); }};
}

}  // namespace rumi::ruminator
