// SPDX-License-Identifier: BSD-3-Clause
// Reads a map.db that somebody else may be using, and turns an atlas into the outputs of a run.
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

// Returns the database that a user names by its file or by the output folder of a run. Throws std::runtime_error, with
// a message for the user, if the folder has no map, or if the file is an lcm log.
std::string map_database_at(const std::string& name);

// Reads a map without locking or changing it; a map_server may have it open. Throws std::runtime_error, with a message
// for the user, if that fails or if somebody keeps the map locked for longer than `wait`.
map_server::Atlas load_map(const std::string& file, std::chrono::milliseconds wait = map_server::kReaderWait);

// Loads a map from the bytes of its file, and copies the map to `copy_to`. Throws as load_map() does. If only the copy
// fails, *copy_problem says why.
map_server::Atlas load_map_bytes(std::span<const uint8_t> bytes, const std::string& copy_to, std::string* copy_problem);

// An atlas as a picture, to be drawn. It points into the atlas and into `placed`.
struct AtlasPicture {
  AtlasPicture() = default;
  AtlasPicture(AtlasPicture&&) = default;  // a copy would point into the original
  std::map<SubmapKey, Submap> placed;      // the submaps of the map, at their places in it
  viewer_offscreen::MapPicture picture;
};
AtlasPicture make_picture(const map_server::Atlas& atlas, const std::string& title);

// Writes trajectory.txt, submaps/, frames.csv and masks of the sessions after `after`, and map.ply of all sessions.
// Writes what it can, and returns a line for each failure. image_size: size of the masks, see write_masks().
std::vector<std::string> write_run_outputs(const map_server::Atlas& atlas, const std::string& folder,
                                           int64_t after = map_server::kNoSession,
                                           const map_server::LandmarkColours& colours = {},
                                           const cv::Size& image_size = {});

// Numbers of an atlas. Some are only of the sessions after a given one, which are those of this run.
struct AtlasCounts {
  int64_t frames = 0, tracked_frames = 0, frames_in_map = 0;  // numbers of frames in this run's sessions
  // Frames of earlier sessions, also if this run has the same images; is_joined: the served map has submaps of earlier
  // sessions and frames of this run.
  int64_t earlier_frames = 0;
  int earlier_sessions = 0;
  bool is_joined = false;
  int submaps = 0, keyframes = 0, landmarks = 0;  // submaps of this run's sessions, and all others of the map
  int front_submaps = 0, front_submaps_in_map = 0;
};
AtlasCounts count(const map_server::Atlas& atlas, int64_t after = map_server::kNoSession);

}  // namespace rumi::tool
