// SPDX-License-Identifier: BSD-3-Clause
// map.db as a file that somebody else may be using, and an atlas as the outputs of a run.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <opencv2/core/types.hpp>
#include <span>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"
#include "map_server/outputs/output_files.h"
#include "map_server/store/map_store.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::tool {

// The database that a user names: the file, or the output folder of a run. Throws std::runtime_error with a message for
// the user if the folder has no map, or if the file is an lcm log.
std::string map_database_at(const std::string& name);

// Reads a map without locking or changing it, also while a map_server has it open. Throws std::runtime_error with a
// message for the user, also if somebody keeps it locked for longer than `wait`.
map_server::Atlas load_map(const std::string& file, std::chrono::milliseconds wait = map_server::kReaderWait);

// Loads a map from the bytes of its file, and copies it to `copy_to`. Throws as load_map(); *copy_problem says why it
// could not be copied.
map_server::Atlas load_map_bytes(std::span<const uint8_t> bytes, const std::string& copy_to, std::string* copy_problem);

// The content of a picture of the atlas. It points into the atlas and into `placed`.
struct AtlasPicture {
  AtlasPicture() = default;
  AtlasPicture(AtlasPicture&&) = default;  // a copy would point into the original
  std::map<SubmapKey, Submap> placed;      // submaps of the map, as they lie in it
  viewer_offscreen::MapPicture picture;
};
AtlasPicture make_picture(const map_server::Atlas& atlas, const std::string& title);

// Writes trajectory.txt, submaps/, frames.csv, masks (of sessions after `after`) and map.ply (of all). Writes what it
// can; returns a line for each that could not be written. image_size: size of the masks, see write_masks().
std::vector<std::string> write_run_outputs(const map_server::Atlas& atlas, const std::string& folder,
                                           int64_t after = map_server::kNoSession,
                                           const map_server::LandmarkColours& colours = {},
                                           const cv::Size& image_size = {});

// An atlas in numbers.
struct AtlasCounts {
  int64_t frames = 0, tracked_frames = 0, frames_in_map = 0;  // of sessions after the one given
  // Frames of earlier sessions, including those that a session after has seen again; is_joined: the map has submaps of
  // both.
  int64_t earlier_frames = 0;
  int earlier_sessions = 0;
  bool is_joined = false;
  int submaps = 0, keyframes = 0, landmarks = 0;  // of sessions after the one given, and of the map
  int front_submaps = 0, front_submaps_in_map = 0;
};
AtlasCounts count(const map_server::Atlas& atlas, int64_t after = map_server::kNoSession);

}  // namespace rumi::tool
