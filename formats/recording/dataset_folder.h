// SPDX-License-Identifier: BSD-3-Clause
// The folders of datasets, as their downloads make them.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// The folder of a recording, found in a folder above it.
struct DatasetFolder {
  std::filesystem::path folder;  // what was given, if nothing else is known
  std::string note;              // empty, or what was taken instead
};
// Finds the dataset inside the folder of an unpacked archive, if there is one and nothing else to play, and the colour
// images of an RGB-D dataset without a list (ICL-NUIM).
DatasetFolder find_dataset(const std::filesystem::path& given);

// Finds data.csv of the camera in a folder like EuRoC's, however much of its path is given; empty if there is none.
std::filesystem::path find_euroc_list(const std::filesystem::path& folder);

// Recognizes a dataset by the names of its download: "; it seems to be of TUM's freiburg1: try --camera
// config/cameras/tum_fr1.yaml (of Rumi)". Empty if it is not known.
std::string advice_on_known_camera(const std::filesystem::path& recording, const std::string& channel);

}  // namespace rumi
