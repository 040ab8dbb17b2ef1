// SPDX-License-Identifier: BSD-3-Clause
// rumi view MAP -o PNG: draws a map.
#include <fmt/format.h>

#include <map>
#include <memory>
#include <optional>

#include "base/running/failures.h"
#include "formats/truth/truth.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/outputs/map_file.h"
#include "viewer_offscreen/picture/draw_map.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string map, out, groundtruth, title, view = "all";
  TruthOptions truth;
};

const std::map<std::string, std::optional<viewer_offscreen::ViewKind>> kViews = {
    {"all", std::nullopt},
    {"oblique", viewer_offscreen::ViewKind::kOblique},
    {"top", viewer_offscreen::ViewKind::kTop},
    {"side", viewer_offscreen::ViewKind::kSide},
    {"follow", viewer_offscreen::ViewKind::kFollow}};

void view(const Arguments& arguments) {
  const map_server::Atlas atlas = load_map(map_database_at(arguments.map));
  AtlasPicture shown = make_picture(atlas, arguments.title.empty() ? arguments.map : arguments.title);
  viewer_offscreen::MapPicture& picture = shown.picture;
  if (!arguments.groundtruth.empty()) {
    const TruthFile truth = read_groundtruth(arguments.groundtruth, arguments.truth);
    fail_if(truth.error);
    for (const std::string& note : truth.notes) fmt::print(stderr, "{}\n", note);
    for (const TimedPose& pose : truth.poses) picture.groundtruth[pose.utime_us] = pose.map_from_cam.translation;
  }
  fail_if(viewer_offscreen::write_png(viewer_offscreen::draw_map(picture, kViews.at(arguments.view)), arguments.out));
  fmt::print("picture written to {}\n", arguments.out);
}

}  // namespace

void add_view_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("view", "Draw a map, as a PNG");
  command->add_option("MAP", arguments->map, "output folder of a run, or map.db of one or of a running map_server")
      ->required();
  command->add_option("-o,--output", arguments->out, "PNG file")->type_name("FILE").required();
  command->add_option("--groundtruth", arguments->groundtruth, "true path to draw beside it, see `rumi evaluate`")
      ->type_name("FILE");
  command
      ->add_option("--groundtruth-rate", arguments->truth.frames_per_second,
                   "the truth counts images at this rate, Hz, see `rumi evaluate`; 0: it has times")
      ->not_negative()
      ->show_default();
  command->add_option("--title", arguments->title, "above the picture (MAP)")->type_name("TEXT");
  command->add_option("--view", arguments->view, "all, or one that fills the picture: oblique, top, side, follow")
      ->one_of({"all", "oblique", "top", "side", "follow"})
      ->show_default();
  run_if_chosen(command, chosen, arguments, view);
}

}  // namespace rumi::tool
