// SPDX-License-Identifier: BSD-3-Clause
// rumi mask: finds what never moves in the images of a recording, and writes it as a mask for its camera.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "base/files/whole_file.h"
#include "base/running/log.h"
#include "base/this_process/exit_codes.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/working_image.h"
#include "camera_driver/flags.h"
#include "camera_driver/open_source.h"
#include "formats/recording/mask_option.h"
#include "front_tracker/masking/still_parts.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/progress_line.h"
#include "rumi/commands/recording_options.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string input, output;
  camera_driver::CameraOptions camera;
  std::vector<std::string> settings;
};

Result<> check_output(const std::string& file) {
  std::error_code code;
  if (std::filesystem::path(file).extension() != ".png") return Error{"must be a PNG: give NAME.png", file};
  // An existing mask is not replaced, because the user may have edited it.
  if (std::filesystem::exists(file, code)) return Error{"exists", file, "remove it or give another name"};
  return check_writable(file);
}

struct Looked {
  int64_t images = 0;
  ImageMask mask;  // as front_tracker learns it, in the size of its working images
  int looks = 0;   // images that differed enough from the one before to be compared with it
};

Looked look_at(camera_driver::ImageSource& source) {
  const Camera& camera = source.camera();
  const Camera working = working_camera(camera, kDefaultMaxImageSide);
  front_tracker::StillParts still;
  Looked looked;
  ProgressLine line(true);
  while (const auto image = source.next()) {
    const cv::Mat grey = decode_working_image(*image, camera, working).value_or(cv::Mat());
    if (grey.empty()) continue;
    still.add(image->utime, grey);
    ++looked.images;
    line.update(looked.images, source.total(),
                [&] { return fmt::format("{} of {} images", looked.images, source.total()); });
  }
  line.erase();
  looked.mask = still.mask();
  looked.looks = still.looks();
  return looked;
}

// Writes the mask even if nothing is left out: then all of it is white, and the user can draw on it.
Result<> write_mask(const ImageMask& mask, const Camera& camera, const std::string& name) {
  const cv::Size size(camera.width, camera.height);
  WholeFile file(name);
  file.write(encode_mask(mask.is_everything() ? cv::Mat(size, CV_8U, cv::Scalar(255)) : mask.resized(size).pixels()));
  return file.commit();
}

int run_mask(const Arguments& arguments) {
  fail_if(check_output(arguments.output));
  const auto opened = value_or_fail(camera_driver::open_recording(arguments.input, arguments.camera));
  camera_driver::ImageSource& source = *opened;
  const Looked looked = look_at(source);
  fail_if(looked.images == 0 ? arguments.input + ": no image can be read" : "");
  fail_if(write_mask(looked.mask, source.camera(), arguments.output));
  if (looked.mask.is_everything())
    fmt::print("{} is white: nothing is known to stay where it is ({} of {} images had moved on enough to tell)\n",
               arguments.output, looked.looks, looked.images);
  else
    fmt::print("{}: {:.1f} % of the image never moves, and is black (of {} images {} had moved on enough to tell)\n",
               arguments.output, 100 * looked.mask.left_out(), looked.images, looked.looks);
  fmt::print(
      "Look at it, draw in it what it lacks, and give it with --mask, or leave it as mask.png beside the data\n");
  const std::vector<std::string> complaints = source.skipped().complaints(looked.images);
  for (const std::string& complaint : complaints) complain("mask", complaint);
  return complaints.empty() ? 0 : kNotAll;
}

int run(Arguments& arguments) {
  load_recording_options(arguments.settings, &arguments.camera);
  arguments.camera.mask = kNoMask;  // a mask beside the recording is not used, as it may be the one to be replaced
  start_logging("rumi", false, false);
  return run_mask(arguments);
}

}  // namespace

void add_mask_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command =
      app.add_command("mask", "Find what never moves in a recording's images (a bonnet, a caption), as a mask to edit");
  command->add_option("RECORDING", arguments->input, "dataset folder, folder of images, video, lcm log or ROS bag")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "NAME.png, of the images' size: black is left out, white is the world; must not exist")
      ->type_name("FILE")
      .required();
  add_recording_settings(command, &arguments->settings);
  camera_driver::add_flags(*command, {"--camera", "--every", "--start", "--duration", "--log-channel", "--rate"},
                           &arguments->settings);
  command->footer(
      "The result is a beginning: what mirrors the world, or is of one colour, is not all found. Any program that "
      "draws can mend it. front_tracker learns the same by itself while it runs; a mask that is given holds from the "
      "first "
      "image on. Exit codes: 0 written; 1 not written; 2 wrong options; 3 written, but not all images could be used.");
  run_if_chosen(command, chosen, arguments, run);
}

}  // namespace rumi::tool
