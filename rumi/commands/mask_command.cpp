// SPDX-License-Identifier: BSD-3-Clause
// rumi mask: what never moves in the images of a recording, as a mask for its camera.
#include <fmt/format.h>

#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "base/exit_codes.h"
#include "base/log.h"
#include "base/whole_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "camera_driver/flags.h"
#include "camera_driver/open_source.h"
#include "camera_driver/options.h"
#include "front_tracker/masking/still_parts.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/progress_line.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string input, output;
  camera_driver::CameraOptions camera;
  std::vector<std::string> settings;
};

// White, of the image's size, where nothing is left out: something to draw on.
cv::Mat pixels_of(const ImageMask& mask, const cv::Size& size) {
  return mask.is_everything() ? cv::Mat(size, CV_8U, cv::Scalar(255)) : mask.pixels();
}

int run_mask(const Arguments& arguments) {
  camera_driver::OpenedSource opened = camera_driver::open_recording(arguments.input, arguments.camera);
  fail_if(opened.error);
  front_tracker::StillParts still;
  ProgressLine line(true);
  int64_t images = 0;
  cv::Size size;
  while (const auto image = opened.source->next()) {
    std::string error;
    const cv::Mat grey = decode_grey(*image, &error);
    if (grey.empty()) continue;
    size = grey.size();
    still.add(image->utime, grey);
    ++images;
    line.update(images, opened.source->total(),
                [&] { return fmt::format("{} of {} images", images, opened.source->total()); });
  }
  line.erase();
  fail_if(images == 0 ? arguments.input + ": no image can be read" : "");
  WholeFile file(arguments.output);
  file.write(encode_mask(pixels_of(still.mask(), size)));
  fail_if(file.commit());
  if (still.mask().is_everything())
    fmt::print(
        "nothing of the image is found to stay where it is ({} of {} images moved enough to tell): {} is white\n",
        still.looks(), images, arguments.output);
  else
    fmt::print("{:.1f} % of the image never moves: black in {}. Look at it and edit it; then use it with --mask\n",
               100 * still.mask().left_out(), arguments.output);
  return 0;
}

int run(Arguments& arguments) {
  OptionTable table;
  describe(table, arguments.camera);
  refuse_if(load_options(table, "", arguments.settings));
  refuse_if(check(arguments.camera));
  if (arguments.camera.loop) refuse_if("camera_driver.loop is true, and this would never end: leave it out");
  start_logging("rumi", false, false);
  return run_mask(arguments);
}

}  // namespace

void add_mask_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command(
      "mask", "Find what never moves in a recording's images (a bonnet, a caption), as a mask to be edited");
  command->add_option("RECORDING", arguments->input, "dataset folder, folder of images, video, lcm log or ROS bag")
      ->required();
  command
      ->add_option("-o,--output", arguments->output, "PNG of the images' size: black is left out, white is the world")
      ->type_name("FILE")
      .required();
  command->add_option("--set", arguments->settings, "set one option of camera_driver, may be repeated")
      ->type_name("KEY=VALUE")
      .one_each();
  camera_driver::add_flags(*command, {"--camera", "--every", "--start", "--duration", "--log-channel", "--rate"},
                           &arguments->settings);
  run_if_chosen(command, chosen, arguments, run);
}

}  // namespace rumi::tool
