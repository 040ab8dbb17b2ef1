// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "slam/geometry/camera.h"

namespace rumi::synth {

// A stretch of the sequence that is hard to track.
struct HardPassage {
  enum class Kind {
    kBlur,         // out of focus
    kDark,         // a few grey levels and noise
    kTextureless,  // everything in sight fades to one blank surface
    kRotation,     // a fast turn of the camera about the vertical, and back
  };
  Kind kind = Kind::kBlur;
  double at_s = 0;      // after the first frame
  double for_s = 0;     // how long
  double strength = 1;  // 0 .. 1; 1 is the full effect
};

// width x height pixels with the field of view of a TUM RGB-D camera: fx = fy = 525 at 640 pixels of width.
Camera default_synth_camera(int width, int height);

// A walk that synth makes up itself.
enum class WalkKind {
  kLoop,      // around the middle of a room
  kNextRoom,  // lost on the way into the next room: see next_room_walk.h
};

struct SynthOptions {
  uint64_t seed = 1;  // chooses everything random: the room, its contents, the walk, the noise
  WalkKind walk = WalkKind::kLoop;
  double seconds = 20;    // length of the walk without a path file
  double rate_hz = 0;     // 0: 30 without a path file, else the times of the file
  std::string path_file;  // TUM trajectory (map_from_cam: t tx ty tz qx qy qz qw); empty: the walk above
  double start_s = 0;     // seconds into the path
  double duration_s = 0;  // how much of the path, in seconds; 0: to its end
  Camera camera = default_synth_camera(640, 480);
  double exposure_s = 0.008;     // shutter time: motion blur; 0: none
  int max_sub_exposures = 8;     // images averaged where the picture moves fast
  double noise = 1;              // times the default sensor noise (read 1.2 grey levels, shot 2.2 at mid grey); 0: none
  double exposure_swing = 0.15;  // slow change of the gain, fraction
  bool grey = false;             // grey images, else colour
  int jpeg_quality = 92;
  std::vector<HardPassage> hard;

  // An Error names the field and the value that cannot be used.
  Result<> check() const;
};

// "loop" or "next-room", else an Error.
Result<WalkKind> parse_walk_kind(const std::string& name);
// "blur", "dark", "textureless" or "rotation", else an Error.
Result<HardPassage::Kind> parse_hard_kind(const std::string& name);

}  // namespace rumi::synth
