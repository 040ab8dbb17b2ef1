// SPDX-License-Identifier: BSD-3-Clause
// What never moves in the images of a run (a bonnet, a caption), as it was learned: in words, in run.json, and as masks
// for --mask.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"
#include "map_server/outputs/trajectory_file.h"

namespace rumi::tool {

using RunMasks = std::map<int64_t, map_server::StillMask>;  // by stream

// Those that were learned in sessions after that one and leave something out.
RunMasks masks_of(const map_server::Atlas& atlas, int64_t after = map_server::kNoSession);

// A line each, for a person.
std::vector<std::string> describe_masks(const RunMasks& masks);

nlohmann::ordered_json masks_to_json(const RunMasks& masks);

// FOLDER/mask.png, or FOLDER/mask-STREAM.png of several, instead of those of an earlier run: as large as the images,
// where that is known, as --mask wants it. Returns what could not be written, a line each.
std::vector<std::string> write_masks(const RunMasks& masks, const std::string& folder, const cv::Size& image_size = {});

// Whether it is the name of a file that write_masks() may write.
bool is_mask_name(const std::string& name);

// The mask that a run uses, the one given or else the one beside the data (no input: images from elsewhere), must not
// be one that its outputs replace. Returns what is wrong, or nothing.
std::string check_mask_stays(const std::string& given, const std::string& input, const std::string& folder);

}  // namespace rumi::tool
