// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/up_arguments.h"

#include <fmt/format.h>

#include <filesystem>

#include "formats/camera/camera_file.h"
#include "map_server/store/map_store.h"
#include "rumi/commands/command_frame.h"
#include "rumi/outputs/output_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

bool is_yaml(const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

void take(const std::string& flag, std::string* option) {
  if (!flag.empty()) *option = flag;
}

// Without INPUT no camera_driver is started. Then --camera gives front_tracker and ruminator their calibration, and
// other camera flags are refused.
Result<> sort_out_camera(const AllOptions& options, UpArguments* arguments) {
  if (!options.up.input.empty()) return {};
  for (const std::string& setting : arguments->camera_settings) {
    if (!setting.starts_with("--camera "))
      return Error{"there is no INPUT that this could be meant for", setting.substr(0, setting.find(' '))};
    arguments->calibration = options.camera_driver.camera_file;
    const Result<CameraFile> read = read_camera_file(arguments->calibration);
    if (!read) return read.error();
    if (!read->mask.empty())
      complain("up", fmt::format("{} is put on the images of an INPUT only: those from elsewhere carry their own",
                                 read->mask));
  }
  return {};
}

}  // namespace

bool is_file(const std::string& database) { return !database.empty() && database != map_server::kInMemory; }

Result<> sort_out(UpArguments* arguments) {
  arguments->snapshot = arguments->asked_snapshot.value_or("");
  if (arguments->asked_snapshot && arguments->snapshot.empty()) return Error{"--output is empty: give a folder"};
  for (const std::string& name : {arguments->first, arguments->second}) {
    if (name.empty()) continue;
    std::string& meant = is_yaml(name) ? arguments->config : arguments->input;
    if (!meant.empty())
      return Error{"give one INPUT, and one CONFIG, whose name ends in .yaml", fmt::format("{} and {}", meant, name)};
    meant = name;
  }
  return {};
}

Result<> read_options(UpArguments* arguments, AllOptions* options, OptionTable* table) {
  describe(*table, *options);
  std::vector<std::string> settings = arguments->settings;
  settings.insert(settings.end(), arguments->camera_settings.begin(), arguments->camera_settings.end());
  if (const std::string problem = load_options(*table, arguments->config, settings); !problem.empty())
    return Error{problem};
  take(arguments->input, &options->up.input);
  take(arguments->up.lcm_url, &options->up.lcm_url);
  take(arguments->up.channel_prefix, &options->up.channel_prefix);
  take(arguments->up.channel, &options->up.channel);
  if (arguments->fresh && options->map_server.localize_only)
    return Error{"--fresh: there would be no map to localize in (map_server.localize_only)"};
  if (const Result<> camera = sort_out_camera(*options, arguments); !camera) return camera;
  // The outputs must not replace a map that goes on, which map_server has open.
  if (!arguments->snapshot.empty() && is_file(options->map_server.database))
    if (const Result<> stays = check_map_stays(options->map_server.database, arguments->snapshot); !stays) return stays;
  return check(options->camera_driver);
}

}  // namespace rumi::tool
