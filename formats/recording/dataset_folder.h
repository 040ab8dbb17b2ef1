// SPDX-License-Identifier: BSD-3-Clause
// Finds the recording in a folder as the download of a dataset makes it.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// The folder of a recording, found in a folder above it.
struct DatasetFolder {
  std::filesystem::path folder;  // the given folder, if no other one was found
  std::string note;              // what is played instead of the given folder; empty: nothing else
};
// Finds the folder to play: the dataset inside the folder of an unpacked archive, if that has nothing else to play; the
// colour images of an RGB-D dataset without a list (ICL-NUIM); else the given folder.
DatasetFolder find_dataset(const std::filesystem::path& given);

// Finds data.csv of the camera in a folder like EuRoC's, however much of its path is given; empty if it is not there.
std::filesystem::path find_euroc_list(const std::filesystem::path& folder);

// Recognizes a dataset by the name of its download. Returns "; by its name it is of TUM's freiburg1: give --camera
// config/cameras/tum_fr1.yaml (of Rumi)" or the like; empty if it is not known.
std::string advice_on_known_camera(const std::filesystem::path& recording, const std::string& channel);

}  // namespace rumi
