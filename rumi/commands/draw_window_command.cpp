// SPDX-License-Identifier: BSD-3-Clause
// rumi draw-window LOG -o PNG: which frames were sampled around a loss.
#include <fmt/format.h>

#include <memory>

#include "base/command_line.h"
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

int draw(const Arguments& arguments) {
  const WindowSceneResult result = read_window_scene(arguments.log, arguments.window);
  std::string error = result.error;
  if (error.empty()) error = viewer_offscreen::write_png(draw_window(result.scene), arguments.out);
  if (error.empty()) return 0;
  fmt::print(stderr, "rumi draw-window: {}\n", error);
  return 1;
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
  command->on_chosen([arguments, chosen] { *chosen = [arguments] { return draw(*arguments); }; });
}

}  // namespace rumi::tool
