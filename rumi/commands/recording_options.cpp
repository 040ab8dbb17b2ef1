// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/recording_options.h"

#include "camera_driver/options.h"
#include "rumi/commands/command_frame.h"

namespace rumi::tool {

void add_recording_settings(CommandLine* command, std::vector<std::string>* settings) {
  command->add_option("--set", *settings, "set one option of camera_driver, may be repeated")
      ->type_name("KEY=VALUE")
      .one_each();
}

void load_recording_options(const std::vector<std::string>& settings, camera_driver::CameraOptions* options) {
  OptionTable table;
  describe(table, *options);
  refuse_if(load_options(table, "", settings));
  refuse_if(check(*options).error_text());
  if (options->loop) refuse_if("camera_driver.loop is true, and this would never end: leave it out");
}

}  // namespace rumi::tool
