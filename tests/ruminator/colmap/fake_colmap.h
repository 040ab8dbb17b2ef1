// SPDX-License-Identifier: BSD-3-Clause
// The option names that `colmap mapper -h` prints on Debian 12, 13 and sid (October 2026), and a fake COLMAP that
// prints them.
#pragma once

#include <array>
#include <filesystem>
#include <sstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace rumi::testing {

struct ColmapHelp {
  const char* version;
  const char* head;            // the line that contains the version
  const char* options;         // options of all commands, and those of `mapper` without a prefix
  const char* mapper_options;  // options of `mapper` with the prefix "Mapper."
};

inline constexpr ColmapHelp kDebian12 = {
    "3.8", "COLMAP 3.8 (Commit Unknown on Unknown without CUDA)",
    "help project_path random_seed log_to_stderr log_level database_path image_path input_path output_path "
    "image_list_path",
    "min_num_matches ignore_watermarks multiple_models max_num_models max_model_overlap min_model_size init_image_id1 "
    "init_image_id2 init_num_trials extract_colors num_threads min_focal_length_ratio max_focal_length_ratio "
    "max_extra_param ba_refine_focal_length ba_refine_principal_point ba_refine_extra_params "
    "ba_min_num_residuals_for_multi_threading ba_local_num_images ba_local_function_tolerance "
    "ba_local_max_num_iterations ba_global_use_pba ba_global_pba_gpu_index ba_global_images_ratio "
    "ba_global_points_ratio ba_global_images_freq ba_global_points_freq ba_global_function_tolerance "
    "ba_global_max_num_iterations ba_global_max_refinements ba_global_max_refinement_change ba_local_max_refinements "
    "ba_local_max_refinement_change snapshot_path snapshot_images_freq fix_existing_images init_min_num_inliers "
    "init_max_error init_max_forward_motion init_min_tri_angle init_max_reg_trials abs_pose_max_error "
    "abs_pose_min_num_inliers abs_pose_min_inlier_ratio filter_max_reproj_error filter_min_tri_angle max_reg_trials "
    "local_ba_min_tri_angle tri_max_transitivity tri_create_max_angle_error tri_continue_max_angle_error "
    "tri_merge_max_reproj_error tri_complete_max_reproj_error tri_complete_max_transitivity tri_re_max_angle_error "
    "tri_re_min_ratio tri_re_max_trials tri_min_angle tri_ignore_two_view_tracks"};

inline constexpr ColmapHelp kDebian13 = {
    "3.10-dev",
    "I20261128 20:36:38.935627  7518 option_manager.cc:847] COLMAP 3.10-dev (Commit Unknown on Unknown without CUDA)",
    "help project_path random_seed log_to_stderr log_level database_path image_path input_path output_path "
    "image_list_path",
    "min_num_matches ignore_watermarks multiple_models max_num_models max_model_overlap min_model_size init_image_id1 "
    "init_image_id2 init_num_trials extract_colors num_threads min_focal_length_ratio max_focal_length_ratio "
    "max_extra_param ba_refine_focal_length ba_refine_principal_point ba_refine_extra_params "
    "ba_min_num_residuals_for_multi_threading ba_local_num_images ba_local_function_tolerance "
    "ba_local_max_num_iterations ba_global_images_ratio ba_global_points_ratio ba_global_images_freq "
    "ba_global_points_freq ba_global_function_tolerance ba_global_max_num_iterations ba_global_max_refinements "
    "ba_global_max_refinement_change ba_local_max_refinements ba_local_max_refinement_change snapshot_path "
    "snapshot_images_freq fix_existing_images init_min_num_inliers init_max_error init_max_forward_motion "
    "init_min_tri_angle init_max_reg_trials abs_pose_max_error abs_pose_min_num_inliers abs_pose_min_inlier_ratio "
    "filter_max_reproj_error filter_min_tri_angle max_reg_trials local_ba_min_tri_angle tri_max_transitivity "
    "tri_create_max_angle_error tri_continue_max_angle_error tri_merge_max_reproj_error tri_complete_max_reproj_error "
    "tri_complete_max_transitivity tri_re_max_angle_error tri_re_min_ratio tri_re_max_trials tri_min_angle "
    "tri_ignore_two_view_tracks"};

