// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "slam/geometry/camera.h"

namespace rumi::synth {

// A stretch of the sequence that is hard to track.
struct HardPassage {
  enum class Kind {
    kBlur,         // out of focus
    kDark,         // a few grey levels, and noise
    kTextureless,  // everything in sight becomes one blank surface
    kRotation,     // the camera turns fast about the vertical, and back
    kLorry,        // in a street: a lorry overtakes, covers most of the image, and leaves
  };
  Kind kind = Kind::kBlur;
  double at_s = 0;      // seconds after the first frame
  double for_s = 0;     // duration, s
  double strength = 1;  // 0 .. 1; 1 is the full effect
};

// Returns a camera with the field of view of TUM RGB-D: fx = fy = 525 at 640 pixels of width.
Camera default_synth_camera(int width, int height);

enum class SceneKind {
  kRoom,
  kStreet,  // see street_scene.h
};

// Carries the camera in a street.
enum class VehicleKind {
  kCar,    // 1.65 m above the road
  kRobot,  // 0.5 m above it, and shaking
};

// A walk that synth makes up.
enum class WalkKind {
  kLoop,      // around the middle of a room
  kNextRoom,  // lost on the way into the next room: see next_room_walk.h
  // Lost in scenes that repeat: see repeating_walks.h.
  kTwinRooms,
  kStoreys,
  kDoors,
  kSquare,
  kCampus,  // a robot's round on the ways of a campus, in a street scene: see campus_walk.h
};

struct SynthOptions {
  uint64_t seed = 1;  // seed of everything random: the room, its contents, the walk, the noise
  SceneKind scene = SceneKind::kRoom;
  WalkKind walk = WalkKind::kLoop;
  std::optional<VehicleKind> vehicle;  // of a street; otherwise a robot on a campus, and a car along a path
  int day = 1;                         // of a street: another day has another light, and other cars and people
  double traffic = 1;                  // of a street: share of what moves; 0: nothing
  double seconds = 20;                 // length of the walk without a path file
  double rate_hz = 0;                  // 0: the times of the path file; without one, 30
  std::string path_file;               // TUM trajectory (map_from_cam: t tx ty tz qx qy qz qw); empty: the walk above
  double alike = 1;       // of scenes that repeat: share of the things that each copy has; it leaves out others
  double start_s = 0;     // seconds into the path
  double duration_s = 0;  // seconds of the path; 0: to its end
  Camera camera = default_synth_camera(640, 480);
  double exposure_s = 0.008;     // shutter time, which causes motion blur; 0: no blur
  int max_sub_exposures = 8;     // images that are averaged if the picture moves fast, at most
  double noise = 1;              // times the default sensor noise (read 1.2 grey levels, shot 2.2 at mid grey); 0: none
  double exposure_swing = 0.15;  // slow change of the gain, as a share of it
  bool grey = false;             // grey images; otherwise colour
  int jpeg_quality = 92;
  std::vector<HardPassage> hard;

  // Returns whether a robot carries the camera.
  bool robot() const {
    return vehicle ? *vehicle == VehicleKind::kRobot : path_file.empty() && walk == WalkKind::kCampus;
  }
  // An Error names the field and its value if an option cannot be used.
  Result<> check() const;
};

// Returns the kind named "room" or "street", else an Error.
Result<SceneKind> parse_scene_kind(const std::string& name);
// Returns the kind named "car" or "robot", else an Error.
Result<VehicleKind> parse_vehicle_kind(const std::string& name);
// Returns the kind named "loop", "next-room", "twin-rooms", "storeys", "doors", "square" or "campus", else an Error.
Result<WalkKind> parse_walk_kind(const std::string& name);
// Returns the kind named "blur", "dark", "textureless", "rotation" or "lorry", else an Error.
Result<HardPassage::Kind> parse_hard_kind(const std::string& name);

}  // namespace rumi::synth
