// SPDX-License-Identifier: BSD-3-Clause
// rumi synth: renders a sequence of images with its true path.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>

#include "formats/camera/camera_file.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "synth/write_sequence.h"

namespace rumi::tool {
namespace {

volatile std::sig_atomic_t g_stop = 0;

struct Flags {
  synth::SynthOptions synth;
  std::string folder, camera_file, size, scene = "room", walk = "loop", vehicle;
  std::vector<std::string> hard;
  std::vector<double> at_s, for_s;
  bool overwrite = false, quiet = false;
};

// Sets options from --size, --camera, and --hard with --at and --for. An Error names the flag that is wrong.
Result<> resolve(Flags& f) {
  if (!f.size.empty() && !f.camera_file.empty())
    return Error{"give one of them, the camera file has a size", "--size and --camera"};
  if (!f.size.empty()) {
    int width = 0, height = 0, used = 0;
    if (std::sscanf(f.size.c_str(), "%dx%d%n", &width, &height, &used) != 2 || used != static_cast<int>(f.size.size()))
      return Error{fmt::format("--size {}: must be WIDTHxHEIGHT, for example 640x480", f.size)};
    f.synth.camera = synth::default_synth_camera(width, height);
  }
  if (!f.camera_file.empty()) {
    const Result<CameraFile> read = read_camera_file(f.camera_file);
    if (!read) return read.error();
    log_notes(*read);
    f.synth.camera = read->camera;
  }
  const Result<synth::SceneKind> scene = synth::parse_scene_kind(f.scene);
  if (!scene) return scene.error();
  f.synth.scene = *scene;
  if (!f.vehicle.empty()) {
    const Result<synth::VehicleKind> vehicle = synth::parse_vehicle_kind(f.vehicle);
    if (!vehicle) return vehicle.error();
    f.synth.vehicle = *vehicle;
  }
  const Result<synth::WalkKind> walk = synth::parse_walk_kind(f.walk);
  if (!walk) return walk.error();
  f.synth.walk = *walk;
  if (f.hard.size() != f.at_s.size() || f.hard.size() != f.for_s.size())
    return Error{fmt::format("--hard was given {} times, --at {} and --for {}: each hard passage needs all three",
                             f.hard.size(), f.at_s.size(), f.for_s.size())};
  f.synth.hard.clear();
  for (size_t i = 0; i < f.hard.size(); ++i) {
    const Result<synth::HardPassage::Kind> kind = synth::parse_hard_kind(f.hard[i]);
    if (!kind) return kind.error();
    f.synth.hard.push_back({*kind, f.at_s[i], f.for_s[i]});
  }
  return f.synth.check();
}

void render(Flags& f) {
  refuse_if(resolve(f));
  const bool live = !f.quiet && isatty(STDERR_FILENO);
  int frames = 0;
  const auto progress = [&](int done, int all) {
    frames = done;
    if (live && (done % 10 == 0 || done == all))
      fmt::print(stderr, "\rframe {}/{}{}", done, all, done == all ? "\n" : "");
    return !g_stop;
  };
  std::signal(SIGINT, [](int) { g_stop = 1; });
  std::signal(SIGTERM, [](int) { g_stop = 1; });
  const Result<> written = synth::write_sequence(f.synth, f.folder, f.overwrite, progress);
  if (!written && live) fmt::print(stderr, "\n");
  fail_if(written);
  if (!f.quiet) fmt::print("{}: {} frames, {}x{}\n", f.folder, frames, f.synth.camera.width, f.synth.camera.height);
}

void add_street_options(CommandLine* sub, Flags* f) {
  sub->add_option("--scene", f->scene,
                  "room, or street: a town along --path, which may be kilometres long, or a campus (--walk campus)")
      ->show_default();
  sub->add_option("--vehicle", f->vehicle,
                  "in a street: car, the camera 1.65 m above the road, or robot, 0.5 m above it and shaking (default: "
                  "car along --path, robot on a campus)");
  sub->add_option("--day", f->synth.day,
                  "of a street: another day has other light, parked cars, traffic and people, and the same houses")
      ->show_default();
  sub->add_option("--traffic", f->synth.traffic, "in a street: cars and people that move, times the usual; 0: none")
      ->show_default();
}

void add_hard_options(CommandLine* sub, Flags* f) {
  sub->add_option("--hard", f->hard,
                  "a hard passage: blur, dark, textureless, rotation or (in a street) lorry; with --at and --for; may "
                  "be repeated")
      ->one_each();
  sub->add_option("--at", f->at_s, "seconds after the first image at which the hard passage begins")->one_each();
  sub->add_option("--for", f->for_s, "seconds that it lasts")->one_each();
}

}  // namespace

void add_synth_command(CommandLine& app, std::function<int()>* chosen) {
  CommandLine* sub = app.add_command(
      "synth", "Render a sequence of a furnished room or a street with its true path, as a TUM-style folder");
  auto f = std::make_shared<Flags>();
  sub->add_option("-o,--output", f->folder, "folder to write")->type_name("FOLDER").required();
  sub->add_flag("--overwrite", f->overwrite, "into a folder that holds a sequence already");
  sub->add_option("--seed", f->synth.seed, "number that chooses the room, the walk and the noise")->show_default();
  add_street_options(sub, f.get());
  sub->add_option(
         "--walk", f->walk,
         "without --path: loop, a walk about in a room; next-room, a walk into a second room, with a dark turn in "
         "the doorway between them, of which nothing is seen from either room; or a walk in a scene that repeats, on "
         "which nothing is seen for a while: twin-rooms (next-room, and the second room equals the first), storeys, "
         "doors (of a corridor), square (four equal sides); in a street: campus, a robot's round at 1.2 m/s that "
         "crosses itself and comes back to its ways")
      ->show_default();
  sub->add_option("--alike", f->synth.alike,
                  "in a scene that repeats: share of the things that each copy has; it leaves out others than the rest")
      ->show_default();
  sub->add_option("--seconds", f->synth.seconds, "length of the walk without --path")->show_default();
  sub->add_option("--rate", f->synth.rate_hz, "images per second; 0: 30, or the times of --path")->show_default();
  sub->add_option("--size", f->size, "in pixels, with a TUM camera's field of view (default 640x480)")
      ->type_name("WIDTHxHEIGHT");
  sub->add_option("--camera", f->camera_file, "calibration file; its lens distortion is rendered")->type_name("FILE");
  sub->add_option("--path", f->synth.path_file,
                  "move along a TUM trajectory (time tx ty tz qx qy qz qw, the camera in the room)")
      ->type_name("FILE");
  sub->add_option("--start", f->synth.start_s, "seconds into the path")->show_default();
  sub->add_option("--duration", f->synth.duration_s, "seconds of it; 0: to its end")->show_default();
  sub->add_option("--blur", f->synth.exposure_s, "shutter time in seconds: motion blur; 0: none")->show_default();
  sub->add_option("--noise", f->synth.noise, "sensor noise, times the default; 0: none")->show_default();
  sub->add_option("--exposure", f->synth.exposure_swing,
                  "slow change of the exposure, fraction; 0: none, and in a street no automatic exposure either")
      ->show_default();
  sub->add_flag("--grey", f->synth.grey, "grey images");
  sub->add_option("--quality", f->synth.jpeg_quality, "of the JPEG files, 1 to 100")->show_default();
  add_hard_options(sub, f.get());
  sub->add_flag("-q,--quiet", f->quiet, "no progress, no summary");
  run_if_chosen(sub, chosen, f, render);
}

}  // namespace rumi::tool