inline constexpr ColmapHelp kSid = {
    "4.2.1",
    "I20261128 20:36:38.935627  7518 option_manager.cc:1319] COLMAP 4.2.1 "
    "(Commit Unknown on Unknown without GPU support, std hash maps)",
    "help project_path default_random_seed log_target log_path log_level log_severity log_color database_path "
    "image_path input_path output_path",
    "min_num_matches ignore_watermarks multiple_models max_num_models max_model_overlap min_model_size init_image_id1 "
    "init_image_id2 init_num_trials structure_less_registration_fallback structure_less_registration_only "
    "extract_colors num_threads random_seed min_focal_length_ratio max_focal_length_ratio max_extra_param "
    "ba_refine_focal_length ba_refine_principal_point ba_refine_extra_params ba_refine_sensor_from_rig "
    "ba_local_function_tolerance ba_local_max_num_iterations ba_global_frames_ratio ba_global_points_ratio "
    "ba_global_frames_freq ba_global_points_freq ba_global_function_tolerance ba_global_max_num_iterations "
    "ba_global_max_refinements ba_global_max_refinement_change ba_local_max_refinements "
    "ba_local_max_refinement_change ba_use_gpu ba_gpu_index ba_local_backend ba_global_backend "
    "ba_min_num_residuals_for_cpu_multi_threading snapshot_path snapshot_frames_freq fix_existing_frames "
    "init_min_num_inliers init_max_error init_max_forward_motion init_min_tri_angle init_max_reg_trials "
    "abs_pose_max_error abs_pose_min_num_inliers abs_pose_min_inlier_ratio filter_max_reproj_error "
    "filter_min_tri_angle max_reg_trials ba_local_num_images ba_local_min_tri_angle "
    "ba_global_ignore_redundant_points3D ba_global_ignore_redundant_points3D_min_coverage_gain image_list_path "
    "constant_rig_list_path constant_camera_list_path max_runtime_seconds tri_max_transitivity "
    "tri_create_max_angle_error tri_continue_max_angle_error tri_merge_max_reproj_error tri_complete_max_reproj_error "
    "tri_complete_max_transitivity tri_re_max_angle_error tri_re_min_ratio tri_re_max_trials tri_min_angle "
    "tri_ignore_two_view_tracks"};

inline constexpr std::array kHelps = {&kDebian12, &kDebian13, &kSid};

inline std::string option_lines(const ColmapHelp& help) {
  std::istringstream general(help.options), mapper(help.mapper_options);
  std::string lines, name;
  while (general >> name) lines += "  --" + name + " arg (=0)\n";
  while (mapper >> name) lines += "  --Mapper." + name + " arg (=0)\n";
  return lines;
}

// Writes a script that answers `mapper -h` with the text, and refuses unknown options as COLMAP does. Otherwise it
// writes its arguments into the file `arguments` in the folder, and runs `body`. There $out is the output folder, and
// $here is `folder`.
inline std::string write_fake_colmap(const TemporaryFolder& folder, const std::string& help, const std::string& body) {
  folder.write("help", help);
  const std::string program = folder.write("colmap", "#!/bin/sh\nhere='" + folder.path().string() + R"('
if [ "$2" = -h ]; then
  cat "$here/help" >&2
  exit
fi
echo "$@" > "$here/arguments"
for word in "$@"; do
  case $word in --*) grep -q -e "$word arg" "$here/help" || {
    echo "ERROR: Failed to parse options - unrecognised option '$word'." >&2
    exit 1
  } ;;
  esac
done
while [ $# -gt 0 ]; do [ "$1" = --output_path ] && out=$2; shift; done
)" + body + "\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  return program;
}

inline std::string help_text(const ColmapHelp& help) { return std::string(help.head) + "\n" + option_lines(help); }

}  // namespace rumi::testing
