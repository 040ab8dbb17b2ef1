// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/colmap_dialect.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "ruminator/colmap/colmap_environment.h"

namespace rumi::ruminator {
namespace {

enum class Need {
  kAlways,   // a COLMAP without this option is not used
  kUseful,   // without it COLMAP is slower or finds other models
  kIfThere,  // may be missing: then the wanted behaviour is COLMAP's default
};

struct Option {
  std::vector<std::string> names;  // oldest first; a version knows at most one of them
  Need need;
  std::optional<std::string> value;  // nullopt: not set by this command
};

std::vector<Option> table(const MapperCommand& command, const MapperSettings& s) {
  using enum Need;
  const auto text = [](auto value) { return fmt::format("{}", value); };
  const auto flag = [](bool value) { return std::string(value ? "1" : "0"); };
  const bool extends = !command.input_model.empty();
  const auto of_extension = [&](const std::string& value) { return extends ? std::optional(value) : std::nullopt; };
  return {
      {{"database_path"}, kAlways, command.database},
      {{"image_path"}, kAlways, command.output_folder},  // must exist; the mapper reads images only for colours
      {{"output_path"}, kAlways, command.output_folder},
      // Otherwise COLMAP would write logs into /tmp, and newer versions would colour them with terminal codes.
      {{"log_to_stderr"}, kIfThere, flag(true)},
      {{"log_target"}, kIfThere, "stderr"},
      {{"log_color"}, kIfThere, flag(false)},
      {{"random_seed", "default_random_seed"}, kUseful, text(s.random_seed)},
      {{"Mapper.random_seed"}, kIfThere, text(s.random_seed)},  // older versions use the option above
      // Option of 4.x that places images without any known point; version 4.2.1 crashes in it.
      {{"Mapper.structure_less_registration_fallback"}, kIfThere, flag(false)},
      {{"Mapper.num_threads"}, kUseful, text(s.threads)},
      {{"Mapper.extract_colors"}, kUseful, flag(false)},
      {{"Mapper.min_num_matches"}, kUseful, text(s.min_num_matches)},
      {{"Mapper.multiple_models"}, kUseful, flag(s.multiple_models)},
      {{"Mapper.max_num_models"}, kUseful, text(s.max_num_models)},
      {{"Mapper.min_model_size"}, kUseful, text(s.min_model_size)},
      {{"Mapper.init_min_tri_angle"}, kUseful, text(s.init_min_tri_angle_deg)},
      {{"Mapper.init_min_num_inliers"}, kUseful, text(s.init_min_num_inliers)},
      {{"Mapper.abs_pose_min_num_inliers"}, kUseful, text(s.abs_pose_min_num_inliers)},
      {{"Mapper.filter_max_reproj_error"}, kUseful, text(s.filter_max_reproj_error_px)},
      {{"Mapper.ba_refine_focal_length"}, kAlways, flag(false)},  // otherwise the poses would belong to another camera
      {{"Mapper.ba_refine_principal_point"}, kUseful, flag(false)},
      {{"Mapper.ba_refine_extra_params"}, kUseful, flag(false)},  // the PINHOLE model has no such parameters
      {{"Mapper.ba_local_num_images"}, kUseful, text(s.local_num_images)},
      {{"Mapper.ba_local_max_num_iterations"}, kUseful, text(s.local_max_num_iterations)},
      {{"Mapper.ba_local_max_refinements"}, kUseful, text(s.local_max_refinements)},
      {{"Mapper.ba_local_function_tolerance"}, kUseful, text(s.function_tolerance)},
      {{"Mapper.ba_global_max_num_iterations"}, kUseful, text(s.global_max_num_iterations)},
      {{"Mapper.ba_global_max_refinements"}, kUseful, text(s.global_max_refinements)},
      {{"Mapper.ba_global_images_ratio", "Mapper.ba_global_frames_ratio"}, kUseful, text(s.global_growth)},
      {{"Mapper.ba_global_points_ratio"}, kUseful, text(s.global_growth)},
      {{"Mapper.ba_global_function_tolerance"}, kUseful, text(s.function_tolerance)},
      {{"input_path"}, kAlways, of_extension(command.input_model)},
      {{"Mapper.fix_existing_images", "Mapper.fix_existing_frames"},
       kUseful,
       of_extension(flag(command.fix_existing_images))},
  };
}

// Returns the option's name in this version of COLMAP, or null if the version does not have it.
const std::string* known_name(const Option& option, const OptionNames& known) {
  const auto name =
      std::find_if(option.names.begin(), option.names.end(), [&](const std::string& n) { return known.contains(n); });
  return name == option.names.end() ? nullptr : &*name;
}

std::vector<std::string> unknown(Need need, const OptionNames& known) {
  std::vector<std::string> result;
  for (const Option& option : table({}, {}))
    if (option.need == need && !known_name(option, known))
      result.push_back(fmt::format("--{}", fmt::join(option.names, " or --")));
  return result;
}

}  // namespace

std::vector<std::string> mapper_arguments(const MapperCommand& command, const MapperSettings& settings,
                                          const OptionNames& known) {
  std::vector<std::string> arguments = {"mapper"};
  for (const Option& option : table(command, settings)) {
    const std::string* name = known_name(option, known);
    if (!name || !option.value) continue;
    arguments.push_back("--" + *name);
    arguments.push_back(*option.value);
  }
  return arguments;
}

std::vector<std::string> missing_options(const OptionNames& known) { return unknown(Need::kAlways, known); }
std::vector<std::string> options_left_out(const OptionNames& known) { return unknown(Need::kUseful, known); }

// Returns the number of images that are registered already. COLMAP 3.8 prints "Registering image #7 (12)" before it
// tries the twelfth image, 4.x prints "Registering image #7 (num_reg_frames=11)".
std::optional<int> registered_images(std::string_view line) {
  const size_t at = line.find("Registering image #");
  const size_t bracket = line.find('(', std::min(at, line.size()));
  const size_t digits = line.find_first_of("0123456789", std::min(bracket, line.size()));
  if (digits == std::string_view::npos) return std::nullopt;
  int number = 0;
  const auto read = std::from_chars(line.data() + digits, line.data() + line.size(), number);
  if (read.ec != std::errc() || number < 1) return std::nullopt;
  return digits == bracket + 1 ? number - 1 : number;
}

bool tells_of_no_model(std::string_view output) {
  return contains_any_case(output, "failed to create sparse model") ||
         contains_any_case(output, "failed to create any sparse model");
}

}  // namespace rumi::ruminator
