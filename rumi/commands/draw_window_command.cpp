// SPDX-License-Identifier: BSD-3-Clause
// rumi draw-window LOG -o PNG: draws which frames were sampled around a loss.
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/report/window_picture.h"
#include "rumi/windows/window_scene.h"
#include "viewer_offscreen/picture/draw_map.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string log, out;
  int window = 0;
};

void draw(const Arguments& arguments) {
  const WindowScene scene = value_or_fail(read_window_scene(arguments.log, arguments.window));
  fail_if(viewer_offscreen::write_png(draw_window(scene), arguments.out));
}

}  // namespace

void add_draw_window_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("draw-window", "Draw which frames were sampled around a tracking loss");
  command->add_option("LOG", arguments->log, "lcm log with the images: of `rumi replay --log`, or of lcm-logger")
      ->required();
  command->add_option("-o,--output", arguments->out, "PNG file")->type_name("FILE").required();
  command->add_option("--window", arguments->window, "its number; default: the first between two submaps")
      ->in_range(1, 1'000'000'000);
  run_if_chosen(command, chosen, arguments, draw);
}

}  // namespace rumi::tool
