// SPDX-License-Identifier: BSD-3-Clause
// Parts of the images that never move in a run (a bonnet, a caption), as front_tracker learned them. They are described
// in words and in run.json, and written as masks for --mask.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "map_server/atlas/atlas.h"
#include "map_server/outputs/trajectory_file.h"

namespace rumi::tool {

using RunMasks = std::map<int64_t, map_server::StillMask>;  // by stream

// Returns the masks that were learned in sessions after `after` and leave something out.
RunMasks masks_of(const map_server::Atlas& atlas, int64_t after = map_server::kNoSession);

// Returns a line for each mask, for a person.
std::vector<std::string> describe_masks(const RunMasks& masks);

nlohmann::ordered_json masks_to_json(const RunMasks& masks);

// Writes FOLDER/mask.png, or FOLDER/mask-STREAM.png if there are several, and removes those of an earlier run. They are
// scaled to the size of the images, as --mask requires, if that size is known. Returns a line for each failure.
std::vector<std::string> write_masks(const RunMasks& masks, const std::string& folder, const cv::Size& image_size = {});

// True if write_masks() may write a file of this name.
bool is_mask_name(const std::string& name);

// An Error if the outputs of a run would replace the mask that the run uses: `given`, or, if that is empty, the one
// beside `input`. An empty `input` means that the images come from elsewhere.
Result<> check_mask_stays(const std::string& given, const std::string& input, const std::string& folder);

}  // namespace rumi::tool
