// SPDX-License-Identifier: BSD-3-Clause
#include "synth/options.h"

#include <fmt/format.h>

#include <cmath>

#include "synth/campus_walk.h"
#include "synth/next_room_walk.h"
#include "synth/repeating_walks.h"

namespace rumi::synth {
namespace {

Result<> range(const char* field, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return {};  // NaN fails too
  return Error{fmt::format("{} is {}: must be {} to {}{}", field, value, low, high, unit)};
}

Result<> check_seconds(WalkKind walk, double seconds) {
  if (walk == WalkKind::kNextRoom || walk == WalkKind::kTwinRooms)
    return range("seconds of the walk next-room", seconds, kMinNextRoomSeconds, kMaxNextRoomSeconds, " s");
  if (walk == WalkKind::kLoop) return {};
  if (walk == WalkKind::kCampus)
    return range("seconds of the walk campus", seconds, kMinCampusSeconds, kMaxCampusSeconds, " s");
  return range("seconds of a walk through what repeats", seconds, kMinRepeatingSeconds, kMaxRepeatingSeconds, " s");
}

// Checks that what is asked for belongs to the scene.
Result<> check_scene(const SynthOptions& o) {
  const bool street = o.scene == SceneKind::kStreet;
  if (street && o.path_file.empty() && o.walk != WalkKind::kCampus)
    return Error{"needs a path", "--scene street", "give --path FILE or --walk campus"};
  if (street && !o.path_file.empty() && o.walk != WalkKind::kLoop)
    return Error{"give one of them", "--path and --walk"};
  if (street) return {};
  if (o.walk == WalkKind::kCampus) return Error{"is a walk of --scene street only", "--walk campus"};
  if (o.vehicle) return Error{"belongs to --scene street only", "--vehicle"};
  for (const HardPassage& passage : o.hard)
    if (passage.kind == HardPassage::Kind::kLorry) return Error{"drives in --scene street only", "--hard lorry"};
  return {};
}

}  // namespace

Camera default_synth_camera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 525.0 * width / 640;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

Result<> SynthOptions::check() const {
  if (const Result<> fits = check_scene(*this); !fits) return fits;
  if (path_file.empty()) {
    if (const Result<> fits = check_seconds(walk, seconds); !fits) return fits;
  }
  for (const Result<>& fits :
       {range("seconds", seconds, 0.1, 3600, " s"), range("rate", rate_hz, 0, 1000, " Hz (0: the path's own times)"),
        range("alike", alike, 0, 1, ""), range("start", start_s, 0, 1e6, " s"),
        range("duration", duration_s, 0, 1e6, " s (0: to the end)"),
        range("blur", exposure_s, 0, 0.2, " s of shutter time"),
        range("max_sub_exposures", max_sub_exposures, 1, 64, ""), range("noise", noise, 0, 20, ""),
        range("exposure_swing", exposure_swing, 0, 0.8, ""), range("day", day, 1, 1e6, ""),
        range("traffic", traffic, 0, 5, ""), range("jpeg_quality", jpeg_quality, 1, 100, "")})
    if (!fits) return fits;
  if (const std::string error = camera.check(); !error.empty()) return Error{error, "camera"};
  if (camera.width > 4096 || camera.height > 4096)
    return Error{fmt::format("{}x{} is too large to render: at most 4096x4096", camera.width, camera.height), "camera"};
  for (const HardPassage& passage : hard) {
    for (const Result<>& fits : {range("hard passage: at", passage.at_s, 0, 1e6, " s"),
                                 range("hard passage: for", passage.for_s, 0.05, 1e6, " s"),
                                 range("hard passage: strength", passage.strength, 0, 1, "")})
      if (!fits) return fits;
  }
  return {};
}

Result<SceneKind> parse_scene_kind(const std::string& name) {
  if (name == "room") return SceneKind::kRoom;
  if (name == "street") return SceneKind::kStreet;
  return Error{fmt::format("--scene {}: must be room or street", name)};
}

Result<VehicleKind> parse_vehicle_kind(const std::string& name) {
  if (name == "car") return VehicleKind::kCar;
  if (name == "robot") return VehicleKind::kRobot;
  return Error{fmt::format("--vehicle {}: must be car or robot", name)};
}

Result<WalkKind> parse_walk_kind(const std::string& name) {
  for (const auto& [known, kind] : {std::pair{"loop", WalkKind::kLoop},
                                    {"next-room", WalkKind::kNextRoom},
                                    {"twin-rooms", WalkKind::kTwinRooms},
                                    {"storeys", WalkKind::kStoreys},
                                    {"doors", WalkKind::kDoors},
                                    {"square", WalkKind::kSquare},
                                    {"campus", WalkKind::kCampus}})
    if (name == known) return kind;
  return Error{fmt::format("--walk {}: must be loop, next-room, twin-rooms, storeys, doors, square or campus", name)};
}

Result<HardPassage::Kind> parse_hard_kind(const std::string& name) {
  using Kind = HardPassage::Kind;
  for (const auto& [known, kind] : {std::pair{"blur", Kind::kBlur},
                                    {"dark", Kind::kDark},
                                    {"textureless", Kind::kTextureless},
                                    {"rotation", Kind::kRotation},
                                    {"lorry", Kind::kLorry}})
    if (name == known) return kind;
  return Error{fmt::format("--hard {}: must be blur, dark, textureless, rotation or lorry", name)};
}

}  // namespace rumi::synth
